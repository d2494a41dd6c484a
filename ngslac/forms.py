"""Bulk plus contact as one form."""

import numpy as np

from ngslac._ngslac import MergeMatrices

__all__ = ["FormSum"]


class FormSum:
    """The sum of a bulk form and of contact forms, with the verbs of a BilinearForm.

    NGSolve's own `ngsolve.nonlinearsolvers.NewtonSolver` runs it with the pairing fixed.
    `ContactSolver` does the same with scaling, safe linear solves and control of cycling.

    Parameters
    ----------
    a : ngsolve.BilinearForm
        Bulk form on the product space X, without static condensation or with it.
    contacts : LACContact
        Contact forms on the same X.

    Examples
    --------
    >>> form = FormSum(a, contact)
    >>> form.AssembleLinearization(gf.vec)
    >>> form.mat.height == fes.ndof
    True
    """

    def __init__(self, a, *contacts):
        if len({id(c.space) for c in contacts}) < len(contacts):
            raise ValueError("two contacts share one lam: give each a LACSpace of its own")
        self.a = a
        self.contacts = contacts
        self.mat = None

    @property
    def condense(self):
        """Is the bulk condensed?"""
        return self.a.condense

    @property
    def harmonic_extension(self):
        """Of the bulk."""
        return self.a.harmonic_extension

    @property
    def harmonic_extension_trans(self):
        """Of the bulk."""
        return self.a.harmonic_extension_trans

    @property
    def inner_solve(self):
        """Of the bulk."""
        return self.a.inner_solve

    def AssembleLinearization(self, x):
        """Assemble `mat` at the state x (BaseVector); pairs the surfaces if that was not done."""
        self.a.AssembleLinearization(x)
        for contact in self.contacts:
            contact.Prepare(self.a.mat)
            contact.AssembleLinearization(x)
        self.mat = MergeMatrices(
            self.a.mat, [c.form for c in self.contacts], np.ones(self.contacts[0].nscalars)
        )

    def Apply(self, x, y):
        """y = residual of bulk and contact at x (both BaseVectors)."""
        self.a.Apply(x, y)
        for contact in self.contacts:
            contact.AddApply(x, y)
