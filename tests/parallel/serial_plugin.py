"""A plugin of pytest: the two blocks of tests/problems are on a mesh that all processes share.

``mpiexec -n 3 python -m mpi4py -m pytest -p serial_plugin FILES`` runs tests of a single process.
"""

import faulthandler
import os
import sys

import press
import pytest
from mpi4py import MPI

from ngslac.meshes import Distributed

LIMIT = 60.0  # seconds of a test, after which it counts as one that hangs
COMM = MPI.COMM_WORLD
whole = press.two_blocks


def shared(*args, **options):
    """The two blocks, distributed."""
    return Distributed(lambda: whole(*args, **options), COMM)


press.two_blocks = shared
if COMM.rank:  # one process tells
    sys.stdout = open(os.devnull, "w")  # noqa: SIM115


@pytest.hookimpl(hookwrapper=True)
def pytest_runtest_call(item):
    """End all processes where one hangs."""
    faulthandler.dump_traceback_later(LIMIT, exit=True, file=sys.__stderr__)
    yield
    faulthandler.cancel_dump_traceback_later()
