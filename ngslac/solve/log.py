# SPDX-License-Identifier: LGPL-2.1-or-later
"""The convergence table of a solve, as it grows."""

import logging

import numpy as np

from ngslac.callback import TellIterate
from ngslac.progress import ShowLive
from ngslac.solve.iteration import Iteration

__all__ = ["Log"]


class Log:
    """Notes each iterate, and shows it to whom it concerns."""

    def __init__(self, gf, tol, printing, callback, progress):
        self.gf, self.tol, self.printing, self.callback = gf, tol, printing, callback
        self.history, self.progress, self._status = [], progress, None

    def Say(self, line):
        """Print a line between those of the table."""
        if self.printing:
            print(line)

    def Add(self, state, damping=1.0):
        """The line of a Measurement, which a part of a step led to."""
        number = len(self.history)
        entry = Iteration.Of(number, state, self._status if number else state.status, damping)
        self._status = state.status
        self.history.append(entry)
        logging.getLogger("ngslac").debug("%s", entry)
        sizes = [max(e.equilibrium, e.constraint) for e in (self.history[0], entry)]
        if min(sizes) > self.tol:
            self.progress.At(np.log(sizes[1] / sizes[0]) / np.log(self.tol / sizes[0]))
        self.Say(entry)
        if not self.printing:
            ShowLive(str(entry))
        if self.callback:
            TellIterate(self.callback, entry, self.gf)
