"""Stress set in three dimensions: large deformation and large sliding on tiny meshes."""

import numpy as np
from ngsolve import cos, sin, x, y, z
from stress_finite2d import Large, Top
from stress_meshes import Grids
from stress_problem import Moved, Pressed, problem


def Blocks3D(length=1.6):
    lower = (-0.3, -0.3, -0.5, length - 0.3, 1.3, 0)
    return Grids(
        upper=((0, 0, 0.01, 1, 1, 0.51), (2, 2, 1)), lower=(lower, (int(length * 3), 3, 1))
    )


@problem(0.0, 0.5)
def Slide3D(friction):
    """Pressed and drawn aside by more than half of its width."""
    drive, path = Top(lambda t: (0.6 * Moved(t), 0, -0.08 * Pressed(t))), [(1.0, 1), (2.0, 2)]
    return Large(Blocks3D(2.2), 20.0, 40.0, friction, drive=drive, path=path)


@problem(0.4)
def Twist3D(friction):
    """Pressed and turned by 60 degrees about the normal in one step."""

    def spin(t):
        a, u, w = np.pi / 3 * t, x - 0.5, y - 0.5
        return cos(a) * u - sin(a) * w - u, sin(a) * u + cos(a) * w - w, -0.06 * t

    return Large(Blocks3D(1.8), 20.0, 40.0, friction, drive=Top(spin))


@problem(0.3)
def Turn3D(friction):
    """A pressed pair is turned as a whole by 60 degrees about a horizontal axis."""

    def turned(t, h):
        a = np.pi / 3 * Moved(t)
        return 0, cos(a) * y - sin(a) * h - y, sin(a) * y + cos(a) * h - z

    drive = Top(lambda t: turned(t, z + -0.05 * Pressed(t)))
    drive |= {"lower_bottom": lambda t: turned(t, z)}
    return Large(Blocks3D(), 20.0, 40.0, friction, drive=drive, path=[(1.0, 1), (2.0, 2)])


@problem(0.6)
def LargeBrick3D(friction):
    """Held by contact alone, four macro-elements, pushed aside."""
    return Large(Blocks3D(), 20.0, 40.0, friction).Traction("upper_top", (0.2, 0.1, -1))
