# SPDX-License-Identifier: LGPL-2.1-or-later
"""Errors that a contact computation can end with."""

import sys
import warnings
from collections.abc import Sequence
from enum import Flag, auto
from pathlib import Path
from typing import NoReturn

from ngslac.progress import Speaks

__all__ = [
    "ContactConvergenceError",
    "ContactWarning",
    "FloatingBodyError",
    "LinearSolveError",
    "Reason",
    "RefuseCopy",
    "Warn",
]

HOME = str(Path(__file__).parent)


class Reason(Flag):
    """The known reasons of a failed solve, several at once if need be.

    `CERTAIN`: this load has no equilibrium. `UNHELD`: not even closed contact would hold a body
    that the loads move, nor would it under smaller loads. `EXHAUSTED`: all was tried that finds the
    contact status. `SLIDES`: friction is at its limit wherever contact holds a body that the loads
    carry off. `SLIPS`: nearly all contact slipped for long, where bodies are held by it alone.
    """

    CERTAIN, UNHELD, EXHAUSTED, SLIDES, SLIPS = (auto() for _ in range(5))


class LinearSolveError(RuntimeError):
    """No linear solver found a solution with a small residual."""


# Attributes of errors before 0.3, by what they are now.
RENAMED = {name: name.upper() for name in ("certain", "unheld", "exhausted", "slides")}
RENAMED |= {"rubs": "SLIPS"}


class ContactConvergenceError(RuntimeError):
    """The generalised Newton method did not converge; the last converged state is restored.

    Attributes
    ----------
    history : list[Iteration]
        One entry per iteration, see `ContactSolver.history`.
    reason : Reason
        What is known about why: ``Reason.CERTAIN in error.reason``, for example.

    Examples
    --------
    >>> square = InnerProduct(Grad(u), Grad(u))
    >>> a = BilinearForm(fes)
    >>> a += Variation((square + square**2) * dx)
    >>> a += v[1] * ds("top")
    >>> try:
    ...     last = ContactSolver(a, gf, contact).Solve(maxit=1, printing=False)
    ... except ContactConvergenceError as error:
    ...     print(str(error)[:14], error.history[-1].number)
    no convergence 1
    """

    def __init__(self, message: str, history: Sequence = ()):
        super().__init__(message)
        self.history, self.reason = list(history), Reason(0)

    def __getattr__(self, name: str) -> bool:
        if name not in RENAMED:
            raise AttributeError(name)
        reason = Reason[RENAMED[name]]
        Warn(f"write Reason.{reason.name} in error.reason for error.{name}", DeprecationWarning)
        return reason in self.reason


class FloatingBodyError(ContactConvergenceError):
    """A body is held by nothing: neither Dirichlet conditions nor active contact.

    The message names the body and the motions that are left to it. Its `history` is that of a
    `ContactConvergenceError`.

    Examples
    --------
    A load that pulls the upper block away:

    >>> load.Set(-1)
    >>> try:
    ...     solver.Solve(printing=False)
    ... except FloatingBodyError as error:
    ...     print("upper" in str(error))
    True
    """


class ContactWarning(UserWarning):
    """A result was found, but it may not be the intended one.

    The message says where, how much, and what to do about it. Turn it into an error by
    ``warnings.simplefilter("error", ContactWarning)``.

    Examples
    --------
    A condition on a boundary that is not there, which holds nothing:

    >>> import warnings
    >>> V = VectorH1(mesh, order=2, dirichlet="botom")
    >>> Q = LACSpace(V, slave="slave")
    >>> with warnings.catch_warnings():
    ...     warnings.simplefilter("error", ContactWarning)
    ...     try:
    ...         LACContact(*(V * Q).TrialFunction(), master="master")
    ...     except ContactWarning as warning:
    ...         print("botom" in str(warning))
    True
    """


def Warn(message: str, kind: type[Warning] | None = None) -> None:
    """A warning at the line of the user's script that called the package."""
    if not Speaks():
        return
    frame, level = sys._getframe(1), 2
    while frame.f_back is not None and frame.f_code.co_filename.startswith(HOME):
        frame, level = frame.f_back, level + 1
    warnings.warn(message, kind or ContactWarning, stacklevel=level)


def RefuseCopy(self, *_) -> NoReturn:
    """Refuse `pickle` and `copy` for objects that hold meshes and matrices."""
    raise TypeError(
        f"a {type(self).__name__} can be neither pickled nor copied: make another one in the same "
        "way; SaveState and LoadState carry the state from one to the other"
    )
