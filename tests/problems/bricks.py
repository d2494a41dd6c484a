"""One body in cells of every shape, in 2D and 3D; the lower side is the slave surface."""

import netgen.meshing as ngm
import numpy as np
from netgen.csg import unit_cube
from netgen.geom2d import unit_square
from netgen.occ import Box, Circle, Glue, MoveTo, OCCGeometry, Rectangle, Sphere, X
from ngsolve import BND, Mesh
from ngsolve.meshes import MakeStructured2DMesh

from ngslac.meshes.boxes import KINDS as KINDS3D
from ngslac.meshes.boxes import StructuredBox

KINDS = ["trig", "quad", *KINDS3D]
TRIANGLES = {"tet", "prism"}  # kinds with triangles on the lower side
RIM = "left|right|front|back"


def dimension(kind):
    return 3 if kind in KINDS3D else 2


def by_hand(points, cells, facets, inside=()):
    """A mesh of cells (material, vertices) and facets (boundary, vertices), as they are written.

    Those of `inside` have the first two materials on their sides.
    """
    dim = len(points[0])
    mesh = ngm.Mesh(dim=dim)
    numbers = [mesh.Add(ngm.MeshPoint(ngm.Pnt(*p, *[0.0] * (3 - dim)))) for p in points]
    cell = ngm.Element2D if dim == 2 else ngm.Element3D
    materials, boundaries = ([*dict.fromkeys(n for n, _ in part)] for part in (cells, facets))
    for i, name in enumerate(materials):
        mesh.SetMaterial(i + 1, name)
    for i, name in enumerate(boundaries):
        if dim == 3:
            first = set(next(vertices for n, vertices in facets if n == name))
            owner = next(n for n, vertices in cells if first <= set(vertices))
            sides = {"domin": materials.index(owner) + 1, "domout": 2 if name in inside else 0}
            mesh.Add(ngm.FaceDescriptor(surfnr=i + 1, bc=i + 1, **sides))
        mesh.SetBCName(i, name)
    for name, vertices in cells:
        mesh.Add(cell(materials.index(name) + 1, [numbers[i] for i in vertices]))
    for name, vertices in facets:
        index, corners = boundaries.index(name) + 1, [numbers[i] for i in vertices]
        mesh.Add(ngm.Element1D(corners, index=index) if dim == 2 else ngm.Element2D(index, corners))
    return Mesh(mesh)


def brick(kind, n=4, layers=2, *, perturb=0.0, mapping=None):
    """The unit square or cube, n cells wide, in layers of one kind; `mapping` moves points (3D)."""
    if kind in ("trig", "quad"):
        return MakeStructured2DMesh(quads=kind == "quad", nx=n, ny=layers)
    lateral, height = np.linspace(0, 1, n + 1), np.linspace(0, 1, layers + 1)
    return box_mesh(StructuredBox(lateral, lateral, height, kind, perturb=perturb, seed=1), mapping)


def box_mesh(box, mapping=None):
    points = box.points if mapping is None else mapping(box.points)
    return by_hand(points, [("body", cell) for cell in box.cells], box.faces)


def mixed(n=4):
    """A row of hexahedra and prisms: the lower side has quadrilaterals, x < 1, and triangles."""
    grid = np.linspace(0, 2, 2 * n + 1), np.linspace(0, 1, n + 1), [0, 0.5]
    cells, faces = [], []
    for right, kind in enumerate(("hex", "prism")):
        box = StructuredBox(*grid, kind)
        here = [box.points[list(vertices), 0].mean() > 1 for vertices in box.cells]
        cells += [("body", v) for v, there in zip(box.cells, here, strict=True) if there == right]
        faces += [f for f in box.faces if (box.points[list(f[1]), 0].mean() > 1) == right]
    return by_hand(box.points, cells, faces)


def unstructured(dim, maxh):
    """The unit square or cube in triangles or tetrahedra with the names of `brick`."""
    return Mesh((unit_square if dim == 2 else unit_cube).GenerateMesh(maxh=maxh))


def ball(dim, maxh, order=2, **options):
    """The unit disc or ball; its boundary is "surface"."""
    body = Circle((0, 0), 1).Face() if dim == 2 else Sphere((0, 0, 0), 1)
    (body.edges if dim == 2 else body.faces).name = "surface"
    return Mesh(OCCGeometry(body, dim=dim).GenerateMesh(maxh=maxh, **options)).Curve(order)


def glued(dim, maxh, quads=False):
    """Two unit squares or cubes "A" and "B" with a common "interface"; "end" is opposite on B."""
    if dim == 2:
        bodies = [Rectangle(1, 1).Face(), MoveTo(1, 0).Rectangle(1, 1).Face()]
        bodies[1].faces.quad_dominated = quads
    else:
        bodies = [Box((0, 0, 0), (1, 1, 1)), Box((1, 0, 0), (2, 1, 1))]
    for body, material, end in zip(bodies, "AB", ("interface", "end"), strict=True):
        sides, whole = (body.edges, body.faces) if dim == 2 else (body.faces, body.solids)
        sides.name, whole.name = "side", material
        sides.Max(X).name = end
    return Mesh(OCCGeometry(Glue(bodies), dim=dim).GenerateMesh(maxh=maxh))


def facet(el):
    """The edge (2D) or face (3D) that a boundary element is."""
    return el.faces[0] if el.faces else el.edges[0]


def slave_faces(mesh, slave="bottom"):
    return list(mesh.Boundaries(slave).Elements())


def middle(mesh, el):
    return np.mean([mesh[v].point for v in el.vertices], axis=0)


def flipped(mesh, every=2):
    """The same first-order mesh; each `every`-th boundary element (0: none) is written backwards,
    as the boundary elements of many mesh generators run in mixed directions.
    """
    cells = [(el.mat, [v.nr for v in el.vertices]) for el in mesh.Elements()]
    facets = [
        (el.mat, [v.nr for v in el.vertices][:: -1 if every and el.nr % every == 1 else 1])
        for el in mesh.Elements(BND)
    ]
    return by_hand([v.point for v in mesh.vertices], cells, facets)
