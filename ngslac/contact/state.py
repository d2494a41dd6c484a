# SPDX-License-Identifier: LGPL-2.1-or-later
"""The state of a contact from one step to the next: recorded, saved and restored."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import suppress
from typing import Any

import numpy as np
from netgen.meshing import NgException
from ngsolve import BaseMatrix, BilinearForm, GridFunction

from ngslac.arguments import CheckParts, CheckState, Wrong
from ngslac.parallel.form import MakeForm
from ngslac.parallel.layout import LayoutOf

__all__ = ["CheckSaved", "FormState"]

# In place of the solution in which the surfaces were paired: there was none, and while they are.
REFERENCE, IN_DOUBT = np.empty(0), object()
FLAGS = ("scaled", "active")


class FormState:
    """The compiled form of a contact, with where it was paired and how it was scaled."""

    def __init__(self, setup: dict[str, Any], stiffness: float):
        # The arguments of a ContactForm, the factor of its scale, and the form.
        self.setup, self.stiffness, self.form = setup, stiffness, MakeForm(setup)
        self.scaled, self.paired = False, None

    @property
    def follows(self) -> bool:
        """Does it pair anew in each step? Then there is more in the form than its history."""
        return self.setup["finite"] and not self.setup["tied"]

    @property
    def refined(self) -> bool:
        """Is the pairing that of another mesh?"""
        return self.form.paired and not self.form.current

    def Pair(
        self,
        gf: GridFunction | None,
        history: dict[str, np.ndarray] | None = None,
        active: bool | None = None,
    ) -> None:
        """Pair in the configuration of `gf`, None: reference; take over a saved history.

        `active`: is it switched on? None: as before.
        """
        active = self.form.active if active is None else active
        paired = REFERENCE.copy() if gf is None else LayoutOf(gf.space).Values(gf.vec).copy()
        form = MakeForm(self.setup, active=active)
        form.Update(gf, history)
        if history is None and gf is not None and self.form.current:
            form.KeepFrom(self.form)
        self.form, self.scaled, self.paired = form, False, paired

    def Scale(self, bulk: BaseMatrix, form: BilinearForm | BaseMatrix | None) -> None:
        """Take the scale from the bulk's matrix, and which body is stiffer from a form, once."""
        if not self.scaled:
            self.form.SetStiffness(bulk, self.stiffness)
            self.form.LearnStiffness(bulk if form is None else form)
            self.scaled = True

    def Displacement(self, values: np.ndarray | None) -> GridFunction | None:
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
        entries = LayoutOf(form.component).Values(function.vec)
        entries[:] = values[first : first + len(entries)]
        return function

    def Commit(self, gf: GridFunction) -> None:
        """Accept `gf` as the end of a step."""
        paired = self.paired
        if self.follows:
            paired, self.paired = LayoutOf(gf.space).Values(gf.vec).copy(), IN_DOUBT
        self.form.Commit(gf.vec)
        self.paired = paired

    def State(self) -> dict:
        """As a dict of numpy arrays."""
        history = self.form.History() if self.form.paired else {}
        flags = {"scaled": self.scaled, "active": self.form.active}
        return {"paired": self.paired} | flags | history

    def SetState(self, state: dict, gf: GridFunction | None) -> None:
        """Go back to a `State`; `gf` is the solution then, or None."""
        history = {name: state[name] for name in state if name not in ("paired", *FLAGS)}
        active = bool(state.get("active", True))
        if not history:
            self._Unpair(active)
            return
        if self.follows or not self.form.paired or self.paired is not state["paired"]:
            self.Pair(self._Function(state["paired"]), history, active)
            self.paired = state["paired"]
        else:
            self.form.Restore()
            self.form.SetActive(active)
        if self.setup["finite"] and gf is not None:
            with suppress(NgException):  # where the surfaces do not meet, they did not then
                self.form.Follow(gf.vec)
                self.form.Evaluate(gf.vec)
        self.form.SetHistory(history)
        self.scaled = state["scaled"]

    def _Unpair(self, active: bool) -> None:
        if self.paired is not None or self.form.active != active:
            self.form = MakeForm(self.setup, active=active)
        self.scaled, self.paired = False, None

    def _Function(self, values: np.ndarray | None) -> GridFunction | None:
        """The solution with these entries, where the surfaces were paired; None: the reference."""
        if values is None or not len(values):
            return None
        gf = GridFunction(self.form.fes)
        if len(values) != len(gf.vec.FV()):
            raise ValueError(
                f"state['paired'] has {len(values)} entries, the product space "
                f"{len(gf.vec.FV())}: give the State() of the same contact"
            )
        LayoutOf(gf.space).Values(gf.vec)[:] = values
        return gf

    def FormKept(self) -> _Kept:
        """An error or interrupt in the block, which makes a new form, changes nothing."""
        before = self.form, self.scaled, self.paired

        def Restore() -> None:
            self.form, self.scaled, self.paired = before

        return _Kept(Restore)

    def WholeOrNot(self, gf: GridFunction | None) -> _Kept:
        """An error or interrupt in the block changes nothing: `gf` is the solution."""
        before = self.State()
        return _Kept(lambda: self.SetState(before, gf))


class _Kept:
    """Restores after an error; as a generator it may miss an interrupt before the first line."""

    def __init__(self, restore: Callable[[], object]):
        self.restore = restore

    def __enter__(self) -> _Kept:
        return self

    def __exit__(self, kind: type[BaseException] | None, *_) -> None:
        if kind is not None:
            self.restore()


def CheckSaved(state: dict) -> dict:
    """Check a result of `State`, of any contact."""
    CheckState(state, "paired", "scaled")
    CheckParts(state, **{name: (bool, np.bool_) for name in FLAGS if name in state})
    for key in state:
        if key not in FLAGS and np.asarray(state[key]).dtype.kind not in "fiuO":
            raise Wrong(TypeError, f"state[{key!r}]", state[key], "what State() returned there")
    return state
