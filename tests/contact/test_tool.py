"""The form of a contact with a rigid tool: derivative, invariance, slip, what is refused."""

import numpy as np
import pytest
from blocks import C
from bricks import brick
from form import Form, rotation
from netgen.meshing import NgException
from ngsolve import CF, NumberSpace, Parameter, VectorH1, sin, sqrt, x, y, z

from ngslac import LACContact, LACSpace, tools

AXIS = {2: None, 3: (1, 2, 0.5)}
TOOLS = {
    (2, "disc"): tools.Sphere((0.4, -0.72), 0.7),
    (2, "line"): tools.Plane((0, 0), (0.1, 1)),
    (2, "function"): tools.SignedDistance(
        sqrt((x - 0.4) ** 2 + (y + 0.7) ** 2) - 0.7 + 0.05 * x * y, dim=2
    ),
    (2, "polygon"): tools.Polygon([(-1, -1), (2, -1), (2, 0.02), (0.4, -0.03), (-1, 0.01)]),
    (3, "sphere"): tools.Sphere((0.4, 0.45, -0.72), 0.7),
    (3, "plane"): tools.Plane((0, 0, 0), (0.1, 0.1, 1)),
    (3, "torus"): tools.Torus((0.4, 0.4, -0.33), (0, 0, 1), 0.5, 0.3),
    (3, "cone"): tools.Cone((0.4, 0.45, 0.1), (0, 0.1, -1), 1.3),
}
LAWS = {"frictionless": {}, "coulomb": {"friction": 0.7}, "tresca": {"tresca": 0.6}}


def tool_form(dim, tool, law="coulomb", *, driven=False, order=2, kind=None, n=None):
    """A block over a tool on a path, and its parameter; three numbers may move the tool, too."""
    mesh = brick(kind or ("trig" if dim == 2 else "tet"), n or 5 - dim)
    V, time = VectorH1(mesh, order=order), Parameter(0)
    X = NumberSpace(mesh) * NumberSpace(mesh) * NumberSpace(mesh) * V * LACSpace(V, slave="bottom")
    *numbers, u, lam = X.TrialFunction()
    given = {"center": (0.3, -0.2, 0.1)[:dim], "axis": AXIS[dim]}
    shift = (0.05 * time, 0.1 * time, 0.03 * time)[:dim]
    tool = tool.Moved(shift=shift, angle=0.5 * time, **given)
    if driven:
        travel = (numbers[0], None, numbers[1])[3 - dim :]
        tool = tool.Driven(
            travel=travel, turn=numbers[2], force=(1, 0, 3)[3 - dim :], moment=4, **given
        )
    contact = LACContact(u, lam, obstacle=tool, finite=True, **LAWS[law])
    contact.Update()
    contact.form.SetConstant(C)
    return Form(contact), time


def deformed(form, time):
    """Committed in one configuration with slip in advance, moved on to another; every status."""
    dim, random = form.dim, np.random.default_rng(3)
    bent = (0.03 * sin(3 * x), 0.05 * x * x - 0.02, 0.04 * x * y)[:dim]
    form.u.Set(CF(bent))
    form.values[:] += 0.004 * random.normal(size=len(form.values))
    form.values[form.multipliers] = 0
    form.commit()
    history = form.contact.form.History()
    history["reference"][:] = 0.01 * random.normal(size=len(history["reference"]))
    form.contact.form.SetHistory(history)
    time.Set(0.3)
    form.values[:] += 0.004 * random.normal(size=len(form.values))
    form.follow()
    form.impose(0.7)
    return set(form.table()["status"])


CASES = [(dim, name, "coulomb", True) for dim, name in TOOLS]
CASES += [(d, n, law, False) for d, n in ((2, "disc"), (3, "sphere")) for law in LAWS]


@pytest.mark.parametrize(("dim", "name", "law", "driven"), CASES)
def test_derivative(dim, name, law, driven):
    form, time = tool_form(dim, TOOLS[dim, name], law, driven=driven)
    assert deformed(form, time) == ({0, 2} if law == "frictionless" else {0, 1, 2})
    assert form.derivative_error(30) <= 1e-8


@pytest.mark.parametrize(
    ("dim", "order", "kind", "n"), [(2, 1, "quad", 8), (2, 3, "trig", 3), (3, 1, "hex", 5)]
)
def test_derivative_of_other_elements(dim, order, kind, n):
    tool = TOOLS[dim, "disc" if dim == 2 else "sphere"]
    form, time = tool_form(dim, tool, order=order, kind=kind, n=n)
    assert len(deformed(form, time)) > 1
    assert form.derivative_error(30) <= 1e-8


@pytest.mark.parametrize(("dim", "driven"), [(2, False), (2, True), (3, True)])
def test_newton_matrix_beyond_an_edge(dim, driven):
    """What faces the tool is told anew for each difference."""
    corners = [(-1, -1), (0.51, -1), (0.51, 0.01), (-1, 0.01)]
    punch = tools.Polygon(corners).Grown(0.02)
    if dim == 3:
        punch = tools.Revolved(punch, (0, 0, 0), (0, 0.05, 1))
    form, time = tool_form(dim, punch, driven=driven, order=2, n=None if dim == 2 else 3)
    assert len(deformed(form, time)) > 1
    share = form.table()["area"] / form.table()["fullarea"]
    assert np.any((share > 0.01) & (share < 0.99))
    assert form.derivative_error(30, repaired=True) <= 1e-6


@pytest.mark.parametrize("dim", [2, 3])
def test_tool_and_slave_moved_together(dim):
    """A rotation and a shift of everything: the same gaps, no slip, and forces that turn."""
    R, way = rotation(dim, 40.0), np.array((0.3, -0.2, 0.5))[:dim]
    center = np.array((0.4, 0.45, -0.72))[3 - dim :]
    mesh = brick("trig", 3, 3) if dim == 2 else brick("tet", 2)
    V, time = VectorH1(mesh, order=2), Parameter(0)
    u, lam = (V * LACSpace(V, slave="bottom")).TrialFunction()
    axis = None if dim == 2 else (1.0, -2.0, 0.5)
    ball = tools.Sphere(center, 0.7).Moved(
        shift=tuple(w * time for w in way), angle=np.radians(40) * time, axis=axis
    )
    form = Form(LACContact(u, lam, obstacle=ball, finite=True, friction=0.5))
    form.contact.Update()
    form.contact.form.SetConstant(C)
    form.u.Set(CF((0.01 * y, 0.01 * x * x, 0.02 * x)[:dim]))
    form.commit()
    form.impose(0.5)
    before, force = dict(form.table()), form.contact.Force()
    tractions = form.values[form.multipliers].copy()
    time.Set(1)
    places = CF((x, y, z)[:dim]) + CF((0.01 * y, 0.01 * x * x, 0.02 * x)[:dim])
    turned = CF(tuple(R.ravel()), dims=R.shape) * places + CF(tuple(way))
    form.u.Set(turned - CF((x, y, z)[:dim]))
    form.values[form.multipliers] = tractions @ R.T
    form.follow()
    table = form.table()
    assert table["gap"] == pytest.approx(before["gap"], abs=1e-13)
    assert table["slip"] == pytest.approx(0, abs=1e-13)
    assert table["normal"] == pytest.approx(before["normal"] @ R.T, abs=1e-13)
    assert form.contact.Force() == pytest.approx(R @ force, abs=1e-13)


def roll(angle):
    """A block on a disc that turns below it; its slip."""
    mesh = brick("quad", 8, 2)
    V = VectorH1(mesh, order=1)
    u, lam = (V * LACSpace(V, slave="bottom")).TrialFunction()
    disc = tools.Sphere((0.5, -1), 1).Moved(angle=angle, center=(0.5, -1))
    contact = LACContact(u, lam, obstacle=disc, finite=True, friction=0.5)
    contact.Update()
    return contact


def test_a_roll_that_turns_drags_the_points_that_it_touches():
    angle = Parameter(0)
    form = Form(roll(angle))
    angle.Set(-0.01)
    table = form.table()
    middle = np.argsort(np.abs(table["x"][:, 0] - 0.5))[:2]
    assert table["slip"][middle, 0] == pytest.approx(-0.01, rel=0.02)  # it is curved


def test_an_approach_is_no_slip():
    """Towards an inclined plane along its normal."""
    mesh, normal = brick("quad", 4, 2), np.array((0.6, 0.8))
    V, time = VectorH1(mesh, order=1), Parameter(0)
    u, lam = (V * LACSpace(V, slave="bottom")).TrialFunction()
    plane = tools.Plane(-0.5 * normal, normal).Moved(shift=tuple(n * time for n in normal))
    form = Form(LACContact(u, lam, obstacle=plane, finite=True, friction=0.5))
    form.contact.Update()
    time.Set(0.1)
    assert form.table()["slip"] == pytest.approx(0, abs=1e-15)
    assert np.ptp(form.table()["gap"]) > 0


def test_what_turns_away_from_the_tool_is_not_pushed():
    """All sides of a block inside of a ball: the distance is negative, and nothing faces it."""
    mesh = brick("quad", 4, 2)
    V = VectorH1(mesh, order=1)
    u, lam = (V * LACSpace(V, slave=".*")).TrialFunction()
    ball = tools.Sphere((0.5, 0.5), 5)
    contact = LACContact(u, lam, obstacle=-ball, finite=True)
    contact.Update()
    assert np.all(contact.Table()["area"] > 0)
    with pytest.raises(NgException, match=r"slave looks away from it; .*a minus before a tool"):
        LACContact(u, lam, obstacle=ball, finite=True).Update()


def test_beyond_the_edge_of_a_punch_nothing_touches():
    """A flat punch under a half of the block."""
    mesh = brick("quad", 8, 2)
    V = VectorH1(mesh, order=1)
    u, lam = (V * LACSpace(V, slave="bottom")).TrialFunction()
    punch = tools.Polygon([(-1, -1), (0.5, -1), (0.5, 0), (-1, 0)])
    contact = LACContact(u, lam, obstacle=punch, finite=True)
    contact.Update()
    table = contact.Table()
    assert np.array_equal(table["area"] > 0, table["x"][:, 0] < 0.5)
    assert "facing" not in str(contact.Check())


REFUSED = {
    "small sliding": ({"obstacle": tools.Sphere((0, 0), 1)}, "needs finite=True"),
    "tied": ({"obstacle": tools.Sphere((0, 0), 1), "finite": True, "tied": True}, "cannot be tied"),
    "dimension": ({"obstacle": tools.Sphere((0, 0, 0), 1), "finite": True}, "a tool in 3D"),
    "function": ({"obstacle": CF(1), "finite": True}, "does not depend on the coordinates"),
}


@pytest.mark.parametrize("case", REFUSED)
def test_refused(case):
    given, words = REFUSED[case]
    mesh = brick("quad", 2, 2)
    V = VectorH1(mesh, order=1)
    u, lam = (V * LACSpace(V, slave="bottom")).TrialFunction()
    with pytest.raises(Exception, match=words):
        LACContact(u, lam, **given)


def test_a_function_of_the_coordinates_is_a_tool():
    mesh = brick("quad", 2, 2)
    V, t = VectorH1(mesh, order=1), Parameter(0.25)
    u, lam = (V * LACSpace(V, slave="bottom")).TrialFunction()
    form = Form(LACContact(u, lam, obstacle=y + t + 0 * x, finite=True))
    form.contact.Update()
    assert form.table()["gap"] == pytest.approx(0.25)
    t.Set(0.5)
    assert form.table()["gap"] == pytest.approx(0.5)
