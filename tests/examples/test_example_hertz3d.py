"""The example hertz3d: its number, its command line, its files.

Whether it agrees with Hertz is a matter of tests/validation/test_validation_hertz3d.py.
"""

import json

import hertz3d
import numpy as np
import pytest
from commandline import Help, Refused
from ngsolve import VectorH1

FIGURES = {"p0_ratio", "force_ratio", "contact_radius_ratio", "profile_error", "newton_iterations"}
FILES = {"hertz3d_pressure.png", "hertz3d.vtu", "hertz3d_contact.vtu", "hertz3d_segments.vtu"}


@pytest.mark.parametrize("shape", ["sphere", "cylinder"])
def test_hertz3d_command(shape, tmp_path, capsys):
    pytest.importorskip("matplotlib")
    file, out = tmp_path / "new" / "figures.json", tmp_path / "out"
    hertz3d.main(["--shape", shape, "--h", "0.9", "--json", str(file), "--out", str(out)])
    figures = json.loads(file.read_text())
    assert figures.keys() >= FIGURES
    assert figures["force_ratio"] == pytest.approx(1, abs=1e-9)
    assert figures["p0_ratio"] == pytest.approx(1, abs=0.1)
    assert figures["contact_radius_ratio"] == pytest.approx(1, abs=0.1)
    assert {path.name for path in out.iterdir()} == FILES
    assert all(path.stat().st_size > 1000 for path in out.iterdir())
    printed = capsys.readouterr().out
    assert f"{figures['p0_ratio']:.5f}" in printed
    assert f"{figures['ndof']} unknowns" in printed


def test_hertz3d_options():
    mesh = hertz3d.Mesh("cylinder", 1.25, order=1, stabilize="bubble")
    pressed = hertz3d.Press(mesh, 2850.0, order=1, stabilize="bubble", friction=0.1, steps=2)
    assert [factor for factor, *_ in pressed.steps] == [0.5, 1.0]
    assert len(pressed.solution.components[0].vec) > VectorH1(mesh, order=1).ndof
    table = pressed.steps[-1][-1]
    assert set(np.unique(table["status"])) <= {0, 1, 2}
    assert table["friction"] == pytest.approx(0.1)


def test_hertz3d_help_and_refusals(capsys):
    text = Help(capsys, hertz3d.main)
    assert "python tutorials/examples/hertz3d.py" in text
    assert "(default: 0.3125)" in text
    assert "--h: 0 is no finite number > 0" in Refused(capsys, hertz3d.main, "--h", "0")
    assert "'cube'" in Refused(capsys, hertz3d.main, "--shape", "cube")
    assert "--friction" in Refused(capsys, hertz3d.main, "--friction", "-1")
