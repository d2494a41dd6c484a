"""Stress set: thin plates in bending contact, and the flat ring that touches itself."""

import numpy as np
from ngsolve import x
from stress_meshes import Grids, Polar
from stress_problem import Problem, problem


def Leaves(gap, n, friction, length=1.0, kind="quad", **options):
    """Two thin plates, t = L / 50, clamped at the left."""
    mesh = Grids(
        upper=((0, gap, 1, gap + 0.02), (n[0], 1), kind),
        lower=((0, -0.02, length, 0), (n[1], 1), kind),
    )
    return Problem(mesh, 1e5, friction=friction or None, held="upper_left|lower_left", **options)


@problem((0.0, 0.0, 1), (0.2, 0.0, 1), (0.5, 0.0, 1), (0.0, 0.01, 1), (0.2, 0.01, 1),
         (0.5, 0.01, 2), (1.5, 0.0, 1), (0.2, 0.0, 5), (0.0, 0.0, 20),
         (0.5, 0.01, 20))  # fmt: skip
def Leaf(friction, gap, steps):
    """Two cantilevers are bent by a force at the end of the upper one."""
    return Leaves(gap, (20, 17), friction, steps=steps).Traction("upper_right", (0, -3.0))


@problem((0.0, 2, 0.7), (0.3, 2, 1.3), (0.3, 3, 1.0), (0.0, 3, 0.7), (0.3, 1, 1.0))
def LeafMeshes(friction, order, length):
    """A shorter or longer lower plate, triangles, and other orders."""
    n = (20, 23) if order > 1 else (48, 40)
    return Leaves(0.0, n, friction, length, "trig", order=order).Traction("upper_right", (0, -3.0))


@problem((0.0, 1), (0.3, 1), (0.3, 5), (0.8, 2))
def LeafPressed(friction, steps):
    """A pressure on the upper plate, in proportion to the load, and no gap."""
    return Leaves(0.0, (16, 19), friction, steps=steps).Traction("upper_top", (0, -0.05))


@problem((0.0, 1), (0.3, 2))
def LeafOnSupports(friction, steps):
    """The upper plate lies on a lower one between two blocks, pressed in its middle."""
    lower = ((0, -0.02, 1, 0), (21, 1), "quad")
    mesh = Grids(upper=((0.1, 0, 0.9, 0.016), (19, 1), "quad"), lower=lower)
    options = {"held": "lower_left|lower_right", "steps": steps}
    p = Problem(mesh, 1e5, friction=friction or None, **options).Spring("upper_top", (0, 0), 1e-2)
    return p.Traction("upper_top", (0, -1 - 20 * (x - 0.1) * (0.9 - x)))


@problem((0.0, 2), (0.3, 2), (0.3, 5), (0.0, 10))
def LargeLeaf(friction, steps):
    """Large bending with finite sliding, driven at the end of the upper plate."""
    options = {"heldy": "upper_right", "prescribe": {"upper_right": (0, -0.25)}, "finite": True}
    return Leaves(0.005, (20, 17), friction, 0.9, steps=steps, **options)


@problem((0.0, 1), (0.3, 1), (0.3, 3))
def Leaf3D(friction, steps):
    """Two thin plates in three dimensions."""
    lower = ((0, -0.05, -0.02, 1, 0.35, 0), (9, 3, 1))
    mesh = Grids(upper=((0, 0, 0, 1, 0.3, 0.02), (10, 2, 1)), lower=lower)
    options = {"held": "upper_left|lower_left", "steps": steps}
    p = Problem(mesh, 1e5, friction=friction or None, **options)
    return p.Traction("upper_right", (0, 0, -3.0))


@problem((0.3, 1), (0.0, 1))
def ThreeLeaves(friction, steps):
    """A spring of three leaves, each shorter than the one above."""
    thin, names = 0.02, ["upper", "middle", "lower"]
    places = [(0, -k * thin, 1 - 0.25 * k, (1 - k) * thin) for k in range(3)]
    leaves = {names[k]: (places[k], (20 - 3 * k, 1), "quad") for k in range(3)}
    pairs, held = [("upper", "middle"), ("middle", "lower")], "upper_left|middle_left|lower_left"
    p = Problem(Grids(**leaves), 1e5, pairs, friction or None, held=held, steps=steps)
    return p.Traction("upper_right", (0, -3.0))


PATHS = {
    "first": [(0.01, 1), (0.5, 5)],
    "twice": [(0.01, 1), (0.02, 1), (1.0, 10)],
    "flat": [(1.6, 16)],
    "all": [(0.01, 1), (1.6, 30)],
}


@problem(("first", 0.2, 24), ("twice", 0.0, 24), ("flat", 0.2, 24), ("all", 0.2, 32),
         ("flat", 0.0, 28))  # fmt: skip
def FlatRing(path, friction, n):
    """Half a rubber ring is pressed flat until its inside touches; some first steps are tiny."""
    mesh = Grids(
        ring=(lambda s, t: Polar(np.pi * (s - 0.5), 1 - 0.15 * t), (n, 2), "quad"),
        floor=((-0.3, -1.2, 2.2, -1), (n, 2), "quad"),
        press=((-0.3, 1, 2.2, 1.2), (n - 3, 2), "quad"),
    )
    pairs = [("ring_bottom", "floor_top|press_bottom"), ("ring_top", "ring_top")]
    sides = {"held": "floor_bottom", "heldx": "ring_left|ring_right"}
    sides |= {"drive": {"press_top": (0, -1)}}
    options = {"nu": 0.33, "own": {1: {"penetration": 0.07}}, "path": PATHS[path]}
    young = {"ring": 2.67, "floor": 2670.0, "press": 2670.0}
    return Problem(mesh, young, pairs, friction or None, True, **sides, **options)
