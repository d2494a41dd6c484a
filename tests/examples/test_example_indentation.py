"""Elastoplastic indentation by a cylinder: the example against Johnson's numbers."""

import json

import indentation
import numpy as np
import pytest
from commandline import Help, Refused
from indentation import PRANDTL, Cycle, Depths, OnsetPressure
from indenter import Indenter
from netgen.occ import OCCGeometry, Pnt, Segment
from ngsolve import (
    BilinearForm,
    Grad,
    GridFunction,
    InnerProduct,
    Sym,
    VectorH1,
    dx,
)
from ngsolve import Mesh as NGSolveMesh

from ngslac import ContactConvergenceError
from ngslac.materials import Stress
from ngslac.meshes import IndentationMesh
from ngslac.meshes.geometry import Body, Side

SOFT = {"h": 0.4, "yield_stress": 8.0, "hardening": 1.6}


@pytest.fixture(scope="module")
def results():
    return Cycle(Indenter())


@pytest.fixture(scope="module")
def figures(results):
    return results.Figures()


def test_onset_of_yield():
    """Johnson 1985, section 6.1: 1.79 for the Poisson ratio 0.3; the finite block takes 1 %."""
    assert OnsetPressure(0.3) == pytest.approx(1.79, abs=0.005)
    assert indentation.Onset() == pytest.approx(OnsetPressure(0.3), rel=0.015)


def test_fully_plastic_mean_pressure(results, figures):
    """From Hertz' pressure at the first yield it rises towards Prandtl's."""
    mean = [row["mean_pressure"] / 35.0 for row in results.loading if row["closed"] > 8]
    assert 0.9 * PRANDTL < mean[-1] < PRANDTL
    assert np.all(np.diff(mean) > -0.03)  # the width is known to a tenth of an element
    assert np.mean(mean[-3:]) > 1.02 * np.mean(mean[:3])
    assert figures["scaled_width"] > 75


def test_rigid_plastic_limit():
    """A block so soft that elasticity plays no role: Prandtl's pressure, from above."""
    last = Indenter(**SOFT).Advance(Depths(steps=8)[0])[-1]
    assert last["scaled_width"] > 350
    assert last["mean_pressure"] / 8.0 == pytest.approx(PRANDTL, rel=0.04)


def test_forces_balance(results, figures):
    assert figures["balance"] < 1e-9
    assert np.all(np.diff([row["force"] for row in results.loading]) > 0)


def test_quadratic_convergence(results, figures):
    before, after = results.residuals[-2:]
    assert after < max(1e3 * before**2, 1e-13)
    assert after < 1e-3 * before
    assert figures["cuts"] <= 2


def test_imprint_stays(results, figures):
    assert figures["released"]
    # Where the cylinder lets go is where the surface stays.
    assert figures["permanent_depth"] == pytest.approx(figures["imprint_depth"], rel=0.005)
    assert 0.7 < figures["permanent_depth"] / 0.08 < 0.85


def test_unloading_and_loading_again_are_elastic(results, figures):
    """Johnson 1985, section 6.4, but for a little yield where the edge of the contact was."""
    assert figures["reloading_force_ratio"] == pytest.approx(1, abs=2e-3)
    path = sorted((row["depth"], row["force"]) for row in results.unloading)
    for row in results.reloading:
        force = np.interp(row["depth"], *np.transpose(path))
        assert row["force"] == pytest.approx(force, abs=0.02 * figures["peak_force"])


def punch_stiffness(problem, halfwidth):
    """Elastic stiffness of a rigid, frictionless punch on the block, by plain NGSolve."""
    size = problem.size
    corners = [(0, -size), (size, -size), (size, 0), (halfwidth, 0), (0, 0)]
    names = ["bottom", "side", "top", "punch", "sym"]
    sides = [
        Side(Segment(Pnt(*p, 0), Pnt(*q, 0)), name, 20 if name == "punch" else None)
        for p, q, name in zip(corners, [*corners[1:], corners[0]], names, strict=True)
    ]
    mesh = NGSolveMesh(OCCGeometry(Body(sides, "block"), dim=2).GenerateMesh(maxh=8, grading=0.2))
    V = VectorH1(mesh, order=3, dirichletx="sym|bottom", dirichlety="bottom|punch")
    u, v = V.TnT()
    stress = Stress(Sym(Grad(u)), problem.young, problem.poisson)
    a = BilinearForm(InnerProduct(stress, Sym(Grad(v))) * dx).Assemble()
    gf = GridFunction(V)
    gf.Set((0, 1), definedon=mesh.Boundaries("punch"))
    residual = gf.vec.CreateVector()
    residual.data = a.mat * gf.vec
    gf.vec.data -= a.mat.Inverse(V.FreeDofs(), inverse="sparsecholesky") * residual
    residual.data = a.mat * gf.vec
    return 2 * InnerProduct(residual, gf.vec)


def test_unloading_slope_is_that_of_an_elastic_punch(results, figures):
    """At the first moment of unloading the contact keeps its width."""
    expected = punch_stiffness(results.indenter, figures["halfwidth"])
    assert figures["unloading_slope"] == pytest.approx(expected, rel=0.03)


def test_a_failed_step_leaves_no_trace():
    """Three iterations are too few: state, solution and curve stay, and the next try is right."""
    depths, runs = Depths(steps=10)[0], []
    for fails in (False, True):
        results = Indenter(h=0.4)
        results.Advance(depths[:3])
        if fails:
            before = [results.material.state.vec.FV().NumPy().copy()]
            before += [results.solver.gf.vec.FV().NumPy().copy(), len(results.curve)]
            with pytest.raises(ContactConvergenceError):
                results.Advance(depths[3:4], maxit=1)
            assert np.array_equal(results.material.state.vec.FV().NumPy(), before[0])
            assert np.array_equal(results.solver.gf.vec.FV().NumPy(), before[1])
            assert len(results.curve) == before[2]
        results.Advance(depths[3:4])
        runs.append(results.curve[-1])
    assert runs[1]["force"] == pytest.approx(runs[0]["force"], rel=1e-8)
    assert runs[1]["plastic_volume"] == pytest.approx(runs[0]["plastic_volume"], rel=1e-8)


def force_at_depth(h, steps):
    rows = Indenter(h=h).Advance(Depths(0.04, steps)[0], maxit=60)
    assert len(rows) == steps  # none was halved: the flow depends on the step size
    return rows[-1]["force"]


@pytest.mark.slow
def test_force_converges_with_the_mesh():
    """The same steps on three meshes."""
    forces = [force_at_depth(h, 8) for h in (0.6, 0.3, 0.15)]
    coarse, fine = np.abs(np.diff(forces)) / forces[-1]
    assert coarse < 0.05
    assert fine < 0.01


def test_units_and_sizes_do_not_matter():
    """In metres and pascals, the same: the mesh scales with the radius."""
    metres = {"h": 0.4e-3, "radius": 0.1, "zone": 5e-3, "size": 40e-3}
    pascals = {"young": 70e9, "yield_stress": 35e6, "hardening": 70e6}
    depths = Depths(steps=10)[0][:4]
    forces = [
        Indenter(h=0.4).Advance(depths)[-1]["force"],
        Indenter(**metres, **pascals).Advance([1e-3 * d for d in depths])[-1]["force"],
    ]
    assert forces[1] == pytest.approx(1e3 * forces[0], rel=1e-7)


def test_mesh():
    mesh = IndentationMesh(0.4)
    assert set(mesh.GetBoundaries()) == {
        "slave",
        "top",
        "side",
        "bottom",
        "sym",
        "master",
        "back",
    }
    with pytest.raises(ValueError, match="zone"):
        IndentationMesh(0.4, zone=50.0)


def test_indentation_command(tmp_path, capsys):
    pytest.importorskip("matplotlib")
    file = tmp_path / "new" / "figures.json"
    options = ["--h", "0.4", "--steps", "5", "--depth", "0.02", "--out", str(tmp_path)]
    indentation.main([*options, "--json", str(file)])
    found = json.loads(file.read_text())
    for name in ("indentation.png", "indentation_top.vtu"):
        assert (tmp_path / name).stat().st_size > 3000
    assert "mean pressure" in capsys.readouterr().out
    assert found["steps"] == len(found["curve"])
    assert found["prandtl"] == pytest.approx(2.9685, abs=1e-4)
    assert found["onset_pressure"] == pytest.approx(1.79, rel=0.03)


def test_indentation_help_and_bad_values(capsys):
    assert "(default: 0.08)" in Help(capsys, indentation.main)
    assert "--steps: 0 is less than 1" in Refused(capsys, indentation.main, "--steps", "0")
    assert "--depth: -1 is no finite" in Refused(capsys, indentation.main, "--depth", "-1")
    assert "--yield-stress: 0 is no" in Refused(capsys, indentation.main, "--yield-stress", "0")
