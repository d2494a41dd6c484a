"""Bodies from plane meshes of triangles: sectors of bodies of revolution, and slices.

A triangle becomes a prism. In a sector, a triangle with one vertex on the axis becomes a pyramid,
and one with two a tetrahedron. Faces are flat: the whole body has a regular polygon for
each circle.
"""

import numpy as np
from netgen.meshing import Mesh as NetgenMesh
from ngsolve import BND, Mesh

from ngslac.meshes.boxes import Cells

__all__ = ["SectorMesh", "SliceMesh"]


def SectorMesh(plane, angle):
    """The sector 0 <= theta <= angle (radians) of the body whose half section (r, z) is `plane`.

    Materials and boundaries of `plane` keep their names; boundaries on the axis vanish. "front"
    (y = 0) and "oblique" (theta = angle) are new.
    """

    def Ends(r, z):
        return (np.column_stack([r * np.cos(t), r * np.sin(t), z]) for t in (0.0, angle))

    return _Swept(plane, Ends, "oblique")


def SliceMesh(plane, thickness):
    """The slice 0 <= y <= thickness over the (x, z) plane; "front" and "back" are its sides."""

    def Ends(x, z):
        return (np.column_stack([x, np.full_like(x, y), z]) for y in (0.0, thickness))

    return _Swept(plane, Ends, "back")


def _Swept(plane, Ends, back):
    mesh = NetgenMesh(dim=3)
    for name in dict.fromkeys(plane.GetMaterials()):
        _Body(plane, plane.Materials(name), Ends, back).AddTo(mesh, name)
    mesh.Compress()
    return Mesh(mesh)


def _Body(plane, body, Ends, back):
    """The cells between both positions of the triangles; a vertex on the axis is one point."""
    triangles = [[v.nr for v in el.vertices] for el in body.Elements()]
    numbers = sorted({nr for t in triangles for nr in t})
    at = np.array([plane.vertices[nr].point for nr in numbers])
    local = {nr: i for i, nr in enumerate(numbers)}
    first, second = Ends(*at.T)
    axis = np.linalg.norm(second - first, axis=1) < 1e-9 * np.ptp(at)
    moved = np.where(axis, np.arange(len(at)), len(at) + np.cumsum(~axis) - 1)
    points = np.concatenate([first, second[~axis]])
    cells, faces, directed = [], [], set()
    for triangle in triangles:
        a = _Counterclockwise([local[nr] for nr in triangle], at)
        cells.append(_Cell(a, moved, axis))
        directed |= {(a[k - 1], a[k]) for k in range(3)}
        # Seen from outside; the outer normal of the section at y = 0 is -y.
        faces.append(("front", tuple(a)))
        faces.append((back, tuple(int(moved[i]) for i in reversed(a))))
    for el in plane.Elements(BND):
        ends = [local.get(v.nr, -1) for v in el.vertices]
        if tuple(ends) in directed:
            ends.reverse()
        i, j = ends
        if (j, i) in directed and not (axis[i] and axis[j]):
            face = [i, j, int(moved[j]), int(moved[i])]
            faces.append((el.mat, tuple(dict.fromkeys(face))))
    return Cells(points, cells, faces)


def _Counterclockwise(triangle, at):
    a, b, c = at[triangle]
    if np.linalg.det([b - a, c - a]) < 0:
        triangle[1], triangle[2] = triangle[2], triangle[1]
    return triangle


def _Cell(a, moved, axis):
    """Vertex numbers of the swept triangle, oriented as in `Cells` (first face from inside)."""
    on = [bool(axis[nr]) for nr in a]
    first = on.index(sum(on) == 1) if any(on) else 0  # the vertex that is unlike the others
    i, j, k = a[first:] + a[:first]
    p, q, r = (int(moved[nr]) for nr in (i, j, k))
    if not any(on):  # (r, z) is counter-clockwise seen from -y, and y grows away from there
        return (i, j, k, p, q, r)
    return (j, q, r, k, i) if sum(on) == 1 else (i, j, k, p)
