"""The comparison with other codes: meshes and measures, the two peers in NGSolve, the tables."""

import json
import shutil

import calculix
import compare
import contactboundary
import kratos
import lac
import meshes
import metrics
import numpy as np
import peercommand
import pytest
from equal_accuracy import Matches
from scipy.spatial import Delaunay

from ngslac.reference import HertzLine, HertzPoint

# ---------------------------------------------------------------- meshes


def test_mesh_is_closed_curved_and_named(mesh):
    dim, points = mesh.dim, mesh.points
    sides = points[mesh.elements[:, 1 : dim + 1]] - points[mesh.elements[:, :1]]
    volume = np.linalg.det(sides) / (2 if dim == 2 else 6)
    assert volume.min() > 0
    along = points[mesh.faces[:, 1:dim]] - points[mesh.faces[:, :1]]
    normal = along[:, 0] @ [[0, -1], [1, 0]] if dim == 2 else np.cross(along[:, 0], along[:, 1]) / 2
    flux = (normal * points[mesh.faces[:, :dim]].mean(axis=1)).sum()
    assert flux / dim == pytest.approx(volume.sum(), rel=1e-12)
    ends = mesh.elements[:, meshes.EDGES[dim]]
    bow = points[mesh.elements[:, dim + 1 :]] - points[ends].mean(axis=2)
    size = np.ptp(points[ends], axis=2).max(axis=-1)
    assert (np.linalg.norm(bow, axis=-1) < 0.2 * size).all()
    assert {"slave", "master", *meshes.HELD[mesh.problem]} <= set(mesh.names)
    slave = mesh.Nodes(2, "slave")
    assert not set(slave) & set(mesh.Nodes(2, "master"))
    if mesh.problem == "patch":
        assert np.abs(bow).max() < 1e-14
    else:
        distance = np.linalg.norm(points[slave] - np.eye(dim)[-1] * metrics.RADIUS, axis=1)
        assert distance == pytest.approx(metrics.RADIUS, rel=1e-4)
    assert mesh.problem != "hertz" or points[mesh.load] == pytest.approx([0, 100], abs=1e-9)
    for face, owner in zip(mesh.faces, mesh.owners, strict=True):
        assert set(face) <= set(mesh.elements[owner])
    mesh.owners[:] = 0
    with pytest.raises(ValueError, match="'master' do not belong"):
        mesh.Opposite("master")


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
    for factor in (1, 2):
        errors = metrics.LineErrors(x, factor * exact)
        assert errors == pytest.approx(dict.fromkeys(("peak", "l2", "force"), factor - 1), abs=2e-3)


def test_sphere_errors():
    """On triangles of a square with sides of 7."""
    grid = np.stack(np.meshgrid(*[np.linspace(0, 7, 41)] * 2), axis=-1).reshape(-1, 2)
    points, faces = np.pad(grid, ((0, 0), (0, 1))), Delaunay(grid).simplices
    exact = metrics.SpherePressure(np.hypot(*grid.T))
    errors = metrics.SphereErrors(points, faces, exact)
    assert errors["peak"] == pytest.approx(0, abs=1e-12)
    assert errors["force"] == pytest.approx(0, abs=5e-3)
    assert 0.005 < errors["l2"] < 0.03  # of a linear interpolation: not only the corners count
    nothing = metrics.SphereErrors(points, faces, 0 * exact)
    assert nothing == pytest.approx({"peak": -1, "l2": 1, "force": -1})


@pytest.mark.parametrize("order", [1, 2])
def test_patch_errors(files, order):
    mesh = meshes.Load(files["patch"])
    exact = metrics.PatchDisplacement(mesh.Points(order))
    sunk = exact.copy()
    sunk[mesh.MaterialNodes(order, "upper"), 2] -= 1e-5
    right, large, low = (metrics.PatchErrors(mesh, u) for u in (exact, 1.02 * exact, sunk))
    assert list(right.values()) == pytest.approx([0, 0, 0], abs=1e-12)
    assert [large["displacement"], large["stress"]] == pytest.approx([0.02, 0.02])
    assert low["penetration"] == pytest.approx(0.005)
    assert low["stress"] < 1e-12


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

CHEAP = ("--inverse", "umfpack")  # small matrices: MKL takes longer to start than to solve
FRICTION = ("--friction", "0.2", "--steps", "2")
LINEAR = ("--order", "1")
NITSCHE, BUBBLE = ("--variant", "nitsche"), ("--variant", "bubble")
HERTZ = {"peak": 0.08, "l2": 0.15, "force": 0.01}


@pytest.mark.parametrize(
    ("driver", "problem", "options", "limits"),
    [
        (lac, "patch", LINEAR, {"displacement": 1e-12, "stress": 1e-12}),
        (contactboundary, "patch", LINEAR, {"penetration": 1 / 60 * 1.001}),
        (contactboundary, "patch", LINEAR + NITSCHE, {"penetration": 1e-4, "displacement": 1e-3}),
        (lac, "hertz", (), HERTZ),
        (contactboundary, "hertz", (), HERTZ),
        (lac, "hertz", FRICTION, HERTZ),
        (contactboundary, "hertz", FRICTION, HERTZ),
        (lac, "sphere", LINEAR + BUBBLE, {"force": 0.05}),
    ],
)
def test_peers_in_ngsolve(driver, problem, options, limits, drive, files):
    code, row = drive(driver, problem, *options, *CHEAP)
    assert code == 0
    assert all(abs(row[name]) < limit for name, limit in limits.items())
    assert {"version", "settings", "cpu", "h"} <= row.keys()
    assert row["iterations"] >= 1
    assert row["seconds"] > 0
    assert 0.05 < row["memory"] < 50
    mesh, order = meshes.Load(files[problem]), 1 if LINEAR[0] in options else 2
    assert BUBBLE[1] in options or row["dofs"] == mesh.Points(order).size
    if BUBBLE[1] in options:
        assert row["macros"] == len(mesh.Faces(1, "slave"))
    if limits.keys() == {"penetration"}:  # a penalty sinks in by a known part
        assert row["penetration"] == pytest.approx(1 / 60, rel=1e-3)


@pytest.mark.parametrize(
    ("driver", "options", "said"),
    [
        (contactboundary, FRICTION, "friction only in 2D"),
        (contactboundary, (*NITSCHE, *FRICTION), "with the penalty"),
        (kratos, (), "use --order 1"),
        (calculix, ("--stiffness", "0"), "a positive --stiffness"),
    ],
)
def test_what_a_peer_cannot_do(driver, options, said, drive, monkeypatch, capsys):
    monkeypatch.setattr(kratos, "MISSING", None)
    monkeypatch.setattr(shutil, "which", lambda name: name)
    assert drive(driver, "sphere", *options) == (1, None)
    assert said in capsys.readouterr().err.splitlines()[-1]


def test_mesh_of_another_problem_is_refused(files, tmp_path, capsys):
    line = ["sphere", str(files["patch"]), "--json", str(tmp_path / "row.json")]
    assert peercommand.Main(lac.Solve, peer="peer", argv=line) == 1
    assert "a mesh of the problem patch" in capsys.readouterr().err


# ---------------------------------------------------------------- compare.py

WRITES = """
import json, sys
row = dict(h=0.5, order=int(sys.argv[4]), dofs=7, iterations=2, cpu=1.0, memory=0.1, version="1")
row |= dict(settings=" ".join(sys.argv[5:7]), seconds=3.0, displacement=1e-15, stress=0.01)
json.dump(row | dict(peer="ngslac", penetration=-0.5), open(sys.argv[-1], "w"))
"""
SCRIPTS = {
    "lac.py": WRITES,
    "contactboundary.py": WRITES.replace("3.0", "2.0").replace("ngslac", "NGSolve"),
    "calculix.py": "print('install ccx'); exit(3)",
    "kratos.py": "import sys; print('on the way'); raise ValueError('order ' + sys.argv[4])",
    "getfem_peer.py": "import time; time.sleep(60)",
}


@pytest.fixture
def scripts(monkeypatch, tmp_path):
    for name, text in SCRIPTS.items():
        (tmp_path / name).write_text(text)
    monkeypatch.setattr(compare, "FOLDER", tmp_path)


@pytest.mark.usefixtures("scripts")
def test_command_line(tmp_path, capsys, files):
    peers = ["ngslac", "first", "bubble", "penalty", "calculix", "kratos"]
    output, tables = tmp_path / "figures.json", tmp_path / "tables.md"
    options = ["--problems", "patch", "--sizes", f"patch={1 / 3:g}", "--peers", *peers]
    options += ["--meshes", str(files["patch"].parent), "--inverse", "umfpack"]
    compare.main([*options, "--json", str(output), "--markdown", str(tables)])
    figures, text = json.loads(output.read_text()), tables.read_text()
    where, _, shown = text.partition("\n\n")
    assert shown.strip() in capsys.readouterr().out
    assert figures["machine"] in where
    assert figures["date"] in where
    found = [(row["title"], row["order"]) for row in figures["rows"]]
    assert found == [("ngslac", 2), ("ngslac, first order", 1), ("ContactBoundary, penalty", 2)]
    assert [row["settings"] for row in figures["rows"][:2]] == 2 * ["--inverse umfpack"]
    assert text.index("| ContactBoundary") < text.index("| ngslac")  # the faster one first
    assert "|1e-13%|1.00%|-50.00%|" in text.replace(" ", "")
    for reason in ("not installed: install ccx", "failed: ValueError: order 1"):
        assert reason in text
    assert len(figures["missing"]) == 2
    assert "P2|1.00%|2.00|1.00|ngslac,0.5|1.00%|3.00|1.00|0.7|1.0|" in text.replace(" ", "")


def test_sizes_of_ngslac_alone():
    own = compare.Sizes(["sphere=0.5,1", "patch="], lambda case: case.own)
    assert own["sphere"] == (0.5, 1.0)
    assert own["patch"] == ()
    assert own["hertz"] == compare.CASES["hertz"].own
    plan = compare.Plan((0.5,), own["sphere"], ["first", "kratos"])
    assert plan == {0.5: ["first", "kratos"], 1.0: ["first"]}
    assert compare.Plan((0.5,), (1.0,), ["kratos"]) == {0.5: ["kratos"]}


def row(peer, order, seconds, l2, **more):
    figures = {"peer": peer, "title": peer, "order": order, "h": 1.0, "cpu": 1.0}
    return {**figures, "seconds": seconds, "l2": l2, **more}


def test_each_peer_stands_beside_the_fastest_run_of_equal_accuracy():
    own = [row("ngslac", 2, 1.0, 0.08), row("ngslac", 2, 2.0, 0.04), row("ngslac", 1, 0.5, 0.05)]
    sphere, hertz = compare.CASES["sphere"], compare.CASES["hertz"]

    def beside(case, *peer, ours=own):
        (match,) = Matches(case, [*ours, row("other", *peer)])
        return match.own

    assert beside(sphere, 2, 9.0, 0.05) is own[1]
    assert beside(sphere, 2, 9.0, 0.08) is own[0]
    assert beside(sphere, 1, 9.0, 0.08) is own[2]  # of the same order only
    assert beside(sphere, 2, 9.0, 0.03) is None
    better = row("ngslac", 2, 1.5, 0.08, recovered_l2=0.03)
    assert beside(sphere, 2, 9.0, 0.03, ours=[*own, better]) is better
    known = row("ngslac", 2, 1.0, 0.009)
    assert beside(hertz, 2, 9.0, 0.001, ours=[known]) is known  # both below the floor


@pytest.mark.usefixtures("scripts")
def test_runs_without_a_result(files):
    late = compare.Run("patch", "getfem", files["patch"], limit=0.2)
    assert late.reason == "stopped after 0.2 s"
    unable = compare.Run("friction", "nitsche", files["hertz"])
    assert unable.reason == "does not solve this problem"
    for option in ("sphere", "cube=1"):
        with pytest.raises(SystemExit, match="write"):
            compare.Sizes([option], lambda case: case.own)


def test_quick(monkeypatch, tmp_path):
    import scaling

    ratios, asked = {"frictionless_over_best_cpu": 2.0, "ndof": 99, "best": "own"}, {}
    monkeypatch.setattr(scaling, "Ratios", lambda **options: asked.update(options) or ratios)
    file = tmp_path / "quick.json"
    compare.main(["--quick", "--json", str(file), "--solver", "direct"])
    assert json.loads(file.read_text()) == ratios
    assert asked == {"ndof": 100_000, "solver": "direct", "inverse": None}
