"""Stress set: loads that no contact balances, each with the words that its error has to say."""

from functools import partial

import numpy as np
from ngsolve import IfPos, x, y
from stress_meshes import Block, Disc, Grids, Polar
from stress_problem import Problem, problem
from stress_unsolvable import AWAY, SLIDES, Says, TallBrick, Which

PAIR = [("brick", "base")]
TIPS = "tips over"


def Brick3D(friction, finite, says, height=0.5):
    base = ((-0.4, -0.4, -0.5, 1.4, 1.4, 0), (4, 4, 1))
    mesh = Grids(brick=((0, 0, 0, 1, 1, height), (3, 3, 2)), base=base)
    return Problem(mesh, 100.0, PAIR, friction, bool(finite), says=says)


@problem((0.3, 0), (0.6, 0), (0.3, 1))
def NoSlope3D(friction, finite):
    """A brick on a slope a little steeper than friction holds, down along no edge of it."""
    angle = np.arctan(1.05 * friction)
    down = np.array([np.sin(angle) * np.cos(0.5), np.sin(angle) * np.sin(0.5), -np.cos(angle)])
    p = Brick3D(friction, finite, Says(SLIDES, "slides away", "brick"), height=0.2)
    return p.Weight("brick", tuple(down))


@problem((0.3, 0), (0.3, 1))
def NoTurn3D(friction, finite):
    """A couple about the normal turns a brick that friction would hold against its force."""
    p = Brick3D(friction, finite, Says("turns", "brick", "rotation about z", SLIDES))
    return p.Traction("brick_top", (-1.5 * (y - 0.5), 1.5 * (x - 0.5), -1.0))


@problem((0.8, 0), (0.8, 1))
def NoTipping3D(friction, finite):
    """A tall brick is tipped over about an edge."""
    p = Brick3D(friction, finite, Says(TIPS, "brick", "rotation about [xy]"), height=2.0)
    return p.Traction("brick_top", (0.4, 0.0, -1.0))


@problem(1, 3)
def NoTippingFar(steps):
    """A tall block with finite sliding is tipped over by a force at its top."""
    return TallBrick(Says(f"{TIPS}|turns|limit load", "brick"), 0.5, finite=True, steps=steps)


@problem((0.2, 0), (0.0, 0), (0.2, 1))
def NoWedge(friction, finite):
    """A wedge of 30 degrees is squeezed out from below a punch."""
    slope = np.tan(np.radians(30))

    def wedge(s, t):
        return s, t * (0.2 + slope * (1 - s)) + (1 - t) * 0.0

    def base(s, t):
        return -0.4 + 2.2 * s, -0.8 + 0.8 * t

    def punch(s, t):
        px = 0.2 + 0.6 * s
        return px, 0.2 + slope * (1 - px) + t * (1.0 - slope * (1 - px))

    mesh = Grids(wedge=(wedge, (9, 5), "quad"), base=(base, (17, 4)), punch=(punch, (5, 6)))
    pairs, says = [("wedge", "base"), ("punch", "wedge")], Says("slides away|float", "wedge")
    p = Problem(mesh, 100.0, pairs, friction, bool(finite), heldx="punch_top", says=says)
    return p.Traction("punch_top", (0, -1.0))


@problem((0.3, 0), (0.3, 1))
def NoTable(friction, finite):
    """A disc is rolled off the edge of a table by a force on its middle."""
    disc, table = partial(Disc, radius=0.5), (-1.5, -0.8, 0.1, 0.0)
    mesh = Grids(disc=(disc, (10, 10)), table=(table, (21, 6), "quad"))
    options = {"held": "table_bottom", "says": Says(f"{TIPS}|turns|slides|{AWAY}", "disc")}
    young, pairs = {"disc": 1000.0, "table": 100.0}, [("disc", "table")]
    p = Problem(mesh, young, pairs, friction, bool(finite), **options)
    return p.Weight("disc", (0.25, -1.0))


@problem((0.3, 0, 1.4), (0.3, 0, 2.4), (0.3, 1, 2.4))
def NoMiddle(friction, finite, force):
    """Of three bricks of one material below a lid the middle one is pulled out.

    The weaker force would be held by a rigid lid, which rests on this brick alone.
    """
    base = Block("base", (-0.4, -0.6, 3.8, 0), (19, 3))
    bricks = [Block("brick", (1.2 * k, 0, 1.2 * k + 1, 0.4), (4, 2), "quad") for k in range(3)]
    mesh = Grids(base, *bricks, Block("lid", (-0.2, 0.4, 3.6, 0.8), (18, 2)))
    pairs = [("brick", "base"), ("brick_top", "lid_bottom")]
    says = Says(SLIDES, "slides away|moves off", "brick", Which("2", 1.7))
    p = Problem(mesh, 100.0, pairs, friction, bool(finite), heldx="lid_top", says=says)
    middle = IfPos(x - 1.1, 1.0, 0.0) * IfPos(2.3 - x, 1.0, 0.0)
    return p.Traction("lid_top", (0, -1.0)).Weight("brick", (force / 0.4 * middle, 0))


@problem(0.2)
def NoTresca(bound):
    """A force beyond Tresca's bound times the area."""
    brick, base = ((0, 0, 1, 0.3), (5, 2), "quad"), ((-0.4, -0.8, 1.4, 0), (9, 4))
    says = Says(SLIDES, "slides away", "brick")
    p = Problem(Grids(brick=brick, base=base), pairs=PAIR, law={"tresca": bound}, says=says)
    return p.Traction("brick_top", (1.1 * bound, -1.0))


@problem((0.2, 0), (0.4, 0), (0.3, 1))
def NoCapstan(friction, finite):
    """A belt around half of a drum is pulled harder than friction and the other end hold."""

    def belt(s, t):
        return Polar(np.pi * (1 - s), 1.0 + 0.06 * t)

    def drum(s, t):
        return Polar(np.pi * (1.1 - 1.2 * s), 0.5 + 0.5 * t)

    mesh = Grids(belt=(belt, (24, 1), "quad"), drum=(drum, (31, 3)))
    # Of a belt that bends as it slides large ways no rigid motion tells.
    words = "exceed what friction can carry" if finite else f"turns|slides away|moves off|{SLIDES}"
    options = {"held": "drum_bottom", "says": Says(words, "belt")}
    p = Problem(mesh, 1000.0, [("belt", "drum")], friction, bool(finite), **options)
    pull = 1.3 * np.exp(friction * np.pi)
    return p.Traction("belt_left", (0, -1.0)).Traction("belt_right", (0, -pull))
