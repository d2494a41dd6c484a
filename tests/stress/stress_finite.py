"""Stress set: large deformation and large sliding, in two dimensions and on tiny meshes in 3D."""

from functools import partial

import numpy as np
from ngsolve import IfPos, cos, sin, x, y, z
from stress_blocks import TwoBlocks
from stress_meshes import Disc, Grids, Polar
from stress_problem import Moved, Pressed, Problem, problem

ROUND = [("upper_left|upper_bottom|upper_right", "lower_top")]


def Large(mesh, upper=100.0, lower=100.0, friction=0.0, pairs=(("upper", "lower"),), **options):
    """A problem with neo-Hooke bodies and finite sliding."""
    young = options.pop("young", {"upper": upper, "lower": lower})
    return Problem(mesh, young, pairs, friction or None, finite=True, **options)


def Top(*motion):
    """The top is driven: by numbers that grow with the load, or a function of the load."""
    return {"upper_top": motion if len(motion) > 1 else motion[0]}


def Blocks(length=3.0, n=(7, 5), height=0.6):
    lower = (-0.3, -0.6, length - 0.3, 0)
    return Grids(
        upper=((0, 0.01, 1.0, height + 0.01), (n[0], 4), "quad"),
        lower=(lower, (int(length * n[1]), 4), "quad"),
    )


@problem((31, 0.0), (32, 0.3), (33, 0.8), (34, 1.5))
def LargeRandom(seed, friction):
    """Random surfaces, pressed and sheared by several elements in one step."""
    mesh = TwoBlocks(seed, 0.04, (10, 8), ("quad", "trig")[seed % 2])
    return Large(mesh, 10.0, 30.0, friction, drive=Top(0.15, -0.2))


@problem(0.0, 0.3, 1.0)
def LargeSlide(friction):
    """A block slides by more than its length, in steps of three elements."""
    drive, path = Top(lambda t: (1.5 * Moved(t), -0.06 * Pressed(t))), [(1.0, 1), (2.0, 3)]
    return Large(Blocks(), 20.0, 50.0, friction, drive=drive, path=path)


@problem(0.0, 0.4)
def OverEdge(friction):
    """A block slides over the end of the lower one, until half of it hangs over."""
    drive, path = Top(lambda t: (0.7 * Moved(t), -0.04 * Pressed(t))), [(1.0, 1), (2.0, 4)]
    return Large(Blocks(1.4, (8, 7)), 20.0, 50.0, friction, drive=drive, path=path)


@problem(0.0, 0.5)
def Indent(friction):
    """A stiff disc pressed into a soft block by half of its radius."""
    disc = partial(Disc, radius=0.4)
    mesh = Grids(upper=(disc, (8, 8)), lower=((-1, -1, 1, -0.001), (23, 9), "quad"))
    return Large(mesh, 1000.0, 1.0, friction, ROUND, drive=Top(0, -0.2))


@problem(0.0, 0.4)
def SoftPunch(friction):
    """A soft block pressed flat on a stiff one, nearly incompressible: it bulges."""
    options = {"nu": 0.49, "order": 3, "drive": Top(0, -0.21)}
    return Large(Blocks(1.6, (8, 7), 0.8), 1.0, 1000.0, friction, **options)


@problem(0.0, 0.2)
def Iron(friction):
    """A disc is pressed in and drawn along: shallow ironing."""
    disc, path = partial(Disc, radius=0.5), [(1.0, 1), (2.0, 5)]
    mesh = Grids(upper=(disc, (8, 8)), lower=((-0.8, -0.7, 2.2, -0.001), (30, 5), "quad"))
    drive = Top(lambda t: (Moved(t), -0.12 * Pressed(t)))
    return Large(mesh, 100.0, 10.0, friction, ROUND, drive=drive, path=path)


@problem(0.0, 0.6)
def Turn(friction):
    """A pressed pair is turned as a whole by a right angle in three steps."""

    def turned(t, a, b):
        angle = np.pi / 2 * Moved(t)
        return cos(angle) * a - sin(angle) * b - x, sin(angle) * a + cos(angle) * b - y

    drive = Top(lambda t: turned(t, x + 0.02 * Pressed(t), y + -0.05 * Pressed(t)))
    drive |= {"lower_bottom": lambda t: turned(t, x, y)}
    options = {"drive": drive, "path": [(1.0, 1), (2.0, 3)]}
    return Large(Blocks(length=1.6), 50.0, 50.0, friction, **options)


@problem(0.0, 0.3)
def Beams(friction):
    """A cantilever bends another one that crosses below its end, and slides along it."""
    mesh = Grids(
        upper=((0, 0.01, 2, 0.11), (16, 2), "quad"),
        lower=((1.5, -0.1, 3.5, 0), (19, 2), "quad"),
    )
    options = {"held": "lower_right", "drive": {"upper_left": (0, -0.5)}, "steps": 2}
    return Large(mesh, 1000.0, 700.0, friction, **options)


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

    mesh = Grids(upper=(upper, (20, 4), "quad"), lower=(lower, (37, 7), "quad"))
    drive = Top(lambda t: (1.6 * t, -0.01 * IfPos(t - 0.2, 1, 5 * t)))
    return Large(mesh, 20.0, 30.0, friction, drive=drive, steps=5)


@problem(0.0, 0.3)
def WedgeIn(friction):
    """A wedge is driven between two soft blocks and pushes them apart."""

    def wedge(s, t):
        return (2 * s - 1) * (0.12 + 0.2 * t), 0.62 + 0.8 * t

    mesh = Grids(
        wedge=(wedge, (4, 8), "quad"),
        left=((-1.0, 0, -0.15, 0.7), (5, 9), "quad"),
        right=((0.15, 0, 1.0, 0.7), (5, 7), "quad"),
    )
    pairs = [("left_right", "wedge_left"), ("right_left", "wedge_right")]
    young = {"wedge": 500.0, "left": 10.0, "right": 10.0}
    options = {"held": "left_left|right_right", "drive": {"wedge_top": (0, -0.4)}, "steps": 2}
    return Large(mesh, young=young, friction=friction, pairs=pairs, **options)


@problem(0.5)
def ToAndFro(friction):
    """Large sliding to and fro."""
    drive = Top(lambda t: (0.5 - 0.5 * cos(6.283 * t), -0.05 * IfPos(t - 0.2, 1, 5 * t)))
    return Large(Blocks(), 20.0, 50.0, friction, drive=drive, steps=6)


@problem(0.4)
def Lift(friction):
    """Pressed, lifted far beyond the first gap, pressed again, one step each."""
    path = [(1.0, 1), (-2.0, 1), (1.0, 1)]
    return Large(TwoBlocks(35, 0.02), 20.0, 50.0, friction, drive=Top(0.1, -0.12), path=path)


@problem(0.3, 1.0)
def LargeBrick(friction):
    """A brick held by nothing but contact, three macro-elements, pushed aside."""
    p = Large(Blocks(1.6, (3, 6)), 20.0, 20.0, friction)
    return p.Traction("upper_top", (0.2, -1))


@problem((14, 4), (4, 14))
def LargeMeshes(*n):
    """A fine against a coarse mesh, and the reverse."""
    return Large(Blocks(1.8, n), 10.0, 10.0, 0.4, drive=Top(0.25, -0.12))


@problem(41, 42)
def LargeBadStart(seed):
    """A random start vector."""
    p = Large(TwoBlocks(seed, 0.02), 20.0, 20.0, 0.3)
    return p.Spring("upper_top", (0.05, -0.1), 200).Scatter(seed, 0.004, 1)


@problem((0.0, 0.5), (0.2, 0.47))
def HalfRing(friction, down):
    """A thin half ring is pressed on a block until it is about half as high.

    With friction the path folds at 0.478, with elements half as large at 0.481, where the inner
    ones of the macro-elements that touch come off: what follows is a jump.
    """

    def ring(s, t):
        px, py = Polar(np.pi * (1 + s), 1.0 - 0.1 * t)
        return px, py + 1

    lower = (-1.4, -0.4, 1.4, -0.001)
    mesh = Grids(upper=(ring, (31, 1), "quad"), lower=(lower, (27, 3), "quad"))
    options = {"drive": {"upper_left|upper_right": (0, -down)}, "steps": 4}
    return Large(mesh, 1000.0, 300.0, friction, **options)


# --- in three dimensions -------------------------------------------------------------------------


def Blocks3D(length=1.6):
    lower = (-0.3, -0.3, -0.5, length - 0.3, 1.3, 0)
    return Grids(
        upper=((0, 0, 0.01, 1, 1, 0.51), (2, 2, 1)), lower=(lower, (int(length * 3), 3, 1))
    )


@problem(0.0, 0.5)
def Slide3D(friction):
    """Pressed and drawn aside by more than half of its width."""
    drive, path = Top(lambda t: (0.6 * Moved(t), 0, -0.08 * Pressed(t))), [(1.0, 1), (2.0, 2)]
    return Large(Blocks3D(2.2), 20.0, 40.0, friction, drive=drive, path=path)


@problem(0.4)
def Twist3D(friction):
    """Pressed and turned by 60 degrees about the normal in one step."""

    def spin(t):
        a, u, w = np.pi / 3 * t, x - 0.5, y - 0.5
        return cos(a) * u - sin(a) * w - u, sin(a) * u + cos(a) * w - w, -0.06 * t

    return Large(Blocks3D(1.8), 20.0, 40.0, friction, drive=Top(spin))


@problem(0.3)
def Turn3D(friction):
    """A pressed pair is turned as a whole by 60 degrees about a horizontal axis."""

    def turned(t, h):
        a = np.pi / 3 * Moved(t)
        return 0, cos(a) * y - sin(a) * h - y, sin(a) * y + cos(a) * h - z

    drive = Top(lambda t: turned(t, z + -0.05 * Pressed(t)))
    drive |= {"lower_bottom": lambda t: turned(t, z)}
    return Large(Blocks3D(), 20.0, 40.0, friction, drive=drive, path=[(1.0, 1), (2.0, 2)])


@problem(0.6)
def LargeBrick3D(friction):
    """Held by contact alone, four macro-elements, pushed aside."""
    return Large(Blocks3D(), 20.0, 40.0, friction).Traction("upper_top", (0.2, 0.1, -1))
