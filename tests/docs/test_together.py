"""What works together: the table of docs/limits.md, each of its cells tried."""

from pathlib import Path

import numpy as np
import pytest
from netgen.meshing import NgException
from ngsolve import CF, Id, IfPos, Norm, Sym, Trace, exp
from press import LAME, MU, press, solved

from ngslac import AugmentedLagrangianSolver, Law, LoadStepper, TimeStepper, tools
from ngslac.analysis import Modes, ResidualEstimate, Sensitivity

LIMITS = Path(__file__).resolve().parents[2] / "docs" / "limits.md"
FLOOR = {2: ((0, 0), (0, 1)), 3: ((0, 0, 0), (0, 0, 1))}


def table():
    """Rows and columns of its cells, and what they say."""
    lines = [line for line in LIMITS.read_text().splitlines() if line.startswith("|")]
    head, _, *rows = ([cell.strip() for cell in line.strip("|").split("|")] for line in lines)
    return {
        (row[0], name): cell for row in rows for name, cell in zip(head[1:], row[1:], strict=True)
    }


def surroundings(column, dim):
    """What the block is pressed on."""
    return {
        "small sliding": {},
        "large sliding": {"finite": True},
        "gap function": {"master": None, "obstacle": CF(0.0)},
        "tool": {"master": None, "obstacle": tools.Plane(*FLOOR[dim]), "finite": True},
    }[column]


def spring(places):
    return {"traction": places["gap"][:, None] * places["normal"], "by_gap": places["normal"]}


LAWS = {
    "no friction": {},
    "Coulomb's friction": {"friction": 0.3},
    "Tresca's friction": {"tresca": 0.5},
    "tied": {"tied": True},
    "without separation": {"bilateral": True},
    "a law of your own (`law`)": {"law": spring},
    "a law as an expression (`Law`)": {"law": Law(lambda z: IfPos(z.gap, 0, z.gap) * z.normal)},
    "clearance (`offset`)": {"offset": 0.001},
    "functions of the fields (`friction`, `tresca`, `offset`)": {
        "friction": lambda z: 0.2 + 0.1 * exp(-Norm(z.rate)),
        "tresca": lambda z: 0.5 + 0.1 * z.pressure,
        "offset": lambda z: z.History("worn", lambda w: w + 1e-3 * z.pressure * Norm(z.slip)),
    },
    "heat through contact (`flux`)": {"flow": lambda z, T: z.pressure * z.Slave(T)},
    "adjusted start": {"adjust": 0.01},
    "sharp edges (`edges`)": {"edges": True},
    "self-contact": {"master": "slave|master"},
}


def off_and_on(problem):
    solved(problem)
    problem.contact.Deactivate()
    solved(problem)
    assert not np.any(problem.contact.Table()["status"])
    problem.gf.vec[:] = 0
    problem.contact.Activate(problem.gf)
    solved(problem)


def recovered(problem):
    solved(problem)
    assert problem.contact.Recovered().pressure is not None


def estimated(problem):
    solver, push = solved(problem), problem.load * CF(problem.push)
    springs = {"top": -1000 * (problem.gf.components[0] - push)}
    found = ResidualEstimate(
        solver, lambda H: 2 * MU * Sym(H) + LAME * Trace(H) * Id(H.dims[0]), tractions=springs
    )
    assert 0 < found.relative < 1


def differentiated(problem):
    solver = solved(problem)
    assert np.any(Sensitivity(solver, problem.contact.Force).By(problem.load))


def vibrating(problem):
    assert np.all(Modes(solved(problem), density=1.0, count=2).frequencies > 0)


USES = {
    "`LoadStepper`": lambda p: LoadStepper(p.solver(), p.load).Integrate(2, printing=False),
    "`TimeStepper`": lambda p: TimeStepper(p.solver(), 1.0, dt=0.05).Integrate(0.2, printing=False),
    "`AugmentedLagrangianSolver`": lambda p: AugmentedLagrangianSolver(p.a, p.gf, p.contact).Solve(
        printing=False
    ),
    "switched off and on": off_and_on,
    "recovered pressure": recovered,
    "estimates and `Adapt`": estimated,
    "`Sensitivity`": differentiated,
    "`Modes`": vibrating,
}


def run(row, column, dim):
    given = {"dim": dim, "push": (0.002, -0.01) if dim == 2 else (0.002, 0.001, -0.01)}
    given |= {"friction": 0.3} if row in USES else LAWS[row]
    given = surroundings(column, dim) | given
    problem = press(nonlinear=given.get("finite", False), **given)
    problem.push = given["push"]
    if row in USES:
        USES[row](problem)
    else:
        solved(problem)
    assert np.any(problem.contact.Table()["status"])
    if "flow" in given:
        assert problem.contact.Flow()[0] > 1e-3


# Laws differ in 3D and are tested there; their uses are so with small sliding alone by default.
LONG = [(row, column) for row, column in table() if row in USES and column != "small sliding"]
CELLS = [(*cell, 2) for cell in table()]
CELLS += [pytest.param(*c, 3, marks=pytest.mark.full if c in LONG else ()) for c in table()]


@pytest.mark.parametrize(("row", "column", "dim"), CELLS)
def test_cells(row, column, dim):
    if table()[row, column] == "yes":
        run(row, column, dim)
        return
    with pytest.raises((ValueError, TypeError, NgException)):
        run(row, column, dim)


def test_all_is_in_the_table():
    assert {row for row, _ in table()} == {*LAWS, *USES}
