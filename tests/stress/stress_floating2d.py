"""Stress set in two dimensions: bodies that contact alone holds; sliding as a whole."""

from itertools import pairwise

import numpy as np
from ngsolve import CF, x, y
from stress_check import Require
from stress_meshes import Block, Grids, Rotated
from stress_problem import Problem, problem


def Force(problem, expected):
    force = problem.contacts[0].Force()
    Require(np.abs(force - expected).max() / np.abs(expected).max(), 1e-6, "resultant")


@problem((3, 0.5), (4, 0.2), (3, 1.5))
def Brick(argument):
    """A brick with three or four macro-elements above a rigid plane, heavy, pushed aside."""
    n, friction = argument
    mesh = Grids(Block("brick", (0, 0, 1, 0.5), n, 2, quads=True))
    p = Problem(mesh, [("brick_bottom", CF(0.01))], {"brick": 100.0}, law={"friction": friction})
    p.Traction("brick_top", p.load * CF((0.1, -1)))
    p.exact = lambda p: Force(p, [-0.1, 1])
    return p


@problem(0.3, 1.0)
def BrickOnBlock(friction):
    """The same on an elastic block, as master."""
    mesh = Grids(Block("brick", (0, 0.01, 1, 0.5), 4, 2), Block("base", (-0.4, -1, 1.4, 0), 9, 5))
    p = Problem(mesh, [("base_top", "brick_bottom")], {"brick": 100.0, "base": 100.0},
                flags={"dirichlet": "base_bottom"}, law={"friction": friction})  # fmt: skip
    p.Traction("brick_top", p.load * CF((0.2, -1)))
    p.exact = lambda p: Force(p, [0.2, -1])
    return p


def Disc(s, t, radius=1.0):
    """The square as a disc that touches y = 0."""
    a, b = 2 * s - 1, 2 * t - 1
    return radius * a * np.sqrt(1 - b * b / 2), radius * (1 + b * np.sqrt(1 - a * a / 2))


@problem(0.1, 1.0)
def DiscOnPlane(friction):
    """A heavy disc lies on an elastic block, held by friction alone."""
    mesh = Grids(
        Block("disc", Disc, 10, 10), Block("base", (-1.2, -1, 1.2, -0.001), 21, 6, quads=True)
    )
    p = Problem(mesh, [("disc_bottom", "base_top")], {"disc": 100.0, "base": 100.0},
                flags={"dirichlet": "base_bottom"}, law={"friction": friction})  # fmt: skip
    p.Weight("disc", p.load * CF((0, -2.0)))
    return p


@problem()
def Slope():
    """A brick on an incline of 20 degrees with friction 0.5: it stays."""
    mesh = Grids(
        Block("brick", Rotated(lambda s, t: (s, 0.5 * t), 20), 5, 3),
        Block("base", Rotated(lambda s, t: (-0.5 + 2 * s, -0.5 + 0.5 * t), 20), 13, 4),
    )
    p = Problem(mesh, [("brick_bottom", "base_top")], {"brick": 100.0, "base": 100.0},
                flags={"dirichlet": "base_bottom"}, law={"friction": 0.5})  # fmt: skip
    p.Weight("brick", p.load * CF((0, -2.0)))
    p.exact = lambda p: Force(p, [0, 1.0])
    return p


@problem()
def Tilt():
    """A couple nearly tilts a brick: one corner carries it."""
    mesh = Grids(Block("brick", (0, 0, 1, 1), 10, 6), Block("base", (-0.4, -1, 1.4, 0), 13, 5))
    p = Problem(mesh, [("brick_bottom", "base_top")], {"brick": 100.0, "base": 100.0},
                flags={"dirichlet": "base_bottom"}, law={"friction": 0.8})  # fmt: skip
    p.Weight("brick", CF((0, -1.0)))
    p.Traction("brick_left", p.load * CF((0.44, 0)))
    p.exact = lambda p: Force(p, [-0.44, 1.0])
    return p


@problem(0.2, 0.6)
def FullSlip(friction):
    """A driven block slides as a whole: friction times pressure is what it takes."""
    mesh = Grids(Block("upper", (0, 0, 1, 0.5), 8, 4), Block("lower", (-0.4, -1, 1.4, 0), 9, 5))
    p = Problem(mesh, [("upper_bottom", "lower_top")], {"upper": 100.0, "lower": 100.0},
                flags={"dirichletx": "upper_top", "dirichlet": "lower_bottom"},
                law={"friction": friction})  # fmt: skip
    p.Traction("upper_top", CF((0, -1.0)))
    p.prescribe = {"upper_top": CF((0.05 * p.load, 0))}
    p.exact = lambda p: Force(p, [-friction, 1.0])
    return p


@problem()
def Stack():
    """Four bricks on each other, each held by friction alone, gaps between, the top one pushed."""
    names = ["base", "a", "b", "c", "d"]
    blocks = [Block("base", (-0.4, -0.5, 1.4, 0), 11, 3)]
    for i, name in enumerate(names[1:]):
        y0 = 0.31 * i + 0.01
        blocks.append(Block(name, (0.05 * (i % 2), y0, 1, y0 + 0.3), 5 + i, 2, quads=i % 2 == 0))
    pairs = [(f"{u}_bottom", f"{w}_top") for w, u in pairwise(names)]
    p = Problem(Grids(*blocks), pairs, dict.fromkeys(names, 100.0),
                flags={"dirichlet": "base_bottom"}, law={"friction": 0.5})  # fmt: skip
    for name in names[1:]:
        p.Weight(name, CF((0, -1.0)))
    p.Traction("d_top", p.load * CF((0.1, 0)))
    p.exact = lambda p: Force(p, [-0.095, 0.3 * (1 + 0.95 + 1 + 0.95)])
    return p


@problem(0.0, 0.4)
def TiltedStart(friction):
    """A guided brick starts tilted above the plane and comes down on it."""
    mesh = Grids(
        Block("brick", Rotated(lambda s, t: (s, 0.05 + 0.5 * t), -4), 3, 2),
        Block("base", (-0.4, -1, 1.4, -0.08), 9, 5),
    )
    p = Problem(mesh, [("brick_bottom", "base_top")], {"brick": 100.0, "base": 100.0},
                flags={"dirichlet": "base_bottom"}, law={"friction": friction})  # fmt: skip
    p.Spring("brick_top", CF((0, 0)), 1e-3)
    p.Weight("brick", p.load * CF((0, -2.0)))
    return p


@problem(0.1, 0.6)
def PinInCradle(friction):
    """A pin in a cradle with little play, loaded by a force and turned by another one."""

    def ring(s, t):
        angle, radius = np.pi * (1 + s), 2.0 - t * (2.0 - 1.01)
        return radius * np.cos(angle), radius * np.sin(angle)

    def pin(s, t):
        px, py = Disc(s, t)
        return px, py - 1

    mesh = Grids(Block("pin", pin, 7, 7), Block("ring", ring, 19, 3))
    sides = "pin_bottom|pin_right|pin_top|pin_left"
    p = Problem(mesh, [(sides, "ring_top")], {"pin": 100.0, "ring": 50.0},
                flags={"dirichlet": "ring_bottom"}, law={"friction": friction})  # fmt: skip
    p.Weight("pin", p.load * CF((0, -3.0)) + 0.3 * p.load * CF((-y, x)))
    return p
