"""What macro-elements add to the bulk: against dense formulas, and taken over by sweeps."""

import numpy as np
import pytest
from ngsolve import GetNumThreads, IdentityMatrix, SetNumThreads, TaskManager
from press import mixed_press, mixed_press3d, numpy, press3d
from test_condensed import dense, random_vectors, system
from test_linear import made

from ngslac._ngslac import Condensation, MergeMatrices, StarSweeps, TwoLevel
from ngslac.arrays import AsNumPy
from ngslac.linear.multigrid import Blocks

PENALTY = 3
SMALL = ["2D stick", "2D tied", "2D frictionless", "2D mixed", "3D stick", "3D slip", "3D mixed"]


def blocks(given, counts):
    """K without multipliers, its local terms ``-G F^+ E``, and E2, G2 of each macro-element."""
    mat, multipliers, dim, free = given
    values, inner = dense(mat), AsNumPy(free).copy()
    inner[multipliers] = False
    inner = np.flatnonzero(inner)
    slip, rows = np.zeros((len(inner),) * 2), []
    for lam, count in zip(np.reshape(multipliers, (-1, dim)), counts, strict=True):
        E, G, F = values[np.ix_(lam, inner)], values[np.ix_(inner, lam)], values[np.ix_(lam, lam)]
        left, sizes, right = np.linalg.svd(F)
        told = dim - count
        slip -= G @ right[:told].T @ np.diag(1 / sizes[:told]) @ left[:, :told].T @ E
        rows.append((left[:, told:].T @ E, G @ right[told:].T))
    return values[np.ix_(inner, inner)] + slip, rows, inner


def onto(columns):
    """Orthogonal projection on what columns span."""
    return columns @ np.linalg.solve(columns.T @ columns, columns.T)


@pytest.mark.parametrize("case", SMALL)
def test_product_is_that_of_the_formula(case):
    """``A = (1 - Pi_G) (K - G F^+ E) (1 - Pi_E)`` with projections on all reactions at once."""
    given, _ = system(made(case))
    condensed = Condensation(*given)
    mat, rows, inner = blocks(given, condensed.constraints)
    E2, G2 = np.vstack([e for e, _ in rows]), np.hstack([g for _, g in rows])
    unit = np.eye(len(inner))
    A = (unit - onto(G2)) @ mat @ (unit - onto(E2.T))
    for x in random_vectors(condensed, 3):
        image, z = numpy((condensed * x).Evaluate()), numpy(x)
        assert np.abs(image[inner] - A @ z[inner]).max() < 1e-10 * np.abs(image).max()
        assert not np.any(np.delete(image, inner))


@pytest.mark.parametrize("case", SMALL)
def test_rows_are_those_of_the_formula(case):
    """``K - G F^+ E + 3 sum Pi_G Pi_E`` with projections macro-element by macro-element."""
    given, _ = system(made(case))
    condensed = Condensation(*given)
    mat, rows, inner = blocks(given, condensed.constraints)
    expected = mat + PENALTY * sum(onto(G2) @ onto(E2.T) for E2, G2 in rows if len(E2))
    found = dense(condensed.Part(np.flatnonzero(AsNumPy(condensed.freedofs))))
    assert np.abs(found - expected).max() <= 1e-11 * np.abs(expected).max()  # of two million
    assert condensed.diagonal[inner] == pytest.approx(np.diag(expected), abs=1e-11)


@pytest.mark.parametrize("case", ["2D mixed", "3D mixed"])
def test_blocks_of_nodes_are_a_part_of_the_rows(case):
    given, _ = system(made(case))
    condensed, width = Condensation(*given), given[2]
    nodes = np.flatnonzero(AsNumPy(condensed.freedofs))[: 40 * width].reshape(-1, width)[::-1]
    nodes[1, 0] = -1
    found = Blocks(condensed, nodes)
    whole = dense(condensed.Part(np.arange(condensed.height)))
    expected = whole[np.ix_(nodes.ravel(), nodes.ravel())]
    expected[width], expected[:, width], expected[width, width] = 0, 0, 1
    assert found.blocksize == (width, width)
    assert found.has_sorted_indices
    assert found.toarray() == pytest.approx(expected, abs=1e-12 * np.abs(expected).max())
    wanted = np.arange(len(nodes)) % 3 == 0
    some = Blocks(condensed, nodes, wanted).toarray()
    assert np.array_equal(some, found.toarray() * np.repeat(wanted, width)[:, None])


@pytest.mark.parametrize("case", SMALL)
def test_rows_that_macro_elements_add_to_are_known(case):
    arguments, _ = system(made(case))
    condensed = Condensation(*arguments)
    others = np.setdiff1d(np.arange(condensed.height), arguments[1])
    differs = np.any(
        dense(condensed.Part(others)) != dense(arguments[0])[np.ix_(others, others)], 1
    )
    assert np.any(differs)
    assert np.all(condensed.changed[others][differs])
    assert not np.all(condensed.changed)


# --- sweeps --------------------------------------------------------------------------------------


def systems(make, **flags):
    """Condensations of all Newton steps of a problem, and its space."""
    problem = make(**flags)
    solver, seen = problem.solver(solver="direct"), []
    solve = solver.linear.Solve

    def Solve(system):
        seen.append(MergeMatrices(system.mat, system.contacts, system.scale))
        return solve(system)

    solver.linear.Solve = Solve
    solver.Solve(printing=False)
    fes = problem.contact.form.fes
    given = problem.contact.form.MultiplierDofs().tolist(), problem.mesh.dim, solver.linear.bits
    return [Condensation(mat, *given) for mat in seen], fes


def sweeps(condensed, fes):
    """By stars of vertices."""
    stars = fes.CreateSmoothingBlocks(blocktype=["vertexedge"])
    return StarSweeps(condensed, condensed.freedofs, stars, fes.dim)


def applied(condensed, star_sweeps):
    """To a random vector, forward and backward, with nothing in between."""
    (x,) = random_vectors(condensed, 1)
    inverse = TwoLevel(condensed, star_sweeps, IdentityMatrix(0), [])
    return numpy((inverse * x).Evaluate()).copy()


STEPS = {
    "2D": (mixed_press, {}),
    "2D large": (mixed_press, {"finite": True}),
    "3D": (mixed_press3d, {"kinds": ("tet", "tet")}),
    "3D slip": (press3d, {"friction": 0.1}),
}


@pytest.mark.parametrize("case", STEPS)
def test_sweeps_taken_over(case):
    """As sweeps made anew, bit for bit, there and back again; those of another step differ."""
    make, flags = STEPS[case]
    (first, *_, last), fes = systems(make, **flags)
    updated = sweeps(first, fes)
    images = [applied(first, updated)]
    for condensed in (first, last, first):
        updated.Update(condensed)
        images.append(applied(condensed, updated))
    assert np.array_equal(images[0], images[1])
    assert np.array_equal(images[0], images[3])
    assert not np.array_equal(images[0], images[2])
    if case != "2D large":  # where the graph is another, and with it the order of the nodes
        assert np.array_equal(images[2], applied(last, sweeps(last, fes)))


@pytest.mark.parametrize("case", STEPS)
def test_sweeps_in_any_number_of_threads(case):
    """Stars that share a macro-element wait for each other."""
    make, flags = STEPS[case]
    found, fes = systems(make, **flags)
    before, images = GetNumThreads(), []
    try:
        for threads in (1, 3):
            SetNumThreads(threads)
            with TaskManager():
                own = sweeps(found[0], fes)
                own.Update(found[-1])
                images.append(applied(found[-1], own))
    finally:
        SetNumThreads(before)
    assert np.array_equal(*images)
