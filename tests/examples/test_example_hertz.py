"""The example of the README: the paper's Hertz problem from the command line."""

import json

import hertz
import pytest
from commandline import Help, Refused

KEYS = ("p0_ratio", "contact_edge", "force_ratio", "newton_iterations", "newton_max", "ndof")
FAST = ("--h", "1", "--steps", "2")


def test_hertz_command(tmp_path, capsys):
    pytest.importorskip("matplotlib")
    file = tmp_path / "new" / "figures.json"
    found = hertz.main([*FAST, "--json", str(file), "--out", str(tmp_path)])
    assert json.loads(file.read_text()) == found
    assert found.keys() == {*KEYS, "seconds"}
    assert found["p0_ratio"] == pytest.approx(1.017, abs=3e-3)
    assert found["force_ratio"] == pytest.approx(1, abs=1e-10)
    assert len(found["newton_iterations"]) == 2
    for name in ("hertz.png", "hertz.vtu", "hertz_slave.vtu"):
        assert (tmp_path / name).stat().st_size > 3000
    assert "contact force 1.0000" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("stabilize", "ratio"), [("none", 1.0493), ("split", 1.0294), ("bubble", 1.0295)]
)
def test_first_order(stabilize, ratio, capsys):
    options = ("--order", "1", "--stabilize", stabilize, "--full", "--quiet")
    found = hertz.main([*FAST, *options])
    assert found["force_ratio"] == pytest.approx(1, abs=1e-10)
    assert found["p0_ratio"] == pytest.approx(ratio, abs=1e-3)
    assert capsys.readouterr().out == ""


def test_hertz_help_and_bad_values(capsys):
    assert "(default: 0.5)" in Help(capsys, hertz.main)
    assert "--h: 0 is no finite number > 0" in Refused(capsys, hertz.main, "--h", "0")
    assert "--friction: -1 is no" in Refused(capsys, hertz.main, "--friction", "-1")
    assert "--steps" in Refused(capsys, hertz.main, "--steps", "0")
    assert "--stabilize" in Refused(capsys, hertz.main, "--stabilize", "some")


def test_the_half_model_cannot_be_turned():
    with pytest.raises(ValueError, match="angle = 30"):
        hertz.Hertz(angle=30)


def test_interrupted(monkeypatch, capsys):
    def Interrupt(*_, **options):
        raise KeyboardInterrupt

    monkeypatch.setattr(hertz.Hertz, "Press", Interrupt)
    with pytest.raises(SystemExit, match="interrupted"):
        hertz.main([*FAST, "--quiet"])
