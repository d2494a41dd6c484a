"""Data of the friction benchmark."""

import numpy as np
import pytest

from ngslac.reference import GRECO_SLAB


def test_converged_values_agree_with_the_published_ones():
    """Within the 5 % of the verification case; four of five within 0.5 %."""
    errors = np.abs(GRECO_SLAB.Errors(GRECO_SLAB.converged, reference="published"))
    assert (errors < 0.05).all()
    assert (np.sort(errors)[:4] < 0.005).all()
    assert (GRECO_SLAB.Errors(GRECO_SLAB.converged) == 0).all()


def test_friction_holds_the_slab_back():
    free = GRECO_SLAB.FrictionlessDisplacement(GRECO_SLAB.abscissae)
    assert (np.array(GRECO_SLAB.converged) < free).all()
    assert (np.array(GRECO_SLAB.published) < free).all()
    assert (np.diff(GRECO_SLAB.converged) < 0).all()


def test_frictionless_state_satisfies_hooke_and_the_loads():
    strain = -(
        GRECO_SLAB.FrictionlessDisplacement(GRECO_SLAB.width)
        - GRECO_SLAB.FrictionlessDisplacement(0)
    ) / (-GRECO_SLAB.width)
    sxx, syy, young, nu = -15e7, -5e7, 1.3e11, 0.2
    szz = nu * (sxx + syy)  # plane strain
    assert strain == pytest.approx((sxx - nu * (syy + szz)) / young, rel=1e-12)
    assert GRECO_SLAB.FrictionlessDisplacement(GRECO_SLAB.width) == 0


def test_zones_lie_in_order():
    slab = GRECO_SLAB
    assert 0 < slab.open_end < slab.slip_end < slab.width
    assert all(0 <= x < slab.slip_end for x in slab.abscissae)
