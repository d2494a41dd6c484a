"""The benchmarks run and solve what they say; no test looks at a time."""

import json
import math

import numpy as np
import pairing
import phases
import pytest
from layers import StripMesh
from scipy.integrate import quad

N = 300


def arc_length():
    """Length of the sine that the curved strip is bent to."""
    slope = pairing.AMPLITUDE * pairing.WAVE
    return quad(lambda x: math.hypot(1, slope * math.cos(pairing.WAVE * x)), 0, 1, epsabs=1e-13)[0]


@pytest.fixture(scope="module")
def step():
    return phases.Measure(2.0, 0.2, repeat=1)


@pytest.mark.parametrize("curved", [False, True])
def test_strips_pair_completely(curved):
    row = pairing.Measure(N, curved, repeat=2)
    assert row.segments == 2 * N
    # The quadrature of a parabola's length is what limits the curved one.
    assert row.area == pytest.approx(row.length, rel=1e-12 if not curved else 1e-9)
    assert row.length == pytest.approx(arc_length() if curved else 1.0, rel=1e-7)
    assert set(row.parts) == set(pairing.PARTS)
    assert all(0 <= seconds <= row.update for seconds in row.parts.values())


def test_strip_nodes_do_not_meet():
    mesh = StripMesh(7)
    near = [
        {v.nr for e in mesh.Boundaries(name).Elements() for v in e.vertices}
        for name in ("slave", "master")
    ]
    slave, master = (np.array([mesh.vertices[v].point for v in sorted(nodes)]) for nodes in near)
    assert (len(slave), len(master)) == (8, 9)
    inner = np.abs(slave[1:-1, :1] - master[None, 1:-1, 0])
    assert inner.min() > 0.01
    assert np.all(slave[:, 1] == 0)
    assert np.all(master[:, 1] == 0)


def test_growth_finds_the_exponent():
    rows = [pairing.Row(n, False, 1, 2 * n, 1, 1, 0, 3e-6 * n**1.5, 0, {}, 0) for n in (10, 90)]
    measured, reference = pairing.Growth(rows, lambda row: row.update)
    assert measured == pytest.approx(1.5)
    assert 1 < reference < 1.5


def test_pairing_from_the_command_line(tmp_path, capsys):
    file = tmp_path / "rows.json"
    arguments = ["--largest", "1000", "--threads", "1", "--repeat", "1", "--json", str(file)]
    pairing.main(arguments)
    rows = json.loads(file.read_text())
    assert [(row["n"], row["curved"]) for row in rows] == [(1000, False), (1000, True)]
    assert len(capsys.readouterr().out.split("bytes/seg")) == 3


def test_step_carries_the_load(step):
    assert step.force == pytest.approx(1, rel=1e-10)
    assert step.iterations >= 2
    assert step.macros == 8
    assert step.ndof > 2000


def test_elastic_problem_is_solved(step):
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
    monkeypatch.setattr(phases.time, "perf_counter", lambda: next(clock))
    watch = phases.StopWatch()
    with watch.Phase("solve"), watch.Phase("merge"):
        pass
    assert watch.seconds == {**dict.fromkeys(phases.PHASES, 0.0), "rest": 1, "solve": 2, "merge": 1}


def test_phases_table_and_picture(step, tmp_path):
    assert phases.Line(step).count("%") == len(phases.PHASES)
    assert len(phases.Line(step)) == len(phases.Head())
    pytest.importorskip("matplotlib")
    phases.Picture([step], tmp_path / "phases.png")
    assert (tmp_path / "phases.png").stat().st_size > 10_000
