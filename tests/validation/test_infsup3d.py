"""The discrete inf-sup constant (T19) of the macro-elements in three dimensions.

Published constants: on the cube in structured tetrahedra and hexahedra with a reference of order 3,
and on a box of unstructured tetrahedra with order 4. They were computed by others, with a program
that has nothing to do with this one.

Bounded means: at least 0.25, and a loss of less than 8 % for a mesh finer by a quarter.
"""

from functools import lru_cache
from itertools import pairwise
from math import log

import pytest
from infsup3d import RIM, Body3D, Cube, Parents, Slab, Space3D

from ngslac import LACSpace, SplitSlaveFaces

TABLE = {  # for n = 4, 6, 8
    ("tet", "P1bubble"): (0.475, 0.442, 0.428),
    ("tet", "P2bubble"): (0.764, 0.755, 0.752),
    ("hex", "P1"): (0.851, 0.750, 0.703),
    ("hex", "P1bubble"): (0.585, 0.519, 0.488),
    ("hex", "P2"): (0.893, 0.885, 0.883),
}
CLAMPED_TABLE = {
    ("tet", "P1bubble"): (0.420, 0.413, 0.411),
    ("tet", "P2bubble"): (0.753, 0.751, 0.749),
}
UNSTABLE = (0.368, 0.258, 0.198)  # one constant per triangle of order 2
UNSTRUCTURED = {  # for h = 0.34, 0.2
    "P1bubble": (0.537, 0.497),
    "P2bubble": (0.769, 0.748),
    "P3": (0.866, 0.835),
}
UNSTRUCTURED_UNSTABLE = (0.430, 0.299)
UNSTRUCTURED_SPLIT = {1: (0.345, 0.316), 2: (0.740, 0.719)}

KINDS = {  # with the elements that differ: order 2 on quadrilaterals has its bubbles by itself
    "tet": ("P1", "P1bubble", "P2", "P2bubble"),
    "hex": ("P1", "P1bubble", "P2"),
    "prism": ("P1", "P1bubble", "P2", "P2bubble"),
    "prism_side": ("P1", "P1bubble", "P2"),
    "pyramid": ("P1", "P1bubble", "P2"),
}
ALL = [(kind, element) for kind, elements in KINDS.items() for element in elements]
# The cone over a triangle is thin where a brick is high: bounded, but lower than the rest.
LEAST = {("tet", "P1split"): 0.23, ("prism", "P1split"): 0.16}


def MakeBody(n, kind="tet", clamped=False, split=False):
    return CachedBody(n, kind, clamped, split)


@lru_cache
def CachedBody(n, kind, clamped, split):
    mesh = Cube(n, kind)
    flags = {"dirichlet": RIM} if clamped else {}
    return Body3D(SplitSlaveFaces(mesh, "bottom") if split else mesh, **flags)


@lru_cache
def Unstructured(h):
    return Body3D(Slab(h), reference=4)


def CheckBounded(levels, constants, least=0.25):
    assert min(constants) >= least
    assert Rate(levels, constants) < log(1 / 0.92) / log(1.25)


def Rate(levels, constants):
    """Exponent of the decay with the mesh size between two levels."""
    (n, finer), (coarse, fine) = levels, constants
    return log(coarse / fine) / log(finer / n)


@pytest.mark.parametrize(("kind", "element"), TABLE)
def test_agrees_with_the_table(kind, element):
    constants = [MakeBody(n, kind).InfSup(element) for n in (4, 6, 8)]
    assert constants == pytest.approx(TABLE[kind, element], rel=0.003)


@pytest.mark.parametrize(("kind", "element"), CLAMPED_TABLE)
def test_agrees_with_the_table_for_a_clamped_rim(kind, element):
    constants = [MakeBody(n, kind, True).InfSup(element) for n in (4, 6, 8)]
    assert constants == pytest.approx(CLAMPED_TABLE[kind, element], rel=0.003)


@pytest.mark.parametrize("element", UNSTRUCTURED)
def test_agrees_with_the_table_for_unstructured_tetrahedra(element):
    constants = [Unstructured(h).InfSup(element) for h in (0.34, 0.2)]
    assert constants == pytest.approx(UNSTRUCTURED[element], rel=0.005)


@pytest.mark.parametrize(("element", "published"), [("P1", None), ("P2", (0.772, 0.715))])
def test_agglomerates_of_unstructured_tetrahedra(element, published):
    """The published pairs of order 2 are others; a star can be the whole of a coarse surface."""
    constants = [Unstructured(h).InfSup(element) for h in (0.34, 0.2)]
    assert min(constants) > 0.6
    assert published is None or constants == pytest.approx(published, rel=0.01)


def test_agrees_with_the_table_for_the_split():
    """One macro-element per former face, which for order 1 the space finds by itself."""
    constants = {1: [], 2: []}
    for h in (0.34, 0.2):
        coarse = Slab(h)
        fine = SplitSlaveFaces(coarse, "bottom")
        parents, body = Parents(coarse, fine), Body3D(fine, reference=4)
        for order, values in constants.items():
            values.append(body.InfSup(f"P{order}", parents))
        own = LACSpace(Space3D(fine, "P1"), slave="bottom").macros
        both = {(own[nr], parent) for nr, parent in zip(body.faces, parents, strict=True)}
        assert len(both) == max(parents) + 1 == max(own) + 1
    for order, values in constants.items():
        assert values == pytest.approx(UNSTRUCTURED_SPLIT[order], rel=0.003)


@pytest.mark.parametrize(("kind", "element"), ALL)
@pytest.mark.parametrize("clamped", [False, True])
def test_bounded_under_refinement(kind, element, clamped):
    """Macro-elements beside a clamped edge are as stable as others, and that on coarse meshes."""
    levels = (4, 6) if clamped else (6, 8)
    CheckBounded(levels, [MakeBody(n, kind, clamped).InfSup(element) for n in levels])


@pytest.mark.parametrize(("kind", "element"), [(k, e) for k in KINDS for e in ("P1", "P2")])
@pytest.mark.parametrize("clamped", [False, True])
def test_bounded_after_the_split(kind, element, clamped):
    """With the macro-elements of the space: the former faces, or for order 2 pairs of triangles."""
    levels, least = (4, 6), LEAST.get((kind, f"{element}split"), 0.25)
    constants = [MakeBody(n, kind, clamped, split=True).InfSup(element) for n in levels]
    CheckBounded(levels, constants, least)


@pytest.mark.parametrize("kind", KINDS)
def test_stable_on_perturbed_meshes(kind):
    """Quadrilaterals that are no parallelograms, cells that are no bricks: a fifth less at most."""
    body = Body3D(Cube(6, kind, perturb=0.25), dirichlet=RIM)
    for element in KINDS[kind]:
        assert body.InfSup(element) > 0.8 * MakeBody(6, kind, True).InfSup(element)


@pytest.mark.slow
def test_order_one_on_hexahedra_on_finer_meshes():
    """The elements whose constants fall longest, once more between finer meshes."""
    for element, published in (("P1", 0.680), ("P1bubble", 0.473)):
        constants = [MakeBody(n, "hex").InfSup(element) for n in (8, 10)]
        CheckBounded((8, 10), constants)
        assert constants[1] == pytest.approx(published, rel=0.003)


@pytest.mark.parametrize("kind", ["tet", "hex"])
def test_order_three_is_bounded(kind):
    """Against a reference of higher order than its own."""
    levels = (4, 6)
    bodies = [Body3D(Cube(n, kind), reference=4, dirichlet=RIM) for n in levels]
    CheckBounded(levels, [body.InfSup("P3") for body in bodies], least=0.7)


def test_one_constant_per_triangle_of_order_two_is_unstable():
    """The constant decays like the mesh size, which unstructured meshes hide at first."""
    constants = [MakeBody(n).InfSupPerFace(2) for n in (4, 6, 8)]
    assert constants == pytest.approx(UNSTABLE, rel=0.003)
    for levels, pair in zip(pairwise((4, 6, 8)), pairwise(constants), strict=True):
        assert Rate(levels, pair) > 0.8
    constants = [Unstructured(h).InfSupPerFace(2) for h in (0.34, 0.2)]
    assert constants == pytest.approx(UNSTRUCTURED_UNSTABLE, rel=0.003)


@pytest.mark.parametrize("kind", ["tet", "prism"])
def test_one_constant_per_triangle_has_a_kernel_beside_a_clamped_rim(kind):
    """Of order 2 exactly one mode, the checkerboard; of order 1 one in any case."""
    body = MakeBody(6, kind, clamped=True)
    kernel, second = body.PerFace(2)[:2]
    assert kernel < 1e-6
    assert second > 0.05
    assert body.InfSupPerFace(1) < 1e-6
    assert MakeBody(6, kind).InfSupPerFace(1) < 1e-6
    assert body.InfSup("P2") > 0.6


@pytest.mark.parametrize("kind", ["hex", "prism_side", "pyramid"])
def test_one_constant_per_quadrilateral_of_order_one_is_unstable(kind):
    constants = [MakeBody(n, kind).InfSupPerFace(1) for n in (6, 8)]
    assert Rate((6, 8), constants) > 1.5
    assert MakeBody(6, kind, clamped=True).InfSupPerFace(1) < 1e-6


@pytest.mark.parametrize(
    ("kind", "element"),
    [("tet", "P1"), ("tet", "P2"), ("prism", "P2"), ("hex", "P1"), ("pyramid", "P1")],
)
@pytest.mark.parametrize("clamped", [False, True])
def test_lacspace_refuses_one_macro_element_per_face(kind, element, clamped):
    body = MakeBody(6, kind, clamped)
    V = Space3D(body.mesh, element, **body.dirichlet)
    with pytest.raises(Exception, match="no free displacement") as error:
        LACSpace(V, slave="bottom", macros=list(range(len(body.faces))))
    assert "BubbleVectorH1" in str(error.value)


@pytest.mark.parametrize("kind", ["hex", "prism_side", "pyramid"])
def test_facewise_constants_of_order_two_are_what_lacspace_makes(kind):
    body = MakeBody(6, kind)
    assert body.InfSupPerFace(2) == pytest.approx(body.InfSup("P2"), rel=1e-9)
