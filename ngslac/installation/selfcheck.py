# SPDX-License-Identifier: LGPL-2.1-or-later
"""Small problems with known solutions, for a look whether an installation works.

Two blocks that do not match carry one constant stress. With half of the shear at which they slide
the displacement is linear; with all of it the upper block has slid by a given way besides. The
method gives both to rounding, in 2D and in 3D.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from ngsolve import (
    CF,
    BilinearForm,
    Grad,
    GridFunction,
    InnerProduct,
    Integrate,
    Sym,
    VectorH1,
    ds,
    dx,
    specialcf,
    x,
    y,
    z,
)

from ngslac._ngslac import LACSpace
from ngslac.contact.contact import LACContact
from ngslac.materials import Stress
from ngslac.meshes import TwoBlocks, TwoBlocks3D
from ngslac.solve.solver import ContactSolver

__all__ = ["CASES", "Case"]

YOUNG, POISSON, PRESSURE, FRICTION = 2000.0, 0.3, 25.0, 0.4
ALLOWED = 1e-9  # Newton's method ends at 1e-10 of the forces
HELD = "bottom|top"
FREE = "left_.*|right_.*|front_.*|back_.*"


@dataclass(frozen=True)
class Case:
    """One problem."""

    dim: int
    shear: float  # part of the shear stress at which the blocks slide
    slip: float  # how far the upper block has slid, with shear=1

    @property
    def name(self):
        return f"{'slip' if self.slip else 'stick'} in {self.dim}D"

    @property
    def along(self):
        """Direction of the shear in the plane of contact, oblique to the axes in 3D."""
        return np.array([1.0, 0.0] if self.dim == 2 else [0.8, 0.6, 0.0])

    @property
    def stress(self):
        """The exact stress, constant, shape (dim, dim)."""
        up = np.eye(self.dim)[-1]
        shear = np.outer(self.along, up)
        level = self.shear * FRICTION * PRESSURE
        return level * (shear + shear.T) - PRESSURE * np.outer(up, up)

    @property
    def strain(self):
        """The exact strain, in 2D that of plane strain."""
        s = self.stress
        trace = np.trace(s) * (1 + POISSON if self.dim == 2 else 1)
        return ((1 + POISSON) * s - POISSON * trace * np.eye(self.dim)) / YOUNG

    def Mesh(self):
        return TwoBlocks(0.25) if self.dim == 2 else TwoBlocks3D("tet", None, (3, 2), (2, 3))

    def Displacement(self, mesh):
        """The exact one at the ends: linear, and the slip of the upper block."""
        place = CF((x, y, z)[: self.dim])
        slid = mesh.BoundaryCF({"top": self.slip}, default=0) * CF(tuple(self.along))
        return Constant(self.strain) * place + slid

    def Solve(self):
        """Solve it with defaults: displacement, and force on the slave."""
        mesh = self.Mesh()
        V = VectorH1(mesh, order=2, dirichlet=HELD)
        fes = V * LACSpace(V, slave="slave")
        (u, lam), (v, _) = fes.TnT()
        traction = Constant(self.stress) * specialcf.normal(self.dim)
        a = BilinearForm(fes)
        a += InnerProduct(Stress(Sym(Grad(u)), YOUNG, POISSON), Sym(Grad(v))) * dx
        a += -InnerProduct(traction, v) * ds(FREE)
        gf = GridFunction(fes)
        gf.components[0].Set(self.Displacement(mesh), definedon=mesh.Boundaries(HELD))
        contact = LACContact(u, lam, master="master", friction=FRICTION)
        ContactSolver(a, gf, contact).Solve(printing=False)
        return gf.components[0], np.array(contact.Force())

    def Errors(self):
        """Relative errors of the stress in the blocks, of size 1, and of the force on the slave."""
        u, force = self.Solve()
        error = Stress(Sym(Grad(u)), YOUNG, POISSON) - Constant(self.stress)
        square = Integrate(InnerProduct(error, error), u.space.mesh)
        missing = np.linalg.norm(force + self.stress[:, -1])  # the slave looks down
        return np.array([math.sqrt(square / 2), missing]) / np.linalg.norm(self.stress)

    def Differs(self):
        """What is wrong, in words; "" for nothing."""
        try:
            errors = self.Errors()
        except Exception as error:  # to be reported, with the results of the other cases
            return f"{type(error).__name__}: {error}"
        parts = zip(("stress", "contact force"), errors, strict=True)
        wrong = [f"{what} off by {size:.1e}" for what, size in parts if not size <= ALLOWED]
        return " and ".join(wrong) + f", of {ALLOWED:.0e} allowed" if wrong else ""


def Constant(array):
    """A constant tensor as coefficient function."""
    return CF(tuple(array.ravel()), dims=array.shape)


CASES = [Case(dim, *load) for dim in (2, 3) for load in ((0.5, 0.0), (1.0, 0.01))]
