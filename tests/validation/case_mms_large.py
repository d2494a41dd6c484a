"""Contact with large deformation and a known solution, on a rigid curved master.

Material of St. Venant and Kirchhoff with E = 1 and nu = 0 in the unit cube. The displacement

    U = (0.2 x y z^2, 0.2 x y z^2, -0.2 (1 + x^2 + y^2) (1 + 0.01 z) - 0.01 z - 0.3)

takes its lower face z = 0 to the paraboloid z = -0.2 (1 + x^2 + y^2) - 0.3, which is the surface of
the master. There F is the identity but for its last row (a, b, c), so that the pressure per area of
the reference is p = c (1 - c^2) / (2 sqrt(1 + a^2 + b^2)), between 0.010 and 0.014.

Test SSNV219 of code_aster, modellings e to m; the size of the domain is ours.
"""

from __future__ import annotations

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
from report_bounds import Rate
from report_case import Case, Outcome, Row
from report_pictures import BLUE, GREEN, INK, ORANGE, Figure

from ngslac import ContactSolver, LACContact, LACSpace, SplitSlaveFaces
from ngslac.meshes.boxes import StructuredBox

OUTSIDE = 0.1  # of the master beyond the slave
COLOURS = (BLUE, ORANGE, GREEN, INK)
COORDINATES = (x, y, z)


def Strain(F):
    return 0.5 * (F.trans * F - Id(3))


# The exact solution: the stress is P = F S with S = E.
CURVED = -0.2 * (1 + x * x + y * y)
U = CF((0.2 * x * y * z * z, 0.2 * x * y * z * z, CURVED * (1 + 0.01 * z) - 0.01 * z - 0.3))
F = Id(3) + CF(tuple(u.Diff(c) for u in U for c in COORDINATES), dims=(3, 3))
P = F * Strain(F)
FORCE = -CF(tuple(sum(P[i, k].Diff(c) for k, c in enumerate(COORDINATES)) for i in range(3)))
TRACTION = P * specialcf.normal(3)
OUT = Inv(F).trans * specialcf.normal(3)
NORMAL = OUT / sqrt(InnerProduct(OUT, OUT))  # of the deformed body
PRESSURE = -InnerProduct(TRACTION, NORMAL)


@dataclass(frozen=True)
class Element:
    """Kind of cells, order of the displacement, and what makes order 1 stable."""

    kind: str
    order: int
    stabilize: str = "none"  # "split", "hexes"

    @property
    def name(self):
        return f"{self.kind} {self.order} {self.stabilize}"


# The published element that is nearest to it, and its rates of displacement and pressure.
PUBLISHED = {
    Element("tet", 1, "split"): ("TETRA4", 1.953, 1.282),
    Element("hex", 1, "hexes"): ("HEXA8, hexahedra", 1.990, 1.887),
    Element("hex", 1, "split"): ("HEXA8, pyramids", 1.988, 1.866),
    Element("prism", 1, "split"): ("PENTA6", 1.957, 1.881),
    Element("tet", 2): ("TETRA10", 2.996, 1.994),
    Element("hex", 2): ("HEXA27", 2.999, 1.016),
    Element("prism", 2): ("PENTA15", 3.933, 2.050),
}
LEVELS = {1: (3, 6), 2: (2, 4)}
THEORY = {1: (2.0, 0.5), 2: (2.5, 1.0)}


def BoxMesh(kind, n):
    """The cube with n^3 cells of a kind, above a master with about 3/4 as many in x and y."""
    mesh, grid = NetgenMesh(dim=3), np.linspace(0, 1, n + 1)
    # Its spacing is never a multiple of that of the cube: no vertices below each other inside.
    wide = np.linspace(-OUTSIDE, 1 + OUTSIDE, max(2, round(0.75 * n)) + 1)
    for body, sides, height, names, other in (
        ("cube", grid, grid, {"bottom": "slave", "top": "top"}, "side"),
        ("base", wide, [-0.6, -0.3], {"top": "master"}, "outside"),
    ):

        def Name(side, _, names=names, other=other):
            return names.get(side, other)

        StructuredBox(sides, sides, height, kind, names=Name).AddTo(mesh, body)
    mesh.Compress()
    return Mesh(mesh)


class Manufactured:
    """The problem on one mesh."""

    def __init__(self, element, n):
        mesh = BoxMesh(element.kind, n)
        if element.stabilize != "none":
            flags = {"hexes": {"hexes": "hexes"}, "split": {}}[element.stabilize]
            mesh = SplitSlaveFaces(mesh, "slave", **flags)
        self.mesh = mesh
        self._bend = bend = GridFunction(VectorH1(mesh, order=2))  # the mesh keeps no reference
        bend.Set(CF((0, 0, CURVED)), definedon=mesh.Materials("base"))
        mesh.SetDeformation(bend)
        V = VectorH1(mesh, order=element.order, dirichlet="top")
        X = V * LACSpace(V, slave="slave")
        (u, lam), (v, _) = X.TnT()
        a, self.gf = BilinearForm(X), GridFunction(X)
        strain = Strain(Id(3) + Grad(u))
        a += Variation((0.5 * InnerProduct(strain, strain)).Compile() * dx("cube"))
        self.contact = LACContact(u, lam, master="master", finite=True)
        free = X.FreeDofs() & ~X.GetDofs(mesh.Materials("base"))
        load = Loads(LinearForm(X), v)
        self.solver = ContactSolver(a, self.gf, self.contact, rhs=load, freedofs=free)

    def Solve(self):
        """From the interpolated solution, without contact tractions."""
        self.gf.components[0].Set(U, definedon=self.mesh.Materials("cube"))
        return self.solver.Solve(printing=False)

    @cached_property
    def errors(self):
        """Relative errors of the displacement and of the pressure in L2."""
        cube, slave = self.mesh.Materials("cube"), self.mesh.Boundaries("slave")
        return {
            "displacement": Norm(self.gf.components[0] - U, cube) / Norm(U, cube),
            "pressure": Norm(self.contact.pressure - PRESSURE, slave) / Norm(PRESSURE, slave),
        }


def Loads(form, v):
    """All that the exact stress takes but the contact pressure."""
    order = {"bonus_intorder": 4}
    form += InnerProduct(FORCE.Compile(), v) * dx("cube", **order)
    form += InnerProduct(TRACTION.Compile(), v) * ds("side", **order)
    form += InnerProduct((TRACTION + PRESSURE * NORMAL).Compile(), v) * ds("slave", **order)
    return form.Assemble()


def Norm(field, region):
    square = InnerProduct(field, field)
    return np.sqrt(Integrate(square, region.mesh, definedon=region, order=8))


def Rates(levels, errors):
    """Rates of convergence from the first to the last of some meshes."""
    ratio = np.log(levels[-1] / levels[0])
    return {key: float(np.log(errors[0][key] / errors[-1][key]) / ratio) for key in errors[0]}


def Errors(element, n):
    problem = Manufactured(element, n)
    problem.Solve()
    return problem.errors


def ManufacturedLarge(quick):
    rows, curves = [], {}
    for element, (name, *published) in list(PUBLISHED.items())[: 1 if quick else None]:
        levels = LEVELS[element.order]
        errors = [Errors(element, n) for n in levels]
        curves[name] = levels, errors
        for k, (key, rate) in enumerate(Rates(levels, errors).items()):
            text = f"{name} ({element.name}): rate of the {key} (code_aster: {published[k]:.2f})"
            rows.append(Row(text, rate, THEORY[element.order][k], Rate()))

    def Draw(*axes):
        for ax, key in zip(axes, ("displacement", "pressure"), strict=True):
            for k, (name, (levels, errors)) in enumerate(curves.items()):
                style = "--o" if levels[-1] == 6 else "-s"
                values = [error[key] for error in errors]
                sizes = [1 / n for n in levels]
                ax.loglog(sizes, values, style, ms=4, color=COLOURS[k % 4], label=name)
            ax.set_title(f"{key}, L2")
            ax.set_xlabel("mesh size")
            ax.set_xticks([1 / 6, 1 / 4, 1 / 3, 1 / 2], ["1/6", "1/4", "1/3", "1/2"])
            ax.minorticks_off()
        axes[0].set_ylabel("relative error")
        axes[1].legend(loc="center left", bbox_to_anchor=(1.01, 0.5))

    caption = "Relative errors on two meshes each; order 1 dashed, order 2 solid."
    return Outcome(rows, Figure(Draw, columns=2, size=(10, 4)), caption)


CASES = [
    Case(
        "mms-large",
        "Large deformation with a known solution",
        "A cube of the material of St. Venant and Kirchhoff whose lower face is bent onto a rigid "
        "paraboloid; loads follow from the chosen displacement. Rates of convergence between two "
        "meshes, which are coarser than those of the published rates.",
        "Theory: 2 and 1/2 for order 1, 5/2 and 1 for order 2. Published for Local Average "
        "Contact: code_aster, test SSNV219 (modellings e to m).",
        "pytest tests/validation/test_mms_large.py",
        ManufacturedLarge,
    ),
]
