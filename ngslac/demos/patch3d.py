"""Patch test in 3D: every element shape, order and partition of the slave surface.

Two blocks (E = 2000, nu = 0.3) lie on each other with a pressure of 25 and non-matching meshes. The
stress is constant, so every method that deserves the name reproduces it up to rounding: in the
bodies as well as in the multipliers, on any interface. Start it with::

    python -m ngslac.demos.patch3d --out results

Each case is computed with a horizontal interface, and with an inclined one, irregular meshes,
another element shape below and all of it rotated. Data as in the tests SSNP170 of code_aster.
Where there are pyramids the load is computed from the volume: Gauss' theorem has an error of 1e-10
in NGSolve's pyramids.
"""

from __future__ import annotations

import time
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from ngsolve import (
    CF,
    ET,
    VOL,
    BilinearForm,
    GridFunction,
    Id,
    InnerProduct,
    IntegrationRule,
    LinearForm,
    Sym,
    Trace,
    ds,
    dx,
    specialcf,
    x,
    y,
    z,
)
from ngsolve import Grad as Gradient

from ngslac import ContactSolver, LACContact, LACSpace

from ._command import CommandParser, RunCommand
from ._patch3d_case import HELD, PARTITIONS, Case
from ._patch3d_pictures import Write
from ._pictures import Matplotlib

__all__ = ["Case", "Cases", "Results", "Run", "Solution", "Solve", "main"]

YOUNG, POISSON = 2000.0, 0.3
ELEMENTS = [(k, p) for k in ("tet", "hex", "prism", "prism_side", "pyramid") for p in (1, 2)]
ELEMENTS.insert(2, ("tet", 3))


@dataclass(frozen=True)
class Solution:
    """What `Solve` returns: NGSolve objects and the relative errors."""

    case: Case
    mesh: object
    displacement: GridFunction
    stress: object
    contact: object
    figures: dict


@dataclass(frozen=True)
class Results:
    """Outcome of `Run`: `figures` (as in the JSON file) and the table as text."""

    figures: dict
    table: str


def Stress(strain):
    """Isotropic linear elasticity."""
    mu = YOUNG / (2 * (1 + POISSON))
    return 2 * mu * (strain + POISSON / (1 - 2 * POISSON) * Trace(strain) * Id(3))


def _Constant(array):
    return CF(tuple(array.ravel()), dims=array.shape)


def _Load(case, mesh, v):
    """The work of the surface tractions outside of the interface.

    NGSolve cuts pyramids off below their apex, which makes an error of 1e-10 in Gauss' theorem and
    thus in any patch test, also without contact. With them it is computed from the volume.
    """
    stress, normal = _Constant(case.stress), specialcf.normal(3)
    if any(el.type == ET.PYRAMID for el in mesh.Elements(VOL)):
        return InnerProduct(stress, Gradient(v)) * dx - InnerProduct(stress * normal, v) * ds(
            "slave|master"
        )
    free = [name for name in mesh.GetBoundaries() if name not in ("slave", "master")]
    return InnerProduct(stress * normal, v) * ds("|".join(set(free) - set(HELD.split("|"))))


def Solve(case):
    """Solve a case and measure its errors.

    Parameters
    ----------
    case : Case

    Returns
    -------
    Solution
        ``figures`` has the largest errors of stress and multipliers relative to the largest
        component of the stress, and the numbers of displacements and macro-elements.

    Examples
    --------
    >>> from ngslac.demos.patch3d import Case, Solve
    >>> Solve(Case("hex", order=2)).figures["stress_error"] < 1e-11
    True
    """
    V = case.Space()
    Q = LACSpace(V, slave="slave")
    X = V * Q
    (u, lam), (v, _) = X.TnT()
    a = BilinearForm(X)
    a += InnerProduct(Stress(Sym(Gradient(u))), Sym(Gradient(v))) * dx
    contact = LACContact(u, lam, master="master", friction=case.friction or None)
    gf = GridFunction(X)
    strain = ((1 + POISSON) * case.stress - POISSON * np.trace(case.stress) * np.eye(3)) / YOUNG
    gf.components[0].Set(_Constant(strain) * CF((x, y, z)), definedon=V.mesh.Boundaries(HELD))
    load = LinearForm(_Load(case, V.mesh, v)).Assemble()
    ContactSolver(a, gf, contact, rhs=load.vec).Solve(tol=1e-13, printing=False)
    displacement = gf.components[0]
    stress = Stress(Sym(Gradient(displacement)))
    figures = {"name": case.name, **_Errors(case, V.mesh, stress, contact), "dofs": V.ndof}
    return Solution(case, V.mesh, displacement, stress, contact, figures)


def _Errors(case, mesh, stress, contact):
    """Largest deviations from the constant stress, in the bodies and in the multipliers."""
    points = [(0.02, 0.03, 0.05), (0.9, 0.05, 0.02), (0.31, 0.3, 0.2), (0.05, 0.1, 0.8)]
    rule = IntegrationRule(points=points, weights=[0] * len(points))
    rules = dict.fromkeys((ET.TET, ET.PYRAMID, ET.PRISM, ET.HEX), rule)
    values = stress(mesh.MapToAllElements(rules, VOL)).reshape(-1, 3, 3)
    table, size = contact.Table(), np.abs(case.stress).max()
    traction = table["traction"] - table["normal"] @ case.stress
    return {
        "stress_error": float(np.abs(values - case.stress).max() / size),
        "multiplier_error": float(np.abs(traction).max() / size),
        "macros": len(table["area"]),
    }


def Cases(friction=0.0):
    """All cases: every element and order, every partition, flat and oblique."""
    return [
        Case(element, order, partition, oblique, friction)
        for element, order in ELEMENTS
        for partition in PARTITIONS
        for oblique in (False, True)
    ]


def Run(*, out=None, quiet=True, cases=None, friction=0.0):
    """Compute the patch tests.

    Parameters
    ----------
    out : str or path, optional
        Directory for pictures and the VTU file.
    quiet : bool
        Print nothing.
    cases : list of Case, optional
        By default those of `Cases`.
    friction : float
        Coefficient of friction of the default cases.

    Returns
    -------
    Results
        With ``results.figures``, the dict that is written to the JSON file.
    """
    if out is not None:
        Matplotlib()  # complain before the work, not after it
    start = time.perf_counter()
    cases = Cases(friction) if cases is None else cases
    rows = [Solve(case).figures for case in cases]
    figures = {
        # numpy's maximum does not lose a NaN
        "max_error": float(np.max([[r["stress_error"], r["multiplier_error"]] for r in rows])),
        "cases": rows,
        "friction": friction,
        "seconds": time.perf_counter() - start,
    }
    results = Results(figures, _Table(figures))
    if not quiet:
        print(results.table)
    if out is not None:
        elements = dict.fromkeys(case.element for case in cases)
        Write([Solve(Case(e, 1, "bubble", True, friction)) for e in elements], rows, Path(out))
    return results


def _Table(figures):
    lines = [f"{'case':<34}{'dofs':>7}{'macros':>8}{'stress':>12}{'multipliers':>13}"]
    lines += [
        f"{row['name']:<34}{row['dofs']:>7}{row['macros']:>8}"
        f"{row['stress_error']:>12.1e}{row['multiplier_error']:>13.1e}"
        for row in figures["cases"]
    ]
    worst, count = figures["max_error"], len(figures["cases"])
    return "\n".join([*lines, "", f"largest relative error {worst:.1e} in {count} cases"])


def _Parser():
    parser = CommandParser("patch3d", __doc__)
    add = parser.add_argument
    add("--friction", type=float, default=0.0, help="coefficient of friction")
    add("--out", metavar="DIR", help="write pictures and a VTU file to this directory")
    return parser


def main(argv=None):
    """Run the demo from the command line."""
    RunCommand(Run, vars(_Parser().parse_args(argv)))


if __name__ == "__main__":
    main()
