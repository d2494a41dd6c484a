"""Stress set: loads that no contact balances, each with the words that its error has to say."""

import numpy as np
from ngsolve import CF, IfPos, x, y
from stress_floating2d import Disc
from stress_meshes import Block, Block3D, Grids, Grids3D
from stress_problem import Problem, problem
from stress_unsolvable import AWAY, HELD, SLIDES, YOUNG, Says, Which

PAIR = [("brick_bottom", "base_top")]
TIPS = "tips over"


def Law(finite, friction=None, **law):
    law |= {} if friction is None else {"friction": friction}
    return law | ({"finite": True} if finite else {})


def Brick3D(friction, finite, height=0.5):
    mesh = Grids3D(Block3D("brick", (0, 0, 0, 1, 1, height), (3, 3, 2)),
                   Block3D("base", (-0.4, -0.4, -0.5, 1.4, 1.4, 0), (4, 4, 1)))  # fmt: skip
    return Problem(mesh, PAIR, YOUNG, flags=HELD, law=Law(finite, friction), nonlinear=finite)


@problem((0.3, 0), (0.6, 0), (0.3, 1))
def NoSlope3D(argument):
    """A brick on a slope a little steeper than friction holds, down along no edge of it."""
    friction, finite = argument
    p = Brick3D(friction, bool(finite), height=0.2)
    p.says = Says(SLIDES, "slides away", "brick")
    angle = np.arctan(1.05 * friction)
    down = np.array([np.sin(angle) * np.cos(0.5), np.sin(angle) * np.sin(0.5), -np.cos(angle)])
    p.Weight("brick", p.load * CF(tuple(down)))
    return p


@problem((0.3, 0), (0.3, 1))
def NoTurn3D(argument):
    """A couple about the normal turns a brick that friction would hold against its force."""
    friction, finite = argument
    p = Brick3D(friction, bool(finite))
    p.says = Says("turns", "brick", "rotation about z", SLIDES)
    p.Traction("brick_top", p.load * CF((-1.5 * (y - 0.5), 1.5 * (x - 0.5), -1.0)))
    return p


@problem((0.8, 0), (0.8, 1))
def NoTipping3D(argument):
    """A tall brick is tipped over about an edge."""
    friction, finite = argument
    p = Brick3D(friction, bool(finite), height=2.0)
    p.says = Says(TIPS, "brick", "rotation about [xy]")
    p.Traction("brick_top", p.load * CF((0.4, 0.0, -1.0)))
    return p


@problem(1, 3)
def NoTippingFar(steps):
    """A tall block with finite sliding is tipped over by a force at its top."""
    mesh = Grids(Block("brick", (0, 0, 0.4, 1.6), 3, 7, quads=True),
                 Block("base", (-0.4, -0.8, 0.8, 0), 9, 4))  # fmt: skip
    p = Problem(mesh, PAIR, YOUNG, flags=HELD, law=Law(True, 0.5), nonlinear=True,
                path=[(1.0, steps)])  # fmt: skip
    p.says = Says(f"{TIPS}|turns|limit load", "brick")
    p.Weight("brick", CF((0, -1.0)))
    p.Traction("brick_right", p.load * CF((0.15, 0)))
    return p


@problem((0.2, 0), (0.0, 0), (0.2, 1))
def NoWedge(argument):
    """A wedge of 30 degrees is squeezed out from below a punch."""
    friction, finite = argument
    slope = np.tan(np.radians(30))

    def wedge(s, t):
        return s, t * (0.2 + slope * (1 - s)) + (1 - t) * 0.0

    def base(s, t):
        return -0.4 + 2.2 * s, -0.8 + 0.8 * t

    def punch(s, t):
        px = 0.2 + 0.6 * s
        return px, 0.2 + slope * (1 - px) + t * (1.0 - slope * (1 - px))

    mesh = Grids(Block("wedge", wedge, 9, 5, quads=True), Block("base", base, 17, 4),
                 Block("punch", punch, 5, 6))  # fmt: skip
    names = ["wedge", "base", "punch"]
    pairs = [("wedge_bottom", "base_top"), ("punch_bottom", "wedge_top")]
    p = Problem(mesh, pairs, dict.fromkeys(names, 100.0), law=Law(finite, friction),
                nonlinear=bool(finite), flags=HELD | {"dirichletx": "punch_top"})  # fmt: skip
    p.says = Says("slides away|float", "wedge")
    p.Traction("punch_top", p.load * CF((0, -1.0)))
    return p


@problem((0.3, 0), (0.3, 1))
def NoTable(argument):
    """A disc is rolled off the edge of a table by a force on its middle."""
    friction, finite = argument
    mesh = Grids(Block("disc", lambda s, t: Disc(s, t, 0.5), 10, 10),
                 Block("table", (-1.5, -0.8, 0.1, 0.0), 21, 6, quads=True))  # fmt: skip
    p = Problem(mesh, [("disc_bottom", "table_top")], {"disc": 1000.0, "table": 100.0},
                flags={"dirichlet": "table_bottom"}, law=Law(finite, friction),
                nonlinear=bool(finite))  # fmt: skip
    p.says = Says(f"{TIPS}|turns|slides|{AWAY}", "disc")
    p.Weight("disc", p.load * CF((0.25, -1.0)))
    return p


@problem((0.3, 0, 1.4), (0.3, 0, 2.4), (0.3, 1, 2.4))
def NoMiddle(argument):
    """Of three bricks of one material below a lid the middle one is pulled out.

    The weaker force would be held by a rigid lid, which rests on this brick alone.
    """
    friction, finite, force = argument
    bricks = [Block("brick", (1.2 * k, 0, 1.2 * k + 1, 0.4), 4, 2, quads=True) for k in range(3)]
    mesh = Grids(Block("base", (-0.4, -0.6, 3.8, 0), 19, 3), *bricks,
                 Block("lid", (-0.2, 0.4, 3.6, 0.8), 18, 2))  # fmt: skip
    pairs = [("brick_bottom", "base_top"), ("brick_top", "lid_bottom")]
    p = Problem(mesh, pairs, dict.fromkeys(["base", "brick", "lid"], 100.0),
                law=Law(finite, friction), nonlinear=bool(finite),
                flags=HELD | {"dirichletx": "lid_top"})  # fmt: skip
    p.says = Says(SLIDES, "slides away|moves off", "brick", Which("2", 1.7))
    p.Traction("lid_top", p.load * CF((0, -1.0)))
    middle = IfPos(x - 1.1, 1.0, 0.0) * IfPos(2.3 - x, 1.0, 0.0)
    p.Weight("brick", p.load * CF((force / 0.4 * middle, 0)))
    return p


@problem(0.2)
def NoTresca(bound):
    """A force beyond Tresca's bound times the area."""
    mesh = Grids(Block("brick", (0, 0, 1, 0.3), 5, 2, quads=True),
                 Block("base", (-0.4, -0.8, 1.4, 0), 9, 4))  # fmt: skip
    p = Problem(mesh, PAIR, YOUNG, flags=HELD, law=Law(False, tresca=bound))  # fmt: skip
    p.says = Says(SLIDES, "slides away", "brick")
    p.Traction("brick_top", p.load * CF((1.1 * bound, -1.0)))
    return p


@problem((0.2, 0), (0.4, 0), (0.3, 1))
def NoCapstan(argument):
    """A belt around half of a drum is pulled harder than friction and the other end hold."""
    friction, finite = argument

    def belt(s, t):
        r, angle = 1.0 + 0.06 * t, np.pi * (1 - s)
        return r * np.cos(angle), r * np.sin(angle)

    def drum(s, t):
        r, angle = 0.5 + 0.5 * t, np.pi * (1.1 - 1.2 * s)
        return r * np.cos(angle), r * np.sin(angle)

    mesh = Grids(Block("belt", belt, 24, 1, quads=True), Block("drum", drum, 31, 3))
    p = Problem(mesh, [("belt_bottom", "drum_top")], {"belt": 1000.0, "drum": 1000.0},
                flags={"dirichlet": "drum_bottom"}, law=Law(finite, friction),
                nonlinear=bool(finite))  # fmt: skip
    # Of a belt that bends as it slides large ways no rigid motion tells.
    words = "exceed what friction can carry" if finite else f"turns|slides away|moves off|{SLIDES}"
    p.says = Says(words, "belt")
    pull = 1.3 * np.exp(friction * np.pi)
    p.Traction("belt_left", p.load * CF((0, -1.0)))
    p.Traction("belt_right", p.load * CF((0, -pull)))
    return p
