"""Commit, slip history, status and resultants between two plane sides."""

import numpy as np
import pytest
from blocks import C, block_mesh, contact_form, macro_dofs, moved, residual, vector, with_traction
from netgen.meshing import NgException
from ngsolve import CF, BitArray, GridFunction, x, y, z

from ngslac.meshes.geometry import RotationMatrix

SLOPE, AZIMUTH = 20.0, 30.0
TURN = ((0.3, -1.0, 0.6), 50.0)
SLANT = 1 / np.cos(np.radians(SLOPE))
AREAS = {2: (1.4, 1.0), 3: (4 * SLANT, SLANT)}  # of the slave, and of what is paired


def frame(dim):
    """Rows: unit vectors along the interface, and the normal out of the slave (downwards)."""
    rise, azimuth = np.tan(np.radians(SLOPE)), np.radians(AZIMUTH)
    if dim == 2:
        along = np.array([1, rise]) / SLANT
        return np.array([along, [along[1], -along[0]]])
    normal = np.array([rise * np.cos(azimuth), rise * np.sin(azimuth), -1.0]) / SLANT
    first = np.array([-np.sin(azimuth), np.cos(azimuth), 0.0])
    return np.stack([first, np.cross(normal, first), normal]) @ RotationMatrix(TURN).T


def cross(a, b):
    """The moment of a force b at a."""
    return a[0] * b[1] - a[1] * b[0] if len(a) == 2 else np.cross(a, b)


def turns(r):
    """Fields of small rotations about the axes."""
    in_space = [(0, -r[-1], r[1]), (r[-1], 0, -r[0]), (-r[1], r[0], 0)]
    return [(-r[1], r[0])] if len(r) == 2 else in_space


class Sides:
    """The upper block moved along and towards the lower one, with tractions.

    The master covers the middle of the slave, whose outermost faces have no partner. What is along
    the interface has two components, of which the first counts in 2D.
    """

    def __init__(self, mesh, **law):
        self.dim = mesh.dim
        *self.T, self.N = frame(self.dim)
        self.T = np.array(self.T)
        self.contact = contact_form(mesh, **law)
        self.paired = self.contact.Table()["area"] > 0
        self.dofs = macro_dofs(self.contact)

    def along(self, parts):
        return np.asarray(parts)[: self.dim - 1] @ self.T

    def state(self, tangential=(0, 0), approach=0.0, pressure=0.0, shear=(0, 0)):
        gf = moved(self.contact, upper=self.along(tangential) + approach * self.N)
        return with_traction(self.contact, gf, -pressure * self.N + self.along(shear))

    def table(self, gf):
        self.contact.Evaluate(gf)
        return self.contact.Table()

    def rows(self, gf):
        """Residual of the multipliers."""
        return residual(self.contact, gf.vec.FV().NumPy())[self.dofs]

    def commit(self, *args, **flags):
        self.contact.Commit(self.state(*args, **flags))

    def check_slip(self, gf, expected, tol=1e-12):
        """Slip of the paired macro-elements."""
        slip = self.table(gf)["slip"]
        assert slip @ self.N == pytest.approx(0, abs=1e-13)
        assert slip[self.paired] == pytest.approx(self.every(self.along(expected)), abs=tol)

    def every(self, value):
        """The value for each paired macro-element."""
        return np.tile(value, (self.paired.sum(), 1))

    def loaded(self, seed):
        """Random tractions that press."""
        traction = np.random.default_rng(seed).normal(size=self.dofs.shape) - 9 * self.N
        return with_traction(self.contact, GridFunction(self.contact.form.fes), traction)

    def work(self, gf, field, where=("upper", "lower")):
        """What the contact does in a displacement of these bodies."""
        forces = vector(self.contact, residual(self.contact, gf.vec.FV().NumPy()))
        return -forces.InnerProduct(moved(self.contact, **dict.fromkeys(where, field)).vec)


@pytest.fixture(scope="module", params=["2D", "hex", "tet"])
def mesh(request):
    if request.param == "2D":
        return block_mesh(2, 0.2, angle=SLOPE)
    return block_mesh(3, request.param, "prism", 5, 3, overhang=-0.5, slope=SLOPE,
                      azimuth=AZIMUTH, rotation=TURN)  # fmt: skip


@pytest.fixture
def sides(mesh):
    return Sides(mesh, friction=0.5)


def test_normals_and_areas(sides):
    table = sides.contact.Table()
    assert table["normal"] == pytest.approx(np.tile(sides.N, (len(table["area"]), 1)), abs=1e-14)
    found = table["fullarea"].sum(), table["area"].sum()
    assert found == pytest.approx(AREAS[sides.dim], rel=1e-12)
    assert not sides.paired.all()


def test_residual_of_stick_is_minus_area_times_slip_and_gap(mesh):
    """Without a partner the row says that the traction vanishes."""
    sides = Sides(mesh, friction=1e3)
    gf = sides.state((0.3, -0.2), 0.02, pressure=5.0)
    area = sides.contact.Table()["area"]
    free = -np.outer(sides.contact.Table()["fullarea"], -5.0 * sides.N) / C
    for slip in ((0.3, -0.2), (0, 0)):  # before and after the commit
        expected = -np.outer(area, sides.along(slip) + 0.02 * sides.N)
        rows = sides.rows(gf)
        assert rows[sides.paired] == pytest.approx(expected[sides.paired], abs=1e-14)
        assert rows[~sides.paired] == pytest.approx(free[~sides.paired], rel=1e-11)
        sides.contact.Commit(gf)


TOUCH = np.array([0.05, -0.02]) * (1 + 0.06 / 0.04)
OPEN = ((0, 0), -0.1)
# Commits (way along the interface, approach, pressure), then a way and the slip there.
PATHS = {
    "closed": ([((0.3, 0.1), 0.01, 1.0), ((0.2, 0.3), 0.01, 1.0)], (0.25, -0.1), (0.05, -0.4)),
    "where the path meets the master": ([OPEN, ((0.05, -0.02), -0.06)], TOUCH, (0, 0)),
    "beyond": ([OPEN, ((0.05, -0.02), -0.06)], np.add(TOUCH, (0.02, 0.01)), (0.02, 0.01)),
    "aside": ([OPEN, ((0.5, 0.4), -0.1)], (0.6, 0.4), (0.1, 0)),
    "away": ([OPEN, ((0.6, 0.4), -0.2)], (0.7, 0.4), (0.1, 0)),
    "grazing": ([OPEN, ((0.3, 0.4), -0.09)], (0.4, 0.4), (0.1, 0)),
    "closes further": ([OPEN, ((0.05, 0.02), -0.06, 5.0)], (0.15, 0.02), (0.1, 0)),
}


@pytest.mark.parametrize(("commits", "way", "slip"), PATHS.values(), ids=PATHS)
def test_slip_counts_from_the_last_commit_or_the_first_touch(sides, commits, way, slip):
    """Of a path that goes on as before; what moves aside or away will not touch soon."""
    for commit in commits:
        sides.commit(*commit)
    if commits[-1][1] > 0:
        sides.check_slip(sides.state(*commits[-1]), (0, 0), 1e-14)
    sides.check_slip(sides.state(way, 0.0, pressure=5.0), slip)
    assert sides.contact.Table()["gap"][sides.paired] == pytest.approx(0, abs=1e-13)


def test_update_starts_the_history_anew(sides):
    sides.commit((0.3, 0.1), 0.0, pressure=1.0)
    gf = sides.state((0.05, -0.03), 0.0, pressure=1.0)
    sides.contact.Update(gf)
    sides.contact.form.SetConstant(C)
    sides.paired = sides.contact.Table()["area"] > 0
    sides.check_slip(gf, (0, 0), 1e-14)
    sides.check_slip(sides.state((0.07, -0.03), 0, pressure=1), (0.02, 0))


def test_restore_goes_back_to_the_commit(sides):
    sides.commit((0.1, 0.2), 0.01, pressure=2.0, shear=(0.1, 0.3))
    before = {name: values.copy() for name, values in sides.contact.Table().items()}
    assert set(sides.table(sides.state((0.5, 0.5), -0.7))["status"]) == {0}
    sides.contact.Restore()
    for name, values in sides.contact.Table().items():
        assert np.array_equal(values, before[name], equal_nan=True), name
    assert np.array_equal(sides.contact.slip.vec.FV().NumPy(), before["slip"].ravel())


def test_evaluate_fills_the_fields(sides):
    gf = sides.state((0.1, -0.1), 0.03, pressure=4.0, shear=(1.0, -2.0))
    table, contact = sides.table(gf), sides.contact
    assert table["pressure"] == pytest.approx(np.where(sides.paired, 4, 0), rel=1e-13)
    assert np.all(np.isnan(table["gap"]) == ~sides.paired)
    assert table["gap"][sides.paired] == pytest.approx(-0.03, rel=1e-11)
    expected = np.outer(sides.paired, -4 * sides.N + sides.along((1, -2)))
    assert table["traction"] == pytest.approx(expected, abs=1e-13)
    assert table["friction"] == pytest.approx(0.5)
    assert set(table["status"][~sides.paired]) == {0}
    for name in ("pressure", "gap", "status", "traction", "slip", "normal"):
        found = getattr(contact, name).vec.FV().NumPy()
        assert np.array_equal(found, table[name].ravel(), equal_nan=True), name


@pytest.mark.parametrize(
    ("law", "bound"),
    [
        ({"friction": 0.3}, 0.3 * 2.3),
        ({"tresca": 0.5}, 0.5),
        ({"friction": 0.3, "tresca": 0.5}, 0.5),  # Coulomb's law up to the threshold
        ({"friction": 0.1, "tresca": 0.5}, 0.23),
        ({"friction": 0.0, "tresca": 0.5}, 0.0),
        ({}, 0.0),
    ],
)
def test_the_law(mesh, law, bound):
    """Trial pressure 2 + 0.1 C = 2.3; the trial shear keeps its direction: a disc, not a square."""
    sides = Sides(mesh, **law)
    inside = [(0.99 * bound * np.cos(t), -0.99 * bound * np.sin(t)) for t in (0, 0.8, 2.0, 4.0)]
    for parts in [(4.0, 0), (-3.0, 2.0), (-1.02 * bound, 0.2 * bound), *inside]:
        shear = sides.along(parts)
        rows = sides.rows(sides.state((0, 0), 0.1, pressure=2.0, shear=parts))[sides.paired]
        area = sides.contact.Table()["area"][sides.paired, None]
        projected = rows * C / area - 2 * sides.N + shear
        size = np.linalg.norm(shear)
        limited = shear * (min(1.0, bound / size) if size else 0.0)
        assert projected == pytest.approx(sides.every(-2.3 * sides.N + limited), abs=1e-11)
        gf = sides.state((0, 0), 0.1, pressure=2.0, shear=parts)
        assert set(sides.table(gf)["status"][sides.paired]) == {1 if size <= bound > 0 else 2}
    assert set(sides.table(sides.state((0, 0), -0.7, pressure=2.0))["status"]) == {0}


def test_friction_depends_on_the_position(mesh):
    """The mean over the whole of each macro-element, which is the value at its centroid."""
    slope = (1, -2, 0.5)[: mesh.dim]
    friction = 6 + sum(a * b for a, b in zip(slope, (x, y, z), strict=False))
    table = contact_form(mesh, friction=friction).Table()
    inside = np.isclose(table["area"], table["fullarea"], rtol=1e-12)
    expected = 6 + table["x"] @ slope
    assert np.any(inside)
    assert table["friction"][inside] == pytest.approx(expected[inside], rel=1e-12)


def test_forces_and_moments_of_both_sides_cancel(sides):
    """The surfaces coincide: no gap. Resultants are the work in unit motions of the slave."""
    gf, d = sides.loaded(1), sides.dim
    table, force = sides.table(gf), sides.contact.Force()
    moment = np.atleast_1d(sides.contact.Moment((0,) * d))
    tol = {"abs": 1e-12 * np.abs(table["traction"]).max()}
    assert force == pytest.approx(table["area"] @ table["traction"], rel=1e-13)
    for field, expected in zip([*np.eye(d), *turns((x, y, z)[:d])], [*force, *moment], strict=True):
        assert sides.work(gf, field) == pytest.approx(0, **tol)
        assert sides.work(gf, field, ["upper"]) == pytest.approx(expected, **tol)
    point = np.array([0.3, -2.0, 1.0])[:d]
    change = np.atleast_1d(sides.contact.Moment(point)) - moment
    assert change == pytest.approx(np.atleast_1d(-cross(point, force)), rel=1e-10)


@pytest.mark.parametrize("gap", [0.01, 0.1])
def test_moment_of_both_sides_is_that_of_the_gap(sides, gap):
    """Across an open gap the forces do not share a line: moment gap times force, no more."""
    contact, lift = sides.contact, -gap * sides.N
    away = moved(contact, upper=lift)
    contact.Update(away)
    contact.form.SetConstant(C)
    with_traction(contact, away, -2.0 * sides.N + sides.T[0])
    contact.Evaluate(away)
    lifted = contact.mesh.MaterialCF({"upper": CF(tuple(lift)), "lower": CF((0,) * sides.dim)})
    r = [c + lifted[k] for k, c in enumerate((x, y, z)[: sides.dim])]
    total = np.array([sides.work(away, turn) for turn in turns(r)])
    # The slave lies at -gap N from where the master takes the opposite force.
    force = contact.Force()
    assert total == pytest.approx(np.atleast_1d(cross(lift, force)), abs=1e-12)
    along = np.linalg.norm(force - force @ sides.N * sides.N)
    assert np.linalg.norm(total) == pytest.approx(gap * along, rel=1e-10)


@pytest.mark.parametrize("status", [3.0, -1.0, 0.5, np.nan, 1e300])
@pytest.mark.parametrize("name", ["states", "accepted"])
def test_a_status_that_there_is_not(name, status):
    """Of a damaged file, or of another version: refused before anything is taken over."""
    form = contact_form(block_mesh(2, 0.25)).form
    history = form.History()
    wrong = history | {"c": history["c"] + 1, name: history[name].copy()}
    wrong[name][2] = status
    with pytest.raises(NgException, match="status of a macro-element"):
        form.SetHistory(wrong)
    for key, values in form.History().items():
        np.testing.assert_array_equal(values, history[key])
    form.SetHistory(history)


@pytest.mark.parametrize("more", [-1, 1])
def test_as_many_bits_as_macro_elements(sides, more):
    contact = sides.contact
    with pytest.raises(NgException, match=r"bits for .* macro-elements"):
        contact.form.Close(BitArray(contact.space.nmacros + more), vector(contact))


@pytest.mark.parametrize("approach", [-0.1, 0.1])
def test_what_is_closed_presses(sides, approach):
    """Whatever its gap is; what has no partner stays open."""
    gf, every = sides.state((0, 0), approach), np.arange(len(sides.dofs))
    chosen, bits = every % 2 == 0, BitArray(len(every))
    bits[:] = False
    for macro in every[chosen]:
        bits.Set(int(macro))
    sides.contact.form.Close(bits, gf.vec)
    table = sides.table(gf)
    assert np.all(table["pressure"][chosen & sides.paired] > 0)
    assert np.all(table["status"][chosen & sides.paired] > 0)
    assert not np.any(table["pressure"][~chosen | ~sides.paired])
