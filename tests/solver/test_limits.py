"""What friction cannot carry, what nothing holds at the start, and what overlaps there."""

import numpy as np
import pytest
from ngsolve import CF, InnerProduct, ds, dx
from press import numpy, press

from ngslac import ContactConvergenceError, FloatingBodyError, LoadStepper


def pushed(side, *, gap=0.0, traction=-1.0, **flags):
    """A block on another one, held by contact alone, pressed down and pushed by load * side."""
    problem = press(**{"spring": 0, "friction": 0.5} | flags)
    v = problem.X.TestFunction()[0]
    problem.a += -InnerProduct(CF((side * problem.load, traction)), v) * ds("top")
    problem.load.Set(0.0)
    shape = problem.gf.components[0]
    shape.Set(problem.mesh.MaterialCF({"upper": CF((0, gap))}, default=CF((0, 0))))
    return problem


def test_a_load_beyond_friction_is_named():
    """The load grows to twice what friction carries: stepping ends there, and says why."""
    problem = pushed(0.2, friction=0.1)
    stepper = LoadStepper(problem.solver(), problem.load)
    with pytest.raises(ContactConvergenceError) as error:
        stepper.Integrate(steps=10, printing=False)
    text = str(error.value)
    assert "the step from load 0.5 to 0.6 fails: no equilibrium: body 'upper' slides away" in text
    assert "towards +x): friction is at its limit" in text
    limit = 0.5
    assert limit - 0.1 / 2**8 <= problem.load.Get() <= limit + 1e-9
    assert problem.contact.Force()[0] == pytest.approx(-0.2 * problem.load.Get(), rel=1e-8)


def test_a_long_step_beyond_the_limit_says_where_that_is():
    """What fails is the load at its end: shorter steps go on to the limit at 0.5."""
    problem = pushed(0.2, friction=0.1)
    stepper = LoadStepper(problem.solver(), problem.load)
    with pytest.raises(
        ContactConvergenceError, match=r"the step from load .* to .* fails"
    ) as error:
        stepper.Integrate(steps=3, printing=False)
    assert "no step beyond" not in str(error.value)
    assert str(error.value).endswith("; up to a load of 0.5 there is one")
    reached = problem.load.Get()
    assert reached < 0.49
    stepper.Integrate(0.49, steps=1, printing=False)
    assert problem.contact.Force()[0] == pytest.approx(-0.2 * 0.49, rel=1e-8)


def test_the_limit_is_not_approached_by_hundreds_of_attempts():
    problem = pushed(0.2, friction=0.1)
    solver, attempts = problem.solver(), []
    solve = solver.Solve
    solver.Solve = lambda **flags: (attempts.append(1), solve(**flags))[1]
    with pytest.raises(ContactConvergenceError):
        LoadStepper(solver, problem.load).Integrate(steps=1, printing=False)
    assert len(attempts) < 25


@pytest.mark.pairwise
@pytest.mark.parametrize("h", [0.26, 0.35])
@pytest.mark.parametrize("gap", [0.0, 0.02, 0.2])
@pytest.mark.parametrize("friction", [0.2, 1.5])
def test_three_or_four_macro_elements_hold_a_body(h, gap, friction):
    """T23: a rigid start from a gap, above an elastic block, in one step."""
    problem = pushed(0.1, friction=friction, gap=gap, mesh_flags={"h_master": 0.2}, h=h)
    assert 3 <= problem.contact.space.nmacros <= 4
    steps = LoadStepper(problem.solver(), problem.load).Integrate(steps=1, printing=False)
    assert sum(s.cuts for s in steps) == 0
    assert problem.contact.Force() == pytest.approx([-0.1, 1], abs=1e-9)
    assert np.all(problem.contact.Table()["gap"] > -1e-9)


@pytest.mark.parametrize("friction", [0.2, 1.5])
def test_a_rigid_plane_holds_a_body(friction):
    """T23 on an obstacle: nothing but contact with a rigid plane below a gap."""
    problem = pushed(
        0.1,
        friction=friction,
        h=0.35,
        master=None,
        obstacle=CF(0.05),
        flags={"dirichlet": "bottom"},
    )
    LoadStepper(problem.solver(), problem.load).Integrate(steps=1, printing=False)
    assert problem.contact.Force() == pytest.approx([-0.1, 1], abs=1e-9)


def test_without_friction_nothing_holds_it_sideways():
    problem = pushed(0.1, friction=None)
    with pytest.raises(FloatingBodyError, match=r"translation in x"):
        LoadStepper(problem.solver(), problem.load, maxcuts=2).Integrate(steps=1, printing=False)


@pytest.mark.parametrize("friction", [None, 0.4])
@pytest.mark.parametrize("finite", [False, True])
def test_an_initial_penetration_is_resolved(friction, finite):
    """The bodies overlap at the start: contact drives them apart, as from any start value."""
    problem = press(friction=friction, spring=1e3, push=(0, -0.05), finite=finite)
    problem.gf.components[0].Set(
        problem.mesh.MaterialCF({"upper": CF((0, -0.05))}, default=CF((0, 0)))
    )
    problem.solver().Solve(printing=False)
    reference = press(friction=friction, spring=1e3, push=(0, -0.05), finite=finite)
    reference.solver().Solve(printing=False)
    assert np.all(problem.contact.Table()["gap"] > -1e-9)
    assert problem.contact.Force()[1] == pytest.approx(reference.contact.Force()[1], rel=1e-8)


def test_a_linear_bulk_is_assembled_once(monkeypatch):
    """Also after steps whose last correction is no more than rounding."""
    problem = press(friction=0.5)
    problem.load.Set(0.0)
    solver = problem.solver()
    assembled = []
    assemble = problem.a.AssembleLinearization
    solver.bulk.a = type("Bulk", (), {
        "AssembleLinearization": lambda self, vec: (assembled.append(1), assemble(vec))[1],
        "__getattr__": lambda self, name: getattr(problem.a, name),
    })()  # fmt: skip
    LoadStepper(solver, problem.load).Integrate(steps=6, printing=False)
    assert len(assembled) == 1


def test_a_bulk_that_is_linear_at_first_is_assembled_again():
    """Small loads do not hide that a bulk is nonlinear."""
    problem = press(friction=0.5, nonlinear=True, push=(1.0, -1.0))
    problem.load.Set(0.0)
    stepper = LoadStepper(problem.solver(), problem.load)
    for end in (1e-3, 1e-2, 0.1):
        stepper.Integrate(end, steps=1, printing=False)
    other = press(friction=0.5, nonlinear=True, push=(1.0, -1.0))
    other.load.Set(0.0)
    LoadStepper(other.solver(), other.load).Integrate(0.1, steps=1, printing=False)
    assert numpy(problem.gf) == pytest.approx(numpy(other.gf), abs=1e-7)


def test_a_prediction_that_is_worse_than_none_is_dropped():
    """Wrong by a factor of a thousand, the extrapolation leads astray: the last state is better."""
    problem = press(friction=0.5)
    problem.load.Set(0.0)
    solver = problem.solver()
    stepper = LoadStepper(solver, problem.load)
    stepper.Integrate(0.5, steps=2, printing=False)
    before = numpy(problem.gf)
    starts = []
    solve = solver.Solve
    solver.Solve = lambda **flags: (starts.append(numpy(problem.gf)), solve(**flags))[1]
    increment, size = stepper._last
    stepper._last = increment, size / 1000
    stepper.Integrate(0.75, steps=1, printing=False)
    assert np.array_equal(starts[0], before)
    stepper.Integrate(1.0, steps=1, printing=False)  # a right one helps
    assert not np.array_equal(starts[1], before)


def test_a_traction_without_weight_lifts_off():
    """Pulled off, a block on a soft spring opens everywhere, and closes again."""
    problem = press(spring=0, friction=0.5)
    u, v = problem.X.TnT()[0][0], problem.X.TnT()[1][0]
    problem.a += 1e-2 * InnerProduct(u, v) * dx("upper")
    problem.a += -InnerProduct(CF((0, -problem.load)), v) * ds("top")
    problem.load.Set(0.0)
    stepper = LoadStepper(problem.solver(), problem.load)
    stepper.Integrate(1.0, steps=1, printing=False)
    assert np.all(problem.contact.Table()["status"] > 0)
    stepper.Integrate(-1.0, steps=1, printing=False)
    assert not np.any(problem.contact.Table()["status"])
    stepper.Integrate(1.0, steps=1, printing=False)
    assert np.all(problem.contact.Table()["status"] > 0)
