"""Dirichlet values that depend on the load."""

import numpy as np
import pytest
from ngsolve import CF, H1, cos, sin, x, y
from press import numpy, press

from ngslac import ContactConvergenceError, LoadStepper

DRIVEN = {"spring": 0, "flags": {"dirichlet": "bottom|top"}}


def driven(prescribe, load=0.0, **flags):
    problem = press(**{"friction": 0.4} | DRIVEN | flags)
    problem.load.Set(load)
    return problem, LoadStepper(problem.solver(), problem.load, prescribe=prescribe(problem.load))


def test_a_displacement_for_a_region():
    problem, stepper = driven(lambda t: {"top": CF((0.01 * t, -0.02 * t))})
    seen = []
    stepper.Integrate(
        steps=4,
        printing=False,
        callback=lambda step: seen.append(problem.gf.components[0](problem.mesh(0.5, 1))),
    )
    expected = np.outer([0.25, 0.5, 0.75, 1], [0.01, -0.02])
    assert np.array(seen) == pytest.approx(expected, rel=1e-12)
    assert problem.contact.Force()[1] > 0.5


def test_dict_and_callable_give_the_same():
    problem, stepper = driven(lambda t: {"top": CF((0.01 * t * x, -0.02 * t))})
    stepper.Integrate(steps=2, printing=False)
    other, stepper = driven(lambda t: None)
    space = other.X.components[0]
    top = np.array([bool(b) for b in space.GetDofs(other.mesh.Boundaries("top"))])
    field = type(other.gf)(space)

    def prescribe(gf):
        field.Set(other.load * CF((0.01 * x, -0.02)), definedon=other.mesh.Boundaries("top"))
        gf.components[0].vec.FV().NumPy()[top] = numpy(field)[top]

    stepper.prescribe = prescribe
    stepper.Integrate(steps=2, printing=False)
    assert numpy(problem.gf) == pytest.approx(numpy(other.gf), abs=1e-13)


def test_only_constrained_components_are_set():
    """The sliding guide at the top holds x; what the user says of y does not count."""
    problem, stepper = driven(
        lambda t: {"top": CF((0.01 * t, 99))},
        flags={"dirichletx": "top", "dirichlet": "bottom"},
        spring=10.0,
    )
    stepper.Integrate(steps=1, printing=False)
    ux, uy = problem.gf.components[0](problem.mesh(0.5, 1))
    assert ux == pytest.approx(0.01, rel=1e-12)
    assert abs(uy) < 0.1


def test_a_callable_may_clear_what_is_free():
    """GridFunction.Set with definedon sets all other dofs to zero: they are put back."""
    problem, stepper = driven(lambda t: {"top": CF((0.01 * t, -0.02 * t))})
    stepper.Integrate(steps=3, printing=False)
    other, stepper = driven(lambda t: None)
    motion = other.load * CF((0.01, -0.02))
    stepper.prescribe = lambda gf: gf.components[0].Set(
        motion, definedon=other.mesh.Boundaries("top")
    )
    steps = stepper.Integrate(steps=3, printing=False)
    assert numpy(problem.gf) == pytest.approx(numpy(other.gf), abs=1e-12)
    assert [s.iterations for s in steps] == [s.iterations for s in stepper.steps]


def test_a_space_with_blocks():
    problem, stepper = driven(
        lambda t: {"top": CF((0.01 * t, -0.02 * t))},
        space=lambda mesh, **flags: H1(mesh, dim=2, **flags),
    )
    stepper.Integrate(steps=1, printing=False)
    assert problem.gf.components[0](problem.mesh(0.5, 1)) == pytest.approx((0.01, -0.02), rel=1e-12)


def test_a_region_without_constraints_is_named():
    with pytest.raises(ValueError, match="no displacement is constrained on 'slave'"):
        driven(lambda t: {"slave": CF((0, 0))})


@pytest.mark.parametrize("condense", [False, True])
def test_a_motion_beyond_the_size_of_the_elements(condense):
    """The top moves by several elements in one step: set at once, it turns them inside out."""
    problem, stepper = driven(
        lambda t: {"top": t * CF((0.3, -0.2))}, nonlinear=True, h=0.1, condense=condense
    )
    steps = stepper.Integrate(steps=1, printing=False)
    assert [s.cuts for s in steps] == [0]
    assert problem.gf.components[0](problem.mesh(0.5, 1)) == pytest.approx((0.3, -0.2), rel=1e-12)
    fine, stepper = driven(
        lambda t: {"top": t * CF((0.3, -0.2))}, nonlinear=True, h=0.1, friction=None
    )
    stepper.Integrate(steps=4, printing=False)
    one, stepper = driven(
        lambda t: {"top": t * CF((0.3, -0.2))}, nonlinear=True, h=0.1, friction=None
    )
    stepper.Integrate(steps=1, printing=False)
    assert numpy(one.gf) == pytest.approx(numpy(fine.gf), abs=1e-8)


def test_a_large_rotation():
    """Both bodies turn by a right angle in two steps: the Newton steps carry it."""

    def turned(t):
        a = np.pi / 2 * t
        spin = CF((cos(a) * x - sin(a) * y - x, sin(a) * x + cos(a) * y - y))
        return {"top": spin, "bottom": spin}

    problem, stepper = driven(turned, nonlinear=True, friction=None, finite=True)
    stepper.Integrate(steps=2, printing=False)
    expected = np.array([-1, 0.5]) - [0.5, 1]
    assert problem.gf.components[0](problem.mesh(0.5, 1)) == pytest.approx(expected, abs=1e-12)
    assert problem.contact.Table()["pressure"] == pytest.approx(0, abs=1e-8)


def test_a_failed_step_restores_the_dirichlet_values():
    problem, stepper = driven(lambda t: {"top": t * CF((0.02, -0.02))}, nonlinear=True)
    stepper.Integrate(0.5, steps=1, printing=False)
    before = numpy(problem.gf)
    stepper.maxcuts = 0
    with pytest.raises(ContactConvergenceError):
        stepper.Integrate(1.0, steps=1, maxit=1, tol=1e-14, printing=False)
    assert np.array_equal(numpy(problem.gf), before)


def test_solve_with_a_motion_ends_where_it_should():
    problem, _ = driven(lambda t: None, nonlinear=True)
    fixed = np.array([not b for b in problem.X.FreeDofs()])
    motion = np.where(fixed, 0.0, 7.0)  # what is free does not count
    top = problem.X.components[0].GetDofs(problem.mesh.Boundaries("top"))
    dofs = np.flatnonzero([bool(b) for b in top])
    motion[dofs[dofs < problem.mesh.nv]] = 0.03
    solver = problem.solver()
    assert solver.Merit() is None
    solver.Solve(printing=False, motion=motion)
    assert numpy(problem.gf)[fixed] == pytest.approx(motion[fixed], abs=1e-15)
    assert solver.Merit() < 1e-8
