"""The way of solving linear systems that suits a problem."""

from ngslac.arguments import CheckChoice, CheckFunction
from ngslac.linear.twolevel import Multigrid
from ngslac.linear.solver import LinearSolver
from ngslac.linear.vertices import VertexNodes

__all__ = ["ChooseSolver"]

# From this many free displacements on an iterative solution is the faster one: 2D and 3D.
LARGE = {2: 25_000, 3: 5_000}


def ChooseSolver(a, contacts, freedofs, inverse, wanted, preconditioner=None):
    """The LinearSolver for these forms and free scalar dofs: the one wanted, or the fastest."""
    if preconditioner is not None:
        CheckFunction("preconditioner", preconditioner, "a function (mat, freedofs), or None")
        if wanted not in (None, "iterative"):
            raise ValueError(f"preconditioner= goes with solver='iterative', not {wanted!r}")
        wanted = "iterative"
    if wanted is not None:
        CheckChoice("solver", wanted, ("direct", "iterative", "saddle"))
    dim, free = a.space.mesh.dim, freedofs.NumSet()
    nodes = VertexNodes.Of(contacts[0].form, freedofs)
    suits = nodes is not None and nodes.count > 0
    if wanted == "iterative" and not suits and not preconditioner:
        raise ValueError(
            f"solver='iterative' needs {dim} free displacements on the vertices of the mesh, which "
            "this space does not have: take solver='direct'"
        )
    reason = "as asked for"
    if wanted is None:
        small_sliding = not any(contact.finite for contact in contacts)
        reason = f"{free} free dofs in {dim}D"
        iterates = suits and free >= LARGE[dim] and not inverse
        wanted = "iterative" if iterates and small_sliding and not a.condense else "direct"
    multigrid = Multigrid(nodes, 3 * nodes.count >= free, a.space) if suits else None
    given = freedofs, inverse, wanted, dim, multigrid, reason, preconditioner
    return LinearSolver(*given)
