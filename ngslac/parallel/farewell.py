# SPDX-License-Identifier: LGPL-2.1-or-later
"""The end of scripts: what others still call then is refused, so that nobody waits for ever."""

import atexit
import time

__all__ = ["BeforeOthers", "Join"]

CREWS = []


def Join(crew):
    """Let the processes of a Crew tell each other when their scripts end, in whatever way."""
    CREWS.append(crew)
    BeforeOthers()


def BeforeOthers():
    """Do it before what is registered so far, such as the end of PETSc, waits for all."""
    atexit.unregister(Farewell)
    atexit.register(Farewell)


def Farewell():
    """Workers say that they leave; conductors stay until all have, since MPI ends with all."""
    from mpi4py import MPI

    if MPI.Is_finalized():
        return
    for crew in CREWS:
        crew.Leave()
    while not all([crew.Dismiss() for crew in CREWS]):  # of all: some wait in one, some in others
        time.sleep(1e-3)
