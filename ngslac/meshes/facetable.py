# SPDX-License-Identifier: LGPL-2.1-or-later
"""A table of the faces of a shape, such as of a STEP file, with data to distinguish them."""

from collections import defaultdict
from collections.abc import Sequence

import numpy as np
from netgen.occ import TopoDS_Shape

from ngslac.arguments import CheckInstance
from ngslac.table import Columns

__all__ = ["FaceTable"]

ROUNDING = 1e-12  # coordinates below this part of the largest are 0


def FaceTable(shape: TopoDS_Shape) -> Columns:
    """Names, sizes, places and bodies of the faces of a shape, in its own order.

    Parameters
    ----------
    shape : netgen.occ.TopoDS_Shape
        In 3D, such as ``OCCGeometry("assembly.step").shape``, or in 2D, where edges are faces.

    Returns
    -------
    dict
        ``number`` (n,) by which ``shape.faces[number]`` (2D: ``shape.edges[number]``) is the face,
        ``name`` (n,), ``body`` (n,) by which ``shape.solids[body]`` (2D: ``shape.faces[body]``) has
        the face, -1 for none, ``material`` (n,) the name of that body, ``area`` (n,) or length,
        ``center`` (n, 3) of mass. It prints as a table. A face between two glued bodies has two
        rows, one for each.

    Raises
    ------
    TypeError
        `shape` is none.

    Examples
    --------
    >>> from netgen.occ import Box, Compound
    >>> from ngslac.meshes import FaceTable
    >>> lower, upper = Box((0, 0, 0), (2, 1, 1)), Box((0, 0, 1), (1, 1, 2))
    >>> lower.name, upper.name = "steel", "rubber"
    >>> lower.faces[0].name = "left"
    >>> shape = Compound([lower, upper])
    >>> table = FaceTable(shape)
    >>> print(table)
    number  name  body  material  area  center
         0  left     0     steel     1       0  0.5  0.5
         1           0     steel     1       2  0.5  0.5
         2           0     steel     2       1    0  0.5
         3           0     steel     2       1    1  0.5
         4           0     steel     2       1  0.5    0
         5           0     steel     2       1  0.5    1
         6           1    rubber     1       0  0.5  1.5
         7           1    rubber     1       1  0.5  1.5
         8           1    rubber     1     0.5    0  1.5
         9           1    rubber     1     0.5    1  1.5
        10           1    rubber     1     0.5  0.5    1
        11           1    rubber     1     0.5  0.5    2
    >>> lowest = table["center"][:, 2].argmin()
    >>> shape.faces[int(lowest)].name = "bottom"
    """
    CheckInstance("shape", shape, TopoDS_Shape, "a shape of netgen.occ")
    solid = len(shape.solids) > 0
    faces = list(shape.faces if solid else shape.edges)
    bodies = list(shape.solids if solid else shape.faces)
    body = _Bodies(faces, [list(b.faces if solid else b.edges) for b in bodies])
    names = np.array([*(b.name or "" for b in bodies), ""], dtype=str)
    center = np.array([[*face.center] for face in faces]).reshape(-1, 3)
    center[np.abs(center) < ROUNDING * np.abs(center).max(initial=0)] = 0
    return Columns(
        number=np.arange(len(faces)),
        name=np.array([face.name or "" for face in faces], dtype=str),
        body=body,
        material=names[body],
        area=np.array([face.mass for face in faces]),
        center=center,
    )


def _Bodies(
    faces: Sequence[TopoDS_Shape], of_bodies: Sequence[Sequence[TopoDS_Shape]]
) -> np.ndarray:
    """The body of each of the `faces`; one that occurs twice belongs to a body each time."""
    owners = defaultdict(list)
    for number, own in enumerate(of_bodies):
        for face in own:
            owners[face].append(number)
    return np.array([owners[face].pop(0) if owners[face] else -1 for face in faces], dtype=int)
