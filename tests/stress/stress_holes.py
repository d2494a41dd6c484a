"""Stress set: round things in round holes, press fits, snap fits, balls in bowls, a lug."""

from functools import partial

import numpy as np
from netgen.occ import Box, Circle, Compound, Cylinder, OCCGeometry, Pnt, X, Y
from ngsolve import IfPos, Mesh
from stress_meshes import Disc, Grids, Part, Plate, Polar, Sketch
from stress_problem import Problem, problem

RADIUS = 10.0
PIN = [("pin_round", "plate_round")]


def HalfPin(play, n):
    """The right half of a pin that touches the bottom of a hole, and the plate around it."""
    pin = Circle((0, -play), RADIUS).Face() * Plate(0, -50, 50, 50)
    plate = Plate(0, -40, 40, 40) - Circle((0, 0), RADIUS + play).Face()
    for face in (pin, plate):
        face.edges.maxh = 8.0
    h = np.pi * RADIUS / n
    inside = {"axis": [(0, 0)], "round": [(RADIUS, -play)]}
    outside = {"axis": [(0, 25), (0, -25)], "far": [(40, 0), (20, -40), (20, 40)]}
    outside |= {"round": [(RADIUS + play, 0)]}
    return Sketch(
        Part("pin", pin, 3.0, inside, {"round": h}),
        Part("plate", plate, 12.0, outside, {"round": 1.3 * h}),
        curve=3,
    )


@problem((0.02, 0.0, 40), (0.02, 0.0, 16), (0.2, 0.0, 16), (0.002, 0.0, 16), (1.0, 0.0, 24),
         (0.02, 0.3, 16), (0.2, 0.3, 24), (0.002, 0.8, 16), (0.5, 0.1, 40))  # fmt: skip
def PinInHole(play, friction, n):
    """A body force presses a pin into a hole with clearance: at first it touches at one point."""
    options = {"held": "plate_far", "heldx": "pin_axis|plate_axis"}
    p = Problem(HalfPin(play, n), 70e3, PIN, friction or None, **options)
    return p.Weight("pin", (0, -50 / (np.pi * RADIUS**2)))


@problem((0.02, 0.0, 2, 0), (0.2, 0.3, 5, 0), (0.02, 0.3, 2, 1), (0.2, 0.0, 3, 1))
def PinDriven(play, friction, steps, finite):
    """The middle of the pin is pushed down by a displacement, small and finite sliding."""
    options = {"held": "plate_far", "heldx": "plate_axis", "drive": {"pin_axis": (0, -0.02)}}
    mesh = HalfPin(play, 16)
    return Problem(mesh, 70e3, PIN, friction or None, bool(finite), steps=steps, **options)


@problem((0.002, 0.3, 1), (0.02, 0.3, 1), (0.05, 0.8, 2), (0.02, 0.1, 5))
def FreePin(play, friction, steps):
    """A whole pin in the middle of a hole that it does not touch; a force pushes it down."""
    disc, outer = Circle((0, 0), 1).Face(), Plate(-3, -3, 3, 3) - Circle((0, 0), 1 + play).Face()
    mesh = Sketch(
        Part("pin", disc, 0.3, {"round": [(1, 0)]}),
        Part("plate", outer, 0.9, {"round": [(1 + play, 0)], "far": [(0, -3)]}, {"round": 0.25}),
        curve=2,
    )
    p = Problem(mesh, 100.0, PIN, friction, held="plate_far", steps=steps)
    return p.Weight("pin", (0, -0.3))


@problem((1.05, 0.1, 0), (1.3, 0.5, 0), (2.0, 1.0, 0), (1.05, 0.3, 1), (1.3, 0.8, 1))
def DiscInBowl(radius, friction, finite):
    """A heavy disc lies in a bowl, a little above its bottom at first."""

    def bowl(s, t):
        px, py = Polar(-np.pi / 2 + (s - 0.5) * 1.6, radius)
        py = radius + py - 0.01
        return px * t + (1 - t) * (2.4 * s - 1.2), py * t - 0.8 * (1 - t)

    mesh = Grids(disc=(Disc, (9, 9)), bowl=(bowl, (15, 5), "quad"))
    pairs, young = [("disc", "bowl")], {"disc": 100.0, "bowl": 300.0}
    p = Problem(mesh, young, pairs, friction, bool(finite), held="bowl_bottom")
    return p.Weight("disc", (0, -1.0))


def Ball(points):
    """The cube [-1, 1]^3 as a ball that touches z = 0."""
    a, b, c = points.T
    a2, b2, c2 = a * a, b * b, c * c
    return np.stack([a * np.sqrt(1 - b2 / 2 - c2 / 2 + b2 * c2 / 3),
                     b * np.sqrt(1 - c2 / 2 - a2 / 2 + c2 * a2 / 3),
                     c * np.sqrt(1 - a2 / 2 - b2 / 2 + a2 * b2 / 3) + 1], axis=1)  # fmt: skip


@problem((0.3, 0.0), (0.8, 0.4))
def BallInBowl(friction, curvature):
    """A heavy ball lies in a shallow bowl."""

    def bowl(points):
        px, py, pz = points.T
        return np.stack([px, py, pz + (pz + 1) * 0.5 * curvature * (px**2 + py**2)], axis=1)

    mesh = Grids(
        ball=((-1, -1, -1, 1, 1, 1), (4, 4, 4), "hex", Ball),
        bowl=((-1.1, -1, -1, 1, 1.1, -0.001), (5, 5, 2), "hex", bowl),
    )
    p = Problem(mesh, 100.0, [("ball", "bowl")], friction, held="bowl_bottom")
    return p.Weight("ball", (0, 0, -1.0))


# --- fits ----------------------------------------------------------------------------------------


@problem(
    (0.005, 0.0, 1.0), (0.02, 0.0, 1.0), (0.02, 0.3, 100.0), (0.02, 1.0, 0.01), (0.05, 0.3, 1.0)
)
def PressFit(excess, friction, contrast):
    """A shaft is a little larger than the hole of its hub; there is no other load."""

    def sector(r0, r1):
        return lambda s, t: Polar(np.pi / 2 - np.pi / 2 * s, r0 + (r1 - r0) * t)

    shaft = (sector(0.3, 1.0 + excess), (8, 4), "quad")
    mesh = Grids(shaft=shaft, hub=(sector(1.0, 1.6), (11, 4)))
    sides = {"heldx": "shaft_left|hub_left", "heldy": "shaft_right|hub_right"}
    young, pairs = {"shaft": 100.0 * contrast, "hub": 100.0}, [("shaft_top", "hub_bottom")]
    return Problem(mesh, young, pairs, friction or None, **sides)


@problem((0.02, 0.0, 5), (0.02, 0.2, 5), (0.05, 0.2, 10), (0.05, 0.0, 20))
def Plug(excess, friction, steps):
    """A plug with a chamfer is pushed into a slot that is too narrow: half of it."""

    def plug(s, t):
        tip = 0.12 * np.clip(1 - t / 0.25, 0, 1)
        return s * (0.5 + excess - tip), 1.0 + 1.2 * t

    mesh = Grids(plug=(plug, (4, 12), "quad"), wall=((0.5, -0.2, 1.2, 1.05), (5, 13), "quad"))
    options = {"heldx": "plug_left|wall_right", "heldy": "plug_top|wall_right", "steps": steps}
    options |= {"prescribe": {"plug_top": (0, -0.8)}}
    pairs = [("plug_right", "wall_left")]
    return Problem(mesh, {"plug": 100.0, "wall": 50.0}, pairs, friction or None, True, **options)


@problem((0.0, 8), (0.2, 8), (0.2, 20), (0.4, 10))
def SnapFit(friction, steps):
    """A nose on a beam climbs over another one, and springs back behind it."""

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

    mesh = Grids(beam=(beam, (26, 2), "quad"), catch=(catch, (21, 5), "quad"))
    options = {"held": "beam_left", "drive": {"catch_bottom": (-0.8, 0)}, "steps": steps}
    return Problem(mesh, 1000.0, [("beam", "catch")], friction or None, True, **options)


@problem((0.1, 0.0), (0.3, 0.5))
def RollIn(push, friction):
    """A disc is pushed sideways and down in a valley by a prescribed motion of its upper half."""

    def valley(s, t):
        px = 3 * s - 1.5
        return px, -0.7 + t * (0.2 * px**2 - 0.001 + 0.7)

    disc, pairs = partial(Disc, radius=0.6), [("disc_left|disc_bottom|disc_right", "valley_top")]
    mesh = Grids(disc=(disc, (8, 8)), valley=(valley, (19, 4), "quad"))
    drive = {"disc_top": lambda t: (push * t, -0.05 * IfPos(t - 0.5, 1, 2 * t))}
    options = {"held": "valley_bottom", "drive": drive, "steps": 3}
    return Problem(mesh, 50.0, pairs, friction or None, True, **options)


# --- a pin in a lug and a fork, held by contact --------------------------------------------------


def Cheek(name, y0, y1, x0, x1, radius, maxh):
    """A plate between y0 and y1 with a hole around the y axis, its far end called NAME_far."""
    body = Box(Pnt(x0, y0, -1), Pnt(x1, y1, 1)) - Cylinder(
        Pnt(0, y0 - 1, 0), Y, radius, y1 - y0 + 2
    )
    body.mat(name)
    body.faces.name = f"{name}_free"
    far = body.faces.Min(X) if name == "fork" else body.faces.Max(X)
    far.name = f"{name}_far"
    body.faces.Nearest(Pnt(0, (y0 + y1) / 2, radius)).name = f"{name}_hole"
    body.maxh = maxh
    return body


def Lug(play):
    """The mesh of two cheeks of a fork, a lug between them, and the pin."""
    pin = Cylinder(Pnt(0, -1.7, 0), Y, 0.5, 3.4)
    pin.mat("pin")
    pin.faces.name = "pin_free"
    pin.faces.Nearest(Pnt(0, 0, 0.5)).name = "pin_round"
    pin.maxh = 0.6
    parts = [
        Cheek("fork", -1.6, -0.7, -2.5, 1.2, 0.5 + play, 1.3),
        Cheek("fork", 0.7, 1.6, -2.5, 1.2, 0.5 + play, 1.3),
        Cheek("lug", -0.5, 0.5, -1.2, 2.5, 0.5 + play, 1.2),
        pin,
    ]
    geometry = OCCGeometry(Compound(parts))
    return Mesh(geometry.GenerateMesh(maxh=1.5, grading=0.8, curvaturesafety=0.8)).Curve(2)


@problem((0.3, 0.002, 1), (0.1, 0.01, 2))
def PinInLug(friction, play, steps):
    """The lug is pulled: it pulls the pin, and the pin the fork."""
    pairs = [("fork_hole", "pin_round"), ("lug_hole", "pin_round")]
    held = {"held": "fork_far", "heldy": "lug_far", "heldz": "lug_far"}
    p = Problem(Lug(play), 1000.0, pairs, friction, steps=steps, **held)
    return p.Traction("lug_far", (1.0, 0, 0))
