"""Meshes of the parallel cases: as a user makes them, in one process or distributed to several."""

from netgen.occ import (
    Axis,
    Box,
    Circle,
    Compound,
    MoveTo,
    OCCGeometry,
    Pnt,
    Rectangle,
    Sphere,
    X,
    Y,
    Z,
)
from ngsolve import Mesh

UPWARDS = Axis((0, 0, 0), Z)


def meshed(comm, *shapes, dim=2, maxh=1.0, **options):
    """The only place where a distributed mesh differs from one of a single process."""
    given = {"parallel_meshing": False} if dim == 3 else {}  # one thread takes less time
    given |= {} if comm is None else {"comm": comm}
    geometry = OCCGeometry(Compound(shapes), dim=dim)
    return Mesh(geometry.GenerateMesh(maxh=maxh, **options, **given))


def rectangle(low, high, h, material, *, top, bottom, side="side"):
    face = MoveTo(*low).Rectangle(high[0] - low[0], high[1] - low[1]).Face()
    face.faces.name, face.edges.name, face.faces.maxh = material, side, h
    face.edges.Max(Y).name, face.edges.Min(Y).name = top, bottom
    face.edges.Max(Y).maxh = 0.5 * h
    return face


def bowl(center, radius, h, material="disc", slave="slave", top="top"):
    """The lower half of a disc."""
    cut = Rectangle(2 * radius, radius).Face().Move((center[0] - radius, center[1] - radius, 0))
    # The seam of the circle goes to the half that is cut away.
    disc = Circle((0, 0), radius).Face().Rotate(UPWARDS, 90).Move((*center, 0)) * cut
    disc.faces.name, disc.edges.name = material, slave
    disc.edges.Max(Y).name, disc.faces.maxh, disc.edges.maxh = top, 2 * h, h
    return disc


def disc_on_block(comm, h=0.05):
    disc = bowl((0, 1.002), 1.0, h)
    block = rectangle((-1.5, -1), (1.5, 0), 2.6 * h, "block", top="master", bottom="bottom")
    return meshed(comm, disc, block)


def two_discs_on_block(comm, h=0.06):
    discs = [
        bowl((x, r + 0.003), r, h, f"disc{k}", f"slave{k}", f"top{k}")
        for k, (x, r) in enumerate(((-1.1, 0.9), (0.9, 0.7)))
    ]
    block = rectangle((-2.3, -1), (2.1, 0), 2.6 * h, "block", top="master", bottom="bottom")
    return meshed(comm, *discs, block)


def block_on_block(comm, h=0.12, gap=0.0, shift=0.0):
    """Blocks that share no node: the lower one is wider and has other sizes."""
    upper = rectangle((shift, gap), (shift + 1, 1), h, "upper", top="top", bottom="slave")
    upper.edges.Min(Y).maxh = 0.45 * h
    ends = (shift - 0.5, -1), (shift + 1.6, 0)
    lower = rectangle(*ends, 1.37 * h, "lower", top="master", bottom="bottom")
    return meshed(comm, upper, lower)


def leaves(comm):
    """Two thin leaves, clamped at the left; the upper one is to be pressed down at its tip."""
    faces = [
        rectangle((0, k), (15, k + 1), h, f"leaf{k}", top=top, bottom=bottom)
        for k, h, top, bottom in ((0, 1.3, "master", "under"), (1, 1.0, "over", "slave"))
    ]
    for face in faces:
        face.edges.Min(X).name, face.edges.Max(X).name = "clamp", "tip"
    faces[1].edges.Max(X).name = "pressed"
    return meshed(comm, *faces)


def die_on_slab(comm, h=0.2):
    die = bowl((0.75, 0.52), 0.5, 0.7 * h, "die", "slave")
    slab = rectangle((0, -1), (4, 0), h, "slab", top="master", bottom="bottom")
    return meshed(comm, die, slab)


def slotted(comm, h=0.3, width=0.08):
    """A square with a slot from the left; the sides of the slot are the boundary "slave"."""
    square = MoveTo(-1, -1).Rectangle(2, 2).Face()
    shape = square - MoveTo(-1.5, -width / 2).Rectangle(2, width).Face()
    shape.faces.name, shape.edges.name = "square", "side"
    for edge in shape.edges:
        if abs(edge.center.y) < 0.5 and abs(edge.center.x) < 0.9:
            edge.name, edge.maxh = "slave", 0.6 * h
    shape.edges.Max(Y).name, shape.edges.Min(Y).name = "top", "bottom"
    return meshed(comm, shape, maxh=h)


def ball_over_slab(comm, h=0.4):
    ball = Circle((0, 0), 1).Face().Rotate(UPWARDS, 90).Move((0, 1.02, 0))
    ball.faces.name, ball.edges.name, ball.faces.maxh = "ball", "slave", h
    slab = rectangle((-2, -0.6), (3, 0), 0.45, "slab", top="master", bottom="bottom", side="bottom")
    return meshed(comm, ball, slab)


def ring_and_disc(comm, h=0.25):
    """A quarter of a disc in a quarter of a ring, with a small clearance."""
    quarter = Rectangle(3, 3).Face()
    disc = Circle((0, 0), 1).Face() * quarter
    ring = (Circle((0, 0), 2).Face() - Circle((0, 0), 1.001).Face()) * quarter
    for shape, material, bound, size in (
        (disc, "disc", "slave", h),
        (ring, "ring", "rim", 1.3 * h),
    ):
        shape.faces.name, shape.edges.name, shape.faces.maxh = material, bound, size
        shape.edges.Min(X).name, shape.edges.Min(Y).name = "symx", "symy"
    for edge in ring.edges:
        if edge.name == "rim" and edge.mass < 2:
            edge.name = "master"
    return meshed(comm, disc, ring)


def sphere_on_block(comm, h=0.25):
    sphere = Sphere(Pnt(0, 0, 1.003), 1).Rotate(Axis((0, 0, 1.003), X), 90)
    cap = sphere * Box(Pnt(-2, -2, -1), Pnt(2, 2, 0.6))
    block = Box(Pnt(-0.9, -1, -0.8), Pnt(1, 0.9, 0))
    return pair_in_space(comm, cap, block, ("sphere", "block"), h)


def cube_on_block(comm, h=0.25, gap=0.01):
    upper = Box(Pnt(0, 0, gap), Pnt(1, 1, 1))
    lower = Box(Pnt(-0.3, -0.2, -0.7), Pnt(1.2, 1.3, 0))
    return pair_in_space(comm, upper, lower, ("upper", "lower"), h)


def pair_in_space(comm, upper, lower, materials, h):
    for solid, material, size in zip((upper, lower), materials, (1.6 * h, 2 * h), strict=True):
        solid.mat(material)
        solid.faces.name, solid.maxh = "side", size
    upper.faces.Max(Z).name, lower.faces.Min(Z).name = "top", "bottom"
    lower.faces.Max(Z).name = "master"
    for face in upper.faces:
        if face.name == "side" and face.center.z < 0.35:
            face.name, face.maxh = "slave", 0.7 * h
    lower.faces.Max(Z).maxh = 0.9 * h
    return meshed(comm, upper, lower, dim=3)
