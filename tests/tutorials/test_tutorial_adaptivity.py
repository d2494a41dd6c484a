"""Tutorial 16, errors and meshes that follow them, runs and keeps what its text says."""

import numpy as np
from notebooks import Tutorial

adaptivity = Tutorial("16_adaptivity", """
VALUES = dict(
    message=message, iterations=iterations, rate=rate, rate_even=rate_even, factor=factor,
    last=steps[-1].relative, rows=rows, error=error, error_even=error_even,
    fine=fine.gf.space.ndof, off=off, counts=counts,
)
""", pictures=1)  # fmt: skip


def test_wrong_loads_are_seen(adaptivity):
    assert "unbalanced" in adaptivity.message


def test_rates(adaptivity):
    assert adaptivity.last <= 0.01
    assert adaptivity.iterations <= 2
    assert -0.85 < adaptivity.rate_even < -0.6
    assert adaptivity.rate < -0.95
    assert 1.5 < adaptivity.factor < 6


def test_the_size_of_the_contact(adaptivity):
    dofs, errors, estimates = adaptivity.rows.T
    assert adaptivity.error < 1e-3 < adaptivity.error_even
    assert dofs[-1] < adaptivity.fine / 10
    assert np.all(np.abs(errors[3:]) < estimates[3:])


def test_load_steps(adaptivity):
    assert adaptivity.off < 0.05
    assert np.all(np.diff(adaptivity.counts) >= 0)
