"""Twisting blocks as a command: mesh, a turn without friction, files, bad values."""

import json

import pytest
import twistblocks
from commandline import Help, Refused
from ngsolve import BND, Integrate

from ngslac.meshes import CheckNonMatching3D


def test_twist_mesh():
    mesh = twistblocks.TwistMesh(4)
    assert set(mesh.GetMaterials()) == {"upper", "lower"}
    areas = {"upper_bottom": 1.0, "upper_top": 1.0, "lower_top": 1.6**2, "lower_bottom": 1.6**2}
    for name, area in areas.items():
        found = Integrate(1, mesh, BND, definedon=mesh.Boundaries(name))
        assert found == pytest.approx(area, abs=1e-12)
    CheckNonMatching3D(mesh, slave="upper_bottom", master="lower_top")


def test_twistblocks_command(tmp_path, capsys):
    pytest.importorskip("matplotlib")
    file = tmp_path / "new" / "figures.json"
    options = ["--n", "2", "--steps", "1", "--angle", "10", "--friction", "0", "--rigid"]
    twistblocks.main([*options, "--out", str(tmp_path), "--json", str(file)])
    figures = json.loads(file.read_text())
    assert figures["steps"] == figures["converged_steps"] == 1
    assert figures["angle"] == pytest.approx([0, 0, 10])
    assert abs(figures["torque"][-1]) < 1e-3 * figures["force"][-1]
    assert "10.0 degrees" in capsys.readouterr().out
    for name in ("twistblocks.png", "twistblocks.vtu", "twistblocks.html"):
        assert (tmp_path / name).stat().st_size > 2000


@pytest.mark.parametrize(
    ("option", "value", "message"),
    [
        ("--steps", "0", "--steps"),
        ("--order", "1", "--order"),
        ("--friction", "-0.1", "--friction"),
        ("--n", "1", "n = 1"),
    ],
)
def test_twistblocks_refuses(option, value, message, capsys):
    assert message in Refused(capsys, twistblocks.main, option, value)


def test_twistblocks_help(capsys):
    assert "(default: 180.0)" in Help(capsys, twistblocks.main)
