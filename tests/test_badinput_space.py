"""Wrong input to LACSpace: partitions that are unstable, spaces that do not fit."""

import pytest
from ngsolve import VectorH1
from ngsolve.meshes import MakeStructured2DMesh
from refused import calls, check_refused

from ngslac import BubbleVectorH1, LACSpace, SplitSlaveFaces
from ngslac.meshes import TwoBlocks3D

REMEDY = r"Remedy: SplitSlaveFaces\(mesh, slave\), BubbleVectorH1\(mesh, slave=...\)"
SLAVE = {2: "bottom", 3: "slave"}


def plane(n=6):
    return MakeStructured2DMesh(quads=False, nx=n, ny=2)


def solid(kind="hex", n=3):
    return TwoBlocks3D(kind, "hex", n, 2)


def space(mesh, kind=VectorH1, order=2, *, macros=None, components=None, **flags):
    """For a displacement; `flags` go to its space."""
    given = {"macros": macros, "components": components}
    given = {name: value for name, value in given.items() if value is not None}
    return LACSpace(kind(mesh, order=order, **flags), slave=SLAVE[mesh.dim], **given)


UNSTABLE = rf"1 face\(s\) of boundary '(bottom|slave)'.*unstable.*{REMEDY}"
CLAMPED = r"face\(s\) of boundary '(bottom|slave)'.*no Dirichlet condition on the slave faces"
REFUSED = [
    ("space(plane(), H1, dim=3)", "has 3 component.*in 2D"),
    ("space(solid(), H1, dim=2)", "has 2 component.*in 3D"),
    ("LACSpace(VectorValued(H1(solid()), 2), slave='slave')", "has 2 component.*in 3D"),
    ("space(plane(), complex=True)", "is complex; contact needs real"),
    ("space(plane(), VectorL2)", "boundary|no macro-element"),
    ("space(solid(), VectorL2)", "boundary|no macro-element"),
    ("space(plane(), order=1, dirichlet='bottom')", f"6 {CLAMPED}"),
    ("space(plane(), order=3, dirichlet='bottom')", f"6 {CLAMPED}"),
    ("space(plane(), dirichlety='bottom')", "no macro-element can be made"),
    ("space(solid(), dirichlet='slave')", CLAMPED),
    ("space(solid(), dirichletz='slave')", CLAMPED),
    ("space(plane(), macros=[0, 0, 1])", "macros has 3 entries, but there are 6 slave faces; give"),
    ("space(plane(), macros=[])", "macros has 0 entries"),
    ("space(plane(), macros=[0, 0, 1, 1, -1, 2])", "macros holds the negative number -1"),
    ("space(plane(), macros=[0, 0, 1, 1, 3, 3])", "macro-element 2 has no face; number them dense"),
    ("space(plane(), macros=[5] * 6)", "macro-element 0 has no face"),
    ("space(plane(), order=1, macros=range(6))", UNSTABLE),
    ("space(solid(), order=1, macros=range(9))", UNSTABLE),
    ("space(solid('tet'), macros=range(18))", UNSTABLE),
    ("space(plane(), components=0)", "components"),
    ("space(plane(), components=-1)", "components"),
    ("space(plane()).CoreDofs(6)", "there is no macro-element 6", IndexError),
    ("LACSpace(VectorH1(plane()))", "slave", TypeError),
    ("LACSpace(VectorH1(plane()), 'bottom')", "without a name", TypeError),
    ("LACSpace(VectorH1(plane()), slave=3)", "slave", TypeError),
]


@calls(REFUSED)
def test_refused(row):
    check_refused(row, space=space, plane=plane, solid=solid)


def test_one_face_per_multiplier():
    """Stable from order 2 on, for triangles from order 3 on."""
    for mesh, order, n in ((plane(), 2, 6), (solid(), 2, 9), (solid("tet"), 3, 18)):
        assert space(mesh, order=order, macros=range(n)).nmacros == n


@pytest.mark.parametrize(
    ("mesh", "faces"),
    [
        (plane(1), 1),
        (plane(2), 2),
        *((solid(kind, 1), faces) for kind, faces in (("tet", 2), ("hex", 1), ("prism", 2))),
    ],
)
def test_too_few_faces_for_a_stable_partition(mesh, faces):
    """Both remedies do; of two edges clamped at the vertex between them no vertex is free."""
    slave, V = SLAVE[mesh.dim], VectorH1(mesh, order=1)
    if mesh.dim == faces == 2:
        middle = next(v.nr for v in mesh.vertices if v.point == (0.5, 0))
        V.FreeDofs().Clear(middle)
        V.FreeDofs().Clear(middle + mesh.nv)
    text = rf"no macro-element can be made of {faces} face\(s\) of boundary '{slave}'.*{REMEDY}"
    with pytest.raises(Exception, match=text):
        LACSpace(V, slave=slave)
    assert space(mesh, BubbleVectorH1, 1, slave=slave).nmacros == faces
    split = space(SplitSlaveFaces(mesh, slave), order=1).nmacros
    assert split == faces if mesh.dim == 2 else split > 0


def test_macros_do_not_survive_refinement():
    mesh = plane()
    Q = space(mesh, macros=[0, 0, 1, 1, 2, 2])
    assert Q.nmacros == 3
    with pytest.raises(Exception, match="does not fit the refined mesh; make a new space"):
        mesh.Refine()
