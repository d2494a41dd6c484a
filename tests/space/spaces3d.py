"""Meshes of every element shape, and what holds for every partition of a slave surface."""

import numpy as np
from netgen.meshing import Mesh as NetgenMesh
from netgen.occ import Box, OCCGeometry, Pnt, Sphere
from ngsolve import BND, H1, VOL, Mesh, VectorH1, VectorValued

from ngslac import BubbleVectorH1
from ngslac.meshes.boxes import KINDS, AddBody, Cells, StructuredBox

__all__ = [
    "KINDS",
    "RIM",
    "SPACES",
    "TRIANGLES",
    "ball",
    "brick",
    "check_partition",
    "faces_of_macros",
    "mixed",
    "sizes",
    "slave_faces",
    "tetrahedra",
]

RIM = "left|right|front|back"
TRIANGLES = {"tet", "prism"}  # kinds with triangles on the lower side

SPACES = {
    "VectorH1": VectorH1,
    "H1(dim=3)": lambda mesh, **flags: H1(mesh, dim=3, **flags),
    "VectorValued": lambda mesh, **flags: VectorValued(H1(mesh, **flags), 3),
    "component": lambda mesh, **flags: (VectorH1(mesh, **flags) * H1(mesh)).components[0],
    "Bubble": lambda mesh, **flags: BubbleVectorH1(mesh, slave="bottom", **flags),
}


def brick(n=4, kind="hex", nz=2, *, mapping=None, perturb=0.0):
    """The unit cube in n x n x nz bricks, each cut into cells of one kind."""
    mesh = NetgenMesh(dim=3)
    lateral, height = np.linspace(0, 1, n + 1), np.linspace(0, 1, nz + 1)
    box = StructuredBox(lateral, lateral, height, kind, perturb=perturb, seed=1)
    points = box.points if mapping is None else mapping(box.points)
    AddBody(mesh, "body", Cells(points, box.cells, box.faces))
    mesh.Compress()
    return Mesh(mesh)


def mixed(n=4):
    """A row of hexahedra and prisms: the lower side has quadrilaterals, x < 1, and triangles."""
    lateral, height = np.linspace(0, 1, n + 1), [0, 0.5]
    parts = [
        StructuredBox(lateral + shift, lateral, height, kind)
        for shift, kind in enumerate(("hex", "prism"))
    ]
    points, number = np.unique(
        np.concatenate([part.points for part in parts]).round(12), axis=0, return_inverse=True
    )
    number = np.split(number.ravel(), [len(parts[0].points)])
    cells = [
        tuple(int(to[i]) for i in c) for to, p in zip(number, parts, strict=True) for c in p.cells
    ]
    faces = [
        (name, tuple(int(to[i]) for i in face))
        for to, part, inner in zip(number, parts, ("right", "left"), strict=True)
        for name, face in part.faces
        if name != inner
    ]
    mesh = NetgenMesh(dim=3)
    AddBody(mesh, "body", Cells(points, cells, faces))
    mesh.Compress()
    return Mesh(mesh)


def tetrahedra(maxh=0.3):
    """A box in unstructured tetrahedra with the names of `brick`."""
    box = Box(Pnt(0, 0, 0), Pnt(1, 1, 0.5))
    for face in box.faces:
        x, y, z = face.center.x, face.center.y, face.center.z
        ends = {"left": x, "right": 1 - x, "front": y, "back": 1 - y, "bottom": z, "top": 0.5 - z}
        face.name = min(ends, key=ends.get)
    return Mesh(OCCGeometry(box).GenerateMesh(maxh=maxh))


def ball(maxh=0.4, order=2):
    sphere = Sphere(Pnt(0, 0, 0), 1)
    sphere.faces.name = "surface"
    return Mesh(OCCGeometry(sphere).GenerateMesh(maxh=maxh)).Curve(order)


def slave_faces(mesh, slave="bottom"):
    return list(mesh.Boundaries(slave).Elements())


def faces_of_macros(Q):
    """The boundary elements of each macro-element."""
    macros = np.array(Q.macros)
    order = np.argsort(macros, kind="stable")
    return np.split(order, np.searchsorted(macros[order], np.arange(Q.nmacros)))[1:]


def sizes(Q):
    """Numbers of faces of the macro-elements, smallest first."""
    return sorted(map(len, faces_of_macros(Q)))


def check_partition(Q, slave="bottom"):
    """What holds for every space: no unused dofs, all faces taken, connected, cores inside."""
    mesh, macros = Q.mesh, np.array(Q.macros)
    faces = {el.nr: el for el in slave_faces(mesh, slave)}
    assert len(macros) == mesh.GetNE(BND)
    assert np.flatnonzero(macros >= 0).tolist() == sorted(faces)
    assert set(macros[list(faces)]) == set(range(Q.nmacros))
    assert Q.ndof * Q.dim == 3 * Q.nmacros
    assert all(Q.FreeDofs())
    assert not any(len(el.dofs) for el in Q.Elements(VOL))
    V = Q.displacement
    supports = scalar_supports(V, faces.values())
    for m, own in enumerate(faces_of_macros(Q)):
        assert is_connected([faces[nr] for nr in own])
        core = list(Q.CoreDofs(m))
        assert core
        assert all(supports[dof] <= set(own.tolist()) for dof in core)
        assert all(V.FreeDofs()[dof // V.dim] for dof in core)


def scalar_supports(V, faces):
    """Slave faces on which each scalar displacement dof lives."""
    supports = {}
    for el in faces:
        for dof in V.GetDofNrs(el):
            for k in range(V.dim):
                supports.setdefault(V.dim * dof + k, set()).add(el.nr)
    return supports


def is_connected(faces):
    vertices = [{v.nr for v in el.vertices} for el in faces]
    reached, rest = vertices[0], vertices[1:]
    while touching := [v for v in rest if v & reached]:
        reached = reached.union(*touching)
        rest = [v for v in rest if v not in touching]
    return not rest
