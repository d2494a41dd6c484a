# SPDX-License-Identifier: LGPL-2.1-or-later
"""The way of solving linear systems that suits a problem."""

from ngslac.arguments import CheckChoice, CheckFunction
from ngslac.linear.inner import InnerDofs
from ngslac.linear.solver import LinearSolver
from ngslac.linear.twolevel import Multigrid
from ngslac.linear.vertices import VertexNodes

__all__ = ["SOLVERS", "ChooseSolver"]

SOLVERS = "interface", "direct", "iterative", "saddle", "petsc"
# From this many free displacements on an iterative solution is the faster one: 2D and 3D.
LARGE = {2: 25_000, 3: 5_000}
# Up to this many the factors of the bulk alone are cheaper than iterations for each system.
FACTORED = {2: 10_000_000, 3: 25_000}


def ChooseSolver(a, contacts, freedofs, inverse, wanted, preconditioner=None, motions=None):
    """The LinearSolver for these forms and free scalar dofs: the one wanted, or the fastest.

    `motions` gives the rigid motions, see `Grounded`.
    """
    if preconditioner is not None:
        CheckFunction("preconditioner", preconditioner, "a function (mat, freedofs), or None")
        if wanted not in (None, "iterative"):
            raise ValueError(f"preconditioner= goes with solver='iterative', not {wanted!r}")
        wanted = "iterative"
    if wanted is not None:
        CheckChoice("solver", wanted, SOLVERS)
    dim, free = a.space.mesh.dim, freedofs.NumSet()
    form = contacts[0].form
    nodes = VertexNodes.Of(form.component, freedofs, form.offset * form.fes.dim)
    suits = nodes is not None and nodes.count > 0
    if wanted == "iterative" and not suits and not preconditioner:
        raise ValueError(
            f"solver='iterative' needs {dim} free displacements on the vertices of the mesh, which "
            "this space does not have: take solver='direct'"
        )
    reason = "as asked for"
    interface = wanted == "interface"
    if wanted is None:
        reason, interface = f"{free} free dofs in {dim}D", not inverse
    if wanted is None or interface:
        wanted = "iterative" if suits and free >= LARGE[dim] and not inverse else "direct"
    multigrid = Multigrid(nodes, 3 * nodes.count >= free, a.space) if suits else None
    given = freedofs, inverse, wanted, dim, multigrid, reason, preconditioner
    first = reason == "as asked for" or free <= FACTORED[dim]
    inner = None
    if wanted == "iterative" and not preconditioner:
        inner = InnerDofs.Of(form.fes, freedofs, form.offset, form.component)
    return LinearSolver(*given, motions if interface else None, first, inner)
