"""Several contact forms in one problem: their sum is what is solved."""

import numpy as np
import pytest
from ngsolve import CF, BilinearForm, GridFunction, InnerProduct, VectorH1, ds
from ngsolve.nonlinearsolvers import NewtonSolver
from press import linear, numpy

from ngslac import ContactSolver, FormSum, LACContact, LACSpace
from ngslac.meshes import TwoBlocks


def pile(traction=(0.1, -1.0), bulk=linear):
    """A block on a block on a rigid floor; everything is held by friction alone."""
    mesh = TwoBlocks(0.34, overhang=0.2, aligned=False, structured=True)
    V = VectorH1(mesh, order=2)
    X = V * LACSpace(V, slave="slave") * LACSpace(V, slave="bottom")
    (u, upper, floor), (v, *_) = X.TnT()
    a = BilinearForm(X)
    a += bulk(u, v) - InnerProduct(CF(traction), v) * ds("top")
    between = LACContact(u, upper, master="master", friction=0.5)
    below = LACContact(u, floor, obstacle=CF(0.0), friction=0.5)
    return a, GridFunction(X), between, below


def test_forces_pass_through_the_pile():
    a, gf, between, below = pile()
    ContactSolver(a, gf, [between, below]).Solve(printing=False)
    assert between.Force() == pytest.approx([-0.1, 1.0], abs=1e-10)
    assert below.Force() == pytest.approx([-0.1, 1.0], abs=1e-10)
    # Moments: of the load about the origin, against the contact tractions on both levels.
    load = -1.0 * 0.5 - 0.1 * 1.0  # x F_y - y F_x at the middle of the top (0.5, 1)
    assert between.Moment((0, 0)) == pytest.approx(-load, abs=1e-9)
    assert below.Moment((0, 0)) == pytest.approx(-load, abs=1e-9)


def test_history_counts_all_macro_elements():
    a, gf, between, below = pile()
    solver = ContactSolver(a, gf, [between, below])
    last = solver.Solve(printing=False)
    n = between.space.nmacros + below.space.nmacros
    assert last.open + last.stick + last.slip == n
    statuses = np.concatenate([c.Table()["status"] for c in (between, below)])
    assert np.bincount(statuses, minlength=3).tolist() == [last.open, last.stick, last.slip]


def test_form_sum_of_two_contacts():
    """The stock solver on the sum, from a start that is closed everywhere."""
    a, gf, between, below = pile()
    ContactSolver(a, gf, [between, below]).Solve(printing=False)
    expected = numpy(gf)
    gf.vec.FV().NumPy()[:] *= 0.9
    form = FormSum(a, between, below)
    newton = NewtonSolver(form, gf, freedofs=gf.space.FreeDofs(), inverse="umfpack")
    newton.Solve(maxerr=1e-12, maxit=20, printing=False)
    assert numpy(gf) == pytest.approx(expected, abs=1e-10 * np.abs(expected).max())


def test_order_of_the_contacts_does_not_matter():
    results = []
    for turned in (False, True):
        a, gf, *contacts = pile()
        ContactSolver(a, gf, contacts[::-1] if turned else contacts).Solve(printing=False)
        results.append(numpy(gf))
    assert results[0] == pytest.approx(results[1], abs=1e-12)
