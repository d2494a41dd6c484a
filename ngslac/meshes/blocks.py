# SPDX-License-Identifier: LGPL-2.1-or-later
"""Two blocks on each other: meshes for patch tests."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from netgen.meshing import Mesh as NetgenMesh
from netgen.occ import ArcOfCircle, Glue, Pnt, TopoDS_Shape
from ngsolve import Mesh

from ngslac.meshes.boxes import Cells
from ngslac.meshes.geometry import (
    Body,
    CheckNonMatching,
    Divisions,
    GenerateMesh,
    Incline,
    Label,
    Line,
    MovePoints,
    NonMatchingDivisions,
    RotationMatrix,
    Side,
)
from ngslac.meshes.sizes import (
    CheckAlike,
    CheckElements,
    CheckFinite,
    CheckMoved,
    CheckOrder,
    CheckPositive,
)

__all__ = ["TwoBlocks"]


@dataclass(frozen=True)
class _Block:
    """One body: its contact edge in pieces (name, start, end, divisions), and its far end."""

    name: str
    h: float
    pieces: list
    end: float  # y of the side away from the interface
    slope: float  # of the interface, dy/dx
    middle: float  # x where the interface crosses y = 0

    @property
    def top(self) -> str:
        return "top" if self.end > 0 else "bottom"

    def Height(self, x: float | np.ndarray) -> float | np.ndarray:
        """y of the interface at x."""
        return self.slope * (x - self.middle)

    def Nodes(self) -> np.ndarray:
        """Positions x of the nodes of the contact edge."""
        parts = [np.linspace(a, b, n + 1) for _, a, b, n in self.pieces]
        return np.concatenate([parts[0], *(p[1:] for p in parts[1:])])


def TwoBlocks(
    h_slave: float = 0.25,
    h_master: float | None = None,
    *,
    shape: str = "flat",
    slope: float = 20.0,
    overhang: float = 0.0,
    aligned: bool = True,
    quads: bool = False,
    structured: bool = False,
    curved: bool = False,
    width: float = 1.0,
    height: float = 1.0,
    order: int | None = None,
    scale: float = 1.0,
    angle: float = 0.0,
) -> Mesh:
    """Mesh of a block "upper" on a block "lower" with non-matching straight contact edges.

    The narrower block covers 0 <= x <= width; the interface passes through
    (width / 2, 0), and the blocks end at y = height and y = -height. Boundaries: "slave" (lower
    edge of "upper"), "master" (upper edge of "lower"), "top", "bottom", "left_upper",
    "right_upper", "left_lower", "right_lower".

    Parameters
    ----------
    h_slave, h_master : float
        Edge lengths on the two sides, by default ``h_master = 0.73 * h_slave``. Divisions
        are chosen such that no slave node faces a master node (except common ends).
    shape : {"flat", "oblique"}
        Interface horizontal, or inclined by `slope` degrees.
    slope : float
        Inclination for ``shape="oblique"``.
    overhang : float
        By how much the lower block is wider at each end; the upper one if negative.
    aligned : bool
        With an overhang: put vertices of the wider block at the ends of the narrower one. The
        free parts of its contact edge are then named "master_left" and "master_right"
        ("slave_left", "slave_right"). Otherwise the edge is divided evenly.
    quads : bool
        Quadrilaterals (without `structured`: mostly).
    structured : bool
        A grid in each block; triangles by cutting the quadrilaterals.
    curved : bool
        Each block is cut by a circular arc from the interface to its far side, so that interior
        edges (named "arc") are curved while the interface stays straight. Not with
        `structured`.
    width, height : float
        Sizes of the blocks.
    order, scale, angle
        See `ngslac.meshes`; the order is 2 by default if `curved`, else 1.

    Returns
    -------
    ngsolve.Mesh
    """
    h_master = 0.73 * h_slave if h_master is None else h_master
    CheckPositive(h_slave=h_slave, h_master=h_master, width=width, height=height)
    CheckFinite(overhang=overhang)
    wider = {"overhang": abs(overhang)} if overhang else {}
    CheckAlike(width=width, height=height, **wider)
    CheckMoved(scale, angle)
    order = (2 if curved else 1) if order is None else order
    CheckOrder(order)
    fine, area = min(h_slave, h_master), 2 * (width + 2 * abs(overhang)) * height
    coarse = fine if structured else max(h_slave, h_master)
    number = 2 * area / coarse**2 + 2 * (width + 2 * abs(overhang)) / fine
    CheckElements(number, h_slave=h_slave, h_master=h_master)
    if structured and curved:
        raise ValueError("a structured mesh has no curved edges: structured or curved, not both")
    incline = Incline(shape, slope, width / 2 + abs(overhang), height)
    sides = _Sides(h_slave, h_master, overhang, aligned, curved, width, height, incline)
    if structured:
        mesh = _StructuredMesh(sides, quads, scale, angle)
    else:
        mesh = GenerateMesh(
            [_Shape(side, curved) for side in sides],
            order=order,
            scale=scale,
            angle=angle,
            maxh=max(h_slave, h_master),
            quad_dominated=quads,
        )
    CheckNonMatching(mesh)
    return mesh


def _Sides(
    h_slave: float,
    h_master: float,
    overhang: float,
    aligned: bool,
    curved: bool,
    width: float,
    height: float,
    slope: float,
) -> tuple[_Block, _Block]:
    """Divide the contact edges: first the slave's, then the master's between its nodes."""
    cuts = (0.3729 * width, 0.5817 * width) if curved else (None, None)
    pieces = _Pieces("slave", -overhang, width, aligned, cuts[0])
    ends = [0.0, width]  # of the master, should it be the narrower one
    pieces = [(n, a, b, NonMatchingDivisions(ends, a, b, h_slave)) for n, a, b in pieces]
    upper = _Block("upper", h_slave, pieces, height, slope, width / 2)
    nodes = upper.Nodes()
    pieces = _Pieces("master", overhang, width, aligned, cuts[1])
    pieces = [(n, a, b, NonMatchingDivisions(nodes, a, b, h_master)) for n, a, b in pieces]
    return upper, _Block("lower", h_master, pieces, -height, slope, width / 2)


def _Pieces(
    name: str, wider: float, width: float, aligned: bool, cut: float | None
) -> list[tuple[str, float, float]]:
    """Split a contact edge at the ends of the other block and at the curved cut."""
    wider = max(wider, 0.0)
    if wider and aligned:
        pieces = [
            (f"{name}_left", -wider, 0.0),
            (name, 0.0, width),
            (f"{name}_right", width, width + wider),
        ]
    else:
        pieces = [(name, -wider, width + wider)]
    if cut is None:
        return pieces
    i = [p[0] for p in pieces].index(name)
    _, a, b = pieces[i]
    return [*pieces[:i], (name, a, cut), (name, cut, b), *pieces[i + 1 :]]


# ---------------------------------------------------------------- unstructured


def _Shape(side: _Block, curved: bool) -> TopoDS_Shape:
    """The body as an OCC face, or as two faces glued along an arc."""
    if not curved:
        return Body(_Outline(side, side.pieces, None, None), side.name)
    cut = next(i for i, p in enumerate(side.pieces) if i and side.pieces[i - 1][0] == p[0])
    x = side.pieces[cut][1]
    width = side.pieces[-1][2] - side.pieces[0][1]
    y0, y1 = side.Height(x), side.end
    middle = Pnt(x + 0.1 * width, 0.45 * y0 + 0.55 * y1, 0)
    arc = Side(ArcOfCircle(Pnt(x, y0, 0), middle, Pnt(x, y1, 0)), "arc")
    left = _Outline(side, side.pieces[:cut], None, arc)
    right = _Outline(side, side.pieces[cut:], arc, None)
    shape = Glue([Body(left, side.name), Body(right, side.name)])
    Label(shape, left + right)
    return shape


def _Outline(
    side: _Block,
    pieces: Sequence[tuple[str, float, float, int]],
    left: Side | None,
    right: Side | None,
) -> list[Side]:
    """The edges around some pieces of the contact edge; `left`, `right` replace a side."""

    # All edges run counter-clockwise, so that NGSolve's normals point outwards.
    clockwise = side.end < 0

    def Turned(
        p: tuple[float, float],
        q: tuple[float, float],
        name: str,
        count: int,
        turn: bool = clockwise,
    ) -> Side:
        return Line(*((q, p) if turn else (p, q)), name, count)

    def Upright(x: float, where: str) -> Side:
        y, turn = side.Height(x), clockwise != (where == "left")
        count = Divisions(abs(side.end - y), side.h)
        return Turned((x, y), (x, side.end), f"{where}_{side.name}", count, turn)

    x0, x1 = pieces[0][1], pieces[-1][2]
    contact = [
        Turned((a, side.Height(a)), (b, side.Height(b)), name, n) for name, a, b, n in pieces
    ]
    far = Turned((x1, side.end), (x0, side.end), side.top, Divisions(x1 - x0, side.h))
    return [*contact, right or Upright(x1, "right"), far, left or Upright(x0, "left")]


# ---------------------------------------------------------------- structured


def _StructuredMesh(sides: tuple[_Block, _Block], quads: bool, scale: float, angle: float) -> Mesh:
    """A grid in each block."""
    ngmesh = NetgenMesh(dim=2)
    for side in sides:
        _Grid(side, quads).AddTo(ngmesh, side.name)
    ngmesh.Compress()
    MovePoints(ngmesh, scale * RotationMatrix(("z", angle)))
    return Mesh(ngmesh)


def _Grid(side: _Block, quads: bool) -> Cells:
    """One block, numbered by rows from the interface on."""
    xs, rows = side.Nodes(), Divisions(abs(side.end), side.h)
    node, y = np.arange((rows + 1) * len(xs)).reshape(rows + 1, -1), side.Height(xs)
    ys = y + np.arange(rows + 1)[:, None] / rows * (side.end - y)
    points = np.column_stack([np.tile(xs, rows + 1), ys.ravel()])
    sense = -1 if side.end < 0 else 1  # the lower grid is numbered downwards
    cells = []
    for i, j in np.ndindex(rows, len(xs) - 1):
        a, b, c, d = node[i, j], node[i, j + 1], node[i + 1, j + 1], node[i + 1, j]
        cells += [cell[::sense] for cell in ([[a, b, c, d]] if quads else [[a, b, c], [a, c, d]])]
    names = [name for name, _, _, n in side.pieces for _ in range(n)]
    chains = [
        (node[0], names),
        (node[:, -1], [f"right_{side.name}"] * rows),
        (node[-1][::-1], [side.top] * len(names)),
        (node[::-1, 0], [f"left_{side.name}"] * rows),
    ]
    edges = [
        (label, ends[::sense])
        for nodes, labels in chains
        for label, *ends in zip(labels, nodes[:-1], nodes[1:], strict=True)
    ]
    return Cells(points, cells, edges)
