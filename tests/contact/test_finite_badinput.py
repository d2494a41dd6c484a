"""Finite sliding: what cannot be paired is said, and leaves things as they were."""

import numpy as np
import pytest
from finitepress import Led, blocks2d, blocks3d
from ngsolve import CF, GridFunction, VectorH1, x

from ngslac import ContactConvergenceError, LACContact, LACSpace


def raises(text, kind=Exception):
    return pytest.raises(kind, match=text)


@pytest.fixture(scope="module", params=["2D", "3D"])
def led(request):
    mesh = blocks2d(0.34) if request.param == "2D" else blocks3d("hex", "tet", n=(2, 3))
    return Led(mesh, lambda t: (0,) * (mesh.dim - 1) + (0.3 * t,), order=1, friction=0.3)


@pytest.fixture
def apart(led):
    """Paired in the reference configuration."""
    led.gf.vec[:] = 0
    led.contact.Update()
    led.contact.form.SetConstant(1.0)
    return led


def lift(problem, *shift):
    problem.gf.components[0].Set(
        problem.mesh.MaterialCF({"upper": CF(shift)}, default=CF((0,) * len(shift)))
    )
    return problem.gf


@pytest.mark.parametrize(
    "flags", [{"obstacle": x}, {"tied": True, "master": "master"}], ids=lambda f: next(iter(f))
)
def test_nothing_to_slide_on(flags):
    V = VectorH1(blocks2d(0.34), order=1)
    X = V * LACSpace(V, slave="slave")
    u, lam = X.TrialFunction()
    with raises("finite=True needs a master surface that slides"):
        LACContact(u, lam, finite=True, **flags)


@pytest.mark.parametrize("value", [np.nan, np.inf])
def test_configuration_without_numbers(apart, value):
    before = apart.table()
    dofs = apart.reference.size
    bad = apart.gf.vec.FV().NumPy()
    bad[:dofs] = value
    for call in (apart.contact.Update, apart.contact.Follow, apart.contact.Commit):
        with raises("NaN or infinite|not finite|no finite"):
            call(apart.gf)
    bad[:] = 0
    after = apart.table()
    assert all(np.array_equal(before[name], after[name]) for name in before)


def test_surfaces_that_lost_each_other(apart):
    """The pairing stays; solver and stepper go back to the last state."""
    far = np.eye(apart.dim)[0] * 5
    before = apart.contact.form.nsegments
    with raises("never meet: .*check the regions, the placement of the bodies and maxdist"):
        apart.contact.Follow(lift(apart, *far))
    assert apart.contact.form.nsegments == before
    apart.gf.vec[:] = 0
    apart.contact.Follow(apart.gf)
    assert apart.table()["gap"] == pytest.approx(0, abs=1e-14)


def test_surfaces_farther_than_maxdist(apart):
    u, lam = apart.X.TrialFunction()
    contact = LACContact(u, lam, master="master", finite=True, maxdist=0.21)
    contact.Update()
    up = np.eye(apart.dim)[-1]
    contact.Follow(lift(apart, *(0.2 * up)))
    with raises("never meet: .*within maxdist = 0.21"):
        contact.Follow(lift(apart, *(0.22 * up)))
    with raises("never meet: .*within maxdist = 0.21"):
        contact.Update(apart.gf)


def test_step_that_tears_the_bodies_apart():
    """No partner far away: the step fails with a reason, and the last one is restored."""
    problem = Led(blocks2d(0.34), lambda t: (80 * t, -0.05 + 0 * t), order=1, friction=0.3)
    problem.stepper.maxcuts = 2
    problem.run(1e-3, steps=1)
    before, table = problem.gf.vec.FV().NumPy().copy(), problem.table()
    with raises("never meet", ContactConvergenceError):
        problem.run(1.0, steps=1)
    assert np.array_equal(problem.gf.vec.FV().NumPy(), before)
    assert problem.load.Get() == 1e-3
    after = problem.table()
    for name in ("pressure", "gap", "status", "area"):
        assert after[name] == pytest.approx(table[name], abs=1e-14)


def test_a_grid_function_of_another_space(apart):
    other = LACSpace(apart.X.components[0], slave="slave")
    gf = GridFunction(apart.X.components[0] * other * other)
    with raises("gf lives on another space"):
        apart.contact.Update(gf)
    with raises("gf lives on another space"):
        apart.contact.Follow(gf)
