"""A ball that sticks to a half-space: pull-off by a law with adhesion, against JKR theory."""

from __future__ import annotations

from functools import cache

import numpy as np
from elasticity import Sorted
from netgen.occ import Glue, MoveTo, OCCGeometry
from ngsolve import (
    IfPos,
    Mesh,
    Parameter,
    VectorH1,
)
from posed import posed, revolved
from report_bounds import Exact, Neglected
from report_case import Case, Outcome, Row
from report_pictures import INK, ORANGE, Figure

from ngslac import Law, tools

# The radius of the ball and E* are 1; the work of adhesion is such that contact of this radius
# needs no force.
FREE, NU = 0.1, 0.3
WORK = 2 * FREE**3 / (9 * np.pi)
UNIT = np.pi * WORK
SHORT = 3.0  # Maugis' parameter: how short the reach of adhesion is; infinite for JKR
PEAK = SHORT / (9 / (2 * np.pi * WORK)) ** (1 / 3)
FIRST, LAST = 1e-4 * PEAK, 2 * WORK / PEAK
DEPTHS = (0.006, 0.0045, 0.0035, 0.003, 0.002, 0.001, 0.0, -0.0005, -0.001, -0.0015, -0.002, -0.005)
FEW = (0.0035, 0.003, 0.001, -0.0005, -0.001, -0.0015, -0.005)


def Force(radius):
    """Of JKR theory, over pi w R."""
    return (4 / 3 * radius**3 - np.sqrt(8 * np.pi * WORK * radius**3)) / UNIT


def Depth(radius):
    return radius**2 - np.sqrt(2 * np.pi * WORK * radius)


def Transition():
    """Pull-off force over pi w R, and radius without force over JKR's, for Maugis' parameter."""
    force, radius = 4.04 * SHORT**1.4, 2.28 * SHORT**1.3
    pull = 7 / 4 - (force - 1) / (force + 1) / 4
    return pull, (1.54 + 0.279 * (radius - 1) / (radius + 1)) / 6 ** (1 / 3)


def Sticky(z):
    """A triangle of tractions whose area is the work of adhesion, and a stiff pressure."""
    torn = IfPos(LAST - z.gap, PEAK * (LAST - z.gap) / (LAST - FIRST), 0)
    return IfPos(z.gap - FIRST, torn, PEAK / FIRST * z.gap) * z.normal


@cache
def Pulled(depths, h=0.001):
    """Forces on the ball, over pi w R, and radii of contact at the depths."""
    parts = MoveTo(0, -1).Rectangle(0.13, 1), MoveTo(0.13, -1).Rectangle(0.87, 1)
    body = Glue([part.Face() for part in parts])
    body.edges.name = "free"
    for edge in body.edges:
        if edge.center.x < 1e-9:
            edge.name = "axis"
        elif edge.center.y < -1 + 1e-9:
            edge.name = "bottom"
        elif edge.center.y > -1e-9 and edge.center.x < 0.13:
            edge.name, edge.maxh = "slave", h
    mesh = Mesh(OCCGeometry(body, dim=2).GenerateMesh(maxh=0.1, grading=0.25))
    V = VectorH1(mesh, order=2, dirichlet="bottom", dirichletx="axis")
    depth = Parameter(0)
    ball = tools.Sphere((0, 1), 1).Moved(shift=(0, -depth))
    law = {"axisymmetric": True, "obstacle": ball, "finite": True, "law": Law(Sticky)}
    problem = posed(V, revolved(1 - NU**2, NU), load=depth, **law)
    contact, stepper = problem.contact, problem.stepper()
    found = []
    for goal in depths:
        stepper.Integrate(goal, steps=1, printing=False)
        table = Sorted(contact.Table())
        radius = table["x"][np.argmin(table["pressure"]), 0]
        found.append((-contact.Force()[1] / UNIT, radius))
    return np.array(found).T


def Adhesion(quick):
    depths = FEW if quick else DEPTHS
    forces, radii = Pulled(depths)
    pull, free = Transition()
    shape = Neglected(0.01, "the law is a triangle, that of the theory a rectangle; far sides")
    rows = [Row("pull-off force over pi w R", -forces.min(), pull, shape)]
    rows.append(Row("the same, JKR", -forces.min(), 1.5))
    last = np.argmin(forces)
    without = np.interp(0, forces[last::-1], radii[last::-1])
    faces = Neglected(0.02, "a face, and steps of the depth")
    rows.append(Row("radius without force", without, free * FREE, faces))
    rows.append(Row("radius at pull-off, JKR", radii[last], FREE / 4 ** (1 / 3)))
    rows.append(Row("force after that", forces[-1], 0, Exact()))

    def Draw(ax):
        radius = np.linspace(0.04, 0.115, 200)
        ax.plot(1e3 * Depth(radius), Force(radius), color=INK, lw=0.8, label="JKR")
        ax.plot(1e3 * np.array(depths), forces, "o", ms=4, color=ORANGE, label="computed")
        ax.set(xlabel="depth over the radius, 1e-3", ylabel="force over pi w R")
        ax.legend()

    caption = "Force over depth as the ball is drawn back, until it snaps off (last point)."
    return Outcome(rows, Figure(Draw, size=(6, 3.4)), caption)


CASES = [
    Case(
        "adhesion",
        "A ball that sticks is pulled off",
        "A rigid ball is pressed into an elastic half-space and drawn back. The law has a stiff "
        "pressure and an adhesion of a short reach, in three lines; the end is a snap. "
        "Axisymmetric.",
        "Maugis (1992) by the formulas of Carpick, Ogletree and Salmeron (1999); Johnson, Kendall "
        "and Roberts (1971) for adhesion without reach.",
        "pytest tests/validation/test_cases.py -k adhesion",
        Adhesion,
    )
]
