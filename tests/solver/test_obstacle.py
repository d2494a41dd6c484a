"""A rigid obstacle in place of a master: Signorini's problem."""

import numpy as np
import pytest
from ngsolve import (
    BND,
    CF,
    BilinearForm,
    Grad,
    GridFunction,
    Id,
    InnerProduct,
    Integrate,
    Parameter,
    Sym,
    TaskManager,
    Trace,
    VectorH1,
    ds,
    dx,
    specialcf,
    x,
)
from ngsolve.meshes import MakeStructured2DMesh

from ngslac import BubbleVectorH1, ContactSolver, LACContact, LACSpace

MU, LAME = 40.0, 60.0


def stress(u):
    strain = Sym(Grad(u))
    return 2 * MU * strain + LAME * Trace(strain) * Id(2)


def block_on_obstacle(gap, *, order=2, traction=(0, -1.0), n=8, flags=None, space=None, **law):
    """The unit square pressed onto an obstacle below it, gap over x."""
    mesh = MakeStructured2DMesh(quads=False, nx=n, ny=n)
    make = space or VectorH1
    V = make(mesh, order=order, **({"dirichletx": "left|right"} if flags is None else flags))
    X = V * LACSpace(V, slave="bottom")
    (u, lam), (v, _) = X.TnT()
    a = BilinearForm(X)
    a += InnerProduct(stress(u), Sym(Grad(v))) * dx - InnerProduct(CF(traction), v) * ds("top")
    return a, GridFunction(X), LACContact(u, lam, obstacle=CF(gap), **law)


def solve(a, gf, contact, **flags):
    solver = ContactSolver(a, gf, contact, **flags)
    solver.Solve(printing=False)
    return solver


@pytest.mark.parametrize("order", [1, 2, 3])
@pytest.mark.parametrize("gap", [0.0, 0.01, -0.02])
def test_constant_stress(order, gap):
    """Uniaxial strain: constant pressure, and the block stands on the obstacle."""
    a, gf, contact = block_on_obstacle(gap, order=order)
    solve(a, gf, contact)
    table = contact.Table()
    assert table["pressure"] == pytest.approx(1, rel=1e-11)
    assert table["gap"] == pytest.approx(0, abs=1e-13)
    assert contact.Force() == pytest.approx([0, 1], abs=1e-11)
    mesh = gf.space.mesh
    for at in ((0.3, 0.0), (0.7, 1.0)):
        expected = -gap - at[1] / (2 * MU + LAME)
        assert gf.components[0](mesh(*at))[1] == pytest.approx(expected, abs=1e-13)


@pytest.mark.parametrize("space", [VectorH1, BubbleVectorH1])
def test_partial_contact_obeys_signorini(space):
    """A wedge-shaped gap: closed on one side, open on the other."""
    extra = {"slave": "bottom"} if space is BubbleVectorH1 else {}
    a, gf, contact = block_on_obstacle(
        0.2 * x, space=space, order=1, n=12, flags={"dirichletx": "left"} | extra,
        traction=(0, -1.0),
    )  # fmt: skip
    solve(a, gf, contact)
    table = contact.Table()
    closed = table["status"] > 0
    assert 0 < closed.sum() < len(closed)
    assert np.all(table["pressure"][closed] > 0)
    assert np.all(table["gap"][~closed] > 0)
    assert table["pressure"] * table["gap"] == pytest.approx(0, abs=1e-13)
    # The gap of the table is that of the function plus the displacement, on average.
    mesh = gf.space.mesh
    region = mesh.Boundaries("bottom")
    n = specialcf.normal(2)
    exact = Integrate((0.2 * x - gf.components[0] * n), region, BND, order=6)
    assert table["area"] @ table["gap"] == pytest.approx(exact, rel=1e-11)


def test_equilibrium_of_all_forces():
    """Contact force, load and reaction at the clamped side add up to zero."""
    a, gf, contact = block_on_obstacle(0.03 * x, flags={"dirichlet": "left"}, friction=0.3)
    solve(a, gf, contact)
    residual = gf.vec.CreateVector()
    contact_residual = gf.vec.CreateVector()
    a.Apply(gf.vec, residual)
    contact.Apply(gf.vec, contact_residual)
    residual.data += contact_residual
    V = gf.space.components[0]
    values = residual.FV().NumPy()[: V.ndof]
    free = np.array([bool(b) for b in V.FreeDofs()])
    assert np.abs(values[free]).max() < 1e-12
    assert set(contact.Table()["status"]) > {0}  # open, and something else


@pytest.mark.parametrize("friction", [0.3, 5.0])
def test_friction_on_an_obstacle(friction):
    """Pushed sideways by half of the load against soft springs: slides, or stays."""
    a, gf, contact = block_on_obstacle(0.0, flags={}, traction=(0.5, -1.0), friction=friction)
    (u, _), (v, _) = gf.space.TnT()
    a += 3.0 * u[0] * v[0] * ds("top")
    solve(a, gf, contact)
    status = contact.Table()["status"]
    spring = Integrate(3.0 * gf.components[0][0], gf.space.mesh.Boundaries("top"), BND)
    force = contact.Force()
    assert force[1] == pytest.approx(1, rel=1e-10)
    assert force[0] == pytest.approx(spring - 0.5, rel=1e-10)
    if friction < 0.5:
        assert set(status) <= {0, 2}
        assert force[0] == pytest.approx(-friction, rel=1e-10)
    else:
        assert set(status) <= {0, 1}


def test_a_moving_obstacle():
    """A Parameter in the gap moves the obstacle; Update takes its present value."""
    shift = Parameter(0.1)
    a, gf, contact = block_on_obstacle(0.01 + shift)
    for value in (0.1, 0.2, -0.05):
        shift.Set(value)
        contact.Update()
        gf.vec[:] = 0
        solve(a, gf, contact)
        assert gf.components[0](gf.space.mesh(0.5, 0))[1] == pytest.approx(-0.01 - value, abs=1e-13)


def test_gap_is_read_in_the_reference_configuration():
    """Update(gf) with an obstacle does not move the surface to the gap function."""
    a, gf, contact = block_on_obstacle(0.02)
    solve(a, gf, contact)
    contact.Update(gf)
    solve(a, gf, contact)
    assert gf.components[0](gf.space.mesh(0.5, 0))[1] == pytest.approx(-0.02, abs=1e-13)
    assert contact.Table()["pressure"] == pytest.approx(1, rel=1e-11)


def test_threads():
    results = []
    for threaded in (False, True):
        a, gf, contact = block_on_obstacle(0.001 * x * x, friction=0.2)
        if threaded:
            with TaskManager():
                solve(a, gf, contact)
        else:
            solve(a, gf, contact)
        results.append(gf.vec.FV().NumPy().copy())
    assert results[0] == pytest.approx(results[1], abs=1e-12)


def test_obstacle_has_no_mortar_on_the_other_side():
    _, _, contact = block_on_obstacle(0.01)
    D, M = contact.Mortar()
    assert not np.any(M.ToDense().NumPy())
    assert np.any(D.ToDense().NumPy())
    report = str(contact.Check())
    assert "100.0 %" in report
