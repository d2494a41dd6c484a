"""The matrix of the contact form against central differences of its residual."""

import numpy as np
import pytest
from blocks import (
    block_mesh,
    contact_form,
    matrix,
    mixed_state,
    random_state,
    residual,
    statuses,
    vector,
)
from ngsolve import CF, GridFunction, Parameter, TaskManager, x, y

LAWS = {
    "frictionless": {},
    "coulomb": {"friction": 0.7},
    "coulomb of place": {"friction": 0.5 + 0.4 * x * y},
    "parameter": {"friction": Parameter(0.6)},
    "tresca": {"tresca": 0.8},
    "coulomb and tresca": {"friction": 0.3, "tresca": 0.5},
    "tied": {"tied": True},
    "obstacle": {"obstacle": 0.1 * x - 0.05},
    "obstacle with friction": {"obstacle": CF(0.1), "friction": 0.5},
    "obstacle with tresca": {"obstacle": CF(0.1), "tresca": 0.5},
}
EXPECTED = {"frictionless": {0, 2}, "obstacle": {0, 2}, "tied": {0, 1}}


@pytest.fixture(scope="module")
def mesh():
    return block_mesh()


def differences(contact, state, eps=1e-5):
    """Central differences of the residual for each scalar dof."""
    columns = []
    for i in range(len(state)):
        step = np.zeros(len(state))
        step[i] = eps
        columns.append((residual(contact, state + step) - residual(contact, state - step)) / eps)
    return 0.5 * np.stack(columns, axis=1)


@pytest.mark.parametrize("seed", [0, 1])
@pytest.mark.parametrize("law", LAWS)
def test_derivative(mesh, law, seed):
    contact = contact_form(mesh, **LAWS[law])
    state = mixed_state(contact, EXPECTED.get(law, {0, 1, 2}), 10 * seed)
    exact = matrix(contact, state)
    found = differences(contact, state)
    assert np.abs(found - exact).max() <= 1e-7 * np.abs(exact).max()
    assert np.abs(exact).max() > 0


@pytest.mark.parametrize("space", ["P1", "P3", "block", "bubble"])
def test_derivative_on_other_spaces(mesh, space):
    contact = contact_form(mesh, space, friction=0.7)
    state = mixed_state(contact, {0, 1, 2})
    exact = matrix(contact, state)
    assert np.abs(differences(contact, state) - exact).max() <= 1e-7 * np.abs(exact).max()


def test_derivative_in_a_deformed_configuration(mesh):
    """Pairing, gaps and slips of a configuration other than the reference."""
    contact = contact_form(mesh, friction=0.7)
    gf = GridFunction(contact.form.fes)
    gf.components[0].Set(CF((0.1 * y + 0.03 * x * x, 0.05 * x)))
    contact.Update(gf)
    contact.form.SetConstant(2.0)
    state = gf.vec.FV().NumPy() + random_state(contact, 1)
    assert set(statuses(contact, state)) == {0, 1, 2}
    exact = matrix(contact, state)
    assert np.abs(differences(contact, state) - exact).max() <= 1e-7 * np.abs(exact).max()


def asymmetry(mat):
    return np.abs(mat - mat.T).max() / np.abs(mat).max()


@pytest.mark.parametrize("law", [{"friction": 1e6}, {"tresca": 1e6}, {"tied": True}])
def test_symmetric_where_everything_sticks(law):
    """Sticking rows are the transposed columns: force and constraint use one operator."""
    contact = contact_form(block_mesh(h=0.2), **law)
    state = random_state(contact)
    dofs = contact.form.MultiplierDofs().reshape(-1, 2)
    state[dofs] -= 20 * contact.Table()["normal"]  # enough pressure to close all of them
    paired = contact.Table()["area"] > 0
    assert set(statuses(contact, state)[paired]) == {1}
    assert asymmetry(matrix(contact, state)) <= 1e-15


def test_force_is_the_transposed_jump_in_every_state(mesh):
    """Columns of the multipliers: minus (D - M) transposed, whatever the status."""
    contact = contact_form(mesh, friction=0.7)
    D, M = (op.ToDense().NumPy() for op in contact.Mortar())
    columns = matrix(contact, random_state(contact))[:, contact.form.MultiplierDofs()]
    first = contact.form.offset
    assert columns[first : first + D.shape[1]] == pytest.approx(-(D - M).T, abs=1e-15)


@pytest.mark.parametrize("law", ["frictionless", "coulomb", "tresca"])
@pytest.mark.parametrize("space", ["P1", "P2", "block"])
def test_graph_is_exact(mesh, space, law):
    """Every stored entry is used in some state, and none is stored twice."""
    contact = contact_form(mesh, space, **LAWS[law])
    rows, columns, _ = contact.mat.COO()
    rows, columns = np.array(rows), np.array(columns)
    assert len(set(zip(rows.tolist(), columns.tolist(), strict=True))) == len(rows)
    used = np.zeros(len(rows), dtype=bool)
    for seed in range(40):
        contact.AssembleLinearization(vector(contact, random_state(contact, seed)))
        used |= np.array(contact.mat.COO()[2]) != 0
    # A macro-element without a partner has nothing but its diagonal block.
    unpaired = np.flatnonzero(contact.Table()["area"] == 0)
    alone = np.isin(rows, contact.form.MultiplierDofs().reshape(-1, 2)[unpaired].ravel())
    assert np.all(used[~alone])
    assert alone.sum() == 4 * len(unpaired)


def test_graph_couples_macros_with_displacements_only(mesh):
    """No entries between displacements, none between different macro-elements."""
    contact = contact_form(mesh, friction=0.5)
    rows, columns, _ = (np.array(a) for a in contact.mat.COO())
    dofs = contact.form.MultiplierDofs()
    macro = np.full(contact.nscalars, -1)
    macro[dofs] = np.arange(len(dofs)) // 2
    assert np.all((macro[rows] >= 0) | (macro[columns] >= 0))
    both = (macro[rows] >= 0) & (macro[columns] >= 0)
    assert np.array_equal(macro[rows][both], macro[columns][both])


@pytest.mark.parametrize("law", ["coulomb of place", "obstacle with friction"])
def test_threads_change_nothing_but_rounding(mesh, law):
    contact = contact_form(mesh, **LAWS[law])
    state = random_state(contact, 7)
    alone, linear = residual(contact, state), matrix(contact, state)
    x = vector(contact, state)
    with TaskManager():
        threaded = residual(contact, state)
        contact.AssembleLinearization(x)
    assert np.abs(threaded - alone).max() <= 1e-14 * np.abs(alone).max()
    assert np.array_equal(contact.mat.ToDense().NumPy(), linear)


def test_apply_adds_or_replaces(mesh):
    contact = contact_form(mesh, friction=0.5)
    state = random_state(contact)
    expected = residual(contact, state)
    x, y = vector(contact, state), vector(contact, 1.0)
    contact.AddApply(x, y)
    assert y.FV().NumPy() == pytest.approx(expected + 1, abs=1e-13)
    contact.Apply(x, y)
    assert y.FV().NumPy() == pytest.approx(expected, abs=1e-14)


def test_a_parameter_acts_at_once(mesh):
    coefficient = Parameter(0.0)
    contact = contact_form(mesh, friction=coefficient)
    state = random_state(contact)
    for value in (0.0, 0.4, 5.0):
        coefficient.Set(value)
        fixed = contact_form(mesh, friction=value)
        assert residual(contact, state) == pytest.approx(residual(fixed, state), abs=1e-14)
