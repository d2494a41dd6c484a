"""Meshes of the stress set: mapped grids, the contact sides of which never match."""

from dataclasses import dataclass, field
from itertools import pairwise

import numpy as np
from netgen.meshing import Element1D, Element2D, MeshPoint, Pnt
from netgen.meshing import Mesh as NetgenMesh
from netgen.occ import Compound, Face, OCCGeometry, Rectangle, Segment, Wire
from ngsolve import Mesh

from ngslac.meshes.boxes import Cells, StructuredBox


@dataclass(frozen=True)
class Block:
    """A grid of n = (nx, ny) or (nx, ny, nz) cells; its sides are called NAME_bottom etc.

    `place` is a box (x0, y0, x1, y1) or (x0, y0, z0, x1, y1, z1), or in the plane a map of arrays
    (s, t) of the unit square to (x, y) that keeps the orientation. In space `bend` maps points
    (n, 3) of the box; if `closed`, its left and right sides on each other.
    """

    name: str
    place: object
    n: tuple
    kind: str = ""  # "trig" or "quad"; in space one of `StructuredBox`, "hex" if there is none
    bend: object = None
    closed: bool = False


def Box(x0, y0, x1, y1):
    """The map of the unit square onto a rectangle."""
    return lambda s, t: (x0 + (x1 - x0) * s, y0 + (y1 - y0) * t)


def Turned(angle, a, b):
    """A vector, or place, turned about the origin."""
    c, s = np.cos(angle), np.sin(angle)
    return c * a - s * b, s * a + c * b


def Rotated(shape, degrees):
    """A map followed by a rotation about the origin."""
    return lambda a, b: Turned(np.radians(degrees), *shape(a, b))


def Polar(angle, radius):
    """Cartesian coordinates."""
    return radius * np.cos(angle), radius * np.sin(angle)


def Disc(s, t, radius=1.0):
    """The square as a disc that touches y = 0."""
    a, b = 2 * s - 1, 2 * t - 1
    return radius * a * np.sqrt(1 - b * b / 2), radius * (1 + b * np.sqrt(1 - a * a / 2))


def Grids(*blocks, **named):
    """An NGSolve mesh of `Block`s that share no nodes; ``name=(place, n, ...)`` is one, too."""
    blocks = [*blocks, *(Block(name, *rest) for name, rest in named.items())]
    ngmesh = NetgenMesh(dim=len(blocks[0].n))
    for block in blocks:
        (_AddGrid if ngmesh.dim == 2 else _AddBoxes)(ngmesh, block)
    ngmesh.Compress()
    return Mesh(ngmesh)


def _AddGrid(ngmesh, block):
    shape, (nx, ny) = block.place if callable(block.place) else Box(*block.place), block.n
    s, t = np.meshgrid(np.linspace(0, 1, nx + 1), np.linspace(0, 1, ny + 1), indexing="ij")
    xs, ys = (np.broadcast_to(np.asarray(c, dtype=float), s.shape) for c in shape(s, t))
    domain = ngmesh.AddRegion(block.name, dim=2)
    node = np.empty(s.shape, dtype=object)
    for i, j in np.ndindex(s.shape):
        node[i, j] = ngmesh.Add(MeshPoint(Pnt(xs[i, j], ys[i, j], 0)))
    for i, j in np.ndindex(nx, ny):
        a, b, c, d = node[i, j], node[i + 1, j], node[i + 1, j + 1], node[i, j + 1]
        for cell in [[a, b, c, d]] if block.kind == "quad" else [[a, b, c], [a, c, d]]:
            ngmesh.Add(Element2D(domain, cell))
    # The outline is walked counter-clockwise: the checks rely on this order.
    sides = {"bottom": node[:, 0], "right": node[-1], "top": node[::-1, -1], "left": node[0, ::-1]}
    for side, chain in sides.items():
        index = ngmesh.AddRegion(f"{block.name}_{side}", dim=1)
        for a, b in pairwise(chain):
            ngmesh.Add(Element1D([a, b], index=index))


def _AddBoxes(ngmesh, block):
    ends = zip(block.place[:3], block.place[3:], block.n, strict=True)
    grid = [np.linspace(a, b, n + 1) for a, b, n in ends]
    cells = StructuredBox(*grid, block.kind or "hex", names=lambda side, _: f"{block.name}_{side}")
    if block.bend:
        cells = Cells(block.bend(cells.points), cells.cells, cells.faces)
    (Closed(cells, block.name) if block.closed else cells).AddTo(ngmesh, block.name)


def Closed(cells, name):
    """The left and right sides of a block become one, inside of the body."""
    size = np.ptp(cells.points, axis=0).max()
    _, first, number = np.unique(
        np.round(cells.points / size, 9) + 0.0, axis=0, return_index=True, return_inverse=True
    )
    number = number.ravel()

    def Renumbered(corners):
        return tuple(int(number[i]) for i in corners)

    seam = (f"{name}_left", f"{name}_right")
    faces = [(side, Renumbered(face)) for side, face in cells.faces if side not in seam]
    return Cells(cells.points[first], [Renumbered(cell) for cell in cells.cells], faces)


@dataclass(frozen=True)
class Part:
    """An OCC face as a body; `edges` are points beside the edges that get a name of their own.

    Edges are called NAME_free, or NAME_SIDE for ``edges={"SIDE": [(x, y), ...]}``; `sizes` are
    mesh sizes along some of them.
    """

    name: str
    face: object
    maxh: float
    edges: dict
    sizes: dict = field(default_factory=dict)


def Plate(x0, y0, x1, y1):
    """A rectangle as OCC face."""
    return Rectangle(x1 - x0, y1 - y0).Face().Move((x0, y0, 0))


def Outline(*points):
    """A polygon as OCC face."""
    ends = [(*point, 0) for point in points]
    return Face(Wire([Segment(a, b) for a, b in pairwise([*ends, ends[0]])]))


def Sketch(*parts, curve=1):
    """An unstructured NGSolve mesh of `Part`s that share no nodes."""
    for part in parts:
        part.face.faces.name = part.name
        part.face.faces.maxh = part.maxh
        part.face.edges.name = f"{part.name}_free"
        for side, points in part.edges.items():
            for point in points:
                edge = part.face.edges.Nearest((*point, 0))
                edge.name = f"{part.name}_{side}"
                edge.maxh = part.sizes.get(side, part.maxh)
    shape = Compound([part.face for part in parts])
    mesh = Mesh(OCCGeometry(shape, dim=2).GenerateMesh())
    return mesh if curve == 1 else mesh.Curve(curve)
