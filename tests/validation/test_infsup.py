"""The discrete inf-sup constant (T19), from the operators that LACContact assembles.

The published constants belong to unstructured meshes of triangles with the stated edge length.
"""

from functools import lru_cache
from itertools import pairwise

import pytest
from infsup import Body, Space, Square

from ngslac import LACSpace, SplitSlaveFaces

RIM = {"dirichlet": "left|right"}
# For h = 1/5, 1/10, 1/20; computed by others, with a program that has nothing to do with this one.
TABLE = {
    "P1": (0.939, 0.811, 0.790),
    "P1bubble": (0.831, 0.837, 0.835),
    "P2": (0.899, 0.897, 0.900),
}
UNSTABLE = (0.346, 0.191, 0.097)
KINDS = ["P1", "P1split", "P1bubble", "P2", "P3"]
DIVISIONS = (5, 10, 20)


@lru_cache
def MakeBody(n, kind="unstructured", clamped=False, split=False):
    mesh = Square(n, kind)
    return Body(SplitSlaveFaces(mesh, "bottom") if split else mesh, **(RIM if clamped else {}))


@pytest.mark.parametrize("kind", TABLE)
def test_agrees_with_the_table(kind):
    constants = [MakeBody(n).InfSup(kind) for n in DIVISIONS]
    assert constants == pytest.approx(TABLE[kind], rel=0.01)


@pytest.mark.pairwise
@pytest.mark.parametrize("mesh", ["unstructured", "trigs", "quads"])
@pytest.mark.parametrize("clamped", [False, True])
@pytest.mark.parametrize("kind", KINDS)
def test_bounded_under_refinement(kind, clamped, mesh):
    """Macro-elements beside a clamped edge are as stable as others."""
    split, kind = kind.endswith("split"), kind.removesuffix("split")
    coarse, fine = (MakeBody(n, mesh, clamped, split).InfSup(kind) for n in DIVISIONS[1:])
    assert min(coarse, fine) > 0.5
    assert fine > 0.92 * coarse


def test_one_constant_per_face_of_order_one_is_unstable():
    """The constant decays like the mesh size; all of it from plain NGSolve."""
    constants = [MakeBody(n).InfSupPerFace(1) for n in DIVISIONS]
    assert constants == pytest.approx(UNSTABLE, rel=0.01)
    assert all(1.7 < a / b < 2.1 for a, b in pairwise(constants))


def test_one_constant_per_face_of_order_one_has_a_kernel_beside_a_clamped_rim():
    """Between clamped ends there are fewer free vertices than faces."""
    assert MakeBody(10, clamped=True).InfSupPerFace(1) < 1e-6


def test_facewise_constants_of_order_two_are_what_lacspace_makes():
    """Forms written by hand and those of LACContact give the same number."""
    body = MakeBody(10)
    assert body.InfSupPerFace(2) == pytest.approx(body.InfSup("P2"), rel=1e-9)


@pytest.mark.parametrize("mesh", ["unstructured", "quads"])
@pytest.mark.parametrize("dirichlet", [{}, RIM])
def test_lacspace_refuses_one_macro_element_per_face(mesh, dirichlet):
    V = Space(Square(10, mesh), "P1", **dirichlet)
    with pytest.raises(Exception, match="no free displacement") as error:
        LACSpace(V, slave="bottom", macros=list(range(10)))
    assert "SplitSlaveFaces" in str(error.value)


@pytest.mark.parametrize("kind", ["P1bubble", "P2"])
def test_lacspace_takes_one_macro_element_per_face_where_that_is_stable(kind):
    V = Space(Square(10), kind, **RIM)
    assert LACSpace(V, slave="bottom", macros=list(range(10))).nmacros == 10
