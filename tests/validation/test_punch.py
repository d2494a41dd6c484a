"""NAFEMS contact benchmark 2: the pressures up to the edge, stick inside of slip."""

import numpy as np
import pytest
from case_punch import ANGLE, EDGE, LOAD, PUBLISHED, Solved


@pytest.mark.parametrize(("friction", "middle"), [(0.0, 87.5), (0.1, 88.9)])
def test_pressure_rises_to_the_edge(friction, middle):
    """Like that of a flat punch, from 87 % of the load in the middle; it ends on the fillet."""
    solution = Solved(0.4)[friction]
    assert solution.foundation == pytest.approx(PUBLISHED[friction], rel=0.01)
    assert solution.punch == pytest.approx(solution.foundation, abs=1e-5)
    assert solution.load == pytest.approx(LOAD * 50**2 / 2 * np.sin(ANGLE), rel=1e-6)
    pressure, closed = solution.table["pressure"], solution.table["status"] > 0
    assert solution.radius[closed].max() == pytest.approx(EDGE, abs=1)
    assert np.all(np.diff(closed.astype(int)) <= 0)
    assert np.all(np.diff(pressure[closed]) > 0)
    assert pressure[0] == pytest.approx(middle, rel=0.01)


def test_friction_stiffens_as_published_and_slips_outside():
    smooth, rough = Solved(0.4).values()
    published = PUBLISHED[0.1] - PUBLISHED[0.0]
    assert rough.foundation - smooth.foundation == pytest.approx(published, rel=0.02)
    table, radius = rough.table, rough.radius
    slips, sticks = table["status"] == 2, table["status"] == 1
    assert radius[sticks].max() < radius[slips].min()
    shear = table["traction"] + table["pressure"][:, None] * table["normal"]
    size = np.linalg.norm(shear, axis=1)
    np.testing.assert_allclose(size[slips], 0.1 * table["pressure"][slips], rtol=1e-9)
    # The foundation moves inwards under the stiffer punch, and pulls it along.
    assert np.all(shear[slips, 0] < 0)
    # Nothing acts across the sector, but for its flat faces.
    middle = np.array([-np.sin(ANGLE / 2), np.cos(ANGLE / 2), 0])
    assert np.abs(shear @ middle).max() <= 1e-3 * size.max()
