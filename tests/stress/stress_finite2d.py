"""Stress set in two dimensions: large deformation and large sliding."""

import numpy as np
from ngsolve import CF, IfPos, cos, sin, x, y
from stress_blocks2d import TwoBlocks
from stress_floating2d import Disc
from stress_meshes import Block, Grids
from stress_problem import Problem, problem

PAIR = [("upper_bottom", "lower_top")]
CLAMPED = {"dirichlet": "lower_bottom"}
DRIVEN = {"dirichlet": "lower_bottom|upper_top"}


def Large(mesh, young=(100.0, 100.0), friction=0.0, pairs=PAIR, names=("upper", "lower"), **flags):
    """A problem with neo-Hooke bodies and finite sliding."""
    bodies = dict(zip(names, young, strict=True))
    law = {"friction": friction, "finite": True} if friction else {"finite": True}
    return Problem(mesh, pairs, bodies, nonlinear=True, law=law, **{"flags": DRIVEN} | flags)


def Blocks(length=3.0, n=(7, 5), width=1.0, height=0.6, gap=0.01):
    return Grids(
        Block("upper", (0, gap, width, height + gap), n[0], 4, quads=True),
        Block("lower", (-0.3, -0.6, length - 0.3, 0), int(length * n[1]), 4, quads=True),
    )


@problem((31, 0.0), (32, 0.3), (33, 0.8), (34, 1.5))
def LargeRandom(argument):
    """Random surfaces, pressed and sheared by several elements in one step."""
    seed, friction = argument
    mesh = TwoBlocks(seed, 0.04, nx=(10, 8), quads=seed % 2 == 0)
    p = Large(mesh, (10.0, 30.0), friction)
    p.prescribe = {"upper_top": p.load * CF((0.15, -0.2))}
    return p


@problem(0.0, 0.3, 1.0)
def LargeSlide(friction):
    """A block slides by more than its length, in steps of three elements."""
    p = Large(Blocks(), (20.0, 50.0), friction)
    t = p.load
    p.prescribe = {"upper_top": CF((IfPos(t - 1, 1.5 * (t - 1), 0), -0.06 * IfPos(t - 1, 1, t)))}
    p.path = [(1.0, 1), (2.0, 3)]
    return p


@problem(0.0, 0.4)
def OverEdge(friction):
    """A block slides over the end of the lower one, until half of it hangs over."""
    p = Large(Blocks(length=1.4, n=(8, 7)), (20.0, 50.0), friction)
    t = p.load
    p.prescribe = {"upper_top": CF((IfPos(t - 1, 0.7 * (t - 1), 0), -0.04 * IfPos(t - 1, 1, t)))}
    p.path = [(1.0, 1), (2.0, 4)]
    return p


@problem(0.0, 0.5)
def Indent(friction):
    """A stiff disc pressed into a soft block by half of its radius."""
    mesh = Grids(
        Block("upper", lambda s, t: Disc(s, t, 0.4), 8, 8),
        Block("lower", (-1, -1, 1, -0.001), 23, 9, quads=True),
    )
    pairs = [("upper_left|upper_bottom|upper_right", "lower_top")]
    p = Large(mesh, (1000.0, 1.0), friction, pairs)
    p.prescribe = {"upper_top": CF((0, -0.2 * p.load))}
    return p


@problem(0.0, 0.4)
def SoftPunch(friction):
    """A soft block pressed flat on a stiff one, nearly incompressible: it bulges."""
    p = Large(Blocks(length=1.6, n=(8, 7), height=0.8), (1.0, 1000.0), friction, nu=0.49, order=3)
    p.prescribe = {"upper_top": CF((0, -0.21 * p.load))}
    return p


@problem(0.0, 0.2)
def Iron(friction):
    """A disc is pressed in and drawn along: shallow ironing."""
    mesh = Grids(
        Block("upper", lambda s, t: Disc(s, t, 0.5), 8, 8),
        Block("lower", (-0.8, -0.7, 2.2, -0.001), 30, 5, quads=True),
    )
    pairs = [("upper_left|upper_bottom|upper_right", "lower_top")]
    p = Large(mesh, (100.0, 10.0), friction, pairs)
    t = p.load
    p.prescribe = {"upper_top": CF((IfPos(t - 1, t - 1, 0), -0.12 * IfPos(t - 1, 1, t)))}
    p.path = [(1.0, 1), (2.0, 5)]
    return p


@problem(0.0, 0.6)
def Turn(friction):
    """A pressed pair is turned as a whole by a right angle in three steps."""
    p = Large(Blocks(length=1.6), (50.0, 50.0), friction)
    t = p.load
    angle = np.pi / 2 * IfPos(t - 1, t - 1, 0)
    down = -0.05 * IfPos(t - 1, 1, t)

    def turned(a, b):
        return CF((cos(angle) * a - sin(angle) * b - x, sin(angle) * a + cos(angle) * b - y))

    p.prescribe = {"upper_top": turned(x + 0.02 * IfPos(t - 1, 1, t), y + down),
                   "lower_bottom": turned(x, y)}  # fmt: skip
    p.path = [(1.0, 1), (2.0, 3)]
    return p


@problem(0.0, 0.3)
def Beams(friction):
    """A cantilever bends another one that crosses below its end, and slides along it."""
    mesh = Grids(
        Block("upper", (0, 0.01, 2, 0.11), 16, 2, quads=True),
        Block("lower", (1.5, -0.1, 3.5, 0), 19, 2, quads=True),
    )
    p = Large(mesh, (1000.0, 700.0), friction, flags={"dirichlet": "upper_left|lower_right"})
    p.prescribe = {"upper_left": CF((0, -0.5 * p.load))}
    p.path = [(1.0, 2)]
    return p


@problem(0.0, 0.3)
def Bumps(friction):
    """Two bumps are driven past each other: the force changes its direction on the way."""

    def upper(s, t):
        px = 1.6 * s
        bottom = -0.12 * np.exp(-(((px - 0.8) / 0.25) ** 2))
        return px, bottom + t * (0.7 - bottom)

    def lower(s, t):
        px = 3.2 * s
        top = -0.14 + 0.12 * np.exp(-(((px - 1.6) / 0.25) ** 2))
        return px, -0.8 + t * (top + 0.8)

    mesh = Grids(Block("upper", upper, 20, 4, quads=True), Block("lower", lower, 37, 7, quads=True))
    p = Large(mesh, (20.0, 30.0), friction)
    p.prescribe = {"upper_top": CF((1.6 * p.load, -0.01 * IfPos(p.load - 0.2, 1, 5 * p.load)))}
    p.path = [(1.0, 5)]
    return p


@problem(0.0, 0.3)
def WedgeIn(friction):
    """A wedge is driven between two soft blocks and pushes them apart."""

    def wedge(s, t):
        return (2 * s - 1) * (0.12 + 0.2 * t), 0.62 + 0.8 * t

    mesh = Grids(
        Block("wedge", wedge, 4, 8, quads=True),
        Block("left", (-1.0, 0, -0.15, 0.7), 5, 9, quads=True),
        Block("right", (0.15, 0, 1.0, 0.7), 5, 7, quads=True),
    )
    pairs = [("left_right", "wedge_left"), ("right_left", "wedge_right")]
    p = Large(mesh, (500.0, 10.0, 10.0), friction, pairs, ("wedge", "left", "right"),
              flags={"dirichlet": "wedge_top|left_left|right_right"})  # fmt: skip
    p.prescribe = {"wedge_top": CF((0, -0.4 * p.load))}
    p.path = [(1.0, 2)]
    return p


@problem(0.5)
def ToAndFro(friction):
    """Large sliding to and fro."""
    p = Large(Blocks(), (20.0, 50.0), friction)
    t = p.load
    p.prescribe = {"upper_top": CF((0.5 - 0.5 * cos(6.283 * t), -0.05 * IfPos(t - 0.2, 1, 5 * t)))}
    p.path = [(1.0, 6)]
    return p


@problem(0.4)
def Lift(friction):
    """Pressed, lifted far beyond the first gap, pressed again, one step each."""
    p = Large(TwoBlocks(35, 0.02), (20.0, 50.0), friction)
    p.prescribe = {"upper_top": p.load * CF((0.1, -0.12))}
    p.path = [(1.0, 1), (-2.0, 1), (1.0, 1)]
    return p


@problem(0.3, 1.0)
def LargeBrick(friction):
    """A brick held by nothing but contact, three macro-elements, pushed aside."""
    p = Large(Blocks(length=1.6, n=(3, 6)), (20.0, 20.0), friction, flags=CLAMPED)
    p.Traction("upper_top", p.load * CF((0.2, -1)))
    return p


@problem((14, 4), (4, 14))
def LargeMeshes(n):
    """A fine against a coarse mesh, and the reverse."""
    p = Large(Blocks(length=1.8, n=n), (10.0, 10.0), 0.4)
    p.prescribe = {"upper_top": p.load * CF((0.25, -0.12))}
    return p


@problem(41, 42)
def LargeBadStart(seed):
    """A random start vector."""
    p = Large(TwoBlocks(seed, 0.02), (20.0, 20.0), 0.3, flags=CLAMPED)
    p.Spring("upper_top", p.load * CF((0.05, -0.1)), 200)
    values, free = p.gf.vec.FV().NumPy(), p.X.FreeDofs()
    values[:] = np.random.default_rng(seed).normal(size=len(values)) * [bool(b) for b in free]
    values[: p.X.components[0].ndof] *= 0.004
    return p


@problem(0.0, 0.2)
def HalfRing(friction):
    """A thin half ring is pressed on a block until it is half as high."""

    def ring(s, t):
        angle, radius = np.pi * (1 + s), 1.0 - 0.1 * t
        return radius * np.cos(angle), radius * np.sin(angle) + 1

    mesh = Grids(
        Block("upper", ring, 31, 1, quads=True),
        Block("lower", (-1.4, -0.4, 1.4, -0.001), 27, 3, quads=True),
    )
    p = Large(mesh, (1000.0, 300.0), friction,
              flags={"dirichlet": "lower_bottom|upper_left|upper_right"})  # fmt: skip
    p.prescribe = {"upper_left|upper_right": CF((0, -0.5 * p.load))}
    p.path = [(1.0, 4)]
    return p
