"""Recovered pressure and traction: linear ones, resultants, friction, odd cases, convergence."""

import numpy as np
import pytest
from bricks import mixed
from carrying import at_points, carry, carrying, keeps_resultants, never_pulls, pressing
from netgen.occ import MoveTo, OCCGeometry
from ngsolve import CF, Integrate, Mesh, VectorH1, x
from obstacles import block_on_obstacle
from press import mixed_press, press, solved

from ngslac import LACContact, LACSpace, SplitSlaveFaces
from ngslac.recovery.stencils import FitMeans
from ngslac.recovery.surface import SlaveSurface

PAIRS3D = [("hex", "prism"), ("prism", "hex"), ("tet", "hex")]
ELEMENTS = [{"dim": 2, "order": order} for order in (1, 2, 3)]
ELEMENTS += [{"dim": 3, "kinds": kinds, "order": o} for kinds in PAIRS3D for o in (1, 2)]
elements = pytest.mark.parametrize("flags", ELEMENTS, ids=str)


def linear(points):
    return 3 + points @ np.array([0.7, 0.4, 0.0])[: points.shape[1]]


def check_linear(contact, exact=linear):
    """The one linear pressure that has the force and moment of the multipliers.

    Constants on macro-elements have less moment than the linear function with their values.
    """
    where, weight, found = at_points(contact, contact.Recovered().pressure)
    terms = np.column_stack([np.ones(len(where)), where[:, :-1]])
    table = contact.Table()
    given = (table["area"] * table["pressure"])[:, None] * np.column_stack(
        [np.ones(len(table["x"])), table["x"][:, :-1]]
    )
    values = np.linalg.solve(terms.T @ (weight[:, None] * terms), given.sum(axis=0))
    size = np.abs(found).max()
    np.testing.assert_allclose(found.ravel(), terms @ values, rtol=0, atol=1e-9 * size)
    np.testing.assert_allclose(found.ravel(), exact(where), atol=0.3 * np.abs(exact(where)).max())
    keeps_resultants(contact)


@elements
@pytest.mark.parametrize("unit", [1.0, 1e9])
def test_linear_pressures_are_exact(flags, unit):
    exact = lambda points: unit * linear(points)  # noqa: E731
    check_linear(carrying(pressing(exact), **({"n": (7, 4), "h": 0.1} | flags)), exact)


@pytest.mark.parametrize("dim", [2, 3])
def test_exact_on_split_faces(dim):
    split = lambda mesh: SplitSlaveFaces(mesh, "slave")  # noqa: E731
    check_linear(carrying(pressing(linear), dim=dim, order=1, change=split, n=(5, 4)))


@elements
def test_constant_pressure_and_traction_are_exact(flags):
    """Also in the last digits of a part of a unit."""
    tilted = np.array([0.1, 0.2, 0.0])[-flags["dim"] :]
    contact = carrying(lambda table: 7e-7 * (tilted - table["normal"]), tied=True, **flags)
    wanted = 7e-7 * (tilted - contact.Table()["normal"][:1])
    found = at_points(contact, contact.Recovered().traction)[2]
    np.testing.assert_allclose(found, np.broadcast_to(wanted, found.shape), rtol=1e-8, atol=1e-18)


LAWS = [{}, {"friction": 0.3}, {"friction": 0.3, "finite": True}, {"finite": True}]
LAWS += [{"tresca": 0.02}, {"tied": True}, {"bilateral": True, "friction": 0.3}]


@pytest.mark.parametrize("law", LAWS, ids=str)
@pytest.mark.parametrize("dim", [2, 3])
@pytest.mark.parametrize("order", [1, 2])
def test_resultants_of_solved_problems(dim, law, order):
    """Stick, slip and open at once, on a slave that overhangs the master in part."""
    given = {"friction": None} | law
    problem = mixed_press(dim=dim, order=order, **given)
    solved(problem)
    contact = problem.contact
    keeps_resultants(contact)
    if not (law.get("tied") or law.get("bilateral")):
        never_pulls(contact)


@pytest.mark.parametrize("dim", [2, 3])
@pytest.mark.parametrize("finite", [False, True])
def test_friction_stays_below_its_bound(dim, finite):
    problem = mixed_press(dim=dim, friction=0.5, finite=finite)
    solved(problem)
    contact, smooth = problem.contact, problem.contact.Recovered()
    assert 2 in contact.Table()["status"]
    t, p = (at_points(contact, f)[2] for f in (smooth.traction, smooth.pressure))
    largest = np.linalg.norm(t, axis=1) - np.sqrt(1 + 0.5**2) * p.ravel()
    # In 3D the directions of slip differ: what is between them is shorter, the force is not.
    assert largest.max() <= {2: 1e-9, 3: 5e-3}[dim] * p.max()


def test_slip_all_over_stays_slip():
    """Nothing sticks: the traction is at the bound everywhere, and force and moment are kept."""

    def sliding(table):
        pressure = linear(table["x"])[:, None]
        return pressure * (np.array([0.3, 0.0, 0.0]) - table["normal"])

    contact = carrying(sliding, dim=3, friction=0.3, n=(7, 4))
    keeps_resultants(contact)
    smooth = contact.Recovered()
    t, p = (at_points(contact, f)[2] for f in (smooth.traction, smooth.pressure))
    np.testing.assert_allclose(t[:, 0], 0.3 * p.ravel(), rtol=1e-8)


@elements
@pytest.mark.parametrize("law", ["tied", "bilateral"])
def test_surfaces_that_do_not_separate_may_pull(flags, law):
    exact = lambda points: points[:, 0] - 0.5  # noqa: E731
    given = {"n": (7, 4), "h": 0.1, law: True} | flags
    check_linear(carrying(pressing(exact), **given), exact)


@pytest.mark.parametrize(
    ("seed", "flags"),
    [
        (172, {"dim": 2, "order": 2, "h": 0.3}),
        (5, {"dim": 3, "order": 1, "n": (4, 3)}),
        (13, {"dim": 3, "order": 2, "n": (3, 2)}),
        (121, {"dim": 3, "order": 2, "n": (3, 2)}),
    ],
)
def test_uneven_pressures_do_not_pull_inside_of_coarse_faces(seed, flags):
    """A linear pressure with their moment would, at corners of faces."""
    uneven = np.random.default_rng(seed).uniform
    contact = carrying(pressing(lambda x: uneven(0, 1, len(x)) ** 4), **flags)
    never_pulls(contact)
    keeps_resultants(contact)


@pytest.mark.parametrize("dim", [2, 3])
def test_obstacle(dim):
    """A bump presses into the middle of a block: the ends of it are open."""
    problem = block_on_obstacle(0.1 * (CF(0.5) - x) ** 2 - 0.002, dim=dim)
    solved(problem)
    assert 0 in problem.contact.Table()["status"]
    keeps_resultants(problem.contact)
    never_pulls(problem.contact)


def test_triangles_beside_quadrilaterals():
    mesh = mixed()
    V = VectorH1(mesh, order=2)
    u, lam = (V * LACSpace(V, slave="bottom")).TrialFunction()
    contact = LACContact(u, lam, obstacle=0.0)
    contact.Update()
    check_linear(carry(contact, pressing(linear)))


def test_selfcontact():
    shape = MoveTo(-1, -1).Rectangle(2, 2).Face() - MoveTo(-1.5, -0.02).Rectangle(2, 0.04).Face()
    for edge in shape.edges:
        edge.name = "slot" if abs(edge.center.y) < 0.03 and edge.center.x > -0.9 else "outside"
    V = VectorH1(Mesh(OCCGeometry(shape, dim=2).GenerateMesh(maxh=0.2)), order=2)
    u, lam = (V * LACSpace(V, slave="slot")).TrialFunction()
    contact = LACContact(u, lam, master="slot", finite=True)
    contact.Update()
    one_side = lambda table: -((table["area"] > 0) * 2.0)[:, None] * table["normal"]  # noqa: E731
    carry(contact, one_side)
    np.testing.assert_allclose(at_points(contact, contact.Recovered().pressure)[2], 2, rtol=1e-8)
    keeps_resultants(contact)


@pytest.mark.parametrize("law", [{}, {"friction": 0.3, "finite": True}], ids=str)
@pytest.mark.parametrize("dim", [2, 3])
@pytest.mark.parametrize("again", [False, True])
def test_gaps_of_points_have_the_means_of_contact(dim, law, again):
    """Also where the surfaces are paired in a deformed configuration."""
    problem = press(dim=dim, **law)
    solver, contact = solved(problem), problem.contact
    if again:
        contact.Update(solver.gf)
        solver.Solve(printing=False)
    contact.Commit(solver.gf)
    smooth = contact.Recovered()
    gaps = smooth._Gaps(contact._state.Displacement(contact._solution))
    surface = smooth._surface
    means = np.bincount(surface.macro, surface.weight * gaps) / surface.area
    np.testing.assert_allclose(means, contact.Table()["gap"], atol=1e-12)


# --- odd cases -----------------------------------------------------------------------------------


def test_nothing_is_fitted_where_nothing_touches():
    problem = press()
    solved(problem)
    surface, weights = SlaveSurface(problem.contact), np.ones(problem.contact.space.nmacros)
    density = np.ones(len(surface.weight))
    values = FitMeans(surface, None, density, weights[:, None], np.zeros(len(weights), bool))
    assert not np.any(values)


@pytest.mark.parametrize("dim", [2, 3])
def test_nothing_closed(dim):
    contact = carrying(lambda table: 0 * table["normal"], dim=dim)
    smooth = contact.Recovered()
    assert Integrate(smooth.pressure, contact.mesh, definedon=contact.space.slave) == 0
    keeps_resultants(contact)


@pytest.mark.parametrize("dim", [2, 3])
@pytest.mark.parametrize("order", [1, 2])
def test_one_closed(dim, order):
    def one(table):
        pressure = np.zeros(len(table["x"]))
        pressure[len(pressure) // 2] = 2
        return -pressure[:, None] * table["normal"]

    contact = carrying(one, dim=dim, order=order, n=(7, 4), h=0.1)
    keeps_resultants(contact)
    never_pulls(contact)
    largest = at_points(contact, contact.Recovered().pressure)[2].max()
    assert 0.5 < largest < 5


def test_not_paired_yet_and_unpaired_part():
    contact = press(mesh_flags={"overhang": -0.4, "aligned": False}).contact
    assert Integrate(contact.Recovered().pressure, contact.mesh, definedon=contact.space.slave) == 0
    assert contact.Check().unpaired.size
    carry(contact, lambda table: -((table["area"] > 0) * 1.0)[:, None] * table["normal"])
    _, _, found = at_points(contact, contact.Recovered().pressure)
    np.testing.assert_allclose(found, 1, rtol=1e-9)
    keeps_resultants(contact)


def test_solved_with_an_unpaired_part_divides_by_no_area():
    problem = press(mesh_flags={"overhang": -0.4, "aligned": False})
    solved(problem)
    assert not problem.contact.Table()["area"].all()
    with np.errstate(all="raise", under="ignore"):
        problem.contact.Recovered()
    keeps_resultants(problem.contact)


def test_two_patches_keep_their_own_resultants():
    """Two punches of very different size of pressure do not see each other."""

    def two(table):
        at = table["x"][:, 0]
        pressure = 100.0 * (np.abs(at - 0.15) < 0.12) + 1e-2 * (np.abs(at - 0.8) < 0.12)
        return -pressure[:, None] * table["normal"]

    contact = carrying(two, h=0.05)
    place, weight, t = at_points(contact, contact.Recovered().traction)
    table = contact.Table()
    for side in (-1, 1):
        mine = weight * (side * (place[:, 0] - 0.5) > 0)
        given = (table["area"] * (side * (table["x"][:, 0] - 0.5) > 0))[:, None] * table["traction"]
        np.testing.assert_allclose(mine @ t, given.sum(axis=0), rtol=1e-10, atol=1e-13)


@pytest.mark.parametrize("law", [{}, {"friction": 0.3}, {"tied": True}], ids=str)
@pytest.mark.parametrize("size", [1e-300, 1e300])
def test_any_size_of_pressure(law, size):
    contact = carrying(lambda table: -size * table["normal"], **law)
    np.testing.assert_allclose(at_points(contact, contact.Recovered().pressure)[2], size, rtol=1e-9)


@pytest.mark.parametrize("tied", [False, True])
def test_what_is_not_finite_is_refused(tied):
    contact = carrying(lambda table: np.nan * table["normal"], tied=tied)
    with pytest.raises(ValueError, match="not all finite"):
        contact.Recovered()


def test_made_when_asked_for_and_forgotten():
    problem = press(friction=0.2)
    solver = solved(problem)
    contact = problem.contact
    assert contact._recovered is None
    first = contact.Recovered()
    assert contact.Recovered() is first
    contact.Evaluate(solver.gf)
    assert contact.Recovered() is not first
    state = contact.State()
    before = at_points(contact, contact.Recovered().pressure)[2]
    contact.Commit(solver.gf)
    contact.SetState(state, solver.gf)
    np.testing.assert_allclose(at_points(contact, contact.Recovered().pressure)[2], before)


# --- where contact ends --------------------------------------------------------------------------


def mean_hertz(table, ends=0.3):
    """Of sqrt(1 - s^2) over each macro-element of a structured row of edges."""
    s = (table["x"][:, 0] - 0.5) / ends
    half = 0.5 * table["fullarea"] / ends

    def primitive(t):
        t = np.clip(t, -1, 1)
        return 0.5 * (t * np.sqrt(1 - t**2) + np.arcsin(t))

    return (primitive(s + half) - primitive(s - half)) / (2 * half)


def l2_error(contact, exact, inside=np.inf):
    place, weight, found = at_points(contact, contact.Recovered().pressure)
    weight = weight * (np.abs(place[:, 0] - 0.5) < inside)
    wanted = exact(place)
    return np.sqrt(weight @ (found.ravel() - wanted) ** 2 / (weight @ wanted**2))


def rates(errors):
    return np.log2(np.array(errors[:-1]) / errors[1:])


def test_second_order_inside():
    """Means of smooth pressures on closed contact: order 2; a constant has order 1."""

    def smooth(points):
        return 2 + np.sin(3 * points[:, 0])

    def means(table):
        at, half = table["x"][:, 0], table["fullarea"] / 2
        mean = (np.cos(3 * (at - half)) - np.cos(3 * (at + half))) / (6 * half)
        return -(2 + mean)[:, None] * table["normal"]

    errors = [l2_error(carrying(means, h=h), smooth) for h in (0.1, 0.05, 0.025, 0.0125)]
    assert rates(errors).min() > 1.9
    assert errors[-1] < 2e-4


def test_convergence_where_contact_ends():
    """Hertz' profile from its means: between half the width and the end the square root shows."""

    def hertz(points):
        return np.sqrt(np.maximum(0, 1 - ((points[:, 0] - 0.5) / 0.3) ** 2))

    given = lambda table: -mean_hertz(table)[:, None] * table["normal"]  # noqa: E731
    contacts = [carrying(given, h=h) for h in (0.06, 0.03, 0.015)]
    errors = [l2_error(contact, hertz) for contact in contacts]
    assert rates(errors).mean() > 0.9
    assert errors[0] < 0.1
    inside = [l2_error(contact, hertz, inside=0.2) for contact in contacts]
    assert rates(inside).mean() > 1.7


def with_means(exact, n, order, kinds):
    """A contact of a block in 3D whose multipliers are the means of a pressure."""

    def given(table):
        surface = SlaveSurface(contact)
        sums = np.bincount(surface.macro, surface.weight * exact(surface.position))
        return -(sums / surface.area)[:, None] * table["normal"]

    contact = carrying(lambda table: 0 * table["normal"], dim=3, n=n, order=order, kinds=kinds)
    return carry(contact, given)


@pytest.mark.parametrize("order", [1, 2])
def test_second_order_inside_in_three_dimensions(order):
    """On stars of triangles and on pairs of them; the sizes of faces are halved."""

    def smooth(at):
        return 2 + np.sin(3 * at[:, 0]) * np.cos(2 * at[:, 1])

    sizes = (6, 5), (12, 11), (24, 23)
    errors = [l2_error(with_means(smooth, n, order, PAIRS3D[2]), smooth) for n in sizes]
    assert rates(errors).mean() > 1.8
    assert errors[-1] < 6e-3


@pytest.mark.parametrize("change", [{"scale": 1e-6}, {"angle": 40.0}], ids=str)
def test_units_and_rotation(change):
    """Other units of length and a rotation change nothing."""
    given, found = None, []
    for flags in ({}, change):

        def hertz(table):
            nonlocal given
            given = mean_hertz(table) if given is None else given
            return -given[:, None] * table["normal"]

        contact = carrying(hertz, h=0.05, mesh_flags=flags)
        found.append(at_points(contact, contact.Recovered().pressure)[2])
    np.testing.assert_allclose(*found, rtol=0, atol=1e-6)
