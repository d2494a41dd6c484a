"""The patch test with large strains on all elements, turned, with all that has to hold in it."""

import numpy as np
import pytest
from case_patch import Turn
from case_patch_large import CELLS, Solved
from elasticity import NAMES

TOL = 1e-10
AXIS = ((1.0, 2.0, -0.5), 37.0)
PROBLEMS = [(kind, None, {"quads": q, "structured": q}) for kind in NAMES for q in (False, True)]
PROBLEMS += [(kind, None, {"angle": 37}) for kind in ("P1", "P2")]
PROBLEMS += [(kind, cells, {}) for *cells, kind in CELLS]
PROBLEMS += [("P1", ("hex", "tet"), {"rotation": AXIS})]


# By default each problem has one of the laws, in turn.
LAWS = ["frictionless", "stick"]
CASES = [
    pytest.param(*problem, law, marks=() if (i + k) % 2 == 0 else pytest.mark.full)
    for i, problem in enumerate(PROBLEMS)
    for k, law in enumerate(LAWS)
]


@pytest.mark.parametrize(("kind", "cells", "options", "law"), CASES)
def test_large_strain(kind, cells, options, law):
    turn = Turn(3 if cells else 2, **options)
    problem = Solved(law, kind, cells, turn=turn, **options)
    errors = problem.Errors()
    assert max(errors.values()) <= TOL, errors
    table, blocks = problem.contact.Table(), problem.blocks
    assert set(table["status"]) == {1 if law == "stick" else 2}
    assert blocks["upper"].F[-1, -1] + blocks["lower"].F[-1, -1] == pytest.approx(1.4)
    assert abs(blocks["upper"].F[-1, -1] - blocks["lower"].F[-1, -1]) > 0.01
    assert np.all(table["pressure"] > 10)
