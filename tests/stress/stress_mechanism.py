"""Stress set: mechanisms whose loads do work on a motion that nothing resists, with their words.

The error has to name the body and the motion; the smallest loads are far below those in balance.
"""

import numpy as np
from netgen.occ import Box, Circle, Compound, Cylinder, OCCGeometry, Pnt, X, Z
from ngsolve import Mesh, x, y, z
from stress_idle import DiscInHole, Socket
from stress_meshes import Grids, Part, Plate, Polar, Rotated, Sketch
from stress_problem import Problem, problem
from stress_unsolvable import Says

TURNS = r"rotation|turns"


# --- in the plane --------------------------------------------------------------------------------


def Hanging(h=0.2):
    """A bar hangs with its hole on a pin with play, and touches it."""
    bar = Plate(-0.3, -2.01, 0.3, 0.29) - Circle((0, -0.01), 0.15).Face()
    pin = Circle((0, 0), 0.14).Face() - Circle((0, 0), 0.05).Face()
    return Sketch(
        Part("bar", bar, h, {"hole": [(0.15, -0.01)]}, {"hole": 0.06}),
        Part("pin", pin, 0.05, {"round": [(0.14, 0)], "inside": [(0.05, 0)]}, {"round": 0.05}),
        curve=3,
    )


@problem(1.0, 0.1, 1e-3)
def NoPendulum(aside):
    """A bar on a pin without friction, its weight has a part to the side."""
    says = Says("bar", TURNS)
    p = Problem(Hanging(), 1000.0, [("bar_hole", "pin_round")], held="pin_inside", says=says)
    return p.Weight("bar", (aside, -1.0))


@problem((1e-1, 0), (1e-2, 0), (1e-3, 0), (1e-2, 1))
def NoSpin(torque, exchanged):
    """A heavy disc in a hole without friction, and a torque."""
    pairs = [("disc_round", "plate_round")]
    pairs = [(m, s) for s, m in pairs] if exchanged else pairs
    mesh = DiscInHole(0.96, -0.04, 3)
    p = Problem(mesh, pairs=pairs, held="plate_far", says=Says("disc", TURNS))
    return p.Weight("disc", (0, -1.0)).Weight("disc", (-torque * (y + 0.04), torque * x))


@problem((10.0, 0), (1.0, 0), (0.01, 0), (10.0, 1))
def NoSlopeAtAll(degrees, finite):
    """A block without friction on a slope, down to one that is hardly any."""
    mesh = Grids(
        brick=(Rotated(lambda s, t: (s, 0.4 * t), degrees), (5, 2), "quad"),
        base=(Rotated(lambda s, t: (-0.4 + 1.8 * s, -0.8 + 0.8 * t), degrees), (9, 4)),
    )
    says = Says("brick", r"translation|slides|pulled|float")
    p = Problem(mesh, 100.0, [("brick", "base")], finite=bool(finite), says=says)
    return p.Weight("brick", (0, -1.0))


def Wheel():
    """A wheel on a plane."""
    disc = Circle((0, 0.5), 0.5).Face()
    return Sketch(
        Part("wheel", disc, 0.15, {"round": [(0, 0)]}),
        Part("road", Plate(-1.5, -0.6, 1.5, 0), 0.35, {"top": [(0, 0)], "bottom": [(0, -0.6)]},
             {"top": 0.13}),
        curve=3,
    )  # fmt: skip


@problem(0.1, 1e-3)
def NoWheel(torque):
    """A torque on a heavy wheel on a plane without friction, which spins."""
    p = Problem(Wheel(), 1000.0, [("wheel_round", "road_top")], held="road_bottom",
                says=Says("wheel", TURNS))  # fmt: skip
    return p.Weight("wheel", (0, -1.0)).Weight("wheel", (-torque * (y - 0.5), torque * x))


@problem(0.5, 0.05)
def NoLever(excess):
    """A lever on a round fulcrum without friction, one of its arms loaded more than the other."""

    def fulcrum(s, t):
        px, py = Polar(np.pi * (0.75 - 0.5 * s), 0.5)
        return px * t + 0.8 * (s - 0.5) * (1 - t), (py - 0.5) * t - 0.7 * (1 - t)

    mesh = Grids(lever=((-1, 0, 1, 0.2), (22, 2), "quad"), fulcrum=(fulcrum, (15, 5), "quad"))
    p = Problem(mesh, 1000.0, [("lever", "fulcrum_top")], held="fulcrum_bottom",
                says=Says("lever", TURNS + "|tips"))  # fmt: skip
    return p.Traction("lever_left", (0, -1.0)).Traction("lever_right", (0, -1.0 - excess))


# --- in space ------------------------------------------------------------------------------------


@problem(("x", 0.1), ("z", 0.1))
def NoBall(axis, torque):
    """A heavy ball in a socket without friction, and a torque."""
    p = Problem(Socket(2), pairs=[("ball_round", "block_hollow")], held="block_far",
                says=Says("ball", TURNS))  # fmt: skip
    high = z + 0.05
    turn = (0, -torque * high, torque * y) if axis == "x" else (-torque * y, torque * x, 0)
    return p.Weight("ball", (0, 0, -1.0)).Weight("ball", turn)


@problem(0.1, 1e-3)
def NoPiston(push):
    """A heavy cylinder that lies in a bore without friction is pushed along its axis."""
    piston = Cylinder(Pnt(-0.8, 0, -0.03), X, 0.47, 1.6)
    block = Box(Pnt(-1, -1, -1), Pnt(1, 1, 1)) - Cylinder(Pnt(-2, 0, 0), X, 0.5, 4)
    for body, name, h in (piston, "piston", 0.4), (block, "block", 0.9):
        body.mat(name)
        body.faces.name, body.maxh = f"{name}_free", h
    piston.faces.Nearest(Pnt(0, 0, 0.44)).name = "piston_round"
    block.faces.Nearest(Pnt(0, 0, 0.5)).name = "block_bore"
    block.faces.Min(Z).name = "block_far"
    mesh = Mesh(OCCGeometry(Compound([piston, block])).GenerateMesh(grading=0.8)).Curve(2)
    p = Problem(mesh, 100.0, [("piston_round", "block_bore")], held="block_far",
                says=Says("piston", "translation in x|float|pulled|slides"))  # fmt: skip
    return p.Weight("piston", (push, 0, -1.0))


@problem(0.1, 1e-3)
def NoSlide3D(push):
    """A block without friction on a flat base is pushed aside, along no edge of it."""
    mesh = Grids(
        brick=((-0.6, -0.55, 0, 0.6, 0.65, 0.5), (3, 3, 2)),
        base=((-1, -1, -0.8, 1, 1, 0), (4, 4, 2)),
    )
    says = Says("brick", "translation|slides|float|pulled")
    p = Problem(mesh, 100.0, [("brick", "base")], says=says)
    return p.Weight("brick", (push, 0.5 * push, -1.0))
