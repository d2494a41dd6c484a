"""The benchmarks of NGSolve alone run and solve what they say; no test looks at a time."""

import json
import math
import os
from dataclasses import asdict
from mmap import mmap

import benchmark_runs
import numpy as np
import pairing
import phases
import pytest
import scaling
import sliding
from benchmark_elastic import Fastest, Iterative, SolveForm
from benchmark_frame import Growth, InProcess
from benchmark_problems import SIZES, Problem, Refined
from benchmark_runs import Meter
from class_problems import Blocks
from ngsolve import CF, Integrate, ds
from scipy.integrate import quad

from ngslac.meshes import HertzMesh

SMALLEST = {name: min(sizes) for name, sizes in SIZES.items()}


def arc_length():
    """Length of the sine that the curved strip is bent to."""
    slope = pairing.AMPLITUDE * pairing.WAVE
    return quad(lambda x: math.hypot(1, slope * math.cos(pairing.WAVE * x)), 0, 1, epsabs=1e-13)[0]


@pytest.mark.parametrize("curved", [False, True])
@pytest.mark.parametrize(("dim", "n"), [(2, 300), (3, 72)])
def test_layers_pair_completely_and_do_not_match(dim, n, curved):
    row = pairing.Measure(n, curved, repeat=2, dim=dim)
    assert row.n == n
    assert row.segments == 2 * n or (dim == 3 and row.segments > 3 * n)
    # The quadrature of curved faces is what limits them.
    limit = {2: 1e-9, 3: 1e-6}[dim] if curved else 1e-12
    assert row.area == pytest.approx(row.length, rel=limit)
    exact = arc_length() if curved else 1.0
    assert row.length == pytest.approx(exact, rel=1e-7 if dim == 2 else 1e-4)
    assert set(row.parts) == set(pairing.PARTS)
    assert all(0 <= seconds <= row.update for seconds in row.parts.values())


@pytest.mark.full
def test_pairing_from_the_command_line(tmp_path, capsys):
    file = tmp_path / "rows.json"
    pairing.main(["--largest", "1000", "--threads", "1", "--repeat", "1", "--json", str(file)])
    rows = json.loads(file.read_text())
    assert [(row["n"], row["curved"]) for row in rows] == [(1000, False), (1000, True)]
    assert len(capsys.readouterr().out.split("bytes/seg")) == 3


@pytest.mark.full
def test_phases(tmp_path, monkeypatch, capsys):
    """A step measured once, then the command line with it."""
    step = phases.Measure(2.0, 0.2, repeat=1, solver="direct")
    assert step.force == pytest.approx(1, rel=1e-10)
    assert step.iterations >= 2
    assert (step.macros, step.ndof > 2000) == (8, True)
    assert max(step.residual[solver] for solver in phases.SOLVERS) < 1e-9
    assert tuple(step.phases) == phases.PHASES
    assert min(step.phases.values()) >= 0
    for phase in ("pairing", "contact", "bulk", "merge", "solve"):
        assert step.phases[phase] > 0, f"the calls of phase {phase!r} have moved"
    assert sum(step.phases.values()) == pytest.approx(step.total)

    pytest.importorskip("matplotlib")
    monkeypatch.setattr(phases, "Measure", lambda *given, **options: step)
    files = {name: tmp_path / f"some.{name}" for name in ("json", "png")}
    phases.main(["--levels", "1", "--json", str(files["json"]), "--picture", str(files["png"])])
    assert [row["ndof"] for row in json.loads(files["json"].read_text())] == 2 * [step.ndof]
    assert files["png"].stat().st_size > 10_000
    _, _, head, line, *_ = capsys.readouterr().out.splitlines()
    assert (len(line), line.count("%")) == (len(head), len(phases.PHASES))


def test_sliding(tmp_path, monkeypatch, capsys):
    """The whole slave is paired, and the calls do what they are named after."""
    monkeypatch.setattr(sliding, "CASES", {"hex 1": ("hex", 1, 4, 5), "tet 2": ("tet", 2, 3, 5)})
    file = tmp_path / "rows.json"
    sliding.main(["--cases", "tet 2", "--repeat", "2", "--json", str(file)])
    (row,) = json.loads(file.read_text()).values()
    assert row["area"] == pytest.approx(1, rel=1e-10)
    assert row["faces"] == 18
    assert set(row["milliseconds"]) == set(sliding.CALLS)
    assert min(row["milliseconds"].values()) > 0
    head, line = capsys.readouterr().out.splitlines()
    assert len(head) == len(line)


def test_inner_phase_stops_the_outer_clock(monkeypatch):
    clock = iter(range(100))
    monkeypatch.setattr(benchmark_runs.time, "perf_counter", lambda: next(clock))
    watch = benchmark_runs.StopWatch()
    with watch.Phase("solve"), watch.Phase("merge"):
        pass
    assert watch.seconds == {**dict.fromkeys(phases.PHASES, 0.0), "rest": 1, "solve": 2, "merge": 1}


@pytest.mark.parametrize(
    ("name", "kind"),
    [*zip(SMALLEST, ("ten_steps", "friction", "frictionless", "ten_steps"), strict=True)],
)
def test_contact_carries_the_load(name, kind):
    row = scaling.ContactRun(name, SMALLEST[name], kind)
    assert row.error < 1e-10
    assert row.ndof == pytest.approx(row.size, rel=0.1)
    assert len(row.iterations) == scaling.KINDS[kind][1]
    assert row.iterations[0] >= 1
    assert 0 < row.share < 0.5
    assert min(row.wall, row.cpu, row.memory) > 0
    assert sum(row.phases.values()) <= row.wall * 1.001
    if name == "patch":  # pressed: proportional; then it slips
        assert row.iterations[:2] == [1, 0]
        assert max(row.iterations[2:]) >= 2


def test_blocks_have_the_size_asked_for():
    for ndof, (n, layers) in SIZES["patch"].items():
        nodes = sum((2 * k + 1) ** 2 for k in (n, n + 1)) * (2 * layers + 1)
        assert 3 * nodes == pytest.approx(ndof, rel=0.1)


def test_refined_hertz_mesh_is_round():
    coarse = HertzMesh(3.0, grading=0.3)
    triangles = coarse.ne
    mesh = Refined(coarse, 1)
    assert mesh.ne == 4 * triangles
    assert Integrate(CF(1) * ds("slave"), mesh) == pytest.approx(15, rel=1e-8)


@pytest.mark.full
def test_elastic_reference_is_the_best_solve(monkeypatch):
    monkeypatch.setenv("NGS_NUM_THREADS", "1")
    problem = Problem("patch", SMALLEST["patch"])
    space = problem.Space(problem.Mesh(), both=True)
    row = scaling.Measure("patch", SMALLEST["patch"], "elastic", repeat=1)
    assert list(row.variants) == scaling.Variants(space, row.size)
    assert {"sparsecholesky", "own"} <= set(row.variants)
    assert row.ndof == 1110
    assert scaling.Variants(space, 1, "umfpack") == ["umfpack", "own"]
    assert scaling.Variants(space, 10**6) == ["own"]
    assert all(name[:4] in ("pard", "own") for name in scaling.Variants(space, 1, "pardiso"))
    names = ["umfpack", "sparsecholesky", "own"]
    monkeypatch.setattr(scaling, "Variants", lambda *_: names)
    row = scaling.ElasticRun("patch", SMALLEST["patch"])
    assert row.wall == min(row.variants[name]["wall"] for name in names[:2])
    assert row.isdirect
    assert row.Best().wall == min(run["wall"] for run in row.variants.values())
    assert max(row.variants[name]["error"] for name in names[:2]) < 1e-9


@pytest.mark.full
def test_elastic_solvers_agree():
    """Those of first order, too; and smoothed aggregation of more than one level."""
    pytest.importorskip("pyamg")
    problem = Blocks("tet", 8, 8, order=1)
    a, f = problem.Elastic(problem.Mesh())
    names = [name for name in Iterative(a.space) if name != "own"]
    assert names == ["smoothed aggregation"]
    runs = {name: SolveForm(a, f, name, Meter()) for name in ("sparsecholesky", *names)}
    assert runs["smoothed aggregation"][1]["error"] < 1e-8
    assert Fastest({"a": {"wall": 2}, "b": {"wall": 1}}) == "b"
    problem = Blocks("tet", 3, 3, order=2)
    with pytest.raises(ValueError, match="first order"):
        SolveForm(*problem.Elastic(problem.Mesh()), "smoothed aggregation", Meter())


def test_killed_process_is_told(monkeypatch, capsys):
    assert InProcess(os._exit, 9) is None
    monkeypatch.setattr(scaling, "Measure", lambda *given, **options: None)
    with pytest.raises(MemoryError, match="elastic"):
        scaling.Ratios()
    assert capsys.readouterr().out.count("was killed") == 4


def test_peak_memory_sees_what_is_gone():
    with benchmark_runs.Meter() as meter:
        before = benchmark_runs.PeakMemory()
        block = mmap(-1, 240_000_000)  # of the system: malloc may keep what it is given back
        np.frombuffer(block, dtype=np.uint8)[:] = 1
        block.close()
    assert meter.memory > before + 0.2
    if benchmark_runs.ForgetPeak():
        assert benchmark_runs.PeakMemory() < meter.memory - 0.2


def synthetic(problem, size, kind, **options):
    """A row whose times grow with an exponent of its own; a hundredth of them is its memory."""
    exponent = {"elastic": 1.5, "frictionless": 1.25, "friction": 1.75, "ten_steps": 2.0}[kind]
    wall = (1 + scaling.ALL.index(kind)) * (size / 1e4) ** exponent
    values = {"cpu": 2 * wall, "memory": wall / 100, "inverse": "pardiso", "error": 1e-13}
    if kind == "elastic":
        run = {"wall": wall, "cpu": 2 * wall, "memory": wall / 100, "error": 1e-13}
        half = {name: value / 2 for name, value in run.items()}
        return scaling.Row(
            problem, size, kind, size, wall, **values, variants={"pardiso": run, "own": half}
        )
    if kind != "elastic":
        shares = {"pairing": 0.01 * wall, "contact": 0.02 * wall, "solve": 0.97 * wall}
        values |= {"macros": 9, "iterations": [3, 2], "phases": shares}
    return scaling.Row(problem, size, kind, size, wall, **values)


def test_ratios_measure_each_kind_once(monkeypatch, capsys):
    asked = []
    measure = lambda *given, **options: asked.append((*given, options)) or synthetic(*given)  # noqa: E731
    monkeypatch.setattr(scaling, "Measure", measure)
    ratios = scaling.Ratios(90_000, inverse="umfpack")
    assert asked == [("sphere", 100_000, kind, {"inverse": "umfpack"}) for kind in scaling.ALL]
    wall = {kind: synthetic("sphere", 100_000, kind).wall for kind in scaling.ALL}
    titles = {"frictionless": "frictionless", "friction": "friction_step", "ten_steps": "ten_steps"}
    for kind, title in titles.items():
        for end in ("", "_cpu"):
            assert ratios[f"{title}_over_elastic{end}"] == wall[kind] / wall["elastic"]
            assert ratios[f"{title}_over_best{end}"] == wall[kind] / (wall["elastic"] / 2)
    assert ratios["seconds"] == wall | {"best": wall["elastic"] / 2}
    assert ratios["best"] == "own"
    assert len(capsys.readouterr().out.splitlines()) == 4


def test_scaling_from_the_command_line(tmp_path):
    pytest.importorskip("matplotlib")
    sizes = (10_000, 40_000, 90_000)
    rows = [synthetic("sphere", size, kind) for size in sizes for kind in scaling.ALL]
    rows = [row for row in rows if (row.kind, row.size) != ("elastic", 90_000)]
    friction = [row for row in rows if row.kind == "friction"]
    assert Growth(sizes, [row.wall for row in friction]) == pytest.approx(1.75)
    saved, table, again, picture = (tmp_path / name for name in ("a", "table.md", "b", "c.png"))
    saved.write_text(json.dumps([asdict(row) for row in rows]))
    files = ["--markdown", str(table), "--json", str(again), "--picture", str(picture)]
    scaling.main(["--load", str(saved), *files])
    assert json.loads(again.read_text()) == json.loads(saved.read_text())
    lines = table.read_text().splitlines()
    assert len(lines) == 5
    assert all(
        f" {cell} |" in lines[2] for cell in ("2 (2.0, 4.0)", "5, 5, 5", "0.01 / 0.01 / 0.04")
    )
    assert " - |" in lines[4]
    assert "Newton 3+2" in scaling.Line(rows[1])
    assert picture.stat().st_size > 20_000
    with pytest.raises(ValueError, match="20000"):
        scaling.main(["--sizes", "123", "--problems", "patch"])
