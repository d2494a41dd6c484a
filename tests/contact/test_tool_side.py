# SPDX-License-Identifier: LGPL-2.1-or-later
"""Tools that are turned inside out are told, and those that are only elsewhere are not."""

import pytest
from bricks import brick
from netgen.meshing import NgException
from ngsolve import VectorH1, sqrt, x, y, z

from ngslac import LACContact, LACSpace, tools

# Of a slave on the lower side of the unit square or cube: the right tool, and the wrong one.
FLAT = {
    "line": (tools.Plane((0, 0.02), (0, 1)), tools.Plane((0, 0.02), (0, -1))),
    "line below": (tools.Plane((0, -5), (0, 1)), tools.Plane((0, -5), (0, -1))),
    "open polygon": tuple(
        tools.Polygon(corners, closed=False) for corners in ([(5, 0), (-5, 0)], [(-5, 0), (5, 0)])
    ),
    "disc": (tools.Sphere((0.5, -1), 1), -tools.Sphere((0.5, -1), 1)),
    "hollow": (-tools.Sphere((0.5, 0.5), 3), tools.Sphere((0.5, 0.5), 3)),
    "function": tuple(
        tools.SignedDistance(sign * (sqrt(x * x + (y + 1) ** 2) - 1), dim=2) for sign in (1, -1)
    ),
}
SOLID = {
    "plane": (tools.Plane((0, 0, 0.02), (0, 0, 1)), tools.Plane((0, 0, 0.02), (0, 0, -1))),
    "ball": (tools.Sphere((0.5, 0.5, -2), 2), -tools.Sphere((0.5, 0.5, -2), 2)),
    "cylinder": (
        tools.Cylinder((0, 0.5, -3), (1, 0, 0), 3),
        -tools.Cylinder((0, 0.5, -3), (1, 0, 0), 3),
    ),
    "pipe": (
        -tools.Cylinder((0, 0.5, 0.5), (1, 0, 0), 3),
        tools.Cylinder((0, 0.5, 0.5), (1, 0, 0), 3),
    ),
    "function": tuple(tools.SignedDistance(sign * (z + 0 * x)) for sign in (1, -1)),
}


def contact(tool, slave="bottom", **options):
    mesh = brick("quad" if tool.dim == 2 else "hex", 3, 3)
    V = VectorH1(mesh, order=2)
    u, lam = (V * LACSpace(V, slave=slave)).TrialFunction()
    return LACContact(u, lam, obstacle=tool, finite=True, **options)


@pytest.mark.parametrize("dim", [2, 3])
@pytest.mark.parametrize("name", [*FLAT, *(f"3d {name}" for name in SOLID)])
def test_the_wrong_side_is_told(name, dim):
    if name.startswith("3d") != (dim == 3):
        return
    right, wrong = SOLID[name[3:]] if dim == 3 else FLAT[name]
    contact(right).Update()
    with pytest.raises(NgException, match=r"never meet.*looks away.*normal point the wrong way"):
        contact(wrong).Update()


@pytest.mark.parametrize("slave", ["bottom", ".*"])
def test_a_body_that_is_deep_inside(slave):
    """Some of its sides face the tool, from inside."""
    for tool in (tools.Plane((0, 3), (0, 1)), tools.Plane((0, 0, 3), (0, 0, 1))):
        with pytest.raises(NgException, match=r"is inside of it, \d.* deep at least.*wrong way"):
            contact(tool, slave).Update()


LATER = {
    "rolls in from the side": tools.Sphere((-9, 0.0), 0.5),
    "rolls in from below the side": tools.Sphere((-9, -1), 0.5),
    "far below": tools.Plane((0, -1e3), (0, 1)),
    "a little deep": tools.Plane((0, 0.1), (0, 1)),
    "a punch beside": tools.Polygon([(2, -1), (3, -1), (3, -0.1), (2, -0.1)]),
    "a cavity around": -tools.Sphere((0.5, 0.5), 0.72),
}


@pytest.mark.parametrize("slave", ["bottom", ".*"])
@pytest.mark.parametrize("name", LATER)
def test_a_tool_that_is_only_elsewhere(name, slave):
    contact(LATER[name], slave).Update()


def test_maxdist_says_that_a_tool_is_apart():
    """It comes around the body: at first it is behind."""
    tool = tools.Sphere((0.5, 4), 1)
    with pytest.raises(NgException, match="give the maxdist"):
        contact(tool).Update()
    contact(tool, maxdist=2).Update()
