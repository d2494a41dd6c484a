# SPDX-License-Identifier: LGPL-2.1-or-later
"""What a computation depends on from one step to the next: noted, and put back after a failure."""

__all__ = ["Snapshot"]


class Snapshot:
    """The state of things as it is now, which comes back where a ``with`` block fails."""

    def __init__(self, *things):
        self._states = [(thing, thing.State()) for thing in things]

    def __enter__(self):
        return self

    def __exit__(self, kind, error, trace):
        if kind is not None:
            self.Restore()

    def Restore(self):
        """Put everything back; an interrupt meanwhile is passed on when that is done."""
        try:
            self._PutBack()
        except KeyboardInterrupt:
            self._PutBack()
            raise

    def _PutBack(self):
        for thing, state in self._states:
            thing.SetState(state)
