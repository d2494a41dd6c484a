# SPDX-License-Identifier: LGPL-2.1-or-later
"""What is told to lie too deep in the master is inside of it, and leads out along the normal."""

import re

import numpy as np
import pytest
from netgen.occ import Axis, Circle, Compound, MoveTo, OCCGeometry, Pnt, Vec, X, Y, Z
from ngsolve import Mesh, VectorH1

from ngslac import LACContact, LACSpace

UPPER, LOWER = "slave|up_side|up_far", "master|low_side|low_far"


def block(dim, low, high, slope=0.0, aside=0.0):
    """Its lower side falls by `slope` along x; in 3D as deep as 1, and more on both sides."""
    (x0, y0), (x1, y1) = low, high
    corners = (x1, y0 - slope), (x1, y1), (x0, y1)
    face = MoveTo(x0, y0)
    for corner in corners:
        face = face.LineTo(*corner)
    face = face.Close().Face()
    if dim == 2:
        return face
    return upright(face, aside)


def upright(face, aside=0.0):
    face = face.Rotate(Axis((0, 0, 0), X), 90).Move(Vec(0, -aside, 0))
    return face.Extrude(Vec(0, 1 + 2 * aside, 0))


def named(body, dim, prefix, contact, up, at):
    """`contact`: name of the side at a point; the opposite one is the far one."""
    parts = body.edges if dim == 2 else body.faces
    parts.name = f"{prefix}_side"
    axis = Y if dim == 2 else Z
    far = parts.Max(axis) if up else parts.Min(axis)
    far.name = f"{prefix}_far"
    parts.Nearest(Pnt(*(at if dim == 2 else (at[0], 0.5, at[1])), *[0] * (dim == 2))).name = contact
    return body


def pair(dim, upper, lower, h):
    """Of two blocks, with their contact sides at these points."""
    (up, up_at), (low, low_at) = upper, lower
    up, low = (
        named(up, dim, "up", "slave", True, up_at),
        named(low, dim, "low", "master", False, low_at),
    )
    up.maxh, low.maxh = h, 1.3 * h
    return Mesh(OCCGeometry(Compound([up, low]), dim=dim).GenerateMesh())


def contact_on(mesh, slave="slave", master="master", order=2, **options):
    V = VectorH1(mesh, order=order)
    contact = LACContact(*(V * LACSpace(V, slave=slave)).TrialFunction(), master=master, **options)
    contact.Update()
    return contact


@pytest.mark.pairwise
@pytest.mark.parametrize("dim", [2, 3])
@pytest.mark.parametrize("finite", [False, True])
@pytest.mark.parametrize(
    ("slave", "master"), [("slave", "master"), (UPPER, "master"), ("slave", LOWER), (UPPER, LOWER)]
)
@pytest.mark.parametrize("height", [0.5, 0.05])
def test_a_half_that_is_too_deep(height, slave, master, finite, dim):
    """The overlap goes from 0 to 0.3; also of a plate that is thinner than this."""
    upper = block(dim, (0, 0), (1, height), 0.3)
    if height < 0.1:
        upper = (
            MoveTo(0, 0).LineTo(1, -0.3).LineTo(1, height - 0.3).LineTo(0, height).Close().Face()
        )
        if dim == 3:
            upper = upright(upper)
    lower = block(dim, (-0.5, -1), (1.5, 0), aside=0.5)
    mesh = pair(dim, (upper, (0.5, -0.15)), (lower, (0.5, 0)), 0.2 if dim == 2 else 0.3)
    contact = contact_on(mesh, slave, master, finite=finite, penetration=0.1)
    depths, table = contact.form.Overlaps(), contact.Table()
    deep = depths > 0
    assert 0.12 < depths.max() < 0.32
    assert np.all(table["area"][deep] < (1 - 1e-6) * table["fullarea"][deep])
    x = table["x"][:, 0]
    below = table["normal"][:, -1] < -0.5
    assert np.all(deep[below & (x > 0.6)])
    assert not np.any(deep[x < (0.2 if dim == 2 else 0.1)])
    # The way out is against the normal: what lies on a side would be pushed along the master.
    assert np.all(np.abs(table["normal"][deep, 0]) < 0.5)


@pytest.mark.parametrize("dim", [2, 3])
@pytest.mark.parametrize("finite", [False, True])
@pytest.mark.parametrize("case", ["over the end", "thin plate", "above", "wide", "underside"])
def test_what_is_not_too_deep(case, finite, dim):
    """All sides of both blocks are slave and master, bodies overlap a little, or not at all."""
    place, master = {
        "over the end": (((0.5, -0.02), (1.5, 0.5)), LOWER),
        "thin plate": (((0.1, -0.01), (0.9, 0.04)), LOWER),
        "above": (((0.1, 0.2), (0.9, 0.7)), LOWER),
        "wide": (((-1, -0.02), (2, 0.5)), LOWER),
        "underside": (((0.5, 0.0), (1.5, 0.5)), "low_far|low_side"),
    }[case]
    upper, lower = block(dim, *place), block(dim, (0, -1), (1, 0))
    at = (0.5 * (place[0][0] + place[1][0]), place[0][1])
    mesh = pair(dim, (upper, at), (lower, (0.5, 0)), 0.4)
    try:
        contact = contact_on(mesh, UPPER, master, finite=finite)
    except Exception as error:
        assert case == "underside"
        assert "overlap" not in str(error)  # noqa: PT017
        return
    assert not np.any(contact.form.Overlaps())
    assert "deep overlap" not in str(contact.Check())


def sides_of(shape, name, h):
    """All of its sides are one boundary."""
    shape.edges.name, shape.faces.name = name, name + "_body"
    shape.maxh = h
    return shape


def mesh_of(*shapes):
    return Mesh(OCCGeometry(Compound(shapes), dim=2).GenerateMesh())


def angle_iron(at):
    """Its outline turns inwards."""
    x, y = at
    face = MoveTo(x, y).LineTo(x + 1, y).LineTo(x + 1, y + 0.3).LineTo(x + 0.3, y + 0.3)
    return face.LineTo(x + 0.3, y + 1).LineTo(x, y + 1).Close().Face()


ALL_SIDES = {
    "block": lambda down: MoveTo(0.2, -down).Rectangle(1, 2.5).Face(),
    "plate": lambda down: MoveTo(0.2, -down).Rectangle(1.5, 0.06).Face(),
    "upright plate": lambda down: MoveTo(0.9, -down).Rectangle(0.06, 1.5).Face(),
    "angle": lambda down: angle_iron((0.4, -down)),
    "disc": lambda down: Circle((1, 0.4 - down), 0.4).Face(),
}


@pytest.mark.parametrize("finite", [False, True])
@pytest.mark.parametrize("shape", ALL_SIDES)
@pytest.mark.parametrize("down", [-0.2, 0.0, 0.03])
def test_no_advice_for_the_far_side(shape, down, finite):
    """All sides of both bodies are of contact, and they overlap by less than is seen."""
    upper = sides_of(ALL_SIDES[shape](down), "slave", 0.2)
    lower = sides_of(MoveTo(0, -1).Rectangle(2, 1).Face(), "master", 0.25)
    report = contact_on(mesh_of(upper, lower), finite=finite).Check()
    assert "penetration =" not in str(report)


@pytest.mark.parametrize("finite", [False, True])
@pytest.mark.parametrize("shape", ["block", "angle", "disc"])
def test_the_advice_is_as_deep_as_the_overlap(shape, finite):
    upper = sides_of(ALL_SIDES[shape](0.25), "slave", 0.1)
    lower = sides_of(MoveTo(0, -1).Rectangle(2, 1).Face(), "master", 0.12)
    try:
        said = str(contact_on(mesh_of(upper, lower), finite=finite, penetration=0.1).Check())
    except Exception as error:  # of which nothing is seen at all
        said = str(error)
    (advised,) = re.findall(r"penetration = ([\d.]+\d),? (?:to have|or move)", said)
    assert 0.2 < float(advised) < 0.4
