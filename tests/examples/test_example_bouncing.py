"""The bouncing ring: impulses, spin, energies, files."""

import json

import bouncing
import pytest
from commandline import Help, Refused

COARSE = {"h": 0.25, "dt": 0.04, "end": 1.6}


@pytest.fixture(scope="module")
def slipping():
    """Thrown so fast that it slips all the time."""
    return bouncing.Run(**COARSE, friction=0.2, gravity=0.0, velocity=(2.0, -1.0))


def test_it_leaves_the_ground(slipping):
    figures = slipping
    assert 0.5 < figures["restitution"] < 1.0
    assert figures["contact_end"] < 1.4
    assert figures["cuts"] == 0


def test_friction_brakes_and_turns(slipping):
    """Slip all the time: the tangential impulse is friction times the normal one."""
    figures = slipping
    assert figures["friction_ratio"] == pytest.approx(0.2, rel=0.06)  # 0.198 on a finer mesh
    assert figures["spin_ratio"] == pytest.approx(0.88, abs=0.06)  # its arm is less than the radius
    assert figures["spin"] < -0.2  # it begins to roll
    assert figures["friction"] > 0


def test_invariants_in_flight(slipping):
    figures = slipping
    assert figures["flight_speed_drift"] < 1e-9
    assert figures["flight_spin_drift"] < 2e-2


def test_energy(slipping):
    figures = slipping
    gone = figures["friction"] + figures["impact"] + figures["algorithmic"]
    assert figures["energy_end"] + gone == pytest.approx(figures["energy_start"], rel=1e-10)
    assert figures["largest_gain"] < 1e-3 * figures["energy_start"]
    assert figures["largest_contact_gain"] < 1e-12
    assert abs(figures["algorithmic"]) < 0.01 * figures["energy_start"]
    assert 0 < figures["impact"] < 0.1 * figures["energy_start"]


def test_without_friction_it_does_not_turn():
    figures = bouncing.Run(**COARSE | {"end": 0.5}, friction=0.0, velocity=(0.5, -1.0))
    # The normals are those of the ring, whose faces are not quite parallel to the ground.
    assert abs(figures["friction_ratio"]) < 0.02
    assert figures["largest_contact_gain"] < 5e-4 * figures["energy_start"]
    assert figures["friction"] == pytest.approx(0, abs=1e-12)


def test_bouncing_command(tmp_path, capsys):
    pytest.importorskip("matplotlib")
    file = tmp_path / "deep" / "figures.json"
    arguments = ["--h", "0.4", "--dt", "0.04", "--end", "0.2", "--velocity", "2", "-1"]
    bouncing.main([*arguments, "--json", str(file), "--out", str(tmp_path)])
    assert json.loads(file.read_text())["steps"] >= 5
    for name in ("bouncing.png", "bouncing_outside.vtu"):
        assert (tmp_path / name).stat().st_size > 3000
    assert "friction_ratio" in capsys.readouterr().out


def test_bouncing_help_and_bad_values(capsys):
    assert "(default: 0.17)" in Help(capsys, bouncing.main)
    assert "--h: 0 is no finite number > 0" in Refused(capsys, bouncing.main, "--h", "0")
    bad = Refused(capsys, bouncing.main, "--thickness", "1.5")
    assert "thickness = 1.5 must be less than the radius" in bad
    assert "downwards" in Refused(capsys, bouncing.main, "--velocity", "1", "0.5")
    short = ("--end", "0.02", "--h", "0.5", "--quiet")
    assert "in the air until the time 0.02" in Refused(capsys, bouncing.main, *short)
