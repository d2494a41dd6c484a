"""Scripts that end in different ways on different processes; the argument says which.

"first": the first process asks for what the others do not; "last": the last one does; "error": the
last one raises something, with "alone" while the others wait in MPI; "differs": an argument is
another one on each. With "slow" the last one is late, and all is well.
"""

import sys
import time

from mpi4py import MPI
from ngsolve import CF
from parallel_problem import QUIET, problem
from parallel_shapes import block_on_block

from ngslac.parallel import farewell, together

comm, end = MPI.COMM_WORLD, sys.argv[1]
made = problem(block_on_block(comm, 0.4), friction=0.3)
made.u.Set(CF((0.01, -0.02)), definedon=made.mesh.Boundaries("top"))
made.solver().Solve(**QUIET)  # which starts PETSc, whose end waits for all
(contact,) = made.contacts
last = comm.rank == comm.size - 1
if end in ("error", "alone") and last:
    if end == "alone":
        farewell.GRACE = 2.0
    raise KeyError("of the user")
if end == "alone":
    comm.Barrier()
if end == "differs":
    made.solver().Reaction("bottom" if comm.rank else "top")
if end == "slow":
    together.PATIENCE = 0.1
    time.sleep(0.5 * last)
if end in ("error", "slow") or (end == "first" and comm.rank == 0) or (end == "last" and last):
    contact.Evaluate(made.gf)
