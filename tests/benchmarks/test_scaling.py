"""The scaling benchmark solves what it says; no test looks at a time."""

import json
import os
from dataclasses import asdict

import _scaling_output as output
import _scaling_problems as problems
import _scaling_runs as runs
import numpy as np
import pytest
import scaling
from _scaling_problems import SIZES, Problem
from _scaling_runs import KINDS, ContactRun, ElasticRun, Growth, Row
from ngsolve import CF, GetNumThreads, Integrate, SetNumThreads, VectorH1, ds

from ngslac import ContactSolver, LoadStepper
from ngslac.meshes import HertzMesh

SMALLEST = {name: min(sizes) for name, sizes in SIZES.items()}


def synthetic(kind, ndof, wall, **others):
    """A row whose memory is a hundredth of its time."""
    values = {"cpu": 2 * wall, "memory": wall / 100, "inverse": "pardiso", "error": 1e-13}
    if kind != "elastic":
        phases = {"pairing": 0.01 * wall, "contact": 0.02 * wall, "solve": 0.97 * wall}
        values |= {"macros": 9, "iterations": [3, 2], "phases": phases}
    return Row("sphere", ndof, kind, ndof, wall, **(values | others))


def family(exponents):
    """Rows of each kind whose times grow with given exponents."""
    return [
        synthetic(kind, n, factor * (n / 1e4) ** exponent)
        for n in (10_000, 40_000, 90_000)
        for factor, (kind, exponent) in enumerate(exponents.items(), 1)
    ]


EXPONENTS = {"elastic": 1.5, "frictionless": 1.25, "friction": 1.75, "ten_steps": 2.0}


@pytest.fixture(scope="module", autouse=True)
def one_thread():
    """So small problems gain nothing from a second one."""
    before = GetNumThreads()
    SetNumThreads(1)
    yield
    SetNumThreads(before)


@pytest.fixture(scope="module")
def blocks():
    return ContactRun("patch", SMALLEST["patch"], "ten_steps")


@pytest.mark.parametrize(
    ("name", "kind"),
    [
        ("patch", "ten_steps"),
        ("patch_hex", "friction"),
        ("sphere", "frictionless"),
        ("hertz", "ten_steps"),
    ],
)
def test_contact_carries_the_load(name, kind, blocks):
    row = blocks if name == "patch" else ContactRun(name, SMALLEST[name], kind)
    assert row.error < 1e-10
    assert row.ndof == pytest.approx(row.size, rel=0.1)
    assert len(row.iterations) == KINDS[kind][1]
    assert row.iterations[0] >= 1
    assert 0 < row.share < 0.5
    assert min(row.wall, row.cpu, row.memory) > 0
    assert sum(row.phases.values()) <= row.wall * 1.001


def test_pressure_of_the_patch_is_exact():
    problem = Problem("patch", SMALLEST["patch"])
    a, contact, load, gf = problem.Contact(problem.Model(problem.Mesh()))
    LoadStepper(ContactSolver(a, gf, contact), load).Integrate(steps=1, printing=False)
    assert contact.Table()["pressure"] == pytest.approx(25, rel=1e-10)


def test_friction_of_the_blocks_slips_after_the_pressing(blocks):
    assert blocks.iterations[:2] == [1, 0]  # pressed: proportional
    assert max(blocks.iterations[2:]) >= 2


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
    mesh = problems._Refined(coarse, 1)
    assert mesh.ne == 4 * triangles
    assert Integrate(CF(1) * ds("slave"), mesh) == pytest.approx(15, rel=1e-8)


def test_elastic_variants_in_a_process(monkeypatch):
    monkeypatch.setenv("NGS_NUM_THREADS", "1")
    row = runs.InProcess(ElasticRun, "patch", SMALLEST["patch"])
    assert set(row.variants) == set(runs.Variants())
    assert "sparsecholesky" in row.variants
    assert row.wall == min(run["wall"] for run in row.variants.values())
    assert max(run["error"] for run in row.variants.values()) < 1e-9
    assert row.ndof == 1110


def test_elastic_solution_does_not_depend_on_the_variant():
    assert runs.Variants("umfpack") == ["umfpack"]
    assert all(name.startswith("pardiso") for name in runs.Variants("pardiso"))
    assert ElasticRun("hertz", SMALLEST["hertz"], inverse="umfpack").inverse == "umfpack"


def test_killed_process_is_told():
    assert runs.InProcess(os._exit, 9) is None
    assert runs.Fastest([None, None]) is None
    assert runs.Fastest([None, synthetic("friction", 5, 2.0)]).wall == 2.0


def test_peak_memory_sees_what_is_gone():
    with runs.Meter() as before:
        pass
    with runs.Meter() as meter:
        np.ones(30_000_000)
    assert meter.memory > before.memory + 0.2
    if runs.ForgetPeak():
        assert runs.PeakMemory() < meter.memory - 0.2


def test_growth_and_ratios_of_synthetic_rows():
    rows = family(EXPONENTS)
    for kind, exponent in EXPONENTS.items():
        own = [row for row in rows if row.kind == kind]
        found = Growth([row.ndof for row in own], [row.wall for row in own])
        assert found == pytest.approx(exponent)
    assert np.isnan(Growth([5], [1.0]))
    ratios = scaling.RatiosOf({row.kind: row for row in rows[:4]})
    titles = ("frictionless", "friction_step", "ten_steps")
    assert [ratios[f"{title}_over_elastic"] for title in titles] == [2, 3, 4]
    assert ratios["seconds"]["elastic"] == 1.0


def test_ratios_measure_each_kind_once(monkeypatch, capsys):
    asked = []

    def measure(problem, size, kind, **options):
        asked.append((problem, size, kind, options))
        return synthetic(kind, size, 1.0 + len(asked))

    monkeypatch.setattr(scaling, "Measure", measure)
    ratios = scaling.Ratios(90_000, inverse="umfpack")
    options = {"inverse": "umfpack", "solver": None}
    kinds = ("elastic", *KINDS)
    assert asked == [("sphere", 100_000, kind, options) for kind in kinds]
    assert ratios["ten_steps_over_elastic"] == 5 / 2
    assert len(capsys.readouterr().out.splitlines()) == 4
    monkeypatch.setattr(scaling, "Measure", lambda *_, **__: None)
    with pytest.raises(MemoryError, match="elastic"):
        scaling.Ratios(printing=False)


def test_table_and_picture(tmp_path, capsys):
    rows = family(EXPONENTS)
    rows = [row for row in rows if (row.kind, row.size) != ("elastic", 90_000)]
    saved, table, again = (tmp_path / name for name in ("rows.json", "table.md", "again.json"))
    saved.write_text(json.dumps([asdict(row) for row in rows]))
    scaling.main(["--load", str(saved), "--markdown", str(table), "--json", str(again)])
    assert json.loads(again.read_text()) == json.loads(saved.read_text())
    lines = table.read_text().splitlines()
    assert len(lines) == 5
    assert "2 (2.0x)" in lines[2]
    assert "5, 5, 5" in lines[2]
    assert "3.0 %" in lines[2]
    assert "| - |" in lines[4]
    assert "Newton 3+2" in output.Line(rows[1])
    pytest.importorskip("matplotlib")
    output.Picture(rows, tmp_path / "scaling.png")
    assert (tmp_path / "scaling.png").stat().st_size > 20_000


def test_unknown_size_is_refused():
    with pytest.raises(ValueError, match="20000"):
        scaling.main(["--sizes", "123", "--problems", "patch"])
