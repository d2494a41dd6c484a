"""The bouncing ring: impulses, spin, energies, files."""

import json

import pytest

from ngslac.demos import bouncing

COARSE = {"h": 0.25, "dt": 0.04, "end": 1.6}


@pytest.fixture(scope="module")
def slipping():
    """Thrown so fast that it slips all the time."""
    return bouncing.Run(**COARSE, friction=0.2, gravity=0.0, velocity=(2.0, -1.0))


def test_it_leaves_the_ground(slipping):
    figures = slipping.figures
    assert 0.5 < figures["restitution"] < 1.0
    assert figures["contact_end"] < 1.4
    assert figures["cuts"] == 0


def test_friction_brakes_and_turns(slipping):
    """Slip all the time: the tangential impulse is friction times the normal one."""
    figures = slipping.figures
    assert figures["friction_ratio"] == pytest.approx(0.2, rel=0.06)  # 0.198 on a finer mesh
    assert figures["spin_ratio"] == pytest.approx(0.88, abs=0.06)  # its arm is less than the radius
    assert figures["spin"] < -0.2  # it begins to roll
    assert figures["friction"] > 0


def test_invariants_in_flight(slipping):
    figures = slipping.figures
    assert figures["flight_speed_drift"] < 1e-9
    assert figures["flight_spin_drift"] < 2e-2


def test_energy(slipping):
    figures = slipping.figures
    gone = figures["friction"] + figures["impact"] + figures["algorithmic"]
    assert figures["energy_end"] + gone == pytest.approx(figures["energy_start"], rel=1e-10)
    assert figures["largest_gain"] < 1e-3 * figures["energy_start"]
    assert figures["largest_contact_gain"] < 1e-12
    assert abs(figures["algorithmic"]) < 0.01 * figures["energy_start"]
    assert 0 < figures["impact"] < 0.1 * figures["energy_start"]


def test_without_friction_it_does_not_turn():
    figures = bouncing.Run(**COARSE | {"end": 0.5}, friction=0.0, velocity=(0.5, -1.0)).figures
    # The normals are those of the ring, whose faces are not quite parallel to the ground.
    assert abs(figures["friction_ratio"]) < 0.02
    assert figures["largest_contact_gain"] < 5e-4 * figures["energy_start"]
    assert figures["friction"] == pytest.approx(0, abs=1e-12)


def test_files(tmp_path):
    pytest.importorskip("matplotlib")
    file, picture = tmp_path / "deep" / "figures.json", tmp_path / "ring.png"
    arguments = ["--h", "0.4", "--dt", "0.04", "--end", "0.2"]
    bouncing.main([*arguments, "--json", str(file), "--picture", str(picture)])
    assert json.loads(file.read_text())["steps"] >= 5
    assert picture.stat().st_size > 10_000


@pytest.mark.parametrize(
    ("flags", "message"),
    [
        ({"h": 0.0}, "h"),
        ({"thickness": 1.5}, "less than the radius"),
        ({"velocity": (1.0, 0.5)}, "downwards"),
    ],
)
def test_bad_arguments(flags, message):
    with pytest.raises(ValueError, match=message):
        bouncing.Problem(**flags)
