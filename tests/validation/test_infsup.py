"""The inf-sup constant is bounded away from zero where LACSpace makes the macro-elements.

The published constants are rows of the cases, but for those on unstructured tetrahedra: these come
with a reference of order 4.
"""

from functools import lru_cache
from math import log

import numpy as np
import pytest
from case_infsup import Body, Cube, Order, Slab, Square

from ngslac import LACSpace, SplitSlaveFaces

SIZES = (0.34, 0.2)
UNSTRUCTURED = {  # accepted difference, and constants for these sizes
    "P1bubble": (0.005, (0.537, 0.497)),
    "P2bubble": (0.005, (0.769, 0.748)),
    "P3": (0.005, (0.866, 0.835)),
    "P2": (0.01, (0.772, 0.715)),  # with other pairs of faces
}
UNSTABLE = (0.430, 0.299)
SPLIT = {"P1": (0.345, 0.316), "P2": (0.740, 0.719)}

KINDS_2D = ("unstructured", "trigs", "quads")
KINDS = {  # with the elements that differ: order 2 on quadrilaterals has its bubbles by itself
    "tet": ("P1", "P1bubble", "P2", "P2bubble"),
    "hex": ("P1", "P1bubble", "P2"),
    "prism": ("P1", "P1bubble", "P2", "P2bubble"),
    "prism_side": ("P1", "P1bubble", "P2"),
    "pyramid": ("P1", "P1bubble", "P2"),
}
# The cone over a triangle is thin where a brick is high: bounded, but lower than the rest.
LEAST = {("tet", "P1split"): 0.23, ("prism", "P1split"): 0.16}
LEAST |= dict.fromkeys([("tet", "P3"), ("hex", "P3")], 0.7)


@lru_cache
def MakeBody(n, kind, clamped=False, split=False, reference=None):
    mesh = Square(n, kind) if kind in KINDS_2D else Cube(n, kind)
    mesh = SplitSlaveFaces(mesh, "bottom") if split else mesh
    return Body(mesh, reference=reference, clamped=clamped)


@lru_cache
def Unstructured(h):
    return Body(Slab(h), reference=4)


def CheckBounded(levels, kind, element, clamped, *, reference=None):
    """In 2D a loss of less than 8 % for a mesh finer by a half, in 3D by a fifth."""
    split, plain = element.endswith("split"), element.removesuffix("split")
    bodies = [MakeBody(n, kind, clamped, split, reference) for n in levels]
    constants = [body.InfSup(plain) for body in bodies]
    plane = kind in KINDS_2D
    assert min(constants) > LEAST.get((kind, element), 0.5 if plane else 0.25)
    assert Order(levels, constants) > log(0.92) / log(2 if plane else 1.25)
    return constants


@pytest.mark.pairwise
@pytest.mark.parametrize("kind", KINDS_2D)
@pytest.mark.parametrize("clamped", [False, True])
@pytest.mark.parametrize("element", ["P1", "P1split", "P1bubble", "P2", "P3"])
def test_bounded_under_refinement_2d(element, clamped, kind):
    """Macro-elements beside a clamped edge are as stable as others."""
    CheckBounded((10, 20), kind, element, clamped)


CLAMPED = [(k, e, True) for k, es in KINDS.items() for e in es]
FREE = [(k, e, False) for k, e, _ in CLAMPED]  # by default on tetrahedra
FREE = [c if c[0] == "tet" else pytest.param(*c, marks=pytest.mark.full) for c in FREE]


@pytest.mark.parametrize(("kind", "element", "clamped"), CLAMPED + FREE)
def test_bounded_under_refinement_3d(kind, element, clamped):
    """And that on coarse meshes."""
    CheckBounded((4, 6) if clamped else (6, 8), kind, element, clamped)


@pytest.mark.parametrize("element", ["P1split", "P2split"])
@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("clamped", [pytest.param(False, marks=pytest.mark.full), True])
def test_bounded_after_the_split_3d(kind, element, clamped):
    """With the macro-elements of the space: the former faces, or for order 2 pairs of triangles."""
    CheckBounded((4, 6), kind, element, clamped)


@pytest.mark.parametrize("kind", ["tet", "hex"])
def test_order_three_is_bounded(kind):
    """Against a reference of higher order than its own."""
    CheckBounded((4, 6), kind, "P3", True, reference=4)


@pytest.mark.full
@pytest.mark.parametrize(("element", "published"), [("P1", 0.680), ("P1bubble", 0.473)])
def test_order_one_on_hexahedra_on_finer_meshes(element, published):
    """The elements whose constants fall longest, once more between finer meshes."""
    constants = CheckBounded((8, 10), "hex", element, False)
    assert constants[1] == pytest.approx(published, rel=0.003)


@pytest.mark.parametrize("kind", KINDS)
def test_stable_on_perturbed_meshes(kind):
    """Quadrilaterals that are no parallelograms, cells that are no bricks: a fifth less at most."""
    body = Body(Cube(6, kind, perturb=0.25), clamped=True)
    for element in KINDS[kind]:
        assert body.InfSup(element) > 0.8 * MakeBody(6, kind, True).InfSup(element)


# ---------------------------------------------------------------- unstructured tetrahedra


@pytest.mark.parametrize("element", UNSTRUCTURED)
def test_agrees_with_published_constants(element):
    accepted, published = UNSTRUCTURED[element]
    constants = [Unstructured(h).InfSup(element) for h in SIZES]
    assert constants == pytest.approx(published, rel=accepted)


def test_stars_of_faces_are_stable():
    """A star can be the whole of a coarse surface."""
    assert min(Unstructured(h).InfSup("P1") for h in SIZES) > 0.6


@pytest.mark.parametrize("k", range(2))
def test_agrees_with_published_constants_of_the_split(k):
    """One macro-element per former face, which for order 1 the space finds by itself."""
    coarse = Slab(SIZES[k])
    fine = SplitSlaveFaces(coarse, "bottom")
    new = [max(v.nr for v in el.vertices) for el in fine.Boundaries("bottom").Elements()]
    assert min(new) >= coarse.nv  # each former face has one new vertex inside
    parents, body = np.unique(new, return_inverse=True)[1].tolist(), Body(fine, reference=4)
    constants = {element: body.InfSup(element, parents) for element in SPLIT}
    assert constants == pytest.approx({e: both[k] for e, both in SPLIT.items()}, rel=0.003)
    own = LACSpace(body.Space("P1"), slave="bottom").macros
    both = {(own[nr], parent) for nr, parent in zip(body.faces, parents, strict=True)}
    assert len(both) == max(parents) + 1 == max(own) + 1


# ---------------------------------------------------------------- one macro-element per face


def test_one_constant_per_triangle_of_order_two_is_unstable():
    """The constant decays like the mesh size, which unstructured meshes hide at first."""
    constants = [MakeBody(n, "tet").PerFace(2)[0] for n in (6, 8)]
    assert Order((6, 8), constants) < -0.8
    constants = [Unstructured(h).PerFace(2)[0] for h in SIZES]
    assert constants == pytest.approx(UNSTABLE, rel=0.003)


@pytest.mark.parametrize(
    "kind", ["hex", *(pytest.param(k, marks=pytest.mark.full) for k in ("prism_side", "pyramid"))]
)
def test_one_constant_per_quadrilateral_of_order_one_is_unstable(kind):
    constants = [MakeBody(n, kind).PerFace(1)[0] for n in (6, 8)]
    assert Order((6, 8), constants) < -1.5


@pytest.mark.parametrize(
    ("n", "kind"),
    [(10, "unstructured"), *((6, k) for k in ("tet", "prism", "hex", "prism_side", "pyramid"))],
)
def test_kernel_beside_a_clamped_rim(n, kind):
    """Of order 1 in any case, on triangles even without a rim; of order 2 one mode there."""
    body, triangles = MakeBody(n, kind, True), kind in ("tet", "prism")
    assert body.PerFace(1)[0] < 1e-6
    if triangles:
        assert MakeBody(n, kind).PerFace(1)[0] < 1e-6
        kernel, second = body.PerFace(2)[:2]
        assert kernel < 1e-6
        assert second > 0.05
        assert body.InfSup("P2") > 0.6


@pytest.mark.parametrize(
    ("n", "kind", "element"),
    [
        *((10, kind, "P1") for kind in ("unstructured", "quads")),
        *((6, kind, "P1") for kind in ("tet", "hex", "pyramid")),
        *((6, kind, "P2") for kind in ("tet", "prism")),
    ],
)
@pytest.mark.parametrize("clamped", [False, True])
def test_lacspace_refuses_one_macro_element_per_face(n, kind, element, clamped):
    body = MakeBody(n, kind, clamped)
    with pytest.raises(Exception, match="no free displacement") as error:
        LACSpace(body.Space(element), slave="bottom", macros=list(range(len(body.faces))))
    remedy = "SplitSlaveFaces" if kind in KINDS_2D else "BubbleVectorH1"
    assert remedy in str(error.value)


@pytest.mark.parametrize(
    ("n", "kind"), [(10, "unstructured"), *((6, k) for k in ("hex", "prism_side", "pyramid"))]
)
def test_where_one_macro_element_per_face_is_stable_lacspace_makes_it(n, kind):
    """Forms written by hand and those of LACContact give the same number."""
    body = MakeBody(n, kind)
    assert body.PerFace(2)[0] == pytest.approx(body.InfSup("P2"), rel=1e-9)
    macros = list(range(len(body.faces)))
    assert LACSpace(body.Space("P1bubble"), slave="bottom", macros=macros).nmacros == len(macros)
