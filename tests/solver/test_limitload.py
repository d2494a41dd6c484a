"""Limit loads: a bar that softens when it is compressed, whose largest force is known."""

import re

import numpy as np
import pytest
from ngsolve import (
    BilinearForm,
    Grad,
    GridFunction,
    Id,
    InnerProduct,
    Parameter,
    Variation,
    VectorH1,
    ds,
    dx,
)
from press import linear

from ngslac import ContactConvergenceError, ContactSolver, LACContact, LACSpace, LoadStepper
from ngslac.meshes import TwoBlocks
from ngslac.steps.limitload import LimitLoad

LIMIT = 2 / (3 * np.sqrt(3))  # of F - F^3, a stress over mu, where F^2 = 1/3


def bar(end=1.0):
    """A stepper that presses a block of Saint Venant and Kirchhoff's material, nu 0, mu 1."""
    mesh = TwoBlocks(0.4, 0.5)
    V = VectorH1(mesh, order=2, dirichlet="bottom", dirichletx="top")
    X = V * LACSpace(V, slave="slave")
    (u, lam), (v, _) = X.TnT()
    F, load, a = Id(2) + Grad(u), Parameter(0.0), BilinearForm(X)
    strain = 0.5 * (F.trans * F - Id(2))
    a += Variation(InnerProduct(strain, strain).Compile() * dx("upper"))
    a += linear(u, v, dx("lower"))
    a += load * end * v[1] * ds("top")
    contact = LACContact(u, lam, master="master")
    return LoadStepper(ContactSolver(a, GridFunction(X), contact), load)


def test_a_limit_load_is_named_with_bounds():
    stepper, systems = bar(), []
    solve = stepper.solver.Solve

    def counted(**flags):
        try:
            return solve(**flags)
        finally:
            systems.append(len(stepper.solver.history) - 1)

    stepper.solver.Solve = counted
    with pytest.raises(ContactConvergenceError, match="body 'upper' snaps or collapses") as error:
        stepper.Integrate(steps=1, printing=False)
    least, most = map(float, re.search(r"between (\S+) and (\S+),", str(error.value)).groups())
    assert least == pytest.approx(stepper.load.Get(), abs=1e-4)
    assert least < LIMIT < most
    assert most - least < 0.1
    assert sum(systems) < 150


def test_below_the_limit_all_is_well():
    stepper = bar(0.97 * LIMIT)
    stepper.Integrate(steps=1, printing=False)
    assert stepper.load.Get() == 1


@pytest.mark.parametrize(("share", "accuracy"), [(0.5, 0.1), (0.9, 0.01), (0.98, 0.002)])
def test_the_estimate_gets_better_near_the_limit(share, accuracy):
    stepper = bar()
    stepper.Integrate(share * LIMIT, steps=3, printing=False)
    limit = LimitLoad(stepper.solver, stepper.load, 1.0)
    before = stepper.solver.gf.vec.FV().NumPy().copy()
    limit.Estimate(0.5, failed=False)
    assert limit.expected == pytest.approx(LIMIT, rel=accuracy)
    limit.Estimate(min(0.99, 0.2 + 0.8 * share) * LIMIT, failed=False)  # short of the limit
    assert limit.expected is None
    assert np.all(stepper.solver.gf.vec.FV().NumPy() == before)
    assert stepper.load.Get() == pytest.approx(share * LIMIT, rel=1e-12)
