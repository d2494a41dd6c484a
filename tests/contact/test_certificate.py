"""What `Check()` says of a solution: conditions at points, and contact that is not resolved."""

import pickle

import numpy as np
import pytest
from netgen.occ import Box, Circle, MoveTo, Sphere
from ngsolve import CF, x
from press import press
from pressed import body, meshed, pressed

from ngslac.contact.neighbours import Neighbours


def below(dim, h, size=1.0):
    shape = (
        MoveTo(-size, -1).Rectangle(2 * size, 1).Face()
        if dim == 2
        else Box((-size, -size, -1), (size, size, 0))
    )
    return body(shape, dim, "low", h, lambda at: at[-1] > -1e-9, "below")


def disc(h):
    shape = MoveTo(-0.5, 0).Rectangle(1, 1).Face() * Circle((0, 1), 1).Face()
    low = lambda at: at[1] < 0.5 and abs(at[0]) < 0.45  # noqa: E731
    return body(shape, 2, "up", h, low, "above")


def block(dim, h, aside=0.0):
    shape = (
        MoveTo(aside - 0.5, 0).Rectangle(1, 0.6).Face()
        if dim == 2
        else Box((aside - 0.5, -0.5, 0), (aside + 0.5, 0.5, 0.6))
    )
    return body(shape, dim, "up", h, lambda at: at[-1] < 1e-9, "above")


def words(report):
    return str(report)


def test_before_a_solution_there_is_no_certificate():
    report = press().contact
    report.Update()
    report = report.Check()
    assert report.certificate is None
    assert "at points" not in words(report)
    assert not len(report.narrow)


@pytest.mark.full
@pytest.mark.parametrize("finite", [False, True])
def test_penetration_at_points_falls_with_the_mesh(finite):
    found = []
    for h in (0.1, 0.05, 0.025):
        mesh = meshed(2, below(2, 0.8 * h), disc(h), curve=2)
        report = pressed(mesh, 0.03, finite=finite).contact.Check()
        excess = report.certificate.penetration
        assert excess.relative < 0.1
        assert abs(excess.place[0]) < 0.4
        assert report.certificate.tension is None
        assert report.certificate.friction is None
        assert "tension none" in words(report)
        found.append(excess.value)
    assert found[2] < found[1] < found[0]


@pytest.mark.parametrize("finite", [False, True])
@pytest.mark.parametrize("dim", [2, 3])
def test_flat_contact_has_nothing_left(dim, finite):
    h = {2: 0.1, 3: 0.2}[dim]
    mesh = meshed(dim, below(dim, 0.8 * h), block(dim, h))
    report = pressed(mesh, 0.01, finite=finite, order=1 + (dim == 2)).contact.Check()
    excess = report.certificate.penetration
    assert excess is None or excess.relative < 0.02
    for line in ("not resolved", "half outside"):
        assert line not in words(report)


def test_tension_where_contact_cannot_open():
    mesh = meshed(2, below(2, 0.2), block(2, 0.15))
    for law in ({"tied": True}, {"bilateral": True}):
        report = pressed(mesh, -0.01, **law).contact.Check()
        tension = report.certificate.tension
        assert 0.1 < tension.relative <= 1
        assert tension.value > 0
        assert abs(tension.place[1]) < 1e-9
    assert pickle.loads(pickle.dumps(tension)) is not tension
    assert "penetration none" in words(pressed(mesh, -0.01, tied=True).contact.Check())


@pytest.mark.parametrize("law", ["friction", "tresca"])
def test_friction_above_a_bound_that_varies(law):
    """In the mean nowhere, at points where it is less than in the mean."""
    mesh = meshed(2, below(2, 0.15), block(2, 0.2))
    bound = (0.2 + 0.15 * x) * (1 if law == "friction" else 0.1)
    even = pressed(mesh, 0.02, **{law: CF(0.1) if law == "friction" else CF(0.01)}).contact.Check()
    assert even.certificate.friction is None
    contact = pressed(mesh, 0.02, **{law: bound}).contact
    table = contact.Table()
    assert np.any(table["status"] == 2)
    excess = contact.Check().certificate.friction
    largest = np.linalg.norm(table["traction"], axis=1).max()
    assert 0 < excess.relative < 0.1
    assert excess.value == pytest.approx(excess.relative * largest)
    # The bound changes by half of this over half of a macro-element.
    steepest = 0.15 * (table["pressure"].max() if law == "friction" else 0.1)
    assert excess.value <= 0.51 * steepest * contact.Check().macro_size[1]


@pytest.mark.parametrize(("slave", "master"), [("up", "low"), ("low", "up")])
def test_one_macro_element_is_not_enough(slave, master):
    mesh = meshed(2, below(2, 0.4), disc(0.4), curve=2)
    report = pressed(mesh, 0.02, slave=slave, master=master).contact.Check()
    closed = pressed(mesh, 0.02, slave=slave, master=master).contact.Table()["status"] > 0
    assert (len(report.narrow) == 1) == (closed.sum() == 1)
    fine = meshed(2, below(2, 0.05), disc(0.05), curve=2)
    report = pressed(fine, 0.02, slave=slave, master=master).contact.Check()
    assert "not resolved" not in words(report)


@pytest.mark.parametrize(("h", "narrow"), [(0.15, True), (0.06, False)])
def test_a_ball(h, narrow):
    shape = Sphere((0, 0, 1), 1) * Box((-0.5, -0.5, 0), (0.5, 0.5, 0.5))
    low = lambda at: at[2] < 0.3 and np.hypot(*at[:2]) < 0.3  # noqa: E731
    base = body(
        Box((-0.5, -0.5, -0.4), (0.5, 0.5, 0)),
        3,
        "low",
        2 * h if h < 0.1 else h,
        lambda at: at[-1] > -1e-9,
        "below",
    )
    up = body(shape, 3, "up", max(h, 0.2), low, "above")
    for face in up.faces:
        if face.name == "up_contact":
            face.maxh = h
    report = pressed(meshed(3, base, up), 0.03, order=1).contact.Check()
    assert ("not resolved" in words(report)) == narrow


def grid(nx, ny):
    """The macro-elements of a slave surface of nx times ny squares, by hand."""
    from scipy.sparse import csr_matrix

    found = Neighbours.__new__(Neighbours)
    corner = lambda i, j: i * (ny + 1) + j  # noqa: E731
    touches = np.zeros((nx * ny, (nx + 1) * (ny + 1)))
    for i, j in np.ndindex(nx, ny):
        for a, b in np.ndindex(2, 2):
            touches[i * ny + j, corner(i + a, j + b)] = 1
    found.dim, found._touches = 3, csr_matrix(touches)
    return found


@pytest.mark.parametrize(
    ("closed", "narrow"),
    [
        (["....", ".x..", "....", "...."], 1),
        (["....", ".xx.", ".xx.", "...."], 0),
        (["xx..", "xx..", "....", "...x"], 1),
        (["xxxx", "....", "....", "...."], 4),  # along an edge
        (["....", "xxxx", "....", "...."], 4),
        (["xxxx", "x..x", "x..x", "xxxx"], 12),  # a ring
        (["xxxx", "xxxx", "xxxx", "xxxx"], 0),
        (["xxx.", "xxx.", "..xx", "..x."], 0),  # it has a tail
        (["xxxxxx"], 0),  # no wider surface
        (["..x..."], 1),
    ],
)
def test_patches(closed, narrow):
    closed = np.array([[c == "x" for c in row] for row in closed])
    found = grid(*closed.shape).Narrow(closed.ravel())
    assert len(found) == narrow
    assert np.all(closed.ravel()[found])


def test_what_hangs_over_the_end():
    mesh = meshed(2, below(2, 0.3, size=0.55), block(2, 0.5, aside=0.4))
    contact = pressed(mesh, 0.02).contact
    report, table = contact.Check(), contact.Table()
    share = table["area"] / table["fullarea"]
    assert list(report.outside) == list(np.flatnonzero((table["status"] > 0) & (share < 0.5)))
    assert ("half outside" in words(report)) == (len(report.outside) > 0)
    assert len(report.outside) == 1
