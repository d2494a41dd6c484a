# SPDX-License-Identifier: LGPL-2.1-or-later
"""Methods of `LACContact` that switch it off and on between steps."""

__all__ = ["Activate", "Deactivate"]


def Deactivate(self) -> None:
    """Switch the contact off: from the next solve on there are no forces between the surfaces.

    All macro-elements are open, and without a partner. Between steps, not within one.

    Examples
    --------
    >>> contact.Deactivate()
    >>> contact.active
    False
    >>> contact.Activate()
    """
    self.form.SetActive(False)
    self._Fill()


def Activate(self, gf=None) -> None:
    """Switch the contact on: it pairs anew, and slip and ties count from there, as of `Update`.

    Parameters
    ----------
    gf : GridFunction, optional
        The solution now, on the product space; None: the reference.
    """
    self._Pair(gf, active=True)
