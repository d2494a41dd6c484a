# SPDX-License-Identifier: LGPL-2.1-or-later
"""Faces of a shape, such as of a STEP file, with what tells one from the other."""

import numpy as np
from netgen.occ import TopoDS_Shape

from ngslac.arguments import CheckInstance
from ngslac.table import Columns

__all__ = ["FaceTable"]


def FaceTable(shape) -> Columns:
    """Names, sizes and places of the faces of a shape, in its own order, to name them by.

    Parameters
    ----------
    shape : netgen.occ.TopoDS_Shape
        In 3D, such as ``OCCGeometry("assembly.step").shape``, or in 2D, where edges are faces.

    Returns
    -------
    dict
        ``number`` (n,) by which ``shape.faces[number]`` (2D: ``shape.edges[number]``) is the face,
        ``name`` (n,), ``area`` (n,) or length, ``center`` (n, 3) of mass. It prints as a table.

    Raises
    ------
    TypeError
        `shape` is none.

    Examples
    --------
    >>> from netgen.occ import Box
    >>> from ngslac.meshes import FaceTable
    >>> body = Box((0, 0, 0), (2, 1, 1))
    >>> body.faces[0].name = "left"
    >>> table = FaceTable(body)
    >>> print(table)
    number  name  area  center
         0  left     1       0  0.5  0.5
         1           1       2  0.5  0.5
         2           2       1    0  0.5
         3           2       1    1  0.5
         4           2       1  0.5    0
         5           2       1  0.5    1
    >>> body.faces[int(table["area"].argmax())].name = "large"
    """
    CheckInstance("shape", shape, TopoDS_Shape, "a shape of netgen.occ")
    faces = list(shape.faces if len(shape.solids) else shape.edges)
    return Columns(
        number=np.arange(len(faces)),
        name=np.array([face.name or "" for face in faces], dtype=str),
        area=np.array([face.mass for face in faces]),
        center=np.array([[*face.center] for face in faces]).reshape(-1, 3),
    )
