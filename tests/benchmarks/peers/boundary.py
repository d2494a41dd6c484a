"""Faces, forces and starting positions as the drivers of the peers need them; NumPy only."""

from __future__ import annotations

import numpy as np

__all__ = ["BODIES", "SHIFT", "Lowered", "Opposite", "PressureForces"]

# The body of the slave, above, and that of the master.
BODIES = {
    "hertz": ("cylinder", "block"),
    "sphere": ("sphere", "block"),
    "patch": ("upper", "lower"),
}

# The upper body starts lower by this: contact is all that holds it.
SHIFT = {"hertz": 0.05, "sphere": 0.1, "patch": 1e-5}


def Lowered(mesh, order):
    """Coordinates (n, dim) of the nodes with the upper body moved down by `SHIFT`."""
    points = mesh.Points(order).copy()
    upper, _ = BODIES[mesh.problem]
    points[mesh.MaterialNodes(order, upper), -1] -= SHIFT[mesh.problem]
    return points


def Opposite(mesh, name):
    """The elements behind the faces of a boundary, and which of their corners lies opposite.

    Parameters
    ----------
    mesh : PeerMesh
    name : str
        Name of the boundary.

    Returns
    -------
    elements, corners : (n,) int arrays
        Number of the element in the mesh; number of the corner (from 0) in the element.
    """
    elements = mesh.owners[mesh.names == name]
    corners, faces = mesh.Elements(1)[elements], mesh.Faces(1, name)
    on_face = (corners[:, :, None] == faces[:, None, :]).any(axis=2)
    if not np.all(on_face.sum(axis=1) == mesh.dim):
        raise ValueError(f"faces of {name!r} do not belong to their elements")
    return elements, np.argmin(on_face, axis=1)


def PressureForces(mesh, name, pressure):
    """Vertical nodal forces of a pressure on a plane boundary in 3D, elements of first order.

    Parameters
    ----------
    mesh : PeerMesh
    name : str
        Name of the boundary.
    pressure : float
        Acts downwards.

    Returns
    -------
    (n,) array
        Force in z at each corner of the mesh.
    """
    faces = mesh.Faces(1, name)
    one, two = (mesh.points[faces[:, i]] - mesh.points[faces[:, 0]] for i in (1, 2))
    area = 0.5 * np.linalg.norm(np.cross(one, two), axis=1)
    return -pressure * np.bincount(faces.ravel(), np.repeat(area / 3, 3), minlength=mesh.nvertices)
