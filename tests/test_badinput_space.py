"""Wrong input to LACSpace: partitions that are unstable, spaces that do not fit."""

from functools import cache

import pytest
from ngsolve import H1, VectorH1, VectorL2, VectorValued
from ngsolve.meshes import MakeStructured2DMesh

from ngslac import BubbleVectorH1, LACSpace, SplitSlaveFaces
from ngslac.meshes import TwoBlocks3D

REMEDY = r"Remedy: SplitSlaveFaces\(mesh, slave\), BubbleVectorH1\(mesh, slave=...\)"
SLAVE = {2: "bottom", 3: "slave"}


def square(n=6):
    return MakeStructured2DMesh(quads=False, nx=n, ny=2)


def blocks(kind="hex", n=3):
    return TwoBlocks3D(kind, "hex", n, 2)


@cache
def mesh(dim, **flags):
    return (square if dim == 2 else blocks)(**flags)


def spaced(dim, V, **flags):
    """The space of multipliers for a displacement that a function of the mesh makes."""
    return lambda: LACSpace(V(mesh(dim)), **({"slave": SLAVE[dim]} | flags))


def P(order, **flags):
    return lambda m: VectorH1(m, order=order, **flags)


VECTOR = "has 1 component.*give a vector-valued space such as VectorH1"
UNSTABLE = rf"1 face\(s\) of boundary '(bottom|slave)'.*unstable.*{REMEDY}"
CLAMPED = r"of boundary '(bottom|slave)'.*no Dirichlet condition on the slave faces"
REFUSED = [
    *((spaced(d, lambda m: H1(m, order=2)), Exception, VECTOR) for d in (2, 3)),
    (spaced(2, lambda m: H1(m, order=2, dim=3)), Exception, "has 3 component.*in 2D"),
    (spaced(3, lambda m: H1(m, order=2, dim=2)), Exception, "has 2 component.*in 3D"),
    (spaced(3, lambda m: VectorValued(H1(m), 2)), Exception, "has 2 component.*in 3D"),
    *((spaced(d, P(2, complex=True)), Exception, "is complex; contact needs real") for d in (2, 3)),
    *((spaced(d, VectorL2), Exception, "boundary|no macro-element") for d in (2, 3)),
    *((spaced(2, P(n, dirichlet="bottom")), Exception, r"6 face\(s\) " + CLAMPED) for n in (1, 3)),
    (spaced(2, P(2, dirichlety="bottom")), Exception, "no macro-element can be made"),
    (spaced(3, P(2, dirichlet="slave")), Exception, CLAMPED),
    (spaced(3, P(2, dirichletz="slave")), Exception, CLAMPED),
    (
        spaced(2, P(2), macros=[0, 0, 1]),
        Exception,
        "macros has 3 entries, but there are 6 ",
    ),
    (spaced(2, P(2), macros=[]), Exception, "macros has 0 entries"),
    (spaced(2, P(2), macros=[0, 0, 1, 1, -1, 2]), Exception, "macros holds the negative number -1"),
    (
        spaced(2, P(2), macros=[0, 0, 1, 1, 3, 3]),
        Exception,
        "macro-element 2 has no face; number them densely",
    ),
    (spaced(2, P(2), macros=[5] * 6), Exception, "macro-element 0 has no face"),
    (spaced(2, P(1), macros=range(6)), Exception, UNSTABLE),
    (spaced(3, P(1), macros=range(9)), Exception, UNSTABLE),
    *((spaced(2, P(2), components=n), Exception, "components") for n in (0, -1)),
    (lambda: spaced(2, P(2))().CoreDofs(6), IndexError, "there is no macro-element 6"),
    (lambda: LACSpace(P(2)(mesh(2))), TypeError, "slave"),
    (lambda: LACSpace(P(2)(mesh(2)), "bottom"), TypeError, "without a name"),
    (spaced(2, P(2), slave=3), TypeError, "slave"),
]


@pytest.mark.parametrize(("make", "error", "message"), REFUSED)
def test_refused(make, error, message):
    with pytest.raises(error, match=message):
        make()


@pytest.mark.parametrize(
    ("make", "faces"), [(square, 1), (square, 2), *((blocks, k) for k in ("tet", "hex", "prism"))]
)
def test_too_few_faces_for_a_stable_partition(make, faces):
    """Both remedies do; of two edges clamped at the vertex between them no vertex is free."""
    flags = {"n": faces} if make is square else {"kind": faces, "n": 1}
    faces = {"hex": 1, "tet": 2, "prism": 2}.get(faces, faces)
    few = make(**flags)
    slave, V = SLAVE[few.dim], VectorH1(few, order=1)
    if few.dim == faces == 2:
        middle = next(v.nr for v in few.vertices if v.point == (0.5, 0))
        V.FreeDofs().Clear(middle)
        V.FreeDofs().Clear(middle + few.nv)
    text = rf"no macro-element can be made of {faces} face\(s\) of boundary '{slave}'.*{REMEDY}"
    with pytest.raises(Exception, match=text):
        LACSpace(V, slave=slave)
    assert LACSpace(BubbleVectorH1(few, order=1, slave=slave), slave=slave).nmacros == faces
    split = LACSpace(VectorH1(SplitSlaveFaces(few, slave), order=1), slave=slave)
    assert split.nmacros == faces if few.dim == 2 else split.nmacros > 0


def test_order_at_which_one_face_per_multiplier_is_stable():
    triangles = blocks("tet")
    for order in (2, 3):
        faces = mesh(2), mesh(3), triangles
        for m, number in zip(faces, (6, 9, 18), strict=True):
            given = {"slave": SLAVE[m.dim], "macros": range(number)}
            if order == 2 and m is triangles:
                with pytest.raises(Exception, match=UNSTABLE):
                    LACSpace(P(order)(m), **given)
            else:
                assert LACSpace(P(order)(m), **given).nmacros == number


def test_macros_do_not_survive_refinement():
    m = square()
    V = VectorH1(m, order=2)
    Q = LACSpace(V, slave="bottom", macros=[0, 0, 1, 1, 2, 2])
    assert Q.nmacros == 3
    with pytest.raises(Exception, match="does not fit the refined mesh; make a new space"):
        m.Refine()
