"""The comparison with other codes: meshes and measures, the two peers in NGSolve, the tables."""

import json
import sys
from pathlib import Path

import numpy as np
import pytest
from ngsolve import GetNumThreads, SetNumThreads

sys.path.insert(0, str(Path(__file__).parent / "peers"))

import compare
import contactboundary
import lac
import meshes
import metrics
import peercommand

from ngslac.reference import HertzLine, HertzPoint

SIZES = {"hertz": 3.0, "sphere": 4.0, "patch": 1 / 3}


@pytest.fixture(scope="module", autouse=True)
def _one_thread():
    """The problems here are so small that a second thread only waits."""
    before = GetNumThreads()
    SetNumThreads(1)
    yield
    SetNumThreads(before)


@pytest.fixture(scope="module")
def files(tmp_path_factory):
    """A coarse mesh of each problem."""
    folder = tmp_path_factory.mktemp("meshes")
    names = {problem: folder / f"{problem}_{h:g}.npz" for problem, h in SIZES.items()}
    for problem, file in names.items():
        meshes.Make(problem, SIZES[problem], file)
    return names


# ---------------------------------------------------------------- meshes


@pytest.mark.parametrize("problem", SIZES)
def test_mesh_is_closed_and_oriented(files, problem):
    mesh = meshes.Load(files[problem])
    dim, points = mesh.dim, mesh.points
    sides = points[mesh.elements[:, 1 : dim + 1]] - points[mesh.elements[:, :1]]
    volume = np.linalg.det(sides) / (2 if dim == 2 else 6)
    assert volume.min() > 0
    along = points[mesh.faces[:, 1:dim]] - points[mesh.faces[:, :1]]
    turned = np.stack([along[:, 0, 1], -along[:, 0, 0]], axis=-1) if dim == 2 else None
    normal = turned if dim == 2 else np.cross(along[:, 0], along[:, 1]) / 2
    flux = (normal * points[mesh.faces[:, :dim]].mean(axis=1)).sum()
    assert flux / dim == pytest.approx(volume.sum(), rel=1e-12)
    for face, owner in zip(mesh.faces, mesh.owners, strict=True):
        assert set(face) <= set(mesh.elements[owner])


@pytest.mark.parametrize("problem", SIZES)
def test_mesh_has_mid_nodes_and_names(files, problem):
    mesh = meshes.Load(files[problem])
    ends = mesh.elements[:, meshes.EDGES[mesh.dim]]
    bow = mesh.points[mesh.elements[:, mesh.dim + 1 :]] - mesh.points[ends].mean(axis=2)
    size = np.ptp(mesh.points[ends], axis=2).max(axis=-1)
    assert (np.linalg.norm(bow, axis=-1) < 0.2 * size).all()
    assert {"slave", "master", *meshes.HELD[problem]} <= set(mesh.names)
    slave, master = mesh.Nodes(2, "slave"), mesh.Nodes(2, "master")
    assert not set(slave) & set(master)
    if problem == "patch":
        assert np.abs(bow).max() < 1e-14
        return
    centre = np.eye(mesh.dim)[-1] * metrics.RADIUS
    distance = np.linalg.norm(mesh.points[slave] - centre, axis=1)
    assert distance == pytest.approx(metrics.RADIUS, rel=1e-4)
    assert mesh.problem != "hertz" or mesh.points[mesh.load] == pytest.approx([0, 100], abs=1e-9)


# ---------------------------------------------------------------- measures


def test_data_are_those_of_the_reference_solutions():
    bodies = {"radius1": 50, "young1": 210e3, "nu1": 0.3, "young2": 70e3, "nu2": 0.3}
    line = HertzLine(force=metrics.LINE_FORCE, **bodies)
    x = np.linspace(0, 8, 20)
    assert line.halfwidth == pytest.approx(metrics.LINE_HALFWIDTH)
    assert metrics.LinePressure(x) == pytest.approx(line.Pressure(x))
    point = HertzPoint(force=metrics.SPHERE_FORCE, **bodies)
    assert point.contact_radius == pytest.approx(5)
    assert metrics.SpherePressure(x) == pytest.approx(point.Pressure(x))


def test_line_errors():
    x = np.random.default_rng(1).permutation(np.linspace(0, 15, 4001))
    exact = metrics.LinePressure(x)
    for value in metrics.LineErrors(x, exact).values():
        assert value == pytest.approx(0, abs=1e-3)
    doubled = metrics.LineErrors(x, 2 * exact)
    assert doubled == pytest.approx({"peak": 1, "l2": 1, "force": 1}, abs=2e-3)


def test_sphere_errors():
    points, faces = Disc(30)
    exact = metrics.SpherePressure(np.hypot(*points.T[:2]))
    errors = metrics.SphereErrors(points, faces, exact)
    assert errors["peak"] == pytest.approx(0, abs=1e-12)
    assert errors["force"] == pytest.approx(0, abs=5e-3)
    assert 0.005 < errors["l2"] < 0.03  # of a linear interpolation: not only the corners count
    nothing = metrics.SphereErrors(points, faces, 0 * exact)
    assert nothing == pytest.approx({"peak": -1, "l2": 1, "force": -1})
    assert metrics.Centroids(5).mean(axis=0) == pytest.approx(1 / 3)


def Disc(n):
    """Triangles on the quarter disc of radius 7: n rings."""
    r, t = (
        grid.ravel() for grid in np.meshgrid(np.linspace(0, 7, n + 1), np.linspace(0, 1, n + 1))
    )
    points = np.stack([r * np.cos(t * np.pi / 2), r * np.sin(t * np.pi / 2), 0 * r], axis=-1)
    number = np.arange((n + 1) ** 2).reshape(n + 1, n + 1)
    a, b, c, d = (
        q.ravel() for q in (number[:-1, :-1], number[:-1, 1:], number[1:, 1:], number[1:, :-1])
    )
    return points, np.vstack([np.stack([a, b, c], axis=-1), np.stack([a, c, d], axis=-1)])


@pytest.mark.parametrize("order", [1, 2])
def test_patch_errors(files, order):
    mesh = meshes.Load(files["patch"])
    exact = metrics.PatchDisplacement(mesh.Points(order))
    assert metrics.PatchErrors(mesh, exact) == pytest.approx(
        {"displacement": 0, "stress": 0, "penetration": 0}, abs=1e-12
    )
    errors = metrics.PatchErrors(mesh, 1.02 * exact)
    assert errors["displacement"] == pytest.approx(0.02)
    assert errors["stress"] == pytest.approx(0.02)
    sunk = exact.copy()
    sunk[mesh.MaterialNodes(order, "upper"), 2] -= 1e-5
    errors = metrics.PatchErrors(mesh, sunk)
    assert errors["penetration"] == pytest.approx(0.005)
    assert errors["stress"] < 1e-12


def test_patch_stress_of_second_order():
    """sigma_zz of a quadratic displacement at the corners of the elements."""
    sides = np.array([[[2.0, 0, 0], [0, 1, 0], [0.5, 0, 3]]])
    corners = np.vstack([np.zeros(3), sides[0]])
    nodes = np.vstack([corners, corners[np.array(meshes.EDGES[3])].mean(axis=1)])
    values = np.stack([nodes[:, 0] * nodes[:, 1], 0 * nodes[:, 0], nodes[:, 2] ** 2], axis=-1)
    lame, shear = (1e3 * 0.3 / (1.3 * 0.4), 1e3 / 2.6)
    exact = 2 * shear * 2 * corners[:, 2] + lame * (corners[:, 1] + 2 * corners[:, 2])
    assert metrics.VerticalStress(values[None], sides, 2)[0] == pytest.approx(exact)
    volume = np.linalg.det(sides)
    square = metrics.SquareNorm(np.ones((1, 10, 3)), volume, 2)
    assert square == pytest.approx(3 * volume[0] / 6)


# ---------------------------------------------------------------- the peers in NGSolve


def Solved(script, files, problem, *options, tmp_path):
    """The row that a peer writes, run in this process."""
    file = tmp_path / "row.json"
    argv = [problem, str(files[problem]), "--json", str(file), *options]
    assert peercommand.Main(script.Solve, peer="peer", options=script.Options, argv=argv) == 0
    row = json.loads(file.read_text())
    assert {"version", "dofs", "iterations", "settings", "cpu"} <= row.keys()
    assert row["seconds"] > 0
    assert 0.05 < row["memory"] < 50
    return row


CHEAP = ("--inverse", "umfpack")  # small matrices: MKL takes longer to start than to solve


def test_patch_in_ngslac_and_contactboundary(files, tmp_path):
    options = ("--order", "1", *CHEAP)
    row = Solved(lac, files, "patch", *options, tmp_path=tmp_path)
    assert max(row["displacement"], row["stress"]) < 1e-12
    row = Solved(contactboundary, files, "patch", *options, tmp_path=tmp_path)
    assert row["penetration"] == pytest.approx(SIZES["patch"] / 20, rel=1e-3)
    row = Solved(
        contactboundary, files, "patch", *options, "--variant", "nitsche", tmp_path=tmp_path
    )
    assert abs(row["penetration"]) < 1e-4
    assert row["displacement"] < 1e-3


@pytest.mark.parametrize("friction", [(), ("--friction", "0.2", "--steps", "2")])
def test_hertz_in_ngslac_and_contactboundary(files, tmp_path, friction):
    rows = [
        Solved(script, files, "hertz", *friction, *CHEAP, tmp_path=tmp_path)
        for script in (lac, contactboundary)
    ]
    for row in rows:
        assert abs(row["peak"]) < 0.08
        assert row["l2"] < 0.15
        assert abs(row["force"]) < 0.01
    assert rows[0]["dofs"] == rows[1]["dofs"]


def test_sphere_with_bubbles(files, tmp_path):
    row = Solved(
        lac, files, "sphere", "--order", "1", "--variant", "bubble", *CHEAP, tmp_path=tmp_path
    )
    assert row["macros"] == len(meshes.Load(files["sphere"]).Faces(1, "slave"))
    assert abs(row["force"]) < 0.05


def test_failures_of_a_peer(files, tmp_path, capsys):
    def Absent(mesh, arguments, watch):
        raise peercommand.NotInstalledError("no module abc: pip install abc")

    argv = ["patch", str(files["patch"]), "--json", str(tmp_path / "row.json")]
    assert peercommand.Main(Absent, peer="abc", argv=argv) == 3
    assert capsys.readouterr().out == "no module abc: pip install abc\n"
    argv[0] = "sphere"
    assert peercommand.Main(lac.Solve, peer="abc", argv=argv) == 1
    assert "a mesh of the problem patch" in capsys.readouterr().err
    assert not (tmp_path / "row.json").exists()


# ---------------------------------------------------------------- compare.py

WRITES = """
import json, sys
row = dict(h=0.5, order=int(sys.argv[4]), dofs=7, iterations=2, cpu=1.0, memory=0.1, version="1")
row |= dict(settings=" ".join(sys.argv[5:7]), seconds=3.0, displacement=1e-15, stress=0.01)
json.dump(row | dict(penetration=-0.5), open(sys.argv[-1], "w"))
"""
SCRIPTS = {
    "lac.py": WRITES,
    "contactboundary.py": WRITES.replace("3.0", "2.0"),
    "calculix.py": "print('install ccx'); exit(3)",
    "kratos.py": "print('on the way'); raise ValueError('no convergence')",
}


def test_command_line(monkeypatch, tmp_path, capsys, files):
    for name, text in SCRIPTS.items():
        (tmp_path / name).write_text(text)
    monkeypatch.setattr(compare, "FOLDER", tmp_path)
    peers = ["ngslac", "bubble", "penalty", "calculix", "kratos"]
    output, tables = tmp_path / "figures.json", tmp_path / "tables.md"
    options = ["--problems", "patch", "--sizes", f"patch={1 / 3:g}", "--peers", *peers]
    options += ["--meshes", str(files["patch"].parent), "--inverse", "umfpack"]
    compare.main([*options, "--json", str(output), "--markdown", str(tables)])
    figures, text = json.loads(output.read_text()), tables.read_text()
    assert text.strip() in capsys.readouterr().out
    assert [row["title"] for row in figures["rows"]] == ["ngslac", "ContactBoundary, penalty"]
    assert figures["rows"][0]["settings"] == "--inverse umfpack"
    assert text.index("| ContactBoundary") < text.index("| ngslac")  # the faster one first
    for reason in ("not installed: install ccx", "failed: ValueError: no conv"):
        assert reason in text
    assert len(figures["missing"]) == 2


def test_time_limit(monkeypatch, tmp_path, files):
    (tmp_path / "getfem_peer.py").write_text("import time; time.sleep(60)")
    monkeypatch.setattr(compare, "FOLDER", tmp_path)
    peer, case = compare.PEERS["getfem"], compare.CASES["patch"]
    result = compare.Run("patch", peer, case, files["patch"], limit=0.2)
    assert result.reason == "stopped after 0.2 s"


def test_cannot(files):
    result = compare.Run(
        "friction", compare.PEERS["nitsche"], compare.CASES["friction"], files["hertz"]
    )
    assert result.reason == "does not solve this problem"


@pytest.mark.parametrize("option", ["sphere", "cube=1"])
def test_bad_sizes(option):
    with pytest.raises(SystemExit, match="write"):
        compare.Sizes([option])


def test_quick(monkeypatch, tmp_path):
    import scaling

    ratios = {
        f"{name}_over_elastic": 2.0 for name in ("frictionless", "friction_step", "ten_steps")
    }
    asked = {}
    monkeypatch.setattr(scaling, "Ratios", lambda **options: asked.update(options) or ratios)
    file = tmp_path / "quick.json"
    compare.main(["--quick", "--json", str(file), "--solver", "saddle"])
    assert json.loads(file.read_text()) == ratios
    assert (asked["ndof"], asked["solver"]) == (100_000, "saddle")
