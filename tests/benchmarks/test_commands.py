"""Each week: the commands run on their smallest problems, and these are solved; no time counts."""

import json
import math
import sys
from pathlib import Path

import classes
import compare
import numpy as np
import pairing
import pytest
import scaling
from benchmark_elastic import SolveForm
from benchmark_problems import SIZES
from benchmark_runs import Meter
from class_list import CLASSES
from class_problems import Blocks, Checkerboard, Cubes, Sheets
from ngsolve import GetNumThreads, Integrate, SetNumThreads
from scipy.integrate import quad
from scipy.spatial import Delaunay

from ngslac.reference import HertzLine, HertzPoint

sys.path.insert(0, str(Path(__file__).parent / "peers"))

import contactboundary
import lac
import meshes
import metrics
from peercommand import Main

pytestmark = pytest.mark.full


@pytest.fixture(scope="module", autouse=True)
def _one_thread():
    """The problems here are so small that a second one only waits."""
    before = GetNumThreads()
    SetNumThreads(1)
    yield
    SetNumThreads(before)


# ---------------------------------------------------------------- ngslac and elastic solves


RUNS = [("patch", "ten_steps"), ("patch_hex", "friction"), ("hertz", "ten_steps")]
RUNS += [("sphere", "friction"), ("sphere", "frictionless")]


@pytest.mark.parametrize(("name", "kind"), RUNS)
def test_contact_carries_the_load(name, kind):
    row = scaling.ContactRun(name, min(SIZES[name]), kind)
    assert row.error < 1e-10
    assert row.ndof == pytest.approx(row.size, rel=0.1)
    assert len(row.iterations) == scaling.KINDS[kind][1]
    assert row.iterations[0] >= 1
    assert 0 < row.share < 0.5
    assert sum(row.phases.values()) <= row.wall * 1.001


def test_scaling(tmp_path):
    """The rows of a run, and table and picture of these rows when they are loaded."""
    saved, again, table, picture = (tmp_path / name for name in ("a", "b", "c.md", "d.png"))
    kinds = ["--kinds", "elastic", "frictionless", "--repeat", "1"]
    scaling.main(["--problems", "patch", "--sizes", "1110", *kinds, "--json", str(saved)])
    elastic, contact = json.loads(saved.read_text())
    assert {"sparsecholesky", "own"} <= elastic["variants"].keys()
    assert elastic["error"] < 1e-8
    assert contact["error"] < 1e-10
    files = ["--json", str(again), "--markdown", str(table), "--picture", str(picture)]
    scaling.main(["--load", str(saved), *files])
    assert json.loads(again.read_text()) == [elastic, contact]
    assert table.read_text().count("1110") == 1
    assert picture.stat().st_size > 10_000
    with pytest.raises(ValueError, match="patch has no mesh of 123 dofs"):
        scaling.main(["--sizes", "123", "--problems", "patch"])


def test_smoothed_aggregation():
    pytest.importorskip("pyamg")
    problem = Blocks("tet", 8, 8, order=1)
    figures = SolveForm(*problem.Elastic(problem.Mesh()), "smoothed aggregation", Meter())[1]
    assert figures["error"] < 1e-8


# Of classes that differ by a number only, one.
SAME = ("frictionless", "284k", "by 10", "points", "nu .49", "peer", "64k", ".03")


@pytest.mark.parametrize("name", [n for n in CLASSES if not any(same in n for same in SAME)])
def test_class(name):
    row = classes.Measure(name, quick=True)
    assert row["converged"], row["reason"]
    assert row["newton"] >= 1
    assert 0 < row["over_best"] == pytest.approx(max(row["over_best"], row["over_direct"]))


def test_classes(tmp_path):
    """One that ends, one that is stopped, and one that fails."""
    file = tmp_path / "rows.json"
    classes.main(["--quick", "--only", "two blocks", "--json", str(file)])
    (row,) = json.loads(file.read_text())["classes"]
    assert row["converged"]
    late = classes.Run("two blocks", tmp_path, quick=True, limit=1e-3)
    assert (late["converged"], late["reason"]) == (False, "stopped after 0.001 s")
    assert "there are sphere" in classes.Run("no such class", tmp_path)["reason"]


@pytest.mark.parametrize(("problem", "area"), [(Cubes(1), 54), (Sheets(2), 7)])
def test_many_bodies_meet(problem, area):
    """All faces between the cubes, and between the sheets, have partners."""
    mesh = problem.Mesh()
    contacts = problem.Contact(problem.Product(mesh))[1]
    for contact in contacts:
        contact.Update()
    assert sum(c.Table()["area"].sum() for c in contacts) == pytest.approx(area, rel=1e-10)


@pytest.mark.parametrize("aligned", [False, True])
def test_checkerboard(aligned):
    """As much soft as stiff, alike from cell to cell."""
    problem = Checkerboard(8, 8, aligned=aligned)
    mesh = problem.Mesh()
    young = problem.young(mesh)
    corner = [float(young(mesh(p, 0.1, 0.1))) for p in (0.1, 0.4, 0.6, 0.9)]
    assert corner == pytest.approx([2e3, 2e7, 2e3, 2e7])
    assert Integrate(young, mesh) == pytest.approx(1.0001e7 * 2, rel=0.05)


def arc_length():
    """Length of the sine that the curved strip is bent to."""
    slope = pairing.AMPLITUDE * pairing.WAVE
    return quad(lambda x: math.hypot(1, slope * math.cos(pairing.WAVE * x)), 0, 1, epsabs=1e-13)[0]


@pytest.mark.parametrize("curved", [False, True])
@pytest.mark.parametrize(("dim", "n"), [(2, 300), (3, 72)])
def test_layers_pair_completely_and_do_not_match(dim, n, curved):
    row = pairing.Measure(n, curved, repeat=2, dim=dim)
    assert row.segments == 2 * n or (dim == 3 and row.segments > 3 * n)
    # The quadrature of curved faces is what limits them.
    limit = {2: 1e-9, 3: 1e-6}[dim] if curved else 1e-12
    assert row.area == pytest.approx(row.length, rel=limit)
    exact = arc_length() if curved else 1.0
    assert row.length == pytest.approx(exact, rel=1e-7 if dim == 2 else 1e-4)
    assert all(0 <= seconds <= row.update for seconds in row.parts.values())


def test_pairing(tmp_path):
    file = tmp_path / "rows.json"
    pairing.main(["--largest", "1000", "--threads", "1", "--repeat", "1", "--json", str(file)])
    rows = json.loads(file.read_text())
    assert [(row["n"], row["curved"]) for row in rows] == [(1000, False), (1000, True)]


# ---------------------------------------------------------------- other programs

COARSE = {"hertz": 3.0, "sphere": 4.0, "patch": 1 / 3}


@pytest.fixture(scope="module")
def files(tmp_path_factory):
    """Of the meshes of the comparison."""
    folder = tmp_path_factory.mktemp("meshes")
    names = {problem: folder / f"{problem}_{h:g}.npz" for problem, h in COARSE.items()}
    for problem, file in names.items():
        meshes.Make(problem, COARSE[problem], file)
    return names


SUNK = {"penetration": 1e-4, "displacement": 1e-3}
HERTZ = {"peak": 0.08, "l2": 0.15, "force": 0.01}
SOLVED = [
    (lac, "patch", "--order 1", {"displacement": 1e-12, "stress": 1e-12}),
    (contactboundary, "patch", "--order 1", {"penetration": 1 / 60 * 1.001}),
    (contactboundary, "patch", "--order 1 --variant nitsche", SUNK),
    (lac, "hertz", "", HERTZ),
    (lac, "hertz", "--friction 0.2 --steps 2", HERTZ),
    (contactboundary, "hertz", "", HERTZ),
    (contactboundary, "hertz", "--friction 0.2 --steps 2", HERTZ),
    (lac, "sphere", "--order 1 --variant bubble", {"force": 0.05}),
]


@pytest.mark.parametrize(("driver", "problem", "options", "limits"), SOLVED)
def test_peers_in_ngsolve(driver, problem, options, limits, files, tmp_path):
    file = tmp_path / "row.json"
    line = [problem, str(files[problem]), "--json", str(file), *options.split()]
    assert Main(driver.Solve, peer="peer", options=driver.Options, argv=line) == 0
    row = json.loads(file.read_text())
    assert all(abs(row[name]) < limit for name, limit in limits.items())
    assert row["iterations"] >= 1


def test_compare(files, tmp_path, monkeypatch):
    """Rows of two programs, and a third one that is not installed."""
    monkeypatch.setattr(compare.os, "environ", compare.os.environ | {"PATH": str(tmp_path)})
    output, tables = tmp_path / "figures.json", tmp_path / "tables.md"
    line = ["--problems", "patch", "--sizes", f"patch={COARSE['patch']:g}"]
    line += ["--peers", "ngslac", "penalty", "calculix", "--meshes", str(files["patch"].parent)]
    compare.main([*line, "--json", str(output), "--markdown", str(tables)])
    figures, text = json.loads(output.read_text()), tables.read_text()
    assert {row["peer"]: row["stress"] < 1e-8 for row in figures["rows"]} == {
        "ngslac": True,
        "ContactBoundary": False,
    }
    (missing,) = figures["missing"]
    assert "calculix-ccx" in missing["reason"]
    assert "ContactBoundary, penalty" in text.partition("time ratio")[2]  # beside ngslac


def test_mesh_is_closed_and_curved(files):
    for file in files.values():
        mesh = meshes.Load(file)
        dim, points = mesh.dim, mesh.points
        sides = points[mesh.elements[:, 1 : dim + 1]] - points[mesh.elements[:, :1]]
        volume = np.linalg.det(sides) / (2 if dim == 2 else 6)
        assert volume.min() > 0
        along = points[mesh.faces[:, 1:dim]] - points[mesh.faces[:, :1]]
        turned = (
            along[:, 0] @ [[0, -1], [1, 0]] if dim == 2 else np.cross(*along.swapaxes(0, 1)) / 2
        )
        flux = (turned * points[mesh.faces[:, :dim]].mean(axis=1)).sum()
        assert flux / dim == pytest.approx(volume.sum(), rel=1e-12)
        if mesh.problem != "patch":
            slave = points[mesh.Nodes(2, "slave")] - np.eye(dim)[-1] * metrics.RADIUS
            assert np.linalg.norm(slave, axis=1) == pytest.approx(metrics.RADIUS, rel=1e-4)


def test_data_are_those_of_the_reference_solutions():
    bodies = {"radius1": 50, "young1": 210e3, "nu1": 0.3, "young2": 70e3, "nu2": 0.3}
    line, x = HertzLine(force=metrics.LINE_FORCE, **bodies), np.linspace(0, 8, 20)
    assert metrics.LinePressure(x) == pytest.approx(line.Pressure(x))
    point = HertzPoint(force=metrics.SPHERE_FORCE, **bodies)
    assert metrics.SpherePressure(x) == pytest.approx(point.Pressure(x))


def test_errors_of_known_pressures():
    """Of twice the pressure of a line, and of none on the triangles of a square below a sphere."""
    x = np.random.default_rng(1).permutation(np.linspace(0, 15, 4001))
    for factor in (1, 2):
        errors = metrics.LineErrors(x, factor * metrics.LinePressure(x))
        assert errors == pytest.approx(dict.fromkeys(("peak", "l2", "force"), factor - 1), abs=2e-3)
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
def test_errors_of_known_displacements(files, order):
    mesh = meshes.Load(files["patch"])
    exact = metrics.PatchDisplacement(mesh.Points(order))
    sunk = exact.copy()
    sunk[mesh.MaterialNodes(order, "upper"), 2] -= 1e-5
    right, large, low = (metrics.PatchErrors(mesh, u) for u in (exact, 1.02 * exact, sunk))
    assert list(right.values()) == pytest.approx([0, 0, 0], abs=1e-12)
    assert [large["displacement"], large["stress"]] == pytest.approx([0.02, 0.02])
    assert low["penetration"] == pytest.approx(0.005)
    assert low["stress"] < 1e-12
