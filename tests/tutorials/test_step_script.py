"""The script from a STEP file to contact forces runs, and what it computes is right."""

import runpy
import sys

import numpy as np
import pytest
from netgen.occ import OCCGeometry
from ngsolve import CF, Integrate, x, y, z
from notebooks import ROOT, Files

from ngslac.meshes.geometry import CheckNonMatching

SCRIPT = ROOT / "tutorials" / "step_to_contact.py"


@pytest.fixture(scope="module")
def script(tmp_path_factory):
    """The names of the script when it has run, among them `folder`."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(sys, "argv", [str(SCRIPT), str(tmp_path_factory.mktemp("step"))])
        return runpy.run_path(str(SCRIPT))


def test_two_solids_in_the_step_file(script):
    solids = OCCGeometry(str(script["folder"] / "assembly.step")).shape.solids
    hole = np.pi * 4.5**2
    foot, back, boss = 40 * 30 * 8, 8 * 30 * 32, np.pi * 8**2
    bracket, plate = foot + back + boss - 9 * hole, 60 * 40 * 10 - np.pi * 4**2 * 10
    assert sorted(s.mass for s in solids) == pytest.approx([bracket, plate], rel=1e-6)


def test_parts_are_meshed_separately(script):
    mesh = script["mesh"]
    assert mesh.GetMaterials() == ("plate", "bracket")
    nodes = [
        {v.nr for el in mesh.Materials(name).Elements() for v in el.vertices}
        for name in mesh.GetMaterials()
    ]
    assert not nodes[0] & nodes[1]
    assert CheckNonMatching(mesh) > 1e-3


def test_faces_found_by_position(script):
    areas = script["areas"]
    ring = np.pi * (8**2 - 4.5**2)
    exact = {"back": 1200, "washer": ring, "slave": 1200 - np.pi * 4.5**2}
    exact |= dict.fromkeys(("bottom", "master"), 2400 - np.pi * 4**2)
    assert areas == pytest.approx(exact, rel=1e-3)
    report = script["contact"].Check()
    assert report.paired_area == pytest.approx(areas["slave"], rel=1e-9)
    assert len(report.unpaired) == len(report.partial) == len(report.penetrating) == 0


def test_steps(script):
    rows = np.array(script["rows"])
    np.testing.assert_allclose(rows[:, 0], 1)
    np.testing.assert_allclose(rows[:, 1], np.arange(6) / 5, atol=1e-12)
    assert np.all(np.diff(rows[:, 8]) > 0)  # the largest pressure grows with the pull
    assert rows[-1, 8] == pytest.approx(46.8, rel=0.05)
    assert rows[-1, 9] == pytest.approx(643, rel=0.1)
    assert np.bincount(script["contact"].Table()["status"], minlength=3).min() >= 2


def test_contact_balances_the_loads(script):
    rows, mesh = np.array(script["rows"]), script["mesh"]
    forces, moments = [script["bolt_force"], script["pull_force"]], []
    for name, force in zip(("washer", "back"), forces, strict=True):
        region = mesh.Boundaries(name)
        center = np.array(Integrate(CF((x, y, z)), region)) / Integrate(CF(1), region)
        moments.append(np.cross(center, force) / 1000)
    loads = rows[:, :2] @ np.array(forces)
    np.testing.assert_allclose(rows[:, 2:5], -loads, rtol=0, atol=1e-8 * 12000)
    loads = rows[:, :2] @ np.array(moments)
    np.testing.assert_allclose(rows[:, 5:8], -loads, rtol=0, atol=1e-8 * abs(loads).max())


def test_files(script):
    names = ["assembly.step", "contact.vtu", "segments.vtu", "volume.vtu"]
    assert Files(script["folder"]) == names
