"""Stress set in three dimensions: small meshes, the same troubles."""

import numpy as np
from ngsolve import CF, cos, sin, x, y
from stress_blocks2d import Pushed
from stress_meshes import Grids
from stress_problem import Problem, problem


def TwoBoxes(n=(3, 3), kind="hex", gap=0.01, waves=0.0, seed=0):
    """A block with a wavy lower side above a wider one."""
    phase = np.random.default_rng(seed).uniform(0, 6, 2)

    def bend(points):
        px, py, pz = points.T
        wave = waves * np.sin(4 * px + phase[0]) * np.cos(3 * py + phase[1])
        return np.stack([px, py, pz + wave * (1 - (pz - gap) / 0.6)], axis=1)

    return Grids(
        upper=((0, 0, gap, 1, 1, gap + 0.6), (n[0], n[0], 2), kind, bend),
        lower=((-0.25, -0.3, -0.6, 1.3, 1.25, 0), (n[1], n[1] + 1, 2)),
    )


UNEQUAL = {"upper": 100.0, "lower": 60.0}  # Young's moduli
SPRING = 10 * 60.0


@problem((1, 0.0), (2, 0.4), (3, 1.5))
def RandomGap3D(seed, friction):
    """A brick pressed on a rigid wavy plane in one step, and sheared."""
    mesh = Grids(brick=((0, 0, 0, 1, 1, 0.5), (4, 4, 2), "prism"))
    a, b = np.random.default_rng(seed).uniform(0, 6, 2)
    gap = 0.02 + 0.02 * sin(4 * x + a) * cos(5 * y + b)
    p = Problem(mesh, pairs=[("brick", gap)], friction=friction)
    return p.Spring("brick_top", (0.03, 0.02, -0.06), 500)


@problem((1, 0.2), (2, 0.7), (3, 1.5))
def RandomSurface3D(seed, friction):
    """Two bricks with random gaps, pressed, pushed aside and turned in one step."""
    mesh = TwoBoxes((4, 3), ["hex", "prism", "tet"][seed - 1], waves=0.02, seed=seed)
    motion = (0.03 - 0.04 * (y - 0.5), 0.04 * (x - 0.5), -0.05)
    return Pushed(mesh, motion, SPRING, young=UNEQUAL, friction=friction)


@problem()
def BadStart3D():
    """A random start vector of displacements and tractions."""
    p = Pushed(TwoBoxes(), (0.02, 0.01, -0.05), SPRING, young=UNEQUAL, friction=0.4)
    return p.Scatter(5, 0.1, 30)


@problem((6, 2), (2, 6))
def Meshes3D(*n):
    """A fine against a coarse mesh, and the reverse."""
    mesh = TwoBoxes(n, waves=0.01)
    return Pushed(mesh, (0.03, -0.02, -0.05), SPRING, young=UNEQUAL, friction=0.5)


@problem(0.3, 1.0)
def Brick3D(friction):
    """A brick with four macro-elements above a rigid plane, heavy, pushed aside."""
    mesh, plane = Grids(brick=((0, 0, 0, 1, 1, 0.5), (2, 2, 1))), [("brick", CF(0.01))]
    p = Problem(mesh, pairs=plane, friction=friction, resultant=(-0.1, -0.05, 1))
    return p.Traction("brick_top", (0.1, 0.05, -1))


@problem()
def Plate3D():
    """A thin plate, pressed into a valley."""

    def valley(points):
        px, py, pz = points.T
        return np.stack([px, py, pz + (pz + 0.5) * (0.6 * (px - 0.5) ** 2 - 0.15)], axis=1)

    mesh = Grids(
        upper=((0, 0, 0, 1, 0.5, 0.03), (9, 3, 1)),
        lower=((-0.2, -0.2, -0.5, 1.2, 0.7, 0), (7, 4, 2), "hex", valley),
    )
    p = Pushed(mesh, (0, 0, 0), 1e-3, young=1000.0, friction=0.3)
    return p.Traction("upper_top", (0, 0, -0.5))


@problem()
def Cyclic3D():
    """Circular shear under changing pressure: the direction of slip turns."""

    def motion(t):
        return 0.04 * sin(6.283 * t), 0.04 * cos(6.283 * t), -0.04

    return Pushed(TwoBoxes(waves=0.005), motion, friction=0.4, steps=8)


@problem()
def PressAndLift3D():
    """Pressed in one step, lifted beyond the first gap in one step, pressed again."""
    path, mesh = [(1.0, 1), (-1.0, 1), (1.0, 1)], TwoBoxes((3, 4), "tet")
    options = {"young": UNEQUAL, "friction": 0.8, "path": path}
    return Pushed(mesh, (0.02, 0.01, -0.05), SPRING, **options)


@problem()
def Rubber3D():
    """Nearly incompressible neo-Hooke, compressed in one step."""
    rubber = {"young": {"upper": 1.0, "lower": 1000.0}, "nu": 0.49, "nonlinear": True}
    return Pushed(TwoBoxes((2, 3)), (0.02, 0, -0.06), 10.0, friction=0.5, **rubber)
