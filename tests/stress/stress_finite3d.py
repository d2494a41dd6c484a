"""Stress set in three dimensions: large deformation and large sliding on tiny meshes."""

import numpy as np
from ngsolve import CF, IfPos, cos, sin, x, y, z
from stress_meshes import Block3D, Grids3D
from stress_problem import Problem, problem

PAIR = [("upper_bottom", "lower_top")]
DRIVEN = {"dirichlet": "lower_bottom|upper_top"}


def Large3D(friction, length=1.6, n=(2, 3), young=(20.0, 40.0), flags=DRIVEN, gap=0.01):
    mesh = Grids3D(
        Block3D("upper", (0, 0, gap, 1, 1, gap + 0.5), (n[0], n[0], 1)),
        Block3D("lower", (-0.3, -0.3, -0.5, length - 0.3, 1.3, 0), (int(length * n[1]), n[1], 1)),
    )
    law = {"friction": friction, "finite": True} if friction else {"finite": True}
    bodies = dict(zip(("upper", "lower"), young, strict=True))
    return Problem(mesh, PAIR, bodies, nonlinear=True, flags=flags, law=law)


@problem(0.0, 0.5)
def Slide3D(friction):
    """Pressed and drawn aside by more than half of its width."""
    p = Large3D(friction, length=2.2)
    t = p.load
    p.prescribe = {"upper_top": CF((IfPos(t - 1, 0.6 * (t - 1), 0), 0, -0.08 * IfPos(t - 1, 1, t)))}
    p.path = [(1.0, 1), (2.0, 2)]
    return p


@problem(0.4)
def Twist3D(friction):
    """Pressed and turned by 60 degrees about the normal in one step."""
    p = Large3D(friction, length=1.8)
    a = np.pi / 3 * p.load
    u, w = x - 0.5, y - 0.5
    spin = CF((cos(a) * u - sin(a) * w - u, sin(a) * u + cos(a) * w - w, -0.06 * p.load))
    p.prescribe = {"upper_top": spin}
    return p


@problem(0.3)
def Turn3D(friction):
    """A pressed pair is turned as a whole by 60 degrees about a horizontal axis."""
    p = Large3D(friction)
    t = p.load
    a = np.pi / 3 * IfPos(t - 1, t - 1, 0)
    down = -0.05 * IfPos(t - 1, 1, t)

    def turned(h):
        return CF((0, cos(a) * y - sin(a) * h - y, sin(a) * y + cos(a) * h - z))

    p.prescribe = {"upper_top": turned(z + down), "lower_bottom": turned(z)}
    p.path = [(1.0, 1), (2.0, 2)]
    return p


@problem(0.6)
def LargeBrick3D(friction):
    """Held by contact alone, four macro-elements, pushed aside."""
    p = Large3D(friction, flags={"dirichlet": "lower_bottom"})
    p.Traction("upper_top", p.load * CF((0.2, 0.1, -1)))
    return p
