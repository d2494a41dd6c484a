# SPDX-License-Identifier: LGPL-2.1-or-later
"""Interrupts (SIGINT) wait while processes work together: who left alone would be waited for."""

import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager

__all__ = ["Interrupts"]


class Interrupts:
    """Holds back interrupts of this process.

    Attributes
    ----------
    came : bool
        Did one come meanwhile?
    """

    def __init__(self):
        self.came, self._handler = False, None

    @contextmanager
    def Held(self) -> Iterator[None]:
        """Within, interrupts are noted; the outermost one raises KeyboardInterrupt at its end."""
        if self._handler is not None or not OfMainThread():
            yield
            return
        self.came, self._handler = False, signal.signal(signal.SIGINT, self._Note)
        try:
            yield
        finally:
            signal.signal(signal.SIGINT, self._handler)
            self._handler = None
        if self.came:
            raise KeyboardInterrupt

    @contextmanager
    def Let(self) -> Iterator[None]:
        """Within, in functions of users, interrupts come at once."""
        handler = self._handler
        if handler is None or not OfMainThread():
            yield
            return
        self._handler = None
        signal.signal(signal.SIGINT, handler)
        try:
            yield
        finally:
            signal.signal(signal.SIGINT, self._Note)
            self._handler = handler

    def _Note(self, *_) -> None:
        self.came = True


def OfMainThread() -> bool:
    """Does the interpreter allow handlers here, and has Python set the present one?"""
    here = threading.current_thread() is threading.main_thread()
    return here and signal.getsignal(signal.SIGINT) is not None
