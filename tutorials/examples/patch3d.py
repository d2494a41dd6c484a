"""Patch test in 3D: every element shape, order and partition of the slave surface.

Two blocks (E = 2000, nu = 0.3) lie on each other with a pressure of 25 and non-matching meshes. The
stress is constant, so every method that deserves the name reproduces it up to rounding: in the
bodies as well as in the multipliers, on any interface (code_aster, SSNP170). Start it with::

    python tutorials/examples/patch3d.py --out results

Each case is computed with a horizontal interface, and with an inclined one, irregular meshes,
another element shape below and all of it rotated.
"""

import math
from dataclasses import dataclass

import numpy as np
from command import Main, NotNegative
from ngsolve import *
from pictures import Curves, Show

from ngslac import *
from ngslac.materials import Stress
from ngslac.meshes import TwoBlocks3D
from ngslac.meshes.geometry import RotationMatrix

YOUNG, POISSON, PRESSURE = 2000.0, 0.3, 25.0
PARTITIONS = ("agglomerated", "bubble", "split")
BELOW = {"tet": "hex", "hex": "prism", "prism": "pyramid", "prism_side": "tet", "pyramid": "tet"}
ELEMENTS = [(k, p) for k in BELOW for p in (1, 2, 3) if p < 3 or k == "tet"]
HELD = "bottom|left_upper"
TURN, SLOPE, AZIMUTH = ((1.0, 2.0, -0.5), 67.0), 20.0, 30.0  # of the oblique interface


@dataclass(frozen=True)
class Case:
    """One patch test."""

    element: str = "tet"  # shape in the slave body; prism_side: quadrilaterals on the interface
    order: int = 1  # of the displacement
    partition: str = "bubble"  # agglomerated: of the space as it is; split: with split slave faces
    oblique: bool = False  # inclined interface, irregular meshes, another shape below, all rotated
    friction: float = 0.0  # the interface carries half the shear at which it slides

    @property
    def name(self):
        where, family = "oblique" if self.oblique else "flat", "PQ"[self.element == "hex"]
        return f"{family}{self.order} {self.element} {self.partition} {where}"

    @property
    def axes(self):
        """Two tangents of the interface, and the normal out of the slave, as columns."""
        rise, a = math.tan(math.radians(SLOPE)) * self.oblique, math.radians(AZIMUTH)
        normal = np.array([rise * math.cos(a), rise * math.sin(a), -1.0])
        normal /= np.linalg.norm(normal)
        tangent = np.cross(normal, [0.3, 0.8, 0.1])
        tangent /= np.linalg.norm(tangent)
        axes = np.column_stack([tangent, np.cross(normal, tangent), normal])
        return RotationMatrix(TURN) @ axes if self.oblique else axes

    @property
    def stress(self):
        """The exact stress (3, 3)."""
        shear = 0.5 * self.friction * PRESSURE
        local = np.array([[-7, 2, shear], [2, 5, 0], [shear, 0, -PRESSURE]])
        return self.axes @ local @ self.axes.T

    def Mesh(self):
        """The two blocks; order 1 without bubbles needs finer ones for two macro-elements."""
        n = (4, 3) if (self.order, self.partition) == (1, "agglomerated") else (3, 2)
        if not self.oblique:
            return TwoBlocks3D(self.element, None, n, n[::-1])
        options = dict(shape="oblique", slope=SLOPE, azimuth=AZIMUTH, perturb=0.2, rotation=TURN)
        return TwoBlocks3D(self.element, BELOW[self.element], n, n[::-1], **options)

    def Space(self):
        """Displacement space, on a new mesh if that is split."""
        if self.partition not in PARTITIONS:
            raise ValueError(f"partition must be one of {PARTITIONS}, but is {self.partition!r}")
        mesh = self.Mesh()
        if self.partition == "split":
            mesh = SplitSlaveFaces(mesh, "slave")
        if self.partition == "bubble":
            return BubbleVectorH1(mesh, order=self.order, slave="slave", dirichlet=HELD)
        return VectorH1(mesh, order=self.order, dirichlet=HELD)


def Constant(array):
    return CF(tuple(array.ravel()), dims=array.shape)


def Load(case, mesh, v):
    """The work of the surface tractions outside of the interface.

    NGSolve cuts pyramids off below their apex, which makes an error of 1e-10 in Gauss' theorem and
    thus in any patch test, also without contact. With them it is computed from the volume.
    """
    stress, normal = Constant(case.stress), specialcf.normal(3)
    if any(el.type == ET.PYRAMID for el in mesh.Elements(VOL)):
        inside = InnerProduct(stress, Grad(v)) * dx
        return inside - InnerProduct(stress * normal, v) * ds("slave|master")
    free = set(mesh.GetBoundaries()) - {"slave", "master", *HELD.split("|")}
    return InnerProduct(stress * normal, v) * ds("|".join(free))


def Solve(case):
    """The displacement, the contact, and the largest deviations from the constant stress.

    In the bodies and in the multipliers, relative to the largest stress.
    """
    V = case.Space()
    X = V * LACSpace(V, slave="slave")
    (u, lam), (v, _) = X.TnT()
    a, gf = BilinearForm(X), GridFunction(X)
    a += InnerProduct(Stress(Sym(Grad(u)), YOUNG, POISSON), Sym(Grad(v))) * dx
    contact = LACContact(u, lam, master="master", friction=case.friction or None)
    strain = ((1 + POISSON) * case.stress - POISSON * np.trace(case.stress) * np.eye(3)) / YOUNG
    gf.components[0].Set(Constant(strain) * CF((x, y, z)), definedon=V.mesh.Boundaries(HELD))
    load = LinearForm(Load(case, V.mesh, v)).Assemble()
    ContactSolver(a, gf, contact, rhs=load.vec).Solve(tol=1e-13, printing=False)

    points = [(0.02, 0.03, 0.05), (0.9, 0.05, 0.02), (0.31, 0.3, 0.2), (0.05, 0.1, 0.8)]
    rules = dict.fromkeys((ET.TET, ET.PYRAMID, ET.PRISM, ET.HEX), IntegrationRule(points, [0] * 4))
    stress = Stress(Sym(Grad(gf.components[0])), YOUNG, POISSON)
    values = stress(contact.mesh.MapToAllElements(rules, VOL)).reshape(-1, 3, 3)
    table, size = contact.Table(), np.abs(case.stress).max()
    traction = table["traction"] - table["normal"] @ case.stress
    figures = {"name": case.name, "macros": len(table["area"])}
    figures["stress_error"] = float(np.abs(values - case.stress).max() / size)
    figures["multiplier_error"] = float(np.abs(traction).max() / size)
    return gf.components[0], contact, figures


def Cases(friction=0.0):
    """All cases: every element and order, every partition, flat and oblique."""
    kinds = [(*element, partition) for element in ELEMENTS for partition in PARTITIONS]
    return [Case(*kind, oblique, friction) for kind in kinds for oblique in (False, True)]


def Run(friction: NotNegative = 0.0, cases=None, out=None):
    """Solve all cases, or some.

    friction : coefficient of friction
    """
    rows = []
    for case in cases or Cases(friction):
        displacement, contact, figures = Solve(case)
        rows.append(figures)
        line = "{name:<34}{stress_error:9.1e}{multiplier_error:9.1e}"
        print(line.format(**figures), flush=True)
    kinds, number = ("stress_error", "multiplier_error"), range(len(rows))
    errors = {kind: ([row[kind] for row in rows], number, ".") for kind in kinds}
    worst = float(np.max([values for values, *_ in errors.values()]))  # which does not lose a NaN
    print(f"largest relative error {worst:.1e} in {len(rows)} cases")
    assert worst < 1e-9, rows
    panel = Curves("error", "case", xscale="log", **errors)
    Show(out, "patch3d", displacement, panel, slave=contact)
    return {"max_error": worst, "cases": rows}


main = Main(Run)
