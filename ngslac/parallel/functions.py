"""Functions of users that only the processes with elements can evaluate."""

__all__ = ["RemoteIntegrand"]


class RemoteIntegrand:
    """A function on a distributed mesh that holds the solution: the conductor can integrate it.

    Parameters
    ----------
    ensemble : Ensemble
    number : int
        Of the function.
    """

    def __init__(self, ensemble, number):
        self._ensemble, self._number = ensemble, number

    def __repr__(self):
        return "<function that holds a GridFunction of a distributed mesh>"

    def Integrate(self):
        """The integral over the mesh."""
        self._ensemble.Write()
        own = lambda: self._ensemble.Integral(self._number)  # noqa: E731
        return float(self._ensemble.Order("integral", self._number, own=own)[-1])
