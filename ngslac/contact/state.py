"""What a contact depends on from one step to the next: noted, saved, and put back."""

from contextlib import contextmanager, suppress

import numpy as np
from netgen.meshing import NgException
from ngsolve import GridFunction

from ngslac._ngslac import ContactForm
from ngslac.arguments import CheckOnSpace, CheckParts, CheckState, Wrong

__all__ = ["FIELDS", "IN_DOUBT", "REFERENCE", "ContactState"]

FIELDS = ("pressure", "gap", "status", "traction", "slip", "normal")
# In place of the solution in which the surfaces were paired: there was none, and while they are.
REFERENCE, IN_DOUBT = np.empty(0), object()


class ContactState:
    """The state of a contact, its compiled `form` and its fields: a base of `LACContact`."""

    def State(self):
        """What later steps depend on, as a dict of numpy arrays: save it to go on in a new process.

        Restore it with `SetState` on a contact that was built in the same way.

        Returns
        -------
        dict
        """
        history = self.form.History() if self.form.paired else {}
        return {"paired": self._paired, "scaled": self._scaled} | history

    def SetState(self, state, gf=None):
        """Pair in the saved configuration and take over the saved history.

        Parameters
        ----------
        state : dict
            Of `State`.
        gf : GridFunction, optional
            The solution then, on the product space. Without it the fields of ``finite=True`` are
            those of the last `Commit`.

        Raises
        ------
        TypeError, ValueError, ngsolve.NgException
            The state is none, or that of another contact. Nothing is changed then.
        """
        CheckParts(CheckState(state, "paired", "scaled"), scaled=(bool, np.bool_))
        for key in state:
            if key != "scaled" and np.asarray(state[key]).dtype.kind not in "fiuO":
                raise Wrong(TypeError, f"state[{key!r}]", state[key], "what State() returned there")
        if gf is not None:
            CheckOnSpace("gf", gf, self.form.fes)
        if self._IsRefined():  # no way back
            self._PutBack(state, gf)
            return
        with self._FormKept() if self.finite else self._WholeOrNot(gf):
            self._PutBack(state, gf)

    def _PutBack(self, state, gf):
        history = {name: state[name] for name in state if name not in ("paired", "scaled")}
        if not history:
            self._Unpair()
            return
        # With finite sliding there is more in the form than its history: it is left as it is.
        if self.finite or not self.form.paired or self._paired is not state["paired"]:
            self._Pair(self._Function(state["paired"]), history)
            self._paired = state["paired"]
        else:
            self.form.Restore()
        if self.finite and gf is not None:
            with suppress(NgException):  # where the surfaces do not meet, they did not then
                self.form.Follow(gf.vec)
                self.form.Evaluate(gf.vec)
        self.form.SetHistory(history)
        self._scaled = state["scaled"]
        self._Fill()

    def _Unpair(self):
        if self._paired is not None:
            self.form = ContactForm(**self._setup)
        self._scaled, self._paired = False, None
        self._Clear()

    def _Clear(self):
        for name in FIELDS:
            getattr(self, name).vec[:] = 0

    def _Function(self, values):
        if values is None or not len(values):
            return None
        if len(values) != self.nscalars:
            raise ValueError(
                f"state['paired'] has {len(values)} entries, the product space {self.nscalars}: "
                "give the State() of the same contact"
            )
        gf = GridFunction(self.form.fes)
        gf.vec.FV().NumPy()[:] = values
        return gf

    @contextmanager
    def _FormKept(self):
        """What fails in the block, or is interrupted, changes nothing: it makes a new form."""
        before = self.form, self._scaled, self._paired
        try:
            yield
        except BaseException:
            self.form, self._scaled, self._paired = before
            if self.form.paired:
                self._Fill()
            else:
                self._Clear()
            raise

    @contextmanager
    def _WholeOrNot(self, gf):
        """What fails in the block, or is interrupted, changes nothing: `gf` is the solution."""
        before = self.State()
        try:
            yield
        except BaseException:
            self._PutBack(before, gf)
            raise
