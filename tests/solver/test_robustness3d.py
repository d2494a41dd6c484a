"""In 3D: rollback and restore, load stepping that fails, and bodies that only contact holds."""

import numpy as np
import pytest
from ngsolve import CF, InnerProduct, ds, x, y
from press import mixed_press3d, numpy, press3d

from ngslac import ContactConvergenceError, FloatingBodyError, LoadStepper

MOTIONS = [f"{kind} {c}" for kind in ("translation in", "rotation about") for c in "xyz"]


def test_a_failed_solve_restores_everything_in_3d():
    problem = mixed_press3d(nonlinear=True)
    solver = problem.solver()
    solver.Solve(printing=False)
    before = numpy(problem.gf)
    table = {k: v.copy() for k, v in problem.contact.Table().items()}
    problem.load.Set(1.7)
    with pytest.raises(ContactConvergenceError, match="no convergence in 1 iterations") as error:
        solver.Solve(maxit=1, printing=False)
    assert np.array_equal(numpy(problem.gf), before)
    for name, values in problem.contact.Table().items():
        assert np.array_equal(values, table[name]), name
    assert np.array_equal(numpy(problem.contact.slip), table["slip"].ravel())
    assert len(error.value.history) == 2
    solver.Solve(printing=False)  # nothing is broken: more iterations do it
    assert not np.array_equal(numpy(problem.gf), before)


def test_a_failed_step_restores_solution_load_and_fields():
    problem = mixed_press3d(n=(3, 2))
    problem.load.Set(0.0)
    stepper = LoadStepper(problem.solver(), problem.load)
    stepper.Integrate(0.8, steps=2, printing=False)
    before = numpy(problem.gf)
    table = {k: v.copy() for k, v in problem.contact.Table().items()}
    reference = problem.contact.form.Vectors("reference")
    assert np.abs(table["slip"]).max() > 0
    stepper.prescribe = lambda gf: (_ for _ in ()).throw(KeyboardInterrupt)
    with pytest.raises(KeyboardInterrupt):
        stepper.Integrate(1.2, steps=1, printing=False)
    assert problem.load.Get() == pytest.approx(0.8)
    assert np.array_equal(numpy(problem.gf), before)
    assert np.array_equal(problem.contact.form.Vectors("reference"), reference)
    for name, values in problem.contact.Table().items():
        assert np.array_equal(values, table[name]), name


def test_a_step_that_is_too_large_is_cut_in_3d(capsys):
    """In one step six iterations do not do; in two they do."""
    problem = press3d(friction=2.0, nonlinear=True, push=(0.5, 0.2, -0.1))
    problem.load.Set(0.0)
    steps = LoadStepper(problem.solver(), problem.load).Integrate(steps=1, maxit=6)
    assert sum(s.cuts for s in steps) >= 1
    assert len(steps) >= 2
    assert steps[-1].time == problem.load.Get() == 1.0
    assert "halved" in capsys.readouterr().out


def test_nan_in_the_residual_in_3d():
    problem = mixed_press3d(nonlinear=True, n=(3, 2))
    problem.gf.components[0].Set(CF((-2 * x, 0, 0)))
    before = numpy(problem.gf)
    with pytest.raises(ContactConvergenceError, match="NaN or infinite"):
        problem.solver().Solve(printing=False)
    assert np.array_equal(numpy(problem.gf), before)


def test_a_failed_pairing_leaves_the_old_one_in_3d():
    problem = press3d()
    problem.contact.Update()
    report, segments = str(problem.contact.Check()), len(problem.contact.Segments())
    problem.gf.components[0].Set(
        problem.mesh.MaterialCF({"upper": CF((50, 0, 0))}, default=CF((0, 0, 0)))
    )
    with pytest.raises(Exception, match="never meet"):
        problem.contact.Update(problem.gf)
    assert str(problem.contact.Check()) == report
    assert len(problem.contact.Segments()) == segments


# --- bodies that only contact holds (T23) ------------------------------------------------------


def floating(traction=(0.0, 0.0, -1.0), **flags):
    """The upper block is loaded by a traction and held by nothing else."""
    problem = press3d(spring=0, **flags)
    v = problem.X.TestFunction()[0]
    problem.a += -InnerProduct(CF(traction), v) * ds("top")
    return problem


def lift(problem, shift):
    """Start with the upper block away from where it was meshed."""
    problem.gf.components[0].Set(
        problem.mesh.MaterialCF({"upper": CF(shift)}, default=CF((0, 0, 0)))
    )


@pytest.mark.parametrize("law", [{"friction": 0.5}, {"tied": True}])
@pytest.mark.parametrize("gap", [0.0, 0.01])
def test_contact_holds_a_body_that_starts_from_the_gap(gap, law):
    problem = floating(**law)
    lift(problem, (0, 0, gap))
    problem.solver().Solve(printing=False)
    assert problem.contact.Force() == pytest.approx([0, 0, 1], abs=1e-10)
    assert np.all(problem.contact.Table()["status"] == 1)


@pytest.mark.parametrize("kinds", [("hex", "hex"), ("tet", "prism_side"), ("pyramid", "tet")])
def test_a_tilted_body_falls_flat(kinds):
    """It touches with one edge first; frictionless, guided sideways and against turning."""
    problem = floating(
        kinds=kinds,
        flags={"dirichletx": "left_upper", "dirichlety": "front_upper", "dirichlet": "bottom"},
    )
    problem.gf.components[0].Set(
        problem.mesh.MaterialCF({"upper": CF((0, 0, 0.01 + 0.02 * x))}, default=CF((0, 0, 0)))
    )
    problem.solver().Solve(printing=False)
    assert problem.contact.Force() == pytest.approx([0, 0, 1], abs=1e-9)
    assert np.all(problem.contact.Table()["status"] == 2)


def test_frictionless_contact_cannot_hold_sideways_in_3d():
    """Three of the six motions are stopped by a plane without friction."""
    problem = floating()
    with pytest.raises(FloatingBodyError) as error:
        problem.solver().Solve(printing=False)
    found = str(error.value).split(":")[0].split("; ")
    free = ["translation in x", "translation in y", "rotation about z"]
    assert found == [f"body 'upper' floats ({motion})" for motion in free]
    assert not np.any(numpy(problem.gf))


@pytest.mark.parametrize(
    ("flags", "free"),
    [
        ({}, MOTIONS),
        ({"dirichletz": "top"}, [MOTIONS[0], MOTIONS[1], MOTIONS[5]]),
        ({"dirichletx": "left_upper"}, [MOTIONS[1], MOTIONS[2], MOTIONS[3]]),
        ({"dirichletx": "left_upper", "dirichlety": "front_upper"}, [MOTIONS[2]]),
    ],
)
def test_every_free_motion_is_named_in_3d(flags, free):
    problem = floating(flags={"dirichlet": "bottom"} | flags)
    with pytest.raises(FloatingBodyError) as error:
        problem.solver(initial="none").Solve(printing=False)
    found = str(error.value).split(":")[0].split("; ")
    assert found == [f"body 'upper' floats ({motion})" for motion in free]
    assert "start in contact" in str(error.value)
    assert not np.any(numpy(problem.gf))


def test_both_bodies_may_float():
    """The clamp is missing: twelve motions, of which a frictional contact stops six."""
    problem = floating(friction=0.5, flags={"dirichlet": ""})
    with pytest.raises(FloatingBodyError) as error:
        problem.solver().Solve(printing=False)
    found = str(error.value).split(":")[0].split("; ")
    assert len(found) == 6
    assert {text.split("'")[1] for text in found} <= {"upper", "lower"}


def test_the_slave_may_hold_a_floating_master_in_3d():
    """The lower block floats, the upper one is held by springs."""
    problem = press3d(friction=0.5, flags={"dirichlet": ""})
    v = problem.X.TestFunction()[0]
    problem.a += -InnerProduct(CF((0, 0, 1.0)), v) * ds("bottom")
    problem.load.Set(0.0)
    problem.solver().Solve(printing=False)
    # 1.4 is the width of the lower block with its overhang
    assert problem.contact.Force() == pytest.approx([0, 0, 1.4**2], abs=1e-9)


def test_a_pulled_body_flies_away_in_3d():
    problem = floating(traction=(0.0, 0.0, 1.0), friction=0.5)
    with pytest.raises(ContactConvergenceError) as error:
        problem.solver().Solve(printing=False, maxit=8)
    assert "is pulled away (translation in z, towards +z)" in str(error.value)
    assert not np.any(numpy(problem.gf))


def test_friction_stops_the_turning_about_the_normal():
    """A couple about z, within friction and beyond it."""
    couple = CF((-(y - 0.5), x - 0.5, 0.0))  # moment of this traction on the unit square: 1/6
    for size, holds in ((0.2, True), (2.0, False)):
        problem = floating(friction=0.5)
        v = problem.X.TestFunction()[0]
        problem.a += -InnerProduct(size * couple, v) * ds("top")
        if holds:
            problem.solver().Solve(printing=False)
            moment = problem.contact.Moment((0.5, 0.5, 0.0))
            assert moment == pytest.approx([0, 0, -size / 6], abs=1e-10)
        else:
            with pytest.raises(ContactConvergenceError):
                problem.solver().Solve(printing=False)


def test_friction_below_tresca_keeps_the_law_continuous_in_3d():
    """Coulomb's law up to a bound converges where contact opens."""
    push = (0.2, 0.1, -0.02 + 0.1 * x)
    problem = press3d(friction=1.0, tresca=2.0, push=push)
    problem.solver().Solve(printing=False)
    table = problem.contact.Table()
    shear = table["traction"] + table["pressure"][:, None] * table["normal"]
    bound = np.minimum(table["pressure"], 2.0)
    assert np.all(np.linalg.norm(shear, axis=1) <= bound + 1e-9)
    assert 0 in table["status"]
