"""Finite sliding does not depend on where the bodies are and how they are turned."""

import numpy as np
import pytest
from blocks import contact_form, macro_dofs
from finitepress import Led, blocks2d, blocks3d
from form import Form, rotation
from ngsolve import IfPos, x

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
    "bilateral": lambda: Led(blocks2d(0.15), lead2d, bilateral=True, **FRICTION),
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


@pytest.mark.parametrize("degrees", [10, 90, 137, 310])
def test_a_stressed_pair_may_be_moved(stressed, degrees):
    """Positions R (X + u) + c and tractions R lam: forces turn, and nothing else changes."""
    stressed.contact.Follow(stressed.gf)
    before, forces = stressed.table(), stressed.residuals(stressed.gf)
    assert set(before["status"]) == {0, 1, 2} - ({0} if stressed.contact.bilateral else set())
    moved, R = stressed.moved(degrees, (3, -2, 1)[: stressed.dim])
    stressed.contact.Follow(moved)
    after, turned = stressed.table(moved), stressed.residuals(moved)

    size = before["pressure"].max()
    assert np.abs(before["slip"][before["status"] == 2]).max() > 5e-3
    assert np.array_equal(after["status"], before["status"])
    for name, scale in (("pressure", size), ("gap", 1), ("area", 1)):
        assert after[name] == pytest.approx(before[name], abs=TOL * scale)
    for name, scale in (("traction", size), ("normal", 1), ("slip", 1)):
        assert after[name] == pytest.approx(before[name] @ R.T, abs=TOL * scale)

    dofs, n = macro_dofs(stressed.contact), stressed.reference.size
    for old, new in zip(forces, turned, strict=True):
        old[:n] = (R @ old[:n].reshape(stressed.dim, -1)).ravel()
        old[dofs] = old[dofs] @ R.T
        assert new == pytest.approx(old, abs=TOL * size)
        assert np.abs(new[stressed.solver.linear.free]).max() > 0


TURNS = {
    2: (lambda: blocks2d(0.2), lambda t: (0.02 * t, t * (-0.05 + 0.06 * x)), 2, 360, 8),
    3: (
        lambda: blocks3d("hex", "prism", n=(4, 3)),
        lambda t: (0.02 * t, 0.01 * t, t * (-0.05 + 0.06 * x)),
        1,
        90,
        3,
    ),
}


@pytest.mark.parametrize("dim", TURNS)
def test_turned_in_large_steps(dim):
    """What sticks keeps sticking, and tractions turn with the bodies: about full circle in 2D.

    Led to their place by load 1, then turned as a whole by load 2.
    """
    make, lead, order, degrees, steps = TURNS[dim]
    problem = Led(make(), lambda load: lead(min(load, 1)), friction=0.6, order=order,
                  turn=lambda load: degrees * max(load - 1, 0))  # fmt: skip
    problem.run(1, tol=1e-12)
    before, tables = problem.table(), []
    problem.run(2, steps=steps, tol=1e-12, callback=lambda _: tables.append(problem.table()))
    assert len(tables) >= steps
    size = before["pressure"].max()
    for now in tables:
        assert np.abs(now["slip"]).max() <= TOL
        assert np.abs(now["pressure"] - before["pressure"]).max() <= TOL * size
    turned = before["traction"] @ rotation(dim, degrees).T
    assert np.abs(now["traction"] - turned).max() <= TOL * size
    assert np.abs(now["gap"] - before["gap"]).max() <= TOL


def unstrained(dim):
    mesh = blocks2d(0.34) if dim == 2 else blocks3d("hex", "tet", n=(2, 3))
    return Form(contact_form(mesh, finite=True, friction=0.5))


@pytest.mark.parametrize("degrees", [30, 90, 200])
@pytest.mark.parametrize("dim", [2, 3])
def test_slip_across_a_gap(dim, degrees):
    """A rotation of both bodies is no slip although their surfaces are apart."""
    pair, up = unstrained(dim), np.eye(dim)[-1]
    aside = np.eye(dim)[0] + 0.3 * np.eye(dim)[-2] * (dim - 2)
    pair.lead(0.2 * up)
    pair.contact.Commit(pair.gf)
    for height, way in ((0.2, 0.0), (0.15, 0.05)):
        R = pair.lead(height * up + way * aside, degrees)
        table = pair.table()
        assert table["gap"] == pytest.approx(height, abs=1e-14)
        slip = np.tile(R @ (way * aside), (len(table["gap"]), 1))
        assert table["slip"] == pytest.approx(slip, abs=1e-14)


@pytest.mark.parametrize("degrees", [0, 40, 90])
def test_slip_before_the_touch(degrees):
    """What an approaching macro-element moves until it touches turns with the bodies, too."""
    pair = unstrained(2)
    for shift in [(0, 0.1), (0.03, 0.05)]:  # on its way to touch at (0.06, 0)
        pair.lead(shift)
        pair.contact.Commit(pair.gf)
    R = pair.lead((0.05, 0.01), degrees)
    slip = pair.table()["slip"] @ R
    assert slip == pytest.approx(np.tile((-0.01, 0.0), (len(slip), 1)), abs=1e-12)
