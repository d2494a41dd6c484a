# SPDX-License-Identifier: LGPL-2.1-or-later
"""Whether a bulk form is linear, asked by a random displacement."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from netgen.meshing import NgException
from ngsolve import BaseVector, BilinearForm, Mesh

from ngslac.parallel.extent import ExtentOf

if TYPE_CHECKING:
    from ngslac.parallel.layout import Layout, Whole
    from ngslac.solve.bulk import Bulk

__all__ = ["AssembleLinear", "Probe"]

# Deviations that are rounding: of all, and of a row, relative to what is expected there.
ALL, ROW = 1e-11, 1e-8


@dataclass
class Probe:
    """What a form says of the solution, and of the way from there to a random displacement.

    That is of the size of an element: strains of about 1 in all of them show a nonlinear law, a
    damage or a gap that have not begun to act at the solution, too.
    """

    values: np.ndarray
    residual: BaseVector
    way: np.ndarray
    change: np.ndarray

    @classmethod
    def At(cls, bulk: Bulk) -> Probe | None:
        """From the solution of a Bulk; None where the form has no value."""
        gf, vec, layout = bulk.gf, bulk.gf.vec, bulk.layout
        there, at, here = (vec.CreateVector() for _ in range(3))
        values = layout.Values(vec)
        way = ElementSize(gf.space.mesh) * layout.Consistent(RandomWay(len(values)))
        layout.Values(at)[:] = values + way
        try:
            layout.Apply(bulk.a, vec, here)
            layout.Apply(bulk.a, at, there)
        except NgException:
            return None
        change = layout.Values(there) - layout.Values(here)
        if not np.all(np.isfinite(change)):
            return None
        return cls(values.copy(), here, way, change)

    def Agrees(self, bulk: Bulk) -> bool:
        """Is the matrix of a Bulk that of a linear form with this change?"""
        deviation, expected = map(np.abs, bulk.Deviation(self.change, self.way))
        return all(
            np.linalg.norm(deviation[rows]) <= ALL * np.linalg.norm(expected[rows])
            and np.all(deviation[rows] <= ROW * expected[rows])
            for rows in (bulk.inner, ~bulk.inner)
        )


def AssembleLinear(a: BilinearForm, layout: Layout | Whole) -> bool:
    """The matrix of a form, if it is linear; False where that fails.

    A form that is not has some other matrix then, also where a product of test functions alone
    stands beside the linear part in one integrand: one has to ask a `Probe`.
    """
    try:
        layout.together.Agree(a.Assemble, NgException)
    except NgException:
        return False
    return True


def ElementSize(mesh: Mesh) -> float:
    """A length of elements."""
    extent = ExtentOf(mesh)
    return extent.size * extent.elements ** (-1 / mesh.dim)


def RandomWay(n: int) -> np.ndarray:
    """The same each time, (n,): no number of it is small."""
    random = np.random.default_rng(17)
    return random.choice([-1.0, 1.0], n) * random.uniform(0.5, 1, n)
