"""What the problems with large displacements share: energies and the discrete model.

Plane strain; J = det F, C = F^T F.
"""

from dataclasses import dataclass, field

import numpy as np
from ngsolve import (
    BilinearForm,
    Det,
    Grad,
    GridFunction,
    Id,
    IfPos,
    InnerProduct,
    Parameter,
    Sym,
    Trace,
    Variation,
    ds,
    dx,
    log,
    sqrt,
)

from ngslac import ContactSolver, LACContact, LACSpace, LoadStepper


def Lame(young, nu):
    return young * nu / ((1 + nu) * (1 - 2 * nu)), young / (2 * (1 + nu))


def _Hooke(strain, young, nu):
    first, shear = Lame(young, nu)
    return first / 2 * Trace(strain) * Trace(strain) + shear * InnerProduct(strain, strain)


def Small(u, young, nu):
    """Linear elasticity."""
    return _Hooke(Sym(Grad(u)), young, nu)


def SaintVenant(u, young, nu):
    """Hooke's law of Green's strain and the second Piola-Kirchhoff stress."""
    F = Id(2) + Grad(u)
    return _Hooke(0.5 * (F.trans * F - Id(2)), young, nu)


def Hencky(u, young, nu):
    """Hooke's law of the logarithmic strain and the Kirchhoff stress.

    With the principal stretches a, b: log(a b) = log J, and q = tr C / (2 J) = cosh(log(a/b)).
    """
    first, shear = Lame(young, nu)
    F = Id(2) + Grad(u)
    J = Det(F)
    z = Trace(F.trans * F) / (2 * J) - 1
    volume = log(J)
    return (first + shear) / 2 * volume * volume + shear / 2 * _SquaredArcosh(z)


def _SquaredArcosh(z):
    """arcosh(1 + z)^2, near 0 by its series (the root has no derivative there)."""
    bound, terms, binomial = 0.2, 0 * z, 1.0
    for n in range(1, 14):
        binomial *= (2 * n - 1) * 2 * n / n**2
        terms += -2 * (-2 * z) ** n / (n**2 * binomial)
    away = IfPos(z - bound, z, bound)
    value = log(1 + away + sqrt(away * (away + 2)))
    return IfPos(z - bound, value * value, terms)


@dataclass
class Model:
    """Bulk and contact on the displacement space `V`.

    `V` has the Dirichlet conditions; ``energy(u, young, nu)`` is one of the above, with moduli
    `young` by the material; `forces` are dead ones (per thickness) at vertices, which the load
    multiplies. Without `finite` sliding the surfaces are paired in the reference.
    """

    V: object
    energy: object
    young: dict
    nu: float = 0.3
    slave: str = "slave"
    master: str = "master"
    friction: float | None = None
    finite: bool = True
    forces: dict = field(default_factory=dict)
    load: Parameter = field(init=False)
    contact: LACContact = field(init=False)
    solver: ContactSolver = field(init=False)

    def __post_init__(self):
        mesh = self.V.mesh
        X = self.V * LACSpace(self.V, slave=self.slave)
        (u, lam), (v, _) = X.TnT()
        self.load = Parameter(0.0)
        a = BilinearForm(X)
        a += Variation(self.energy(u, mesh.MaterialCF(self.young), self.nu).Compile() * dx)
        for vertex, force in self.forces.items():
            at = ds(definedon=mesh.BBoundaries(vertex))
            for k, value in enumerate(force):
                a += -self.load * value * v[k] * at
        kind = {"finite": True} if self.finite else {}
        self.contact = LACContact(u, lam, master=self.master, friction=self.friction, **kind)
        self.solver = ContactSolver(a, GridFunction(X), self.contact)

    @property
    def displacement(self):
        return self.solver.gf.components[0]

    def Run(self, *, steps, end=1.0, prescribe=None, callback=None):
        """Raise the load to `end`; returns the steps."""
        stepper = LoadStepper(self.solver, self.load, prescribe=prescribe)
        return stepper.Integrate(end, steps=steps, callback=callback, printing=False)

    def At(self, material, point):
        """Displacement of the vertex of a body at `point`."""
        mesh = self.V.mesh
        vertices = {v.nr for el in mesh.Materials(material).Elements() for v in el.vertices}
        nr = min(vertices, key=lambda n: np.hypot(*np.subtract(mesh.vertices[n].point, point)))
        assert np.hypot(*np.subtract(mesh.vertices[nr].point, point)) < 1e-6
        values = self.displacement.vec.FV().NumPy()
        return np.array([values[self.V.Range(k).start + nr] for k in range(2)])
