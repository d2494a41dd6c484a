"""The GRECO slab: all spaces in 2D and 3D, Coulomb's law, steps and units."""

from functools import cache

import numpy as np
import pytest
from case_slab import SLICE, Solve
from exact_slab import GRECO_SLAB

PLANE = ["P1", "P1split", "P1bubble", "P2"]  # P1 has macro-elements of two faces
SLICES = ["hex P2", "tet P2", "prism P2", "hex P1bubble", "prism_side P1split"]
ZONES = OPEN, SLIP, STICK = 0, 2, 1  # in their order along x

Solved = cache(Solve)


@pytest.fixture(params=[*PLANE, *SLICES], scope="module")
def name(request):
    return request.param


def test_displacements_agree_with_the_converged_ones(name):
    solution = Solved(name)
    errors = GRECO_SLAB.Errors(solution.displacement)
    assert np.abs(errors).max() <= (3e-3 if name in SLICES else 5e-3)
    # The slice is plane: exactly so on cells that do not change across it.
    size = np.abs(solution.displacement).max()
    tolerance = 1e-12 if name.startswith("hex") else 1e-3
    assert np.abs(solution.across - solution.displacement).max() <= tolerance * size


def test_zones_are_open_slip_stick_with_ends_within_one_macro_element(name):
    table = Solved(name).table
    status, x = table["status"], table["x"][:, 0]
    assert np.all(np.diff([ZONES.index(s) for s in status]) >= 0)
    assert set(status) == set(ZONES)
    ends = (OPEN, SLIP, GRECO_SLAB.open_end), (SLIP, STICK, GRECO_SLAB.slip_end)
    for before, after, end in ends:
        last, first = x[status == before].max(), x[status == after].min()
        assert last - (first - last) / 2 <= end <= first + (first - last) / 2


def test_contact_carries_the_top_pressure_within_the_friction_bound(name):
    solution, table = Solved(name), Solved(name).table
    top = GRECO_SLAB.top_pressure * GRECO_SLAB.width * (SLICE if name in SLICES else 1)
    assert solution.force[-1] == pytest.approx(top, rel=1e-10 if name in PLANE else 1e-9)
    small = 1e-9 * GRECO_SLAB.top_pressure
    assert table["pressure"].min() >= -small
    size = np.linalg.norm(table["traction"][:, :-1], axis=1)
    bound = GRECO_SLAB.friction * table["pressure"]
    slips, sticks, opens = (table["status"] == s for s in (SLIP, STICK, OPEN))
    np.testing.assert_allclose(size[slips], bound[slips], atol=small)
    assert np.all(size[sticks] <= bound[sticks] + small)
    # The side pressure drives the slab along +x, friction acts along -x.
    assert np.all(table["slip"][slips, 0] > 0)
    assert np.all(table["traction"][slips, 0] < 0)
    assert np.all(table["gap"][opens] > 0)


@pytest.mark.parametrize("space", ["P2", "hex P1bubble"])
def test_several_steps_give_the_same_as_one(space):
    """Without an initial gap the solution is proportional to the load."""
    one, more = Solved(space), Solve(space, steps=3)
    np.testing.assert_allclose(more.displacement, one.displacement, rtol=1e-8)
    np.testing.assert_array_equal(more.table["status"], one.table["status"])


@pytest.mark.parametrize("space", ["P2", "hex P1bubble"])
def test_millimetres_and_megapascals_give_the_same_as_si_units(space):
    """Also iteration by iteration: nothing in the method has an absolute size."""
    si, mm = Solved(space), Solve(space, length=1e3, stress=1e-6)
    np.testing.assert_allclose(mm.displacement, si.displacement, rtol=1e-9)
    size = 1e-9 * GRECO_SLAB.top_pressure
    np.testing.assert_allclose(mm.table["pressure"] * 1e6, si.table["pressure"], atol=size)
    assert mm.iterations == si.iterations
