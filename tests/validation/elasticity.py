"""Two elastic bodies in contact, as short as possible: shared by the validation cases."""

from dataclasses import dataclass

import numpy as np
from ngsolve import (
    ET,
    VOL,
    BilinearForm,
    GridFunction,
    InnerProduct,
    IntegrationRule,
    LinearForm,
    Sym,
    VectorH1,
    ds,
    dx,
)
from ngsolve import Grad as Gradient

from ngslac import BubbleVectorH1, ContactSolver, LACContact, LACSpace, SplitSlaveFaces
from ngslac.materials import Stress

__all__ = ["NAMES", "Displacements", "Material", "Pair", "Samples"]

NAMES = {
    "P1": "order 1, two faces",
    "P1split": "order 1, split faces",
    "P1bubble": "order 1, bubbles",
    "P2": "order 2",
    "P3": "order 3",
}


@dataclass(frozen=True)
class Material:
    """Linear elasticity, in 2D in plane strain; `young` may be a coefficient function."""

    young: object = 2000.0
    nu: object = 0.3

    def Stress(self, strain):
        return Stress(strain, self.young, self.nu)

    def Strain(self, stress):
        """The strain (2, 2) of a stress given as numpy array; for numbers only."""
        return (1 + self.nu) / self.young * (stress - self.nu * np.trace(stress) * np.eye(2))


def Displacements(mesh, kind, *, slave="slave", **flags):
    """Displacement space, on a new mesh if split: "P1", "P1split", "P1bubble", "P2", ..."""
    order = int(kind[1])
    if kind.endswith("split"):
        mesh = SplitSlaveFaces(mesh, slave)
    if kind.endswith("bubble"):
        return BubbleVectorH1(mesh, order=order, slave=slave, **flags)
    return VectorH1(mesh, order=order, **flags)


def Samples(mesh):
    """Points inside all elements, near their vertices too."""
    rule = IntegrationRule(points=[(0.02, 0.03), (0.9, 0.05), (0.31, 0.3)], weights=[0, 0, 0])
    return mesh.MapToAllElements({ET.TRIG: rule, ET.QUAD: rule}, VOL)


def Flat(nested):
    """The proxies of a product of products in one list."""
    return [p for n in nested for p in (Flat(n) if isinstance(n, (list, tuple)) else [n])]


class Pair:
    """Bulk, contact and solution of two bodies on the product of displacement and traction.

    Parameters
    ----------
    V : FESpace
        Displacement.
    material : Material
    product : callable
        Makes the product space of V and the LACSpace: V comes first, the LACSpace last, and scalar
        fields between them have no part in the problem.
    slave : str
        Boundaries of the LACSpace.
    **law
        Options of LACContact.
    """

    def __init__(self, V, material, *, slave="slave", product=lambda V, Q: V * Q, **law):
        self.material, self.mesh = material, V.mesh
        self.Q = LACSpace(V, slave=slave)
        self.X = product(V, self.Q)
        trial, test = map(Flat, self.X.TnT())
        self.a = BilinearForm(self.X)
        strain = Sym(Gradient(trial[0]))
        self.a += InnerProduct(material.Stress(strain), Sym(Gradient(test[0]))) * dx
        for w, dw in list(zip(trial, test, strict=True))[1:-1]:
            self.a += w * dw * dx
        self.v = test[0]
        self.load = LinearForm(self.X)
        self.contact = LACContact(trial[0], trial[-1], **{"master": "master"} | law)
        self.gf = self.displacement = GridFunction(self.X)
        while self.displacement.space != V:
            self.displacement = self.displacement.components[0]
        self.stress = material.Stress(Sym(Gradient(self.displacement)))

    def Load(self, traction, where):
        """Tractions on boundaries."""
        self.load += InnerProduct(traction, self.v) * ds(where)

    def Hold(self, displacement, where):
        """Dirichlet values on boundaries (which V has to name); call it once."""
        self.displacement.Set(displacement, definedon=self.mesh.Boundaries(where))

    def Solve(self, *, tol=1e-12, **options):
        """One step; returns the last `Iteration`. (So small a problem is faster in one thread.)"""
        self.load.Assemble()
        solver = ContactSolver(self.a, self.gf, self.contact, rhs=self.load.vec)
        return solver.Solve(tol=tol, printing=False, **options)

    def StressError(self, stress):
        """Largest distance to a constant stress, relative to it."""
        values = self.stress(Samples(self.mesh)).reshape(-1, 2, 2)
        return np.abs(values - stress).max() / np.abs(stress).max()
