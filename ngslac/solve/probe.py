# SPDX-License-Identifier: LGPL-2.1-or-later
"""Whether a bulk form is linear, asked by a random displacement."""

from dataclasses import dataclass

import numpy as np
from netgen.meshing import NgException
from ngsolve import BaseVector

from ngslac.arrays import Multiply

__all__ = ["AssembleLinear", "Probe"]

# Deviations that are rounding: of all, and of a row, relative to what is expected there.
ALL, ROW = 1e-11, 1e-8


@dataclass
class Probe:
    """What a form says of the solution, and of the way from there to a random displacement.

    That is of the size of an element: strains of about 1 in all of them show a nonlinear law, a
    damage or a gap that have not begun to act at the solution, too.

    Attributes
    ----------
    values : (n,) array
        The solution.
    residual : BaseVector
        There.
    way, change : (n,) array
        Random, and how the residual changes along it.
    """

    values: np.ndarray
    residual: BaseVector
    way: np.ndarray
    change: np.ndarray

    @classmethod
    def At(cls, a, gf):
        """From a solution; None where the form has no value."""
        vec, there, here = (gf.vec.CreateVector() for _ in range(3))
        way = ElementSize(gf.space.mesh) * RandomWay(len(gf.vec.FV().NumPy()))
        vec.FV().NumPy()[:] = gf.vec.FV().NumPy() + way
        try:
            a.Apply(gf.vec, here)
            a.Apply(vec, there)
        except NgException:
            return None
        change = there.FV().NumPy() - here.FV().NumPy()
        if not np.all(np.isfinite(change)):
            return None
        return cls(gf.vec.FV().NumPy().copy(), here, way, change)

    def Agrees(self, mat):
        """Is a matrix that of a linear form with this change?"""
        expected = Multiply([mat], self.way)
        deviation = np.abs(self.change - expected)
        expected = np.abs(expected)
        if not np.linalg.norm(deviation) <= ALL * np.linalg.norm(expected):
            return False
        return bool(np.all(deviation <= ROW * expected))


def AssembleLinear(a):
    """The matrix of a form, if it is linear; False where that fails.

    A form that is not has some other matrix then, also where a product of test functions alone
    stands beside the linear part in one integrand: one has to ask a `Probe`.
    """
    try:
        a.Assemble()
    except NgException:
        return False
    return True


def ElementSize(mesh):
    """A length of elements."""
    size = np.ptp(np.asarray(mesh.ngmesh.Coordinates()), axis=0).max()
    return size * mesh.ne ** (-1 / mesh.dim)


def RandomWay(n):
    """The same each time, (n,): no number of it is small."""
    random = np.random.default_rng(17)
    return random.choice([-1.0, 1.0], n) * random.uniform(0.5, 1, n)
