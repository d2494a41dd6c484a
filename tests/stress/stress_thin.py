"""Stress set: thin plates in bending contact, and the flat ring that touches itself."""

import numpy as np
from ngsolve import CF, x
from stress_meshes import Block, Block3D, Grids, Grids3D
from stress_problem import Problem, problem

PAIR = [("upper_bottom", "lower_top")]
YOUNG = {"upper": 1e5, "lower": 1e5}


def Leaves(gap, n, thin=0.02, quads=True, length=1.0):
    """Two thin plates, clamped at the left."""
    return Grids(
        Block("upper", (0, gap, 1, gap + thin), n[0], 1, quads),
        Block("lower", (0, -thin, length, 0), n[1], 1, quads),
    )


def Law(friction, finite=False):
    return ({"friction": friction} if friction else {}) | ({"finite": True} if finite else {})


@problem((0.0, 0.0, 1), (0.2, 0.0, 1), (0.5, 0.0, 1), (0.0, 0.01, 1), (0.2, 0.01, 1),
         (0.5, 0.01, 2), (1.5, 0.0, 1), (0.2, 0.0, 5), (0.0, 0.0, 20),
         (0.5, 0.01, 20))  # fmt: skip
def Leaf(argument):
    """Two cantilevers, t = L / 50, are bent by a force at the end of the upper one."""
    friction, gap, steps = argument
    p = Problem(Leaves(gap, (20, 17)), PAIR, YOUNG, flags={"dirichlet": "upper_left|lower_left"},
                law=Law(friction), path=[(1.0, steps)])  # fmt: skip
    p.Traction("upper_right", p.load * CF((0, -3.0)))
    return p


@problem((0.0, 2, 0.7), (0.3, 2, 1.3), (0.3, 3, 1.0), (0.0, 3, 0.7), (0.3, 1, 1.0))
def LeafMeshes(argument):
    """A shorter or longer lower plate, triangles, and other orders."""
    friction, order, length = argument
    mesh = Leaves(0.0, (20, 23) if order > 1 else (48, 40), quads=False, length=length)
    p = Problem(mesh, PAIR, YOUNG, flags={"dirichlet": "upper_left|lower_left"}, order=order,
                law=Law(friction))  # fmt: skip
    p.Traction("upper_right", p.load * CF((0, -3.0)))
    return p


@problem((0.0, 1), (0.3, 1), (0.3, 5), (0.8, 2))
def LeafPressed(argument):
    """A pressure on the upper plate, in proportion to the load, and no gap."""
    friction, steps = argument
    p = Problem(Leaves(0.0, (16, 19)), PAIR, YOUNG, flags={"dirichlet": "upper_left|lower_left"},
                law=Law(friction), path=[(1.0, steps)])  # fmt: skip
    p.Traction("upper_top", p.load * CF((0, -0.05)))
    return p


@problem((0.0, 1), (0.3, 2))
def LeafOnSupports(argument):
    """The upper plate lies on a lower one between two blocks, pressed in its middle."""
    friction, steps = argument
    mesh = Grids(
        Block("upper", (0.1, 0, 0.9, 0.016), 19, 1, quads=True),
        Block("lower", (0, -0.02, 1, 0), 21, 1, quads=True),
    )
    p = Problem(mesh, PAIR, YOUNG, flags={"dirichlet": "lower_left|lower_right"},
                law=Law(friction), path=[(1.0, steps)])  # fmt: skip
    p.Spring("upper_top", CF((0, 0)), 1e-2)
    p.Traction("upper_top", p.load * CF((0, -1 - 20 * (x - 0.1) * (0.9 - x))))
    return p


@problem((0.0, 2), (0.3, 2), (0.3, 5), (0.0, 10))
def LargeLeaf(argument):
    """Large bending with finite sliding, driven at the end of the upper plate."""
    friction, steps = argument
    mesh = Leaves(0.005, (20, 17), length=0.9)
    p = Problem(mesh, PAIR, YOUNG, nonlinear=True, law=Law(friction, True),
                flags={"dirichlet": "upper_left|lower_left", "dirichlety": "upper_right"},
                path=[(1.0, steps)])  # fmt: skip
    p.prescribe = {"upper_right": CF((0, -0.25 * p.load))}
    return p


@problem((0.0, 1), (0.3, 1), (0.3, 3))
def Leaf3D(argument):
    """Two thin plates in three dimensions."""
    friction, steps = argument
    mesh = Grids3D(
        Block3D("upper", (0, 0, 0, 1, 0.3, 0.02), (10, 2, 1)),
        Block3D("lower", (0, -0.05, -0.02, 1, 0.35, 0), (9, 3, 1)),
    )
    p = Problem(mesh, PAIR, YOUNG, flags={"dirichlet": "upper_left|lower_left"}, law=Law(friction),
                path=[(1.0, steps)])  # fmt: skip
    p.Traction("upper_right", p.load * CF((0, 0, -3.0)))
    return p


@problem((0.3, 1), (0.0, 1))
def ThreeLeaves(argument):
    """A spring of three leaves, each shorter than the one above."""
    friction, steps = argument
    thin, names = 0.02, ["upper", "middle", "lower"]
    mesh = Grids(*[
        Block(name, (0, -k * thin, 1 - 0.25 * k, (1 - k) * thin), 20 - 3 * k, 1, quads=True)
        for k, name in enumerate(names)
    ])  # fmt: skip
    pairs = [("upper_bottom", "middle_top"), ("middle_bottom", "lower_top")]
    p = Problem(mesh, pairs, dict.fromkeys(names, 1e5), law=Law(friction), path=[(1.0, steps)],
                flags={"dirichlet": "|".join(f"{name}_left" for name in names)})  # fmt: skip
    p.Traction("upper_right", p.load * CF((0, -3.0)))
    return p


# --- a ring between plates -----------------------------------------------------------------------


def RingBetween(n, thickness=0.15):
    """The right half of a ring between two stiff plates."""

    def ring(s, t):
        angle, radius = np.pi * (s - 0.5), 1 - thickness * t
        return radius * np.cos(angle), radius * np.sin(angle)

    return Grids(
        Block("ring", ring, n, 2, quads=True),
        Block("floor", (-0.3, -1.2, 2.2, -1), n, 2, quads=True),
        Block("press", (-0.3, 1, 2.2, 1.2), n - 3, 2, quads=True),
    )


PATHS = {
    "first": [(0.01, 1), (0.5, 5)],
    "twice": [(0.01, 1), (0.02, 1), (1.0, 10)],
    "flat": [(1.6, 16)],
    "all": [(0.01, 1), (1.6, 30)],
}


@problem(("first", 0.2, 24), ("twice", 0.0, 24), ("flat", 0.2, 24), ("all", 0.2, 32),
         ("flat", 0.0, 28))  # fmt: skip
def FlatRing(argument):
    """A rubber ring is pressed flat until its inside touches itself; some first steps are tiny."""
    path, friction, n = argument
    pairs = [("ring_bottom", "floor_top|press_bottom"), ("ring_top", "ring_top")]
    p = Problem(RingBetween(n), pairs, {"ring": 2.67, "floor": 2670.0, "press": 2670.0}, nu=0.33,
                nonlinear=True, law=Law(friction, True), own={1: {"penetration": 0.07}},
                flags={"dirichlet": "floor_bottom|press_top", "dirichletx": "ring_left|ring_right"},
                path=PATHS[path], outlines=False)  # fmt: skip
    p.prescribe = {"press_top": CF((0, -p.load))}
    return p
