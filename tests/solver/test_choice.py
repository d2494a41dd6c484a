"""Which linear systems are solved by iteration without being asked to, and that it is exact."""

import numpy as np
import pytest
from ngsolve import ds
from press import linear, mixed_press3d, numpy, press, press3d, solved

import ngslac.linear.chain
from ngslac import LoadStepper

CASES = {  # of many free displacements, with sticking, slip, and open contact
    "large sliding": {"finite": True, "n": (2, 1)},
    "large sliding of tetrahedra": {"finite": True, "nonlinear": True, "kinds": ("tet", "tet")}
    | {"n": (2, 1)},
    "condensed": {"condense": True, "n": (2, 1)},
    "condensed order 3": {"condense": True, "order": 3, "kinds": ("prism", "tet"), "n": (2, 1)},
    "condensed and large sliding": {"condense": True, "finite": True, "n": (2, 1)},
}


@pytest.fixture
def small_is_large(monkeypatch):
    monkeypatch.setitem(ngslac.linear.chain.LARGE, "ngsolve", {2: 1, 3: 1})
    monkeypatch.setattr(ngslac.linear.chain, "FACTORED", {2: 0, 3: 0})


def state(flags, **options):
    """Displacements, contact forces and iterations of a solution, and how it was solved."""
    problem = mixed_press3d(**flags)
    solver = solved(problem, **options)
    u, force = numpy(problem.gf.components[0]), np.array(problem.contact.Force())
    return u, force, len(solver.history), solver.linear


@pytest.mark.parametrize("case", CASES)
def test_large_problems_are_iterated(case, small_is_large):
    """With the same results as by factorisations, in hardly more Newton steps."""
    u, force, steps, linear = state(CASES[case])
    expected, pushed, fewest, direct = state(CASES[case], solver="direct")
    assert (linear.method, linear.factorisations) == ("iterative", 0)
    assert direct.factorisations > 0
    assert u == pytest.approx(expected, abs=1e-8 * np.abs(expected).max())
    assert force == pytest.approx(pushed, abs=1e-8 * np.abs(pushed).max())
    assert steps <= fewest + 2


@pytest.mark.parametrize("dim", [2, 3])
@pytest.mark.parametrize("flags", [{}, {"finite": True}, {"condense": True}])
def test_small_problems_are_factored(dim, flags):
    """The bulk alone, once for all systems, or with the constraints."""
    make = press3d if dim == 3 else press
    assert make(**flags).solver().linear.method == "interface"


@pytest.mark.parametrize("flags", [{}, {"nonlinear": True}, {"finite": True}, {"spring": 0.0}])
def test_condensed_forms_on_the_interface(flags):
    """As without condensation; order 3, so that there are dofs inside."""
    given = {"order": 3, "n": (2, 1), "kinds": ("hex", "tet")} | flags
    if "spring" in flags:  # nothing but contact holds the upper block
        given["bulk"] = lambda u, v, load: [
            linear(u, v),
            load * (4 * v[2] - 0.2 * v[0]) * ds("top"),
        ]
    u, force, _, solver = state(given | {"condense": True})
    expected, pushed, _, _ = state(given, solver="direct")
    assert solver.method == "interface"
    assert u == pytest.approx(expected, abs=1e-8 * np.abs(expected).max())
    assert force == pytest.approx(pushed, abs=1e-8 * np.abs(pushed).max())


@pytest.mark.parametrize("flags", [{"finite": True}, {"condense": True}])
def test_a_direct_solver_that_is_asked_for_is_used(flags, small_is_large):
    problem = press3d(**flags)
    assert problem.solver(inverse="umfpack").linear.method == "direct"
    assert problem.solver(solver="direct").linear.method == "direct"
    assert problem.solver().linear.method == "iterative"


def test_large_sliding_in_steps(small_is_large):
    """Over several macro-elements, to where the direct solver gets."""
    results = []
    for solver in (None, "direct"):
        problem = press3d(finite=True, friction=0.2, push=(0.5, 0.2, -0.02), n=(2, 1))
        problem.load.Set(0.0)
        history = LoadStepper(problem.solver(solver=solver), problem.load).Integrate(
            1.0, steps=2, printing=False
        )
        results.append(numpy(problem.gf.components[0]))
        assert [step.cuts for step in history] == [0, 0]
    assert results[0] == pytest.approx(results[1], abs=1e-8 * np.abs(results[1]).max())


def test_an_older_name_of_the_direct_solver():
    with pytest.warns(DeprecationWarning, match="solver='direct'") as warned:
        assert press().solver(solver="saddle").linear.method == "direct"
    assert "posed.py" in warned[0].filename
