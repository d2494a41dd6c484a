"""The problems of the comparison in NGSolve, for ngslac and for NGSolve's own contact."""

from __future__ import annotations

from pathlib import Path

import metrics
import ngsolve as ngs
from meshes import HELD, NodalValues
from metrics import LINE_FORCE, NU, PRESSURE, YOUNG
from ngsolve import BilinearForm, GridFunction, ds, dx

from ngslac.materials import Stress

__all__ = ["CornerProjection", "Displacements", "Elastic", "Errors", "Loads", "Projection", "Read"]


def Read(arguments):
    """The NGSolve mesh beside the .npz file, curved as the nodes of that are."""
    mesh = ngs.Mesh(str(Path(arguments.mesh).with_suffix(".vol")))
    mesh.Curve(arguments.order)
    return mesh


def Displacements(mesh, arguments, *, space=ngs.VectorH1, **options):
    """The displacement space with the supports of the problem; `options` of another `space`."""
    held = {}
    for name, component in HELD[arguments.problem].items():
        held.setdefault(f"dirichlet{'xyz'[component]}", []).append(name)
    options |= {name: "|".join(boundaries) for name, boundaries in held.items()}
    return space(mesh, order=arguments.order, **options)


def Elastic(mesh, u, v):
    """Linear elasticity of both bodies, plane strain in 2D."""
    young = mesh.MaterialCF({name: YOUNG[name] for name in mesh.GetMaterials()})
    strain, virtual = (ngs.Sym(ngs.Grad(w)) for w in (u, v))
    return ngs.InnerProduct(Stress(strain, young, NU), virtual) * dx


def Loads(peermesh, space, displacement=None):
    """The whole load as a vector on the displacement space, or on a product that begins with it."""
    v = space.TestFunction() if displacement is None else space.TestFunction()[0]
    form = ngs.LinearForm(space)
    if peermesh.problem != "hertz":
        form += -PRESSURE[peermesh.problem] * v[2] * ds("top")
        return form.Assemble().vec
    vector, node = form.Assemble().vec, ngs.NodeId(ngs.VERTEX, peermesh.load)
    _, vertical = (displacement or space).GetDofNrs(node)
    vector[vertical] = -LINE_FORCE / 2
    return vector


# ---------------------------------------------------------------- evaluation


def Projection(mesh, rhs, space):
    """L2 projection to the slave side: function of H1 or SurfaceL2 with given moments (n,)."""
    p, q = space.TnT()
    mass = BilinearForm(space)
    mass += p.Trace() * q.Trace() * ds("slave")
    mass.Assemble()
    used = ngs.BitArray(space.ndof)
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
    return Projection(mesh, rhs, ngs.H1(mesh, order=1)).vec.FV().NumPy().copy()


def Errors(peermesh, mesh, displacement, pressure):
    """The figures of `metrics` from the displacement (a GridFunction).

    `pressure` is called on demand: samples (x, p) of the pressure along the slave edge in 2D,
    values at all corners of the mesh in 3D.
    """

    def Values():
        values = NodalValues(mesh, [displacement[i] for i in range(mesh.dim)])
        return values[: None if displacement.space.globalorder > 1 else peermesh.nvertices]

    if peermesh.problem == "hertz":
        return metrics.LineErrors(*pressure())
    return metrics.Errors(peermesh, 1, Values, pressure)
