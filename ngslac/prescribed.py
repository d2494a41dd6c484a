"""Dirichlet values that change with the load."""

import numpy as np
from ngsolve import CoefficientFunction, GridFunction, Region

from ngslac.arrays import AsNumPy, ScalarDofs

__all__ = ["Prescribed"]


class Prescribed:
    """Sets Dirichlet values for the current load.

    Parameters
    ----------
    solver : ContactSolver
    values : callable or dict
        ``values(gf)`` sets them, or a displacement for each region: {region: CoefficientFunction}.

    Raises
    ------
    TypeError
        Neither of the two.
    ValueError
        A region where no dof of the displacement is constrained, or a value that is no
        displacement.
    """

    def __init__(self, solver, values):
        self.values, self.gf = values, solver.gf
        if isinstance(values, CoefficientFunction) or not (
            callable(values) or hasattr(values, "keys")
        ):
            raise TypeError(
                "prescribe: give a displacement for each region, {'top': CF((0, -load))}, or a "
                "function of the solution"
            )
        if callable(values):
            return
        form = solver.contacts[0].form
        space, block = form.component, form.fes.dim
        self.first = form.offset * block
        self.field = GridFunction(space)
        fixed = ~AsNumPy(ScalarDofs(space.FreeDofs(), space))
        self.dofs = {}
        for key in values:
            region = key if isinstance(key, Region) else space.mesh.Boundaries(key)
            dofs = fixed & AsNumPy(ScalarDofs(space.GetDofs(region), space))
            if not np.any(dofs):
                raise ValueError(
                    f"prescribe: no displacement is constrained on {key!r}; give the space "
                    "dirichlet=..., dirichletx=... for it"
                )
            if (dim := CoefficientFunction(values[key]).dim) != space.mesh.dim:
                raise ValueError(
                    f"prescribe: the value of {key!r} has {dim} components, a displacement has "
                    f"{space.mesh.dim}"
                )
            self.dofs[key] = region, np.flatnonzero(dofs)

    def Set(self):
        """Put the values for the current load into the solution."""
        if callable(self.values):
            self.values(self.gf)
            return
        vec, field = self.gf.vec.FV().NumPy(), self.field.vec.FV().NumPy()
        for key, (region, dofs) in self.dofs.items():
            self.field.Set(CoefficientFunction(self.values[key]), definedon=region)
            vec[self.first + dofs] = field[dofs]
