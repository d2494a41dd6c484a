"""Quadratic convergence of finite sliding with friction, over several faces in each step.

`python -m pytest -s` prints the last residuals of each step (the larger one of equilibrium and
constraint), the table of which the tests say that it is quadratic.
"""

from itertools import pairwise

import numpy as np
import pytest
from press import press

from ngslac import LoadStepper

FACTOR = 20.0  # r(k+1) <= FACTOR r(k)^2
NEAR, DONE = 1e-2, 1e-9  # between a Newton method's last guesses and rounding

WIDE = {"overhang": 1.2}  # two faces of the slave, almost three of the master in each step
BLOCK = {"push": (1.1, -0.15), "h": 0.15, "mesh_flags": WIDE}
# The part of the slave that has a partner changes in every iteration.
RIM = {"push": (0.3, -0.05), "h": 0.15, "mesh_flags": {"overhang": -0.3}}
CUBE = {"dim": 3, "push": (0.6, 0.3, -0.1), "mesh_flags": {"overhang": 0.6, "height": 0.6}}
SHORT = {"push": (0.3, 0.15, -0.05), "order": 2, "n": (2, 5)}


def of_order_1(*kinds):
    return CUBE | {"kinds": kinds, "order": 1, "n": (5, 8)}


CASES = {  # problem, steps, least slip in each
    **{f"order {k}": (BLOCK | {"order": k}, 3, 0.3) for k in (1, 2, 3)},
    "quads": (BLOCK | {"mesh_flags": WIDE | {"quads": True}}, 3, 0.3),
    "frictionless": (BLOCK | {"friction": None}, 3, 0.0),
    "tresca": (BLOCK | {"friction": None, "tresca": 1.0}, 3, 0.3),
    **{f"rim, order {k}": (RIM | {"order": k}, 4, 0.05) for k in (1, 2, 3)},
    "hexes, order 1": (of_order_1("hex", "hex"), 2, 0.28),
    "tets on prisms, order 1": (of_order_1("tet", "prism"), 2, 0.28),
    "hexes on tets, order 2": (CUBE | SHORT | {"kinds": ("hex", "tet")}, 1, 0.28),
}


@pytest.mark.parametrize(
    "name", [pytest.param(n, marks=pytest.mark.full if "order 3" in n else ()) for n in CASES]
)
def test_convergence_is_quadratic(name):
    flags, steps, least = CASES[name]
    problem = press(**({"nonlinear": True, "finite": True, "friction": 0.3} | flags))
    solver = problem.solver(solver="direct")
    problem.load.Set(0)

    def check(step):
        table = problem.contact.Table()
        slip = np.linalg.norm(table["slip"], axis=1).max()
        errors = [max(line.equilibrium, line.constraint) for line in solver.history]
        last = "  ".join(f"{error:8.1e}" for error in errors[-4:])
        print(f"\n{name:24} {len(errors) - 1:2d} iterations  {last}   slip {slip:.2f}", end="")
        assert step.cuts == 0
        assert slip >= least
        assert errors[-1] <= 1e-12
        for before, after in pairwise(errors):
            assert before > NEAR or after <= max(FACTOR * before**2, DONE)
        paired = table["area"].sum() / table["fullarea"].sum()
        assert 0.5 < paired < 0.7 if "rim" in name else paired > 0

    stepper = LoadStepper(solver, problem.load)
    stepper.Integrate(steps=steps, printing=False, callback=check, tol=1e-12)
