"""Hertz' problem with large deformation: a rubber cylinder is flattened between rigid plates.

Plane strain, neo-Hookean (1 MPa, nu = 0.49), radius 1 mm, without friction; a quarter is computed.
The plates come together until the middle is nearer to each by 30 % of the radius. Start it with::

    python -m ngslac.demos.hertz_large --out results

The force is compared with Hertz' for small loads, and its work with the strain energy; the mesh
converged force is 0.6282 N/mm at the end, of which Hertz' theory has 0.4940.
"""

from __future__ import annotations

import time
from dataclasses import asdict, dataclass, field
from pathlib import Path

from ngslac import ContactConvergenceError
from ngslac.meshes.geometry import CheckPositive

from ._command import CommandParser, WriteJSON
from ._hertz_large_figures import Figures, Report
from ._hertz_large_model import Model
from ._hertz_large_pictures import OverviewPicture, Write
from ._pictures import Matplotlib

__all__ = ["Problem", "Results", "Run", "Table", "main"]


@dataclass(frozen=True, kw_only=True)
class Problem:
    """What to compute.

    Parameters
    ----------
    h : float
        Edge length on the slave arc, in mm (radius 1 mm).
    order : int
        Order of the displacement, at least 2.
    young, nu : float
        Young's modulus in MPa and Poisson's ratio at small strains.
    friction : float
        Coefficient of friction.
    depth : float
        By which the middle approaches the plate, in mm.
    steps : int
        Number of equal load steps.
    """

    h: float = 0.05
    order: int = 2
    young: float = 1.0
    nu: float = 0.49
    friction: float = 0.0
    depth: float = 0.3
    steps: int = 30

    def __post_init__(self):
        CheckPositive(h=self.h, young=self.young, depth=self.depth)
        if self.steps < 1:
            raise ValueError(f"steps = {self.steps} must be at least 1")
        if self.order < 2:
            raise ValueError(f"order = {self.order} must be at least 2")
        if not 0 <= self.nu < 0.5:
            raise ValueError(f"nu = {self.nu} must be at least 0 and less than 0.5")
        if not self.depth < 0.7:
            raise ValueError(f"depth = {self.depth} must be less than 0.7 radii")


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
        Directory for the picture and a VTU file.
    picture : str or path, optional
        File for the picture alone.
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
    try:
        results.model.Integrate(1.0, steps, None if quiet else _Print, printing)
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


def Table(sizes=(0.2, 0.1, 0.05), **options):
    """Force, energy and half width at the end for several mesh sizes.

    Parameters
    ----------
    sizes : sequence of float
        Edge lengths on the slave arc.
    **options
        Fields of `Problem`, without ``h``.

    Returns
    -------
    list of dict
        ``h, ndof, force, energy, halfwidth`` for each of them.
    """
    rows = []
    for h in sizes:
        results = Run(h=h, **options)
        last = results.states[-1]
        rows.append(
            {
                "h": h,
                "ndof": results.figures["ndof"],
                "force": last.force,
                "energy": last.energy,
                "halfwidth": last.halfwidth,
            }
        )
    return rows


def _Print(state):
    print(
        f"  approach {state.approach:.4f}   force {state.force:.6f} N/mm   half width "
        f"{state.halfwidth:.3f}   {state.iterations} iterations"
        + (f", {state.cuts} cuts" if state.cuts else ""),
        flush=True,
    )


def _Parser():
    parser = CommandParser("hertz_large", __doc__)
    add = parser.add_argument
    add("--h", type=float, default=0.05, help="edge length on the slave arc, in mm")
    add("--order", type=int, choices=(2, 3), default=2, help="order of the displacement")
    add("--nu", type=float, default=0.49, help="Poisson's ratio")
    add("--friction", type=float, default=0.0, help="coefficient of friction")
    add("--depth", type=float, default=0.3, help="approach of the middle to a plate, in mm")
    add("--steps", type=int, default=30, help="number of load steps")
    add("--table", action="store_true", help="print a table of the convergence with the mesh size")
    add("--picture", metavar="PNG", help="draw states and curves into this file")
    add("--out", metavar="DIR", help="write the picture and a VTU file to this directory")
    add("--printing", action="store_true", help="print every Newton iteration")
    return parser


def main(argv=None):
    """Run the demo from the command line."""
    options = vars(_Parser().parse_args(argv))
    file, table = options.pop("json"), options.pop("table")
    results = Run(**options)
    figures = results.figures
    if table:
        fields = {key: options[key] for key in ("order", "nu", "friction", "depth", "steps")}
        figures["table"] = Table([4 * options["h"], 2 * options["h"]], **fields)
        figures["table"].append({key: figures[key] for key in ("h", "ndof")})
        for key in ("force", "energy", "halfwidth"):
            figures["table"][-1][key] = figures[key][-1]
        for row in figures["table"]:
            print("  ".join(f"{key} {value:.8g}" for key, value in row.items()))
    if file:
        WriteJSON(figures, file)
    if results.failure:
        raise SystemExit(results.failure)


if __name__ == "__main__":
    main()
