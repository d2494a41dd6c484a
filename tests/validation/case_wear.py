"""Wear as a history that moves the gap: a ball that wears to a cap, a clutch that runs in.

What slides goes round about the axis, in the section nothing moves: the way is that of the load.
"""

from __future__ import annotations

from functools import cache

import numpy as np
from elasticity import Sorted
from netgen.occ import Circle, Glue, MoveTo, OCCGeometry, Rectangle, Y
from ngsolve import (
    Integrate,
    Mesh,
    Parameter,
    VectorH1,
    ds,
    pi,
    x,
)
from posed import posed, revolved
from report_bounds import Element, Neglected, Tolerance
from report_case import Case, Outcome, Row
from report_pictures import INK, ORANGE, Figure

from ngslac import LoadStepper, tools


class Runner:
    """A body of revolution that a force on its top presses on a plane, which wears it off.

    `rate` is the depth for each unit of the way and of the pressure, a function of the radius.
    """

    def __init__(self, mesh, young, nu, force, rate):
        held = {"dirichletx": "axis"} if "axis" in mesh.GetBoundaries() else {}
        V = VectorH1(mesh, order=2, **held)
        area = Integrate(2 * pi * x * ds("top"), mesh)

        def Pressed(u, v, load):
            return force / area * 2 * pi * x * v[1] * ds("top")

        def Worn(z):
            return z.History("worn", lambda worn: worn + rate * z.pressure * z.dt)

        law = {"obstacle": tools.Plane((0, 0), (0, 1)), "finite": True, "offset": Worn}
        problem = posed(V, revolved(young, nu), Pressed, axisymmetric=True, **law)
        self.contact, solver = problem.contact, problem.solver()
        solver.Solve(printing=False)
        self.stepper = LoadStepper(solver, Parameter(0))

    def Run(self, ways):
        """Tables at these ways, each in the order of the radius."""
        tables = [Sorted(self.contact.Table())]
        for way in ways:
            self.stepper.Integrate(way, steps=1, printing=False)
            tables.append(Sorted(self.contact.Table()))
        return tables


# --- a ball --------------------------------------------------------------------------------------

RADIUS, PRESSED, SOFT = 5.0, 10.0, 1e-7  # mm, N, mm2/N
WAYS = (1e4, 1e5)  # mm


def Cap(way):
    """Depth and radius of the flat on a ball that hardly deforms."""
    depth = np.sqrt(SOFT * PRESSED * way / (np.pi * RADIUS))
    return depth, np.sqrt(2 * RADIUS * depth)


@cache
def WornBall(h, steps):
    """Tables at ways that grow by the same factor, from 100 mm to the last."""
    cap = Circle((0, RADIUS), RADIUS).Face() * Rectangle(2, 2).Face()
    for edge in cap.edges:
        edge.name = "axis" if edge.center.x < 1e-6 else "top" if edge.center.y > 1 else "slave"
    cap.edges["slave"].maxh = h
    mesh = Mesh(OCCGeometry(cap, dim=2).GenerateMesh(maxh=0.3)).Curve(2)
    ways = np.geomspace(100, WAYS[-1], steps)
    return ways, Runner(mesh, 210e3, 0.3, PRESSED, SOFT).Run(ways)[1:]


def Ball(quick):
    ways, tables = WornBall(0.05, 7 if quick else 31)
    rows = []
    for goal in WAYS:
        number = np.argmin(abs(ways - goal))
        way, table = ways[number], tables[number]
        depth, radius = Cap(way)
        shape = Neglected(0.01, "depth over radius of the ball, steps of a factor 1.26")
        rows.append(Row(f"depth after {way / 1000:.0f} m [mm]", table["worn"].max(), depth, shape))
        worn = table["worn"] > 1e-6 * depth
        flat = np.sqrt(table["area"][worn].sum() / np.pi)
        size = np.diff(np.sqrt(np.cumsum(table["area"]) / np.pi))[worn.sum() - 2]
        rows.append(Row("radius of the flat [mm]", flat, radius, Element(size, f"{size:.3f} mm")))
        volume = (table["worn"] * table["area"]).sum()
        exact = Tolerance(1e-10, factor=PRESSED * SOFT * way)
        rows.append(Row("volume [mm3]", volume, SOFT * PRESSED * way, exact))

    def Draw(ax):
        for way, table in zip(ways, tables, strict=True):
            if way < 900 and not quick:
                continue
            depth, radius = Cap(way)
            r = np.linspace(0, radius)
            ax.plot(r, 1e3 * (depth - r**2 / 2 / RADIUS), color=INK, lw=0.8)
            ax.plot(table["x"][:, 0], 1e3 * table["worn"], ".", ms=4, color=ORANGE)
        ax.set(xlabel="radius [mm]", ylabel="depth [um]", xlim=(0, 1.2))

    caption = "Depth of wear over the radius, at all ways from 1 m on (dots), and that of the cap."
    return Outcome(rows, Figure(Draw, size=(6, 3.4)), caption)


# --- a clutch ------------------------------------------------------------------------------------

INNER, OUTER, AXIAL, FRICTION = 10.0, 30.0, 1000.0, 0.3  # mm, mm, N


@cache
def WornClutch(h, steps):
    """Tables of a lining of 4 mm under a stiff plate: new, and as it turns by 1e5 radians."""
    parts = MoveTo(INNER, 0).Rectangle(20, 4), MoveTo(INNER, 4).Rectangle(20, 10)
    body = Glue([part.Face() for part in parts])
    body.faces.Min(Y).name, body.faces.Max(Y).name = "lining", "plate"
    body.edges.name = "free"
    body.edges.Min(Y).name, body.edges.Max(Y).name = "slave", "top"
    body.edges["slave"].maxh = h
    mesh = Mesh(OCCGeometry(body, dim=2).GenerateMesh(maxh=3))
    young = mesh.MaterialCF({"lining": 100, "plate": 2e6})
    return Runner(mesh, young, 0.0, AXIAL, 1e-6 * x).Run(np.geomspace(10, 1e5, steps))


def Clutch(quick):
    tables = WornClutch(1.0, 11 if quick else 16)

    def Torque(table):
        return (FRICTION * table["pressure"] * table["x"][:, 0] * table["area"]).sum()

    new = FRICTION * AXIAL * 2 / 3 * (OUTER**3 - INNER**3) / (OUTER**2 - INNER**2)
    stiff = Neglected(1e-3, "lining over plate, 5e-5, and the middle of a macro-element's radius")
    rows = [Row("torque, new [N mm]", Torque(tables[0]), new, stiff)]
    last = FRICTION * AXIAL * (INNER + OUTER) / 2
    ends = Neglected(1e-3, "what is left of the new profile")
    rows.append(Row("torque, run in [N mm]", Torque(tables[-1]), last, ends))
    product = tables[-1]["pressure"] * tables[-1]["x"][:, 0]
    even = AXIAL / (2 * np.pi * (OUTER - INNER))
    rows.append(Row("least p r, run in [N/mm]", product.min(), even, ends))
    rows.append(Row("largest p r, run in [N/mm]", product.max(), even, ends))

    def Draw(ax):
        r = np.linspace(INNER, OUTER)
        ax.plot(r, even / r, color=INK, lw=0.8, label="p r constant")
        ax.plot(r, 0 * r + AXIAL / np.pi / (OUTER**2 - INNER**2), "--", color=INK, lw=0.8)
        for table in tables[:: 2 if quick else 3]:
            ax.plot(table["x"][:, 0], table["pressure"], ".", ms=4, color=ORANGE)
        ax.set(xlabel="radius [mm]", ylabel="pressure [MPa]")
        ax.legend()

    caption = "Pressures from the new clutch (dashed: uniform) to the one that has run in."
    return Outcome(rows, Figure(Draw, size=(6, 3.4)), caption)


CASES = [
    Case(
        "worn-ball",
        "A ball wears to a cap",
        "A ball of 5 mm is pressed on a plate by 10 N and slides; it wears by Archard's law, "
        "w' = k p |v| with k = 1e-7 mm2/N. Axisymmetric; the elastic contact is 20 times smaller.",
        "Closed form of a stiff ball: volume k F s = pi R h^2, radius sqrt(2 R h).",
        "pytest tests/validation/test_cases.py -k worn-ball",
        Ball,
    ),
    Case(
        "clutch",
        "A clutch runs in",
        "A lining between the radii 10 and 30 mm under a stiff plate and 1000 N wears in "
        "proportion to pressure and speed, until the depth is the same everywhere.",
        "Closed forms of uniform pressure and of uniform wear (p r constant).",
        "pytest tests/validation/test_cases.py -k clutch",
        Clutch,
    ),
]
