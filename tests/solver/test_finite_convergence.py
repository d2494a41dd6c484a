"""Quadratic convergence of finite sliding with friction, over several faces in each step.

`python -m pytest -s` prints the last residuals of each step (the larger one of equilibrium and
constraint), the table of which the tests say that it is quadratic.
"""

from dataclasses import dataclass

import numpy as np
import pytest
from press import press, press3d

from ngslac import LoadStepper

FACTOR = 20.0  # r(k+1) <= FACTOR r(k)^2
NEAR, DONE = 1e-2, 1e-9  # between a Newton method's last guesses and rounding


@dataclass
class Slide:
    """One step: residuals of its iterations, largest slip, share of the slave that is paired."""

    residuals: list
    slip: float
    paired: float
    cuts: int

    def __str__(self):
        last = "  ".join(f"{r:8.1e}" for r in self.residuals[-4:])
        return f"  {len(self.residuals) - 1:2d} iterations  {last}   slip {self.slip:.2f}"

    def Quadratic(self):
        return all(
            after <= max(FACTOR * before**2, DONE)
            for before, after in zip(self.residuals, self.residuals[1:], strict=False)
            if before <= NEAR
        )


def slides(problem, steps):
    solver = problem.solver()
    problem.load.Set(0)
    done = []

    def record(step):
        table = problem.contact.Table()
        done.append(
            Slide(
                [max(line.equilibrium, line.constraint) for line in solver.history],
                np.linalg.norm(table["slip"], axis=1).max(),
                table["area"].sum() / table["fullarea"].sum(),
                step.cuts,
            )
        )

    stepper = LoadStepper(solver, problem.load)
    stepper.Integrate(steps=steps, printing=False, callback=record, tol=1e-12)
    return done


def check(name, done, least):
    print(f"\n{name}", *done, sep="\n")
    for step in done:
        assert step.cuts == 0
        assert step.slip >= least
        assert step.Quadratic()
        assert step.residuals[-1] <= 1e-12


FORMS = {
    "order 1": {"order": 1},
    "order 2": {},
    "order 3": {"order": 3},
    "quads": {"mesh_flags": {"quads": True}},
    "frictionless": {"friction": None},
    "tresca": {"friction": None, "tresca": 1.0},
}


@pytest.mark.parametrize("form", FORMS)
def test_sliding_block(form):
    """Two faces of the slave, almost three of the master in each step."""
    flags = {"friction": 0.3} | FORMS[form]
    flags["mesh_flags"] = {"overhang": 1.2} | flags.get("mesh_flags", {})
    problem = press(push=(1.1, -0.15), h=0.15, nonlinear=True, finite=True, **flags)
    check(form, slides(problem, 3), 0.0 if form == "frictionless" else 0.3)


CELLS = {
    "hexes, order 1": (("hex", "hex"), 1, (5, 8), 2),
    "tets on prisms, order 1": (("tet", "prism"), 1, (5, 8), 2),
    "hexes on tets, order 2": (("hex", "tet"), 2, (2, 5), 1),
}


@pytest.mark.parametrize("cells", CELLS)
def test_sliding_block_3d(cells):
    kinds, order, n, steps = CELLS[cells]
    push = tuple(0.5 * steps * value for value in (0.6, 0.3, -0.1))
    mesh_flags = {"overhang": 0.6, "height": 0.6}
    problem = press3d(
        kinds=kinds, order=order, n=n, push=push, nonlinear=True, finite=True,
        mesh_flags=mesh_flags, friction=0.3,
    )  # fmt: skip
    check(cells, slides(problem, steps), 0.28)


@pytest.mark.parametrize("order", [1, 2, 3])
def test_slave_beyond_the_rim(order):
    """The part of the slave that has a partner changes in every iteration."""
    problem = press(
        order=order, push=(0.3, -0.05), h=0.15, nonlinear=True, finite=True, friction=0.3,
        mesh_flags={"overhang": -0.3},
    )  # fmt: skip
    done = slides(problem, 4)
    assert all(0.5 < step.paired < 0.7 for step in done)
    check(f"rim, order {order}", done, 0.05)
