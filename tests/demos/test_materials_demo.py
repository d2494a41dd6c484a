"""The demo materials: command line, files, refusals. Its numbers: validation/test_materials.py."""

import json

import pytest

from ngslac.demos import materials


def test_command_line_writes_everything(tmp_path, capsys):
    pytest.importorskip("matplotlib")
    file, picture = tmp_path / "new" / "figures.json", tmp_path / "picture.png"
    materials.main(["--json", str(file), "--picture", str(picture)])
    figures = json.loads(file.read_text())
    assert set(figures) == {"rubber", "thermal"}
    assert picture.stat().st_size > 20000
    assert "peak_pressure" in capsys.readouterr().out
    assert figures["thermal"]["pressure"] == pytest.approx(figures["thermal"]["lame"], rel=2e-3)


def test_one_case_and_quiet(capsys):
    materials.main(["--cases", "thermal", "--quiet"])
    assert capsys.readouterr().out == ""


def test_refusals(tmp_path):
    with pytest.raises(ValueError, match="unknown cases"):
        materials.Run(cases=["steel"])
    pytest.importorskip("matplotlib")
    with pytest.raises(ValueError, match="all cases"):
        materials.Run(cases=["thermal"], picture=tmp_path / "x.png")
