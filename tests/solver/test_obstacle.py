"""A rigid obstacle in place of a master: a plane, a slope, a ball."""

import numpy as np
import pytest
from ngsolve import BND, Integrate, Parameter, VectorH1, ds, specialcf, sqrt, x, y
from obstacles import block_on_obstacle
from press import LAME, MU, solved

from ngslac import BubbleVectorH1

TOL = {2: 1e-13, 3: 1e-12}  # of lengths; a hundredth of that of tractions and forces


@pytest.fixture(params=[2, 3])
def dim(request):
    return request.param


def lower_side(problem):
    """Normal displacement in the middle of the slave."""
    at = problem.mesh(*(0.5, 0.5, 0)[3 - problem.mesh.dim :])
    return problem.gf.components[0](at)[-1]


@pytest.mark.parametrize(
    "given",
    [
        *({"order": order} for order in (1, 2, 3)),
        {"dim": 3, "order": 1},
        *({"dim": 3, "n": 3, "kind": k} for k in ("tet", "hex", "prism", "prism_side", "pyramid")),
    ],
)
@pytest.mark.parametrize("gap", [0.01, -0.02])
def test_constant_stress_on_a_plane(given, gap):
    """Uniaxial strain: constant pressure, and the block stands on the obstacle."""
    problem = block_on_obstacle(gap, **given)
    solved(problem)
    table, dim = problem.contact.Table(), problem.mesh.dim
    tol = TOL[dim]
    assert table["pressure"] == pytest.approx(1, rel=100 * tol)
    assert table["gap"] == pytest.approx(0, abs=tol)
    assert problem.contact.Force() == pytest.approx([0] * (dim - 1) + [1], abs=100 * tol)
    for at in ((0.3, 0.4, 0.0), (0.7, 0.1, 1.0)):
        expected = -gap - at[2] / (2 * MU + LAME)
        point = problem.mesh(*at[3 - dim :])
        assert problem.gf.components[0](point)[-1] == pytest.approx(expected, abs=tol)


@pytest.mark.parametrize(
    "given", [{"n": 12}, {"dim": 3, "n": 5, "kind": "tet"}, {"dim": 3, "n": 5, "kind": "hex"}]
)
@pytest.mark.parametrize("space", [VectorH1, BubbleVectorH1])
def test_partial_contact_on_a_slope_obeys_signorini(given, space):
    """A wedge-shaped gap: closed on one side, open on the other."""
    dim = given.get("dim", 2)
    gap, flags = 0.2 * x, {"dirichletx": "left"}
    if dim == 3:
        gap, flags["dirichlety"] = 0.1 * x + 0.05 * y, "front"
    if space is BubbleVectorH1:
        flags["slave"] = "bottom"
    problem = block_on_obstacle(gap, space=space, order=1, flags=flags, **given)
    solved(problem)
    table = problem.contact.Table()
    closed = table["status"] > 0
    assert 0 < closed.sum() < len(closed)
    assert np.all(table["pressure"][closed] > 0)
    assert np.all(table["gap"][~closed] > 0)
    assert table["pressure"] * table["gap"] == pytest.approx(0, abs=TOL[dim])
    assert problem.contact.Force()[-1] == pytest.approx(1, rel=1e-10)
    # The gap of the table is that of the function plus the displacement, on average.
    region, normal = problem.mesh.Boundaries("bottom"), specialcf.normal(dim)
    exact = Integrate(gap - problem.gf.components[0] * normal, region, BND, order=6)
    assert table["area"] @ table["gap"] == pytest.approx(exact, rel=100 * TOL[dim])


def test_equilibrium_of_all_forces():
    """The residual of bulk and contact vanishes where the block is not clamped."""
    problem = block_on_obstacle(0.03 * x, flags={"dirichlet": "left"}, friction=0.3)
    solved(problem)
    residual = problem.gf.vec.CreateVector()
    problem.a.Apply(problem.gf.vec, residual)
    problem.contact.AddApply(problem.gf.vec, residual)
    V = problem.X.components[0]
    free = np.array([bool(b) for b in V.FreeDofs()])
    assert np.abs(residual.FV().NumPy()[: V.ndof][free]).max() < 1e-12
    assert set(problem.contact.Table()["status"]) > {0}  # open, and something else


@pytest.mark.parametrize("friction", [0.3, 5.0])
def test_friction_on_a_plane(dim, friction):
    """Pushed sideways by half of the load against soft springs: slides, or stays."""
    push = np.array({2: [0.5], 3: [0.3, 0.4]}[dim])
    problem = block_on_obstacle(
        0.0, dim=dim, n=3 if dim == 3 else 8, flags={}, traction=(*push, -1.0), friction=friction
    )
    (u, _), (v, _) = problem.X.TnT()
    problem.a += 3.0 * sum(u[k] * v[k] for k in range(dim - 1)) * ds("top")
    solved(problem)
    status, force = set(problem.contact.Table()["status"]), problem.contact.Force()
    stretch = Integrate(problem.gf.components[0], problem.mesh.Boundaries("top"), BND)
    assert force[-1] == pytest.approx(1, rel=1e-10)
    assert force[:-1] == pytest.approx(3 * np.array(stretch)[:-1] - push, abs=1e-10)
    assert status <= ({0, 2} if friction < 0.5 else {0, 1})
    if friction < 0.5:
        # The slip directions differ a little over the surface.
        assert force[:-1] == pytest.approx(-friction * push / 0.5, rel=1e-10 if dim == 2 else 0.02)
        assert np.linalg.norm(force[:-1]) <= friction * (1 + 1e-10)


def test_a_moving_obstacle(dim):
    """A Parameter in the gap moves the obstacle; Update takes its present value, and no motion."""
    shift = Parameter(0.1)
    problem = block_on_obstacle(0.01 + shift, dim=dim, n=2)
    for value in (0.1, 0.2, -0.05):
        shift.Set(value)
        problem.contact.Update()
        problem.gf.vec[:] = 0
        solved(problem)
        assert lower_side(problem) == pytest.approx(-0.01 - value, abs=TOL[dim])
    problem.contact.Update(problem.gf)  # does not move the surface to the gap function
    solved(problem)
    assert lower_side(problem) == pytest.approx(-0.01 - value, abs=TOL[dim])
    assert problem.contact.Table()["pressure"] == pytest.approx(1, rel=100 * TOL[dim])


def test_obstacle_has_no_mortar_on_the_other_side(dim):
    contact = block_on_obstacle(0.01, dim=dim, n=2).contact
    D, M = contact.Mortar()
    assert not np.any(M.ToDense().NumPy())
    assert np.any(D.ToDense().NumPy())
    assert "100.0 %" in str(contact.Check())


def test_a_ball_pressed_into_a_block():
    """Rigid ball of radius 2 under the middle: a round contact, and no resultant sideways."""
    radius, depth = 2.0, 0.02
    gap = radius - depth - sqrt(radius**2 - (x - 0.5) ** 2 - (y - 0.5) ** 2)
    problem = block_on_obstacle(gap, dim=3, n=8, flags={"dirichlet": "top"})
    problem.load.Set(0)
    solved(problem)
    table, force = problem.contact.Table(), problem.contact.Force()
    r = np.hypot(*(table["x"][:, :2] - 0.5).T)
    closed, pressure = table["status"] > 0, table["pressure"]
    assert 0.1 < r[closed].max() < np.sqrt(2 * radius * depth)
    assert r[closed].max() < r[~closed].min() + 1e-9  # round
    assert pressure.argmax() in np.argsort(r)[:4]
    assert force[:2] == pytest.approx(0, abs=1e-11)
    # Hertz gives the right size only: the block is small and held at its far side.
    modulus = 4 * MU * (MU + LAME) / (2 * MU + LAME)
    hertz = 4 / 3 * modulus * np.sqrt(radius) * depth**1.5
    assert hertz < force[2] < 2 * hertz
    # Mirror images have equal pressures.
    mirrored = [
        np.lexsort(np.round([s * (table["x"][:, 0] - 0.5), table["x"][:, 1]], 9)) for s in (1, -1)
    ]
    assert pressure[mirrored[0]] == pytest.approx(pressure[mirrored[1]], abs=1e-10)


@pytest.mark.parametrize("dim", [2, 3])
def test_what_is_tied_to_an_obstacle_goes_with_it(dim):
    """It pulls and pushes by what it has moved since the start, however far off it is."""
    at = Parameter(0.3)
    moving = block_on_obstacle(at, dim=dim, tied=True, flags={"dirichlet": "top"})
    moving.load.Set(0)
    moving.solver().Solve(printing=False)
    assert not np.any(moving.contact.Force())
    at.Set(0.35)  # away
    moving.contact.Commit(moving.gf)
    moving.solver().Solve(printing=False)
    table = moving.contact.Table()
    assert np.all(table["pressure"] < 0)
    assert table["gap"] == pytest.approx(0.3, abs=1e-12)
    other = block_on_obstacle(at, dim=dim, tied=True, flags={"dirichlet": "top"})
    other.contact.SetState(moving.contact.State())
    other.load.Set(0)
    other.solver().Solve(printing=False)
    assert other.contact.Force() == pytest.approx(moving.contact.Force(), rel=1e-9, abs=1e-12)
