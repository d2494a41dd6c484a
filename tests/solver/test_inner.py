"""Elimination of dofs inside of elements: exact, and as NGSolve's static condensation."""

import numpy as np
import pytest
from netgen.meshing import NgException
from ngsolve import CF, H1, L2, BilinearForm, Grad, InnerProduct, VectorH1, dx
from press import press3d, same, solved

from ngslac._ngslac import InnerElimination
from ngslac.arrays import AsBits, AsNumPy
from ngslac.errors import LinearSolveError
from ngslac.linear.inner import InnerDofs


def dense(mat):
    values, columns, starts = map(np.asarray, mat.CSR())
    result = np.zeros((mat.height, mat.width))
    rows = np.repeat(np.arange(mat.height), np.diff(starts.astype(int)))
    result[rows, columns] = values
    return result


@pytest.fixture(scope="module")
def bulk():
    mesh = press3d(n=(2, 1), kinds=("hex", "hex")).mesh
    space = VectorH1(mesh, order=2, dirichlet="bottom")
    u, v = space.TnT()
    skew = CF((1, 2, 0, 0, 1, 3, 0, 0, 1), dims=(3, 3))  # no symmetric matrix
    form = InnerProduct(Grad(u) * skew, Grad(v)) + InnerProduct(u, v)
    return space, BilinearForm(form * dx).Assemble().mat


def test_is_the_schur_complement(bulk):
    space, mat = bulk
    dofs = InnerDofs.Of(space, space.FreeDofs()).dofs
    inner, given, found = AsNumPy(dofs), dense(mat), InnerElimination(mat, dofs)
    assert inner.sum() == 3 * space.mesh.ne
    left = given[~inner][:, ~inner]
    left = left - given[~inner][:, inner] @ np.linalg.solve(
        given[inner][:, inner], given[inner][:, ~inner]
    )
    assert dense(found.mat)[~inner][:, ~inner] == pytest.approx(left, abs=1e-12)
    x = np.random.default_rng(0).standard_normal(len(inner))
    rhs = given @ x
    assert found.Reduce(rhs)[~inner] == pytest.approx(left @ x[~inner], abs=1e-11)
    assert found.Expand(rhs, np.where(inner, 7.0, x)) == pytest.approx(x, abs=1e-11)


def test_refusals(bulk):
    space, mat = bulk
    inner = AsNumPy(InnerDofs.Of(space, space.FreeDofs()).dofs)
    with pytest.raises(NgException, match="bits for a matrix"):
        InnerElimination(mat, AsBits(inner[1:]))
    dofs = InnerDofs.Of(space, space.FreeDofs()).dofs
    with pytest.raises(NgException, match="a vector has 3 entries"):
        InnerElimination(mat, dofs).Reduce(np.zeros(3))


def test_only_displacements_that_are_free(bulk):
    space, _ = bulk
    assert InnerDofs.Of(space, space.FreeDofs(True)) is None
    assert InnerDofs.Of(VectorH1(space.mesh, order=1), VectorH1(space.mesh).FreeDofs()) is None
    assert InnerDofs.Of(H1(space.mesh, order=2, dim=3), None) is None
    mixed = space * L2(space.mesh)
    dofs = InnerDofs.Of(mixed, mixed.FreeDofs(), 0, mixed.components[0]).dofs
    assert not AsNumPy(dofs)[space.ndof :].any()


@pytest.mark.parametrize("kind", ["hex", "prism"])
def test_as_the_direct_solver(kind):
    """Stars of vertices with edges, and of edges with faces."""
    given = {"order": 3, "n": (2, 1), "kinds": (kind, "hex"), "friction": 0.1}
    problem, reference = press3d(**given), press3d(**given)
    linear = solved(problem, solver="iterative").linear
    solved(reference, solver="direct")
    assert (linear.method, linear.factorisations) == ("iterative", 0)
    assert linear.inner.dofs.NumSet() > 0
    same(problem, reference, 1e-8)


def test_goes_on_where_inner_dofs_are_singular(monkeypatch):
    """Without elimination, for good, and as exact."""
    given = {"order": 2, "n": (2, 1), "kinds": ("hex", "hex"), "friction": 0.1}
    problem, reference = press3d(**given), press3d(**given)
    solver = problem.solver(solver="iterative")
    assert solver.linear.inner is not None

    def singular(self, bulk):
        raise LinearSolveError("singular")

    monkeypatch.setattr(InnerDofs, "Eliminate", singular)
    solver.Solve(printing=False)
    solved(reference, solver="direct")
    assert (solver.linear.method, solver.linear.inner) == ("iterative", None)
    same(problem, reference, 1e-8)
