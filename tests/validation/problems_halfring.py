"""A half ring of two layers is pressed on a block (code_aster SSNP165), the right half of it.

The ring has the outer radius 100 mm and two layers of 5 mm, the inner one hundred times stiffer;
the block is 125 mm wide (half of it) and 50 mm high. The ends of the ring move down by 90 mm, of
which 20 mm are clearance. The ring touches in the middle first, then it buckles inwards there and
rests on two places that move outwards. x counts from the plane of symmetry.
"""

from itertools import pairwise

import numpy as np
from driven import RigidMotion
from netgen.geom2d import SplineGeometry
from netgen.meshing import Element1D, Element2D, MeshPoint, Pnt
from netgen.meshing import Mesh as NetgenMesh
from ngsolve import Mesh, VectorH1
from problems_large import Hencky, Model

from ngslac import BubbleVectorH1

YOUNG = {"inner": 1e5, "outer": 1e3, "block": 300.0}  # MPa
RADII = (90.0, 95.0, 100.0)
WIDTH, HEIGHT, CENTRE = 125.0, 50.0, 170.0
DEPTH = 90.0
PA, PB = (0.0, 50.0), (200.0 / 3, 50.0)  # points of the block's top


def RingMesh(h=4.2, *, order=2):
    """Mesh of triangles with the edge length h along both contact sides."""
    geometry = SplineGeometry()
    _Block(geometry, h)
    _Ring(geometry, h)
    for number, name in enumerate(YOUNG, start=1):
        geometry.SetMaterial(number, name)
    mesh = Mesh(geometry.GenerateMesh(maxh=3 * h, grading=0.3))
    mesh.Curve(order)
    return mesh


def _Block(geometry, h):
    corners = [(0, 0), (WIDTH, 0), (WIDTH, HEIGHT), PB, PA]
    names = ["bottom", "side", "slave", "slave", "sym"]
    points = [geometry.AppendPoint(*corner) for corner in corners]
    for p, q, name in zip(points, [*points[1:], points[0]], names, strict=True):
        size = {"maxh": h} if name == "slave" else {}
        geometry.Append(["line", p, q], leftdomain=3, rightdomain=0, bc=name, **size)


def _Ring(geometry, h):
    lower, corner, upper = (
        [geometry.AppendPoint(x, y) for x, y in ends]
        for ends in (
            [(0, CENTRE - r) for r in RADII],
            [(r, CENTRE - r) for r in RADII],
            [(r, CENTRE) for r in RADII],
        )
    )
    for k, name in enumerate(("inside", "layer", "master")):
        left = (0, 1, 2)[k], (1, 2, 0)[k]  # domains inside and outside of the arc
        arc = ["spline3", lower[k], corner[k], upper[k]]
        geometry.Append(arc, leftdomain=left[0], rightdomain=left[1], bc=name, maxh=0.9 * h)
    for k in (0, 1):
        for line, name, inside in ((lower, "sym", 0), (upper, "driven", 1)):
            sides = (k + 1, 0) if inside == 0 else (0, k + 1)
            ends = ["line", line[k + 1], line[k]]
            geometry.Append(ends, leftdomain=sides[1], rightdomain=sides[0], bc=name)


def QuadMesh(columns=15, rows=6):
    """The mesh of code_aster, half of it: quadrilaterals with straight edges, one per layer."""
    ngmesh = NetgenMesh(dim=2)
    angle = np.linspace(0, np.pi / 2, columns + 1)
    arcs = [np.column_stack([r * np.sin(angle), CENTRE - r * np.cos(angle)]) for r in RADII[::-1]]
    x = np.linspace(0, WIDTH, columns + 1)
    levels = [np.column_stack([x, np.full_like(x, y)]) for y in np.linspace(0, HEIGHT, rows + 1)]
    _Grid(ngmesh, levels, ["block"] * rows, ["bottom", "side", "slave", "sym"])
    _Grid(ngmesh, arcs, ["outer", "inner"], ["master", "driven", "inside", "sym"])
    return Mesh(ngmesh)


def _Grid(ngmesh, points, bodies, names):
    """Quadrilaterals between rows of points; names of the sides: first row, right, last, left."""
    node = np.array(
        [[ngmesh.Add(MeshPoint(Pnt(x, y, 0))) for x, y in row] for row in points], dtype=object
    )
    for i, body in enumerate(bodies):
        domain = _Region(ngmesh, body, 2)
        for a, b, c, d in zip(node[i], node[i, 1:], node[i + 1, 1:], node[i + 1], strict=False):
            ngmesh.Add(Element2D(domain, [a, b, c, d]))
    for name, chain in zip(
        names, (node[0], node[:, -1], node[-1, ::-1], node[::-1, 0]), strict=True
    ):
        for ends in pairwise(chain):
            ngmesh.Add(Element1D([*ends], index=_Region(ngmesh, name, 1)))


def _Region(ngmesh, name, dim):
    names = ngmesh.GetRegionNames(dim=dim)
    return names.index(name) + 1 if name in names else ngmesh.AddRegion(name, dim=dim)


def RingModel(mesh, *, order=2, energy=Hencky, friction=None, finite=True):
    """The discrete problem and what drives it; the load is code_aster's time."""
    fixed = {"dirichletx": "bottom|driven|sym", "dirichlety": "bottom|driven"}
    if order == 1:
        V = BubbleVectorH1(mesh, order=1, slave="slave", **fixed)
    else:
        V = VectorH1(mesh, order=order, **fixed)
    model = Model(V, energy, YOUNG, friction=friction, finite=finite)
    motion = RigidMotion(
        V, body="inner|outer", driven="driven", target=lambda: (0.0, -DEPTH * model.load.Get())
    )
    return model, motion
