"""The example materials: command line, files, refusals; its numbers: test_materials.py."""

import json

import materials
import pytest
from commandline import Help, Refused


def test_materials_command(tmp_path, capsys):
    pytest.importorskip("matplotlib")
    file = tmp_path / "new" / "figures.json"
    materials.main(
        ["--json", str(file), "--out", str(tmp_path), "--squeeze", "0.05", "--steps", "1"]
    )
    figures = json.loads(file.read_text())
    assert set(figures) == {"rubber", "thermal"}
    for name in ("materials.png", "materials_rubber.vtu", "materials_thermal.vtu"):
        assert (tmp_path / name).stat().st_size > 3000
    assert "peak_pressure" in capsys.readouterr().out
    assert figures["thermal"]["pressure"] == pytest.approx(figures["thermal"]["lame"], rel=2e-3)
    force = materials.SqueezeForce(0.05)
    assert figures["rubber"]["force"] == pytest.approx(force, rel=0.05)


def test_one_case_and_quiet(capsys, tmp_path):
    found = materials.main(["--cases", "thermal", "--quiet", "--out", str(tmp_path)])
    assert [*found] == ["thermal"]
    assert (tmp_path / "materials.png").exists()
    assert capsys.readouterr().out == ""


def test_materials_help_and_bad_values(capsys):
    assert "(default: 0.25)" in Help(capsys, materials.main)
    assert "invalid choice: 'steel'" in Refused(capsys, materials.main, "--cases", "steel")
    assert "--squeeze: -1 is no finite" in Refused(capsys, materials.main, "--squeeze", "-1")
