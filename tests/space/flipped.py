"""Meshes whose boundary elements run in mixed directions, as those of many mesh generators do."""

from netgen import meshing
from ngsolve import BND, VOL, Mesh


def Flipped(mesh, every=2):
    """The same first-order mesh; each `every`-th boundary element has its vertices reversed.

    0: none. Elements and vertices keep their numbers.
    """
    copy = meshing.Mesh(dim=mesh.dim)
    points = [copy.Add(meshing.MeshPoint(p.p)) for p in mesh.ngmesh.Points()]
    element = meshing.Element2D if mesh.dim == 2 else meshing.Element3D
    _AddBoundaries(mesh, copy)
    for el in mesh.Elements(VOL):
        copy.Add(element(el.index + 1, [points[v.nr] for v in el.vertices]))
    for el in mesh.Elements(BND):
        corners = [points[v.nr] for v in el.vertices]
        if every and el.nr % every == 1:
            corners = corners[::-1]
        if mesh.dim == 2:
            copy.Add(meshing.Element1D(corners, index=el.index + 1))
        else:
            copy.Add(meshing.Element2D(el.index + 1, corners))
    return Mesh(copy)


def _AddBoundaries(mesh, copy):
    for i, name in enumerate(mesh.GetMaterials()):
        copy.SetMaterial(i + 1, name)
    for i, name in enumerate(mesh.GetBoundaries()):
        if mesh.dim == 3:
            copy.Add(meshing.FaceDescriptor(surfnr=i + 1, domin=1, domout=0, bc=i + 1))
        copy.SetBCName(i, name)
