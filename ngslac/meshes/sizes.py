# SPDX-License-Identifier: LGPL-2.1-or-later
"""Checks of the sizes of meshes, before a mesher works on them, maybe for ever."""

from __future__ import annotations

import math

from ngslac.arguments import CheckCount, CheckNumber

__all__ = [
    "MOST",
    "CheckAlike",
    "CheckElements",
    "CheckFinite",
    "CheckGrading",
    "CheckMoved",
    "CheckOrder",
    "CheckPositive",
    "Graded",
]

MOST = 5e6  # elements: gigabytes, and minutes of meshing
HIGHEST = 20  # order of a curved geometry
SMALLEST, LARGEST = 1e-50, 1e50  # whose powers are numbers
FLATTEST, STEEPEST = 1e-3, 10  # growth of element sizes
RATIO = 1e-6  # of lengths of one body, for geometry kernels


def CheckPositive(**values: float) -> None:
    """Raise a ``ValueError`` that names the first value which is not positive and finite."""
    for name, value in values.items():
        number = CheckNumber(name, value, "a number > 0", lambda _: True)
        if not (math.isfinite(number) and number > 0):
            raise ValueError(f"{name} must be positive, but is {value}")
        if not SMALLEST < number < LARGEST:
            raise ValueError(
                f"{name} must be positive, between {SMALLEST:g} and {LARGEST:g}, but is {value}"
            )


def CheckGrading(grading: float) -> None:
    """Check netgen's grading, next to zero of which netgen crashes."""
    CheckPositive(grading=grading)
    if not FLATTEST <= grading <= STEEPEST:
        raise ValueError(f"grading = {grading:g} must be from {FLATTEST:g} to {STEEPEST:g}")


def CheckAlike(**lengths: float) -> None:
    """Raise a ``ValueError`` where one of the lengths is next to nothing beside another one."""
    least, most = min(lengths, key=lengths.get), max(lengths, key=lengths.get)
    if lengths[least] < RATIO * lengths[most]:
        raise ValueError(
            f"{least} = {lengths[least]:g} is too small for {most} = {lengths[most]:g}: give at "
            f"least {RATIO:g} times that"
        )


def CheckFinite(**values: float) -> None:
    """Raise a ``ValueError`` that names the first value which is NaN or infinite."""
    for name, value in values.items():
        CheckNumber(name, value)


def CheckMoved(scale: float, angle: float) -> None:
    """Check the scale and the angle of a mesh in 2D."""
    CheckPositive(scale=scale)
    CheckFinite(angle=angle)


def CheckOrder(order: int) -> None:
    """Check the order of a curved geometry."""
    if CheckCount("order", order) > HIGHEST:
        raise ValueError(f"order must be a whole number from 1 to {HIGHEST}, but is {order}")


def CheckElements(number: float, **sizes: float) -> None:
    """Raise a ``ValueError`` where sizes of elements make more of them than anyone can use."""
    if not number <= MOST:
        shown = ", ".join(f"{name} = {value:g}" for name, value in sizes.items())
        raise ValueError(
            f"{shown} would make about {number:.1e} elements, more than {MOST:g}: take other sizes"
        )


def Graded(h: float, grading: float, contact: float, size: float, dim: int) -> float:
    """About how many elements a body has whose size is `h` on a contact face and grows from there.

    `contact` and `size` are the lengths of that face and of the body, in 3D half of the diameter of
    the former.
    """
    far = math.log1p(grading * size / h) * 2 * math.pi / grading**dim
    if dim == 2:
        return min(2 * contact / (grading * h) + far, 2 * (size / h) ** 2)
    near = math.pi * contact**2 / (2 * grading * h**2)
    return 6 * min(near + far, (size / h) ** 3)
