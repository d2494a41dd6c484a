"""Mistakes in arguments of spaces and SplitSlaveFaces: the argument, its value, the remedy."""

from functools import partial

import ngsolve as ngs
import pytest
from bricks import ball, brick, unstructured
from netgen.occ import Circle, MoveTo, OCCGeometry
from ngsolve.meshes import Make1DMesh, MakeStructured2DMesh
from refused import calls, check_refused

from ngslac import BubbleVectorH1, LACSpace, SplitSlaveFaces
from ngslac.meshes import TwoBlocks3D

MESH, OTHER, CUBE = brick("trig"), brick("quad"), unstructured(3, 0.5)
P2 = ngs.VectorH1(MESH, order=2)
Q = LACSpace(P2, slave="bottom")


def bubble(mesh=MESH, **flags):
    return BubbleVectorH1(mesh, **flags)


def quadratic(dim):
    ngmesh = unstructured(dim, 0.5).ngmesh
    ngmesh.SecondOrder()
    return ngs.Mesh(ngmesh)


def five_edges():
    """A hole whose circle is met by five edges only: new vertices would leave the body."""
    body = MoveTo(-1.2, -1.2).Rectangle(2.4, 2.4).Face() - Circle((0, 0), 1).Face()
    body.edges.name = "rim"
    coarse = {"maxh": 10, "curvaturesafety": 0.5, "segmentsperedge": 0.5}
    return ngs.Mesh(OCCGeometry(body, dim=2).GenerateMesh(**coarse))


NOREGION = "slave = <Region> must be .* a boundary region"
NORMAL = "no displacement is free there along the norm"
LACSPACE = [
    ("space(None)", "V = None must be a displacement space, such as VectorH1", TypeError),
    ("space(MESH)", "V = <ngsolve.comp.Mesh", TypeError),
    ("space(GridFunction(P2))", "V = <ngsolve.comp.GridFunction", TypeError),
    ('space("VectorH1")', "V = 'VectorH1' must be a displacement space", TypeError),
    ("space(Discontinuous(VectorH1(MESH)))", "has no dofs there. Remedy"),
    ('space(VectorH1(MESH, definedon="no"))', "has no dofs there. Remedy"),
    ("space(L2(MESH, order=1))", "no values on the boundary", ValueError),
    ("space(H1(MESH) * H1(MESH))", "no values on the boundary", ValueError),
    ("space(HCurl(MESH, order=1))", NORMAL),
    ("space(TangentialFacetFESpace(MESH))", NORMAL),
    ("space(NumberSpace(MESH))", "no free displacement dof"),
    ("space(NumberSpace(MESH) ** 2)", "no free displacement dof"),
    ("space(Q)", "V is itself a LACSpace", ValueError),
    ('LACSpace(VectorH1(Make1DMesh(3)), slave="left")', "mesh of dimension 1", ValueError),
    ("lac()", "slave = None must be a pattern of boundary names or a boundary region", TypeError),
    ("lac(slave=ElementId(VOL, 0))", "slave = .* must be a pattern", TypeError),
    *(
        (f"LACSpace(VectorH1({mesh}), slave={slave})", message, ValueError)
        for mesh in ("MESH", "CUBE")
        for slave, message in (
            ("'rim'", "slave='rim' matches no boundary face; .*'bottom'"),
            ("''", "slave='' matches no boundary face; .*'bottom'"),
            (f"{mesh}.Boundaries('rim')", "slave=<Region> matches no boundary face"),
            ("OTHER.Boundaries('bottom')", "region of another mesh"),
            (f"{mesh}.Materials('.*')", NOREGION),
            (f"{mesh}.BBoundaries('.*')", NOREGION),
        )
    ),
    ('lac(slave="bottom", components="2")', "components = '2' must be 1, 2 or 3", TypeError),
    ('lac(slave="bottom", components=1.5)', "components = 1.5 must be 1, 2 or 3", TypeError),
    ('lac(slave="bottom", components=True)', "components = True", TypeError),
    ('lac(slave="bottom", components=4)', "components = 4 must be 1, 2 or 3", ValueError),
    ('lac(slave="bottom", autoupdate="no")', "autoupdate = 'no' must be True or", TypeError),
    ('lac(slaves="bottom")', "there is no argument 'slaves'; the arguments are V, ", TypeError),
    ("Q.WithComponents(None)", "components = None", TypeError),
    ("Q.WithComponents(10**7)", "components = 10000000 must be 1, 2 or 3", ValueError),
    ("Q.CoreDofs(-1)", "no macro-element -1", IndexError),
    ('Q.CoreDofs("a")', "macro = 'a'", TypeError),
]
NO_MESH = r"BubbleVectorH1: mesh = .* must be an ngsolve\.Mesh"
NO_ORDER = r"order = .* must be an integer from 1", (TypeError, ValueError)
BUBBLE = [
    ("bubble(order=1)", r"which boundaries get bubbles.* 'bottom', 'left'"),
    ('bubble(slave="rim")', r"BubbleVectorH1: slave='rim' matches no boundary face.* 'bottom'"),
    ('bubble(slave=MESH.Boundaries("rim"))', "slave=<Region> matches no boundary face"),
    ('bubble(slave=OTHER.Boundaries("left"))', "region of another mesh"),
    ('bubble(slave=MESH.Materials(".*"))', "slave = <Region> must be .* a boundary region"),
    ("bubble(slave=None)", "slave = None must be a pattern of", TypeError),
    ('bubble(slave="left", hoprolongation=True)', "leaves no place for bubbles"),
    ('bubble(slave="left", order_policy=ORDER_POLICY.CONSTANT)', "VARIABLE"),
    ('bubble(Make1DMesh(3), slave="left")', "two- or three-dimensional"),
    ('bubble(slave="[")', r"slave = '\[' is no regular expression", ValueError),
    ("bubble(slave=2.5)", "slave = 2.5 must be a pattern of", TypeError),
    (
        'bubble(slave="left", dirichlet="[")',
        r"dirichlet = '\[' is no regular expression",
        ValueError,
    ),
    (
        'bubble(slave="left", dirichlet=2.5)',
        "dirichlet = 2.5 must be a pattern of",
        TypeError,
    ),
    *((f"bubble({m}, slave='left')", NO_MESH, TypeError) for m in ("None", "3", "'mesh'", "b'm'")),
    *(
        (f"bubble(slave='left', order={n})", *NO_ORDER)
        for n in ("0", "-1", "2.5", "'2'", "True", "None", "10**6", "10**400")
    ),
]
BOTH = ("MESH", "CUBE")
NO_PATTERN = "slave = .* must be a pattern of boundary names"
SPLIT = [
    *((f"split({m}, 'rim')", "slave='rim' matches no boundary fa", ValueError) for m in BOTH),
    *((f"split({m}, {m}.Materials('.*'))", NO_PATTERN) for m in BOTH),
    *((f"split(quadratic({dim}), 'top')", "second order") for dim in (2, 3)),
    ('split(CUBE, CUBE.BBoundaries(".*"))', NO_PATTERN),
    ('split(MESH, MESH.Boundaries("rim"))', "slave=<Region> matches no boundary", ValueError),
    ('split(MESH, OTHER.Boundaries("left"))', "slave is a region of another mesh"),
    ("split(MESH, 3)", "slave = 3 must be a pattern", TypeError),
    ('split(MESH.ngmesh, "left")', r"mesh = <Mesh> must be an ngsolve\.Mesh", TypeError),
    (
        'split(CUBE, "top", hexes="cubes")',
        "hexes = 'cubes' must be one of 'pyramids', 'h",
        ValueError,
    ),
    ('split(Make1DMesh(3), "left")', "must be two- or three-dimensional"),
    # Tetrahedra with two faces on the sphere: no centre of one sees the other.
    ('split(ball(3, 0.6, order=1), "surface")', "fold over"),
    ('split(five_edges(), "rim")', "fold over"),
]


# ---------------------------------------------------------------- partitions

REMEDY = r"Remedy: SplitSlaveFaces\(mesh, slave\), BubbleVectorH1\(mesh, slave=...\)"
SLAVE = {2: "bottom", 3: "slave"}


def plane(n=6):
    return MakeStructured2DMesh(quads=False, nx=n, ny=2)


def solid(kind="hex", n=3):
    return TwoBlocks3D(kind, "hex", n, 2)


def part(mesh, kind=ngs.VectorH1, order=2, *, macros=None, components=None, **flags):
    """For a displacement; `flags` go to its space."""
    given = {"macros": macros, "components": components}
    given = {name: value for name, value in given.items() if value is not None}
    return LACSpace(kind(mesh, order=order, **flags), slave=SLAVE[mesh.dim], **given)


UNSTABLE = rf"1 face\(s\) of boundary '(bottom|slave)'.*unstable.*{REMEDY}"
CLAMPED = r"face\(s\) of boundary '(bottom|slave)'.*no Dirichlet condition on the slave faces"
PARTITION = [
    ("part(plane(), H1, dim=3)", "has 3 component.*in 2D"),
    ("part(solid(), H1, dim=2)", "has 2 component.*in 3D"),
    ("LACSpace(VectorValued(H1(solid()), 2), slave='slave')", "has 2 component.*in 3D"),
    ("part(plane(), complex=True)", "is complex; contact needs real"),
    ("part(plane(), VectorL2)", "boundary|no macro-element"),
    ("part(solid(), VectorL2)", "boundary|no macro-element"),
    ("part(plane(), order=1, dirichlet='bottom')", f"6 {CLAMPED}"),
    ("part(plane(), order=3, dirichlet='bottom')", f"6 {CLAMPED}"),
    ("part(plane(), dirichlety='bottom')", "no macro-element can be made"),
    ("part(solid(), dirichlet='slave')", CLAMPED),
    ("part(solid(), dirichletz='slave')", CLAMPED),
    ("part(plane(), macros=[0, 0, 1])", "macros has 3 entries, but there are 6 slave faces; give"),
    ("part(plane(), macros=[])", "macros has 0 entries"),
    ("part(plane(), macros=[0, 0, 1, 1, -1, 2])", "macros holds the negative number -1"),
    ("part(plane(), macros=[0, 0, 1, 1, 3, 3])", "macro-element 2 has no face; number them dense"),
    ("part(plane(), macros=[5] * 6)", "macro-element 0 has no face"),
    ("part(plane(), order=1, macros=range(6))", UNSTABLE),
    ("part(solid(), order=1, macros=range(9))", UNSTABLE),
    ("part(solid('tet'), macros=range(18))", UNSTABLE),
    ("part(plane(), components=0)", "components"),
    ("part(plane(), components=-1)", "components"),
    ("part(plane()).CoreDofs(6)", "there is no macro-element 6", IndexError),
    ("LACSpace(VectorH1(plane()), 'bottom')", "without a name", TypeError),
]


SHORT = {"space": partial(LACSpace, slave="bottom"), "lac": partial(LACSpace, P2)}
SHORT |= {"split": SplitSlaveFaces, "Make1DMesh": Make1DMesh, "ball": ball}


@calls([*LACSPACE, *BUBBLE, *SPLIT, *PARTITION])
def test_refused(row):
    check_refused(row, **globals() | SHORT)


def test_spaces_that_serve():
    for V in ngs.Compress(P2), ngs.H1(MESH, order=2, dim=2), ngs.H1(MESH, order=2) ** 2:
        assert LACSpace(V, slave="bottom").nmacros == 4


def test_region_and_pattern_are_the_same():
    region = MESH.Boundaries("left") + MESH.Boundaries("top")
    spaces = [BubbleVectorH1(MESH, slave=slave) for slave in ("left|top", region)]
    assert isinstance(spaces[0], ngs.VectorH1)
    dofs = [[list(el.dofs) for el in V.Elements(ngs.BND)] for V in spaces]
    assert dofs[0] == dofs[1]
    for mesh in (MESH, CUBE):
        region = mesh.Boundaries("left") + mesh.Boundaries("top")
        meshes = [SplitSlaveFaces(mesh, slave) for slave in ("left|top", region)]
        vertices = [[[v.nr for v in el.vertices] for el in m.Elements()] for m in meshes]
        assert vertices[0] == vertices[1]


def test_one_face_per_multiplier():
    """Stable from order 2 on, for triangles from order 3 on."""
    for mesh, order, n in ((plane(), 2, 6), (solid(), 2, 9), (solid("tet"), 3, 18)):
        assert part(mesh, order=order, macros=range(n)).nmacros == n


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
    slave, V = SLAVE[mesh.dim], ngs.VectorH1(mesh, order=1)
    if mesh.dim == faces == 2:
        middle = next(v.nr for v in mesh.vertices if v.point == (0.5, 0))
        V.FreeDofs().Clear(middle)
        V.FreeDofs().Clear(middle + mesh.nv)
    text = rf"no macro-element can be made of {faces} face\(s\) of boundary '{slave}'.*{REMEDY}"
    with pytest.raises(Exception, match=text):
        LACSpace(V, slave=slave)
    assert part(mesh, BubbleVectorH1, 1, slave=slave).nmacros == faces
    split = part(SplitSlaveFaces(mesh, slave), order=1).nmacros
    assert split == faces if mesh.dim == 2 else split > 0


def test_macros_do_not_survive_refinement():
    mesh = plane()
    Q = part(mesh, macros=[0, 0, 1, 1, 2, 2])
    assert Q.nmacros == 3
    with pytest.raises(Exception, match="does not fit the refined mesh; make a new space"):
        mesh.Refine()
