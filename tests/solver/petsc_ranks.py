"""A Newton system of which each rank but the first has a part of the bulk: python -m mpi4py on it.

Prints a line of JSON with what came out, on rank 0.
"""

import json
import sys
from pathlib import Path

import numpy as np
from mpi4py import MPI
from ngsolve.la import SparseMatrixd

sys.path.append(str(Path(__file__).parents[1] / "problems"))

from press import mixed_press3d

from ngslac.arrays import ToCSR
from ngslac.errors import LinearSolveError
from ngslac.petsc.nodes import Nodes
from ngslac.petsc.system import PetscSystem

WORLD = MPI.COMM_WORLD


def last_system():
    """Of a Newton iteration that has converged: the same one on all ranks."""
    problem = mixed_press3d(n=(3, 2))
    solver = problem.solver(solver="direct")
    linear, seen = solver.linear, {}
    solve = linear.Solve

    def watched(system):
        x, scale = solve(system), system.scale.copy()
        seen.update(bulk=ToCSR(system.mat), mats=system.contacts, scale=scale, x=x.copy())
        seen["b"] = scale * system.rhs * linear.free
        return x

    linear.Solve = watched
    solver.Solve(printing=False)
    return seen | {
        "multipliers": problem.contact.form.MultiplierDofs(),
        "free": linear.free,
        "nodes": Nodes.Of(problem.contact, linear.freedofs),
    }


def part(bulk, nodes, number, count):
    """Some rows of a matrix, on the dofs that they need, and these."""
    own = nodes.blocks[np.arange(len(nodes.blocks)) * count // len(nodes.blocks) == number]
    rows = bulk.tocsr()[np.sort(own[own >= 0])].tocoo()
    row = np.sort(own[own >= 0])[rows.row]
    dofs = np.union1d(row, rows.col)
    where = np.searchsorted(dofs, row).tolist(), np.searchsorted(dofs, rows.col).tolist()
    size = len(dofs)
    return SparseMatrixd.CreateFromCOO(*where, rows.data.tolist(), size, size), dofs


def main():
    seen, zero = last_system(), WORLD.rank == 0
    comm = WORLD if WORLD.size > 1 else None
    workers = max(WORLD.size - 1, 1)
    number = WORLD.rank - (WORLD.size > 1)
    mat, dofs = part(seen["bulk"], seen["nodes"], number, workers) if number >= 0 else (None, [])

    def mine(*values):
        return values if zero else [None] * len(values)

    system = PetscSystem(comm, len(seen["x"]), dofs, *mine(seen["free"], seen["nodes"]))
    system.SetBulk(mat)
    system.SetContacts(*mine(seen["mats"], seen["multipliers"], seen["scale"]))
    found = {"ranks": WORLD.size}
    for method in ("direct", "iterative"):
        x, error = system.Solve(*mine(seen["b"], 1e-9, method))
        if zero:
            difference = np.linalg.norm(seen["scale"] * x - seen["x"]) / np.linalg.norm(seen["x"])
            found[method] = difference, error
    found["krylov"] = system.krylov
    parts = [*vars(system).values(), *vars(system.numbering).values()]
    longest = max((len(part) for part in parts if isinstance(part, np.ndarray)), default=0)
    found["longest"] = WORLD.gather((longest, len(dofs)))
    system.SetContacts(*mine([], np.zeros(0, dtype=int), seen["scale"]))
    try:
        system.Solve(*mine(seen["b"]))
        failed = False
    except LinearSolveError:
        failed = True
    found["singular fails"] = WORLD.allreduce(failed, MPI.LAND)
    if zero:
        print(json.dumps(found))


if __name__ == "__main__":
    main()
