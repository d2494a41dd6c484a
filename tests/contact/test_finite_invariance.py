"""Finite sliding does not depend on where the bodies are and how they are turned."""

import numpy as np
import pytest
from finiteform import POSITIONS, rotation
from finitepress import Led, blocks2d, blocks3d
from ngsolve import CF, IfPos, x

TOL = 1e-10
FRICTION = {"friction": IfPos(x - 0.4, 0.1, 2.0)}


def lead2d(t):
    return 0.1 * t, t * (-0.08 + 0.12 * x)


def lead3d(t):
    return 0.06 * t, 0.03 * t, t * (-0.08 + 0.12 * x)


CASES = {
    "order 1": lambda: Led(blocks2d(0.1), lead2d, order=1, **FRICTION),
    "order 2": lambda: Led(blocks2d(0.15), lead2d, **FRICTION),
    "quads, order 3": lambda: Led(blocks2d(0.2, quads=True), lead2d, order=3, **FRICTION),
    "tresca": lambda: Led(blocks2d(0.15), lead2d, tresca=4 * FRICTION["friction"]),
    "hex on tet": lambda: Led(blocks3d("hex", "tet"), lead3d, **FRICTION),
    "prism on hex": lambda: Led(blocks3d("prism", "hex", n=(6, 5)), lead3d, order=1, **FRICTION),
}


@pytest.fixture(scope="module", params=CASES)
def stressed(request):
    """Two steps, of which the second is not committed: some of the pair slipped in it."""
    problem = CASES[request.param]()
    problem.run(0.5, tol=1e-12)
    problem.solve(1.0, tol=1e-12)
    return problem


@pytest.mark.parametrize("degrees", [10, 90, 137, 180, 310])
def test_a_stressed_pair_may_be_moved(stressed, degrees):
    """Positions R (X + u) + c and tractions R lam: forces turn, and nothing else changes."""
    stressed.contact.Follow(stressed.gf)
    before, forces = stressed.table(), stressed.residuals(stressed.gf)
    assert set(before["status"]) == {0, 1, 2}
    moved, R = stressed.moved(degrees, (3, -2, 1)[: stressed.dim])
    stressed.contact.Follow(moved)
    after, turned = stressed.table(moved), stressed.residuals(moved)

    size = before["pressure"].max()
    assert after["pressure"] == pytest.approx(before["pressure"], abs=TOL * size)
    for name in ("gap", "area"):
        assert after[name] == pytest.approx(before[name], abs=TOL)
    for name in ("normal", "slip"):
        assert after[name] == pytest.approx(before[name] @ R.T, abs=TOL)
    assert np.abs(before["slip"][before["status"] == 2]).max() > 5e-3
    assert after["traction"] == pytest.approx(before["traction"] @ R.T, abs=TOL * size)
    assert np.array_equal(after["status"], before["status"])

    dofs = stressed.contact.form.MultiplierDofs().reshape(-1, stressed.dim)
    n = stressed.reference.size
    for old, new in zip(forces, turned, strict=True):
        expected = old.copy()
        expected[:n] = (R @ old[:n].reshape(stressed.dim, -1)).ravel()
        expected[dofs] = old[dofs] @ R.T
        assert new == pytest.approx(expected, abs=TOL * size)
        assert np.abs(new[stressed.solver.linear.free]).max() > 0


def turning(mesh, lead, degrees, **law):
    """Led to its place by load 1, then turned as a whole by load 2."""

    def turn(load):
        return degrees * max(load - 1, 0)

    return Led(mesh, lambda load: lead(min(load, 1)), turn=turn, **law)


TURNS = {
    "2D": (lambda: blocks2d(0.2), lambda t: (0.02 * t, t * (-0.05 + 0.06 * x)), 360, 8),
    "3D": (
        lambda: blocks3d("hex", "prism", n=(4, 3)),
        lambda t: (0.02 * t, 0.01 * t, t * (-0.05 + 0.06 * x)),
        90,
        3,
    ),
}


@pytest.mark.parametrize("case", TURNS)
def test_turned_in_large_steps(case):
    """What sticks keeps sticking, and tractions turn with the bodies: about full circle in 2D."""
    make, lead, degrees, steps = TURNS[case]
    problem = turning(make(), lead, degrees, friction=0.6, order=2 if case == "2D" else 1)
    problem.run(1, tol=1e-12)
    before = problem.table()
    size, pressures = before["pressure"].max(), []

    def watch(_):
        now = problem.table()
        pressures.append(now["pressure"])
        assert np.abs(now["slip"]).max() <= TOL

    problem.run(2, steps=steps, tol=1e-12, callback=watch)
    assert len(pressures) >= steps
    for pressure in pressures:
        assert np.abs(pressure - before["pressure"]).max() <= TOL * size
    after = problem.table()
    turned = before["traction"] @ rotation(problem.dim, degrees).T
    assert np.abs(after["traction"] - turned).max() <= TOL * size
    assert np.abs(after["gap"] - before["gap"]).max() <= TOL


def placed(problem, degrees, shift):
    """Bodies without strain: the upper one shifted, then both rotated; returns the rotation."""
    R = rotation(problem.dim, degrees)
    r, matrix = CF(POSITIONS[: problem.dim]), CF(tuple(R.ravel()), dims=R.shape)
    places = {"upper": matrix * (r + CF(tuple(shift))) - r, "lower": matrix * r - r}
    problem.gf.components[0].Set(problem.mesh.MaterialCF(places))
    problem.contact.Follow(problem.gf)
    return R


@pytest.mark.parametrize("degrees", [30, 90, 200])
@pytest.mark.parametrize("dim", [2, 3])
def test_slip_across_a_gap(dim, degrees):
    """A rotation of both bodies is no slip although their surfaces are apart."""
    mesh = blocks2d(0.34) if dim == 2 else blocks3d("hex", "tet", n=(2, 3))
    problem = Led(mesh, None, friction=0.5)
    up, aside = np.eye(dim)[-1], np.eye(dim)[0] + 0.3 * np.eye(dim)[-2] * (dim - 2)
    problem.contact.Update()
    problem.contact.form.SetConstant(1.0)
    placed(problem, 0, 0.2 * up)
    problem.contact.Commit(problem.gf)
    placed(problem, degrees, 0.2 * up)
    table = problem.table()
    assert np.abs(table["slip"]).max() <= 1e-14
    assert table["gap"] == pytest.approx(0.2, abs=1e-14)
    R = placed(problem, degrees, 0.15 * up + 0.05 * aside)
    table = problem.table()
    assert table["slip"] == pytest.approx(np.tile(R @ (0.05 * aside), (len(table["gap"]), 1)))
    assert table["gap"] == pytest.approx(0.15)


@pytest.mark.parametrize("degrees", [40, 90])
def test_slip_before_the_touch(degrees):
    """What an approaching macro-element moves until it touches turns with the bodies, too."""
    problem = Led(blocks2d(0.34), None, friction=0.5)
    problem.contact.Update()
    problem.contact.form.SetConstant(1.0)
    for shift in [(0, 0.1), (0.03, 0.05)]:  # on its way to touch at (0.06, 0)
        placed(problem, 0, shift)
        problem.contact.Commit(problem.gf)
    for angle in (0, degrees):
        R = placed(problem, angle, (0.05, 0.01))
        slip = problem.table()["slip"] @ R
        assert slip == pytest.approx(np.tile((-0.01, 0.0), (len(slip), 1)), abs=1e-12)
