"""Lifts of least energy are exact, and iterations do not see which body is stiffer."""

from functools import partial

import numpy as np
import pytest
from netgen.meshing import NgException
from ngsolve import Grad, InnerProduct, Parameter, Sym, TaskManager, dx
from press import mixed_press3d, press3d, same, solved, stress
from test_condensed import condition, dense, system
from test_linear import CASES, made

from ngslac._ngslac import Condensation
from ngslac.arrays import AsBits, AsNumPy


def bodies(ratio):
    """Bulk in which the slave is stiffer by a ratio."""

    def bulk(u, v, _):
        work = InnerProduct(stress(u), Sym(Grad(v)))
        return [ratio * work * dx("upper"), work * dx("lower")]

    return bulk


def contrast(make, ratio, **flags):
    """A press in which the slave, and the springs that hold it, are stiffer by a ratio."""
    return make(bulk=bodies(ratio), spring=1000.0 * ratio, **flags)


STICK, TIED, FREE = {"friction": 5.0}, {"tied": True, "friction": None}, {}
RATIOS = (1e-4, 1.0, 1e4)
ANY = {case: partial(made, case) for case in CASES}
ANY |= {f"3D {ratio:g}": partial(contrast, mixed_press3d, ratio) for ratio in RATIOS}
ANY |= {"rotated": partial(mixed_press3d, mesh_flags={"rotation": ((1.0, 2.0, 3.0), 0.7)})}


def image(mat, values):
    """Product with the entries of an array."""
    x = mat.CreateRowVector()
    x.FV().NumPy()[:] = values
    return (mat * x).Evaluate().FV().NumPy().copy()


def reduce(condensed, mat, b):
    """The right hand side of the condensed system."""
    u = condensed.Displacements(b, 0 * b)
    reduced = condensed.Reduce(b, u, image(mat, u))
    near = condensed.Reduce(b, u)  # with the part of the image that counts
    assert near == pytest.approx(reduced, abs=1e-11 * np.abs(reduced).max())
    return reduced


def expand(condensed, mat, b, w):
    """The whole solution from that of the condensed system."""
    u = condensed.Displacements(b, w)
    whole = condensed.Complete(b, u, image(mat, u))
    assert condensed.Complete(b, u) == pytest.approx(whole, abs=1e-11 * np.abs(whole).max())
    return whole


@pytest.mark.parametrize("case", ANY)
def test_the_whole_solution_solves_the_condensed_system(case):
    """Also for a right hand side that is none of Newton's; P u is what counts."""
    given, _ = system(ANY[case]())
    mat, multipliers, _, free = given
    b = np.random.default_rng(3).standard_normal(mat.height) * AsNumPy(free)
    expected = image(mat.Inverse(free, inverse="umfpack"), b)
    condensed = Condensation(*given)
    inner = AsNumPy(condensed.freedofs)
    u, reduced = expected * inner, reduce(condensed, mat, b)
    size = np.abs(expected).max()
    assert np.abs(image(condensed, u) - reduced)[inner].max() < 1e-10 * size
    assert expand(condensed, mat, b, u) == pytest.approx(expected, abs=1e-9 * size)
    assert not np.any(inner[multipliers])


@pytest.mark.parametrize("case", ["2D stick", "3D tied", "3D mixed"])
def test_lifts_cancel(case):
    """A vanishes on what the lifts span, of which the projection leaves nothing."""
    given, _ = system(made(case))
    condensed = Condensation(*given)
    free = AsNumPy(condensed.freedofs)
    w = np.random.default_rng(6).standard_normal(condensed.height) * free
    kept = condensed.Project(w)
    assert np.abs(condensed.Project(kept) - kept)[free].max() < 1e-11 * np.abs(w).max()
    rest = (w - kept) * free
    assert np.abs(rest).max() > 1e-3
    assert np.abs(image(condensed, rest)).max() < 1e-11 * np.abs(image(condensed, w)).max()
    tested = condensed.Test(w)
    assert np.abs(condensed.Test(tested) - tested).max() < 1e-11 * np.abs(w).max()


@pytest.mark.sample(6)
@pytest.mark.parametrize("ratio", [1e-4, 1e-2, 1.0, 1e2, 1e4])
@pytest.mark.parametrize("law", [STICK, TIED, FREE])
def test_condition_number_does_not_see_the_ratio(ratio, law):
    """Within a factor of ten of the bulk's, where pivots on the stiff side take a thousand."""
    given, _ = system(contrast(press3d, ratio, n=(2, 3), **law))
    condensed = Condensation(*given)
    inner = condensed.freedofs
    bulk = condition(dense(given[0], inner))
    assert np.sum(condensed.constraints) > 0
    assert condition(dense(condensed.Part(np.arange(condensed.height)), inner)) < 10 * bulk


@pytest.mark.sample(3)
@pytest.mark.parametrize("friction", [None, 0.1, 5.0])
@pytest.mark.parametrize("n", [(2, 5), (3, 2)])
def test_iterations_do_not_see_the_ratio(friction, n):
    """Stick, slip and neither; the master finer and coarser. The solution is that of LU."""
    given, counts = {"friction": friction, "n": n, "kinds": ("tet", "tet")}, []
    for ratio in RATIOS:
        reference, problem = (contrast(press3d, ratio, **given) for _ in range(2))
        solved(reference, solver="direct")
        solver = solved(problem, solver="iterative")
        assert (solver.linear.method, solver.linear.factorisations) == ("iterative", 0)
        same(problem, reference, 1e-7)
        counts.append(solver.linear.krylov / (len(solver.history) - 1))
    assert max(counts) < 1.5 * counts[1]


def test_dependent_constraints_are_refused():
    """Where all that a macro-element touches is held."""
    (mat, multipliers, dim, free), _ = system(press3d(friction=Parameter(5.0)))
    held = AsNumPy(free)
    values = dense(mat)
    held &= ~(values[multipliers[:dim]] != 0).any(axis=0)
    held[multipliers] = True
    with TaskManager(), pytest.raises(NgException, match="depend on each other"):
        Condensation(mat, multipliers, dim, AsBits(held))
