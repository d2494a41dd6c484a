"""Tutorial 09, solvers, runs, and what it computes is right."""

import numpy as np
from notebooks import Tutorial

solvers = Tutorial("09_solvers", """
lines = {
    name: [[i.equilibrium, i.constraint, i.changed, i.open, i.stick, i.slip] for i in entries]
    for name, entries in history.items()
}
VALUES = dict(
    bulk=values_bulk, saddle=values_saddle, condensed=values_condensed, difference=difference,
    choice=choice, lines=lines, outer=augmented.outer, distance=distance, runs=runs[1:4],
    counts=[run[1:2] + run[3:] for run in runs if run[1] != "elastic"], fill=fill, krylov=krylov,
    pairing=pairing, bulk_time=spent["Matrix assembling"], stock=stock_difference,
    force=contact.Force(), nmacros=contact.space.nmacros,
)
""", pictures=4)  # fmt: skip


def test_systems(solvers):
    """The saddle point is indefinite, the condensed system is definite, and exact."""
    bulk, condensed = solvers.bulk, solvers.condensed
    multipliers = len(solvers.saddle) - len(bulk)
    assert bulk.min() > 0
    assert np.sum(solvers.saddle < 0) == multipliers == len(bulk) - len(condensed) > 0
    assert condensed[0] > 0
    assert condensed[-1] / condensed[0] < 3 * bulk[-1] / bulk[0]
    assert solvers.difference.max() < 1e-10
    assert "on the interface" in solvers.choice
    assert "free dofs in 3D" in solvers.choice


def test_iterations(solvers):
    """Quadratic at the end, all three statuses, and nothing changes any more."""
    lines = solvers.lines["friction"]
    _, constraint, changed, *counts = lines.T
    assert len(lines) <= 9
    assert changed[-1] == 0
    assert constraint[-1] < 1e-10
    assert constraint[-1] < 1e-2 * constraint[-2] < 1e-4 * constraint[-3] < 1
    assert np.sum(counts, axis=0).tolist() == [solvers.nmacros] * len(lines)
    assert min(count[-1] for count in counts) >= 1
    np.testing.assert_allclose(solvers.force, [-0.8, -0.3, 4], rtol=1e-9, atol=1e-9)


def test_other_solvers_find_the_same(solvers):
    assert solvers.distance < 1e-8  # augmented Lagrangian
    assert solvers.outer > 1
    assert len(solvers.lines["augmented Lagrangian, friction"]) > len(solvers.lines["friction"])
    assert solvers.stock < 1e-9  # NGSolve's Newton


def test_what_is_factored_and_what_is_iterated(solvers):
    assert len(solvers.counts) == 9
    for way, factorisations, krylov in solvers.counts.tolist():
        assert (int(factorisations) == 0) == (way == "iterative")
        assert (int(krylov) == 0) == (way != "iterative")
        assert way != "interface" or int(factorisations) == 1
    # The condensed factor is much smaller than that of the saddle point, the vertices' tiny.
    fill, krylov = solvers.fill, solvers.krylov
    assert fill["condensed"] < 0.5 * fill["saddle point"]
    assert fill["condensed"] < 2 * fill["elastic"]
    assert fill["vertices"] < 0.05 * fill["elastic"]
    assert 3 * krylov["two levels"] < krylov["Gauss-Seidel"]
    assert min(solvers.pairing, solvers.bulk_time) > 0  # timers
