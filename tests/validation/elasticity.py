"""Two elastic bodies in contact, as short as possible, in 2D and 3D: shared by many cases."""

from dataclasses import dataclass

import numpy as np
from ngsolve import (
    CF,
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
    specialcf,
)
from ngsolve import Grad as Gradient

from ngslac import BubbleVectorH1, ContactSolver, LACContact, LACSpace, SplitSlaveFaces
from ngslac.materials import Stress

__all__ = ["NAMES", "Displacements", "Field", "Material", "Pair", "Sorted", "StressError"]

NAMES = {
    "P1": "order 1, two faces",
    "P1split": "order 1, split faces",
    "P1bubble": "order 1, bubbles",
    "P2": "order 2",
    "P3": "order 3",
}
# Inside of all elements, near their vertices too.
POINTS = [(0.02, 0.03, 0.05), (0.9, 0.05, 0.02), (0.31, 0.3, 0.2), (0.05, 0.1, 0.8)]
SHAPES = {2: (ET.TRIG, ET.QUAD), 3: (ET.TET, ET.PYRAMID, ET.PRISM, ET.HEX)}


@dataclass(frozen=True)
class Material:
    """Linear elasticity, in 2D in plane strain; `young` may be a coefficient function."""

    young: object = 2000.0
    nu: object = 0.3

    def Stress(self, strain):
        return Stress(strain, self.young, self.nu)

    def Strain(self, stress):
        """The strain (d, d) of a stress given as numpy array; for numbers only."""
        d, nu = len(stress), self.nu
        lateral = nu * (1 + nu) if d == 2 else nu
        return ((1 + nu) * stress - lateral * np.trace(stress) * np.eye(d)) / self.young


def Displacements(mesh, kind, *, slave="slave", **flags):
    """Displacement space, on a new mesh if split: "P1", "P1split", "P1bubble", "P2", ..."""
    order = int(kind[1])
    if kind.endswith("split"):
        mesh = SplitSlaveFaces(mesh, slave)
    if kind.endswith("bubble"):
        return BubbleVectorH1(mesh, order=order, slave=slave, **flags)
    return VectorH1(mesh, order=order, **flags)


def Field(array):
    """A constant vector or matrix as coefficient function."""
    return CF(tuple(array.ravel()), dims=array.shape)


def StressError(mesh, field, stress):
    """Largest distance of a stress field to a constant one, relative to it."""
    rule = IntegrationRule(points=[p[: mesh.dim] for p in POINTS], weights=[0] * len(POINTS))
    points = mesh.MapToAllElements(dict.fromkeys(SHAPES[mesh.dim], rule), VOL)
    return np.abs(field(points).reshape(-1, *stress.shape) - stress).max() / np.abs(stress).max()


def Sorted(table, at=lambda x: x[:, 0]):
    """The table of a contact by x, or by another function of the middles (n, d)."""
    order = np.argsort(at(table["x"]), kind="stable")
    return {name: values[order] for name, values in table.items()}


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

    def LoadStress(self, stress, where):
        """The tractions of a constant stress on boundaries."""
        self.Load(Field(stress) * specialcf.normal(self.mesh.dim), where)

    def LoadStressInside(self, stress, contact):
        """The tractions of a constant stress on all but the contact boundaries, from the inside.

        Gauss' theorem has an error of 1e-10 in NGSolve's pyramids, which it cuts off just below
        their apex. With the volume integral the bulk has no part in the error of a patch test.
        """
        self.load += InnerProduct(Field(stress), Gradient(self.v)) * dx
        self.LoadStress(-stress, contact)

    def Hold(self, displacement, where):
        """Dirichlet values on boundaries (which V has to name); call it once."""
        self.displacement.Set(displacement, definedon=self.mesh.Boundaries(where))

    def Solve(self, *, tol=1e-12, load=None, **options):
        """One step; returns the last `Iteration`. (So small a problem is faster in one thread.)

        `load` is the vector of all loads, if those that were assembled are not it.
        """
        load = self.load.Assemble().vec if load is None else load
        solver = ContactSolver(self.a, self.gf, self.contact, rhs=load)
        return solver.Solve(tol=tol, printing=False, **options)

    def StressError(self, stress):
        """Largest distance to a constant stress, relative to it."""
        return StressError(self.mesh, self.stress, stress)
