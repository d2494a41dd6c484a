"""Each class of problems runs on its smallest size, and says what it did; no time is looked at.

Each week: by default the problems are only made.
"""

import json

import class_problems
import classes
import numpy as np
import pytest
from class_list import CLASSES
from ngsolve import CF, Integrate, ds

KEYS = {"name", "dofs", "seconds", "newton", "krylov", "over_best", "over_direct", "memory"}
KEYS |= {"method", "converged", "per", "elastic"}
# Of those that differ by a number only, one.
SAME = ("frictionless", "ten steps", "284k", "by 10", "points", "nu .49", "peer", "64k", ".03")
DIFFERENT = [name for name in CLASSES if not any(same in name for same in SAME)]


@pytest.mark.full
@pytest.mark.parametrize("name", ["hertz 2D ten steps", *DIFFERENT])
def test_class(name):
    row = classes.Measure(name, quick=True)
    assert row["converged"], row["reason"]
    assert row.keys() >= KEYS
    assert row["newton"] >= 1
    assert 0 < row["over_best"] == pytest.approx(max(row["over_best"], row["over_direct"]))
    assert min(row["seconds"], row["memory"]) > 0
    assert row["method"] in ("interface", "direct", "iterative")
    assert "sparsecholesky" in row["elastic"] or "umfpack" in row["elastic"]


def test_many_bodies_meet():
    """All faces between the cubes, and between the sheets, have partners."""
    for problem, area in ((class_problems.Cubes(1), 54), (class_problems.Sheets(2), 7)):
        mesh = problem.Mesh()
        contacts = problem.Contact(problem.Product(mesh))[1]
        for contact in contacts:
            contact.Update()
        assert sum(c.Table()["area"].sum() for c in contacts) == pytest.approx(area, rel=1e-10)
        outside = sum(Integrate(CF(1) * ds(side), mesh) for side in ("top", "bottom"))
        assert outside == pytest.approx(18 if area == 54 else 2)


@pytest.mark.parametrize("aligned", [False, True])
def test_checkerboard(aligned):
    """As much soft as stiff, alike from cell to cell."""
    problem = class_problems.Checkerboard(8, 8, aligned=aligned)
    mesh = problem.Mesh()
    young = problem.young(mesh)
    corner = [float(young(mesh(p, 0.1, 0.1))) for p in (0.1, 0.4, 0.6, 0.9)]
    assert corner == pytest.approx([2e3, 2e7, 2e3, 2e7])
    assert Integrate(young, mesh) == pytest.approx(1.0001e7 * 2, rel=0.05)


@pytest.mark.full
def test_time_limit_and_errors(tmp_path, monkeypatch):
    late = classes.Run("two blocks", tmp_path, quick=True, limit=1e-3)
    assert (late["converged"], late["reason"]) == (False, "stopped after 0.001 s")
    row = classes.Run("no such class", tmp_path)
    assert "there are sphere" in row["reason"]
    failing = CLASSES["nu .49"].__class__(None, CLASSES["nu .49"].quick, run=lambda *_: 1 / 0)
    monkeypatch.setitem(CLASSES, "failing", failing)
    row = classes.Measure("failing", quick=True)
    assert row["reason"] == "ZeroDivisionError: division by zero"
    assert row["elastic"]["own"]["error"] < 1e-8
    assert row.keys() >= KEYS
    assert "fails: ZeroDivision" in classes.Table([row])


@pytest.mark.full
def test_command_line(tmp_path, capsys):
    file = tmp_path / "rows.json"
    classes.main(["--quick", "--only", "nu*99", "*Lagrangian", "--here", "--json", str(file)])
    rows = json.loads(file.read_text())["classes"]
    assert [row["name"] for row in rows] == ["nu .4999", "augmented Lagrangian"]
    lines = capsys.readouterr().out.splitlines()
    assert np.unique([len(line) for line in lines[2:]]).size == 1
    with pytest.raises(SystemExit, match="first-order hexahedra"):
        classes.Chosen(["nothing*"])
