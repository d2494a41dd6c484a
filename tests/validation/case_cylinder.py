"""A cylinder on a block with friction: Cattaneo and Mindlin's reversal, and Spence's growing load.

The cylinder has the radius 50 mm and lies on the block of the paper's Hertz problem, under loads so
low that both are half-planes to the contact; the bodies are linearly elastic, in plane strain.
Forces are in N/mm, stresses in MPa.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from elasticity import Material, Pair, Sorted
from exact_spence import SpenceLine
from ngsolve import Integrate, Parameter, VectorH1, ds, dx, y
from problems_punch import CoupledPunch, StickRatio
from report_bounds import Element, Means, MeshSpread, Tolerance
from report_case import Case, Outcome, Row
from report_pictures import BLUE, GREY, INK, ORANGE, Figure, Profile

from ngslac.meshes import HertzMesh
from ngslac.reference import CattaneoMindlin, HertzLine

RADIUS = 50.0
OPEN, STICK, SLIP = 0, 1, 2


@dataclass(frozen=True, kw_only=True)
class Cylinder:
    """Normal force of the whole contact, edge length and arc of the slave side, materials.

    `half` of the model is enough for loads without shear.
    """

    force: float
    friction: float
    h: float
    zone: float
    young: tuple = (210e3, 70e3)  # of the cylinder and of the block
    half: bool = True

    @property
    def hertz(self):
        """Hertz' solution at the full load."""
        young1, young2 = self.young
        bodies = dict(radius1=RADIUS, young1=young1, nu1=0.3, young2=young2, nu2=0.3)
        return HertzLine(force=self.force, **bodies)


class Model:
    """The discrete problem, with factors of the normal and of the shear force.

    The shear force is a body force without moment about the contact, linear in y: it does not make
    the cylinder roll, and the contact pressure stays centred.
    """

    def __init__(self, problem):
        self.problem = problem
        mesh = HertzMesh(problem.h, zone=problem.zone, half=problem.half, grading=0.3)
        V = VectorH1(mesh, order=2, dirichletx="sym|bottom", dirichlety="bottom")
        young = mesh.MaterialCF(dict(zip(("cylinder", "block"), problem.young, strict=True)))
        self.pair = pair = Pair(V, Material(young, 0.3), friction=problem.friction)
        self.normal, self.shear, self.contact = Parameter(0.0), Parameter(0.0), pair.contact
        top = -0.5 * problem.force if problem.half else -problem.force
        pair.load += self.normal * top * pair.v[1] * ds(definedon=mesh.BBoundaries("load"))
        if not problem.half:
            disc = mesh.Materials("cylinder")
            area, first, second = (Integrate(y**k, mesh, order=6, definedon=disc) for k in range(3))
            unit = np.linalg.solve([[area, first], [first, second]], [1.0, 0.0])
            pair.load += -self.shear * (unit[0] + unit[1] * y) * pair.v[0] * dx("cylinder")

    def _Step(self):
        self.pair.Solve(tol=1e-10)
        self.contact.Commit(self.pair.gf)
        return Macros.Of(self.contact.Table(), half=self.problem.half)

    def Press(self, steps):
        """Raise the normal force such that the half width of the contact grows by equal parts."""
        for k in range(1, steps + 1):
            self.normal.Set((k / steps) ** 2)
            macros = self._Step()
        return macros

    def Shear(self, force):
        """Change the shear force: `force` becomes the resultant of the tractions on the slave."""
        self.shear.Set(force)
        return self._Step()


@dataclass(frozen=True)
class Macros:
    """Macro-elements by x: ends, status, pressure, traction and slip along x on the slave side."""

    start: np.ndarray
    end: np.ndarray
    status: np.ndarray
    pressure: np.ndarray
    traction: np.ndarray
    slip: np.ndarray

    @classmethod
    def Of(cls, table, *, half):
        table = Sorted(table)
        arc = np.concatenate([[0.0], np.cumsum(table["fullarea"])])
        nodes = RADIUS * np.sin((arc if half else arc - arc[-1] / 2) / RADIUS)
        normal, traction = table["normal"], table["traction"]
        along = normal[:, 0] * traction[:, 1] - normal[:, 1] * traction[:, 0]
        values = table["status"], table["pressure"], along, table["slip"][:, 0]
        return cls(nodes[:-1], nodes[1:], *values)

    @property
    def middle(self):
        return 0.5 * (self.start + self.end)

    @property
    def size(self):
        """Of the largest one."""
        return np.max(self.end - self.start)

    def Zone(self, *status):
        """Ends of the interval of macro-elements with one of these statuses; no holes allowed."""
        where = np.flatnonzero(np.isin(self.status, status))
        assert np.all(np.diff(where) == 1)
        return self.start[where[0]], self.end[where[-1]]


# ---------------------------------------------------------------- Cattaneo and Mindlin
#
# Equal materials; the mesh has 41 macro-elements in the half width of the contact, which is 1/800
# of the radius. First the load is raised, then half of it is taken away, then it is reversed.

SHEARED = Cylinder(force=3.5, friction=0.2, h=0.0015, zone=0.08, young=(105e3, 105e3), half=False)
HERTZ, LIMIT = SHEARED.hertz, SHEARED.friction * SHEARED.force
LOADED = CattaneoMindlin(hertz=HERTZ, shear=0.6 * LIMIT, friction=SHEARED.friction)
HISTORY = [LOADED, LOADED.Reverse(0.3 * LIMIT), LOADED.Reverse(-0.4 * LIMIT)]


def TractionErrors(macros, exact):
    """Differences of the tangential tractions from the exact means, over F p0."""
    means = exact.MeanTraction(macros.start, macros.end)
    return (macros.traction - means) / (SHEARED.friction * HERTZ.peak)


def _OfShearedState(macros, state, shear):
    text = f"Q = {state.shear / LIMIT:+.1f} F P"
    end, halfwidth = np.array(macros.Zone(STICK)), HERTZ.halfwidth
    ratio = abs(end[np.abs(np.abs(end) - state.stick).argmax()]) / halfwidth
    error = np.sqrt(np.mean(TractionErrors(macros, state) ** 2))
    macro, stick = Element(macros.size / halfwidth), state.stick / halfwidth
    spread = MeshSpread(state.Traction, macros.start, macros.end)
    means = Means(spread / (SHEARED.friction * HERTZ.peak))
    resultant = f"{text}: resultant along the contact over P"
    return [
        Row(f"{text}: end of the stick zone over a", ratio, stick, macro),
        Row(f"{text}: error of the traction over F p0, in L2", error, 0, means),
        Row(resultant, shear / SHEARED.force, state.shear / SHEARED.force, Tolerance()),
    ]


def Mindlin(quick):
    model = Model(replace(SHEARED, h=4 * SHEARED.h) if quick else SHEARED)
    model.Press(3)
    rows, found = [], []
    for state in HISTORY:
        found.append(model.Shear(state.shear))
        rows += _OfShearedState(found[-1], state, model.contact.Force()[0])

    def Draw(*axes):
        a, scale = HERTZ.halfwidth, SHEARED.friction * HERTZ.peak
        x = np.linspace(-1.1, 1.1, 1001)
        for ax, macros, state in zip(axes, found, HISTORY, strict=True):
            spans = macros.start / a, macros.end / a
            Profile(ax, *spans, macros.traction / scale, macros.status)
            ax.plot(x, state.Traction(x * a) / scale, color=INK, lw=0.8, label="exact")
            title = f"Q = {state.shear / LIMIT:+.1f} F P"
            ax.set(xlim=(-1.15, 1.15), xlabel="x / a", title=title)
        axes[0].set_ylabel("traction / (F p0)")
        axes[0].legend(loc="lower center")

    caption = "Tractions after the first loading, after half of it is taken back, and reversed."
    return Outcome(rows, Figure(Draw, columns=3, sharey=True, size=(10, 3.4)), caption)


# ---------------------------------------------------------------- Spence
#
# With 20 steps and 21 macro-elements in the half width the contact grows by one macro-element in
# each step. With fewer steps the stick zone is smaller (0.76 of the contact with 5 steps), with 40
# the same but for one macro-element. Near its end at k the ratio |tau|/(F p) approaches 1 like
# (k - x/a)^(3/2): the end of the stick zone is more sensitive to errors than the tractions are.

# Start of the search for the stick ratio of the coupled problem.
GUESS = {0.1: 0.4, 0.2: 0.9}
# A hundredth of the paper's load: contact width over radius 1/80.
LOW = Cylinder(force=350.0, friction=0.2, h=0.03, zone=0.8)
# A tenth of its size, where the contact is flat: 1/800.
FLAT = {F: Cylinder(force=3.5, friction=F, h=0.003, zone=0.07) for F in GUESS}


class Run:
    """A problem, pressed in steps; sizes are over the half width of the contact."""

    def __init__(self, problem, steps=20):
        self.problem, self.halfwidth, model = problem, problem.hertz.halfwidth, Model(problem)
        self.macros = model.Press(steps)
        self.force = np.asarray(model.contact.Force())
        self.spence = SpenceLine(hertz=problem.hertz, friction=problem.friction)
        self.macro, self.stick = self.macros.size / self.halfwidth, self.macros.Zone(STICK)[1]
        self.stick /= self.halfwidth

    def Ratio(self):
        """Positions x/a and |tau|/(F p), without the first macro-elements and the last.

        The first ones came into contact in the first steps, when they were the whole contact.
        """
        x = self.macros.middle / self.halfwidth
        inner = (x > 0.15) & (x < 0.95)
        ratio = np.abs(self.macros.traction) / self.problem.friction
        return x[inner], ratio[inner] / self.macros.pressure[inner]


def Spence(quick):
    problems = {0.2: replace(FLAT[0.2], h=0.006)} if quick else FLAT
    runs = {friction: Run(problem) for friction, problem in problems.items()}
    rows, exact = [], {}
    for friction, run in runs.items():
        guess = GUESS[friction]
        punch = CoupledPunch(beta=abs(run.problem.hertz.beta), friction=friction)
        ratio = StickRatio(punch.beta, friction, guess)
        x, computed = run.Ratio()
        exact[friction] = x, computed, punch.HertzFriction(x, guess)
        error = float(np.sqrt(np.mean((computed - exact[friction][2]) ** 2)))
        text, closed = f"friction {friction:g}", run.spence.ratio
        coupled, macro = f"{text}: stick ratio c/a, coupled equations", Element(run.macro)
        half = run.macro / 2
        spread = MeshSpread(lambda x, p=punch, g=guess: p.HertzFriction(x, g), x - half, x + half)
        rows += [
            Row(coupled, run.stick, ratio, macro),
            Row(f"{text}: the same, Spence's closed form", run.stick, closed, macro),
            Row(f"{text}: error of |tau|/(F p) in L2", error, 0, Means(spread)),
        ]

    def Draw(ax):
        for colour, (friction, run) in zip((BLUE, ORANGE), runs.items(), strict=False):
            x, computed, coupled = exact[friction]
            ax.plot(x, computed, "o", ms=4, color=colour, label=f"computed, friction {friction:g}")
            ax.plot(x, coupled, color=INK, lw=0.9, label="coupled equations")
            at = np.linspace(0.01, 0.999, 300)
            closed = np.abs(run.spence.zone.HertzFriction(at)) / friction
            ax.plot(at, closed, color=GREY, lw=0.9, ls="--", label="Spence's closed form")
        ax.set(xlabel="x / a", ylabel="|tau| / (F p)")
        ax.legend()

    caption = "Share of the friction that is used, over the contact; 1 is slip."
    return Outcome(rows, Figure(Draw, size=(6.5, 3.8)), caption)


CASES = [
    Case(
        "cattaneo2d",
        "Cattaneo and Mindlin in 2D, with a reversal",
        "Two cylinders of equal material are pressed together, then pushed sideways to 0.6 of "
        "what friction can carry, back to half of that, and reversed. The stick zone and the "
        "tractions remember the way (hysteresis).",
        "Mindlin, J. Appl. Mech. 16 (1949); Mindlin and Deresiewicz, J. Appl. Mech. 20 (1953); as "
        "`CattaneoMindlin` and `MindlinReversal`.",
        "pytest tests/validation/test_cylinder.py",
        Mindlin,
    ),
    Case(
        "spence",
        "Stick and slip under a growing load",
        "A steel cylinder on an aluminium block: under pressure the softer surface moves further "
        "inwards, friction holds it in a stick zone that keeps its share of the contact. The load "
        "is so low that both bodies are half-planes. Spence's closed form takes the pressure "
        "from the problem without friction; the coupled equations do not. Differences of the "
        "stick ratio are accepted up to one macro-element.",
        "Spence, Proc. Camb. Phil. Soc. 73 (1973) and J. Elasticity 5 (1975), as in "
        "`tests/reference/exact_spence.py`; coupled equations solved by quadrature "
        "(`tests/validation/problems_punch.py`).",
        "pytest tests/validation/test_cylinder.py",
        Spence,
    ),
]
