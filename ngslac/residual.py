"""The residual of bulk plus contact, and how large it is."""

from dataclasses import dataclass, field

import numpy as np
from netgen.meshing import NgException
from ngsolve import LinearForm

__all__ = ["Residual", "State"]


@dataclass
class State:
    """Residual of bulk and loads, its sizes and the contact status, at one iterate.

    Attributes
    ----------
    bulk : (n,)
        Residual of the bulk form minus `rhs`; None where there is none.
    equilibrium, constraint : float
        Norms of the scaled residuals of both kinds of rows, relative to the forces at work.
    merit : float
        Norm of both, not divided by the forces: what a line search compares. Infinite where the
        residual has no value, or the surfaces cannot be paired.
    unbalance : float
        The part of the equilibrium rows of the merit.
    status : (m,) int
        Of the macro-elements of all contacts: 0 open, 1 stick, 2 slip.
    covered : (m,)
        Share of their area that faces a master.
    reason : str
        Why there is no residual.
    """

    bulk: np.ndarray = field(repr=False)
    equilibrium: float
    constraint: float
    merit: float
    unbalance: float
    status: np.ndarray = field(repr=False)
    covered: np.ndarray = field(repr=False)
    reason: str = ""

    @property
    def finite(self):
        """Is there a residual?"""
        return np.isfinite(self.merit)

    def LostSight(self, before):
        """Did a macro-element lose its partner, as when a step moves it through the master?"""
        return bool(np.any(self.covered < 0.5 * before.covered))

    @classmethod
    def Nothing(cls, reason):
        """Of an iterate that has no residual."""
        return cls(None, np.inf, np.inf, np.inf, np.inf, None, None, reason)


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
        self.forces = self.reference = 0.0

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

    def Follow(self):
        """Contacts that follow the motion pair anew in the configuration of gf."""
        for contact in self.contacts:
            if follow := getattr(contact, "Follow", None):
                follow(self.gf)

    def Accept(self):
        """The state measured last has converged."""
        self.converged = max(self.forces, self.converged)

    def Measure(self, scale):
        """The State of gf."""
        vec = self.gf.vec
        residual, contact_residual = vec.CreateVector(), vec.CreateVector()
        contact_residual[:] = 0
        try:
            self.Follow()
            self.a.Apply(vec, residual)
            for contact in self.contacts:
                contact.AddApply(vec, contact_residual)
                contact.form.Evaluate(vec)
        except NgException as error:
            return State.Nothing(str(error))
        bulk, contact_forces = residual.FV().NumPy(), contact_residual.FV().NumPy()
        load = LoadVector(self.rhs, vec)
        # Forces at work: reactions, contact forces and loads all count.
        forces = max(
            float(np.linalg.norm((scale * f)[~self.rows])) for f in (bulk, contact_forces, load)
        )
        bulk = bulk - load
        scaled = scale * (bulk + contact_forces) * self.free
        if not np.all(np.isfinite(scaled)):
            return State.Nothing("the residual holds NaN or infinite values")
        self.forces = forces
        # No residual gets below the rounding errors of the stiffness times the displacement.
        rounding = 1e-14 * float(np.linalg.norm((vec.FV().NumPy() / scale)[~self.rows]))
        reference = max(self.forces, self.reference, rounding / self.tol)
        equilibrium = float(np.linalg.norm(scaled[~self.rows]))
        constraint = float(np.linalg.norm(scaled[self.rows]))
        merit = float(np.hypot(equilibrium, constraint))
        reference = reference or max(equilibrium, constraint) or 1.0
        tables = [contact.Table() for contact in self.contacts]
        return State(
            bulk,
            equilibrium / reference,
            constraint / reference,
            merit,
            equilibrium,
            np.concatenate([t["status"] for t in tables]),
            np.concatenate([t["area"] / t["fullarea"] for t in tables]),
        )


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
