"""The scripts of the how-to pages run as they stand, and their results are the stated ones."""

import re
from pathlib import Path

import numpy as np
import pytest
from netgen.occ import OCCGeometry

HOWTO = Path(__file__).parents[2] / "docs" / "howto"
SCRIPT = re.compile(r"^```py\n(.*?)^```", re.MULTILINE | re.DOTALL)


@pytest.fixture
def quick(monkeypatch):
    """Netgen makes the same meshes without its threads, which take seconds on a busy machine."""
    generate = OCCGeometry.GenerateMesh

    def Generate(self, *args, **options):
        return generate(self, *args, parallel_meshing=False, **options)

    monkeypatch.setattr(OCCGeometry, "GenerateMesh", Generate)


@pytest.fixture
def run(tmp_path, monkeypatch, quick):
    """Execute the only script of a page in a folder of its own; the names it leaves."""

    def Run(page):
        monkeypatch.chdir(tmp_path)
        (script,) = SCRIPT.findall((HOWTO / f"{page}.md").read_text())
        names = {"__name__": "__main__"}
        exec(compile(script, f"{page}.md", "exec"), names)
        return names

    return Run


def test_press_fit(run):
    names = run("press_fit")
    assert names["lame"] == pytest.approx(69.23, abs=0.005)
    assert names["pressure"] == pytest.approx(names["lame"], rel=3e-3)


def test_rigid_tool(run):
    names = run("rigid_tool")
    push, lift = names["contact"].Force()
    assert lift == pytest.approx(-0.373, rel=0.02)
    assert abs(push) < 0.005 * abs(lift)  # symmetric but for the mesh


def test_bolt_preload(run):
    names = run("bolt_preload")
    assert names["clamp"] == pytest.approx([names["inside"]] * 3, rel=1e-5)
    assert names["inside"] == pytest.approx(8360, rel=0.01)


def test_heat_across_interface(run):
    names = run("heat_across_interface")
    assert names["exact"] == pytest.approx(121.554, abs=1e-3)
    assert names["heat"] == pytest.approx(names["exact"], rel=1e-4)
    assert names["middle"] == pytest.approx(88.80, abs=0.02)


def test_many_bodies(run):
    names = run("many_bodies")
    for contact in names["contacts"]:
        assert contact.Force() == pytest.approx([-1000, 0, 5000], abs=1e-6)


def test_reaction_forces(run):
    names = run("reaction_forces")
    top, bottom = (np.array(names["forces"][name]) for name in ("top", "bottom"))
    assert bottom == pytest.approx([-6.05, 140.03], rel=0.02)
    assert bottom == pytest.approx(names["contact"].Force(), rel=1e-9)
    assert top == pytest.approx(-bottom, rel=1e-9)
    assert names["moment"] == pytest.approx(names["contact"].Moment((0, 0)), rel=1e-9)


def test_convergence_study(run):
    names = run("convergence_study")
    assert 1.5 < names["order"] < 2.5
    assert names["limit"] == pytest.approx(137.19, rel=1e-3)
    assert np.all(np.diff(names["errors"]) < 0)
    assert names["errors"] == pytest.approx([3.1e-3, 1.14e-3, 3e-4, 8e-5], rel=0.2)


def test_from_contactboundary(run):
    names = run("from_contactboundary")
    assert names["lac"] == pytest.approx(137.45, rel=5e-3)
    assert names["contact"].Force()[1] == pytest.approx(names["lac"], rel=1e-9)
    # The penalty gives way by 7e-6 of the 1e-3 that are pressed.
    assert 0.99 < names["penalty"] / names["lac"] < 1


def test_from_calculix(run, tmp_path):
    names = run("from_calculix")
    assert names["contact"].Force() == pytest.approx([0, 0, 5000], abs=1e-6)
    assert (tmp_path / "slave.vtu").exists()


def test_choosing_slave(run):
    names = run("choosing_slave")
    fine, coarse, both = names["results"].values()
    assert both[:2] == pytest.approx((0.00904, 0.0571), rel=0.01)
    assert fine[:2] == pytest.approx(both[:2], rel=0.01)
    assert coarse[:2] == pytest.approx(both[:2], rel=0.01)


def test_when_it_fails(run):
    names = run("when_it_fails")
    floats, slides = names["messages"]
    assert "'upper' floats (translation in x)" in floats
    assert "'upper' slides away" in slides
    assert names["contact"].Force() == pytest.approx([20, 100], rel=1e-9)


def test_on_many_cores(run):
    assert run("on_many_cores")["contact"].Force() == pytest.approx([0, 0, 0.01], abs=1e-9)
