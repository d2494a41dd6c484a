"""The example patch3d: cases, errors, command line, files."""

import json

import patch3d
import pytest
from commandline import Help, Refused
from patch3d import Case, Cases, Run, Solve

FEW = [Case("tet", 1, "split", True), Case("pyramid", 1, "agglomerated"), Case("hex", 2)]


@pytest.fixture
def few(monkeypatch):
    monkeypatch.setattr(patch3d, "Cases", lambda friction: FEW)


def test_all_cases():
    """Every element and order with every partition, flat and oblique."""
    names = {case.name for case in Cases()}
    assert len(names) == len(Cases()) == 11 * 3 * 2
    assert "P3 tet split oblique" in names
    assert "P2 prism_side agglomerated flat" in names
    assert "Q2 hex bubble flat" in names


def test_patch3d_command(tmp_path, capsys, few):
    pytest.importorskip("matplotlib")
    file, out = tmp_path / "new" / "patch3d.json", tmp_path / "out"
    patch3d.main(["--json", str(file), "--out", str(out)])
    figures = json.loads(file.read_text())
    assert figures["max_error"] < 1e-11
    assert [row["name"] for row in figures["cases"]] == [case.name for case in FEW]
    errors = [(row["stress_error"], row["multiplier_error"]) for row in figures["cases"]]
    assert figures["max_error"] == max(map(max, errors))
    assert all(row["dofs"] > 100 and row["macros"] > 1 for row in figures["cases"])
    assert capsys.readouterr().out.count("\n") == len(FEW) + 1
    sizes = {path.name: path.stat().st_size for path in out.iterdir()}
    assert sizes.keys() == {"patch3d_errors.png", "patch3d_contact.vtu", "patch3d_segments.vtu"}
    assert min(sizes.values()) > 1000


@pytest.mark.parametrize("oblique", [False, True])
def test_friction_carries_shear(oblique):
    case = Case("prism", 1, "bubble", oblique, friction=0.4)
    _, contact, figures = Solve(case)
    table = contact.Table()
    assert set(table["status"]) == {1}
    assert table["traction"] @ case.axes[:, 0] == pytest.approx(0.2 * table["pressure"])
    assert figures["multiplier_error"] < 1e-11


def test_a_wrong_load_shows(monkeypatch):
    right = patch3d.Load
    monkeypatch.setattr(patch3d, "Load", lambda *args: 1.1 * right(*args))
    _, _, figures = Solve(Case("hex", 1, "bubble"))
    assert min(figures["stress_error"], figures["multiplier_error"]) > 1e-3


def test_patch3d_help_and_refusals(capsys):
    assert "python tutorials/examples/patch3d.py --out results" in Help(capsys, patch3d.main)
    assert "--friction" in Refused(capsys, patch3d.main, "--friction", "-1", "--quiet")
    with pytest.raises(ValueError, match="partition must be one of"):
        Solve(Case("tet", 1, "none"))
    with pytest.raises(ValueError, match="kind must be one of tet"):
        Run(cases=[Case("brick")])
