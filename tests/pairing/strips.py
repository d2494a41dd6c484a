"""Bodies that are strips of quadrilaterals on given contact nodes, and contacts between them."""

from dataclasses import dataclass

import numpy as np
from netgen.meshing import Element1D, Element2D, MeshPoint, Pnt
from netgen.meshing import Mesh as NetgenMesh
from ngsolve import Mesh, VectorH1

from ngslac import LACContact, LACSpace


@dataclass(frozen=True)
class Strip:
    """A body with one row of quadrilaterals between its contact nodes and their shifted copies.

    A boundary segment runs against the body's orientation where `flipped` says so (a bool, or one
    per segment).
    """

    name: str
    nodes: np.ndarray  # (n, 2)
    depth: tuple  # from the contact edge into the body
    face: str
    rest: str = "rest"
    flipped: object = False


def on_line(x, y=0.0):
    """Points (x_i, y)."""
    x = np.asarray(x, dtype=float)
    return np.stack([x, np.full_like(x, y)], axis=1)


def moved(points, angle=0.0, scale=1.0, shift=(0.0, 0.0)):
    """Points scaled, rotated (radians) and shifted."""
    c, s = np.cos(angle), np.sin(angle)
    return scale * np.asarray(points) @ np.array([[c, s], [-s, c]]) + np.asarray(shift)


def strip_mesh(*strips, angle=0.0, scale=1.0, shift=(0.0, 0.0)):
    """The mesh of some strips, moved as a whole."""
    ngmesh = NetgenMesh(dim=2)
    regions = {}
    for strip in strips:
        near = moved(strip.nodes, angle, scale, shift)
        far = moved(strip.nodes + np.asarray(strip.depth), angle, scale, shift)
        ids = [[ngmesh.Add(MeshPoint(Pnt(*p, 0))) for p in row] for row in (near, far)]
        add_cells(ngmesh, strip, ids, near, far)
        add_edges(ngmesh, strip, ids, regions)
    ngmesh.Compress()
    return Mesh(ngmesh)


def add_cells(ngmesh, strip, ids, near, far):
    """The quadrilaterals, counter-clockwise."""
    domain = ngmesh.AddRegion(strip.name, dim=2)
    (ax, ay), (bx, by) = near[1] - near[0], far[0] - near[0]
    turn = 1 if ax * by - ay * bx > 0 else -1
    for i in range(len(near) - 1):
        cell = [ids[0][i], ids[0][i + 1], ids[1][i + 1], ids[1][i]]
        ngmesh.Add(Element2D(domain, cell[::turn]))


def add_edges(ngmesh, strip, ids, regions):
    """The contact edge, and the three others under the name `rest`."""
    n = len(ids[0]) - 1
    flipped = np.broadcast_to(strip.flipped, n)
    edges = [(strip.face, *ids[0][i : i + 2][:: -1 if flipped[i] else 1]) for i in range(n)]
    edges += [(strip.rest, *ids[1][i : i + 2]) for i in range(n)]
    edges += [(strip.rest, ids[0][k], ids[1][k]) for k in (0, n)]
    for name, a, b in edges:
        if name not in regions:
            regions[name] = ngmesh.AddRegion(name, dim=1)
        ngmesh.Add(Element1D([a, b], index=regions[name]))


def contact_on(mesh, *, slave="slave", master="master", order=2, **flags):
    """A contact between two regions, each slave face a macro-element (order >= 2)."""
    V = VectorH1(mesh, order=order)
    X = V * LACSpace(V, slave=slave)
    u, lam = X.TrialFunction()
    contact = LACContact(u, lam, master=master, **flags)
    contact.Update()
    return contact


def slave_elements(contact):
    """Boundary element numbers of the slave faces, in the order of the mesh."""
    macros = np.array(contact.space.macros)
    return np.flatnonzero(macros >= 0)


def areas_by_face(contact):
    """Paired area of each slave face, from the segments."""
    segments = contact.Segments()
    area = np.bincount(segments.slave, segments.area, minlength=len(contact.space.macros))
    return area[slave_elements(contact)]


def overlap(a, b):
    """Lengths of the intersections of all intervals between nodes a with those between nodes b."""
    left = np.maximum(np.minimum(a[:-1], a[1:])[:, None], np.minimum(b[:-1], b[1:])[None])
    right = np.minimum(np.maximum(a[:-1], a[1:])[:, None], np.maximum(b[:-1], b[1:])[None])
    return np.maximum(right - left, 0.0)
