# SPDX-License-Identifier: LGPL-2.1-or-later
"""Structured boxes of every element shape, made by hand: no mesher, no geometry.

A grid of cubes is cut into cells, each written with its first face counter-clockwise seen from
inside, as on paper. Netgen wants the opposite orientation, which `Cells.AddTo` gives.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from netgen.meshing import Element1D, Element2D, Element3D, FaceDescriptor, MeshPoint, Pnt
from netgen.meshing import Mesh as NetgenMesh

from ngslac.arguments import CheckCount
from ngslac.meshes.sizes import CheckElements

__all__ = ["KINDS", "Cells", "SideOf", "StructuredBox"]

# The corners of a cube: 0-3 below and 4-7 above, both counter-clockwise; 8 is its middle.
_KUHN = [(0, 1, 2, 6), (0, 2, 3, 6), (0, 3, 7, 6), (0, 7, 4, 6), (0, 4, 5, 6), (0, 5, 1, 6)]
_QUADS = [(0, 1, 2, 3), (4, 7, 6, 5), (0, 4, 5, 1), (1, 5, 6, 2), (2, 6, 7, 3), (3, 7, 4, 0)]
KINDS = {
    "tet": _KUHN,
    "hex": [(0, 1, 2, 3, 4, 5, 6, 7)],
    "prism": [(0, 1, 2, 4, 5, 6), (0, 2, 3, 4, 6, 7)],
    "prism_side": [(0, 7, 4, 1, 6, 5), (0, 3, 7, 1, 2, 6)],
    "pyramid": [(*quad, 8) for quad in _QUADS],
}
# Faces of a cell by its number of vertices, counter-clockwise seen from outside.
_FACES = {
    4: [(0, 2, 1), (0, 1, 3), (1, 2, 3), (2, 0, 3)],
    5: [(0, 3, 2, 1), (0, 1, 4), (1, 2, 4), (2, 3, 4), (3, 0, 4)],
    6: [(0, 2, 1), (3, 4, 5), (0, 1, 4, 3), (1, 2, 5, 4), (2, 0, 3, 5)],
    8: [(0, 3, 2, 1), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7)],
}
_MIRRORED = {
    4: (0, 2, 1, 3),
    5: (0, 3, 2, 1, 4),
    6: (0, 2, 1, 3, 5, 4),
    8: (0, 3, 2, 1, 4, 7, 6, 5),
}
_SIDES = ("left", "right", "front", "back", "bottom", "top")


@dataclass(frozen=True)
class Cells:
    """Points (n, d), cells (tuples of point numbers), and the outer faces with their names.

    To map a mesh, replace the points; the map has to keep the orientation.
    `faces` are pairs of a name and the point numbers, counter-clockwise seen from outside. In 2D
    they are edges, with the body on their left.
    """

    points: np.ndarray
    cells: list
    faces: list

    def AddTo(self, ngmesh: NetgenMesh, name: str) -> None:
        """Become the body `name` of a netgen mesh, whose ``Compress()`` is to be called at the end.

        Faces of equal names become one boundary of this body.
        """
        dim = ngmesh.dim
        domain, index = ngmesh.AddRegion(name, dim=dim), {}
        points = np.pad(self.points, [(0, 0), (0, 3 - self.points.shape[1])])
        numbers = [ngmesh.Add(MeshPoint(Pnt(*p))) for p in points]
        for cell in self.cells:
            corners = [numbers[i] for i in cell]
            if dim == 2:
                ngmesh.Add(Element2D(domain, corners))
            else:
                ngmesh.Add(Element3D(domain, [corners[i] for i in _MIRRORED[len(cell)]]))
        for label, face in self.faces:
            corners = [numbers[i] for i in face]
            if label not in index:
                index[label] = _AddBoundary(ngmesh, label, domain)
            if dim == 2:
                ngmesh.Add(Element1D(corners, index=index[label]))
            else:
                ngmesh.Add(Element2D(index[label], corners))


def StructuredBox(
    x: Sequence[float],
    y: Sequence[float],
    z: Sequence[float],
    kind: str = "hex",
    *,
    names: Callable[[str, np.ndarray], str] | None = None,
    perturb: float = 0.0,
    fixed: Sequence[float] = (),
    seed: int = 0,
) -> Cells:
    """Cut a grid of cubes into cells of one shape.

    Parameters
    ----------
    x, y, z : array_like
        Increasing positions of the grid planes.
    kind : {"tet", "hex", "prism", "prism_side", "pyramid"}
        Six tetrahedra per cube, hexahedra, two prisms with triangles below and above, two prisms
        with quadrilaterals there, six pyramids with their apex in the middle of the cube.
    names : callable, optional
        ``names(side, centre)`` names an outer face; `side` is one of "left" (x smallest),
        "right", "front" (y smallest), "back", "bottom", "top", and `centre` its middle in the
        grid. By default the side itself.
    perturb : float
        Moves every grid point at random by up to this part of the neighbouring spacings, but in
        the sides, edges and corners of the box only along them. Must be less than 0.3.
    fixed : sequence of float
        Positions in x and y of grid planes inside whose points move only along them as well.
    seed : int
        Of the random numbers.

    Returns
    -------
    Cells
        Their ``AddTo(ngmesh, name)`` makes them a body of a netgen mesh; their ``points`` may be
        replaced before (``dataclasses.replace``) by a map that keeps the orientation.

    Examples
    --------
    >>> import numpy as np
    >>> from netgen.meshing import Mesh as NetgenMesh
    >>> from ngsolve import Integrate, Mesh
    >>> from ngslac.meshes import StructuredBox
    >>> box = StructuredBox(np.linspace(0, 2, 3), [0, 1], [0, 1], "prism")
    >>> len(box.points), len(box.cells), len(box.faces)
    (12, 4, 14)
    >>> ngmesh = NetgenMesh(dim=3)
    >>> box.AddTo(ngmesh, "brick")
    >>> ngmesh.Compress()
    >>> round(Integrate(1, Mesh(ngmesh)), 12)
    2.0
    """
    if kind not in KINDS:
        raise ValueError(f"kind must be one of {', '.join(KINDS)}, but is {kind!r}")
    if not 0 <= perturb < 0.3:
        raise ValueError(f"perturb must be at least 0 and less than 0.3, but is {perturb}")
    CheckCount("seed", seed, least=0)
    grid = [np.asarray(c, dtype=float) for c in (x, y, z)]
    for name, c in zip("xyz", grid, strict=True):
        if c.ndim != 1 or len(c) < 2 or not (np.isfinite(c).all() and np.all(np.diff(c) > 0)):
            raise ValueError(f"{name} must be at least two increasing positions, all finite")
    CheckElements(len(KINDS[kind]) * np.prod([len(c) - 1.0 for c in grid]), **_Least(grid))
    flat = np.stack(np.meshgrid(*grid, indexing="ij"), axis=-1).reshape(-1, 3)
    cubes = _Cubes(*(len(c) for c in grid))
    points = flat + _Shifts(grid, perturb, fixed, seed) if perturb else flat
    if kind == "pyramid":
        cubes = np.column_stack([cubes, len(flat) + np.arange(len(cubes))])
        flat = np.concatenate([flat, flat[cubes[:, :8]].mean(axis=1)])
        points = np.concatenate([points, points[cubes[:, :8]].mean(axis=1)])
    cells = [tuple(int(cube[i]) for i in cell) for cube in cubes for cell in KINDS[kind]]
    faces = _NamedFaces(flat, cells, names or (lambda side, centre: side))
    return Cells(points, cells, faces)


def _AddBoundary(ngmesh: NetgenMesh, label: str, domain: int) -> int:
    """The number of a new boundary with a name, in front of a body."""
    if ngmesh.dim == 2:
        return ngmesh.AddRegion(label, dim=1)
    number = len(ngmesh.FaceDescriptors()) + 1
    index = ngmesh.Add(FaceDescriptor(surfnr=number, domin=domain, bc=number))
    ngmesh.SetBCName(number - 1, label)
    return index


def _Least(grid: list[np.ndarray]) -> dict[str, float]:
    """The least spacing of each coordinate."""
    return {f"spacing of {name}": np.diff(c).min() for name, c in zip("xyz", grid, strict=True)}


def SideOf(corners: np.ndarray, low: np.ndarray, high: np.ndarray) -> str:
    """Return which side of the box between two points a face with these corners (n, 3) lies in."""
    at = [np.all(corners[:, a] == end[a]) for a in range(3) for end in (low, high)]
    return _SIDES[at.index(True)]


def _Cubes(nx: int, ny: int, nz: int) -> np.ndarray:
    """Point numbers of the eight corners of every cube of a grid with nx, ny, nz points."""
    number = np.arange(nx * ny * nz).reshape(nx, ny, nz)
    corner = [(0, 0), (1, 0), (1, 1), (0, 1)]
    return np.stack(
        [
            number[i : nx - 1 + i, j : ny - 1 + j, k : nz - 1 + k].ravel()
            for k in (0, 1)
            for i, j in corner
        ],
        axis=1,
    )


def _Shifts(
    grid: list[np.ndarray], perturb: float, fixed: Sequence[float], seed: int
) -> np.ndarray:
    """Random shifts of the grid points; none across the sides of the box."""
    random = np.random.default_rng(seed)
    shifts = perturb * random.uniform(-1, 1, (*(len(c) for c in grid), 3))
    for axis, c in enumerate(grid):
        room = np.zeros(len(c))
        room[1:-1] = np.minimum(np.diff(c)[:-1], np.diff(c)[1:])
        if axis < 2:
            room[np.isin(c, fixed)] = 0.0
        shifts[..., axis] *= room.reshape([-1 if a == axis else 1 for a in range(3)])
    return shifts.reshape(-1, 3)


def _NamedFaces(
    flat: np.ndarray, cells: Sequence[tuple[int, ...]], names: Callable[[str, np.ndarray], str]
) -> list[tuple[str, tuple[int, ...]]]:
    """The faces of one cell only, named by the side of the box they lie in."""
    outer = {}
    for cell in cells:
        for face in _FACES[len(cell)]:
            points = tuple(cell[i] for i in face)
            key = frozenset(points)
            if outer.pop(key, None) is None:
                outer[key] = points
    low, high = flat.min(axis=0), flat.max(axis=0)
    named = []
    for face in outer.values():
        corners = flat[list(face)]
        named.append((names(SideOf(corners, low, high), corners.mean(axis=0)), face))
    return named
