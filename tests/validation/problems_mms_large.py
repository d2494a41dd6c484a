"""Contact with large deformation and a known solution (T09), on a rigid curved master.

Material of St. Venant and Kirchhoff with E = 1 and nu = 0 in the unit cube. The displacement

    U = (0.2 x y z^2, 0.2 x y z^2, -0.2 (1 + x^2 + y^2) (1 + 0.01 z) - 0.01 z - 0.3)

takes its lower face z = 0 to the paraboloid z = -0.2 (1 + x^2 + y^2) - 0.3, which is the surface of
the master. There F is the identity but for its last row (a, b, c), so that the pressure per area of
the reference is p = c (1 - c^2) / (2 sqrt(1 + a^2 + b^2)), between 0.010 and 0.014.

Test SSNV219 of code_aster, modellings e to m; the size of the domain is ours.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from netgen.meshing import Mesh as NetgenMesh
from ngsolve import (
    CF,
    BilinearForm,
    Grad,
    GridFunction,
    Id,
    InnerProduct,
    Integrate,
    Inv,
    LinearForm,
    Mesh,
    Variation,
    VectorH1,
    ds,
    dx,
    specialcf,
    sqrt,
    x,
    y,
    z,
)

from ngslac import BubbleVectorH1, ContactSolver, LACContact, LACSpace, SplitSlaveFaces
from ngslac.meshes.boxes import AddBody, StructuredBox

OUTSIDE = 0.1  # of the master beyond the slave
COORDINATES = (x, y, z)
CURVED = -0.2 * (1 + x * x + y * y)
U = CF((0.2 * x * y * z * z, 0.2 * x * y * z * z, CURVED * (1 + 0.01 * z) - 0.01 * z - 0.3))


def Gradient(field):
    """Of a vector (3,) or matrix (3, 3) in x, y, z: the derivatives are in the last place."""
    return [[component.Diff(c) for c in COORDINATES] for component in field]


def Strain(F):
    return 0.5 * (F.trans * F - Id(3))


@dataclass(frozen=True)
class Exact:
    """The stress P = F S with S = E, and the loads that it takes."""

    F: object
    P: object

    @classmethod
    def Of(cls, field):
        rows = Gradient(field)
        F = Id(3) + CF(tuple(entry for row in rows for entry in row), dims=(3, 3))
        return cls(F, F * Strain(F))

    @property
    def force(self):
        """Load per volume: minus the divergence of P."""
        return -CF(
            tuple(sum(self.P[i, k].Diff(COORDINATES[k]) for k in range(3)) for i in range(3))
        )

    @property
    def traction(self):
        return self.P * specialcf.normal(3)

    @property
    def normal(self):
        """Out of the deformed body."""
        n = Inv(self.F).trans * specialcf.normal(3)
        return n / sqrt(InnerProduct(n, n))

    @property
    def pressure(self):
        return -InnerProduct(self.traction, self.normal)


EXACT = Exact.Of(U)


def BoxMesh(kind, n, order, split):
    """The cube with n^3 cells of a kind, above a master with about 3/4 as many in x and y."""
    mesh = NetgenMesh(dim=3)
    grid = np.linspace(0, 1, n + 1)
    names = {"bottom": "slave", "top": "top"}
    AddBody(
        mesh,
        "cube",
        StructuredBox(grid, grid, grid, kind, names=lambda side, _: names.get(side, "side")),
    )
    # Its spacing is never a multiple of that of the cube: no vertices below each other inside.
    wide = np.linspace(-OUTSIDE, 1 + OUTSIDE, max(2, round(0.75 * n)) + 1)
    AddBody(
        mesh,
        "base",
        StructuredBox(
            wide,
            wide,
            [-0.6, -0.3],
            kind,
            names=lambda side, _: "master" if side == "top" else "outside",
        ),
    )
    mesh.Compress()
    mesh = Mesh(mesh)
    return SplitSlaveFaces(mesh, "slave", **split) if split is not None else mesh


@dataclass(frozen=True)
class Case:
    """Kind of cells, order of the displacement, and what makes order 1 stable."""

    kind: str
    order: int
    stabilize: str = "none"  # "split", "hexes", "bubble"

    @property
    def name(self):
        return f"{self.kind} {self.order} {self.stabilize}"


class Manufactured:
    """The problem on one mesh."""

    def __init__(self, case, n):
        self.case, self.n = case, n
        split = {"split": {}, "hexes": {"hexes": "hexes"}}.get(case.stabilize)
        self.mesh = mesh = BoxMesh(case.kind, n, case.order, split)
        bend = GridFunction(VectorH1(mesh, order=2))
        bend.Set(CF((0, 0, CURVED)), definedon=mesh.Materials("base"))
        self._bend = bend  # the mesh keeps no reference
        mesh.SetDeformation(bend)
        space, flags = VectorH1, {"order": case.order, "dirichlet": "top"}
        if case.stabilize == "bubble":
            space, flags = BubbleVectorH1, flags | {"slave": "slave"}
        V = space(mesh, **flags)
        X = V * LACSpace(V, slave="slave")
        (u, lam), (v, _) = X.TnT()
        self.a = BilinearForm(X)
        strain = Strain(Id(3) + Grad(u))
        self.a += Variation((0.5 * InnerProduct(strain, strain)).Compile() * dx("cube"))
        self.gf = GridFunction(X)
        self.contact = LACContact(u, lam, master="master", finite=True)
        free = X.FreeDofs()
        base = X.GetDofs(mesh.Materials("base"))
        self.solver = ContactSolver(
            self.a, self.gf, self.contact, rhs=self.Loads(v), freedofs=free & ~base
        )

    @property
    def displacement(self):
        return self.gf.components[0]

    def Loads(self, v):
        """All that the exact stress takes but the contact pressure."""
        form, order = LinearForm(self.gf.space), {"bonus_intorder": 4}
        tangential = EXACT.traction + EXACT.pressure * EXACT.normal
        form += InnerProduct(EXACT.force.Compile(), v) * dx("cube", **order)
        form += InnerProduct(EXACT.traction.Compile(), v) * ds("side", **order)
        form += InnerProduct(tangential.Compile(), v) * ds("slave", **order)
        return form.Assemble()

    def Solve(self, **options):
        """From the interpolated solution, without contact tractions."""
        self.displacement.Set(U, definedon=self.mesh.Materials("cube"))
        return self.solver.Solve(**{"printing": False, **options})

    @cached_property
    def errors(self):
        """Relative errors of the displacement and of the pressure in L2."""
        cube = self.mesh.Materials("cube")
        slave = self.mesh.Boundaries("slave")
        pressure = self.contact.pressure
        return {
            "displacement": Norm(self.displacement - U, cube) / Norm(U, cube),
            "pressure": Norm(pressure - EXACT.pressure, slave) / Norm(EXACT.pressure, slave),
        }


def Norm(field, region):
    order = 8
    square = InnerProduct(field, field)
    return np.sqrt(Integrate(square, region.mesh, definedon=region, order=order))


def Rates(levels, errors):
    """Rates of convergence from the first to the last of some meshes."""
    ratio = np.log(levels[-1] / levels[0])
    return {key: float(np.log(errors[0][key] / errors[-1][key]) / ratio) for key in errors[0]}
