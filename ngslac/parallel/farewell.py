# SPDX-License-Identifier: LGPL-2.1-or-later
"""The end of scripts: what others still call then is refused, so that nobody waits for ever."""

import atexit
import sys
import time

__all__ = ["BeforeOthers", "Join"]

CREWS = []
# Seconds that a process whose script has failed waits for the others; they may be in calls of MPI,
# as those of NGSolve are, that wait for it.
GRACE = 10.0


class Failure:
    """Notes that the script of this process ends by an error, which is printed as ever."""

    def __init__(self):
        self.came, self._print = False, None

    def Watch(self):
        """Begin to, once."""
        if self._print is None:
            self._print, sys.excepthook = sys.excepthook, self

    def __call__(self, *error):
        self.came = True
        self._print(*error)


FAILURE = Failure()


def Join(crew):
    """Let the processes of a Crew tell each other when their scripts end, in whatever way."""
    CREWS.append(crew)
    FAILURE.Watch()
    BeforeOthers()


def BeforeOthers():
    """Do it before what is registered so far, such as the end of PETSc, waits for all."""
    atexit.unregister(Farewell)
    atexit.register(Farewell)


def Farewell():
    """Workers say that they leave; all stay until all have, since MPI ends with all."""
    from mpi4py import MPI

    if MPI.Is_finalized():
        return
    end = time.monotonic() + GRACE
    for crew in CREWS:
        crew.Leave()
    left = [crew.messages.comm.Ibarrier() for crew in CREWS]
    # Of all: some wait in one, some in others.
    while not all([crew.Dismiss() for crew in CREWS] + [one.Test() for one in left]):
        if FAILURE.came and time.monotonic() > end:
            print(
                f"process {MPI.COMM_WORLD.rank} has ended by an error, and others still run after "
                f"{GRACE:g} s: the run ends here",
                file=sys.stderr,
                flush=True,
            )
            MPI.COMM_WORLD.Abort(1)
        time.sleep(1e-3)
