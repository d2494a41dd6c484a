"""Convergence (T10) to an exact solution of two-body contact, on non-matching meshes.

Theory and an independent program give, for order 1, rates 1 (H1), 2 (L2) and, for the multiplier,
0.93; for order 2, rates 3/2 (H1: multipliers are constant), above 2 and 0.93. Single halvings vary
by a third with the position of the end of contact in its macro-element. Two sequences of two
halvings each are averaged: that end lies at 1/3 of a face at the start of one, at 2/3 in the other.
For order 1 the L2 rate is 1.90 to 1.97 on these meshes and 1.92 to 1.95 on the next finer ones.
"""

from functools import lru_cache

import numpy as np
import pytest
from signorini import EXACT, Measure, Rates, Solved

SEQUENCES = [(8, 16, 32), (10, 20, 40)]
LEAST = {
    "P1": {"energy": 0.95, "l2": 1.85, "traction": 0.9, "mean": 0.9},
    "P1split": {"energy": 0.95, "l2": 1.85, "traction": 0.9, "mean": 0.9},
    "P1bubble": {"energy": 0.95, "l2": 1.85, "traction": 0.9, "mean": 0.9},
    "P2": {"energy": 1.45, "l2": 2.0, "traction": 0.9, "mean": 0.9},
}


@lru_cache
def Sequence(kind, levels):
    return [Measure(n, kind) for n in levels]


@pytest.mark.parametrize("name", ["energy", "l2", "traction", "mean"])
@pytest.mark.parametrize("kind", LEAST)
def test_rates(kind, name):
    rate = np.mean([Rates(Sequence(kind, levels), name) for levels in SEQUENCES])
    assert rate >= LEAST[kind][name]


@pytest.mark.parametrize("kind", LEAST)
def test_active_set_converges_in_few_iterations(kind):
    """The number grows slowly with the number of macro-elements, from a start without contact."""
    assert max(e.iterations for levels in SEQUENCES for e in Sequence(kind, levels)) <= 6


@pytest.mark.parametrize("kind", LEAST)
def test_end_of_contact_lies_in_the_right_macro_element(kind):
    pair, _ = Solved(20, kind)
    table = pair.contact.Table()
    x, size = table["x"][:, 0], table["fullarea"].max()
    closed = table["status"] != 0
    assert np.all(closed[x < EXACT.tip - size])
    assert not np.any(closed[x > EXACT.tip + size])
    assert np.all(table["gap"][~closed] > 0)
    assert np.all(table["pressure"][closed] > 0)
    assert np.abs(table["traction"][:, 0]).max() < 1e-13
