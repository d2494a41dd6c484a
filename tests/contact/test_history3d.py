"""Commit, slip history, status and resultants in 3D, where slip is a vector in a plane."""

import numpy as np
import pytest
from blocks3d import C, block_mesh, contact_form, moved, residual, vector, with_traction
from ngsolve import CF, GridFunction, x, y, z

from ngslac.meshes.geometry3d import RotationMatrix

SLOPE, AZIMUTH = 20.0, 30.0
TURN = ((0.3, -1.0, 0.6), 50.0)


def frame():
    """Rows: two unit vectors along the interface, and the normal out of the slave (downwards)."""
    rise, azimuth = np.tan(np.radians(SLOPE)), np.radians(AZIMUTH)
    normal = np.array([rise * np.cos(azimuth), rise * np.sin(azimuth), -1.0])
    normal /= np.linalg.norm(normal)
    first = np.array([-np.sin(azimuth), np.cos(azimuth), 0.0])
    return np.stack([first, np.cross(normal, first), normal]) @ RotationMatrix(TURN).T


T1, T2, N = frame()
T = np.stack([T1, T2])


@pytest.fixture(scope="module", params=["hex", "tet"])
def mesh(request):
    """The master covers the middle of the slave, whose outermost faces have no partner."""
    return block_mesh(
        request.param, "prism", 5, 3, overhang=-0.5, slope=SLOPE, azimuth=AZIMUTH, rotation=TURN
    )


def state(contact, tangential=(0, 0), approach=0.0, pressure=0.0, shear=(0, 0)):
    """The upper block moved along and towards the lower one, with tractions."""
    shift = np.asarray(tangential) @ T + approach * N
    gf = moved(contact, upper=tuple(map(float, shift)))
    return with_traction(contact, gf, -pressure * N + np.asarray(shear) @ T)


def slip(contact, gf):
    """Slip of the paired macro-elements in the two tangential directions."""
    contact.Evaluate(gf)
    table = contact.Table()
    assert table["slip"] @ N == pytest.approx(0, abs=1e-13)
    return (table["slip"] @ T.T)[table["area"] > 0]


def every(contact, value):
    """The value for each paired macro-element."""
    return np.tile(value, (np.sum(contact.Table()["area"] > 0), 1))


def test_normals_and_areas(mesh):
    contact = contact_form(mesh)
    table = contact.Table()
    assert table["normal"] == pytest.approx(np.tile(N, (len(table["area"]), 1)), abs=1e-14)
    slant = 1 / np.cos(np.radians(SLOPE))
    assert table["fullarea"].sum() == pytest.approx(4 * slant, rel=1e-13)
    assert table["area"].sum() == pytest.approx(slant, rel=1e-12)
    assert np.any(table["area"] == 0)


def test_slip_counts_from_the_last_commit_in_3d(mesh):
    contact = contact_form(mesh, friction=0.5)
    total = np.zeros(2)
    for step in ((0.3, 0.1), (-0.1, 0.2), (0.05, -0.4)):
        total += step
        gf = state(contact, total, 0.01, pressure=1.0)
        assert slip(contact, gf) == pytest.approx(every(contact, step), abs=1e-13)
        contact.Commit(gf)
        assert slip(contact, gf) == pytest.approx(0, abs=1e-14)


def test_gap_does_not_depend_on_the_history_in_3d(mesh):
    contact = contact_form(mesh)
    contact.Commit(state(contact, (0.1, -0.2), 0.2, pressure=1.0))
    contact.Evaluate(state(contact, (0.3, 0.5), -0.05))
    paired = contact.Table()["area"] > 0
    assert contact.Table()["gap"][paired] == pytest.approx(0.05, rel=1e-11)


def test_residual_of_stick_is_minus_area_times_slip_in_3d(mesh):
    contact = contact_form(mesh, friction=1e3)
    gf = state(contact, (0.3, -0.2), 0.02, pressure=5.0)
    rows = residual(contact, gf.vec.FV().NumPy())[contact.form.MultiplierDofs()].reshape(-1, 3)
    table = contact.Table()
    paired = table["area"] > 0
    jump = np.array([0.3, -0.2]) @ T + 0.02 * N
    expected = -np.outer(table["area"], jump)
    assert rows[paired] == pytest.approx(expected[paired], abs=1e-14)
    free = -np.outer(table["fullarea"], -5.0 * N) / C
    assert rows[~paired] == pytest.approx(free[~paired], rel=1e-11)
    contact.Commit(gf)  # now only the gap is left
    rows = residual(contact, gf.vec.FV().NumPy())[contact.form.MultiplierDofs()].reshape(-1, 3)
    expected = -np.outer(table["area"], 0.02 * N)
    assert rows[paired] == pytest.approx(expected[paired], abs=1e-14)


def test_first_touch_along_the_path_in_3d(mesh):
    """Open at the commit and approaching: slip counts from where the path meets the master."""
    contact = contact_form(mesh, friction=0.5)
    contact.Commit(state(contact, (0.0, 0.0), -0.1))  # 0.1 open
    contact.Commit(state(contact, (0.05, -0.02), -0.06))  # 0.06 open, by 0.04 nearer
    touch = np.array([0.05, -0.02]) * (1 + 0.06 / 0.04)
    assert slip(contact, state(contact, touch, 0.0, pressure=1)) == pytest.approx(0, abs=1e-13)
    later = state(contact, touch + np.array([0.02, 0.01]), 0.0, pressure=1)
    assert slip(contact, later) == pytest.approx(every(contact, (0.02, 0.01)), abs=1e-12)


def test_a_grazing_path_counts_from_the_commit_in_3d(mesh):
    contact = contact_form(mesh, friction=0.5)
    contact.Commit(state(contact, (0, 0), -0.1))
    contact.Commit(state(contact, (0.3, 0.4), -0.09))
    later = state(contact, (0.4, 0.4), 0.0, pressure=1.0)
    assert slip(contact, later) == pytest.approx(every(contact, (0.1, 0)), abs=1e-12)


def test_update_starts_the_history_anew_in_3d(mesh):
    contact = contact_form(mesh, friction=0.5)
    contact.Commit(state(contact, (0.3, 0.1), 0.0, pressure=1.0))
    gf = state(contact, (0.05, -0.03), 0.0, pressure=1.0)
    contact.Update(gf)
    contact.form.SetConstant(C)
    assert slip(contact, gf) == pytest.approx(0, abs=1e-14)
    moved_on = state(contact, (0.07, -0.03), 0, pressure=1)
    assert slip(contact, moved_on) == pytest.approx(every(contact, (0.02, 0)), abs=1e-12)


def test_restore_goes_back_to_the_commit(mesh):
    contact = contact_form(mesh, friction=0.5)
    contact.Commit(state(contact, (0.1, 0.2), 0.01, pressure=2.0, shear=(0.1, 0.3)))
    before = {name: values.copy() for name, values in contact.Table().items()}
    contact.Evaluate(state(contact, (0.5, 0.5), -0.7))
    assert set(contact.Table()["status"]) == {0}
    contact.Restore()
    for name, values in contact.Table().items():
        assert np.array_equal(values, before[name]), name
    assert np.array_equal(contact.slip.vec.FV().NumPy(), before["slip"].ravel())


def test_evaluate_fills_the_fields_in_3d(mesh):
    contact = contact_form(mesh, friction=0.5)
    contact.Evaluate(state(contact, (0.1, -0.1), 0.03, pressure=4.0, shear=(1.0, -2.0)))
    table = contact.Table()
    paired = table["area"] > 0
    assert table["pressure"] == pytest.approx(4, rel=1e-13)
    assert table["gap"][paired] == pytest.approx(-0.03, rel=1e-11)
    expected = np.tile(-4 * N + T1 - 2 * T2, (len(paired), 1))
    assert table["traction"] == pytest.approx(expected, abs=1e-13)
    assert table["friction"] == pytest.approx(0.5)
    assert set(table["status"][~paired]) <= {0}
    for name in ("pressure", "gap", "status"):
        assert np.array_equal(getattr(contact, name).vec.FV().NumPy(), table[name]), name
    for name in ("traction", "slip", "normal"):
        assert np.array_equal(getattr(contact, name).vec.FV().NumPy(), table[name].ravel()), name


@pytest.mark.parametrize(
    ("friction", "expected"), [(0.0, 2), (None, 2), (0.21, 2), (0.23, 1), (10, 1)]
)
def test_status_follows_the_disc(mesh, friction, expected):
    """Trial pressure 2 + C/10 = 2.3, trial shear 0.5 in any direction: a disc, not a square."""
    contact = contact_form(mesh, friction=friction)
    for angle in np.radians([0, 45, 100, 200, 330]):
        shear = 0.5 * np.array([np.cos(angle), np.sin(angle)])
        contact.Evaluate(state(contact, (0, 0), 0.1, pressure=2.0, shear=shear))
        table = contact.Table()
        assert set(table["status"][table["area"] > 0]) == {expected}
    contact.Evaluate(state(contact, (0, 0), -0.7, pressure=2.0))  # 2 - 0.7 C < 0
    assert set(contact.Table()["status"]) == {0}


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
def test_bound_of_the_tangential_traction_in_3d(mesh, law, bound):
    """Trial pressure 2 + 0.1 C = 2.3; the trial shear keeps its direction."""
    contact = contact_form(mesh, **law)
    for shear in ((4.0, 0), (-3.0, 2.0), (0.5 * bound, -0.6 * bound)):
        gf = state(contact, (0, 0), 0.1, pressure=2.0, shear=shear)
        rows = residual(contact, gf.vec.FV().NumPy())[contact.form.MultiplierDofs()]
        table = contact.Table()
        paired = table["area"] > 0
        projected = rows.reshape(-1, 3)[paired] * C / table["area"][paired, None]
        projected += -2 * N + np.asarray(shear) @ T
        size = np.hypot(*shear)
        limited = np.asarray(shear) * (min(1.0, bound / size) if size else 0.0)
        assert projected == pytest.approx(every(contact, -2.3 * N + limited @ T), abs=1e-11)


def test_friction_and_tresca_depend_on_the_position(mesh):
    """The mean over the whole of each macro-element, which is the value at its centroid."""
    contact = contact_form(mesh, friction=6 + x - 2 * y + 0.5 * z)
    table = contact.Table()
    inside = np.isclose(table["area"], table["fullarea"], rtol=1e-12)
    expected = 6 + table["x"] @ [1, -2, 0.5]
    assert np.any(inside)
    assert table["friction"][inside] == pytest.approx(expected[inside], rel=1e-12)


def test_force_and_moment_in_3d(mesh):
    contact = contact_form(mesh)
    rng = np.random.default_rng(0)
    gf = GridFunction(contact.form.fes)
    tractions = rng.normal(size=(contact.space.nmacros, 3))
    with_traction(contact, gf, tractions)
    contact.Evaluate(gf)
    table, force = contact.Table(), contact.Force()
    assert force == pytest.approx(table["area"] @ tractions, rel=1e-13)
    point = np.array([0.3, -2.0, 1.0])
    change = contact.Moment(point) - contact.Moment((0, 0, 0))
    assert change == pytest.approx(-np.cross(point, force), rel=1e-10)


def test_forces_on_both_sides_cancel(mesh):
    """T21: the nodal forces add up to nothing; moments to what the gap times the force gives."""
    contact = contact_form(mesh)
    rng = np.random.default_rng(1)
    gf = with_traction(
        contact, GridFunction(contact.form.fes), rng.normal(size=(contact.space.nmacros, 3))
    )
    contact.Evaluate(gf)
    forces = vector(contact, residual(contact, gf.vec.FV().NumPy()))
    size = np.abs(contact.Table()["traction"]).max()

    def work(field, where=("upper", "lower")):
        gf = GridFunction(contact.form.fes)
        both = {body: CF(field) if body in where else CF((0, 0, 0)) for body in ("upper", "lower")}
        gf.components[0].Set(contact.mesh.MaterialCF(both))
        return forces.InnerProduct(gf.vec)

    turns = [(0, -z, y), (z, 0, -x), (-y, x, 0)]
    moment = contact.Moment((0, 0, 0))
    for k in range(3):
        unit = tuple(np.eye(3)[k])
        assert abs(work(unit)) <= 1e-12 * size
        assert -work(unit, ["upper"]) == pytest.approx(contact.Force()[k], abs=1e-12 * size)
        assert abs(work(turns[k])) <= 1e-12 * size  # the surfaces coincide: no gap
        assert -work(turns[k], ["upper"]) == pytest.approx(moment[k], abs=1e-12 * size)


@pytest.mark.parametrize("gap", [0.01, 0.1])
def test_moment_of_both_sides_is_that_of_the_gap(mesh, gap):
    """Across an open gap the forces do not share a line: moment gap times force, no more."""
    contact = contact_form(mesh)
    away = moved(contact, upper=tuple(-gap * N))
    contact.Update(away)
    contact.form.SetConstant(C)
    gf = with_traction(contact, GridFunction(contact.form.fes), -2.0 * N + 1.0 * T1)
    gf.components[0].vec.data = away.components[0].vec
    contact.Evaluate(gf)
    forces = vector(contact, residual(contact, gf.vec.FV().NumPy()))
    force, shape = contact.Force(), GridFunction(contact.form.fes)
    lifted = contact.mesh.MaterialCF({"upper": CF(tuple(-gap * N)), "lower": CF((0, 0, 0))})
    r = [c + lifted[k] for k, c in enumerate((x, y, z))]
    turns = [(0, -r[2], r[1]), (r[2], 0, -r[0]), (-r[1], r[0], 0)]
    total = []
    for turn in turns:
        shape.components[0].Set(CF(turn))
        total.append(-forces.InnerProduct(shape.vec))
    # The slave lies at -gap N from where the master takes the opposite force.
    assert total == pytest.approx(np.cross(-gap * N, force), abs=1e-12)
    assert np.linalg.norm(total) == pytest.approx(gap * np.linalg.norm(force @ T.T), rel=1e-10)
