"""A ring pressed flat: contact of the inside with itself against contact with a rigid plane."""

import json

import numpy as np
import pytest

from ngslac.demos import flatring


def figures(h, quarter):
    found = flatring.Run(h=h, quarter=quarter).figures
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


def test_command_line(tmp_path, capsys):
    pytest.importorskip("matplotlib")
    file = tmp_path / "figures.json"
    flatring.main(["--travel", "0.2", "--steps", "2", "--json", str(file), "--out", str(tmp_path)])
    found = json.loads(file.read_text())
    assert found["steps"] == found["converged_steps"] == 2
    assert (tmp_path / "flatring.png").stat().st_size > 5000
    assert "force on the plate" in capsys.readouterr().out
