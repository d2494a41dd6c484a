"""The benchmarks of NGSolve alone run and solve what they say; no test looks at a time."""

import json
import math
import os
from dataclasses import asdict
from types import SimpleNamespace

import benchmark_runs
import numpy as np
import pairing
import phases
import pytest
import scaling
from benchmark_frame import Growth, InProcess
from benchmark_problems import SIZES, Problem, Refined
from layers import LayerMesh
from ngsolve import CF, Integrate, VectorH1, ds
from scipy.integrate import quad

from ngslac.meshes import HertzMesh

SMALLEST = {name: min(sizes) for name, sizes in SIZES.items()}


# ---------------------------------------------------------------- pairing.py


def arc_length():
    """Length of the sine that the curved strip is bent to."""
    slope = pairing.AMPLITUDE * pairing.WAVE
    return quad(lambda x: math.hypot(1, slope * math.cos(pairing.WAVE * x)), 0, 1, epsabs=1e-13)[0]


@pytest.mark.parametrize("curved", [False, True])
@pytest.mark.parametrize(("dim", "n"), [(2, 300), (3, 72)])
def test_layers_pair_completely(dim, n, curved):
    row = pairing.Measure(n, curved, repeat=2, dim=dim)
    assert row.n == n
    assert row.segments == 2 * n or dim == 3
    # The quadrature of curved faces is what limits them.
    limit = {2: 1e-9, 3: 1e-6}[dim] if curved else 1e-12
    assert row.area == pytest.approx(row.length, rel=limit)
    exact = arc_length() if curved else 1.0
    assert row.length == pytest.approx(exact, rel=1e-7 if dim == 2 else 1e-4)
    assert set(row.parts) == set(pairing.PARTS)
    assert all(0 <= seconds <= row.update for seconds in row.parts.values())


def test_timers_count_one_update_only(monkeypatch):
    readings = iter([dict.fromkeys(pairing.PARTS.values(), seconds) for seconds in (5.0, 7.0)])
    monkeypatch.setattr(pairing, "TimerSeconds", lambda: next(readings))
    *_, parts = pairing.TimedUpdate(SimpleNamespace(Update=lambda gf: None), None)
    assert parts == dict.fromkeys(pairing.PARTS, 2.0)


@pytest.mark.parametrize(("dim", "n", "nodes"), [(2, 7, (8, 9)), (3, 32, (25, 36))])
def test_layer_nodes_do_not_meet(dim, n, nodes):
    mesh, sides = LayerMesh(n, dim), []
    for name in ("slave", "master"):
        numbers = {v.nr for e in mesh.Boundaries(name).Elements() for v in e.vertices}
        sides.append(np.array([mesh.vertices[v].point for v in sorted(numbers)]))
    assert tuple(map(len, sides)) == nodes
    assert all(np.all(side[:, -1] == 0) for side in sides)
    slave, master = (s[((s > 0) & (s < 1))[:, : dim - 1].all(axis=1)] for s in sides)
    assert np.linalg.norm(slave[:, None] - master[None], axis=-1).min() > 0.01
    assert Integrate(CF(1), mesh) == pytest.approx(2 / (nodes[0] ** (1 / (dim - 1)) - 1))


def test_pairing_from_the_command_line(tmp_path, capsys):
    file = tmp_path / "rows.json"
    arguments = ["--largest", "1000", "--threads", "1", "--repeat", "1", "--json", str(file)]
    pairing.main(arguments)
    rows = json.loads(file.read_text())
    assert [(row["n"], row["curved"]) for row in rows] == [(1000, False), (1000, True)]
    assert len(capsys.readouterr().out.split("bytes/seg")) == 3


# ---------------------------------------------------------------- phases.py


@pytest.fixture(scope="module")
def step():
    return phases.Measure(2.0, 0.2, repeat=1)


def test_step_and_elastic_problem_are_solved(step):
    assert step.force == pytest.approx(1, rel=1e-10)
    assert step.iterations >= 2
    assert (step.macros, step.ndof > 2000) == (8, True)
    assert set(step.residual) == set(phases.SOLVERS)
    assert max(step.residual.values()) < 1e-9


def test_phases_add_up(step):
    assert tuple(step.phases) == phases.PHASES
    assert min(step.phases.values()) >= 0
    for phase in ("pairing", "contact", "bulk", "merge", "solve"):
        assert step.phases[phase] > 0, f"the calls of phase {phase!r} have moved"
    assert sum(step.phases.values()) == pytest.approx(step.total)
    assert step.Ratio("umfpack") == step.total / step.elastic["umfpack"]


def test_inner_phase_stops_the_outer_clock(monkeypatch):
    clock = iter(range(100))
    monkeypatch.setattr(benchmark_runs.time, "perf_counter", lambda: next(clock))
    watch = benchmark_runs.StopWatch()
    with watch.Phase("solve"), watch.Phase("merge"):
        pass
    assert watch.seconds == {**dict.fromkeys(phases.PHASES, 0.0), "rest": 1, "solve": 2, "merge": 1}


def test_phases_from_the_command_line(step, tmp_path, monkeypatch, capsys):
    pytest.importorskip("matplotlib")
    monkeypatch.setattr(phases, "Measure", lambda *given, **options: step)
    files = {name: tmp_path / f"some.{name}" for name in ("json", "png")}
    phases.main(["--levels", "1", "--json", str(files["json"]), "--picture", str(files["png"])])
    assert [row["ndof"] for row in json.loads(files["json"].read_text())] == 2 * [step.ndof]
    assert files["png"].stat().st_size > 10_000
    _, title, head, line, *_ = capsys.readouterr().out.splitlines()
    assert title.startswith("friction 0")
    assert (len(line), line.count("%")) == (len(head), len(phases.PHASES))


# ---------------------------------------------------------------- scaling.py

CASES = {
    "patch": "ten_steps",
    "patch_hex": "friction",
    "sphere": "frictionless",
    "hertz": "ten_steps",
}


@pytest.mark.parametrize(("name", "kind"), CASES.items())
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


def test_pressure_of_the_patch_is_exact():
    problem = Problem("patch", SMALLEST["patch"])
    run = benchmark_runs.SolveContact(problem, problem.Mesh())
    assert run.contact.Table()["pressure"] == pytest.approx(25, rel=1e-10)


@pytest.mark.parametrize("ndof", [n for n in SIZES["patch"] if n > 2_000])
def test_blocks_have_the_size_asked_for(ndof):
    n, layers = SIZES["patch"][ndof]
    nodes = sum((2 * k + 1) ** 2 for k in (n, n + 1)) * (2 * layers + 1)
    assert 3 * nodes == pytest.approx(ndof, rel=0.1)
    if ndof < 30_000:
        assert VectorH1(Problem("patch", ndof).Mesh(), order=2).ndof == 3 * nodes


def test_refined_hertz_mesh_is_round():
    coarse = HertzMesh(3.0, grading=0.3)
    triangles = coarse.ne
    mesh = Refined(coarse, 1)
    assert mesh.ne == 4 * triangles
    assert Integrate(CF(1) * ds("slave"), mesh) == pytest.approx(15, rel=1e-8)


def test_elastic_variants_in_a_process(monkeypatch):
    monkeypatch.setenv("NGS_NUM_THREADS", "1")
    row = scaling.Measure("patch", SMALLEST["patch"], "elastic", repeat=1)
    assert set(row.variants) == set(scaling.Variants()) >= {"sparsecholesky"}
    assert row.wall == min(run["wall"] for run in row.variants.values())
    assert max(run["error"] for run in row.variants.values()) < 1e-9
    assert row.ndof == 1110
    assert scaling.Variants("umfpack") == ["umfpack"]
    assert all(name.startswith("pardiso") for name in scaling.Variants("pardiso"))


def test_killed_process_is_told(monkeypatch, capsys):
    assert InProcess(os._exit, 9) is None
    monkeypatch.setattr(scaling, "Measure", lambda *given, **options: None)
    with pytest.raises(MemoryError, match="elastic"):
        scaling.Ratios()
    assert capsys.readouterr().out.count("was killed") == 4


def test_peak_memory_sees_what_is_gone():
    with benchmark_runs.Meter() as before:
        pass
    with benchmark_runs.Meter() as meter:
        np.ones(30_000_000)
    assert meter.memory > before.memory + 0.2
    if benchmark_runs.ForgetPeak():
        assert benchmark_runs.PeakMemory() < meter.memory - 0.2


def synthetic(problem, size, kind, wall=None, **options):
    """A row whose times grow with an exponent of its own; a hundredth of them is its memory."""
    exponent = {"elastic": 1.5, "frictionless": 1.25, "friction": 1.75, "ten_steps": 2.0}[kind]
    wall = (1 + scaling.ALL.index(kind)) * (size / 1e4) ** exponent
    values = {"cpu": 2 * wall, "memory": wall / 100, "inverse": "pardiso", "error": 1e-13}
    if kind != "elastic":
        shares = {"pairing": 0.01 * wall, "contact": 0.02 * wall, "solve": 0.97 * wall}
        values |= {"macros": 9, "iterations": [3, 2], "phases": shares}
    return scaling.Row(problem, size, kind, size, wall, **values)


def test_growth():
    rows = [synthetic("sphere", n, "friction") for n in (10_000, 40_000, 90_000)]
    assert Growth([row.ndof for row in rows], [row.wall for row in rows]) == pytest.approx(1.75)
    assert np.isnan(Growth([5], [1.0]))


def test_ratios_measure_each_kind_once(monkeypatch, capsys):
    asked = []

    def measure(*given, **options):
        asked.append((*given, options))
        return synthetic(*given)

    monkeypatch.setattr(scaling, "Measure", measure)
    ratios = scaling.Ratios(90_000, inverse="umfpack")
    assert asked == [("sphere", 100_000, kind, {"inverse": "umfpack"}) for kind in scaling.ALL]
    wall = {row.kind: row.wall for row in (synthetic(*given[:3]) for given in asked)}
    titles = {"frictionless": "frictionless", "friction": "friction_step", "ten_steps": "ten_steps"}
    for kind, title in titles.items():
        for end in ("", "_cpu"):
            assert ratios[f"{title}_over_elastic{end}"] == wall[kind] / wall["elastic"]
    assert ratios["seconds"] == wall
    assert len(capsys.readouterr().out.splitlines()) == 4


def test_scaling_from_the_command_line(tmp_path):
    pytest.importorskip("matplotlib")
    sizes = (10_000, 40_000, 90_000)
    rows = [synthetic("sphere", size, kind) for size in sizes for kind in scaling.ALL]
    rows = [row for row in rows if (row.kind, row.size) != ("elastic", 90_000)]
    saved, table, again, picture = (tmp_path / name for name in ("a", "table.md", "b", "c.png"))
    saved.write_text(json.dumps([asdict(row) for row in rows]))
    files = ["--markdown", str(table), "--json", str(again), "--picture", str(picture)]
    scaling.main(["--load", str(saved), *files])
    assert json.loads(again.read_text()) == json.loads(saved.read_text())
    lines = table.read_text().splitlines()
    assert len(lines) == 5
    for cell in ("2 (2.0x)", "5, 5, 5", "3.0 %"):
        assert f" {cell} |" in lines[2]
    assert " - |" in lines[4]
    assert "Newton 3+2" in scaling.Line(rows[1])
    assert picture.stat().st_size > 20_000
    with pytest.raises(ValueError, match="20000"):
        scaling.main(["--sizes", "123", "--problems", "patch"])
