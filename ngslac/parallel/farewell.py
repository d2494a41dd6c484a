# SPDX-License-Identifier: LGPL-2.1-or-later
"""The end of scripts: what others still call then is refused, so that nobody waits for ever."""

import atexit
import sys
import time
from collections.abc import Callable, Iterator

__all__ = ["Farewell"]

# Seconds that a process whose script has failed waits for the others; they may be in calls of MPI,
# as those of NGSolve are, that wait for it.
GRACE = 10.0


class Farewell:
    """Stays until the scripts of all processes have ended, since MPI ends with all.

    Attributes
    ----------
    failed : bool
        Has the script of this process ended by an error, which is printed as ever?
    """

    known = None

    def __init__(self):
        self.waits, self.failed, self._print = [], False, sys.excepthook
        sys.excepthook = self._Note

    @classmethod
    def Of(cls, leave: Callable[[], Iterator[None]]) -> None:
        """Let a generator, which waits for others, run at the end, before PETSc's own."""
        cls.known = cls.known or cls()
        cls.known.waits.append(leave)
        cls.Again()

    @classmethod
    def Again(cls) -> None:
        """Run before all that is registered so far."""
        if cls.known is not None:
            atexit.unregister(cls.known)
            atexit.register(cls.known)

    def _Note(self, *error) -> None:
        self.failed = True
        self._print(*error)

    def __call__(self) -> None:
        """Wait for the other processes, after an error not for ever."""
        from mpi4py import MPI

        if MPI.Is_finalized():
            return
        end = time.monotonic() + GRACE
        for leave in self.waits:
            for _ in leave():
                if self.failed and time.monotonic() > end:
                    print(
                        f"process {MPI.COMM_WORLD.rank} has ended by an error, and others still "
                        f"run after {GRACE:g} s: the run ends here",
                        file=sys.stderr,
                        flush=True,
                    )
                    MPI.COMM_WORLD.Abort(1)
                time.sleep(1e-3)
