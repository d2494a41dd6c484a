"""A mass matrix by its products alone, as on distributed meshes, does what its factors do."""

import numpy as np
import pytest
import scipy
from press import press

from ngslac.arrays import AsNumPy, ScalarDofs
from ngslac.bodies.constraints import AllJumps
from ngslac.bodies.mass import MassByProducts, WholeMass
from ngslac.parallel.form import WholeTrace
from ngslac.parallel.matrices import SkinRows


@pytest.fixture(params=[2, 3])
def masses(request):
    """Both, the constraints of sticking contact, and random numbers."""
    problem = press(dim=request.param, kinds=("tet", "tet"))
    contact, space = problem.contact, problem.X
    contact.Update()
    free = AsNumPy(ScalarDofs(space.FreeDofs(), space))
    free[contact.form.MultiplierDofs()] = False
    (u, _), (v, _) = space.TnT()
    whole = WholeMass(2.0, (u, v), contact, free)
    other = MassByProducts(2.0, (u, v), contact, free)
    return whole, other, AllJumps(contact).tocsr(), np.random.default_rng(3)


def kept(rows):
    """Rows as distributed meshes have them, here with all columns."""
    return SkinRows(rows, WholeTrace(rows.shape[1]))


def same(one, other):
    assert np.abs(one - other).max() < 1e-12 * np.abs(one).max()


def test_accelerations(masses):
    whole, other, rows, random = masses
    forces = random.normal(size=rows.shape[1])
    same(whole.Solve(forces), other.Solve(forces))
    assert not np.any(other.Solve(0 * forces))


def test_velocities_under_constraints(masses):
    whole, other, rows, random = masses
    rates = random.normal(size=rows.shape[0])
    none = np.zeros((len(rates), 0))
    wanted = whole.Follow(rows, rates, none)
    same(wanted, other.Follow(kept(rows), rates, none))
    twice = scipy.sparse.vstack([rows, rows[:2]]).tocsr()  # some constraints are redundant
    rates = np.concatenate([rates, rates[:2]])
    same(wanted, other.Follow(kept(twice), rates, np.zeros((len(rates), 0))))


def test_what_has_no_mass_gives_way(masses):
    whole, other, rows, random = masses
    rates, loose = random.normal(size=rows.shape[0]), random.normal(size=(rows.shape[0], 2))
    loose = np.linalg.qr(loose)[0]
    rates -= loose @ (loose.T @ rates)
    same(whole.Follow(rows, rates, loose), other.Follow(kept(rows), rates, loose))
