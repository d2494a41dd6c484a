"""The smallest mesh of each problem of the comparison, made by hand: two simplices."""

import numpy as np
from boundary import BODIES
from meshes import EDGES, FACE_EDGES, PeerMesh

__all__ = ["TinyMesh"]


def TinyMesh(problem):
    """A simplex on a larger, mirrored one; each face is a boundary of its own."""
    dim = 2 if problem == "hertz" else 3
    upper = np.vstack([np.zeros(dim), np.eye(dim)])
    lower = 1.2 * upper * np.append(np.ones(dim - 1), -1)
    corners = np.vstack([upper, lower])
    first = list(range(dim + 1))
    second = [node + dim + 1 for node in (0, 2, 1, 3)[: dim + 1]]  # of positive volume
    sides = ["sym"] if dim == 2 else ["sym_x", "sym_y"]
    faces, names = [], []
    for start, (far, near) in ((0, ("top", "slave")), (dim + 1, ("bottom", "master"))):
        for opposite, name in enumerate([far, *sides, near]):
            faces.append([start + node for node in first if node != opposite])
            names.append(name)
    numbers, points = {}, list(corners)
    elements = [WithMidNodes(cell, EDGES[dim], numbers, points) for cell in (first, second)]
    faces = [WithMidNodes(face, FACE_EDGES[dim], numbers, points) for face in faces]
    return PeerMesh(
        problem,
        1.0,
        len(corners),
        np.array(points),
        np.array(elements),
        np.array(BODIES[problem]),
        np.array(faces),
        np.array(names),
        np.repeat([0, 1], dim + 1),
    )


def WithMidNodes(cell, edges, numbers, points):
    """Append the mid nodes of a cell; new ones go to `numbers` and `points`."""
    mids = []
    for a, b in edges:
        key = tuple(sorted((cell[a], cell[b])))
        if key not in numbers:
            numbers[key] = len(points)
            points.append((points[key[0]] + points[key[1]]) / 2)
        mids.append(numbers[key])
    return [*cell, *mids]
