"""Two clamped beams, one of which rests with its end on the other: contact ends inside of faces."""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from netgen.meshing import Mesh as NetgenMesh
from ngsolve import (
    Mesh,
    Parameter,
    VectorH1,
    ds,
)
from posed import posed
from press import linear, neo_hooke

from ngslac import ContactSolver
from ngslac.meshes.boxes import Cells, StructuredBox

LENGTH, HEIGHT, WIDTH = 1.0, 0.1, 0.15


@dataclass
class Beams:
    """The parts of a problem; `load` scales the pressure on the upper beam."""

    mesh: object
    gf: object
    contact: object
    solver: object
    load: object
    dim: int

    def Tip(self):
        """Deflection of the upper beam's end, in the middle of its height."""
        at = (
            (LENGTH - 1e-9, HEIGHT / 2) if self.dim == 2 else (LENGTH - 1e-9, WIDTH / 2, HEIGHT / 2)
        )
        return self.gf.components[0](self.mesh(*at))[self.dim - 1]


def Grid(xs, ys, names):
    """Quadrilaterals in 2D, with a name for each side (bottom, right, top, left)."""
    nx, ny = len(xs) - 1, len(ys) - 1
    node = np.arange((nx + 1) * (ny + 1)).reshape(ny + 1, nx + 1)
    points = np.array([(a, b, 0.0) for b in ys for a in xs])
    cells = [
        (node[j, i], node[j, i + 1], node[j + 1, i + 1], node[j + 1, i])
        for j in range(ny)
        for i in range(nx)
    ]
    chains = (node[0], node[:, -1], node[-1][::-1], node[::-1, 0])
    faces = [
        (name, (a, b))
        for name, chain in zip(names, chains, strict=True)
        for a, b in pairwise(chain)
    ]
    cells = [tuple(map(int, c)) for c in cells]
    return Cells(points, cells, [(n, tuple(map(int, f))) for n, f in faces])


def Mesh2D(overlap, n, layers):
    """Upper beam from x = 0, lower one up to x = 2 - overlap."""
    ngmesh = NetgenMesh(dim=2)
    up = np.linspace(0, LENGTH, n + 1)
    Grid(up, np.linspace(0, HEIGHT, layers + 1), ("under", "end_upper", "top", "clamp")).AddTo(
        ngmesh, "upper"
    )
    Grid(
        up + LENGTH - overlap,
        np.linspace(-HEIGHT, 0, layers + 1),
        ("bottom", "clamp", "over", "end_lower"),
    ).AddTo(ngmesh, "lower")
    ngmesh.Compress()
    return Mesh(ngmesh)


def Mesh3D(overlap, n, layers, wide, kind="hex", narrow=0.0):
    """The same; `narrow`: how much narrower the upper beam is on both sides."""
    ngmesh = NetgenMesh(dim=3)
    up, y = np.linspace(0, LENGTH, n + 1), np.linspace(0, WIDTH, wide + 1)
    upper = {"left": "clamp", "right": "end_upper", "top": "top", "bottom": "under"}
    lower = {"right": "clamp", "left": "end_lower", "top": "over", "bottom": "bottom"}
    own = np.linspace(narrow, WIDTH - narrow, wide + 1)
    z = np.linspace(0, HEIGHT, layers + 1)

    def name(table):
        return lambda side, centre: table.get(side, "side_" + table["top"])

    StructuredBox(up, own, z, kind, names=name(upper)).AddTo(ngmesh, "upper")
    StructuredBox(up + LENGTH - overlap, y, z - HEIGHT, kind, names=name(lower)).AddTo(
        ngmesh, "lower"
    )
    ngmesh.Compress()
    return Mesh(ngmesh)


def beams(
    *,
    dim=2,
    overlap=0.25,
    n=8,
    layers=1,
    wide=1,
    kind="hex",
    narrow=0.0,
    order=2,
    slave="under",
    master=None,
    load=1e-3,
    space=VectorH1,
    nonlinear=False,
    condense=False,
    solver=ContactSolver,
    mesh=None,
    **law,
):
    """Both beams clamped at their far ends, the upper one pressed down on its top."""
    if mesh is None:
        mesh = (
            Mesh2D(overlap, n, layers)
            if dim == 2
            else Mesh3D(overlap, n, layers, wide, kind, narrow)
        )
    master = master or {"under": "over", "over": "under"}[slave]
    flags = {} if space is VectorH1 else {"slave": slave}
    V = space(mesh, order=order, dirichlet="clamp", **flags)

    def bulk(u, v, pressure):
        return neo_hooke(u) if nonlinear else linear(u, v)

    def pressed(u, v, pressure):
        return pressure * v[dim - 1] * ds("top")

    law |= {"slave": slave, "master": master}
    p = posed(V, bulk, pressed, condense=condense, load=Parameter(load), **law)
    return Beams(mesh, p.gf, p.contact, solver(p.a, p.gf, p.contact), p.load, dim)
