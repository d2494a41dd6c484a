"""Stress set: units and places, orders and element shapes, tied parts, obstacles that move."""

import numpy as np
from ngsolve import CF, Parameter, cos, sin, x, y
from stress_blocks2d import Waves
from stress_meshes import Block, Block3D, Grids, Grids3D, Part, Plate, Sketch
from stress_problem import Problem, problem

from ngslac import BubbleVectorH1

PAIR = [("upper_bottom", "lower_top")]


@problem(
    (1e-6, 1e-6, 0),
    (1e12, 1e-6, 0),
    (1e-6, 1e3, 0),
    (1e12, 1e3, 0),
    (1.0, 1e-6, 1),
    (2.1e11, 1e-3, 0),
    (2.1e5, 1e3, 1),
    (1.0, 1.0, 100),
    (1e12, 1e-6, 10),
    (1e-6, 1e3, 30),
)
def Units(argument):
    """Two rubbing blocks in any units, far from the origin; driven, linear."""
    young, size, far = argument
    wave = Waves(7, 0.02)

    def upper(s, t):
        low = wave(s) + 0.02
        return size * (s + far), size * (low + t * (1 - low) - 0.7 * far)

    def lower(s, t):
        return size * (-0.3 + 1.6 * s + far), size * (t - 1 - 0.7 * far)

    mesh = Grids(Block("upper", upper, 9, 5), Block("lower", lower, 11, 5, quads=True))
    p = Problem(mesh, PAIR, {"upper": young, "lower": 0.4 * young}, law={"friction": 0.4},
                flags={"dirichlet": "lower_bottom|upper_top"}, path=[(1.0, 2)])  # fmt: skip
    p.prescribe = {"upper_top": size * p.load * CF((0.03, -0.06))}
    return p


@problem((1e-6, 1e-6), (1e12, 1e-6), (1e-6, 1e3), (1e12, 1e3), (2.1e11, 1e-3))
def LargeUnits(argument):
    """A brick held by friction alone with finite sliding, in any units."""
    young, size = argument

    def Scaled(x0, y0, x1, y1):
        return tuple(size * np.array((x0, y0, x1, y1)))

    mesh = Grids(Block("upper", Scaled(0, 0.01, 1, 0.6), 5, 3, quads=True),
                 Block("lower", Scaled(-0.4, -0.6, 1.4, 0), 7, 4))  # fmt: skip
    p = Problem(mesh, PAIR, {"upper": young, "lower": young}, nonlinear=True,
                law={"friction": 0.5, "finite": True}, flags={"dirichlet": "lower_bottom"},
                )  # fmt: skip
    p.Traction("upper_top", 0.03 * young * p.load * CF((0.2, -1)))
    return p


@problem((1, "patches", 0), (1, "bubble", 0), (2, "p2", 0), (3, "p3", 1), (1, "bubble", 1),
         (2, "bubble", 0), (4, "p4", 0), (1, "patches", 1))  # fmt: skip
def Orders(argument):
    """Displacements of order 1 to 4, triangles or quadrilaterals."""
    order, kind, quads = argument
    mesh = Grids(Block("upper", (0, 0.01, 1, 0.8), 9, 4, bool(quads)),
                 Block("lower", (-0.3, -0.8, 1.3, 0), 13, 4, bool(quads)))  # fmt: skip
    space = {"space": BubbleVectorH1} if kind == "bubble" else {}
    p = Problem(mesh, PAIR, {"upper": 100.0, "lower": 100.0}, order=order, law={"friction": 0.5},
                flags={"dirichlet": "lower_bottom|upper_top"}, path=[(1.0, 2)],
                **space)  # fmt: skip
    p.prescribe = {"upper_top": p.load * CF((0.03, -0.05))}
    return p


@problem(
    ("tet", 1, 0),
    ("tet", 2, 0),
    ("hex", 1, 0),
    ("hex", 3, 0),
    ("prism", 1, 0),
    ("prism", 2, 0),
    ("prism_side", 2, 0),
    ("pyramid", 2, 0),
    ("tet", 1, 1),
    ("hex", 1, 1),
    ("tet", 2, 1),
)
def Kinds3D(argument):
    """Every element shape, order 1 to 3, with patches of faces or with bubbles."""
    kind, order, bubble = argument
    mesh = Grids3D(
        Block3D("upper", (0, 0, 0.01, 1, 1, 0.6), (3, 3, 1), kind),
        Block3D("lower", (-0.3, -0.25, -0.6, 1.3, 1.35, 0), (4, 3, 1), "hex"),
    )
    space = {"space": BubbleVectorH1} if bubble else {}
    p = Problem(mesh, PAIR, {"upper": 100.0, "lower": 100.0}, order=order, law={"friction": 0.5},
                flags={"dirichlet": "lower_bottom|upper_top"}, **space)  # fmt: skip
    p.prescribe = {"upper_top": p.load * CF((0.03 - 0.02 * y, 0.02 * x, -0.05))}
    return p


@problem((0.3, 2), (0.0, 1), (1.0, 5))
def Unstructured(argument):
    """Unstructured triangles of different size; a punch on a half plane."""
    friction, steps = argument
    mesh = Sketch(
        Part("upper", Plate(-0.5, 0.01, 0.5, 0.6), 0.2,
             {"bottom": [(0, 0.01)], "top": [(0, 0.6)]}, {"bottom": 0.11}),
        Part("lower", Plate(-1, -1, 1, 0), 0.4, {"bottom": [(0, -1)], "top": [(0, 0)]},
             {"top": 0.13}),
    )  # fmt: skip
    law = {"friction": friction} if friction else {}
    p = Problem(mesh, PAIR, {"upper": 1e4, "lower": 1.0}, law=law, outlines=False,
                flags={"dirichlet": "lower_bottom|upper_top"}, path=[(1.0, steps)])  # fmt: skip
    p.prescribe = {"upper_top": p.load * CF((0.03, -0.06))}
    return p


# --- tied parts, obstacles, thermal strain -------------------------------------------------------


@problem((0.3, 1), (0.8, 5), (0.0, 2))
def TiedAndLoose(argument):
    """A coating is tied to a block, which is pressed on another one and pushed aside."""
    friction, steps = argument
    mesh = Grids(
        Block("lower", (-0.3, -0.8, 1.3, 0), 11, 4),
        Block("coat", (0, 0.01, 1, 0.11), 14, 1, quads=True),
        Block("upper", (0, 0.11, 1, 0.7), 6, 3),
    )
    pairs = [("coat_bottom", "lower_top"), ("coat_top", "upper_bottom")]
    law = {"friction": friction} if friction else {}
    p = Problem(mesh, pairs, {"lower": 100.0, "coat": 1.0, "upper": 100.0},
                own={0: law, 1: {"tied": True}}, path=[(1.0, steps)],
                flags={"dirichlet": "lower_bottom|upper_top"})  # fmt: skip
    p.prescribe = {"upper_top": p.load * CF((0.02, -0.03))}
    return p


@problem((0.5, "hex"), (0.2, "tet"))
def TiedAndLoose3D(argument):
    """The same in three dimensions, under a force."""
    friction, kind = argument
    mesh = Grids3D(
        Block3D("lower", (-0.3, -0.3, -0.6, 1.3, 1.3, 0), (3, 3, 1), "hex"),
        Block3D("coat", (0, 0, 0, 1, 1, 0.2), (3, 3, 1), "hex"),
        Block3D("upper", (0, 0, 0.2, 1, 1, 0.7), (2, 2, 1), kind),
    )
    pairs = [("coat_bottom", "lower_top"), ("coat_top", "upper_bottom")]
    p = Problem(mesh, pairs, {"lower": 100.0, "coat": 10.0, "upper": 100.0},
                own={0: {"friction": friction}, 1: {"tied": True}},
                flags={"dirichlet": "lower_bottom"})  # fmt: skip
    p.Traction("upper_top", p.load * CF((0.05, 0.03, -1.0)))
    return p


@problem((0.0, 1, 0.05), (0.4, 5, 0.05), (1.0, 2, 0.03), (0.4, 20, 0.04))
def MovingFloor(argument):
    """A block is held at its top; a rigid wavy floor comes up by more than the gap."""
    friction, steps, rise = argument
    mesh = Grids(Block("block", (0, 0, 1, 0.6), 11, 5))
    load = Parameter(0.0)
    gap = 0.02 + 0.01 * sin(5 * x) - rise * load
    law = {"friction": friction} if friction else {}
    return Problem(mesh, [("block_bottom", gap)], {"block": 100.0}, law=law, load=load,
                   flags={"dirichlet": "block_top"}, path=[(1.0, steps)])  # fmt: skip


@problem((0.3, 2), (0.0, 3))
def MovingFloor3D(argument):
    """The same in three dimensions."""
    friction, steps = argument
    mesh = Grids3D(Block3D("brick", (0, 0, 0, 1, 1, 0.5), (3, 3, 1), "prism"))
    load = Parameter(0.0)
    gap = 0.02 + 0.01 * sin(4 * x) * cos(3 * y) - 0.05 * load
    law = {"friction": friction} if friction else {}
    return Problem(mesh, [("brick_bottom", gap)], {"brick": 100.0}, law=law, load=load,
                   flags={"dirichlet": "brick_top"}, path=[(1.0, steps)])  # fmt: skip


@problem((0.0, 1), (0.3, 2), (1.0, 5))
def Swelling(argument):
    """A block between clamped walls grows until it touches both, and the floor."""
    friction, steps = argument
    mesh = Grids(
        Block("inner", (0, 0, 1, 0.5), 9, 5, quads=True),
        Block("left", (-0.6, -0.2, -0.004, 0.7), 4, 8),
        Block("right", (1.003, -0.2, 1.6, 0.7), 4, 7),
    )
    pairs = [("inner_left", "left_right"), ("inner_right", "right_left")]
    law = {"friction": friction} if friction else {}
    p = Problem(mesh, pairs, {"inner": 100.0, "left": 300.0, "right": 30.0}, law=law,
                flags={"dirichlet": "left_left|right_right", "dirichlety": "inner_bottom"},
                path=[(1.0, steps)])  # fmt: skip
    p.Spring("inner_bottom", CF((0, 0)), 1e-3)
    p.Growth("inner", 0.02 * p.load)
    return p


@problem((2, 1), (3, 1), (2, 3))
def HalfHeld(argument):
    """The tangential displacement of the slave side is prescribed; there is no friction."""
    order, steps = argument
    mesh = Grids(
        Block("upper", (0, 0.01, 1, 0.5), 8, 3), Block("lower", (-0.3, -0.6, 1.3, 0), 11, 4)
    )
    p = Problem(mesh, PAIR, {"upper": 100.0, "lower": 100.0}, order=order, path=[(1.0, steps)],
                flags={"dirichlet": "lower_bottom", "dirichletx": "upper_bottom|upper_top"},
                )  # fmt: skip
    p.Traction("upper_top", p.load * CF((0, -1.0)))
    return p
