"""The way of solving linear systems that suits a problem."""

from ngslac._ngslac import VertexDofs
from ngslac.arguments import CheckChoice, CheckFunction
from ngslac.arrays import ScalarDofs
from ngslac.linear.solver import LinearSolver

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
    space = a.space
    coarse = ScalarDofs(VertexDofs(space), space) & freedofs
    free, vertices = freedofs.NumSet(), coarse.NumSet()
    suits = 0 < vertices < free / 3  # else the coarse problem is nearly the whole one
    if wanted == "iterative" and not suits and not preconditioner:
        raise ValueError(
            f"solver='iterative' corrects on the {vertices} dofs of the vertices, which must be "
            f"less than a third of the {free} free ones: take a displacement of order 2 or higher"
        )
    reason = "as asked for"
    if wanted is None:
        large = free >= LARGE[space.mesh.dim]
        small_sliding = not any(contact.finite for contact in contacts)
        reason = f"{free} free dofs in {space.mesh.dim}D"
        iterates = suits and large and not inverse
        wanted = "iterative" if iterates and small_sliding and not a.condense else "direct"
    given = freedofs, inverse, wanted, space.mesh.dim, coarse, reason, preconditioner
    return LinearSolver(*given)
