# SPDX-License-Identifier: LGPL-2.1-or-later
"""What a computation depends on from one step to the next: noted, and put back after a failure."""

from __future__ import annotations

from types import TracebackType

__all__ = ["Snapshot"]


class Snapshot:
    """The state of things as it is now, which comes back where a ``with`` block fails."""

    def __init__(self, *things):
        self._states = [(thing, thing.State()) for thing in things]

    def __enter__(self) -> Snapshot:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        if kind is not None:
            self.Restore()

    def Restore(self) -> None:
        """Put everything back; an interrupt meanwhile is passed on when that is done."""
        try:
            self._PutBack()
        except KeyboardInterrupt:
            self._PutBack()
            raise

    def _PutBack(self) -> None:
        for thing, state in self._states:
            thing.SetState(state)
