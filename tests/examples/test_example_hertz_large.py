"""The flattened cylinder as a command: its mesh, Hertz' force, files, bad values."""

import json

import hertz_large
import numpy as np
import pytest
from commandline import Help, Refused
from ngsolve import CF, Integrate


def test_hertz_force_inverts_the_approach():
    for force in (1e-4, 1e-2, 0.3):
        approach = hertz_large.Approach(force, 0.3, 2.0)
        assert hertz_large.HertzForce(approach, 0.3, 2.0) == pytest.approx(force, rel=1e-10)


def test_cylinder_mesh():
    mesh = hertz_large.CylinderMesh(0.1)
    area = Integrate(CF(1), mesh, definedon=mesh.Materials("cylinder"))
    assert area == pytest.approx(np.pi / 4, rel=1e-6)
    assert set(mesh.GetMaterials()) == {"cylinder", "plate"}
    vertices = {
        name: {v.nr for el in mesh.Boundaries(name).Elements() for v in el.vertices}
        for name in ("slave", "master")
    }
    slave, master = (
        np.array(sorted(mesh.vertices[v].point[0] for v in numbers))
        for numbers in vertices.values()
    )
    distance = np.abs(slave[:, None] - master)
    distance[0, 0] = np.inf  # both at x = 0
    assert distance.min() > 1e-5


def test_hertz_large_command(tmp_path, capsys):
    pytest.importorskip("matplotlib")
    file = tmp_path / "new" / "figures.json"
    options = ["--h", "0.2", "--steps", "2", "--depth", "0.02", "--order", "3"]
    hertz_large.main([*options, "--out", str(tmp_path), "--json", str(file)])
    figures = json.loads(file.read_text())
    assert figures["steps"] == figures["converged_steps"] == 2
    assert figures["force"][-1] == pytest.approx(figures["hertz"][-1], rel=0.1)
    assert "by Hertz" in capsys.readouterr().out
    for name in ("hertz_large.png", "hertz_large.vtu"):
        assert (tmp_path / name).stat().st_size > 3000


@pytest.mark.parametrize(
    ("option", "value", "message"),
    [
        ("--steps", "0", "--steps"),
        ("--order", "1", "--order"),
        ("--nu", "0.5", "nu"),
        ("--depth", "0.8", "depth = 0.8"),
        ("--h", "0", "--h"),
    ],
)
def test_hertz_large_refuses(option, value, message, capsys):
    assert message in Refused(capsys, hertz_large.main, option, value)


def test_hertz_large_help(capsys):
    assert "(default: 0.3)" in Help(capsys, hertz_large.main)
