"""Stress set: units and places, orders and element shapes, tied parts, obstacles that move."""

import numpy as np
from ngsolve import CF, cos, sin, x, y
from stress_blocks import Waves
from stress_meshes import Grids, Part, Plate, Sketch
from stress_problem import Problem, problem


@problem((1e-6, 1e-6, 0), (1e12, 1e-6, 0), (1e-6, 1e3, 0), (1e12, 1e3, 0), (1.0, 1e-6, 1),
         (2.1e11, 1e-3, 0), (2.1e5, 1e3, 1), (1.0, 1.0, 100), (1e12, 1e-6, 10),
         (1e-6, 1e3, 30))  # fmt: skip
def Units(young, size, far):
    """Two rubbing blocks in any units, far from the origin; driven, linear."""
    wave = Waves(7, 0.02)

    def upper(s, t):
        low = wave(s) + 0.02
        return size * (s + far), size * (low + t * (1 - low) - 0.7 * far)

    def lower(s, t):
        return size * (-0.3 + 1.6 * s + far), size * (t - 1 - 0.7 * far)

    mesh = Grids(upper=(upper, (9, 5)), lower=(lower, (11, 5), "quad"))
    drive = {"upper_top": lambda t: size * t * CF((0.03, -0.06))}
    young = {"upper": young, "lower": 0.4 * young}
    return Problem(mesh, young, friction=0.4, drive=drive, steps=2)


@problem((1e-6, 1e-6), (1e12, 1e-6), (1e-6, 1e3), (1e12, 1e3), (2.1e11, 1e-3))
def LargeUnits(young, size):
    """A brick held by friction alone with finite sliding, in any units."""
    upper = tuple(size * np.array((0, 0.01, 1, 0.6)))
    lower = tuple(size * np.array((-0.4, -0.6, 1.4, 0)))
    mesh = Grids(upper=(upper, (5, 3), "quad"), lower=(lower, (7, 4)))
    p = Problem(mesh, young, friction=0.5, finite=True)
    return p.Traction("upper_top", 0.03 * young * p.load * CF((0.2, -1)))


@problem((1, "patches", 0), (1, "bubble", 0), (2, "p2", 0), (3, "p3", 1), (1, "bubble", 1),
         (2, "bubble", 0), (4, "p4", 0), (1, "patches", 1))  # fmt: skip
def Orders(order, space, quads):
    """Displacements of order 1 to 4, triangles or quadrilaterals."""
    kind = ("trig", "quad")[quads]
    lower = ((-0.3, -0.8, 1.3, 0), (13, 4), kind)
    mesh = Grids(upper=((0, 0.01, 1, 0.8), (9, 4), kind), lower=lower)
    options = {"friction": 0.5, "drive": {"upper_top": (0.03, -0.05)}, "steps": 2}
    return Problem(mesh, order=order, bubble=space == "bubble", **options)


@problem(("tet", 1, 0), ("tet", 2, 0), ("hex", 1, 0), ("hex", 3, 0), ("prism", 1, 0),
         ("prism", 2, 0), ("prism_side", 2, 0), ("pyramid", 2, 0), ("tet", 1, 1), ("hex", 1, 1),
         ("tet", 2, 1))  # fmt: skip
def Kinds3D(kind, order, bubble):
    """Every element shape, order 1 to 3, with patches of faces or with bubbles."""
    lower = ((-0.3, -0.25, -0.6, 1.3, 1.35, 0), (4, 3, 1))
    mesh = Grids(upper=((0, 0, 0.01, 1, 1, 0.6), (3, 3, 1), kind), lower=lower)
    drive = {"upper_top": (0.03 - 0.02 * y, 0.02 * x, -0.05)}
    return Problem(mesh, order=order, bubble=bool(bubble), friction=0.5, drive=drive)


@problem((0.3, 2), (0.0, 1), (1.0, 5))
def Unstructured(friction, steps):
    """Unstructured triangles of different size; a punch on a half plane."""
    above = {"bottom": [(0, 0.01)], "top": [(0, 0.6)]}
    below = {"bottom": [(0, -1)], "top": [(0, 0)]}
    mesh = Sketch(
        Part("upper", Plate(-0.5, 0.01, 0.5, 0.6), 0.2, above, {"bottom": 0.11}),
        Part("lower", Plate(-1, -1, 1, 0), 0.4, below, {"top": 0.13}),
    )
    options = {"drive": {"upper_top": (0.03, -0.06)}, "steps": steps}
    return Problem(mesh, {"upper": 1e4, "lower": 1.0}, friction=friction or None, **options)


# --- tied parts, obstacles, thermal strain -------------------------------------------------------


def Coated(mesh, coat, friction, **options):
    """A coating is tied to a block, which is pressed on another one."""
    own = {0: {"friction": friction} if friction else {}, 1: {"tied": True}}
    young = {"lower": 100.0, "coat": coat, "upper": 100.0}
    pairs = [("coat", "lower"), ("coat_top", "upper_bottom")]
    return Problem(mesh, young, pairs, own=own, **options)


@problem((0.3, 1), (0.8, 5), (0.0, 2))
def TiedAndLoose(friction, steps):
    """The block is pushed aside."""
    mesh = Grids(
        lower=((-0.3, -0.8, 1.3, 0), (11, 4)),
        coat=((0, 0.01, 1, 0.11), (14, 1), "quad"),
        upper=((0, 0.11, 1, 0.7), (6, 3)),
    )
    return Coated(mesh, 1.0, friction, steps=steps, drive={"upper_top": (0.02, -0.03)})


@problem((0.5, "hex"), (0.2, "tet"))
def TiedAndLoose3D(friction, kind):
    """The same in three dimensions, under a force."""
    mesh = Grids(
        lower=((-0.3, -0.3, -0.6, 1.3, 1.3, 0), (3, 3, 1)),
        coat=((0, 0, 0, 1, 1, 0.2), (3, 3, 1)),
        upper=((0, 0, 0.2, 1, 1, 0.7), (2, 2, 1), kind),
    )
    return Coated(mesh, 10.0, friction).Traction("upper_top", (0.05, 0.03, -1.0))


def OnFloor(mesh, friction, gap, steps):
    """A block is held at its top above a rigid floor that moves."""
    options = {"held": "block_top", "steps": steps}
    return Problem(mesh, pairs=[("block", gap)], friction=friction or None, **options)


@problem((0.0, 1, 0.05), (0.4, 5, 0.05), (1.0, 2, 0.03), (0.4, 20, 0.04))
def MovingFloor(friction, steps, rise):
    """A wavy floor comes up by more than the gap."""
    mesh = Grids(block=((0, 0, 1, 0.6), (11, 5)))
    return OnFloor(mesh, friction, lambda t: 0.02 + 0.01 * sin(5 * x) - rise * t, steps)


@problem((0.3, 2), (0.0, 3))
def MovingFloor3D(friction, steps):
    """The same in three dimensions."""
    mesh = Grids(block=((0, 0, 0, 1, 1, 0.5), (3, 3, 1), "prism"))
    wave = 0.02 + 0.01 * sin(4 * x) * cos(3 * y)
    return OnFloor(mesh, friction, lambda t: wave - 0.05 * t, steps)


@problem((0.0, 1), (0.3, 2), (1.0, 5))
def Swelling(friction, steps):
    """A block between clamped walls grows until it touches both, and the floor."""
    mesh = Grids(
        inner=((0, 0, 1, 0.5), (9, 5), "quad"),
        left=((-0.6, -0.2, -0.004, 0.7), (4, 8)),
        right=((1.003, -0.2, 1.6, 0.7), (4, 7)),
    )
    pairs = [("inner_left", "left_right"), ("inner_right", "right_left")]
    young = {"inner": 100.0, "left": 300.0, "right": 30.0}
    sides = {"held": "left_left|right_right", "heldy": "inner_bottom"}
    p = Problem(mesh, young, pairs, friction or None, steps=steps, **sides)
    return p.Spring("inner_bottom", (0, 0), 1e-3).Growth("inner", 0.02)


@problem((2, 1), (3, 1), (2, 3))
def HalfHeld(order, steps):
    """The tangential displacement of the slave side is prescribed; there is no friction."""
    mesh = Grids(upper=((0, 0.01, 1, 0.5), (8, 3)), lower=((-0.3, -0.6, 1.3, 0), (11, 4)))
    p = Problem(mesh, order=order, steps=steps, heldx="upper_bottom|upper_top")
    return p.Traction("upper_top", (0, -1.0))
