"""The demo of the patch tests in 3D: figures, table, files; the examples of the mesh builders."""

import doctest
import importlib
import json

import pytest

from ngslac.demos import patch3d
from ngslac.demos.patch3d import Case, Cases, Run, Solve

MODULES = ["_blocks3d", "_boxes", "_geometry3d", "_spheres", "patch3d"]
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


def test_json_and_table(tmp_path, capsys, few):
    file = tmp_path / "new" / "patch3d.json"
    patch3d.main(["--json", str(file)])
    figures = json.loads(file.read_text())
    assert figures["max_error"] < 1e-11
    assert [row["name"] for row in figures["cases"]] == [case.name for case in FEW]
    errors = [(row["stress_error"], row["multiplier_error"]) for row in figures["cases"]]
    assert figures["max_error"] == max(map(max, errors))
    assert all(row["dofs"] > 100 and row["macros"] > 1 for row in figures["cases"])
    assert capsys.readouterr().out.count("\n") == len(FEW) + 3


def test_files(tmp_path, capsys, few):
    pytest.importorskip("matplotlib")
    patch3d.main(["--quiet", "--out", str(tmp_path / "new")])
    sizes = {file.name: file.stat().st_size for file in (tmp_path / "new").iterdir()}
    names = ["patch3d_interfaces.png", "patch3d_errors.png", "patch3d.html", "patch3d.vtu"]
    assert sizes.keys() == set(names)
    assert min(sizes.values()) > 5000
    assert capsys.readouterr().out == ""


@pytest.mark.parametrize("oblique", [False, True])
def test_friction_carries_shear(oblique):
    case = Case("prism", 1, "bubble", oblique, friction=0.4)
    solution = Solve(case)
    table = solution.contact.Table()
    assert set(table["status"]) == {1}
    assert table["traction"] @ case.axes[:, 0] == pytest.approx(0.2 * table["pressure"])
    assert solution.figures["multiplier_error"] < 1e-11


def test_a_wrong_load_shows(monkeypatch):
    right = patch3d._Load
    monkeypatch.setattr(patch3d, "_Load", lambda *args: 1.1 * right(*args))
    figures = Solve(Case("hex", 1, "bubble")).figures
    assert min(figures["stress_error"], figures["multiplier_error"]) > 1e-3


def test_bad_input():
    with pytest.raises(ValueError, match="partition must be one of agglomerated, bubble, split"):
        Case("tet", 1, "none")
    with pytest.raises(ValueError, match="kind must be one of tet"):
        Run(cases=[Case("brick")])


@pytest.mark.parametrize("name", MODULES)
def test_examples_in_docstrings(name):
    module = importlib.import_module(f"ngslac.demos.{name}")
    result = doctest.testmod(module)
    assert result.attempted > 0
    assert result.failed == 0
