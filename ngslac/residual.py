"""The residual of bulk plus contact, and how large it is."""

from dataclasses import dataclass, field

import numpy as np
from ngsolve import LinearForm

from ngslac.errors import ContactConvergenceError

__all__ = ["Residual", "State"]


@dataclass
class State:
    """Residual of bulk and loads, its sizes and the contact status, at one iterate."""

    bulk: np.ndarray = field(repr=False)
    equilibrium: float
    constraint: float
    status: np.ndarray = field(repr=False)

    @property
    def merit(self):
        return float(np.hypot(self.equilibrium, self.constraint))


class Residual:
    """Measures both kinds of rows, scaled and relative to the forces at work.

    Parameters
    ----------
    a, gf, contacts, rhs :
        As in ContactSolver.
    free : (n,) bool
        Scalar dofs whose rows count: all free ones, also those that are condensed.
    """

    def __init__(self, a, gf, contacts, rhs, free):
        self.a, self.gf, self.contacts, self.rhs, self.free = a, gf, contacts, rhs, free
        self.converged = 0.0  # largest forces of a converged state

    def Begin(self, scale, tol):
        """Start a solve with these factors and tolerance; returns the first State."""
        self.rows = np.zeros(len(scale), dtype=bool)
        for contact in self.contacts:
            dofs = contact.form.MultiplierDofs()
            if np.any(self.rows[dofs]):
                raise ValueError("two contacts share one lam: give each a LACSpace of its own")
            self.rows[dofs] = True
        self.reference, self.tol = self.converged, tol
        state = self.Measure(scale)
        # A body that moves without touching feels nothing but the jump of its Dirichlet values.
        self.reference = max(self.converged, 1e-3 * self.forces)
        return state

    def Accept(self):
        """The state measured last has converged."""
        self.converged = max(self.forces, self.converged)

    def Measure(self, scale):
        """The State of gf; raises ContactConvergenceError if it holds NaN."""
        vec = self.gf.vec
        residual, contact_residual = vec.CreateVector(), vec.CreateVector()
        self.a.Apply(vec, residual)
        contact_residual[:] = 0
        for contact in self.contacts:
            contact.AddApply(vec, contact_residual)
            contact.Evaluate(self.gf)
        bulk, contact_forces = residual.FV().NumPy(), contact_residual.FV().NumPy()
        load = LoadVector(self.rhs, vec)
        # Forces at work: reactions, contact forces and loads all count.
        self.forces = max(
            float(np.linalg.norm((scale * f)[~self.rows])) for f in (bulk, contact_forces, load)
        )
        bulk = bulk - load
        scaled = scale * (bulk + contact_forces) * self.free
        if not np.all(np.isfinite(scaled)):
            raise ContactConvergenceError("the residual holds NaN or infinite values")
        # No residual gets below the rounding errors of the stiffness times the displacement.
        rounding = 1e-14 * float(np.linalg.norm((vec.FV().NumPy() / scale)[~self.rows]))
        reference = max(self.forces, self.reference, rounding / self.tol)
        equilibrium = float(np.linalg.norm(scaled[~self.rows]))
        constraint = float(np.linalg.norm(scaled[self.rows]))
        reference = reference or max(equilibrium, constraint) or 1.0
        status = np.concatenate([contact.Table()["status"] for contact in self.contacts])
        return State(bulk, equilibrium / reference, constraint / reference, status)


def LoadVector(rhs, vec):
    """The load as numpy array: from nothing, a vector, a LinearForm or a callable."""
    if rhs is None:
        return np.zeros(vec.FV().NumPy().size)
    isform = isinstance(rhs, LinearForm)  # which is callable, too
    load = rhs() if callable(rhs) and not isform else rhs
    if hasattr(load, "Evaluate"):  # an expression such as 2 * vector
        load = load.Evaluate()
    load = getattr(load, "vec", load)
    if load.size != vec.size:
        raise ValueError(f"rhs has {load.size} entries, the product space {vec.size}")
    return load.FV().NumPy().copy()
