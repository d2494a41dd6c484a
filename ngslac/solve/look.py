# SPDX-License-Identifier: LGPL-2.1-or-later
"""A second look at a converged state, which does not know how it was found."""

from ngslac.bodies.messages import DrivenMessage, IdleMessage
from ngslac.errors import FloatingBodyError, Warn

__all__ = ["Look"]


class Look:
    """What a state of bulk and contact says of itself.

    Parameters
    ----------
    system : System
        At the state, whose residual was measured last.
    """

    def __init__(self, system):
        self.system = system

    def __call__(self):
        """Raise an error if the state is none, and warn of what may not be meant."""
        self._LookAtMotions()

    def _LookAtMotions(self):
        system = self.system
        if not system.MayFloat():
            return
        free = system.Freedom("rubbing")
        if not free:
            return
        if system.IsDriven(free, "rubbing"):
            raise FloatingBodyError(DrivenMessage(system.DrivenMotion(free)))
        Warn(IdleMessage(system.bodies.Names(free.weights)))
