# SPDX-License-Identifier: LGPL-2.1-or-later
"""Two blocks on each other in 3D, in every element shape: meshes for patch tests."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from numbers import Integral

import numpy as np
from netgen.meshing import Mesh as NetgenMesh
from netgen.occ import Box, OCCGeometry, Pnt
from ngsolve import Mesh

from ngslac.meshes.boxes import Cells, SideOf, StructuredBox
from ngslac.meshes.geometry import CheckNonMatching, Incline, RotationMatrix
from ngslac.meshes.sizes import CheckAlike, CheckElements, CheckFinite, CheckPositive

__all__ = ["TwoBlocks3D"]


@dataclass(frozen=True)
class _Frame:
    """Shape of the interface, size and position of the whole."""

    middle: np.ndarray  # (x, y) where the interface passes z = 0
    gradient: np.ndarray  # of the interface height, (dz/dx, dz/dy)
    height: float
    matrix: np.ndarray  # rotation and scale

    def Map(self, points: np.ndarray) -> np.ndarray:
        """Incline the interface, keep the far sides, scale and rotate."""
        shear = (points[:, :2] - self.middle) @ self.gradient
        z = points[:, 2] + shear * (1 - np.abs(points[:, 2]) / self.height)
        return np.column_stack([points[:, :2], z]) @ self.matrix.T


def TwoBlocks3D(
    kind_upper: str = "hex",
    kind_lower: str | None = None,
    n_slave: int | tuple[int, int] = 2,
    n_master: int | tuple[int, int] = 3,
    *,
    layers: tuple[int, int] = (1, 1),
    shape: str = "flat",
    slope: float = 20.0,
    azimuth: float = 30.0,
    overhang: float = 0.0,
    aligned: bool = True,
    perturb: float = 0.0,
    unstructured: bool = False,
    width: float = 1.0,
    height: float = 1.0,
    scale: float = 1.0,
    rotation: tuple[str | Sequence[float], float] | None = None,
    seed: int = 1,
) -> Mesh:
    """Mesh of a block "upper" on a block "lower" whose contact faces do not match.

    The narrower block covers ``[0, width] x [0, width]``; the interface passes through
    ``(width / 2, width / 2, 0)``, and the blocks end at ``z = height`` and ``z = -height``. They
    share no vertex. Boundaries: "slave" (lower face of "upper"), "master" (upper face of
    "lower"), "top", "bottom", and ``left_``, ``right_`` (x), ``front_``, ``back_`` (y) followed by
    "upper" or "lower".

    Parameters
    ----------
    kind_upper, kind_lower : {"tet", "hex", "prism", "prism_side", "pyramid"}
        Cells of the blocks, as in `StructuredBox`; by default both are the same.
    n_slave, n_master : int or (int, int)
        Divisions of the contact faces in x and y.
    layers : (int, int)
        Layers of cubes in the upper and the lower block.
    shape, slope, width, height
        As in `TwoBlocks`.
    azimuth : float
        Degrees: the direction of ascent, measured from the x axis.
    overhang : float
        By how much the lower block is wider on each of its four sides; the upper one if negative.
    aligned : bool
        With an overhang: end faces of the wider block where the narrower one ends. The faces
        outside are then named "master_rim" ("slave_rim"), and the divisions count those
        inside. Otherwise the whole face is divided evenly and has one name.
    perturb, seed
        Moves the points of the grids at random, see `StructuredBox`: an irregular interface.
    unstructured : bool
        Tetrahedra from Netgen in place of grids; the edges of the interface have the given
        divisions. Without `perturb`, and with ``aligned=False`` where there is an overhang.
    scale, rotation
        See `ngslac.meshes`.

    Returns
    -------
    ngsolve.Mesh

    Raises
    ------
    ValueError
        Also if the divisions make the two meshes match.

    Examples
    --------
    >>> from ngslac.meshes.blocks3d import TwoBlocks3D
    >>> mesh = TwoBlocks3D("hex", "tet", 2, 3)
    >>> mesh.GetMaterials(), mesh.ne
    (('upper', 'lower'), 58)
    """
    CheckPositive(width=width, height=height, scale=scale)
    CheckFinite(azimuth=azimuth, overhang=overhang)
    CheckAlike(width=width, height=height, **({"overhang": abs(overhang)} if overhang else {}))
    if unstructured and (perturb or (overhang and aligned)):
        raise ValueError("an unstructured mesh has no perturb, and aligned=False with an overhang")
    frame = _MakeFrame(shape, slope, azimuth, overhang, width, height, scale, rotation)
    n_slave, n_master = _Pair("n_slave", n_slave), _Pair("n_master", n_master)
    layers = _Pair("layers", layers)
    wider = (1 + 2 * abs(overhang) / width) ** 2
    for counts, deep in zip((n_slave, n_master), layers, strict=True):
        CheckElements(math.prod(counts) * deep * wider, overhang=overhang, width=width)
    grids = _Grids(n_slave, n_master, overhang, aligned, width)
    z = [np.linspace(0, height, layers[0] + 1), np.linspace(-height, 0, layers[1] + 1)]
    kinds = (kind_upper, kind_lower or kind_upper)
    ngmesh = NetgenMesh(dim=3)
    for i, name in enumerate(("upper", "lower")):
        names = _Names(name, width if aligned else math.inf)
        if unstructured:
            box = _TetBox(grids[i], z[i], names)
        else:
            options = {"perturb": perturb, "fixed": (0.0, width), "seed": seed + i}
            box = StructuredBox(*grids[i], z[i], kinds[i], names=names, **options)
        replace(box, points=frame.Map(box.points)).AddTo(ngmesh, name)
    ngmesh.Compress()
    mesh = Mesh(ngmesh)
    CheckNonMatching(mesh)
    return mesh


# ---------------------------------------------------------------- pieces


def _Pair(name: str, n: int | tuple[int, int]) -> tuple[int, int]:
    pair = tuple(n) if isinstance(n, (tuple, list, np.ndarray)) else (n, n)
    whole = all(isinstance(k, Integral) and not isinstance(k, bool) and k > 0 for k in pair)
    if len(pair) != 2 or not whole:
        raise ValueError(f"{name}: divisions must be one or two positive integers, but are {n}")
    return pair


def _MakeFrame(
    shape: str,
    slope: float,
    azimuth: float,
    overhang: float,
    width: float,
    height: float,
    scale: float,
    rotation: tuple[str | Sequence[float], float] | None,
) -> _Frame:
    direction = np.array([math.cos(math.radians(azimuth)), math.sin(math.radians(azimuth))])
    reach = np.abs(direction).sum() * (width / 2 + abs(overhang))
    rise = Incline(shape, slope, reach, height)
    matrix = scale * RotationMatrix(rotation)
    return _Frame(np.full(2, width / 2), rise * direction, height, matrix)


def _Grids(
    n_slave: tuple[int, int],
    n_master: tuple[int, int],
    overhang: float,
    aligned: bool,
    width: float,
) -> list[list[np.ndarray]]:
    """Grid positions (x, y) of the upper and of the lower block."""
    grids = []
    for counts, wider in ((n_slave, -overhang), (n_master, overhang)):
        wider, grid = max(wider, 0.0), []
        for n in counts:
            inside = np.linspace(0, width, n + 1)
            if wider and aligned:
                rim = np.linspace(0, wider, max(1, round(wider * n / width)) + 1)
                inside = np.concatenate([rim[:-1] - wider, inside, width + rim[1:]])
            elif wider:
                inside = np.linspace(-wider, width + wider, n + 1)
            grid.append(inside)
        grids.append(grid)
    return grids


def _Names(body: str, width: float) -> Callable[[str, np.ndarray], str]:
    """Names of the outer faces of a block; faces of the interface outside `width` are its rim."""
    contact, facing, far = (
        ("slave", "bottom", "top") if body == "upper" else ("master", "top", "bottom")
    )

    def Name(side: str, centre: np.ndarray) -> str:
        if side == facing:
            inside = math.isinf(width) or np.all((centre[:2] > 0) & (centre[:2] < width))
            return contact if inside else f"{contact}_rim"
        return far if side == far else f"{side}_{body}"

    return Name


def _TetBox(
    grid: list[np.ndarray], z: np.ndarray, names: Callable[[str, np.ndarray], str]
) -> Cells:
    """A box meshed by Netgen on its own, with the edges at the interface divided evenly."""
    (x, y), low, high = grid, [c[0] for c in (*grid, z)], [c[-1] for c in (*grid, z)]
    shape = Box(Pnt(*low), Pnt(*high))
    for edge in shape.edges:
        n = len(x) - 1 if edge.center.x not in (low[0], high[0]) else len(y) - 1
        if edge.center.z in (z[0], z[-1]):
            edge.partition = [k / n for k in range(1, n)]
    ngmesh = OCCGeometry(shape).GenerateMesh(
        maxh=max(np.diff(x).max(), np.diff(y).max()), parallel_meshing=False
    )
    points = np.array([p.p for p in ngmesh.Points()])
    cells = [[v.nr - 1 for v in el.vertices] for el in ngmesh.Elements3D()]
    faces = []
    for el in ngmesh.Elements2D():
        face = [v.nr - 1 for v in el.vertices]
        corners = points[face]
        faces.append((names(SideOf(corners, low, high), corners.mean(axis=0)), face))
    return Cells(points, [(a, c, b, d) for a, b, c, d in cells], faces)
