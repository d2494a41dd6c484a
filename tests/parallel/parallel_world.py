"""Where a case runs, and the table of cases."""

from dataclasses import dataclass
from pathlib import Path

CASES = {}


def case(function):
    """Enters a function of the `World` by its name; it returns the numbers to compare."""
    assert function.__name__ not in CASES, f"two cases have the name {function.__name__}"
    CASES[function.__name__] = function
    return function


@dataclass(frozen=True)
class World:
    """`comm` is None in the serial run; `saved` is a state that another run has left."""

    folder: Path
    comm: object = None
    saved: Path | None = None

    @property
    def size(self):
        return 1 if self.comm is None else self.comm.size

    @property
    def rank(self):
        return 0 if self.comm is None else self.comm.rank

    def wait(self):
        """Until all are here, and files of any of them are complete."""
        if self.comm is not None:
            self.comm.Barrier()
