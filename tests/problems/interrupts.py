"""Interrupts at any line of the package, as Ctrl-C brings them, and what is left after them."""

import sys
from pathlib import Path

import numpy as np

import ngslac

HOME = str(Path(ngslac.__file__).parent)


class Interrupter:
    """A context that raises KeyboardInterrupt at the line number `at` that the package executes.

    `lines` is how many were executed.
    """

    def __init__(self, at=None):
        self.at, self.lines = at, 0

    def __enter__(self):
        self._before = sys.gettrace()
        sys.settrace(self._Trace)
        return self

    def __exit__(self, *error):
        sys.settrace(self._before)

    def _Trace(self, frame, event, _):
        if not frame.f_code.co_filename.startswith(HOME):
            return None
        if event == "line":
            self.lines += 1
            if self.lines == self.at:
                raise KeyboardInterrupt
        return self._Trace


def seen(tool):
    """All that a user can see of a computation, by name."""
    solver = getattr(tool, "solver", tool)
    found = {"gf": solver.gf}
    for name in ("load", "time"):
        if hasattr(tool, name):
            found[name] = getattr(tool, name).Get()
    if hasattr(tool, "steps"):
        found["steps"] = len(tool.steps)
    if hasattr(tool, "velocity"):
        found["velocity"] = tool.velocity
        found["balance"] = -1.0 if tool.balance is None else tool.balance.time
    for k, contact in enumerate(solver.contacts):
        parts = contact.Table() | contact.State()
        parts |= {"force": contact.Force(), "moment": contact.Moment()}
        parts["segments"] = contact.Segments().gap
        for name in ("pressure", "gap", "status", "traction", "slip", "normal"):
            parts["field " + name] = getattr(contact, name)
        found |= {f"{name} {k}": value for name, value in parts.items()}
    return {name: Copy(value) for name, value in found.items()}


def Copy(value):
    return np.array(value.vec.FV().NumPy() if hasattr(value, "vec") else value)


def same(one, other):
    """Names of what is the same in both, to the last bit."""
    return {name for name in one if np.array_equal(one[name], other[name], equal_nan=True)}
