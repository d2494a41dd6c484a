"""Bodies under given contact faces in 3D: triangles and quadrilaterals, extruded by one layer."""

from dataclasses import dataclass

import numpy as np
import shapely
from netgen.meshing import Mesh as NetgenMesh
from ngsolve import BND, Mesh
from scipy.spatial import Delaunay
from scipy.spatial.transform import Rotation

from ngslac import BubbleVectorH1, LACContact, LACSpace
from ngslac.meshes.boxes import AddBody, Cells


@dataclass(frozen=True)
class Sheet:
    """A body with one layer of prisms and hexahedra between its contact faces and their copies.

    Faces are tuples of three or four point numbers, in either orientation. With a random generator
    `renumbered` the boundary elements start at any corner and run in any direction.
    """

    name: str
    points: np.ndarray  # (n, 3)
    faces: list
    depth: object  # from the contact faces into the body, (3,) or (n, 3)
    face: str
    rest: str = "rest"
    renumbered: object = None  # a numpy generator


def add_sheet(ngmesh, sheet, motion=lambda points: points):
    """Add a sheet as a body of a netgen mesh."""
    near = np.asarray(sheet.points, dtype=float)
    depth = np.broadcast_to(np.asarray(sheet.depth, dtype=float), near.shape)
    n = len(near)
    cells, faces, sides = [], [], {}
    for face in sheet.faces:
        corners = near[list(face)]
        inwards = np.dot(face_vector(corners), depth[list(face)].mean(axis=0))
        f = tuple(int(i) for i in (face if inwards > 0 else face[::-1]))
        cells.append((*f, *(i + n for i in f)))
        contact = f[::-1]
        if sheet.renumbered is not None:
            contact = np.roll(contact, sheet.renumbered.integers(len(f)))
            contact = tuple(contact[:: sheet.renumbered.choice([1, -1])].tolist())
        faces.append((sheet.face, contact))
        faces.append((sheet.rest, tuple(i + n for i in f)))
        for a, b in zip(f, np.roll(f, -1).tolist(), strict=True):
            if sides.pop((b, a), None) is None:
                sides[a, b] = (sheet.rest, (a, b, b + n, a + n))
    used = sorted({i for cell in cells for i in cell})
    number = {old: new for new, old in enumerate(used)}
    points = motion(np.concatenate([near, near + depth])[used])
    cells = [tuple(number[i] for i in cell) for cell in cells]
    faces = [(name, tuple(number[i] for i in f)) for name, f in [*faces, *sides.values()]]
    AddBody(ngmesh, sheet.name, Cells(points, cells, faces))


def face_vector(corners):
    """Area times normal of a plane face, of a warped one its best guess."""
    corners = np.asarray(corners)
    return np.cross(corners[-2] - corners[0], corners[-1] - corners[-3 if len(corners) == 4 else 1])


def sheet_mesh(*sheets, motion=lambda points: points):
    """The mesh of some sheets, moved as a whole by ``motion(points)``."""
    ngmesh = NetgenMesh(dim=3)
    for sheet in sheets:
        add_sheet(ngmesh, sheet, motion)
    ngmesh.Compress()
    return Mesh(ngmesh)


def rigid(seed=None, scale=1.0, shift=(0.0, 0.0, 0.0)):
    """A motion: a random rotation (None: no rotation), a factor, a translation."""
    quaternion = [0, 0, 0, 1] if seed is None else np.random.default_rng(seed).normal(size=4)
    matrix = Rotation.from_quat(quaternion).as_matrix()
    return lambda points: scale * np.asarray(points) @ matrix.T + np.asarray(shift)


def in_plane(points2, z=0.0):
    """Points (x, y, z)."""
    points2 = np.asarray(points2, dtype=float)
    return np.column_stack([points2, np.full(len(points2), z)])


def triangulation(rng, n=8, box=((0.0, 0.0), (1.0, 1.0))):
    """Random Delaunay triangulation of a rectangle with about n inner points."""
    low, high = np.array(box)
    edge = np.linspace(0, 1, 3)
    ring = [(x, y) for x in edge for y in edge if x in (0, 1) or y in (0, 1)]
    points = np.concatenate([ring, rng.uniform(0.02, 0.98, (n, 2))])
    points = low + points * (high - low)
    return points, [tuple(t) for t in Delaunay(points).simplices.tolist()]


def quad_grid(nx, ny, box=((0.0, 0.0), (1.0, 1.0)), rng=None, shift=0.25, diagonals=()):
    """A grid of quadrilaterals, its inner points moved at random; cells in `diagonals` are cut."""
    low, high = np.array(box)
    x, y = np.linspace(0, 1, nx + 1), np.linspace(0, 1, ny + 1)
    points = np.stack(np.meshgrid(x, y, indexing="ij"), axis=-1)
    if rng is not None:
        moves = shift * rng.uniform(-1, 1, points.shape) / (nx, ny)
        moves[[0, -1], :, 0] = moves[:, [0, -1], 1] = 0
        points = points + moves
    number = np.arange((nx + 1) * (ny + 1)).reshape(nx + 1, ny + 1)
    faces = []
    for i in range(nx):
        for j in range(ny):
            a, b, c, d = number[i : i + 2, j : j + 2].ravel()[[0, 2, 3, 1]].tolist()
            cut = (i * ny + j) in diagonals
            faces += [(a, b, c), (a, c, d)] if cut else [(a, b, c, d)]
    return low + points.reshape(-1, 2) * (high - low), faces


def surface(rng, kind, n=3, box=((0.0, 0.0), (1.0, 1.0))):
    """A random division of a rectangle: kind "trig", "quad" or "mixed"."""
    if kind == "trig":
        return triangulation(rng, n * n, box)
    cut = rng.permutation(n * n)[: n * n // 2].tolist() if kind == "mixed" else ()
    return quad_grid(n, n, box, rng, diagonals=cut)


def contact_on(mesh, *, slave="slave", master="master", order=1, **flags):
    """A contact between two regions, each slave face a macro-element."""
    V = BubbleVectorH1(mesh, order=order, slave=slave)
    u, lam = (V * LACSpace(V, slave=slave)).TrialFunction()
    contact = LACContact(u, lam, master=master, **flags)
    contact.Update()
    return contact


def faces_of(mesh, region):
    """Boundary elements of a region: their numbers, and their corners (n, 3 or 4, 3)."""
    elements = [el for el in mesh.Boundaries(region).Elements()]
    corners = [np.array([mesh.vertices[v.nr].point for v in el.vertices]) for el in elements]
    return np.array([el.nr for el in elements]), corners


def areas_by_pair(contact):
    """{(slave element, master element): area} of the segments."""
    segments, found = contact.Segments(), {}
    for s, m, area in zip(segments.slave, segments.master, segments.area, strict=True):
        found[int(s), int(m)] = found.get((int(s), int(m)), 0.0) + area
    return found


def areas_by_face(contact, slave="slave"):
    """Paired area of each slave face, in the order of the mesh."""
    segments = contact.Segments()
    area = np.bincount(segments.slave, segments.area, minlength=contact.mesh.GetNE(BND))
    return area[faces_of(contact.mesh, slave)[0]]


def projected_overlaps(slave, master):
    """Area of the intersections of plane faces, seen along the normal of the slave face.

    `slave` and `master` are lists of corners; the result is (n_slave, n_master).
    """
    table = np.zeros((len(slave), len(master)))
    for i, corners in enumerate(slave):
        normal = face_vector(corners)
        normal = normal / np.linalg.norm(normal)
        t = corners[1] - corners[0]
        t = t / np.linalg.norm(t)
        frame = np.stack([t, np.cross(normal, t)])
        own = shapely.Polygon((corners - corners[0]) @ frame.T)
        others = [shapely.Polygon((c - corners[0]) @ frame.T) for c in master]
        table[i] = shapely.area(shapely.intersection(own, others))
    return table
