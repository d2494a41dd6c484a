"""Errors that a contact computation can end with."""

__all__ = ["ContactConvergenceError", "FloatingBodyError"]


class ContactConvergenceError(RuntimeError):
    """The generalised Newton method did not converge; the last converged state is restored.

    Attributes
    ----------
    history : list[Iteration]
        One entry per iteration, see `ContactSolver.history`.
    """

    def __init__(self, message, history=()):
        super().__init__(message)
        self.history = list(history)


class FloatingBodyError(ContactConvergenceError):
    """A body is held by nothing: neither Dirichlet conditions nor active contact."""
