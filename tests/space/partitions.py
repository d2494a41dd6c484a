"""Displacement spaces by name, and a check of any partition of a slave surface."""

import numpy as np
from bricks import slave_faces
from ngsolve import BND, H1, VOL, VectorH1, VectorValued

from ngslac import BubbleVectorH1

SPACES = {
    "VectorH1": VectorH1,
    "H1(dim)": lambda mesh, **flags: H1(mesh, dim=mesh.dim, **flags),
    "VectorValued": lambda mesh, **flags: VectorValued(H1(mesh, **flags), mesh.dim),
    "component": lambda mesh, **flags: (VectorH1(mesh, **flags) * H1(mesh)).components[0],
    "Bubble": lambda mesh, **flags: BubbleVectorH1(mesh, slave="bottom", **flags),
}


def faces_of_macros(Q):
    """The boundary elements of each macro-element."""
    macros = np.array(Q.macros)
    return [np.flatnonzero(macros == m) for m in range(Q.nmacros)]


def sizes(Q):
    """Numbers of faces of the macro-elements, smallest first."""
    return sorted(map(len, faces_of_macros(Q)))


def cores(Q):
    return [sorted(Q.CoreDofs(m)) for m in range(Q.nmacros)]


def check_partition(Q, slave="bottom"):
    """Check a partition: dofs and faces are all used, macro-elements connected, cores inside."""
    mesh, macros = Q.mesh, np.array(Q.macros)
    faces = {el.nr: el for el in slave_faces(mesh, slave)}
    assert len(macros) == mesh.GetNE(BND)
    assert np.flatnonzero(macros >= 0).tolist() == sorted(faces)
    assert set(macros[list(faces)]) == set(range(Q.nmacros))
    assert Q.ndof * Q.dim == mesh.dim * Q.nmacros
    assert all(Q.FreeDofs())
    assert not any(len(el.dofs) for el in Q.Elements(VOL))
    for el in Q.Elements(BND):
        assert len(el.dofs) == el.GetFE().ndof == (mesh.dim // Q.dim if el.nr in faces else 0)
    V = Q.displacement
    supports = scalar_supports(V, faces.values())
    for own, core in zip(faces_of_macros(Q), cores(Q), strict=True):
        assert is_connected([faces[nr] for nr in own])
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
