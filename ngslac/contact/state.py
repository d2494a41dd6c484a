"""What a contact depends on from one step to the next: noted, saved, and put back."""

from contextlib import contextmanager, suppress

import numpy as np
from netgen.meshing import NgException
from ngsolve import GridFunction

from ngslac._ngslac import ContactForm
from ngslac.arguments import CheckParts, CheckState, Wrong

__all__ = ["CheckSaved", "FormState"]

# In place of the solution in which the surfaces were paired: there was none, and while they are.
REFERENCE, IN_DOUBT = np.empty(0), object()


class FormState:
    """The compiled form of a contact, with where it was paired and how it was scaled.

    Parameters
    ----------
    setup : dict
        What a ContactForm is made of.
    stiffness : float
        Factor of its scale.

    Attributes
    ----------
    form : ContactForm
    """

    def __init__(self, setup, stiffness):
        self.setup, self.stiffness, self.form = setup, stiffness, ContactForm(**setup)
        self.scaled, self.paired = False, None

    @property
    def refined(self):
        """Is the pairing that of another mesh?"""
        return self.form.paired and not self.form.current

    def Pair(self, gf, history=None):
        """Pair in the configuration of `gf`, None: reference; take over a saved history."""
        paired = REFERENCE.copy() if gf is None else gf.vec.FV().NumPy().copy()
        form = ContactForm(**self.setup)
        form.Update(gf, history)
        self.form, self.scaled, self.paired = form, False, paired

    def Scale(self, bulk):
        """Take the scale from the bulk's matrix, once."""
        if not self.scaled:
            self.form.SetStiffness(bulk, self.stiffness)
            self.scaled = True

    def Displacement(self, values):
        """Of these entries, counted from where gaps are; None before a scale is known."""
        if values is None or not self.scaled or self.refined:
            return None
        # With finite sliding the pairing is the present one, an obstacle keeps its reference.
        moved = self.setup["master"] is not None and not self.setup["finite"]
        if moved and len(self.paired):
            values = values - self.paired
        form = self.form
        function = GridFunction(form.component)
        first = form.offset * form.fes.dim
        entries = function.vec.FV().NumPy()
        entries[:] = values[first : first + len(entries)]
        return function

    def Commit(self, gf):
        """Accept `gf` as the end of a step."""
        paired = self.paired
        if self.setup["finite"]:
            paired, self.paired = gf.vec.FV().NumPy().copy(), IN_DOUBT
        self.form.Commit(gf.vec)
        self.paired = paired

    def State(self):
        """As a dict of numpy arrays."""
        history = self.form.History() if self.form.paired else {}
        return {"paired": self.paired, "scaled": self.scaled} | history

    def SetState(self, state, gf):
        """Go back to a `State`; `gf` is the solution then, or None."""
        history = {name: state[name] for name in state if name not in ("paired", "scaled")}
        if not history:
            self._Unpair()
            return
        # With finite sliding there is more in the form than its history: it is left as it is.
        finite = self.setup["finite"]
        if finite or not self.form.paired or self.paired is not state["paired"]:
            self.Pair(self._Function(state["paired"]), history)
            self.paired = state["paired"]
        else:
            self.form.Restore()
        if finite and gf is not None:
            with suppress(NgException):  # where the surfaces do not meet, they did not then
                self.form.Follow(gf.vec)
                self.form.Evaluate(gf.vec)
        self.form.SetHistory(history)
        self.scaled = state["scaled"]

    def _Unpair(self):
        if self.paired is not None:
            self.form = ContactForm(**self.setup)
        self.scaled, self.paired = False, None

    def _Function(self, values):
        if values is None or not len(values):
            return None
        gf = GridFunction(self.form.fes)
        if len(values) != len(gf.vec.FV()):
            raise ValueError(
                f"state['paired'] has {len(values)} entries, the product space "
                f"{len(gf.vec.FV())}: give the State() of the same contact"
            )
        gf.vec.FV().NumPy()[:] = values
        return gf

    @contextmanager
    def FormKept(self):
        """What fails in the block, or is interrupted, changes nothing: it makes a new form."""
        before = self.form, self.scaled, self.paired
        try:
            yield
        except BaseException:
            self.form, self.scaled, self.paired = before
            raise

    @contextmanager
    def WholeOrNot(self, gf):
        """What fails in the block, or is interrupted, changes nothing: `gf` is the solution."""
        before = self.State()
        try:
            yield
        except BaseException:
            self.SetState(before, gf)
            raise


def CheckSaved(state):
    """What `State` returned, of any contact."""
    CheckParts(CheckState(state, "paired", "scaled"), scaled=(bool, np.bool_))
    for key in state:
        if key != "scaled" and np.asarray(state[key]).dtype.kind not in "fiuO":
            raise Wrong(TypeError, f"state[{key!r}]", state[key], "what State() returned there")
    return state
