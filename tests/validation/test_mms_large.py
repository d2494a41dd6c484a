"""Large deformation on a rigid curved master: least rates, Newton's steps, and the solution."""

from functools import lru_cache

import numpy as np
import pytest
from case_mms_large import (
    FORCE,
    LEVELS,
    NORMAL,
    PRESSURE,
    TRACTION,
    Element,
    Manufactured,
    Rates,
    U,
)
from ngsolve import BND, Integrate, x, y
from ngsolve.meshes import MakeStructured3DMesh

LEAST = {  # rates of displacement and pressure
    Element("tet", 1, "split"): (1.85, 1.2),
    Element("hex", 1, "split"): (1.9, 1.4),
    Element("prism", 1, "split"): (1.9, 1.4),
    Element("tet", 2): (2.75, 1.5),
    Element("hex", 2): (2.9, 0.98),
    Element("prism", 2): (2.9, 0.98),
}


@lru_cache
def Solved(element, n):
    problem = Manufactured(element, n)
    return problem, problem.Solve()


DEFAULT = Element("tet", 1, "split"), Element("hex", 2)
WEEKLY = [pytest.param(e, marks=pytest.mark.full) for e in LEAST if e not in DEFAULT]


@pytest.mark.parametrize("element", [*DEFAULT, *WEEKLY], ids=lambda element: element.name)
def test_rates_and_newton_from_the_interpolated_solution(element):
    levels = LEVELS[element.order]
    errors = [Solved(element, n)[0].errors for n in levels]
    assert np.all(np.subtract([*Rates(levels, errors).values()], LEAST[element]) >= 0)
    problem, last = Solved(element, levels[-1])
    assert last.number <= 7
    before = problem.solver.history[-2]
    assert last.equilibrium <= max(1e-3 * before.equilibrium, 1e-12)


def test_contact_carries_what_the_exact_pressure_does():
    """Resultant of the tractions against the exact pressure along the normal."""
    problem, _ = Solved(Element("hex", 2), 4)
    slave = problem.mesh.Boundaries("slave")
    exact = Integrate(-PRESSURE * NORMAL, problem.mesh, BND, definedon=slave, order=8)
    assert problem.contact.Force() == pytest.approx(np.array(exact), rel=2e-3, abs=2e-5)


def test_the_exact_solution():
    """Place and pressure of the slave face by their formulas; Gauss' theorem for the stress."""
    cube = MakeStructured3DMesh(hexes=True, nx=1)
    for at in ((0.2, 0.3), (0.9, 0.1)):
        place = np.array([*at, 0]) + np.array(U(cube(*at, 0)))
        assert place == pytest.approx([*at, -0.2 * (1 + at[0] ** 2 + at[1] ** 2) - 0.3], abs=1e-15)
    c = 1 - 0.002 * (1 + x * x + y * y) - 0.01
    formula = c * (1 - c * c) / 2 / (1 + 0.16 * (x * x + y * y)) ** 0.5
    face = {"definedon": cube.Boundaries("bottom"), "order": 8}
    assert Integrate((PRESSURE - formula) ** 2, cube, BND, **face) ** 0.5 < 1e-15
    force = np.array(Integrate(FORCE, cube, order=10))
    traction = np.array(Integrate(TRACTION, cube, BND, order=10))
    assert force + traction == pytest.approx(np.zeros(3), abs=1e-12)
    assert np.abs(force).max() > 1e-3
