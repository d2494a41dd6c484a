"""The contact form: its graph, its symmetry, its frame, its threads."""

import numpy as np
import pytest
from blocks import (
    C,
    block_mesh,
    contact_form,
    macro_dofs,
    matrix,
    mixed_state,
    random_state,
    residual,
    statuses,
    vector,
)
from form import rotation
from ngsolve import CF, Parameter, SetNumThreads, TaskManager, x

STICK = [{"friction": 1e6}, {"tresca": 1e6}, {"tied": True}]


@pytest.fixture(scope="module", params=[2, 3])
def mesh(request):
    return block_mesh(request.param)


def test_slip_turns_in_the_tangential_plane():
    """What is new in 3D: the slip direction has a derivative of its own."""
    contact = contact_form(block_mesh(3), friction=0.2)
    state = mixed_state(contact, {0, 2})
    table, dofs = contact.Table(), macro_dofs(contact)
    m = np.flatnonzero(table["status"] == 2)[0]
    block = matrix(contact, state)[np.ix_(dofs[m], dofs[m])]
    normal, gap = table["normal"][m], table["gap"][m]
    derivative = np.eye(3) + block * C / table["area"][m]  # of the projection, by the trial
    trial = table["traction"][m] - C * (table["slip"][m] - gap * normal)
    tangential = trial - trial @ normal * normal
    size = np.linalg.norm(tangential)
    across, bound = np.cross(normal, tangential / size), 0.2 * -(trial @ normal)
    assert derivative @ tangential == pytest.approx(0, abs=1e-12 * size)
    assert derivative @ across == pytest.approx(bound / size * across, abs=1e-12)
    assert derivative @ normal == pytest.approx(normal - 0.2 * tangential / size, abs=1e-12)


@pytest.mark.parametrize("law", STICK)
def test_symmetric_where_everything_sticks(mesh, law):
    """Sticking rows are the transposed columns: force and constraint use one operator."""
    contact = contact_form(mesh, **law)
    state, table = random_state(contact), contact.Table()
    state[macro_dofs(contact)] -= 20 * table["normal"]  # enough pressure to close all of them
    assert set(statuses(contact, state)[table["area"] > 0]) == {1}
    mat = matrix(contact, state)
    assert np.abs(mat - mat.T).max() <= 1e-15 * np.abs(mat).max()


def test_symmetric_without_friction(mesh):
    """Up to the parts along the tangent, where the multiplier is simply zero."""
    contact = contact_form(mesh)
    state = mixed_state(contact, {0, 2})
    mat, table, dofs = matrix(contact, state), contact.Table(), macro_dofs(contact)
    for m in np.flatnonzero(table["status"] == 2):
        n = table["normal"][m]
        assert n @ mat[dofs[m]] == pytest.approx(mat[:, dofs[m]] @ n, abs=1e-15)


def test_force_is_the_transposed_jump(mesh):
    """Columns of the multipliers: minus (D - M) transposed, whatever the status."""
    contact = contact_form(mesh, friction=0.7)
    D, M = (op.ToDense().NumPy() for op in contact.Mortar())
    columns = matrix(contact, random_state(contact))[:, contact.form.MultiplierDofs()]
    assert columns[: D.shape[1]] == pytest.approx(-(D - M).T, abs=1e-15)


@pytest.mark.parametrize("law", [{}, {"friction": 0.7}, {"tresca": 0.8}])
@pytest.mark.parametrize(
    ("dim", "space"),
    [(2, "order 1"), (2, "order 2"), (2, "H1(dim)"), (3, "order 2"), (3, "H1(dim)")],
)
def test_graph_is_exact(dim, space, law):
    """Every stored entry is used in some state, none is stored twice, none is between two macros.

    A macro-element without a partner has nothing but its diagonal block.
    """
    sizes = {"overhang": -0.5} if dim == 3 else {}
    mesh = block_mesh(dim, *(("hex", "tet", 5, 3) if dim == 3 else ()), **sizes)
    contact = contact_form(mesh, space, **law)
    contact.AssembleLinearization(vector(contact, random_state(contact)))
    rows, columns, _ = (np.array(a) for a in contact.mat.COO())
    assert len(set(zip(rows.tolist(), columns.tolist(), strict=True))) == len(rows)
    used = np.zeros(len(rows), dtype=bool)
    for seed in range(40):
        contact.AssembleLinearization(vector(contact, random_state(contact, seed)))
        used |= np.array(contact.mat.COO()[2]) != 0
    dofs, unpaired = macro_dofs(contact), contact.Table()["area"] == 0
    alone = np.isin(rows, dofs[unpaired])
    assert unpaired.any()
    assert alone.sum() == dim**2 * unpaired.sum()
    assert np.all(used[~alone])
    macro = np.full(contact.nscalars, -1)
    macro[dofs] = np.arange(len(dofs))[:, None]
    assert np.all((macro[rows] >= 0) | (macro[columns] >= 0))  # not between displacements
    both = (macro[rows] >= 0) & (macro[columns] >= 0)
    assert np.array_equal(macro[rows][both], macro[columns][both])


def test_apply_adds_or_replaces(mesh):
    contact = contact_form(mesh, friction=0.5)
    state = random_state(contact)
    expected = residual(contact, state)
    at, out = vector(contact, state), vector(contact, 1.0)
    contact.AddApply(at, out)
    assert out.FV().NumPy() == pytest.approx(expected + 1, abs=1e-13)
    contact.Apply(at, out)
    assert out.FV().NumPy() == pytest.approx(expected, abs=1e-14)


def test_a_parameter_acts_at_once(mesh):
    coefficient = Parameter(0.0)
    contact = contact_form(mesh, friction=coefficient)
    state = random_state(contact)
    for value in (0.0, 0.4, 5.0):
        coefficient.Set(value)
        fixed = contact_form(mesh, friction=value)
        assert residual(contact, state) == pytest.approx(residual(fixed, state), abs=1e-14)


FRAMES = {2: ({"angle": 0.0}, {"angle": 20.0}), 3: ({"rotation": None}, {})}


@pytest.mark.parametrize("dim", FRAMES)
def test_the_form_does_not_see_the_frame(dim):
    """Turned meshes and turned states: turned residuals, equal statuses."""
    results = []
    for flags, degrees in zip(FRAMES[dim], (0, {2: 20, 3: 37}[dim]), strict=True):
        contact = contact_form(block_mesh(dim, **flags), friction=0.7)
        R, dofs = rotation(dim, degrees, (1.0, 2.0, 0.5)), macro_dofs(contact)
        u = slice(contact.form.component.ndof)
        state = random_state(contact)
        state[dofs] = state[dofs] @ R.T
        state[u] = (R @ state[u].reshape(dim, -1)).ravel()
        rows = residual(contact, state)
        rows[dofs] = rows[dofs] @ R
        rows[u] = (R.T @ rows[u].reshape(dim, -1)).ravel()
        results.append((rows, statuses(contact, state)))
    assert np.array_equal(results[0][1], results[1][1])
    assert results[1][0] == pytest.approx(results[0][0], abs=1e-13)


def in_threads(n, f):
    SetNumThreads(n)
    with TaskManager():
        return f()


WEEKLY = [pytest.param(flags, marks=pytest.mark.full) for flags in ({}, {"obstacle": CF(0.1)})]


@pytest.mark.sample(1)
@pytest.mark.parametrize("flags", [{"finite": True}, *WEEKLY])
@pytest.mark.parametrize("dim", [2, 3])
def test_the_order_in_which_threads_arrive_leaves_no_trace(dim, flags):
    """To the last bit; where one master face has several macro-elements threads meet there."""
    mesh = block_mesh(dim, *((0.1, 0.4) if dim == 2 else ("hex", "tet", 3, 1)))

    def run():
        contact = contact_form(mesh, friction=0.3 + 0.01 * x, **flags)
        state = 0.01 * random_state(contact)
        contact.AssembleLinearization(vector(contact))  # makes the matrix
        at, forces = vector(contact, state), vector(contact)
        contact.AssembleLinearization(at)
        parts = [contact.mat.AsVector().FV().NumPy().tobytes()]
        contact.form.AssembleStep(at, forces)
        arrays = [contact.mat.AsVector().FV().NumPy(), contact.Table()["friction"]]
        arrays += [residual(contact, state), forces.FV().NumPy()]
        return parts + [array.tobytes() for array in arrays]

    try:
        results = [in_threads(n, run) for n in (1, 2, 4)]
    finally:
        SetNumThreads(1)
    assert results[0] == results[1] == results[2]
