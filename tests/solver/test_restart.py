"""Saved and continued in a new process: the same as without interruption."""

import subprocess
import sys
from pathlib import Path

import continued
import numpy as np
import pytest
from motions import on_ground, values
from ngsolve import GridFunction, Parameter

from ngslac import ContactConvergenceError
from ngslac.steps.restart import LoadState, SaveState

HERE = Path(__file__).parent


@pytest.fixture(scope="module")
def ends(tmp_path_factory):
    """End values of each kind: without interruption, and continued in a new process."""
    folder, expected = tmp_path_factory.mktemp("states"), {}
    for kind, make in continued.MAKE.items():
        stepper = continued.half(make(), 1)
        SaveState(folder / kind, stepper)
        expected[kind] = continued.outcome(continued.half(stepper, 2))
    subprocess.run([sys.executable, HERE / "continued.py", folder], check=True, cwd=HERE)
    return {kind: (expected[kind], np.load(folder / f"{kind}.npz")) for kind in expected}


@pytest.mark.parametrize("kind", continued.MAKE)
def test_continued_in_a_new_process(kind, ends):
    expected, found = ends[kind]
    assert np.any(expected["status"] > 0)
    # The velocities come from dense products, whose last digit depends on where arrays lie; from
    # there the runs agree to the tolerance of the solver.
    rounding = 1e-10 if kind == "bouncing" else 0
    for name, value in expected.items():
        assert found[name] == pytest.approx(value, rel=rounding, abs=rounding), name


def test_history_matters():
    """On the way back the surfaces stick where they have slid to: the solution alone is not all."""
    stepper, other = continued.loading(), continued.loading()
    stepper.Integrate(1.0, steps=4, printing=False)
    other.solver.gf.vec.data = stepper.solver.gf.vec
    other.load.Set(1.0)
    for tool in (stepper, other):
        tool.Integrate(0.9, steps=1, printing=False)
    assert np.abs(values(stepper.solver.gf) - values(other.solver.gf)).max() > 1e-3


def test_state_of_a_solver_and_of_what_belongs_to_it(tmp_path):
    stepper = continued.half(continued.loading(), 1)
    strain, speed = GridFunction(stepper.solver.gf.space), Parameter(3.5)
    strain.vec[:] = 0.25
    also = {"strain": strain, "speed": speed, "vector": strain.vec}
    before = values(stepper.solver.gf)
    SaveState(tmp_path / "state", stepper.solver, also=also)
    strain.vec[:] = 0
    speed.Set(0)
    stepper.solver.gf.vec[:] = 0
    LoadState(tmp_path / "state", stepper.solver, also=also)
    assert np.all(values(strain) == 0.25)
    assert speed.Get() == 3.5
    assert np.array_equal(values(stepper.solver.gf), before)
    assert stepper.solver.contacts[0].pressure.vec.FV().NumPy().max() > 0


def test_what_does_not_fit_is_refused(tmp_path):
    file = tmp_path / "state"
    stepper = continued.bouncing()
    SaveState(file, stepper)
    before = values(stepper.velocity)
    with pytest.raises(ValueError, match="another tool"):
        LoadState(file, stepper.static)
    finer = on_ground(dt=0.04, divisions=(4, 3), friction=0.4).stepper
    with pytest.raises(ValueError, match="another displacement and mesh"):
        LoadState(file, finer)
    with pytest.raises(ValueError, match="names in also"):
        LoadState(file, stepper, also={"speed": Parameter(1)})
    assert np.array_equal(values(stepper.velocity), before)
    with pytest.raises(TypeError, match="tool = 'stepper' is a str: give a LoadStepper"):
        SaveState(file, "stepper")
    with pytest.raises(TypeError, match=r"also\['speed'\] = 1.0 is neither a GridFunction"):
        SaveState(file, stepper, also={"speed": 1.0})
    with pytest.raises(TypeError, match=r"also = 3 must be a dict"):
        SaveState(file, stepper, also=3)


def test_another_kind_of_contact_changes_nothing(tmp_path):
    saved, other = continued.loading(), continued.loading(finite=True)
    SaveState(tmp_path / "state", continued.half(saved, 1))
    with pytest.raises(
        ValueError, match=r"another kind of contact: small .* there, finite .* here"
    ):
        LoadState(tmp_path / "state", other)
    assert not np.any(values(other.solver.gf))
    assert other.load.Get() == 0
    assert not other.solver.contacts[0].form.paired


def test_sizes_of_what_belongs_to_a_state(tmp_path):
    stepper = continued.loading()
    SaveState(tmp_path / "state", stepper, also={"a": Parameter(1), "b": stepper.solver.gf})
    for also in (
        {"a": stepper.solver.gf, "b": stepper.solver.gf},
        {"a": Parameter(1), "b": stepper.solver.gf.components[0]},
    ):
        with pytest.raises(ValueError, match=r"another kind or size of [ab]"):
            LoadState(tmp_path / "state", stepper, also=also)


def test_another_deformation_of_the_mesh_is_another_mesh(tmp_path):
    stepper = continued.loading()
    mesh = stepper.solver.gf.space.mesh
    SaveState(tmp_path / "state", stepper)
    shape = GridFunction(stepper.solver.gf.space.components[0])
    shape.vec[:] = 0.01
    mesh.SetDeformation(shape)
    with pytest.raises(ValueError, match="another displacement and mesh"):
        LoadState(tmp_path / "state", stepper)


# --- the next step -------------------------------------------------------------------------------


def hard(stepper, last):
    """Between 0.25 and 0.4 steps above 0.06 do not converge; `last` holds the load before."""

    def prescribe(gf):
        if 0.25 < stepper.load.Get() <= 0.4 and stepper.load.Get() - last[0] > 0.06:
            raise ContactConvergenceError("hard")

    stepper.prescribe = prescribe
    return stepper


def test_steps_after_cuts(tmp_path):
    last = [0.0]
    stepper = hard(continued.loading(nonlinear=False), last)
    done = stepper.Integrate(
        0.4, steps=2, printing=False, callback=lambda step: last.__setitem__(0, step.time)
    )
    assert max(step.cuts for step in done) > 0
    SaveState(tmp_path / "state", stepper)
    other = hard(continued.loading(nonlinear=False), last)
    LoadState(tmp_path / "state", other)
    ways = [s.Integrate(1.0, steps=1, printing=False) for s in (stepper, other)]
    assert len(ways[0]) > 1
    assert ways[0] == ways[1]
    assert np.array_equal(values(stepper.solver.gf), values(other.solver.gf))


def test_methods_that_were_given_up(tmp_path):
    """A linear solver that has learnt what does not work goes on without it."""
    stepper = continued.loading()
    linear = stepper.solver.linear
    assert linear.method == "direct"
    del linear._methods[0]  # as after failures in a row
    SaveState(tmp_path / "state", stepper)
    other = continued.loading()
    LoadState(tmp_path / "state", other)
    assert other.solver.linear.method == "saddle"
    back = continued.loading()
    SaveState(tmp_path / "state", back)
    LoadState(tmp_path / "state", other)
    assert other.solver.linear.method == "direct"
