"""The patch test of two blocks with large strains: one deformation gradient in each block.

Two neo-Hookean materials, compressed by 30 %. The blocks are stretched along the interface and
pushed on each other. Where both are stretched alike they may be sheared as well and stick; without
friction the stretches differ such that blocks of different width end up equally wide: the surfaces
then slide over each other, the edge of the slave to the rim of the master.

Pressures stay below 1.1 times the slave's mu: at about 1.6 (order 2) these states lose their
stability, since a face that is held on average only may wrinkle under so large a pressure.
"""

from __future__ import annotations

import numpy as np
from elasticity import NAMES, Displacements
from ngsolve import (
    CF,
    VOL,
    BilinearForm,
    GridFunction,
    InnerProduct,
    IntegrationRule,
    Parameter,
    ds,
    dx,
    specialcf,
    x,
    y,
    z,
)
from press import neo_hooke
from report_bounds import CONDITION, Rounding
from report_case import Case, Outcome, Row
from report_pictures import Bodies, Figure
from scipy.optimize import root

from ngslac import ContactSolver, LACContact, LACSpace, LoadStepper
from ngslac.meshes import TwoBlocks, TwoBlocks3D

MATERIALS = {"upper": (40.0, 60.0), "lower": (25.0, 70.0)}  # mu, lame
SPRING = 1e3
# Without friction a block of width 1 becomes as wide as one of width 1.25 / 1.15.
FREE, STICK = (1.25, 1.15), (1.15, 1.15)
OVERHANG = (FREE[0] / FREE[1] - 1) / 2
CELLS = [
    ("hex", "hex", "P1"),
    ("tet", "hex", "P1"),
    ("prism", "tet", "P1"),
    ("tet", "prism", "P1bubble"),
    ("hex", "prism", "P2"),
    ("tet", "hex", "P2"),
]


def Piola(F, mu, lame):
    """First Piola-Kirchhoff stress (d, d)."""
    inverse = np.linalg.inv(F).T
    return mu * (F - inverse) + lame * np.log(np.linalg.det(F)) * inverse


def Gradients(stretches, total):
    """Deformation gradients of the upper and the lower block of equal heights.

    Parameters
    ----------
    stretches : (2,)
        Along the interface, of the upper and the lower block; both directions in 3D.
    total : (d,)
        Where a line across both blocks goes, per height of one block: twice the normal where
        nothing happens.
    """
    d = len(total)

    def Both(upper):
        both = [stretch * np.eye(d) for stretch in stretches]
        both[0][:, -1], both[1][:, -1] = upper, total - upper
        return both

    def Imbalance(upper):
        """Of the forces on the interface, both per area of the current configuration."""
        one, other = (
            Piola(F, *material)[:, -1] / F[0, 0] ** (d - 1)
            for F, material in zip(Both(upper), MATERIALS.values(), strict=True)
        )
        return one - other

    upper = root(Imbalance, total / 2, tol=1e-13).x
    assert np.abs(Imbalance(upper)).max() <= 1e-11
    return Both(upper)


class Block:
    """The exact solution of one block, as numbers and as functions that follow them."""

    def __init__(self, dim, origin, rotation, material):
        self.material, self.rotation, self.origin = material, rotation, rotation @ origin
        self.F, self.P = np.eye(dim), np.zeros((dim, dim))
        self._parameters = [
            [Parameter(v) for v in values.ravel()] for values in (self.F, self.P, self.origin)
        ]
        F, P, c = (CF(tuple(p)) for p in self._parameters)
        X = CF((x, y, z)[:dim])
        F = F.Reshape((dim, dim))
        self.displacement = F * (X - CF(tuple(self.origin))) + c - X
        self.stress = P.Reshape((dim, dim))

    def Set(self, F, place):
        """Gradient in the frame of the blocks, and where the origin goes."""
        self.F, self.P = F, Piola(F, *self.material)
        R = self.rotation
        values = (R @ F @ R.T, R @ self.P @ R.T, R @ place)
        for parameters, value in zip(self._parameters, values, strict=True):
            for p, v in zip(parameters, np.ravel(value), strict=True):
                p.Set(v)


class LargePatch:
    """Blocks of height 1 on all outer faces of which act the exact tractions.

    Springs hold what the tractions leave free: normal to all outer faces, or, where the blocks
    `stick`, in all directions above and below. At the exact solution they carry nothing.
    """

    def __init__(self, mesh, kind, *, stick, rotation=None):
        V = Displacements(mesh, kind)
        self.mesh, self.dim = V.mesh, V.mesh.dim
        self.stretches = np.array(STICK if stick else FREE)
        aside = (0.15, 0.1)[: self.dim - 1] if stick else (0.0,) * (self.dim - 1)
        self.total = np.array([*aside, 1.4])
        self.rotation = np.eye(self.dim) if rotation is None else rotation
        X = V * LACSpace(V, slave="slave")
        (u, lam), (v, _) = X.TnT()
        self.middle = np.array([0.5] * (self.dim - 1) + [0.0])
        self.up = np.eye(self.dim)[-1]
        origins = {"upper": self.middle, "lower": self.middle - self.up}
        self.blocks = {
            name: Block(self.dim, origin, self.rotation, MATERIALS[name])
            for name, origin in origins.items()
        }
        a, self.gf, self.load = BilinearForm(X), GridFunction(X), Parameter(0.0)
        N = specialcf.normal(self.dim)
        for name, block in self.blocks.items():
            a += neo_hooke(u, dx(name), mu=block.material[0], lame=block.material[1])
            end = "top" if name == "upper" else "bottom"
            sides = f"{end}|(left|right|front|back)_{name}"
            a += -InnerProduct(block.stress * N, v) * ds(sides)
            off = u - block.displacement
            a += SPRING * (off * N) * (v * N) * ds(sides)
            if stick:
                a += SPRING * InnerProduct(off, v) * ds(end)
        law = {"friction": 0.8} if stick else {}
        self.contact = LACContact(u, lam, master="master", finite=True, **law)
        solver = ContactSolver(a, self.gf, self.contact)
        stepper = LoadStepper(solver, self.load, prescribe=self.Prescribe)
        stepper.Integrate(steps=4, printing=False, tol=1e-12)
        self.contact.Evaluate(self.gf)

    def Prescribe(self, _):
        t = self.load.Get()
        total = 2 * self.up + t * (self.total - 2 * self.up)
        upper, lower = Gradients(1 + t * (self.stretches - 1), total)
        self.blocks["lower"].Set(lower, self.middle - self.up)
        self.blocks["upper"].Set(upper, self.middle - self.up + lower[:, -1])

    def Errors(self):
        """Largest ones of displacement (at nodes and inside), traction (relative) and gap."""
        exact = self.mesh.MaterialCF({n: b.displacement for n, b in self.blocks.items()})
        off = self.gf.components[0] - exact
        shapes = {el.type for el in self.mesh.Elements(VOL)}
        rules = {shape: IntegrationRule(shape, 4) for shape in shapes}
        table, P = self.contact.Table(), self.blocks["upper"].P
        traction, pressure = self.rotation @ P @ -self.up, self.up @ P @ -self.up
        size = np.linalg.norm(traction)
        return {
            "displacement": np.abs(off(self.mesh.MapToAllElements(rules, VOL))).max(),
            "traction": np.abs(table["traction"] - traction).max() / size,
            "pressure": np.abs(table["pressure"] - pressure).max() / size,
            "gap": np.abs(table["gap"]).max(),
            "area": np.abs(table["area"] / table["fullarea"] - 1).max(),
        }


def Solved(law, kind, cells=None, *, turn=None, **options):
    """In four steps; in 3D with `cells`; `turn` is the rotation (d, d) of the mesh."""
    if law == "frictionless":
        options |= {"overhang": OVERHANG, "aligned": False}
    n = (2, 1) if kind == "P2" else (4, 3)
    mesh = TwoBlocks3D(*cells, *n, **options) if cells else TwoBlocks(h_slave=0.25, **options)
    return LargePatch(mesh, kind, stick=law == "stick", rotation=turn)


def PatchLarge(quick):
    kinds, cells, rows = ["P2"] if quick else NAMES, CELLS[:1] if quick else CELLS, []
    stiff = max(2 * mu + lame for mu, lame in MATERIALS.values())
    condition = CONDITION * max(1.0, SPRING / stiff)
    bounds = {
        "displacement": Rounding(condition=condition),
        "pressure": Rounding(condition=condition, scale=stiff),
        "gap": Rounding(condition=condition),
    }
    for law in ("frictionless", "stick"):
        flat = [(kind, None) for kind in kinds]
        for dim, problems in (("2D", flat), ("3D", [(kind, c) for *c, kind in cells])):
            errors = [Solved(law, *problem).Errors() for problem in problems]
            for key in ("displacement", "pressure", "gap"):
                text = f"{dim}, {law}: {key}, largest error of {len(errors)} problems"
                rows.append(Row(text, max(error[key] for error in errors), 0, bounds[key]))

    def Draw(left, right):
        problem = Solved("frictionless", "P2")
        Bodies(left, problem.mesh, problem.gf.components[0], factor=0)
        Bodies(right, problem.mesh, problem.gf.components[0])
        left.set_title("reference")
        right.set_title("compressed by 30 %, frictionless")

    caption = "The surfaces slide over each other until both blocks are equally wide."
    return Outcome(rows, Figure(Draw, columns=2, sharex=True, sharey=True), caption)


CASES = [
    Case(
        "patch-large",
        "Patch test with large strains",
        "Two neo-Hookean blocks, compressed by 30 % with one deformation gradient in each. "
        "Without friction the stretches along the interface differ, and the surfaces slide over "
        "each other by a tenth of their length; with friction both are stretched and sheared "
        "alike and stick.",
        "The homogeneous deformation, from two equations for the forces on the interface.",
        "pytest tests/validation/test_patch_large.py",
        PatchLarge,
    ),
]
