"""How much of a Newton step is taken, with made-up residuals."""

import numpy as np
import pytest

from ngslac.solve.globalization import Globalization
from ngslac.solve.residual import State


def state(merit, status=(1, 1), unbalance=0.0):
    status = np.array(status)
    return State(None, merit, 0.0, merit, unbalance, status, np.ones(len(status)))


def search(merit, tool=None, **flags):
    """Search with the merit as a function of the damping; also the dampings that were tried."""
    tried = []

    def move(damping):
        tried.append(damping)
        return state(merit(damping))

    best, damping = (tool or Globalization()).Search(move, **flags)
    return best, damping, tried


def test_the_full_step_is_taken_at_once_even_if_the_residual_grows():
    best, damping, tried = search(lambda part: 100.0)
    assert (best.merit, damping, tried) == (100.0, 1.0, [1.0])


def test_a_step_without_residual_is_halved_and_then_improved():
    """Parts above 0.3 have no residual; below, the shorter the better down to 1/16."""
    merit = lambda part: np.inf if part > 0.3 else abs(part - 1 / 16)  # noqa: E731
    _, damping, tried = search(merit)
    assert damping == 1 / 16
    assert tried[-1] == 1 / 16  # where the solution stays
    assert min(tried) == 1 / 32


def test_a_step_that_never_has_a_residual_is_given_up():
    best, _, tried = search(lambda part: np.inf)
    assert not best.finite
    assert len(tried) == 13


def test_dirichlet_values_take_the_longest_part_that_has_a_residual():
    _, damping, _ = search(lambda part: np.inf if part > 0.6 else part, moving=True)
    assert damping == 0.5


def damped(merit):
    """After a status came back at an iterate with this merit."""
    tool = Globalization()
    for status in ((1, 1), (2, 1), (1, 1), (2, 1)):
        tool.Watch(state(merit, status), changed=1)
    assert tool.cycles
    assert tool.damped
    return tool


def test_a_cycle_starts_a_line_search():
    _, damping, tried = search(lambda part: 2 * part, damped(1.0))
    assert damping == 0.125  # the best of four
    assert len(tried) == 4


def test_a_full_step_is_still_taken_where_it_helps():
    assert search(lambda part: 0.9, damped(1.0))[1:] == (1.0, [1.0])


def test_the_line_search_goes_far_down_where_nothing_else_helps():
    """Only a hundredth of the step lowers the residual."""
    _, damping, _ = search(lambda part: 5.0 if part > 0.01 else 1 - part, damped(1.0))
    assert damping == 2**-7


def test_status_that_returns_with_a_much_smaller_residual_is_no_cycle():
    tool = Globalization()
    for merit, status in zip((1.0, 0.1, 0.009, 0.0008), ((1, 1), (2, 1)) * 2, strict=True):
        tool.Watch(state(merit, status), changed=1)
    assert not tool.cycles


def test_a_residual_that_stays_is_damped_without_a_cycle():
    tool = Globalization()
    for _ in range(12):
        tool.Watch(state(1.0), changed=0)
    assert tool.damped
    assert not tool.cycles


@pytest.mark.parametrize(("rate", "falls"), [(0.9, True), (0.95, False), (1.0, False)])
def test_a_residual_that_falls_slowly_still_falls(rate, falls):
    tool = Globalization()
    for number in range(30):
        tool.Watch(state(rate**number), changed=0)
    assert tool.falls is falls


def test_a_contact_status_of_before_is_known():
    tool = Globalization()
    tool.Watch(state(1.0, status=(1, 2)), changed=0)
    assert tool.Knows(state(0.5, status=(1, 2)))
    assert not tool.Knows(state(0.5, status=(2, 1)))
    tool.Begin()
    assert not tool.Knows(state(0.5, status=(1, 2)))


def test_tiny_steps_in_a_row_mean_stagnation():
    tool = Globalization(patience=3)
    for part in (1e-3, 1e-3, 0.5, 1e-3, 1e-3):
        search(lambda damping, part=part: np.inf if damping > part else 1.0, tool)
        assert not tool.stagnates
    search(lambda damping: np.inf if damping > 1e-3 else 1.0, tool)
    assert tool.stagnates
    tool.Begin()
    assert not tool.stagnates


@pytest.mark.parametrize("merit", [np.nan, np.inf])
def test_a_state_without_residual_is_not_finite(merit):
    assert not state(merit).finite
