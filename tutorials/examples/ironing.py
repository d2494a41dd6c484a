"""Shallow ironing: a die is pressed into a slab and drawn over it with friction.

Plane strain, neo-Hookean bodies (die 6896 MPa, slab 689.6 MPa, nu = 0.32), friction 0.3. The top of
the die goes down by 1 mm (time 0 to 1), of which 0.2 mm are clearance, and then 10 mm to the right
(time 1 to 2): the surfaces slide over dozens of faces. After K. A. Fischer, P. Wriggers, Comput.
Methods Appl. Mech. Engrg. 195 (2006), and code_aster's test SSNP153. Start it with::

    python tutorials/examples/ironing.py --out results

The published forces differ from each other by up to 25 % (vertical) and 90 % (horizontal). Those
computed here are 333 and 423 N/mm down after the indentation and in the middle of the stroke, with
131 N/mm to the right, and change by less than 1 % on finer meshes. Each step should move the die by
half an edge of the slab at most: larger ones can end in another equilibrium, of crumpled elements.
"""

from itertools import pairwise
from typing import Literal

import numpy as np
from command import Communicator, Main, NotNegative
from ngsolve import *
from pictures import Bodies, Curves, Show
from published import PUBLISHED, TIMES

from ngslac import *
from ngslac.materials import NeoHooke
from ngslac.meshes import Distributed, geometry

YOUNG, POISSON = {"die": 6896.0, "slab": 689.6}, 0.32  # MPa
LENGTH, HEIGHT, CLEARANCE = 12.0, 4.0, 0.2  # of the slab, and of the die above it, in mm
DEPTH, STROKE = 1.0, 10.0  # of the top of the die from the time 0 to 1 and 1 to 2, in mm


def IroningMesh(h=0.2, order=2):
    """A die, 1.2 wide on an arc of radius 0.75, above the left end of the slab.

    Boundaries "foot" (the arc), "flank", "top" of the die, "master" (the top of the slab, with the
    edge length h), "bottom", "side". No node of the foot is above a node of the slab.
    """
    left, right, low, high, radius = 0.2, 1.4, 0.5, 1.4, 0.75
    angle, middle = np.arcsin((right - left) / 2 / radius), (left + right) / 2
    foot = max(4, geometry.Divisions(2 * angle * radius, 0.6 * h))
    flank = max(2, foot // 3)
    nodes = middle + radius * np.sin(np.linspace(-angle, angle, foot + 1))
    count = geometry.NonMatchingDivisions(nodes, 0.0, LENGTH, h)
    circle = geometry.Touching(radius)
    sides = [
        geometry.Arc(lambda t: np.add(circle(t), (middle, CLEARANCE)), -angle, angle, "foot", foot),
        geometry.Line((right, low), (right, high), "flank", flank),
        geometry.Line((right, high), (left, high), "top", flank),
        geometry.Line((left, high), (left, low), "flank", flank),
    ]
    points = [(0, -HEIGHT), (LENGTH, -HEIGHT), (LENGTH, 0), (0, 0)]
    slab = geometry.Polygon(points, ("bottom", "side", "master", "side"), "slab", master=count)
    bodies = [geometry.Body(sides, "die"), slab]
    return geometry.GenerateMesh(bodies, order=order, maxh=HEIGHT / 4, grading=0.3)


def Quadratic(residuals):
    """Do the last residuals of a step fall as those of a quadratic method?

    A fall is a quadratic one if r_n <= 1000 r_(n-1)^2 and r_n <= 1e-2 r_(n-1); the residuals are
    relative to the forces at work. One of the last two falls must be, and the last one must be by
    100 at least or end in rounding (1e-12). Linear convergence by a factor above 1e-2 fails.
    """
    falls = [(a, b) for a, b in pairwise(residuals) if a > 1e-12][-2:]  # rounding falls nowhere
    quadratic = any(b <= min(1000 * a**2, 1e-2 * a) for a, b in falls)
    return not falls or (quadratic and falls[-1][1] <= max(1e-2 * falls[-1][0], 1e-12))


def Run(h=0.3, order: Literal[2, 3] = 2, friction: NotNegative = 0.3, steps=80, stroke=STROKE,
        out=None):  # fmt: skip
    """Press the die in, by as many steps as 2.5 mm of the stroke take, and draw it along.

    h : edge length on the top of the slab, in mm
    order : order of the displacement
    friction : coefficient of friction
    steps : load steps, at least 2
    stroke : way of the die to the right, in mm
    """
    if steps < 2 or stroke > STROKE:
        raise ValueError(f"steps = {steps} must be at least 2, stroke = {stroke} at most {STROKE}")
    mesh = Distributed(lambda: IroningMesh(h, order), Communicator())
    V = VectorH1(mesh, order=order, dirichlet="bottom|top")
    X = V * LACSpace(V, slave="foot|flank")
    u, lam = X.TrialFunction()
    a, gf, time = BilinearForm(X), GridFunction(X), Parameter(0.0)
    energy = NeoHooke(Id(2) + Grad(u), mesh.MaterialCF(YOUNG), POISSON)
    a += Variation(energy.Compile() * dx)
    # Steps begin with the die moved into the slab: see the slab through all of the die's foot.
    contact = LACContact(
        u, lam, master="master", friction=friction or None, finite=True, penetration=DEPTH
    )
    way = CF((STROKE * IfPos(time - 1, time - 1, 0), -DEPTH * IfPos(time - 1, 1, time)))
    solver, residuals = ContactSolver(a, gf, contact), []
    stepper = LoadStepper(solver, time, prescribe={"top": way})

    def Note(step):
        right, up = step.forces[0]  # on the die
        print(f"t = {step.time:.3f}: down {up:.1f}, right {-right:.1f} N/mm", flush=True)
        residuals.append([max(entry.equilibrium, entry.constraint) for entry in solver.history])

    down, failure = min(max(1, round(steps * 2.5 / (2.5 + stroke))), steps - 1), None
    try:
        for end, count in ((1.0, down), (1 + stroke / STROKE, steps - down)):
            stepper.Integrate(end, steps=count, callback=Note, printing=False)
    except ContactConvergenceError as error:
        if not residuals:
            raise
        failure = str(error)
    table, moved = stepper.Table(), gf.components[0]
    pressed = np.append(0, table["force"][:, 0, 1])[
        np.append(0, table["load"]) <= CLEARANCE / DEPTH
    ]
    assert not pressed.any(), "a force before the contact"
    figures = {
        "time": table["load"],
        "vertical_force": table["force"][:, 0, 1],  # of the die on the slab, downwards, in N/mm
        "horizontal_force": -table["force"][:, 0, 0],  # of the die on the slab, to the right
        "iterations": table["iterations"],
        "cuts": table["cuts"],
        "residuals": residuals,
        "quadratic": all(map(Quadratic, residuals)),
        "failure": failure,
    }
    Show(out, "ironing", moved, Bodies(moved), Forces(figures), foot=contact)
    return figures


def Forces(figures):
    """The forces (lines) beside the published ones: circles vertical, squares horizontal."""
    curves, time = {}, figures["time"]
    for k, (name, (vertical, horizontal)) in enumerate(PUBLISHED.items()):
        curves |= {name: (TIMES, vertical, f"C{k}o"), f"_{name}": (TIMES, horizontal, f"C{k}s")}
    for name, style in (("vertical_force", "k-"), ("horizontal_force", "k--")):
        curves[name] = time, figures[name], style
    return Curves("time (1: indented by 1 mm, 2: moved by 10 mm)", "force [N/mm]", **curves)


main = Main(Run)
