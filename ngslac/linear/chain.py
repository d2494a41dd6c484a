# SPDX-License-Identifier: LGPL-2.1-or-later
"""The methods for linear systems that suit a problem, in order."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from ngslac.arguments import CheckChoice, CheckFunction
from ngslac.errors import Warn
from ngslac.linear.direct import Direct
from ngslac.linear.inner import InnerDofs
from ngslac.linear.interface import Interface
from ngslac.linear.iterative import Iterative
from ngslac.linear.multigrid import Multigrid
from ngslac.linear.solver import LinearSolver
from ngslac.linear.system import Link, Options
from ngslac.linear.vertices import VertexNodes

if TYPE_CHECKING:
    from ngsolve import BilinearForm, BitArray

    from ngslac.contact.contact import LACContact

__all__ = ["METHODS", "CheckSolver", "IsLarge", "MakeLinearSolver"]

# From this many free displacements on an iterative solution is the faster one: 2D and 3D.
LARGE = {
    "ngsolve": {2: 25_000, 3: 5_000},
    "petsc": {2: 100_000, 3: 30_000},
}
# Up to this many the factors of the bulk alone are cheaper than iterations for each system.
FACTORED = {2: 10_000_000, 3: 25_000}


def IsLarge(free: int, dim: int, backend: str = "ngsolve") -> bool:
    """Are iterations faster than factors with so many free dofs?"""
    return free >= LARGE[backend][dim]


def CheckSolver(name: str | None) -> str | None:
    """Check the name of a solver, or None; the name of a former solver stands for "direct"."""
    if name == "saddle":
        Warn(
            "solver='saddle' is what solver='direct' does: write that instead; the name goes in "
            "release 0.3",
            DeprecationWarning,
        )
        return "direct"
    return name if name is None else CheckChoice("solver", name, (*METHODS, "petsc"))


@dataclass
class Parts:
    """The parts of which the methods of a chain are made."""

    components: int  # of each multiplier
    options: Options
    motions: Callable  # returns the rigid motions (n, k) of all bodies
    multigrid: Multigrid | None  # where iterations are of use


# The methods that users choose by name. One that no chain begins with has to be asked for.
METHODS = {
    "interface": lambda parts: Interface(parts.components, parts.motions),
    "direct": lambda parts: Direct(parts.options.inverse),
    "iterative": lambda parts: Iterative(
        parts.components, parts.multigrid, parts.options.preconditioner
    ),
}


def MakeLinearSolver(
    a: BilinearForm,
    contacts: Sequence[LACContact],
    freedofs: BitArray,
    options: Options,
    motions: Callable[[], np.ndarray],
) -> LinearSolver:
    """The LinearSolver for these forms and free scalar dofs: the requested one, or the fastest."""
    wanted, inverse, preconditioner = options.solver, options.inverse, options.preconditioner
    if preconditioner is not None:
        CheckFunction("preconditioner", preconditioner, "a function (mat, freedofs), or None")
        if wanted not in (None, "iterative"):
            raise ValueError(f"preconditioner= goes with solver='iterative', not {wanted!r}")
        wanted = "iterative"
    dim, free = a.space.mesh.dim, freedofs.NumSet()
    form = contacts[0].form
    nodes = VertexNodes.Of(form.component, freedofs, form.offset * form.fes.dim)
    suits = nodes is not None and nodes.count > 0
    if wanted == "iterative" and not suits and not preconditioner:
        raise ValueError(
            f"solver='iterative' needs {dim} free displacements on the vertices of the mesh, which "
            "this space does not have: take solver='direct'"
        )
    names = _Names(wanted, inverse, suits and IsLarge(free, dim), free <= FACTORED[dim])
    why = f"{free} free dofs in {dim}D" if wanted is None else "as asked for"
    multigrid = inner = None
    if "iterative" in names:
        multigrid = Multigrid(nodes, 3 * nodes.count >= free, a.space) if suits else None
        if not preconditioner:
            inner = InnerDofs.Of(form.fes, freedofs, form.offset, form.component)

    parts = Parts(contacts[0].components, options, motions, multigrid)
    links = [Link(name, METHODS[name](parts), why) for name in names]
    return LinearSolver(freedofs, links, inner)


def _Names(wanted: str | None, inverse: str | None, iterates: bool, factors: bool) -> list[str]:
    """Of the methods of a chain, which ends with the safe one."""
    if wanted not in (None, "interface"):
        return list(dict.fromkeys((wanted, "direct")))
    if wanted is None and inverse:
        return ["direct"]
    names = ["iterative"] if iterates and not inverse else []
    names.insert(0 if wanted or factors else len(names), "interface")
    return [*names, "direct"]
