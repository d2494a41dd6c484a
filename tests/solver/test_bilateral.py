"""Contact without separation: what slides, but does not come off."""

import numpy as np
import pytest
from finitepress import Led, blocks2d, blocks3d
from law import shear
from loaded import loaded
from motions import two_bars
from obstacles import block_on_obstacle
from press import mixed_press, numpy, press, same, solved

from ngslac import FloatingBodyError


def check_guide(contact, tol=1e-9):
    """Gap zero, friction against the slip and bounded by the size of the pressure."""
    t = contact.Table()
    t = {name: values[t["area"] > 0] for name, values in t.items()}
    p, size = np.abs(t["pressure"]).max(), t["fullarea"].max()
    assert np.all(t["status"] > 0)
    assert np.abs(t["gap"]).max() < tol * size
    bound = np.maximum(t["friction"], 0) * np.abs(t["pressure"])
    along = np.linalg.norm(shear(t), axis=1)
    slip = t["status"] == 2
    assert np.all(along <= bound + tol * p)
    assert along[slip] == pytest.approx(bound[slip], abs=tol * p)
    assert np.abs(t["slip"][~slip]).max(initial=0) < tol * size
    assert np.all(np.sum(shear(t) * t["slip"], axis=1)[slip] <= tol * p * size)


@pytest.mark.parametrize("law", [{}, {"friction": 0.3}, {"tresca": 0.05}], ids=str)
@pytest.mark.parametrize("dim", [2, 3])
def test_pulling_is_pressing_with_the_other_sign(dim, law):
    push = np.array({2: (0.02, -0.02), 3: (0.02, 0.01, -0.02)}[dim])
    pressed, pulled = (
        press(dim=dim, push=tuple(map(float, s * push)), bilateral=True, **law) for s in (1, -1)
    )
    for problem in (pressed, pulled):
        solved(problem)
    u, opposite = (numpy(p.gf.components[0]) for p in (pressed, pulled))
    assert u == pytest.approx(-opposite, abs=1e-9 * np.abs(u).max())
    assert pulled.contact.Force() == pytest.approx(-pressed.contact.Force(), rel=1e-8)
    assert pulled.contact.Table()["pressure"].mean() < 0
    if "tresca" not in law:
        check_guide(pulled.contact)


@pytest.mark.parametrize("dim", [2, 3])
@pytest.mark.parametrize("finite", [False, True])
def test_where_all_is_pressed_it_is_contact(dim, finite):
    """Blocks of which the upper one is smaller: all of it is pressed."""
    law = {"dim": dim, "friction": 0.2, "finite": finite, "push": (0,) * (dim - 1) + (-0.05,)}
    one, two = press(**law), press(bilateral=True, **law)
    for problem in (
        one,
        two,
    ):  # on ways of their own: of the first slip rounding tells the direction
        problem.solver().Solve(tol=1e-13, printing=False)
    assert one.contact.Table()["pressure"].min() > 0
    same(two, one)


@pytest.mark.parametrize("solver", ["direct", "iterative"])
@pytest.mark.parametrize("dim", [2, 3])
def test_all_linear_solvers_find_it(dim, solver):
    """Turned at its top, the block presses on one side and pulls on the other."""
    one, two = (mixed_press(dim=dim, bilateral=True) for _ in range(2))
    solved(one, solver=solver), solved(two)
    same(one, two, 1e-8)
    check_guide(one.contact)
    pressure = one.contact.Table()["pressure"]
    assert pressure.min() < 0 < pressure.max()
    assert {1, 2} <= set(one.contact.Table()["status"])


def test_a_guide_holds_along_the_normal_only():
    """A load that pulls is held, and one that pushes aside is not."""
    held = loaded(0, 1, bilateral=True)
    held.solver().Solve(printing=False)
    assert held.contact.Force()[1] == pytest.approx(-1, rel=1e-9)
    with pytest.raises(FloatingBodyError, match=r"'upper' floats \(translation in x\)"):
        loaded(0.1, 1, bilateral=True).solver().Solve(printing=False)
    with pytest.raises(FloatingBodyError):
        loaded(0, 1).solver().Solve(printing=False)


def test_a_guide_jams():
    """What turns a body in its guide presses and pulls: that rubs, whatever the resultant is."""
    problem = loaded(0.5, 0, bilateral=True, friction=0.6)
    problem.solver().Solve(printing=False)
    check_guide(problem.contact)
    assert problem.contact.Force() == pytest.approx([-0.5, 0], abs=1e-9)


def test_on_an_obstacle():
    """A block hung from a plane: the pressure is minus the traction."""
    problem = block_on_obstacle(0.0, traction=(0.0, 1.0), bilateral=True)
    problem.solver().Solve(printing=False)
    assert problem.contact.Table()["pressure"] == pytest.approx(-1, abs=1e-11)


@pytest.mark.parametrize("offset", [0.01, -0.02])
def test_with_an_offset(offset):
    """The gap that is kept is that with the offset."""
    problem = block_on_obstacle(0.0, traction=(0.0, 1.0), bilateral=True, offset=offset)
    problem.solver().Solve(printing=False)
    assert problem.contact.Table()["gap"] == pytest.approx(0, abs=1e-12)
    u = problem.gf.components[0](problem.mesh(0.5, 0.0))
    assert u[1] == pytest.approx(-offset, abs=1e-12)


LEADS = {
    2: (lambda: blocks2d(0.15), lambda t: (0.25 * t, 0.08 * t), 2),
    3: (lambda: blocks3d("hex", "tet"), lambda t: (0.2 * t, 0.1 * t, 0.06 * t), 1),
}


@pytest.mark.parametrize("friction", [None, 0.2])
@pytest.mark.parametrize("dim", LEADS)
def test_large_sliding_while_it_is_pulled(dim, friction):
    make, lead, order = LEADS[dim]
    problem = Led(make(), lead, order=order, bilateral=True, friction=friction)
    problem.run(steps=4)
    check_guide(problem.contact)
    assert problem.contact.Table()["pressure"].mean() < 0
    # Frictionless it slides freely but for the facets of bent surfaces.
    tangent, normal = np.linalg.norm(problem.contact.Force()[:-1]), problem.contact.Force()[-1]
    assert tangent == pytest.approx((friction or 0) * abs(normal), abs=0.05 * abs(normal))


def test_newtons_method_is_quadratic():
    problem = Led(blocks2d(0.2), lambda t: (0.1 * t, 0.1 * t), bilateral=True)
    problem.solve(1.0, tol=1e-13)
    sizes = [max(e.equilibrium, e.constraint) for e in problem.solver.history]
    assert sizes[-1] < 100 * sizes[-2] ** 2 + 1e-13
    assert len(sizes) < 9


@pytest.mark.full
def test_two_bars_that_meet_stay_together():
    """What hits without separation sticks; energy is lost in the impact, never won."""
    motion = two_bars(gap=0.0, bilateral=True)
    motion.run(4.0)
    gap = motion.contact.Table()["gap"]
    assert gap == pytest.approx(0, abs=1e-10)
    velocity = [motion.mean(motion.stepper.velocity, body)[1] for body in ("upper", "lower")]
    losses = np.diff([step.balance.impact for step in motion.stepper.steps])
    assert np.all(losses >= -1e-13)
    assert sum(velocity) == pytest.approx(-1, rel=1e-9)
