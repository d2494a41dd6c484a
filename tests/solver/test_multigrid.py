"""Multigrid: as many iterations on any mesh, setups that serve again, parts of the hierarchy."""

import numpy as np
import pytest
from ngsolve import BitArray
from press import numpy, press3d, solved
from pyamg.relaxation.relaxation import block_gauss_seidel
from scipy.sparse import bsr_matrix, eye_array
from test_linear import FIRST

from ngslac.linear.chain import FACTORED, LARGE
from ngslac.linear.hierarchy import (
    COARSEST,
    Hierarchy,
    Inverses,
    Prolongation,
    Rows,
    Triangles,
    VCycle,
)
from ngslac.linear.vertices import VertexNodes
from ngslac.rigid import MotionsAt


def iterations(**given):
    """Krylov iterations of each linear system."""
    problem = press3d(**(FIRST | given))
    solver = solved(problem, solver="iterative")
    return solver.linear.krylov / (len(solver.history) - 1)


@pytest.mark.full
def test_iterations_do_not_grow_with_the_mesh():
    """Eight times the dofs each time, and one level more."""
    sizes = {(5, 4): (4, 4), (10, 9): (8, 8), (20, 17): (14, 14)}
    given = {"kinds": ("hex", "hex")}
    counts = [iterations(n=n, mesh_flags={"layers": k}, **given) for n, k in sizes.items()]
    assert counts[2] < 1.2 * max(counts[:2])


def test_a_setup_serves_again():
    problem = press3d(**FIRST)
    solver = problem.solver(solver="iterative")
    multigrid, learnt = solver.linear._links[0].method.multigrid, []
    make = multigrid.Preconditioner

    def Preconditioner(*given):
        result = make(*given)
        learnt.append(multigrid.learnt)
        return result

    multigrid.Preconditioner = Preconditioner
    solver.Solve(printing=False)
    assert learnt[0]
    assert 1 <= sum(learnt) < len(learnt)
    multigrid._best, multigrid._hierarchy = 10, multigrid._hierarchy or object()
    multigrid.Watch(14)
    assert multigrid._hierarchy is not None
    multigrid.Watch(16)  # more than half as many again
    assert multigrid._hierarchy is None


# --- the hierarchy of a lattice of springs --------------------------------------------------------


def lattice(n, seed=0):
    """A block of n^3 nodes that springs join, held at the bottom: matrix, points, free dofs."""
    rng = np.random.default_rng(seed)
    index = np.arange(n**3).reshape(n, n, n)
    points = np.stack(np.unravel_index(index.ravel(), index.shape), axis=1).astype(float)
    ends = [(index[:-1], index[1:]), (index[:, :-1], index[:, 1:])]
    ends += [(index[..., :-1], index[..., 1:]), (index[:-1, :-1], index[1:, 1:])]
    ends += [(index[:-1, :, :-1], index[1:, :, 1:]), (index[:, :-1, :-1], index[:, 1:, 1:])]
    ends += [(index[1:, :-1], index[:-1, 1:]), (index[1:, :, :-1], index[:-1, :, 1:])]
    one, two = (np.concatenate([pair[k].ravel() for pair in ends]) for k in (0, 1))
    along = points[two] - points[one]
    along /= np.linalg.norm(along, axis=1)[:, None]
    blocks = rng.uniform(1, 2, len(one))[:, None, None] * along[:, :, None] * along[:, None, :]
    rows, columns = np.concatenate([one, two, one, two]), np.concatenate([one, two, two, one])
    entries = np.concatenate([blocks, blocks, -blocks, -blocks])
    places = np.broadcast_to(3 * rows[:, None, None] + np.arange(3)[:, None], entries.shape)
    others = np.broadcast_to(3 * columns[:, None, None] + np.arange(3), entries.shape)
    whole = (entries.ravel(), (places.ravel(), others.ravel()))
    free = np.repeat(points[:, 2] > 0, 3)
    mat = bsr_matrix(whole, shape=(3 * n**3,) * 2, blocksize=(3, 3)).toarray()
    mat[~free] = mat[:, ~free] = 0
    mat[~free, ~free] = 1
    return bsr_matrix(mat, blocksize=(3, 3)), points, free


def modes(points, free):
    return MotionsAt(points).reshape(-1, 6) * free[:, None]


@pytest.fixture(scope="module")
def block():
    mat, points, free = lattice(9)
    return mat, modes(points, free), Hierarchy(mat, modes(points, free))


def test_matrices_of_a_changed_matrix(block):
    """Only its changed rows are multiplied, which gives the product all the same."""
    mat, _, hierarchy = block
    assert mat.shape[0] > COARSEST
    assert len(hierarchy.prolongations) >= 1
    P = hierarchy.prolongations[0].toarray()
    other = mat.copy()
    changed = slice(other.indptr[40], other.indptr[44])
    other.data[changed] *= 1 + np.random.default_rng(1).random(other.data[changed].shape)
    for given in (mat, other, mat):
        expected, found = P.T @ given.toarray() @ P, hierarchy.Matrices(given)[1].toarray()
        filled = np.diag(expected) == 0
        expected[filled, filled] = 1
        assert found == pytest.approx(expected, abs=1e-12 * np.abs(expected).max())


def test_rows_of_blocks(block):
    mat, *_ = block
    rows = np.array([3, 0, 17])
    expected = mat.toarray().reshape(-1, 3, mat.shape[1])[rows].reshape(9, -1)
    assert np.array_equal(Rows(mat, rows).toarray(), expected)


def test_a_sweep_from_zero_leaves_the_upper_triangle(block):
    mat, *_ = block
    lower, upper = Triangles(mat)
    assert np.array_equal((lower + upper).toarray(), mat.toarray())
    rhs = np.random.default_rng(3).standard_normal(mat.shape[0])
    x, expected = np.zeros_like(rhs), np.zeros_like(rhs)
    options = {"blocksize": 3, "Dinv": Inverses(mat), "sweep": "forward"}
    block_gauss_seidel(lower, x, rhs, **options)
    block_gauss_seidel(mat, expected, rhs, **options)
    assert np.array_equal(x, expected)
    assert -(upper @ x) == pytest.approx(rhs - mat @ x, abs=1e-13 * np.abs(rhs).max())


def test_cycle_is_symmetric_and_converges(block):
    mat, _, hierarchy = block
    cycle = VCycle(
        hierarchy.prolongations, hierarchy.Matrices(mat), eye_array(mat.shape[0], format="csr")
    )
    x, y, image = (cycle.CreateRowVector() for _ in range(3))
    for seed, vec in enumerate((x, y)):
        vec.FV().NumPy()[:] = np.random.default_rng(seed).standard_normal(mat.shape[0])
    image.data = cycle * y
    product = x.InnerProduct(image)
    image.data = cycle * x
    assert y.InnerProduct(image) == pytest.approx(product, abs=1e-10 * x.Norm() * image.Norm())
    left = numpy(x)
    sizes = []
    for _ in range(12):
        x.FV().NumPy()[:] = left
        image.data = cycle * x
        left = left - mat @ numpy(image)
        sizes.append(np.linalg.norm(left))
    assert sizes[-1] < 0.7**8 * sizes[3]


@pytest.mark.parametrize(("turn", "factor", "shift"), [(0.7, 1.0, 0.0), (0.0, 1e3, 1e3)])
def test_rigid_motions_are_kept_by_each_level(block, turn, factor, shift):
    """In any position and unit, but where nodes are held."""
    mat, points, free = lattice(9)
    Q = np.array([[np.cos(turn), -np.sin(turn), 0], [np.sin(turn), np.cos(turn), 0], [0, 0, 1]])
    blocks = Q @ mat.data @ Q.T
    turned = bsr_matrix((blocks, mat.indices, mat.indptr), shape=mat.shape)
    given = modes(factor * points @ Q.T + shift, free)
    levels = Hierarchy(turned, given).Matrices(turned)
    assert [m.shape for m in levels] == [m.shape for m in block[2].Matrices(mat)]
    prolongation, coarse = Prolongation(turned, given)
    inner = np.repeat(points[:, 2] > 1, 3)
    image = (prolongation @ coarse)[inner]
    assert image == pytest.approx(given[inner], abs=1e-10 * np.abs(given).max())


def test_chosen_by_itself_also_for_first_order(monkeypatch):
    monkeypatch.setitem(FACTORED, 3, 0)
    monkeypatch.setitem(LARGE["ngsolve"], 3, 100)
    assert press3d(**FIRST).solver().linear.method == "iterative"
    monkeypatch.setitem(LARGE["ngsolve"], 3, 10_000)
    assert press3d(**FIRST).solver(inverse="umfpack").linear.method == "direct"
    monkeypatch.setitem(FACTORED, 3, 10_000)
    assert press3d(**FIRST).solver().linear.method == "interface"


def test_nodes_without_free_dofs_are_left_out():
    form = press3d(**FIRST).contact.form
    free = BitArray(form.fes.ndof)
    free.Clear()
    assert VertexNodes.Of(form.component, free, form.offset).count == 0
    free.Set(form.offset + 7)
    nodes = VertexNodes.Of(form.component, free, form.offset)
    assert (nodes.dofs.shape, nodes.dofs[nodes.free]) == ((1, 3), [form.offset + 7])
    scale = np.full(form.fes.ndof, 0.5)
    assert np.linalg.norm(nodes.Modes(scale)[:, :3]) == pytest.approx(2)
