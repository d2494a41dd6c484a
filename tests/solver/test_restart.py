"""Saved and continued in a new process: the same as without interruption."""

import subprocess
import sys
from pathlib import Path

import continued
import numpy as np
import pytest
from motions import on_ground, values
from ngsolve import GridFunction, Parameter

from ngslac import LACContact
from ngslac.restart import LoadMesh, LoadState, SaveState

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


def test_the_file_is_replaced_as_a_whole(tmp_path, monkeypatch):
    """A computation that dies while it writes leaves the older state."""
    stepper = continued.loading(nonlinear=False)
    SaveState(tmp_path / "state", stepper)
    before = (tmp_path / "state").read_bytes()
    monkeypatch.setattr(LACContact, "State", lambda self: lambda: None)  # cannot be pickled
    with pytest.raises(Exception, match="pickle"):
        SaveState(tmp_path / "state", stepper)
    assert (tmp_path / "state").read_bytes() == before


def test_mesh_comes_back_with_its_numbering(tmp_path):
    stepper = continued.loading()
    SaveState(tmp_path / "state", stepper)
    mesh, found = stepper.solver.gf.space.mesh, LoadMesh(tmp_path / "state")
    assert [v.point for v in mesh.vertices] == [v.point for v in found.vertices]
    assert mesh.GetBoundaries() == found.GetBoundaries()


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
    with pytest.raises(TypeError, match="tool is a str"):
        SaveState(file, "stepper")
    with pytest.raises(TypeError, match="neither a GridFunction"):
        SaveState(file, stepper, also={"speed": 1.0})
    (tmp_path / "other").write_text("no state")
    with pytest.raises(ValueError, match="not written by SaveState"):
        LoadMesh(tmp_path / "other")
