"""Rates of convergence with large deformation on a rigid curved master (T09), 3D.

Published for Local Average Contact (code_aster SSNV219, last refinement; displacement and pressure
in L2): 2.0 and 1.3 to 1.9 for order 1, 2.5 to 3.9 and 1.0 to 2.0 for order 2; theory has 2 and 1/2,
5/2 and 1. `mms_large_table.py` prints our table.
"""

from functools import lru_cache

import numpy as np
import pytest
from ngsolve import BND, CF, Integrate, Mesh, x, y, z
from ngsolve.meshes import MakeStructured3DMesh
from problems_mms_large import COORDINATES, EXACT, Case, Exact, Manufactured, Rates

# case, meshes, least rates of displacement and pressure
CASES = [
    (Case("tet", 1, "split"), (3, 6), (1.85, 1.2)),
    (Case("hex", 1, "split"), (3, 6), (1.9, 1.4)),
    (Case("prism", 1, "split"), (3, 6), (1.9, 1.4)),
    (Case("tet", 2), (2, 4), (2.75, 1.5)),
    (Case("hex", 2), (2, 4), (2.9, 0.98)),
    (Case("prism", 2), (2, 4), (2.9, 0.98)),
]


@lru_cache
def Solved(case, n):
    problem = Manufactured(case, n)
    return problem, problem.Solve()


@pytest.mark.parametrize(("case", "levels", "least"), CASES, ids=lambda c: getattr(c, "name", None))
def test_rates(case, levels, least):
    errors = [Solved(case, n)[0].errors for n in levels]
    rates = Rates(levels, errors)
    assert rates["displacement"] >= least[0]
    assert rates["pressure"] >= least[1]


@pytest.mark.parametrize("case", [case for case, _, _ in CASES], ids=lambda case: case.name)
def test_newton_converges_fast_from_the_interpolated_solution(case):
    levels = next(levels for other, levels, _ in CASES if other == case)
    problem, last = Solved(case, levels[-1])
    assert last.number <= 7
    before = problem.solver.history[-2]
    assert last.equilibrium <= max(1e-3 * before.equilibrium, 1e-12)


def test_contact_carries_what_the_exact_pressure_does():
    """Resultant of the tractions against the exact pressure along the normal."""
    problem, _ = Solved(Case("hex", 2), 4)
    slave = problem.mesh.Boundaries("slave")
    exact = Integrate(-EXACT.pressure * EXACT.normal, problem.mesh, BND, definedon=slave, order=8)
    assert problem.contact.Force() == pytest.approx(np.array(exact), rel=2e-3, abs=2e-5)


# ---------------------------------------------------------------- the manufactured solution


@pytest.fixture(scope="module")
def cube():
    return MakeStructured3DMesh(hexes=True, nx=1)


def test_slave_face_is_taken_to_the_master(cube):
    from problems_mms_large import U

    for px, py in ((0.2, 0.3), (0.9, 0.1)):
        place = np.array([px, py, 0]) + np.array(U(cube(px, py, 0)))
        assert place == pytest.approx([px, py, -0.2 * (1 + px**2 + py**2) - 0.3], abs=1e-15)


def test_pressure_is_that_of_the_formula(cube):
    c = 1 - 0.002 * (1 + x * x + y * y) - 0.01
    formula = c * (1 - c * c) / 2 / (1 + 0.16 * (x * x + y * y)) ** 0.5
    bottom = cube.Boundaries("bottom" if "bottom" in cube.GetBoundaries() else ".*")
    error = Integrate((EXACT.pressure - formula) ** 2, cube, BND, definedon=bottom, order=8)
    assert error**0.5 < 1e-15


def test_force_balances_the_traction(cube):
    """Gauss' theorem for P, with the derivatives and normals that the loads use."""
    force = np.array(Integrate(EXACT.force, cube, order=10))
    traction = np.array(Integrate(EXACT.traction, cube, BND, order=10))
    assert force + traction == pytest.approx(np.zeros(3), abs=1e-12)
    assert np.abs(force).max() > 1e-3


def test_uniaxial_strain(cube):
    """U = (0, 0, s z): P_zz = (1 + s) ((1 + s)^2 - 1) / 2."""
    exact = Exact.Of(CF((0 * x, 0 * y, 0.1 * z)))
    P = exact.P(cube(0.3, 0.3, 0.3))
    assert P[8] == pytest.approx(1.1 * (1.1**2 - 1) / 2, rel=1e-14)
    assert len(COORDINATES) == 3
    assert isinstance(cube, Mesh)
