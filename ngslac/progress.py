"""What NGSolve's status line and progress bar show of a long computation."""

from weakref import ref

# NGSolve's own Krylov solvers report by the same functions.
from netgen.libngpy._meshing import _GetStatus, _PushStatus, _SetThreadPercentage

__all__ = ["Progress"]


def Nothing():
    """There is no outermost one."""


class Progress:
    """A context that reports how far a computation has come, unless it is part of another one.

    Parameters
    ----------
    name : str
    begin, end : float
        Of the quantity that `At` is told: 0 and 100 percent.
    """

    # The outermost one. If an interrupt keeps it from leaving, it is gone when its frame is.
    _running = staticmethod(Nothing)

    def __init__(self, name, begin=0.0, end=1.0):
        self.name, self.begin, self.end = name, begin, end

    def __enter__(self):
        self._outermost = Progress._running() is None
        if self._outermost:
            self._before = _GetStatus()
            _PushStatus(self.name)
            _SetThreadPercentage(0)
            Progress._running = ref(self)  # last: an interrupt before leaves it to the next one
        return self

    def __exit__(self, *error):
        if self._outermost:
            Progress._running = Nothing
            _PushStatus(self._before[0])
            _SetThreadPercentage(self._before[1])

    def At(self, value):
        """The computation has come to `value`."""
        if self._outermost and self.end != self.begin:
            share = (value - self.begin) / (self.end - self.begin)
            _SetThreadPercentage(100 * min(max(share, 0), 1))
