"""Stress set: a pin in a lug and a fork, in three dimensions; pin and lug are held by contact."""

from netgen.occ import Box, Compound, Cylinder, OCCGeometry, Pnt, X, Y
from ngsolve import Mesh
from stress_problem import Problem, problem


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
