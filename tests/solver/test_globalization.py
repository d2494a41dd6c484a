"""How much of a Newton step is taken, with made-up residuals."""

import numpy as np
import pytest
from ngsolve import (
    VectorH1,
    ds,
)
from posed import elastic, posed

from ngslac.meshes import HertzMesh
from ngslac.solve.globalization import Globalization
from ngslac.solve.residual import Measurement

INF = np.inf


def state(merit, status=(1, 1)):
    status = np.array(status)
    return Measurement(None, merit, 0.0, merit, 0.0, status, *np.ones((2, len(status))))


def watched(*steps, changed=0):
    """After iterates with these merits and statuses."""
    tool = Globalization()
    for step in steps:
        tool.Watch(state(*step), changed=changed)
    return tool


def back_and_forth(*merits):
    """A status that comes back, after another one."""
    statuses = ((1, 1), (2, 1)) * 2
    return watched(*zip(merits, statuses, strict=True), changed=1)


def search(merit, tool=None, **flags):
    """The best merit as a function of the damping, its damping, and those that were tried."""
    tried = []

    def move(damping):
        tried.append(damping)
        return state(merit(damping))

    best, damping = (tool or Globalization()).Search(move, **flags)
    return best.merit, damping, tried


CYCLE = (1.0,) * 4


@pytest.mark.parametrize(
    ("merit", "cycles", "damping", "tried"),
    [
        (lambda part: 100.0, False, 1.0, 1),  # at once, even if the residual grows
        # Halved until there is a residual, then the shorter the better down to 1/16.
        (lambda part: INF if part > 0.3 else abs(part - 1 / 16), False, 1 / 16, 6),
        (lambda part: INF, False, None, 13),  # given up
        # A status came back: a line search.
        (lambda part: 2 * part, True, 0.125, 4),
        (lambda part: 0.9, True, 1.0, 1),  # it helps as it is
        (lambda part: 5.0 if part > 0.01 else 1 - part, True, 2**-7, None),  # far down
    ],
)
def test_part_of_a_step(merit, cycles, damping, tried):
    best, found, dampings = search(merit, back_and_forth(*CYCLE) if cycles else None)
    assert tried is None or len(set(dampings)) == tried
    if damping is None:
        assert best == INF
    else:
        assert (best, found) == (merit(damping), damping)
        assert dampings[-1] == damping or cycles  # where the solution stays


def test_dirichlet_values_take_the_longest_part_that_has_a_residual():
    assert search(lambda part: INF if part > 0.6 else part, moving=True)[1] == 0.5


def test_cycles_and_what_falls():
    assert back_and_forth(*CYCLE).cycles
    assert back_and_forth(*CYCLE).damped
    assert not back_and_forth(1.0, 0.1, 0.009, 0.0008).cycles  # much smaller when it returns
    stays = watched(*[(1.0,)] * 12)
    assert stays.damped
    assert not stays.cycles
    falls = [watched(*((rate**k,) for k in range(30))).falls for rate in (0.9, 0.95, 1.0)]
    assert falls == [True, False, False]


def test_a_contact_status_of_before_is_known():
    tool = watched((1.0, (1, 2)))
    assert tool.Knows(state(0.5, status=(1, 2)))
    assert not tool.Knows(state(0.5, status=(2, 1)))
    tool.Begin()
    assert not tool.Knows(state(0.5, status=(1, 2)))


def test_tiny_steps_in_a_row_mean_stagnation():
    tool = Globalization(patience=3)
    found = []
    for part in (1e-3, 1e-3, 0.5, 1e-3, 1e-3, 1e-3):
        search(lambda damping, part=part: INF if damping > part else 1.0, tool)
        found.append(tool.stagnates)
    assert found == [False] * 5 + [True]
    tool.Begin()
    assert not tool.stagnates


@pytest.mark.parametrize(("share", "lost"), [(1.0, False), (0.6, False), (0.4, True), (0.0, True)])
def test_surfaces_that_pass_through_each_other_lose_their_partners(share, lost):
    before, after = state(1.0), state(1.0)
    before.covered[:] = 0.5, 1.0
    after.covered[:] = 0.5, share
    assert after.LostSight(before, moved=1.0) == lost
    assert not after.LostSight(before, moved=0.4)  # the partner was farther away: it turned


def test_a_state_without_residual_is_not_finite():
    assert not state(np.nan).finite
    assert not state(INF).finite


def test_the_start_of_a_prescribed_motion_is_no_small_residual():
    """Before Dirichlet values have moved nothing is out of balance: that says nothing of later."""
    merits = [0.0, *np.geomspace(1, 1e-2, 12)]
    tool = Globalization()
    for number, merit in enumerate(merits):
        tool.Watch(state(merit), changed=0, moving=number == 0)
    assert tool.falls
    assert not tool.damped
    assert not watched(*((merit,) for merit in merits)).falls


@pytest.mark.parametrize(
    ("changed", "leaps"),
    [((0, 90, 70, 80), True), ((0, 90, 70, 10), False), ((90, 80), False), ((0, 9, 7, 8), False)],
)
def test_a_status_that_is_another_one_each_time_leaps(changed, leaps):
    tool = Globalization()
    for number in changed:
        tool.Watch(state(1.0, np.zeros(100)), changed=number)
    assert tool.leaps == leaps


def test_a_finely_meshed_roll_starts_from_a_part_of_the_step():
    """The whole one closes nearly all, and takes a step for each ring that has to open again."""
    V = VectorH1(HertzMesh(0.1, grading=0.6), order=2, dirichletx="bottom|sym", dirichlety="bottom")
    problem = posed(V, elastic(2500, 0.25), lambda u, v, load: 2 * v[1] * ds("arc"))
    assert problem.solver().Solve(printing=False).number <= 7
