# SPDX-License-Identifier: LGPL-2.1-or-later
"""Methods of LACContact for its fields, which follow the form."""

from ngsolve import GridFunction

__all__ = ["Change", "Fill", "Make"]

SCALARS, VECTORS = ("pressure", "gap", "status"), ("traction", "slip", "normal")


def Make(self):
    """New fields, of one number or one vector per macro-element."""
    for count, names in ((1, SCALARS), (self.mesh.dim, VECTORS)):
        space = self.space.WithComponents(count)
        for name in names:
            setattr(self, name, GridFunction(space, name=name))


def Fill(self):
    """What the form knows; 0 where it is not paired."""
    self._recovered = None
    table = self.Table() if self.form.paired else {}
    for name in SCALARS + VECTORS:
        values = table[name].ravel() if table else 0.0
        getattr(self, name).vec.FV().NumPy()[:] = values


def Change(self, kept, change):
    """Call `change`, and let fields follow the form.

    In the context `kept` what fails, or is interrupted, leaves both as they were.
    """
    fits = len(self.pressure.vec) == self.space.nmacros
    if self._state.refined or not fits:  # no way back
        change()
        self._MakeFields()
        self._Fill()
        return
    before = self._solution, self._accepted
    try:
        with kept:
            try:
                change()
                self._Fill()
            except BaseException:
                self._solution, self._accepted = before
                raise
    except BaseException:
        self._Fill()
        raise
