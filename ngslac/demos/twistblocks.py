"""Twisting blocks: a soft block is pressed on a wider one and turned by 180 degrees.

Large deformation and finite sliding with friction in three dimensions. The top of the upper block
(10 MPa, neo-Hookean) goes down by a tenth of its height and then turns about the vertical axis: the
block twists until its lower face slides, with friction 0.3, and turns as a whole from then on.
Start it with::

    python -m ngslac.demos.twistblocks --out results

The steady torque is compared with that of a flat square punch under uniform pressure, 0.3826 times
friction, force and width: 0.887, 0.938, 0.966 of it for 3, 4, 6 faces (steps of 15 degrees). All
balances are checked.
"""

from __future__ import annotations

import time
from dataclasses import asdict, dataclass, field
from pathlib import Path

from ngslac import ContactConvergenceError

from ._command import CommandParser, RunCommand
from ._pictures import Matplotlib
from ._twistblocks_figures import Figures, Report
from ._twistblocks_model import Model
from ._twistblocks_pictures import OverviewPicture, Write

__all__ = ["Problem", "Results", "Run", "main"]


@dataclass(frozen=True, kw_only=True)
class Problem:
    """What to compute.

    Parameters
    ----------
    n : int
        Element faces of the upper block at the contact, in each direction.
    order : int
        Order of the displacement, at least 2.
    friction : float
        Coefficient of friction.
    angle : float
        By which the top turns, in degrees.
    steps : int
        Steps of the turn; two steps press.
    rigid : bool
        The lower block does not deform: the slip becomes exactly steady.
    """

    n: int = 3
    order: int = 2
    friction: float = 0.3
    angle: float = 180.0
    steps: int = 12
    rigid: bool = False

    def __post_init__(self):
        if self.steps < 1:
            raise ValueError(f"steps = {self.steps} must be at least 1")
        if self.order < 2:
            raise ValueError(f"order = {self.order} must be at least 2")
        if not self.friction >= 0:
            raise ValueError(f"friction = {self.friction} must not be negative")


@dataclass
class Results:
    """Outcome of `Run`: `figures` (as in the JSON file), and the model with its states."""

    problem: Problem
    model: Model
    failure: str | None = None
    figures: dict = field(default_factory=dict)

    @property
    def states(self):
        """The converged steps."""
        return self.model.states


def Run(*, out=None, picture=None, quiet=True, printing=False, **options):
    """Compute the problem.

    Parameters
    ----------
    out : str or path, optional
        Directory for pictures, the VTU files and a scene for the browser.
    picture : str or path, optional
        File for one picture with deformed states, tractions and the torque.
    quiet, printing : bool
        Print nothing; print each Newton iteration.
    **options
        The fields of `Problem`.

    Returns
    -------
    Results
        With ``results.figures``, the dict that is written to the JSON file. A run that stops on the
        way has the reason in ``results.failure`` and the states up to there.
    """
    problem = Problem(**options)
    if out is not None or picture is not None:
        Matplotlib()  # complain before the work, not after it
    start = time.perf_counter()
    fields = asdict(problem)
    steps = fields.pop("steps")
    results = Results(problem, Model(**fields))
    callback = None if quiet else _Print
    try:
        results.model.Integrate(1.0, 2, callback, printing)
        results.model.Integrate(2.0, steps, callback, printing)
    except ContactConvergenceError as error:
        results.failure = str(error)
    results.figures = Figures(results, time.perf_counter() - start)
    if not quiet:
        print(Report(results))
    if out is not None:
        Write(results, Path(out))
    if picture is not None and results.states:
        OverviewPicture(results, picture)
    return results


def _Print(state):
    status = [int((state.table["status"] == k).sum()) for k in range(3)]
    print(
        f"  {state.angle:6.1f} degrees   force {state.force[2]:8.5f} N   torque "
        f"{-state.torque:8.5f} N mm   open {status[0]:2d}  stick {status[1]:2d}  "
        f"slip {status[2]:2d}   {state.iterations} iterations"
        + (f", {state.cuts} cuts" if state.cuts else ""),
        flush=True,
    )


def _Parser():
    parser = CommandParser("twistblocks", __doc__)
    add = parser.add_argument
    add("--n", type=int, default=3, help="faces of the upper block in each direction")
    add("--order", type=int, choices=(2, 3), default=2, help="order of the displacement")
    add("--friction", type=float, default=0.3, help="coefficient of friction")
    add("--angle", type=float, default=180.0, help="angle of the turn in degrees")
    add("--steps", type=int, default=12, help="number of steps of the turn")
    add("--rigid", action="store_true", help="the lower block is rigid")
    add("--picture", metavar="PNG", help="draw states, tractions and torque into this file")
    add("--out", metavar="DIR", help="write pictures and VTU files to this directory")
    add("--printing", action="store_true", help="print every Newton iteration")
    return parser


def main(argv=None):
    """Run the demo from the command line."""
    RunCommand(Run, vars(_Parser().parse_args(argv)))


if __name__ == "__main__":
    main()
