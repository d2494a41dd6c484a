# SPDX-License-Identifier: LGPL-2.1-or-later
"""Rigid motions as coefficients of a displacement space."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING

import numpy as np
from ngsolve import (
    VOL,
    BitArray,
    CoefficientFunction,
    FESpace,
    Grad,
    GridFunction,
    InnerProduct,
    Integrate,
    LinearForm,
    Mesh,
    Region,
    Sym,
    dx,
    x,
    y,
    z,
)

from ngslac.arrays import ComponentsOf
from ngslac.parallel.extent import ExtentOf
from ngslac.parallel.layout import LayoutOf
from ngslac.parallel.spread import SumAt
from ngslac.rigid import Tables

if TYPE_CHECKING:
    from ngsolve.comp import ProxyFunction

    from ngslac.contact.contact import LACContact

__all__ = [
    "DofsOfMaterials",
    "MotionIntegrals",
    "MotionsOf",
    "PoissonRatio",
    "RigidMotions",
    "StrainIntegrals",
    "TablesOf",
    "Turned",
]

ACCURACY = 1e-10


def RigidMotions(space: FESpace) -> tuple[np.ndarray, list[str], float]:
    """The rigid motions of the whole mesh, rotations about its middle and divided by its size."""
    points, center, size = Vertices(space.mesh)
    arms, (tables, names) = Arms(space.mesh), TablesOf(space)
    motions = FromVertices(space, (points - center) / size, arms, tables)
    if motions is None or not IsAccurate(space, motions, arms, tables, size):
        gf, columns = GridFunction(space), []
        for table in tables:
            gf.Set(Field(table, arms), VOL)
            columns.append(gf.vec.FV().NumPy().copy())
        motions = np.stack(columns, axis=1)
    return LayoutOf(space).Of(motions), names, size


def TablesOf(space: FESpace) -> tuple[np.ndarray, list[str]]:
    """The `Tables` of a displacement; of a scalar field that of a constant."""
    d = space.mesh.dim
    return (np.eye(1, 1 + d)[None], ["a constant"]) if space.TestFunction().dim == 1 else Tables(d)


def MotionsOf(contact: LACContact) -> np.ndarray:
    """Those of all scalar dofs of a contact's product space (n, m): zero but for displacements."""
    form = contact.form
    block, (own, *_) = form.fes.dim, RigidMotions(form.component)
    motions = np.zeros((form.fes.ndof * block, own.shape[1]))
    motions[form.offset * block :][: len(own)] = own
    return contact.layout.Of(motions)


def MotionIntegrals(space: FESpace) -> np.ndarray:
    """Integrals of each of the `RigidMotions` times the basis functions (n, m)."""
    arms, (tables, _) = Arms(space.mesh), TablesOf(space)
    return Integrals(space, [Field(table, arms) for table in tables], lambda v: v)


def StrainIntegrals(space: FESpace, motions: np.ndarray) -> np.ndarray:
    """Integrals of the strains of motions (n, m) times those of the basis functions, (n, m)."""
    strains = []
    for k in range(motions.shape[1]):
        gf = GridFunction(space)
        gf.vec.FV().NumPy()[:] = motions[:, k]
        strains.append(Sym(Grad(gf)))
    return Integrals(space, strains, lambda v: Sym(Grad(v)))


def PoissonRatio(
    space: FESpace, part: np.ndarray, forces: Callable[[np.ndarray], np.ndarray]
) -> float:
    """The largest one of parts (n,) of the dofs, from what `forces` a dilation and a shear make."""
    arms = Arms(space.mesh)

    def Modulus(field: Sequence[CoefficientFunction | float]) -> np.ndarray:
        """Work in a displacement over the squares of its strains, of each part."""
        gf = GridFunction(space)
        gf.Set(CoefficientFunction(tuple(field)), VOL)
        values = LayoutOf(space).Values(gf.vec).copy()
        strains = StrainIntegrals(space, values[:, None])[:, 0]
        of = part - part.min()
        count = 1 + of.max()
        work, squares = (SumAt(of, values * dual, count) for dual in (forces(values), strains))
        return work[squares > 0] / squares[squares > 0]

    stiffer = (Modulus(arms) / Modulus((arms[1], *([0] * (len(arms) - 1)))) - 1) / len(arms)
    return np.max((stiffer / (1 + 2 * stiffer))[stiffer > 0], initial=0.0)


def Integrals(
    space: FESpace,
    fields: Sequence[CoefficientFunction],
    of: Callable[[ProxyFunction], CoefficientFunction],
) -> np.ndarray:
    """Of fields times what is made of the basis functions, (n, m)."""
    columns, v = [], space.TestFunction()
    for field in fields:
        form = LinearForm(space)
        form += InnerProduct(field, of(v)) * dx
        columns.append(LayoutOf(space).Values(form.Assemble().vec).copy())
    return np.stack(columns, axis=1)


def Vertices(mesh: Mesh) -> tuple[np.ndarray, np.ndarray, float]:
    """The vertices of a mesh (n, d) here, the mean of all, and the size of the mesh."""
    points, extent = np.asarray(mesh.ngmesh.Coordinates())[: mesh.nv, : mesh.dim], ExtentOf(mesh)
    return points, extent.center, extent.size


def Arms(mesh: Mesh) -> list[CoefficientFunction]:
    """Coordinates from the middle of the mesh, over its size."""
    _, center, size = Vertices(mesh)
    return [(c - c0) / size for c, c0 in zip((x, y, z), center, strict=False)]


def Turned(space: FESpace, displacement: np.ndarray, size: float) -> np.ndarray:
    """What a displacement (n,) changes `RigidMotions` by: (n, m), those of the deformed mesh.

    Zero for spaces of which the components are not alike.
    """
    d = space.mesh.dim
    tables, _ = TablesOf(space)
    if space.dim != d and not SameComponents(space):
        return np.zeros((len(displacement), len(tables)))
    displacement = np.asarray(displacement)
    values = displacement.reshape(-1, d) if space.dim == d else displacement.reshape(d, -1).T
    order = "icm" if space.dim == d else "cim"
    turned = np.einsum(f"ib,mcb->{order}", values / size, tables[:, :, 1:])
    return turned.reshape(len(displacement), len(tables))


def Field(table: np.ndarray, arms: Sequence[CoefficientFunction]) -> CoefficientFunction:
    """The motion of such a table as CoefficientFunction."""
    rows = (row[0] + sum(f * arm for f, arm in zip(row[1:], arms, strict=True)) for row in table)
    return CoefficientFunction(tuple(rows))  # of one row: a scalar


def FromVertices(
    space: FESpace, points: np.ndarray, arms: Sequence[CoefficientFunction], tables: np.ndarray
) -> np.ndarray | None:
    """The motions of spaces with a hierarchical basis of H1; None for others.

    Setting a GridFunction on the volume takes longer than all else that a search for floating
    bodies does. Where the mesh is not curved a linear function is its values at the vertices, and
    where it is, what else there is belongs to the boundary.
    """
    d = len(arms)
    parts = [space] if space.dim == d else SameComponents(space)
    n = parts[0].ndof if parts else 0
    if not parts or n < len(points):
        return None
    basis = np.zeros((n, 1 + d))
    if space.mesh.GetCurveOrder() > 1:
        gf = GridFunction(space)
        gf.Set(CoefficientFunction(tuple(arms)), definedon=space.mesh.Boundaries(".*"))
        values = gf.vec.FV().NumPy()
        basis[:, 1:] = values.reshape(n, d) if space.dim == d else values.reshape(d, n).T
    basis[: len(points), 0], basis[: len(points), 1:] = 1, points
    order = "icm" if space.dim == d else "cim"
    return np.einsum(f"ib,mcb->{order}", basis, tables).reshape(n * d, len(tables))


def SameComponents(space: FESpace) -> list[FESpace]:
    """The components of a space that are alike and as many as dimensions; else nothing."""
    parts = ComponentsOf(space)
    alike = len(parts) == space.mesh.dim and len({part.ndof for part in parts}) == 1
    return parts if alike and all(part.dim == 1 for part in parts) else []


def IsAccurate(
    space: FESpace,
    motions: np.ndarray,
    arms: Sequence[CoefficientFunction],
    tables: np.ndarray,
    size: float,
) -> bool:
    """Is a random one of the motions, where the space has dofs, what it should be?

    `size` is that of the mesh.
    """
    weights = np.random.default_rng(0).standard_normal(len(tables))
    mesh, gf = space.mesh, GridFunction(space)
    gf.vec.FV().NumPy()[:] = motions @ weights
    error = gf - Field(np.tensordot(weights, tables, 1), arms)
    squares = np.asarray(Integrate(InnerProduct(error, error), mesh, order=2, region_wise=True))
    wrong = np.flatnonzero(~(squares <= ACCURACY**2 * size ** len(arms)))
    found = [DofsOfMaterials(space, np.arange(len(squares)) == i).NumSet() for i in wrong]
    return not LayoutOf(space).together.Sum(sum(found))


def DofsOfMaterials(space: FESpace, chosen: np.ndarray) -> BitArray:
    """Dofs of the space on materials, of which `chosen` (n,) bool selects some, as BitArray."""
    return space.GetDofs(Region(space.mesh, VOL, BitArray(list(map(bool, chosen)))))
