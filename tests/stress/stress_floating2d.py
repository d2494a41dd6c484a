"""Stress set in two dimensions: bodies that contact alone holds; sliding as a whole."""

from itertools import pairwise

import numpy as np
from ngsolve import CF, x, y
from stress_meshes import Block, Disc, Grids, Polar, Rotated
from stress_problem import Problem, problem

PAIR = [("brick", "base")]


@problem((3, 0.5), (4, 0.2), (3, 1.5))
def Brick(n, friction):
    """A brick with three or four macro-elements above a rigid plane, heavy, pushed aside."""
    mesh, plane = Grids(brick=((0, 0, 1, 0.5), (n, 2), "quad")), [("brick", CF(0.01))]
    p = Problem(mesh, pairs=plane, friction=friction, resultant=(-0.1, 1))
    return p.Traction("brick_top", (0.1, -1))


@problem(0.3, 1.0)
def BrickOnBlock(friction):
    """The same on an elastic block, as master."""
    mesh = Grids(brick=((0, 0.01, 1, 0.5), (4, 2)), base=((-0.4, -1, 1.4, 0), (9, 5)))
    pairs = [("base_top", "brick_bottom")]
    p = Problem(mesh, pairs=pairs, friction=friction, resultant=(0.2, -1))
    return p.Traction("brick_top", (0.2, -1))


@problem(0.1, 1.0)
def DiscOnPlane(friction):
    """A heavy disc lies on an elastic block, held by friction alone."""
    mesh = Grids(disc=(Disc, (10, 10)), base=((-1.2, -1, 1.2, -0.001), (21, 6), "quad"))
    return Problem(mesh, pairs=[("disc", "base")], friction=friction).Weight("disc", (0, -2.0))


@problem()
def Slope():
    """A brick on an incline of 20 degrees with friction 0.5: it stays."""
    mesh = Grids(
        brick=(Rotated(lambda s, t: (s, 0.5 * t), 20), (5, 3)),
        base=(Rotated(lambda s, t: (-0.5 + 2 * s, -0.5 + 0.5 * t), 20), (13, 4)),
    )
    p = Problem(mesh, pairs=PAIR, friction=0.5, resultant=(0, 1.0))
    return p.Weight("brick", (0, -2.0))


@problem()
def Tilt():
    """A couple nearly tilts a brick: one corner carries it."""
    mesh = Grids(brick=((0, 0, 1, 1), (10, 6)), base=((-0.4, -1, 1.4, 0), (13, 5)))
    p = Problem(mesh, pairs=PAIR, friction=0.8, resultant=(-0.44, 1.0))
    return p.Weight("brick", CF((0, -1.0))).Traction("brick_left", (0.44, 0))


@problem(0.2, 0.6)
def FullSlip(friction):
    """A driven block slides as a whole: friction times pressure is what it takes."""
    mesh = Grids(upper=((0, 0, 1, 0.5), (8, 4)), lower=((-0.4, -1, 1.4, 0), (9, 5)))
    top = {"heldx": "upper_top", "prescribe": {"upper_top": (0.05, 0)}}
    p = Problem(mesh, friction=friction, resultant=(-friction, 1.0), **top)
    return p.Traction("upper_top", CF((0, -1.0)))


@problem()
def Stack():
    """Four bricks on each other, each held by friction alone, gaps between, the top one pushed."""
    blocks = [Block("base", (-0.4, -0.5, 1.4, 0), (11, 3))]
    for i, name in enumerate("abcd"):
        y0, kind = 0.31 * i + 0.01, ("quad", "trig")[i % 2]
        blocks.append(Block(name, (0.05 * (i % 2), y0, 1, y0 + 0.3), (5 + i, 2), kind))
    pairs = [(upper.name, lower.name) for lower, upper in pairwise(blocks)]
    resultant = (-0.095, 0.3 * (1 + 0.95 + 1 + 0.95))
    p = Problem(Grids(*blocks), pairs=pairs, friction=0.5, resultant=resultant)
    for name in "abcd":
        p.Weight(name, CF((0, -1.0)))
    return p.Traction("d_top", (0.1, 0))


@problem(0.0, 0.4)
def TiltedStart(friction):
    """A guided brick starts tilted above the plane and comes down on it."""
    mesh = Grids(
        brick=(Rotated(lambda s, t: (s, 0.05 + 0.5 * t), -4), (3, 2)),
        base=((-0.4, -1, 1.4, -0.08), (9, 5)),
    )
    p = Problem(mesh, pairs=PAIR, friction=friction)
    return p.Spring("brick_top", (0, 0), 1e-3).Weight("brick", (0, -2.0))


@problem(0.1, 0.6)
def PinInCradle(friction):
    """A pin in a cradle with little play, loaded by a force and turned by another one."""

    def pin(s, t):
        px, py = Disc(s, t)
        return px, py - 1

    def ring(s, t):
        return Polar(np.pi * (1 + s), 2.0 - t * (2.0 - 1.01))

    mesh = Grids(pin=(pin, (7, 7)), ring=(ring, (19, 3)))
    pairs = [("pin_bottom|pin_right|pin_top|pin_left", "ring_top")]
    p = Problem(mesh, {"pin": 100.0, "ring": 50.0}, pairs, friction, held="ring_bottom")
    return p.Weight("pin", lambda t: t * CF((0, -3.0)) + 0.3 * t * CF((-y, x)))
