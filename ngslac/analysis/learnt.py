# SPDX-License-Identifier: LGPL-2.1-or-later
"""The stiffness of both bodies as contacts measured it, which changes with design variables."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import scipy
from ngsolve import BilinearForm, BitArray

from ngslac._ngslac import ContactForm, FormDiagonal
from ngslac.arrays import AsNumPy, Exported

if TYPE_CHECKING:
    from ngslac.contact.contact import LACContact
    from ngslac.contact.state import FormState

__all__ = ["Learnt", "SurfaceDofs"]

# Relative difference of two stiffnesses that are the same.
SAME = 1e-9
# Things that are learnt: the contact direction, and the scale of sharp ends.
NAMES = ("share", "end_c")


class Learnt:
    """The stiffness as a contact learns it from the elements of a bulk form.

    The contact direction lies nearer to the normal of the stiffer body, and sharp ends have a scale
    of their own. Where the slave is held along the surface it sticks elastically, by a part of the
    scale c of the contact.

    Attributes
    ----------
    follows : bool
        Has the contact learnt it from the present problem? Else it keeps what it knows.
    """

    def __init__(self, contact: LACContact, elastic: BilinearForm):
        self.contact, self.elastic, self.follows = contact, elastic, False
        # By the elements of the present problem (m,), where that matters: for a FormState of a
        # known pairing, False, and for one that pairs anew.
        self.scales = {}

    def Compare(self, shadow: FormState, apart: bool) -> None:
        """Set `follows` by comparison with a FormState of the present problem."""
        if not isinstance(self.elastic, BilinearForm):
            return
        form = shadow.form
        before = form.History()
        form.LearnStiffness(self.elastic)
        after = form.History()
        known = [name for name in NAMES if name in before]
        self.follows = apart or all(
            np.allclose(before[name], after[name], rtol=SAME, atol=0) for name in known
        )
        if self.follows and GivesAlong(self.contact):
            self.Measure(shadow, anew=False)
        form.SetHistory(before)

    def Needs(self, anew: bool) -> bool:
        """Is a scale to be measured for FormStates that pair anew?"""
        return anew and bool(self.scales) and True not in self.scales

    def Measure(self, shadow: FormState, anew: bool) -> None:
        """Note the scale by the elements of a FormState of the present problem."""
        self.scales[anew] = self._Scale(shadow.form)

    def Learn(self, shadow: FormState, scale: np.ndarray, anew: bool) -> None:
        """Let a FormState learn the stiffness of a variation; `scale` (m,): c before."""
        form = shadow.form
        if self.scales:
            before, now = self.scales[anew], self._Scale(form)
            scale = scale * np.divide(now, before, out=np.ones_like(now), where=before > 0)
        form.LearnStiffness(self.elastic)
        form.SetHistory(form.History() | {"c": scale})

    def _Scale(self, form: ContactForm) -> np.ndarray:
        """The scale c (m,) by the elements at both surfaces."""
        diagonal = FormDiagonal(self.elastic, SurfaceDofs(self.contact))
        form.SetStiffness(Exported(scipy.sparse.diags(diagonal).tocsr()), 1.0)
        return form.History()["c"].copy()


def SurfaceDofs(contact: LACContact) -> BitArray:
    """Dofs of the product space on both surfaces, as BitArray."""
    space = contact.form.fes
    dofs = space.GetDofs(contact.space.slave)
    if contact.master is not None:
        dofs |= space.GetDofs(contact.master)
    return dofs


def GivesAlong(contact: LACContact) -> bool:
    """Is a displacement prescribed on the slave, in which it sticks elastically?"""
    space = contact.form.component
    held = AsNumPy(space.GetDofs(contact.space.slave)) & ~AsNumPy(space.FreeDofs())
    return bool(np.any(held))
