"""Linear elastic solves that contact is measured against: direct ones, and iterative ones."""

from __future__ import annotations

import importlib.util

import numpy as np
from ngsolve import BitArray, Projector
from ngsolve.krylovspace import CGSolver
from scipy.sparse import csr_matrix, diags

from ngslac._ngslac import Condensation
from ngslac.arrays import AsNumPy, ScalarDofs
from ngslac.linear.factor import HasMKL, OneBLASThread
from ngslac.linear.inner import InnerDofs
from ngslac.linear.multigrid import Multigrid
from ngslac.linear.vertices import VertexNodes
from ngslac.rigid import MotionsAt

__all__ = ["DIRECT", "ITERATIVE", "FastDirect", "Fastest", "Iterative", "SolveForm"]

# Direct solvers and their flags. Unless told, Pardiso takes a matrix for unsymmetric that is not
# symmetric to the last bit, and refines each solution up to 16 times.
METIS = {"ordering": "metis", "refinement": 0}
DIRECT = {
    "pardiso": ("pardiso", METIS),
    "pardiso symmetric": ("pardiso", METIS | {"symmetric": True}),
    "pardiso spd": ("pardisospd", METIS | {"symmetric": True}),
    "sparsecholesky": ("sparsecholesky", {}),
    "umfpack": ("umfpack", {}),
}
# Relative residual that counts as a solution, and the most iterations.
EXACT, ACCURATE, ITERATIONS = 1e-9, 1e-8, 400


def Own(a, f):
    """Conjugate gradients with all that ngslac's iterative solver does."""
    space, dim = a.space, a.space.mesh.dim
    free = ScalarDofs(space.FreeDofs(), space)
    inner = InnerDofs.Of(space, free)
    elimination = inner and inner.Eliminate(a.mat)
    mat, left = (elimination.mat, free & ~inner.dofs) if inner else (a.mat, free)
    nodes = VertexNodes.Of(space, left)
    system = Condensation(mat, [], dim, left)
    multigrid = Multigrid(nodes, 3 * nodes.count >= free.NumSet(), space)
    inverse = multigrid.Preconditioner(system, np.ones(system.height))
    right, solution = f.vec.CreateVector(), f.vec.CreateVector()
    solution[:] = 0
    for _ in range(3):  # the iteration looks at another norm
        right.data = Projector(free, True) * (f.vec - a.mat * solution).Evaluate()
        wanted = ACCURATE * f.vec.Norm() / right.Norm()
        if wanted > 1:
            break
        forces = right.FV().NumPy().copy()
        if inner:
            right.FV().NumPy()[:] = elimination.Reduce(forces)
        krylov = CGSolver(mat=system, pre=inverse, tol=0.3 * wanted, maxiter=ITERATIONS)
        step = krylov.Solve(rhs=right).FV().NumPy()
        solution.FV().NumPy()[:] += elimination.Expand(forces, step) if inner else step
    return solution


def SmoothedAggregation(a, f):
    """Conjugate gradients with PyAMG's smoothed aggregation, which is told the rigid motions."""
    import pyamg

    mesh, order, fixed = a.space.mesh, *Blocks(a.space)
    d, n = mesh.dim, len(order)
    values, columns, starts = a.mat.CSR()
    mat = csr_matrix((np.asarray(values), np.asarray(columns), np.asarray(starts)), (n, n))
    keep = diags((~fixed).astype(float))
    mat = (keep @ mat @ keep + diags(fixed * mat.diagonal()))[order][:, order]
    points = np.array([v.point for v in mesh.vertices])
    motions = MotionsAt(points).reshape(n, -1) * ~fixed[order][:, None]
    levels = pyamg.smoothed_aggregation_solver(mat.tobsr((d, d)), B=motions)
    right = (f.vec.FV().NumPy() * ~fixed)[order]
    solution, given = f.vec.CreateVector(), {"accel": "cg", "maxiter": ITERATIONS}
    solution.FV().NumPy()[order] = levels.solve(right, tol=0.5 * ACCURATE, **given)
    return solution


def Blocks(space):
    """Dofs of a space of first order, those of each vertex together; which of all are fixed."""
    if space.ndof != space.mesh.nv * space.mesh.dim:
        raise ValueError("smoothed aggregation is for displacements of first order")
    order = np.arange(space.ndof).reshape(space.mesh.dim, -1).T.ravel()
    return order, ~AsNumPy(BitArray(space.FreeDofs()))


ITERATIVE = {"own": Own, "smoothed aggregation": SmoothedAggregation}


def FastDirect():
    """Names of the direct solvers that are the fast ones of this installation."""
    return [name for name in DIRECT if name == "sparsecholesky" or ("pard" in name and HasMKL())]


def Iterative(space):
    """Names of the iterative solvers that suit a displacement space."""
    linear = space.ndof == space.mesh.nv * space.mesh.dim
    aggregates = linear and importlib.util.find_spec("pyamg")
    return ["own", "smoothed aggregation"] if aggregates else ["own"]


def Fastest(figures, clock="wall"):
    """The name of those figures that took the least time."""
    return min(figures, key=lambda name: figures[name][clock])


def Remainder(a, f, solution):
    """What is left on the free dofs."""
    return (Projector(a.space.FreeDofs(), True) * (f.vec - a.mat * solution).Evaluate()).Evaluate()


def Refined(a, f, inverse):
    """Direct solution, improved once where thin bodies cost it digits."""
    solution = (inverse * f.vec).Evaluate()
    left = Remainder(a, f, solution)
    if left.Norm() > 0.1 * EXACT * f.vec.Norm():
        solution += (inverse * left).Evaluate()
    return solution


def SolveForm(a, f, variant, meter):
    """Assemble and solve once within a `Meter`; returns the dofs, and the figures.

    Raises
    ------
    RuntimeError
        The residual is not small.
    """
    solver, flags = DIRECT.get(variant, (variant, {}))
    with meter, OneBLASThread():
        a.Assemble()
        if variant in ITERATIVE:
            solution = ITERATIVE[variant](a, f)
        else:
            solution = Refined(a, f, a.mat.Inverse(a.space.FreeDofs(), inverse=solver, flags=flags))
    error = Remainder(a, f, solution).Norm() / Remainder(a, f, 0 * solution).Norm()
    if not error < (ACCURATE if variant in ITERATIVE else EXACT):
        raise RuntimeError(f"{variant} left a relative residual of {error:.1e}")
    return a.space.ndof, meter.Figures() | {"error": error}
