# SPDX-License-Identifier: LGPL-2.1-or-later
"""Bulk plus contact as one form."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from ngsolve import BaseMatrix, BaseVector, BilinearForm

from ngslac._ngslac import MergeMatrices
from ngslac.arguments import CheckVector
from ngslac.errors import RefuseCopy
from ngslac.solve.problem import AssembleBulk, CheckBulk, CheckContacts

if TYPE_CHECKING:
    from ngslac.contact.contact import LACContact

__all__ = ["FormSum"]


class FormSum:
    """The sum of a bulk form and of contact forms, with the verbs of a BilinearForm.

    NGSolve's own `ngsolve.nonlinearsolvers.NewtonSolver` runs it with the pairing fixed.
    `ContactSolver` does the same with scaling, safe linear solves and control of cycling.

    Parameters
    ----------
    a : ngsolve.BilinearForm
        Bulk form on the product space X, without static condensation or with it.
    *contacts : LACContact
        Contact forms on the same X, one at least.

    Attributes
    ----------
    mat : BaseMatrix
        Of the last `AssembleLinearization`, with the scalar dofs of X as rows and columns.

    Raises
    ------
    ValueError, TypeError
        If there is no contact, spaces differ, or two contacts share one `lam`.

    Examples
    --------
    >>> form = FormSum(a, contact)
    >>> form.AssembleLinearization(gf.vec)
    >>> form.mat.height == fes.ndof
    True
    """

    __deepcopy__ = __reduce_ex__ = RefuseCopy

    def __init__(self, a: BilinearForm, *contacts: LACContact):
        self.a = CheckBulk(a)
        if a.space.mesh.comm.size > 1:
            raise ValueError(
                "FormSum is not known on a distributed mesh: take a ContactSolver, which adds a "
                "and the contacts itself"
            )
        self.contacts = tuple(CheckContacts(contacts, a.space))
        self.mat: Any = None  # before it is assembled

    def __repr__(self) -> str:
        return f"<FormSum: {self.a!r} and {', '.join(map(repr, self.contacts))}>"

    @property
    def condense(self) -> bool:
        """Does the bulk condense (a bool)?"""
        return self.a.condense

    @property
    def harmonic_extension(self) -> BaseMatrix:
        """Matrix of the bulk, for what it condenses."""
        return self.a.harmonic_extension

    @property
    def harmonic_extension_trans(self) -> BaseMatrix:
        """Matrix of the bulk, for what it condenses."""
        return self.a.harmonic_extension_trans

    @property
    def inner_solve(self) -> BaseMatrix:
        """Matrix of the bulk, for what it condenses."""
        return self.a.inner_solve

    def AssembleLinearization(self, x: BaseVector) -> None:
        """Assemble `mat` at a state; pairs the surfaces if that was not done.

        Parameters
        ----------
        x : BaseVector
            On the product space.
        """
        CheckVector("x", x, self.contacts[0].nscalars)
        AssembleBulk(self.a, x, self.contacts[0].layout)
        for contact in self.contacts:
            contact.Prepare(self.a.mat, form=self.a)
            contact.AssembleLinearization(x)
        self.mat = MergeMatrices(
            self.a.mat, [c.form for c in self.contacts], np.ones(self.contacts[0].nscalars)
        )

    def Apply(self, x: BaseVector, y: BaseVector) -> None:
        """y = residual of bulk and contact at x.

        Parameters
        ----------
        x, y : BaseVector
            State and residual (forces) on the product space.
        """
        for name, vec in {"x": x, "y": y}.items():
            CheckVector(name, vec, self.contacts[0].nscalars)
        self.a.Apply(x, y)
        for contact in self.contacts:
            contact.AddApply(x, y)
