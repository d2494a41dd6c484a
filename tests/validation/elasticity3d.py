"""Two elastic solids in contact: the three-dimensional counterpart of `elasticity`."""

import numpy as np
from elasticity import Material, Pair
from ngsolve import CF, ET, VOL, InnerProduct, IntegrationRule, ds, dx, specialcf
from ngsolve import Grad as Gradient

__all__ = ["Field", "Pair3D", "Solid", "StressError"]

POINTS = [(0.02, 0.03, 0.05), (0.9, 0.05, 0.02), (0.31, 0.3, 0.2), (0.05, 0.1, 0.8)]


class Solid(Material):
    """Linear elasticity in three dimensions."""

    def Strain(self, stress):
        """The strain (3, 3) of a stress given as numpy array; for numbers only."""
        return ((1 + self.nu) * stress - self.nu * np.trace(stress) * np.eye(3)) / self.young


def Field(array):
    """A constant vector or matrix as coefficient function."""
    return CF(tuple(array.ravel()), dims=array.shape)


class Pair3D(Pair):
    """As `Pair`, with loads that keep a constant stress in equilibrium."""

    def LoadStress(self, stress, where):
        """The tractions of a constant stress on boundaries."""
        self.Load(Field(stress) * specialcf.normal(3), where)

    def LoadStressInside(self, stress, contact):
        """The tractions of a constant stress on all but the contact boundaries, from the inside.

        Gauss' theorem has an error of 1e-10 in NGSolve's pyramids, which it cuts off just below
        their apex. With the volume integral the bulk has no part in the error of a patch test.
        """
        self.load += InnerProduct(Field(stress), Gradient(self.v)) * dx
        self.load += -InnerProduct(Field(stress) * specialcf.normal(3), self.v) * ds(contact)

    def StressError(self, stress):
        """Largest distance to a constant stress, relative to it."""
        return StressError(self.mesh, self.stress, stress)


def StressError(mesh, field, stress):
    """Largest distance of a stress field to a constant one, relative to it."""
    rule = IntegrationRule(points=POINTS, weights=[0] * len(POINTS))
    points = mesh.MapToAllElements(dict.fromkeys((ET.TET, ET.PYRAMID, ET.PRISM, ET.HEX), rule), VOL)
    return np.abs(field(points).reshape(-1, 3, 3) - stress).max() / np.abs(stress).max()
