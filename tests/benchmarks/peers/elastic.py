"""The problems of the comparison in NGSolve, for ngslac and for NGSolve's own contact."""

from __future__ import annotations

from pathlib import Path

import ngsolve
from meshes import HELD, NodalValues
from metrics import (
    LINE_FORCE,
    NU,
    PATCH_PRESSURE,
    SPHERE_LOAD,
    YOUNG,
    LineErrors,
    PatchErrors,
    SphereErrors,
)
from ngsolve import (
    BilinearForm,
    BitArray,
    GridFunction,
    Id,
    LinearForm,
    Mesh,
    NodeId,
    Trace,
    VectorH1,
    ds,
)

__all__ = ["Displacements", "Errors", "LoadVector", "Material", "Projection", "Read", "Stress"]


def Read(arguments):
    """The NGSolve mesh beside the .npz file, curved as the nodes of that are."""
    file = Path(arguments.mesh).with_suffix(".vol")
    mesh = Mesh(str(file))
    mesh.Curve(arguments.order)
    return mesh


def Displacements(mesh, arguments, *, space=VectorH1, **options):
    """The displacement space with the supports of the problem; `options` of another `space`."""
    held = {}
    for name, component in HELD[arguments.problem].items():
        held.setdefault(f"dirichlet{'xyz'[component]}", []).append(name)
    options |= {name: "|".join(boundaries) for name, boundaries in held.items()}
    return space(mesh, order=arguments.order, **options)


def Material(young):
    """Lame's constants."""
    return young * NU / ((1 + NU) * (1 - 2 * NU)), young / (2 * (1 + NU))


def Stress(strain, young, dim):
    """Linear elasticity, plane strain in 2D."""
    lame, shear = Material(young)
    return 2 * shear * strain + lame * Trace(strain) * Id(dim)


def Young(mesh):
    """Young's modulus of each body."""
    return mesh.MaterialCF({name: YOUNG[name] for name in mesh.GetMaterials()})


def LoadVector(peermesh, space, *, displacement=None):
    """The whole load as a vector on `space`, or on a product space whose first component is it.

    Parameters
    ----------
    peermesh : PeerMesh
    space : FESpace
    displacement : FESpace, optional
        The displacement space, if `space` is a product.
    """
    v = space.TestFunction()
    v = v if displacement is None else v[0]
    form = LinearForm(space)
    if peermesh.problem == "hertz":
        vector = form.Assemble().vec
        node = NodeId(ngsolve.VERTEX, peermesh.load)
        _, vertical = (displacement or space).GetDofNrs(node)
        vector[vertical] = -LINE_FORCE / 2
        return vector
    form += -(SPHERE_LOAD if peermesh.problem == "sphere" else PATCH_PRESSURE) * v[2] * ds("top")
    return form.Assemble().vec


# ---------------------------------------------------------------- evaluation


def Projection(mesh, rhs, space):
    """Function on the slave side whose moments are given: the L2 projection.

    Parameters
    ----------
    mesh : ngsolve.Mesh
    rhs : (n,) array
        Moments with the basis functions of `space`.
    space : FESpace
        H1 or SurfaceL2.

    Returns
    -------
    GridFunction
    """
    p, q = space.TnT()
    mass = BilinearForm(space)
    mass += p.Trace() * q.Trace() * ds("slave")
    mass.Assemble()
    used = BitArray(space.ndof)
    used.Clear()
    for element in mesh.Boundaries("slave").Elements():
        for dof in space.GetDofNrs(element):
            used[dof] = True
    vector, result = mass.mat.CreateColVector(), GridFunction(space)
    vector.FV().NumPy()[:] = rhs
    result.vec.data = mass.mat.Inverse(used, inverse="sparsecholesky") * vector
    return result


def CornerProjection(mesh, rhs):
    """The same on continuous functions that are linear on the faces; values at all corners."""
    return Projection(mesh, rhs, ngsolve.H1(mesh, order=1)).vec.FV().NumPy().copy()


def Errors(peermesh, mesh, displacement, pressure):
    """The figures of `metrics` for this problem.

    Parameters
    ----------
    peermesh : PeerMesh
    mesh : ngsolve.Mesh
    displacement : GridFunction
    pressure : callable
        Called on demand: samples (x, p) of the pressure along the slave edge in 2D, values at all
        corners of the mesh in 3D.
    """
    if peermesh.problem == "hertz":
        return LineErrors(*pressure())
    if peermesh.problem == "sphere":
        return SphereErrors(peermesh.points, peermesh.Faces(1, "slave"), pressure())
    values = NodalValues(mesh, [displacement[i] for i in range(mesh.dim)])
    order = displacement.space.globalorder
    return PatchErrors(peermesh, values[: None if order > 1 else peermesh.nvertices])
