"""Bodies of one layer of cells under given contact faces: edges, triangles and quadrilaterals."""

from dataclasses import dataclass

import numpy as np
import shapely
from netgen.meshing import Mesh as NetgenMesh
from ngsolve import BND, CF, BilinearForm, GridFunction, Mesh, ds, x, y, z
from scipy.spatial import Delaunay
from scipy.spatial.transform import Rotation

from ngslac import BubbleVectorH1, LACContact, LACSpace
from ngslac.meshes.boxes import Cells

# Kinds of surfaces: "edge" in the plane, "trig", "quad" and "mixed" in space.
FLAT = ("trig", "quad", "mixed")
PAIRS = [("edge", "edge"), ("trig", "quad"), ("quad", "mixed"), ("mixed", "trig")]
UNIT = ((0.0, 0.0), (1.0, 1.0))
WIDER = ((-0.3, -0.2), (1.2, 1.3))
SHIFTED = ((-0.2, -0.1), (0.8, 1.1))


@dataclass(frozen=True)
class Sheet:
    """A body with one layer of cells between its contact faces and their copies.

    Faces are tuples of point numbers, in either orientation. With a random generator `renumbered`
    the boundary elements start at any corner and run in any direction.
    """

    name: str
    points: np.ndarray  # (n, dim)
    faces: list
    depth: object  # from the contact faces into the body, (dim,) or (n, dim)
    face: str
    rest: str = "rest"
    renumbered: object = None  # a numpy generator


def renumber(rng, face):
    turned = np.roll(face, -rng.integers(len(face)))
    return tuple(turned[:: rng.choice([1, -1])].tolist())


def add_sheet(ngmesh, sheet, motion):
    """Add a sheet as a body of a netgen mesh."""
    near = np.asarray(sheet.points, dtype=float)
    depth = np.broadcast_to(np.asarray(sheet.depth, dtype=float), near.shape)
    n, dim = near.shape
    cells, faces, sides = [], [], {}
    for face in sheet.faces:
        inwards = np.dot(face_vector(near[list(face)]), depth[list(face)].mean(axis=0))
        f = tuple(int(i) for i in (face if inwards > 0 else face[::-1]))
        copy = tuple(i + n for i in f)
        cells.append((*f, *(copy if dim == 3 else copy[::-1])))
        contact = f[::-1] if sheet.renumbered is None else renumber(sheet.renumbered, f)
        faces += [(sheet.face, contact), (sheet.rest, copy)]
        rim = zip(f, (*f[1:], f[0]), strict=True) if dim == 3 else ((i,) for i in f)
        for part in rim:
            if sides.pop(part[::-1], None) is None:
                sides[part] = (sheet.rest, (*part, *(i + n for i in part[::-1])))
    used = sorted({i for cell in cells for i in cell})
    number = {old: new for new, old in enumerate(used)}
    points = motion(np.concatenate([near, near + depth])[used])
    cells = [tuple(number[i] for i in cell) for cell in cells]
    faces = [(name, tuple(number[i] for i in f)) for name, f in [*faces, *sides.values()]]
    Cells(points, cells, faces).AddTo(ngmesh, sheet.name)


def sheet_mesh(*sheets, motion=lambda points: points):
    """The mesh of some sheets, moved as a whole by ``motion(points)``."""
    ngmesh = NetgenMesh(dim=np.shape(sheets[0].points)[1])
    for sheet in sheets:
        add_sheet(ngmesh, sheet, motion)
    ngmesh.Compress()
    return Mesh(ngmesh)


class Motion:
    """A random rotation (None: no rotation), a factor, a translation."""

    def __init__(self, dim, seed=None, scale=1.0, shift=0.0):
        self.scale, self.shift, self.R = scale, np.broadcast_to(shift, 3)[:dim], np.eye(dim)
        if seed is not None:
            rng = np.random.default_rng(seed)
            a = rng.uniform(0, 2 * np.pi)
            turn = Rotation.from_quat(rng.normal(size=4)).as_matrix()
            plane = np.array([[np.cos(a), -np.sin(a)], [np.sin(a), np.cos(a)]])
            self.R = plane if dim == 2 else turn

    def __call__(self, points):
        return self.scale * np.asarray(points) @ self.R.T + self.shift

    def back(self, points):
        return (points - self.shift) / self.scale @ self.R

    @property
    def field(self):
        """The displacement."""
        rows = (self.scale * self.R - np.eye(len(self.R))).tolist()
        parts = [sum(a * r for a, r in zip(row, (x, y, z), strict=False)) for row in rows]
        return [part + s for part, s in zip(parts, self.shift.tolist(), strict=True)]


def dimension(kinds):
    return 2 if kinds[0] == "edge" else 3


def grid(kind, n=3, box=UNIT, rng=None):
    """A box divided into n (x n) faces, at random with a generator: points and faces."""
    low, high = np.array(box)[:, :1] if kind == "edge" else np.array(box)
    if kind == "edge":
        inner = np.linspace(0, 1, n + 1)[1:-1] if rng is None else np.sort(rng.random(2 * n))
        nodes = np.concatenate([[0], inner, [1]])[:, None]
        return low + nodes * (high - low), [(i, i + 1) for i in range(len(nodes) - 1)]
    if kind == "trig" and rng is not None:
        ring = [(i / 2, j / 2) for i in range(3) for j in range(3) if (i, j) != (1, 1)]
        points = np.concatenate([ring, rng.uniform(0.02, 0.98, (n * n, 2))])
        return low + points * (high - low), [tuple(t) for t in Delaunay(points).simplices.tolist()]
    return quadrilaterals(kind, n, low, high, rng)


def quadrilaterals(kind, n, low, high, rng):
    """A grid, its inner points moved with a generator; all cells cut for "trig", or some."""
    line = np.linspace(0, 1, n + 1)
    points = np.stack(np.meshgrid(line, line, indexing="ij"), axis=-1)
    cut = {"trig": range(n * n), "quad": (), "mixed": range(0, n * n, 3)}[kind]
    if rng is not None:
        moves = 0.25 * rng.uniform(-1, 1, points.shape) / n
        moves[[0, -1], :, 0] = moves[:, [0, -1], 1] = 0
        points = points + moves
        cut = rng.permutation(n * n)[: n * n // 2] if kind == "mixed" else cut
    number, faces = np.arange((n + 1) ** 2).reshape(n + 1, n + 1), []
    for cell in range(n * n):
        i, j = divmod(cell, n)
        a, b, c, d = number[i : i + 2, j : j + 2].ravel()[[0, 2, 3, 1]].tolist()
        faces += [(a, b, c), (a, c, d)] if cell in cut else [(a, b, c, d)]
    return low + points.reshape(-1, 2) * (high - low), faces


def in_plane(points, z=0.0, slope=(0.0, 0.0)):
    """Points (n, dim - 1) at the heights z + slope.points."""
    points = np.asarray(points, dtype=float)
    return np.column_stack([points, z + points @ np.asarray(slope)[: points.shape[1]]])


def plate(up, points, faces, z, depth, name, slope, **flags):
    points = in_plane(points, z, slope)
    into = up * depth * np.eye(points.shape[1])[-1]
    return Sheet(name, points, faces, into, "slave" if up > 0 else "master", **flags)


def upper(surface, z=0.0, depth=0.5, name="upper", slope=(0.0, 0.0), **flags):
    return plate(1, *surface, z, depth, name, slope, **flags)


def lower(surface, z=0.0, depth=0.5, name="lower", slope=(0.0, 0.0), **flags):
    return plate(-1, *surface, z, depth, name, slope, **flags)


def two_sheets(rng, kinds, box=SHIFTED, gap=0.0, slope=(0.0, 0.0), n=(3, 4)):
    """Random divisions; the master's plane z = -gap + slope.(x, y); any numbering of faces."""
    slave, master = grid(kinds[0], n[0], rng=rng), grid(kinds[1], n[1], box, rng)
    return [upper(slave, renumbered=rng), lower(master, -gap, slope=slope, renumbered=rng)]


def contact_on(mesh, *, slave="slave", master="master", order=1, **flags):
    """A contact between two regions, each slave face a macro-element."""
    V = BubbleVectorH1(mesh, order=order, slave=slave)
    u, lam = (V * LACSpace(V, slave=slave)).TrialFunction()
    contact = LACContact(u, lam, master=None if "obstacle" in flags else master, **flags)
    contact.Update()
    return contact


def with_slave_normals(contact):
    """The contact, where the slave's body is rigid beside the other one: its normals count."""
    fes = contact.form.fes
    (u, _), (v, _) = fes.TnT()
    soft = BilinearForm(u * v * ds(definedon=contact.master)).Assemble()
    contact.Prepare(soft.mat)
    contact.Evaluate(GridFunction(fes))
    return contact


def paired(sheets, *motion, **flags):
    """The contact of some sheets, after a motion of the whole given by what makes a `Motion`."""
    motion = Motion(np.shape(sheets[0].points)[1], *motion)
    return contact_on(sheet_mesh(*sheets, motion=motion), **flags)


def displaced(contact, **fields):
    """A GridFunction on the contact's space with given displacements of the materials."""
    gf = GridFunction(contact.form.fes)
    none = CF((0,) * contact.mesh.dim)
    cfs = {name: CF(tuple(field)) for name, field in fields.items()}
    gf.components[0].Set(contact.mesh.MaterialCF(cfs, default=none))
    return gf


def face_vector(corners):
    """Area times normal of a plane face, of a warped one its best guess."""
    p = np.asarray(corners)
    if p.shape[1] == 2:
        return np.array([p[0, 1] - p[1, 1], p[1, 0] - p[0, 0]])
    return 0.5 * np.cross(p[-2] - p[0], p[-1] - p[-3 if len(p) == 4 else 1])


def face_sizes(faces):
    return np.array([np.linalg.norm(face_vector(c)) for c in faces])


def faces_of(mesh, region):
    """Boundary elements of a region: their numbers, and their corners, each (2 to 4, dim)."""
    elements = list(mesh.Boundaries(region).Elements())
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


def mean_gap(contact):
    segments = contact.Segments()
    return segments.area @ segments.gap / segments.area.sum()


def outlines(segments):
    """Corners of the segments on the slave, each (2 or more, dim)."""
    points = segments.slave_points
    return list(points) if points.ndim == 3 else np.split(points, segments.first[1:-1])


def flat(points):
    """A shape of the plane by its corners (n, 2), or of a line (n, 1) as a strip of width one."""
    points = np.asarray(points)
    if points.shape[1] == 1:
        return shapely.box(points.min(), 0, points.max(), 1)
    return shapely.Polygon(points)


def flat_box(low, high):
    """A box of the plane or of a line."""
    return shapely.box(*low, *high) if len(low) == 2 else shapely.box(low[0], 0, high[0], 1)


def projected_overlaps(slave, master):
    """Area of the intersections of plane faces, seen along the normal of the slave face.

    `slave` and `master` are lists of corners; the result is (n_slave, n_master).
    """
    table = np.zeros((len(slave), len(master)))
    for i, corners in enumerate(slave):
        t = corners[1] - corners[0]
        frame = [t / np.linalg.norm(t)]
        if len(t) == 3:
            normal = face_vector(corners)
            frame.append(np.cross(normal / np.linalg.norm(normal), frame[0]))
        own, *others = (flat((c - corners[0]) @ np.transpose(frame)) for c in [corners, *master])
        table[i] = shapely.area(shapely.intersection(own, others))
    return table
