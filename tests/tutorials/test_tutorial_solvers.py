"""Tutorial 09, solvers, runs, and what it computes is right."""

import numpy as np
import pytest
from notebooks import Errors, Execute, Pictures

pytestmark = pytest.mark.slow

VALUES = """
lines = {
    name: [[i.equilibrium, i.constraint, i.changed, i.open, i.stick, i.slip] for i in entries]
    for name, entries in history.items()
}
VALUES = dict(
    bulk=values_bulk, saddle=values_saddle, condensed=values_condensed, difference=difference,
    choice=choice, lines=lines, outer=augmented.outer, distance=distance, runs=runs[1:4],
    counts=[run[1:2] + run[3:] for run in runs if run[1] != "elastic"], fill=fill, krylov=krylov,
    pairing=pairing, bulk_time=spent["Assemble Linearization"], stock=stock_difference,
    force=contact.Force(), nmacros=contact.space.nmacros,
)
"""


@pytest.fixture(scope="module")
def solvers():
    return Execute("09_solvers", VALUES)


def test_no_errors_and_pictures(solvers):
    _, outputs = solvers
    assert not Errors(outputs)
    assert Pictures(outputs) == 4


def test_saddle_point_is_indefinite(solvers):
    """One negative eigenvalue for each multiplier."""
    values, _ = solvers
    assert values["bulk"].min() > 0
    multipliers = len(values["saddle"]) - len(values["bulk"])
    assert np.sum(values["saddle"] < 0) == multipliers > 0


def test_condensed_is_definite_and_well_conditioned(solvers):
    values, _ = solvers
    condensed, bulk = values["condensed"], values["bulk"]
    assert len(bulk) - len(condensed) == len(values["saddle"]) - len(bulk)
    assert condensed[0] > 0
    assert condensed[-1] / condensed[0] < 3 * bulk[-1] / bulk[0]


def test_condensation_is_exact(solvers):
    assert solvers[0]["difference"].max() < 1e-10


def test_choice_is_explained(solvers):
    assert "condensed" in solvers[0]["choice"]
    assert "free dofs in 3D" in solvers[0]["choice"]


def test_iterations(solvers):
    """Quadratic at the end, all three statuses, and nothing changes any more."""
    values, _ = solvers
    lines = values["lines"]["friction"]
    _, constraint, changed, *counts = lines.T
    assert len(lines) <= 9
    assert changed[-1] == 0
    assert constraint[-1] < 1e-10
    assert constraint[-1] < 1e-2 * constraint[-2] < 1e-4 * constraint[-3] < 1
    assert np.sum(counts, axis=0).tolist() == [values["nmacros"]] * len(lines)
    assert min(count[-1] for count in counts) >= 1


def test_contact_carries_the_load(solvers):
    np.testing.assert_allclose(solvers[0]["force"], [-0.8, -0.3, 4], rtol=1e-9, atol=1e-9)


def test_other_solvers_find_the_same(solvers):
    values, _ = solvers
    assert values["distance"] < 1e-8  # augmented Lagrangian
    assert values["outer"] > 1
    assert len(values["lines"]["augmented Lagrangian, friction"]) > len(values["lines"]["friction"])
    assert values["stock"] < 1e-9  # NGSolve's Newton


def test_ways(solvers):
    """What is factored, and what is iterated."""
    counts = solvers[0]["counts"].tolist()
    assert len(counts) == 9
    for way, factorisations, krylov in counts:
        assert (int(factorisations) == 0) == (way == "iterative")
        assert (int(krylov) == 0) == (way == "saddle")


def test_fill(solvers):
    """The condensed factor is much smaller than that of the saddle point, the vertices' tiny."""
    fill = solvers[0]["fill"]
    assert fill["condensed"] < 0.5 * fill["saddle point"]
    assert fill["condensed"] < 2 * fill["elastic"]
    assert fill["vertices"] < 0.05 * fill["elastic"]


def test_two_levels_need_fewer_iterations(solvers):
    krylov = solvers[0]["krylov"]
    assert 3 * krylov["two levels"] < krylov["Gauss-Seidel"]


def test_timers_know_the_phases(solvers):
    values, _ = solvers
    assert values["pairing"] > 0
    assert values["bulk_time"] > 0
