# SPDX-License-Identifier: LGPL-2.1-or-later
"""What goes with the load: Dirichlet values that change with it, and a load that stays."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from numbers import Real
from typing import TYPE_CHECKING

import numpy as np
from ngsolve import CoefficientFunction, FESpace, GridFunction, Region

from ngslac._ngslac import RegionWithFaces
from ngslac.arguments import CheckFunction, CheckValues, Shown, Wrong
from ngslac.arrays import AsBits, AsNumPy, ComponentsOf, ScalarDofs
from ngslac.parallel.layout import LayoutOf

if TYPE_CHECKING:
    from ngslac.solve.solver import ContactSolver

__all__ = ["Prescribed"]

WANTED = (
    "a displacement for each region, {'top': CF((0, -load))}, or a function of the solution, or "
    "None"
)


class Prescribed:
    """Sets Dirichlet values for the current load."""

    def __init__(
        self,
        solver: ContactSolver,
        values: dict[str | Region, CoefficientFunction] | Callable[[GridFunction], object] | None,
    ):
        self.values, self.gf, self.dofs = values, solver.gf, {}
        if not isinstance(values, Mapping):
            CheckFunction("prescribe", values, WANTED)
            return
        form = solver.contacts[0].form
        space, block = form.component, form.fes.dim
        self.first = form.offset * block
        self.field = GridFunction(space)
        count = solver.contacts[0].components
        self.values = {key: Displacement(key, values[key], count) for key in values}
        for key in values:
            region = RegionWithFaces(space.mesh, "prescribe: region", key, any=True)
            dofs = ConstrainedOn(space, region)
            if not np.any(dofs):
                raise ValueError(
                    f"prescribe: no displacement is constrained on {key!r}; give the space "
                    "dirichlet=..., dirichletx=... for it"
                )
            self.dofs[key] = region, np.flatnonzero(dofs)

    def __bool__(self) -> bool:
        return bool(self.values)

    def Set(self) -> None:
        """Put the values for the current load into the solution."""
        if callable(self.values):
            LayoutOf(self.gf.space).together.ByUser(self.values, self.gf)
            return
        vec, layout = LayoutOf(self.gf.space).Values(self.gf.vec), LayoutOf(self.field.space)
        for key, (region, dofs) in self.dofs.items():
            self.field.Set(self.values[key], definedon=region)
            field = layout.Values(self.field.vec)
            if not np.all(np.isfinite(field[dofs])):
                raise ValueError(
                    f"prescribe: the value of {key!r} is NaN or infinite somewhere there"
                )
            vec[self.first + dofs] = field[dofs]


def ConstrainedOn(space: FESpace, region: Region) -> np.ndarray:
    """The scalar dofs (n,) bool of a region in the components that are constrained on it.

    A vertex may belong to another boundary, too, where more components are. Where no component is
    on a whole boundary, whatever is constrained there.
    """
    layout = LayoutOf(space)
    fixed = layout.Of(~AsNumPy(ScalarDofs(space.FreeDofs(), space)))
    found = np.zeros_like(fixed)
    for number in np.flatnonzero(AsNumPy(region.Mask())):
        one = Region(space.mesh, region.VB(), AsBits(np.arange(len(region.Mask())) == number))
        there = layout.Everywhere(AsNumPy(ScalarDofs(space.GetDofs(one), space)))
        for part in _Components(space):
            own = np.zeros_like(there)
            own[part] = there[part]
            if np.all(fixed[own]):
                found |= own
    if np.any(found):
        return found
    return fixed & layout.Everywhere(AsNumPy(ScalarDofs(space.GetDofs(region), space)))


def _Components(space: FESpace) -> list[slice]:
    """Slices of the dofs of each component of a space; of one without components, all."""
    ranges = [space.Range(k) for k in range(len(ComponentsOf(space)))]
    return [slice(one.start, one.stop) for one in ranges] or [slice(None)]


def Displacement(
    key: Region | str, value: CoefficientFunction | float | Sequence, dim: int
) -> CoefficientFunction:
    """The value of a region as a real function with `dim` components."""
    wanted = "a number" if dim == 1 else f"a displacement with {dim} components, CF({(0,) * dim})"
    parts = value if isinstance(value, (tuple, list)) else (value,)
    if not parts or not all(isinstance(part, (Real, CoefficientFunction)) for part in parts):
        raise Wrong(TypeError, f"prescribe: the value of {key!r}", value, wanted)
    function = CoefficientFunction(value)
    if function.dim != dim:
        raise ValueError(
            f"prescribe: the value of {key!r} has {function.dim} components, u has {dim}"
        )
    if function.is_complex:
        raise ValueError(f"prescribe: the value of {key!r}, {Shown(value)}, is complex")
    return CheckValues(f"prescribe: the value of {key!r}", function)
