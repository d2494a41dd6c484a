"""Stress set in three dimensions: small meshes, the same troubles."""

import numpy as np
from ngsolve import CF, cos, sin, x, y
from stress_check import Require
from stress_meshes import Block3D, Grids3D
from stress_problem import Problem, problem

PAIR = [("upper_bottom", "lower_top")]
CLAMPED = {"dirichlet": "lower_bottom"}


def TwoBoxes(n=(3, 3), kinds=("hex", "hex"), gap=0.01, waves=0.0, seed=0):
    """A block with a wavy lower side above a wider one."""
    phase = np.random.default_rng(seed).uniform(0, 6, 2)

    def bend(points):
        px, py, pz = points.T
        wave = waves * np.sin(4 * px + phase[0]) * np.cos(3 * py + phase[1])
        return np.stack([px, py, pz + wave * (1 - (pz - gap) / 0.6)], axis=1)

    return Grids3D(
        Block3D("upper", (0, 0, gap, 1, 1, gap + 0.6), (n[0], n[0], 2), kinds[0], bend),
        Block3D("lower", (-0.25, -0.3, -0.6, 1.3, 1.25, 0), (n[1], n[1] + 1, 2), kinds[1]),
    )


def Pressed(mesh, motion, young=(100.0, 60.0), **flags):
    bodies = dict(zip(("upper", "lower"), young, strict=True))
    p = Problem(mesh, PAIR, bodies, **{"flags": CLAMPED} | flags)
    p.Spring("upper_top", p.load * CF(motion), 10 * min(young))
    return p


@problem((1, 0.0), (2, 0.4), (3, 1.5))
def RandomGap3D(argument):
    """A brick pressed on a rigid wavy plane in one step, and sheared."""
    seed, friction = argument
    mesh = Grids3D(Block3D("brick", (0, 0, 0, 1, 1, 0.5), (4, 4, 2), "prism"))
    a, b = np.random.default_rng(seed).uniform(0, 6, 2)
    gap = 0.02 + 0.02 * sin(4 * x + a) * cos(5 * y + b)
    p = Problem(mesh, [("brick_bottom", gap)], {"brick": 100.0}, law={"friction": friction})
    p.Spring("brick_top", p.load * CF((0.03, 0.02, -0.06)), 500)
    return p


@problem((1, 0.2), (2, 0.7), (3, 1.5))
def RandomSurface3D(argument):
    """Two bricks with random gaps, pressed, pushed aside and turned in one step."""
    seed, friction = argument
    mesh = TwoBoxes((4, 3), (["hex", "prism", "tet"][seed - 1], "hex"), waves=0.02, seed=seed)
    motion = (0.03 - 0.04 * (y - 0.5), 0.04 * (x - 0.5), -0.05)
    return Pressed(mesh, motion, law={"friction": friction})


@problem()
def BadStart3D():
    """A random start vector of displacements and tractions."""
    p = Pressed(TwoBoxes((3, 3)), (0.02, 0.01, -0.05), law={"friction": 0.4})
    values, free = p.gf.vec.FV().NumPy(), p.X.FreeDofs()
    values[:] = np.random.default_rng(5).normal(size=len(values)) * [bool(b) for b in free]
    values[: p.X.components[0].ndof] *= 0.1
    values[p.X.components[0].ndof :] *= 30
    return p


@problem((6, 2), (2, 6))
def Meshes3D(n):
    """A fine against a coarse mesh, and the reverse."""
    return Pressed(TwoBoxes(n, waves=0.01), (0.03, -0.02, -0.05), law={"friction": 0.5})


@problem(0.3, 1.0)
def Brick3D(friction):
    """A brick with four macro-elements above a rigid plane, heavy, pushed aside."""
    mesh = Grids3D(Block3D("brick", (0, 0, 0, 1, 1, 0.5), (2, 2, 1)))
    p = Problem(mesh, [("brick_bottom", CF(0.01))], {"brick": 100.0}, law={"friction": friction})
    p.Traction("brick_top", p.load * CF((0.1, 0.05, -1)))

    def exact(p):
        force = p.contacts[0].Force()
        Require(np.abs(force - [-0.1, -0.05, 1]).max(), 1e-6, "resultant")

    p.exact = exact
    return p


@problem()
def Plate3D():
    """A thin plate, pressed into a valley."""

    def valley(points):
        px, py, pz = points.T
        return np.stack([px, py, pz + (pz + 0.5) * (0.6 * (px - 0.5) ** 2 - 0.15)], axis=1)

    mesh = Grids3D(
        Block3D("upper", (0, 0, 0, 1, 0.5, 0.03), (9, 3, 1)),
        Block3D("lower", (-0.2, -0.2, -0.5, 1.2, 0.7, 0), (7, 4, 2), shape=valley),
    )
    p = Problem(mesh, PAIR, {"upper": 1000.0, "lower": 1000.0}, flags=CLAMPED,
                law={"friction": 0.3})  # fmt: skip
    p.Spring("upper_top", CF((0, 0, 0)), 1e-3)
    p.Traction("upper_top", p.load * CF((0, 0, -0.5)))
    return p


@problem()
def Cyclic3D():
    """Circular shear under changing pressure: the direction of slip turns."""
    mesh = TwoBoxes((3, 3), waves=0.005)
    p = Problem(mesh, PAIR, {"upper": 100.0, "lower": 100.0}, flags=CLAMPED,
                law={"friction": 0.4})  # fmt: skip
    motion = CF((0.04 * sin(6.283 * p.load), 0.04 * cos(6.283 * p.load), -0.04))
    p.Spring("upper_top", motion, 1000)
    p.path = [(1.0, 8)]
    return p


@problem()
def PressAndLift3D():
    """Pressed in one step, lifted beyond the first gap in one step, pressed again."""
    p = Pressed(TwoBoxes((3, 4), ("tet", "hex")), (0.02, 0.01, -0.05), law={"friction": 0.8})
    p.path = [(1.0, 1), (-1.0, 1), (1.0, 1)]
    return p


@problem()
def Rubber3D():
    """Nearly incompressible neo-Hooke, compressed in one step."""
    mesh = TwoBoxes((2, 3))
    return Pressed(mesh, (0.02, 0, -0.06), young=(1.0, 1000.0), nu=0.49, nonlinear=True,
                   law={"friction": 0.5})  # fmt: skip
