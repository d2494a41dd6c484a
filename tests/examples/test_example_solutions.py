"""What the examples compute, beyond the numbers that they print, and the meshes of their own."""

import belt
import bouncing
import carter
import flatring
import hertz3d
import hertz_large
import ironing
import numpy as np
import patch3d
import pytest
import twistblocks
from ngsolve import BND, CF, Integrate
from patch3d import Case, Cases, Run, Solve
from published import DECK, DECK_SMOOTH, PUBLISHED, TIMES

from ngslac.meshes.geometry import CheckNonMatching

approx = pytest.approx


def Nodes(mesh, region):
    """First coordinates of the vertices of a boundary."""
    elements = mesh.Boundaries(region).Elements()
    return np.array([mesh.vertices[v.nr].point[0] for el in elements for v in el.vertices])


# --- the bouncing ring ---------------------------------------------------------------------------

COARSE = {"h": 0.25, "dt": 0.04, "end": 1.6, "gravity": 0.0}


@pytest.mark.full
def test_bouncing_with_slip_all_the_time():
    figures = bouncing.Run(**COARSE, friction=0.2, velocity=(2.0, -1.0))
    assert 0.5 < figures["restitution"] < 1.0
    assert figures["contact_end"] < 1.4
    assert figures["cuts"] == 0
    assert figures["friction_ratio"] == approx(0.2, rel=0.06)  # 0.198 on a finer mesh
    assert figures["spin_ratio"] == approx(0.88, abs=0.06)  # its arm is less than the radius
    assert figures["spin"] < -0.2  # it begins to roll
    assert figures["flight_speed_drift"] < 1e-9
    assert figures["flight_spin_drift"] < 2e-2
    start = figures["energy_start"]
    gone = figures["friction"] + figures["impact"] + figures["algorithmic"]
    assert figures["friction"] > 0
    assert figures["energy_end"] + gone == approx(start, rel=1e-10)
    assert figures["largest_gain"] < 1e-3 * start
    assert figures["largest_contact_gain"] < 1e-12
    assert abs(figures["algorithmic"]) < 0.01 * start
    assert 0 < figures["impact"] < 0.1 * start


def test_bouncing_without_friction():
    options = COARSE | {"end": 0.5, "gravity": 0.5}
    figures = bouncing.Run(**options, friction=0.0, velocity=(0.5, -1.0))
    # The normals are those of the ring, whose faces are not quite parallel to the ground.
    assert abs(figures["friction_ratio"]) < 0.02
    assert figures["largest_contact_gain"] < 5e-4 * figures["energy_start"]
    assert figures["friction"] == approx(0, abs=1e-12)


# --- the belt ------------------------------------------------------------------------------------


def test_only_the_inner_side_of_the_belt_is_slave():
    mesh = belt.BeltMesh(180, 0.02, 0.05)
    lengths = [Integrate(CF(1), mesh.Boundaries(name)) for name in ("drum", "free")]
    inner, outer = np.pi * belt.RADIUS + 2 * belt.TAIL, np.pi * (belt.RADIUS + 0.02)
    assert lengths == approx([inner, outer + 2 * belt.TAIL], rel=1e-4)


# --- Carter's rollers ----------------------------------------------------------------------------


@pytest.mark.full
@pytest.mark.parametrize("start", [0.7, 1.2])
def test_rolling_forgets_how_it_began(start):
    """The law of creep holds while the tangential force is still on its way."""
    figures = carter.Run(shares=(0.5,), h=0.25, start=start)
    assert abs(figures["share"][0] - 0.5) > 0.05
    assert figures["share"] == approx(figures["share_exact"], abs=0.03)
    exact = np.sqrt(1 - figures["share_exact"][0])
    assert figures["stick"][0] == approx(exact, abs=0.125)  # one macro-element


# --- the flat ring -------------------------------------------------------------------------------


def Pressed(h, quarter):
    return {name: np.array(values) for name, values in flatring.Run(h, quarter=quarter).items()}


@pytest.mark.full
def test_the_flat_ring_touches_itself_as_a_plane():
    itself, plane = Pressed(0.12, False), Pressed(0.12, True)
    assert itself["converged_steps"] == 38
    assert itself["cuts"].sum() == 0
    assert itself["iterations"].max() <= 17
    assert itself["iterations"].sum() <= 200
    assert np.all(np.diff(itself["force"]) > 0)
    assert itself["force_below"] == approx(itself["force"], rel=1e-9)
    # It does not touch before the end, then that carries most of the force.
    assert np.all(itself["closed_inside"][:-1] == 0)
    assert itself["closed_inside"][-1] >= 8
    assert 0.75 < itself["force_inside"][-1] / itself["force"][-1] < 0.95
    before = itself["travel"] < 1.6
    assert itself["force"][before] == approx(plane["force"][before], rel=3e-3)
    assert itself["force"][-1] == approx(plane["force"][-1], rel=0.1)


@pytest.mark.full
def test_the_flat_ring_comes_nearer_to_the_plane_on_a_finer_mesh():
    itself, plane = Pressed(0.06, False), Pressed(0.06, True)
    assert itself["force"][-1] == approx(plane["force"][-1], rel=0.03)


# --- ironing -------------------------------------------------------------------------------------

IRON = {"h": 0.4, "steps": 36, "stroke": 5.0}


def Forces(figures, time):
    """Vertical and horizontal force at a time."""
    names = ("vertical_force", "horizontal_force")
    return [np.interp(time, figures["time"], figures[name]) for name in names]


@pytest.fixture(scope="module")
def figures():
    return ironing.Run(**IRON)


def test_every_step_of_ironing_converges(figures):
    assert len(figures["time"]) == 36
    assert figures["failure"] is None
    assert sum(figures["cuts"]) == 0
    assert figures["time"][-1] == approx(1.5, abs=1e-12)
    assert max(figures["iterations"]) <= 12
    assert figures["quadratic"]
    assert figures["time"][0] < ironing.CLEARANCE  # no force before the contact
    assert figures["vertical_force"][0] == figures["horizontal_force"][0] == 0


def test_forces_of_ironing_are_the_published_ones(figures):
    vertical, horizontal = PUBLISHED["code_aster 2020"]
    for time in (0.6, 1.0, 1.5):
        assert Forces(figures, time)[0] == approx(vertical[TIMES.index(time)], rel=0.03)
    for time, tolerance in ((1.0, 0.05), (1.5, 0.12)):
        published = horizontal[TIMES.index(time)]
        assert Forces(figures, time)[1] == approx(published, rel=tolerance)
    for time, (down, aside) in DECK.items():
        assert Forces(figures, time)[0] == approx(down, rel=0.012)
        assert Forces(figures, time)[1] == approx(aside, rel=0.025)
    # The die also ploughs: the ratio is above the coefficient of friction.
    down, aside = Forces(figures, 1.5)
    published = [h[TIMES.index(1.5)] / v[TIMES.index(1.5)] for v, h in PUBLISHED.values()]
    assert min(published) <= aside / down <= max(published)


@pytest.mark.full
def test_ironing_without_friction():
    figures = ironing.Run(**IRON, friction=0.0)
    assert len(figures["time"]) == 36
    assert figures["failure"] is None
    assert figures["quadratic"]
    for time, published in DECK_SMOOTH.items():
        assert Forces(figures, time)[0] == approx(published, rel=0.02)
    vertical, horizontal = Forces(figures, 1.5)
    assert vertical == approx(421, rel=0.01)  # h = 0.4 and 0.3 agree
    assert abs(horizontal) < 0.01 * vertical  # nothing holds the die in the middle


def test_ironing_mesh():
    mesh = ironing.IroningMesh(0.3)
    assert set(mesh.GetMaterials()) == {"die", "slab"}
    assert Integrate(1, mesh) == approx(48 + 1.2 * 0.9 + 0.2516, abs=1e-4)
    assert np.abs(Nodes(mesh, "foot")[:, None] - Nodes(mesh, "master")).min() > 1e-3
    sizes = np.array(Integrate(1, mesh, BND, element_wise=True))
    names = [el.mat for el in mesh.Elements(BND)]
    assert sizes[[name == "master" for name in names]] == approx(0.3, abs=1e-6)


@pytest.mark.parametrize(
    ("residuals", "quadratic"),
    [
        ((1e-1, 1e-2, 1e-4, 1e-8, 1e-14), True),
        ((1e-1, 3e-2, 3e-3, 2e-6, 3e-11), True),
        ((1e-1, 2e-8, 8e-12), True),
        ((1e-1, 9e-5, 2e-10, 3e-13), True),
        ((0.5, 1e-12), True),
        ((), True),
        ((1e-2, 1e-4, 1e-6, 1e-8, 9e-11), False),
        ((1e-6, 1e-8, 1e-10, 1e-12), False),
        ((1e-1, 1e-2, 5e-8, 2e-9, 9e-11), False),
        ((1e-3, 2.7e-4, 7e-5, 2e-5, 5e-6), False),
    ],
)
def test_order_of_convergence(residuals, quadratic):
    assert ironing.Quadratic(residuals) is quadratic


# --- Hertz, blocks -------------------------------------------------------------------------------


def test_hertz3d_with_friction():
    _, contact, _ = hertz3d.Run("cylinder", h=1.25, friction=0.1)["solution"]
    assert contact.Table()["friction"] == approx(0.1)


def test_flattened_cylinder():
    """Hertz' force inverts the approach; the mesh is round."""
    for force in (1e-4, 1e-2, 0.3):
        approach = hertz_large.Approach(force, 0.3)
        assert hertz_large.HertzForce(approach, 0.3) == approx(force, rel=1e-10)
    assert Integrate(CF(1), hertz_large.CylinderMesh(0.1)) == approx(np.pi / 4, rel=1e-6)


def test_twist_mesh():
    mesh = twistblocks.TwistMesh(4)
    assert set(mesh.GetMaterials()) == {"upper", "lower"}
    areas = {"upper_bottom": 1.0, "upper_top": 1.0, "lower_top": 1.6**2, "lower_bottom": 1.6**2}
    for name, area in areas.items():
        found = Integrate(1, mesh, BND, definedon=mesh.Boundaries(name))
        assert found == approx(area, abs=1e-12)
    CheckNonMatching(mesh, slave="upper_bottom", master="lower_top")


def test_patches_are_of_all_kinds():
    """Every element and order with every partition, flat and oblique."""
    names = {case.name for case in Cases()}
    assert len(names) == len(Cases()) == 11 * 3 * 2
    some = {"P3 tet split oblique", "P2 prism_side agglomerated flat", "Q2 hex bubble flat"}
    assert names > some


@pytest.mark.parametrize("oblique", [False, True])
def test_friction_carries_the_shear_of_a_patch(oblique):
    case = Case("prism", 1, "bubble", oblique, friction=0.4)
    _, contact, figures = Solve(case)
    table = contact.Table()
    assert set(table["status"]) == {1}
    assert table["traction"] @ case.axes[:, 0] == approx(0.2 * table["pressure"])
    assert figures["multiplier_error"] < 1e-11


def test_a_wrong_load_of_a_patch_shows(monkeypatch):
    right = patch3d.Load
    monkeypatch.setattr(patch3d, "Load", lambda *args: 1.1 * right(*args))
    _, _, figures = Solve(Case("hex", 1, "bubble"))
    assert min(figures["stress_error"], figures["multiplier_error"]) > 1e-3


def test_patches_refuse():
    with pytest.raises(ValueError, match="partition must be one of"):
        Solve(Case("tet", 1, "none"))
    with pytest.raises(ValueError, match="kind must be one of tet"):
        Run(cases=[Case("brick")])
