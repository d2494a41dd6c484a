"""A cylinder on a block under loads so low that both are half-planes to the contact.

The cylinder has the radius 50 mm and lies on the block of the paper's Hertz problem; the bodies are
linearly elastic, in plane strain. Forces are in N/mm, stresses in MPa.
"""

from dataclasses import dataclass, field

import numpy as np
from ngsolve import (
    BilinearForm,
    Grad,
    GridFunction,
    InnerProduct,
    Integrate,
    Parameter,
    Sym,
    TaskManager,
    VectorH1,
    ds,
    dx,
    y,
)

from ngslac import ContactSolver, LACContact, LACSpace, LoadStepper
from ngslac.materials import Stress
from ngslac.meshes import HertzMesh
from ngslac.reference import HertzLine

RADIUS = 50.0
OPEN, STICK, SLIP = 0, 1, 2


@dataclass(frozen=True, kw_only=True)
class Cylinder:
    """What to compute.

    Parameters
    ----------
    force : float
        Normal force of the whole contact, at the top of the cylinder.
    young : tuple of float
        Moduli of the cylinder and of the block.
    h, zone : float
        Edge length of the slave side, and length of the slave arc from the middle.
    half : bool
        Half model, for loads without shear.
    """

    force: float
    friction: float
    h: float
    zone: float
    young: tuple = (210e3, 70e3)
    nu: float = 0.3
    half: bool = True
    grading: float = 0.3

    @property
    def hertz(self):
        """Hertz' solution at the full load."""
        cylinder, block = self.young
        return HertzLine(
            force=self.force,
            radius1=RADIUS,
            young1=cylinder,
            nu1=self.nu,
            young2=block,
            nu2=self.nu,
        )


@dataclass
class Model:
    """The discrete problem, with a load factor for the normal and one for the shear force."""

    problem: Cylinder
    contact: LACContact = field(init=False)
    normal: LoadStepper = field(init=False)
    shear: LoadStepper = field(init=False)

    def __post_init__(self):
        p = self.problem
        mesh = HertzMesh(p.h, zone=p.zone, half=p.half, grading=p.grading)
        V = VectorH1(mesh, order=2, dirichletx="sym|bottom", dirichlety="bottom")
        X = V * LACSpace(V, slave="slave")
        (u, lam), _ = X.TnT()
        factors = Parameter(0.0), Parameter(0.0)
        self.contact = LACContact(u, lam, master="master", friction=p.friction)
        solver = ContactSolver(Bulk(p, X, *factors), GridFunction(X), self.contact)
        self.normal, self.shear = (LoadStepper(solver, factor) for factor in factors)

    def Press(self, steps):
        """Raise the normal force such that the half width of the contact grows by equal parts."""
        with TaskManager():
            for k in range(1, steps + 1):
                self.normal.Integrate(end=(k / steps) ** 2, steps=1, printing=False)
        return self.Profile()

    def Shear(self, force, steps=1):
        """Change the shear force: `force` becomes the resultant of the tractions on the slave."""
        with TaskManager():
            self.shear.Integrate(end=force, steps=steps, printing=False)
        return self.Profile()

    def Profile(self):
        """The multipliers along x."""
        return Profile.Of(self.contact.Table(), half=self.problem.half)


def Bulk(problem, X, normal, shear):
    """Elasticity, the normal force at the top and the shear force in the cylinder.

    The shear force is a body force without moment about the contact: it does not make the cylinder
    roll, and the contact pressure stays centred.
    """
    (u, _), (v, _) = X.TnT()
    mesh = X.mesh
    young = mesh.MaterialCF(dict(zip(("cylinder", "block"), problem.young, strict=True)))
    a = BilinearForm(X)
    a += InnerProduct(Stress(Sym(Grad(u)), young, problem.nu), Sym(Grad(v))) * dx
    share = 0.5 if problem.half else 1.0
    a += normal * share * problem.force * v[1] * ds(definedon=mesh.BBoundaries("load"))
    if not problem.half:
        a += shear * UnitForce(mesh) * v[0] * dx("cylinder")
    return a


def UnitForce(mesh):
    """A density in the cylinder, linear in y, with the resultant 1 and no moment about y = 0."""
    disc = mesh.Materials("cylinder")
    area, first, second = (Integrate(y**k, mesh, order=6, definedon=disc) for k in range(3))
    constant, slope = np.linalg.solve([[area, first], [first, second]], [1.0, 0.0])
    return float(constant) + float(slope) * y


@dataclass(frozen=True)
class Profile:
    """Macro-elements ordered by x: ends, status, pressure and tangential traction.

    The traction counts along x, on the slave side.
    """

    start: np.ndarray
    end: np.ndarray
    status: np.ndarray
    pressure: np.ndarray
    traction: np.ndarray

    @classmethod
    def Of(cls, table, *, half):
        order = np.argsort(table["x"][:, 0])
        arc = np.concatenate([[0.0], np.cumsum(table["fullarea"][order])])
        nodes = RADIUS * np.sin((arc if half else arc - arc[-1] / 2) / RADIUS)
        normal, traction = table["normal"][order], table["traction"][order]
        along = normal[:, 0] * traction[:, 1] - normal[:, 1] * traction[:, 0]
        return cls(nodes[:-1], nodes[1:], table["status"][order], table["pressure"][order], along)

    @property
    def middle(self):
        return 0.5 * (self.start + self.end)

    def Zone(self, *status):
        """Ends of the interval of macro-elements with one of these statuses; no holes allowed."""
        inside = np.isin(self.status, status)
        where = np.flatnonzero(inside)
        assert np.all(np.diff(where) == 1)
        return self.start[where[0]], self.end[where[-1]]
