"""The contact form in 3D: its matrix against central differences, its graph, its symmetry."""

import numpy as np
import pytest
from blocks3d import (
    ROTATION,
    SPACES,
    block_mesh,
    contact_form,
    matrix,
    mixed_state,
    random_state,
    residual,
    statuses,
    vector,
)
from ngsolve import CF, H1, GridFunction, Parameter, TaskManager, x, y, z

from ngslac.meshes.geometry3d import RotationMatrix

LAWS = {
    "frictionless": {},
    "coulomb": {"friction": 0.7},
    "coulomb of place": {"friction": 0.8 + 0.4 * x * y + 0.2 * z},
    "parameter": {"friction": Parameter(0.6)},
    "tresca": {"tresca": 0.8},
    "coulomb and tresca": {"friction": 0.3, "tresca": 0.5},
    "tied": {"tied": True},
    "obstacle": {"obstacle": 0.1 * x - 0.05 * z},
    "obstacle with friction": {"obstacle": CF(0.1), "friction": 0.5},
    "obstacle with tresca": {"obstacle": CF(0.1), "tresca": 0.5},
}
EXPECTED = {"frictionless": {0, 2}, "obstacle": {0, 2}, "tied": {1}}
# (upper, lower): triangles and quadrilaterals of every shape of cell, on each side
KINDS = [
    ("hex", "hex"),
    ("tet", "tet"),
    ("prism", "prism_side"),
    ("prism_side", "pyramid"),
    ("pyramid", "tet"),
]


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


def check_derivative(contact, state):
    exact = matrix(contact, state)
    assert np.abs(exact).max() > 0
    assert np.abs(differences(contact, state) - exact).max() <= 1e-7 * np.abs(exact).max()


# --- derivative --------------------------------------------------------------------------------


@pytest.mark.parametrize("law", LAWS)
def test_derivative_in_3d(mesh, law):
    contact = contact_form(mesh, **LAWS[law])
    check_derivative(contact, mixed_state(contact, EXPECTED.get(law, {0, 1, 2})))


@pytest.mark.parametrize("kinds", KINDS)
def test_derivative_between_all_shapes(kinds):
    contact = contact_form(block_mesh(*kinds), friction=0.7)
    check_derivative(contact, mixed_state(contact, {0, 1, 2}))


@pytest.mark.parametrize("space", SPACES)
def test_derivative_on_other_spaces_in_3d(mesh, space):
    if space.startswith("order"):
        mesh = block_mesh("hex", "tet", *{"order 1": (4, 3), "order 3": (2, 1)}[space])
    contact = contact_form(mesh, space, friction=0.7)
    states = (random_state(contact, seed) for seed in range(20))
    check_derivative(contact, next(s for s in states if len(set(statuses(contact, s))) >= 2))


def test_derivative_with_another_unknown_in_front(mesh):
    """The dofs of the displacement do not begin at zero, and need not be those of a VectorH1."""
    contact = contact_form(mesh, before=[lambda m: H1(m, order=1)], friction=0.7)
    state = mixed_state(contact, {0, 1, 2})
    assert contact.form.offset == mesh.nv
    check_derivative(contact, state)
    assert not np.any(matrix(contact, state)[: mesh.nv])
    assert not np.any(residual(contact, state)[: mesh.nv])


def test_derivative_in_a_deformed_configuration_in_3d():
    """Pairing, gaps and slips of a configuration other than the reference."""
    contact = contact_form(block_mesh("hex", "tet", rotation=None), friction=0.7)
    gf = GridFunction(contact.form.fes)
    gf.components[0].Set(CF((0.1 * y + 0.03 * x * x, 0.05 * x * z, 0.04 * x * y)))
    contact.Update(gf)
    contact.form.SetConstant(2.0)
    state = next(
        s
        for s in (gf.vec.FV().NumPy() + random_state(contact, k) for k in range(20))
        if set(statuses(contact, s)) == {0, 1, 2}
    )
    check_derivative(contact, state)


def test_slip_turns_in_the_tangential_plane(mesh):
    """What is new in 3D: the slip direction has a derivative of its own."""
    contact = contact_form(mesh, friction=0.2)
    state = mixed_state(contact, {0, 2})
    dofs = contact.form.MultiplierDofs().reshape(-1, 3)
    m = np.flatnonzero(contact.Table()["status"] == 2)[0]
    block = matrix(contact, state)[np.ix_(dofs[m], dofs[m])]
    area, normal = (contact.Table()[k][m] for k in ("area", "normal"))
    derivative = np.eye(3) + block * 3.0 / area  # of the projection, by the trial traction
    trial = residual_trial(contact, state)[m]
    tangential = trial - trial @ normal * normal
    size = np.linalg.norm(tangential)
    across = np.cross(normal, tangential / size)
    assert derivative @ tangential == pytest.approx(0, abs=1e-12 * size)
    bound = 0.2 * -(trial @ normal)
    assert derivative @ across == pytest.approx(bound / size * across, abs=1e-12)
    assert derivative @ normal == pytest.approx(normal - 0.2 * tangential / size, abs=1e-12)


def residual_trial(contact, state):
    """The trial tractions lambda - c (gap vector and slip), from the table."""
    contact.form.Evaluate(vector(contact, state))
    t = contact.Table()
    return t["traction"] - 3.0 * (t["slip"] - t["gap"][:, None] * t["normal"])


# --- symmetry and conservation -----------------------------------------------------------------


@pytest.mark.parametrize("law", [{"friction": 1e6}, {"tresca": 1e6}, {"tied": True}])
def test_symmetric_where_everything_sticks_in_3d(mesh, law):
    contact = contact_form(mesh, **law)
    state = random_state(contact)
    dofs = contact.form.MultiplierDofs().reshape(-1, 3)
    state[dofs] -= 20 * contact.Table()["normal"]  # enough pressure to close all of them
    assert set(statuses(contact, state)) == {1}
    mat = matrix(contact, state)
    assert np.abs(mat - mat.T).max() <= 1e-15 * np.abs(mat).max()


def test_symmetric_without_friction(mesh):
    """Up to the parts along the tangent, where the multiplier is simply zero."""
    contact = contact_form(mesh)
    state = mixed_state(contact, {0, 2})
    mat, table = matrix(contact, state), contact.Table()
    dofs = contact.form.MultiplierDofs().reshape(-1, 3)
    for m in np.flatnonzero(table["status"] == 2):
        n = table["normal"][m]
        assert n @ mat[dofs[m]] == pytest.approx(mat[:, dofs[m]] @ n, abs=1e-15)


def test_force_is_the_transposed_jump_in_3d(mesh):
    """Columns of the multipliers: minus (D - M) transposed, whatever the status."""
    contact = contact_form(mesh, friction=0.7)
    D, M = (op.ToDense().NumPy() for op in contact.Mortar())
    columns = matrix(contact, random_state(contact))[:, contact.form.MultiplierDofs()]
    first = contact.form.offset
    assert columns[first : first + D.shape[1]] == pytest.approx(-(D - M).T, abs=1e-15)


# --- graph, threads, verbs ---------------------------------------------------------------------


@pytest.mark.parametrize("law", ["frictionless", "coulomb", "tresca"])
@pytest.mark.parametrize("space", ["VectorH1", "H1(dim=3)"])
def test_graph_is_exact_in_3d(space, law):
    """Every stored entry is used in some state, and none is stored twice."""
    mesh = block_mesh(n_slave=5, n_master=3, overhang=-0.5)  # some macro-elements are unpaired
    contact = contact_form(mesh, space, **LAWS[law])
    rows, columns, _ = (np.array(a) for a in contact.mat.COO())
    assert len(set(zip(rows.tolist(), columns.tolist(), strict=True))) == len(rows)
    used = np.zeros(len(rows), dtype=bool)
    for seed in range(20):
        contact.AssembleLinearization(vector(contact, random_state(contact, seed)))
        used |= np.array(contact.mat.COO()[2]) != 0
    dofs = contact.form.MultiplierDofs().reshape(-1, 3)
    unpaired = dofs[contact.Table()["area"] == 0]
    alone = np.isin(rows, unpaired)
    assert len(unpaired) > 0
    assert alone.sum() == 9 * len(unpaired)
    assert np.all(used[~alone])


def test_macros_couple_with_displacements_only_in_3d(mesh):
    """No entries between displacements, none between different macro-elements."""
    contact = contact_form(mesh, friction=0.5)
    rows, columns, _ = (np.array(a) for a in contact.mat.COO())
    dofs = contact.form.MultiplierDofs()
    macro = np.full(contact.nscalars, -1)
    macro[dofs] = np.arange(len(dofs)) // 3
    assert np.all((macro[rows] >= 0) | (macro[columns] >= 0))
    both = (macro[rows] >= 0) & (macro[columns] >= 0)
    assert np.array_equal(macro[rows][both], macro[columns][both])


@pytest.mark.parametrize("law", ["coulomb of place"])
def test_threads_change_nothing_but_rounding_in_3d(mesh, law):
    contact = contact_form(mesh, **LAWS[law])
    state = random_state(contact, 7)
    alone, linear = residual(contact, state), matrix(contact, state)
    with TaskManager():
        threaded = residual(contact, state)
        again = matrix(contact, state)
    assert np.abs(threaded - alone).max() <= 1e-14 * np.abs(alone).max()
    assert np.array_equal(again, linear)


def test_apply_adds_or_replaces_in_3d(mesh):
    contact = contact_form(mesh, friction=0.5)
    state = random_state(contact)
    expected = residual(contact, state)
    x, y = vector(contact, state), vector(contact, 1.0)
    contact.AddApply(x, y)
    assert y.FV().NumPy() == pytest.approx(expected + 1, abs=1e-13)
    contact.Apply(x, y)
    assert y.FV().NumPy() == pytest.approx(expected, abs=1e-14)


def test_a_parameter_acts_at_once_in_3d(mesh):
    coefficient = Parameter(0.0)
    contact = contact_form(mesh, friction=coefficient)
    state = random_state(contact)
    for value in (0.0, 0.4, 5.0):
        coefficient.Set(value)
        fixed = contact_form(mesh, friction=value)
        assert residual(contact, state) == pytest.approx(residual(fixed, state), abs=1e-14)


def test_the_form_does_not_see_the_frame():
    """Turned meshes and turned states: turned residuals, equal statuses."""
    results = []
    for rotation in (None, ROTATION):
        contact = contact_form(block_mesh(rotation=rotation), friction=0.7)
        R = RotationMatrix(rotation)
        dofs = contact.form.MultiplierDofs()
        V = contact.form.component
        first, count = contact.form.offset, V.ndof // 3
        state = random_state(contact)
        state[dofs] = (state[dofs].reshape(-1, 3) @ R.T).ravel()
        shape = state[first : first + V.ndof].reshape(3, count)
        state[first : first + V.ndof] = (R @ shape).ravel()
        rows = residual(contact, state)
        turned = rows.copy()
        turned[dofs] = (rows[dofs].reshape(-1, 3) @ R).ravel()
        turned[first : first + V.ndof] = (
            R.T @ rows[first : first + V.ndof].reshape(3, count)
        ).ravel()
        results.append((turned, statuses(contact, state)))
    assert np.array_equal(results[0][1], results[1][1])
    assert results[1][0] == pytest.approx(results[0][0], abs=1e-13)
