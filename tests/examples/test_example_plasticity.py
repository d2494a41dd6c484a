"""Elastoplastic indentation against Johnson's numbers; its law against a return map."""

import math

import indentation
import ngsolve as ngs
import numpy as np
import pytest
from indentation import PRANDTL, Cycle, Depths, Indenter, OnsetPressure
from netgen.occ import OCCGeometry
from ngsolve.meshes import MakeStructured2DMesh
from plasticity import J2Plasticity, LogStrain

from ngslac import ContactConvergenceError
from ngslac.materials import Stress
from ngslac.meshes.geometry import Polygon

approx = pytest.approx


def test_onset_of_yield():
    """Johnson 1985, section 6.1: 1.79 for the Poisson ratio 0.3."""
    assert OnsetPressure(0.3) == approx(1.79, abs=0.005)
    assert indentation.Onset() == approx(OnsetPressure(0.3), rel=0.015)


@pytest.mark.full
def test_loading_unloading_and_loading_again():
    """Johnson 1985, sections 6.2 and 6.4, but for a little yield where the edge was."""
    results = Cycle(Indenter())
    figures, peak = results.figures, results.loading[-1]["force"]
    mean = [row["mean_pressure"] / 35.0 for row in results.loading if row["closed"] > 8]
    assert 0.9 * PRANDTL < mean[-1] < PRANDTL
    assert np.all(np.diff(mean) > -0.03)  # the width is known to a tenth of an element
    assert np.mean(mean[-3:]) > 1.02 * np.mean(mean[:3])
    assert np.all(np.diff([row["force"] for row in results.loading]) > 0)
    assert figures["scaled_width"] > 75
    assert figures["balance"] < 1e-9
    before, after = results.residuals[-2:]  # quadratic
    assert after < min(1e-3 * before, max(1e3 * before**2, 1e-13))
    assert figures["cuts"] <= 2
    # Where the cylinder lets go is where the surface stays.
    assert figures["released"]
    assert figures["permanent_depth"] == approx(figures["imprint_depth"], rel=0.005)
    assert 0.7 < figures["permanent_depth"] / 0.08 < 0.85
    # The elastic path of unloading, which begins as a flat punch of the width of the contact.
    assert figures["reloading_force_ratio"] == approx(1, abs=2e-3)
    path = np.transpose(sorted((row["depth"], row["force"]) for row in results.unloading))
    for row in results.reloading:
        assert row["force"] == approx(np.interp(row["depth"], *path), abs=0.02 * peak)
    punch = PunchStiffness(results.indenter, figures["halfwidth"])
    assert figures["unloading_slope"] == approx(punch, rel=0.03)


def PunchStiffness(problem, halfwidth):
    """Elastic stiffness of a rigid, frictionless punch on the block, by plain NGSolve."""
    size = problem.size
    corners = [(0, -size), (size, -size), (size, 0), (halfwidth, 0), (0, 0)]
    block = Polygon(corners, ("bottom", "side", "top", "punch", "sym"), "block", punch=20)
    mesh = ngs.Mesh(OCCGeometry(block, dim=2).GenerateMesh(maxh=8, grading=0.2))
    V = ngs.VectorH1(mesh, order=3, dirichletx="sym|bottom", dirichlety="bottom|punch")
    u, v = V.TnT()
    stress = Stress(ngs.Sym(ngs.Grad(u)), problem.young, problem.poisson)
    a = ngs.BilinearForm(ngs.InnerProduct(stress, ngs.Sym(ngs.Grad(v))) * ngs.dx).Assemble()
    gf = ngs.GridFunction(V)
    gf.Set((0, 1), definedon=mesh.Boundaries("punch"))
    gf.vec.data -= a.mat.Inverse(V.FreeDofs(), inverse="sparsecholesky") * (a.mat * gf.vec)
    return 2 * ngs.InnerProduct((a.mat * gf.vec).Evaluate(), gf.vec)


@pytest.mark.full
def test_rigid_plastic_limit():
    """A block so soft that elasticity plays no role: Prandtl's pressure, from above."""
    soft = Indenter(h=0.4, yield_stress=8.0, hardening=1.6)
    last = soft.Advance(Depths(steps=8)[0])[-1]
    assert last["scaled_width"] > 350
    assert last["mean_pressure"] / 8.0 == approx(PRANDTL, rel=0.04)


def test_a_failed_step_leaves_no_trace():
    """Three iterations are too few: state, solution and curve stay, and the next try is right."""
    depths, runs = Depths(steps=10)[0], []
    for fails in (False, True):
        results = Indenter(h=0.4)
        results.Advance(depths[:3])
        if fails:
            vectors = [gf.vec.FV().NumPy() for gf in (results.material.state, results.solver.gf)]
            before, count = [values.copy() for values in vectors], len(results.curve)
            with pytest.raises(ContactConvergenceError):
                results.Advance(depths[3:4], maxit=1)
            assert all(map(np.array_equal, vectors, before))
            assert len(results.curve) == count
        results.Advance(depths[3:4])
        runs.append(results.curve[-1])
    for name in ("force", "plastic_volume"):
        assert runs[1][name] == approx(runs[0][name], rel=1e-8)


@pytest.mark.full
def test_force_converges_with_the_mesh():
    """The same steps on three meshes; none is halved, since the flow depends on the step size."""
    rows = [Indenter(h=h).Advance(Depths(0.04, 8)[0], maxit=60) for h in (0.6, 0.3, 0.15)]
    assert [len(each) for each in rows] == [8, 8, 8]
    forces = [each[-1]["force"] for each in rows]
    coarse, fine = np.abs(np.diff(forces)) / forces[-1]
    assert coarse < 0.05
    assert fine < 0.01


def test_units_and_sizes_do_not_matter():
    """In metres and pascals, the same: the mesh scales with the radius."""
    metres = {"h": 0.4e-3, "radius": 0.1, "zone": 5e-3, "size": 40e-3}
    pascals = {"young": 70e9, "yield_stress": 35e6, "hardening": 70e6}
    depths = Depths(steps=10)[0][:4]
    force = Indenter(h=0.4).Advance(depths)[-1]["force"]
    other = Indenter(**metres, **pascals).Advance([1e-3 * d for d in depths])[-1]["force"]
    assert other == approx(1e3 * force, rel=1e-7)


# --- the law -------------------------------------------------------------------------------------

ELASTIC = {"young": 70e3, "poisson": 0.3}


def Path():
    """Strains (3, 3) that load, turn and unload."""
    shear = np.array([[0.0, 1, 0], [1, 0, 0], [0, 0, 0]])
    first = np.diag([1.0, -0.6, -0.2]) + 0.5 * shear
    second = np.diag([-0.2, 1.2, 0.0]) - 0.4 * shear
    yield from (2e-3 * t * first for t in (0.2, 0.6, 1.0))
    yield from (2e-3 * (first + t * second) for t in (0.5, 1.0))
    yield 1e-3 * first


class ReturnMap:
    """Radial return by bisection on the plastic increment, written without the code under test."""

    def __init__(self, young, poisson, **law):
        self.shear, self.bulk = young / 2 / (1 + poisson), young / 3 / (1 - 2 * poisson)
        self.law, self.plastic, self.a = law, np.zeros((3, 3)), 0.0

    def Yield(self, a):
        return self.law["yield_stress"] + self.law.get("hardening", 0) * a

    def Step(self, strain):
        deviator = strain - np.trace(strain) / 3 * np.eye(3)
        trial = 2 * self.shear * (deviator - self.plastic)
        mises = math.sqrt(1.5 * np.sum(trial**2))
        low, high = 0.0, mises / self.shear if mises > self.Yield(self.a) else 0.0
        for _ in range(200):
            b = (low + high) / 2
            if mises - 3 * self.shear * b > self.Yield(self.a + b):
                low = b
            else:
                high = b
        flow = 1.5 * low / max(mises, 1e-300) * trial
        self.plastic, self.a = self.plastic + flow, self.a + low
        return self.bulk * np.trace(strain) * np.eye(3) + trial - 2 * self.shear * flow


@pytest.mark.parametrize("law", [{}, {"hardening": 900.0}])
def test_stress_state_and_energy_of_the_law(law):
    law = {"yield_stress": 35.0} | law
    mesh = MakeStructured2DMesh(quads=False, nx=1, ny=1)
    material, exact = J2Plasticity(mesh, **ELASTIC, **law), ReturnMap(**ELASTIC, **law)
    values = [ngs.Parameter(0.0) for _ in range(9)]
    strain = ngs.CF(tuple(values), dims=(3, 3))
    stress, energy = material.Stress(strain), material.Energy(strain)
    area = material.Integral(ngs.CF(1))
    direction, size = np.array([[1.0, 0.3, 0], [0.3, -0.4, 0], [0, 0, 0.5]]), 1e-6

    def Means(matrix, *functions):
        for value, entry in zip(values, matrix.ravel(), strict=True):
            value.Set(float(entry))
        return [material.Integral(function) / area for function in functions]

    for matrix in Path():
        (before,), (after,) = (Means(matrix + s * size * direction, energy) for s in (-1, 1))
        computed = Means(matrix, *(stress[i, j] for i in range(3) for j in range(3)))
        expected = exact.Step(matrix)
        np.testing.assert_allclose(computed, expected.ravel(), rtol=1e-9, atol=1e-6)
        slope = (after - before) / (2 * size)
        assert slope == approx(np.sum(expected * direction), rel=1e-6, abs=1e-4)
        material.Commit(strain)
        state = material.state.vec.FV().NumPy().reshape(5, -1)
        wanted = [*np.diag(exact.plastic), exact.plastic[0, 1], exact.a]
        np.testing.assert_allclose(state, np.outer(wanted, np.ones(state.shape[1])), atol=1e-12)
    assert exact.a > 1e-3


@pytest.mark.parametrize(("size", "error"), [(0.1, 1e-12), (0.3, 1e-8), (0.5, 1e-5)])
def test_the_logarithmic_strain_in_3d(size, error):
    """Of a turned and stretched cube, with its exact volume; in plane strain as in 2D."""
    axes = np.linalg.qr([[1.0, 0.3, 0.2], [0.1, 1.0, -0.5], [-0.4, 0.2, 1.0]])[0]
    turn = np.linalg.qr([[0.2, 1.0, 0.3], [-1.0, 0.4, 0.2], [0.1, 0.5, 1.0]])[0]
    stretches = size * np.array([1.0, -0.3, -0.9])
    F = turn @ axes @ np.diag(np.exp(stretches)) @ axes.T
    mesh = MakeStructured2DMesh(quads=False, nx=1, ny=1)
    point = mesh(0.3, 0.3)

    def Strain(F):
        shape = F.shape
        gradient = ngs.CF(tuple((F - np.eye(len(F))).ravel()), dims=shape)
        return np.reshape(LogStrain(gradient)(point), (3, 3))

    found = Strain(F)
    np.testing.assert_allclose(found, axes @ np.diag(stretches) @ axes.T, rtol=0, atol=error)
    assert np.trace(found) == approx(stretches.sum(), abs=1e-13)
    plane = np.eye(3)
    plane[:2, :2] += size * np.array([[0.3, 0.2], [-0.4, 0.1]])
    np.testing.assert_allclose(Strain(plane), Strain(plane[:2, :2]), rtol=0, atol=error)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"yield_stress": -1.0}, "must be positive"),
        ({"poisson": 0.5}, "poisson"),
        ({"hardening": -1.0}, "must not be negative"),
    ],
)
def test_bad_constants(options, message):
    constants = ELASTIC | {"yield_stress": 35.0} | options
    with pytest.raises(ValueError, match=message):
        J2Plasticity(MakeStructured2DMesh(nx=1, ny=1), **constants)
