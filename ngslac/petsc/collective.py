# SPDX-License-Identifier: LGPL-2.1-or-later
"""What only rank 0 computes, and all have to know that it failed."""

from ngslac.linear.factor import LinearSolveError

__all__ = ["OnRankZero"]


def OnRankZero(numbering, function):
    """What a function returns on rank 0, None elsewhere; all ranks raise its LinearSolveError."""
    found = error = None
    if numbering.rank == 0:
        try:
            found = function()
        except LinearSolveError as raised:
            error = str(raised)
    error = numbering.Tell(error)
    if error is not None:
        raise LinearSolveError(error)
    return found
