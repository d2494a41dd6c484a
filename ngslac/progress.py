# SPDX-License-Identifier: LGPL-2.1-or-later
"""Progress of a long computation on NGSolve's status line and progress bar."""

from __future__ import annotations

import shutil
import sys
from types import FrameType

# NGSolve's own Krylov solvers report by the same functions.
from netgen.libngpy._meshing import _GetStatus, _PushStatus, _SetThreadPercentage

__all__ = ["Progress", "Say", "ShowLive", "Silence", "Speaks"]


SILENT = []


def Silence() -> None:
    """Let other processes, which do the same, print and warn."""
    SILENT.append(True)


def Speaks() -> bool:
    """Does this process print and warn?"""
    return not SILENT


def Say(line: object) -> None:
    """Print a line, by one process."""
    if Speaks():
        print(line)


def ShowLive(text: str) -> None:
    """Show a line on a terminal, in place of one that has no end; nothing in files and pipes."""
    if sys.stderr.isatty() and Speaks():
        columns, end = shutil.get_terminal_size().columns, "\n" * text.endswith("\n")
        sys.stderr.write("\r\x1b[K" + text.rstrip("\n")[: columns - 1] + end)
        sys.stderr.flush()


def IsRunning(frame: FrameType | None) -> bool:
    """Is that frame of the interpreter one of those that lead here?"""
    here = sys._getframe() if frame else None
    while here is not None and here is not frame:
        here = here.f_back
    return here is not None


class Progress:
    """A context that reports how far a computation has come, unless it is part of another one.

    `begin` and `end` are the values that `At` gets for 0 and 100 percent.
    """

    # Where the outermost one was entered: an interrupt may keep it from leaving.
    _frame = None

    def __init__(self, name: str, begin: float = 0.0, end: float = 1.0):
        self.name, self.begin, self.end = name, begin, end

    def __enter__(self) -> Progress:
        """Show the name in NGSolve's status, unless another progress is shown."""
        self._outermost = not IsRunning(Progress._frame)
        if self._outermost:
            self._before = _GetStatus()
            _PushStatus(self.name)
            _SetThreadPercentage(0)
            Progress._frame = sys._getframe(
                1
            )  # last: an interrupt before leaves it to the next one
        return self

    def __exit__(self, *error) -> None:
        if self._outermost:
            Progress._frame = None
            ShowLive("")
            _PushStatus(self._before[0])
            _SetThreadPercentage(self._before[1])

    def At(self, value: float) -> None:
        """The computation has come to `value`."""
        if self._outermost and self.end != self.begin:
            share = (value - self.begin) / (self.end - self.begin)
            _SetThreadPercentage(100 * min(max(share, 0), 1))
