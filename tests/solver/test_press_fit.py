"""Rings whose meshes touch; an offset presses them into each other."""

import numpy as np
import pytest
from ngsolve import IfPos
from rings import fit_pressure, press_fit

from ngslac import ContactConvergenceError, LoadState, LoadStepper, SaveState

INTERFERENCE = 0.1


def errors(n, interference=INTERFERENCE, **law):
    problem = press_fit(n, interference, **law)
    problem.solver().Solve(printing=False)
    return np.abs(problem.contact.Table()["pressure"] / fit_pressure(interference) - 1).max()


def test_pressure_of_a_press_fit():
    """The largest error of a macro-element is of order 2."""
    coarse, middle, fine = map(errors, (6, 12, 24))
    assert fine < 1e-3
    assert coarse > 3 * middle > 9 * fine


def test_large_sliding_differs_by_what_is_nonlinear():
    """Interference over radius is 1/200."""
    assert errors(12, finite=True) < 1.5e-2


@pytest.mark.parametrize("finite", [False, True])
def test_a_ramp_in_steps_restarted(finite, tmp_path):
    """The stepper drives the Parameter of the offset; half way another stepper continues."""

    def stepper():
        problem = press_fit(8, lambda load: INTERFERENCE * load, friction=0.1, finite=finite)
        problem.load.Set(0)
        return problem, LoadStepper(problem.solver(), problem.load)

    problem, whole = stepper()
    pressures = []
    whole.Integrate(
        steps=4,
        printing=False,
        callback=lambda _: pressures.append(problem.contact.Table()["pressure"].mean()),
    )
    ratios = np.array(pressures) / pressures[-1]
    assert ratios == pytest.approx([0.25, 0.5, 0.75, 1], rel=0.02 if finite else 1e-4)
    first, second = stepper(), stepper()
    first[1].Integrate(0.5, steps=2, printing=False)
    SaveState(tmp_path / "state", first[1])
    LoadState(tmp_path / "state", second[1])
    second[1].Integrate(steps=2, printing=False)
    found, expected = (p.gf.vec.FV().NumPy() for p in (second[0], problem))
    assert found == pytest.approx(expected, abs=1e-10 * np.abs(expected).max())


def test_a_failed_step_leaves_all_as_it_was():
    """The offset is not finite beyond a load of 0.9: the stepper comes near it, and stays there."""
    problem = press_fit(8, lambda load: INTERFERENCE * IfPos(load - 0.9, 1 / (load - load), load))
    problem.load.Set(0)
    stepper = LoadStepper(problem.solver(), problem.load)
    values, seen = problem.gf.vec.FV().NumPy(), []
    with pytest.raises(ContactConvergenceError, match=r"offset is -?(inf|nan) at"):
        stepper.Integrate(1, steps=2, printing=False, callback=lambda _: seen.append(values.copy()))
    assert 0.8 < problem.load.Get() < 0.9
    assert np.array_equal(values, seen[-1])
    pressure = problem.contact.Table()["pressure"]
    expected = problem.load.Get() * fit_pressure(INTERFERENCE)
    assert pressure == pytest.approx(expected, rel=0.01)


@pytest.mark.parametrize("finite", [False, True])
def test_polygons_that_touch_are_no_press_fit(finite):
    """Rings with straight edges overlap: this strains them, unless the start is adjusted."""
    plain, adjusted = (
        press_fit(6, 0.0, curve=1, finite=finite, **law) for law in ({}, {"adjust": 0.2})
    )
    for problem in (plain, adjusted):
        problem.solver().Solve(printing=False)
    assert plain.contact.Table()["pressure"].max() > 100
    assert adjusted.contact.Table()["pressure"] == pytest.approx(0, abs=1e-10)
    assert adjusted.gf.components[0].vec.FV().NumPy() == pytest.approx(0, abs=1e-14)


def test_a_press_fit_smaller_than_the_errors_of_the_geometry():
    """The interference is 1/2000 of the radius; gaps of the meshes reach the same size."""
    assert errors(6, 0.01, curve=3) > 0.5
    assert errors(6, 0.01, curve=3, adjust=0.02) < 0.011
