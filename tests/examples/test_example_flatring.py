"""A ring pressed flat: contact of the inside with itself against contact with a rigid plane."""

import json

import flatring
import numpy as np
import pytest
from commandline import Help, Refused


def figures(h, quarter):
    found = flatring.Run(h=h, quarter=quarter)
    return {name: np.array(values) for name, values in found.items()}


@pytest.fixture(scope="module")
def itself():
    return figures(0.12, False)


def test_goes_flat_without_help(itself):
    assert itself["converged_steps"] == 38
    assert itself["cuts"].sum() == 0
    assert itself["iterations"].max() <= 17
    assert itself["iterations"].sum() <= 200
    assert np.all(np.diff(itself["force"]) > 0)


def test_forces_balance(itself):
    assert itself["force_below"] == pytest.approx(itself["force"], rel=1e-9)


def test_inside_touches_itself(itself):
    """It does not before the end, then it carries most of the force."""
    assert np.all(itself["closed_inside"][:-1] == 0)
    assert itself["closed_inside"][-1] >= 8
    assert 0.75 < itself["force_inside"][-1] / itself["force"][-1] < 0.95


def test_same_as_a_plane_of_symmetry(itself):
    plane = figures(0.12, True)
    before = itself["travel"] < 1.6
    assert itself["force"][before] == pytest.approx(plane["force"][before], rel=3e-3)
    assert itself["force"][-1] == pytest.approx(plane["force"][-1], rel=0.1)


@pytest.mark.slow
def test_comes_nearer_to_the_plane_on_a_finer_mesh():
    itself, plane = figures(0.06, False), figures(0.06, True)
    assert itself["force"][-1] == pytest.approx(plane["force"][-1], rel=0.03)


def test_flatring_command(tmp_path, capsys):
    pytest.importorskip("matplotlib")
    file = tmp_path / "new" / "figures.json"
    flatring.main(["--travel", "0.2", "--steps", "2", "--json", str(file), "--out", str(tmp_path)])
    found = json.loads(file.read_text())
    assert found["steps"] == found["converged_steps"] == 2
    assert found["travel"] == pytest.approx([0.1, 0.2])
    for name in ("flatring.png", "flatring_inside.vtu", "flatring_outside.vtu"):
        assert (tmp_path / name).stat().st_size > 3000
    assert "force on the plate" in capsys.readouterr().out


def test_flatring_help_and_bad_values(capsys):
    assert "(default: 0.12)" in Help(capsys, flatring.main)
    assert "--h: 0 is no finite number > 0" in Refused(capsys, flatring.main, "--h", "0")
    assert "--steps" in Refused(capsys, flatring.main, "--steps", "few")
    assert "thickness = 2" in Refused(capsys, flatring.main, "--thickness", "2")
