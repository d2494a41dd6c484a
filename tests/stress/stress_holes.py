"""Stress set: round things in round holes, press fits, snap fits, balls in bowls."""

import numpy as np
from netgen.occ import Circle
from ngsolve import CF, IfPos, x, y
from stress_floating2d import Disc
from stress_meshes import Block, Block3D, Grids, Grids3D, Part, Plate, Sketch
from stress_problem import Problem, problem

RADIUS = 10.0


def HalfPin(play, n):
    """The right half of a pin that touches the bottom of a hole, and the plate around it."""
    pin = Circle((0, -play), RADIUS).Face() * Plate(0, -50, 50, 50)
    plate = Plate(0, -40, 40, 40) - Circle((0, 0), RADIUS + play).Face()
    for face in (pin, plate):
        face.edges.maxh = 8.0
    h = np.pi * RADIUS / n
    around = {"round": [(RADIUS, -play)]}
    mesh = Sketch(
        Part("pin", pin, 3.0, {"axis": [(0, 0)]} | around, {"round": h}),
        Part("plate", plate, 12.0,
             {"axis": [(0, 25), (0, -25)], "far": [(40, 0), (20, -40), (20, 40)],
              "round": [(RADIUS + play, 0)]}, {"round": 1.3 * h}),
        curve=3,
    )  # fmt: skip
    return mesh


@problem((0.02, 0.0, 40), (0.02, 0.0, 16), (0.2, 0.0, 16), (0.002, 0.0, 16), (1.0, 0.0, 24),
         (0.02, 0.3, 16), (0.2, 0.3, 24), (0.002, 0.8, 16), (0.5, 0.1, 40))  # fmt: skip
def PinInHole(argument):
    """A body force presses a pin into a hole with clearance: at first it touches at one point."""
    play, friction, n = argument
    law = {"friction": friction} if friction else {}
    p = Problem(HalfPin(play, n), [("pin_round", "plate_round")], {"pin": 70e3, "plate": 70e3},
                flags={"dirichlet": "plate_far", "dirichletx": "pin_axis|plate_axis"}, law=law,
                outlines=False)  # fmt: skip
    p.Weight("pin", p.load * CF((0, -50 / (np.pi * RADIUS**2))))
    return p


@problem((0.02, 0.0, 2, 0), (0.2, 0.3, 5, 0), (0.02, 0.3, 2, 1), (0.2, 0.0, 3, 1))
def PinDriven(argument):
    """The middle of the pin is pushed down by a displacement, small and finite sliding."""
    play, friction, steps, finite = argument
    law = {"friction": friction} if friction else {}
    p = Problem(HalfPin(play, 16), [("pin_round", "plate_round")], {"pin": 70e3, "plate": 70e3},
                flags={"dirichlet": "plate_far|pin_axis", "dirichletx": "plate_axis"},
                law=law | ({"finite": True} if finite else {}), nonlinear=bool(finite),
                outlines=False, path=[(1.0, steps)])  # fmt: skip
    p.prescribe = {"pin_axis": p.load * CF((0, -0.02))}
    return p


@problem((0.002, 0.3, 1), (0.02, 0.3, 1), (0.05, 0.8, 2), (0.02, 0.1, 5))
def FreePin(argument):
    """A whole pin in the middle of a hole that it does not touch; a force pushes it down."""
    play, friction, steps = argument
    disc, outer = Circle((0, 0), 1).Face(), Plate(-3, -3, 3, 3) - Circle((0, 0), 1 + play).Face()
    mesh = Sketch(
        Part("pin", disc, 0.3, {"round": [(1, 0)]}),
        Part("plate", outer, 0.9, {"round": [(1 + play, 0)], "far": [(0, -3)]}, {"round": 0.25}),
        curve=2,
    )
    p = Problem(mesh, [("pin_round", "plate_round")], {"pin": 100.0, "plate": 100.0},
                flags={"dirichlet": "plate_far"}, law={"friction": friction}, outlines=False,
                path=[(1.0, steps)])  # fmt: skip
    p.Weight("pin", p.load * CF((0, -0.3)))
    return p


@problem((1.05, 0.1, 0), (1.3, 0.5, 0), (2.0, 1.0, 0), (1.05, 0.3, 1), (1.3, 0.8, 1))
def DiscInBowl(argument):
    """A heavy disc lies in a bowl, a little above its bottom at first."""
    radius, friction, finite = argument

    def bowl(s, t):
        angle = -np.pi / 2 + (s - 0.5) * 1.6
        px, py = radius * np.cos(angle), radius + radius * np.sin(angle) - 0.01
        return px * t + (1 - t) * (2.4 * s - 1.2), py * t - 0.8 * (1 - t)

    mesh = Grids(Block("disc", Disc, 9, 9), Block("bowl", bowl, 15, 5, quads=True))
    p = Problem(mesh, [("disc_bottom", "bowl_top")], {"disc": 100.0, "bowl": 300.0},
                flags={"dirichlet": "bowl_bottom"}, nonlinear=bool(finite),
                law={"friction": friction} | ({"finite": True} if finite else {}))  # fmt: skip
    p.Weight("disc", p.load * CF((0, -1.0)))
    return p


def Ball(points):
    """The cube [-1, 1]^3 as a ball that touches z = 0."""
    a, b, c = points.T
    a2, b2, c2 = a * a, b * b, c * c
    return np.stack([a * np.sqrt(1 - b2 / 2 - c2 / 2 + b2 * c2 / 3),
                     b * np.sqrt(1 - c2 / 2 - a2 / 2 + c2 * a2 / 3),
                     c * np.sqrt(1 - a2 / 2 - b2 / 2 + a2 * b2 / 3) + 1], axis=1)  # fmt: skip


@problem((0.3, 0.0), (0.8, 0.4))
def BallInBowl(argument):
    """A heavy ball lies in a shallow bowl."""
    friction, curvature = argument

    def bowl(points):
        px, py, pz = points.T
        return np.stack([px, py, pz + (pz + 1) * 0.5 * curvature * (px**2 + py**2)], axis=1)

    mesh = Grids3D(
        Block3D("ball", (-1, -1, -1, 1, 1, 1), (4, 4, 4), "hex", Ball),
        Block3D("bowl", (-1.1, -1, -1, 1, 1.1, -0.001), (5, 5, 2), "hex", bowl),
    )
    p = Problem(mesh, [("ball_bottom", "bowl_top")], {"ball": 100.0, "bowl": 100.0},
                flags={"dirichlet": "bowl_bottom"}, law={"friction": friction})  # fmt: skip
    p.Weight("ball", p.load * CF((0, 0, -1.0)))
    return p


# --- fits ----------------------------------------------------------------------------------------


def Sector(r0, r1, start=0.0, end=np.pi / 2):
    """The map of the square to a part of a ring, its bottom inside."""

    def bent(s, t):
        angle, radius = end - (end - start) * s, r0 + (r1 - r0) * t
        return radius * np.cos(angle), radius * np.sin(angle)

    return bent


@problem(
    (0.005, 0.0, 1.0), (0.02, 0.0, 1.0), (0.02, 0.3, 100.0), (0.02, 1.0, 0.01), (0.05, 0.3, 1.0)
)
def PressFit(argument):
    """A shaft is a little larger than the hole of its hub; there is no other load."""
    excess, friction, contrast = argument
    mesh = Grids(Block("shaft", Sector(0.3, 1.0 + excess), 8, 4, quads=True),
                 Block("hub", Sector(1.0, 1.6), 11, 4))  # fmt: skip
    p = Problem(mesh, [("shaft_top", "hub_bottom")], {"shaft": 100.0 * contrast, "hub": 100.0},
                law={"friction": friction} if friction else {},
                flags={"dirichlety": "shaft_right|hub_right", "dirichletx": "shaft_left|hub_left"},
                )  # fmt: skip
    return p


@problem((0.02, 0.0, 5), (0.02, 0.2, 5), (0.05, 0.2, 10), (0.05, 0.0, 20))
def Plug(argument):
    """A plug with a chamfer is pushed into a slot that is too narrow: half of it."""
    excess, friction, steps = argument

    def plug(s, t):
        tip = 0.12 * np.clip(1 - t / 0.25, 0, 1)
        return s * (0.5 + excess - tip), 1.0 + 1.2 * t

    mesh = Grids(Block("plug", plug, 4, 12, quads=True),
                 Block("wall", (0.5, -0.2, 1.2, 1.05), 5, 13, quads=True))  # fmt: skip
    law = {"finite": True} | ({"friction": friction} if friction else {})
    p = Problem(mesh, [("plug_right", "wall_left")], {"plug": 100.0, "wall": 50.0}, law=law,
                nonlinear=True, path=[(1.0, steps)],
                flags={"dirichletx": "plug_left|wall_right", "dirichlety": "plug_top|wall_right"},
                )  # fmt: skip
    p.prescribe = {"plug_top": CF((0, -0.8 * p.load))}
    return p


@problem((0.0, 8), (0.2, 8), (0.2, 20), (0.4, 10))
def SnapFit(argument):
    """A nose on a beam climbs over another one, and springs back behind it."""
    friction, steps = argument

    def Nose(s, at):
        return 0.1 * np.exp(-(((s - at) / 0.12) ** 2))

    def beam(s, t):
        px = 2 * s
        low = 0.11 - Nose(px, 1.75)
        return px, low + t * (0.24 - low)

    def catch(s, t):
        px = 1.9 + 1.2 * s
        top = Nose(px, 2.2)
        return px, -0.4 + t * (top + 0.4)

    mesh = Grids(Block("beam", beam, 26, 2, quads=True), Block("catch", catch, 21, 5, quads=True))
    law = {"finite": True} | ({"friction": friction} if friction else {})
    p = Problem(mesh, [("beam_bottom", "catch_top")], {"beam": 1000.0, "catch": 1000.0}, law=law,
                nonlinear=True, flags={"dirichlet": "beam_left|catch_bottom"},
                path=[(1.0, steps)])  # fmt: skip
    p.prescribe = {"catch_bottom": CF((-0.8 * p.load, 0))}
    return p


@problem((0.1, 0.0), (0.3, 0.5))
def RollIn(argument):
    """A disc is pushed sideways and down in a valley by a prescribed motion of its upper half."""
    push, friction = argument

    def valley(s, t):
        px = 3 * s - 1.5
        return px, -0.7 + t * (0.2 * px**2 - 0.001 + 0.7)

    mesh = Grids(Block("disc", lambda s, t: Disc(s, t, 0.6), 8, 8),
                 Block("valley", valley, 19, 4, quads=True))  # fmt: skip
    law = {"finite": True} | ({"friction": friction} if friction else {})
    p = Problem(mesh, [("disc_left|disc_bottom|disc_right", "valley_top")],
                {"disc": 50.0, "valley": 50.0}, law=law, nonlinear=True,
                flags={"dirichlet": "disc_top|valley_bottom"}, path=[(1.0, 3)])  # fmt: skip
    t = p.load
    p.prescribe = {"disc_top": CF((push * t, -0.05 * IfPos(t - 0.5, 1, 2 * t))) + 0 * CF((x, y))}
    return p
