"""What spaces and SplitSlaveFaces are given by mistake: the argument, its value, the remedy."""

import pytest
from bricks import ball, brick, unstructured
from netgen.occ import Circle, MoveTo, OCCGeometry
from ngsolve import (
    BND,
    H1,
    L2,
    ORDER_POLICY,
    VOL,
    Compress,
    Discontinuous,
    ElementId,
    FacetFESpace,
    GridFunction,
    HCurl,
    Mesh,
    NumberSpace,
    TangentialFacetFESpace,
    VectorH1,
)
from ngsolve.meshes import Make1DMesh

from ngslac import BubbleVectorH1, LACSpace, SplitSlaveFaces

OTHER = brick("trig")


def space(make, kind="trig"):
    """A call of LACSpace on a displacement space."""
    return lambda: LACSpace(make(brick(kind)), slave="bottom")


def options(**flags):
    return lambda: LACSpace(VectorH1(brick("trig"), order=2), **flags)


def method(call):
    return lambda: call(LACSpace(VectorH1(brick("trig"), order=2), slave="bottom"))


LACSPACE = [
    (space(lambda m: None), TypeError, "V = None must be a displacement space, such as VectorH1"),
    (space(lambda m: m), TypeError, "V = <ngsolve.comp.Mesh"),
    (space(lambda m: GridFunction(VectorH1(m))), TypeError, "V = <ngsolve.comp.GridFunction"),
    (space(lambda m: "VectorH1"), TypeError, "V = 'VectorH1' must be a displacement space"),
    (space(lambda m: Discontinuous(VectorH1(m))), Exception, "has no dofs there. Remedy"),
    (space(lambda m: VectorH1(m, definedon="no")), Exception, "has no dofs there. Remedy"),
    (space(lambda m: L2(m, order=1)), ValueError, "no values on the boundary"),
    (space(lambda m: H1(m) * H1(m)), ValueError, "no values on the boundary"),
    (space(lambda m: HCurl(m, order=1)), Exception, "no displacement is free there along the norm"),
    (space(lambda m: TangentialFacetFESpace(m)), Exception, "no displacement is free there along"),
    (space(lambda m: FacetFESpace(m)), ValueError, r"1 component\(s\)"),
    (space(lambda m: NumberSpace(m)), ValueError, r"1 component\(s\)"),
    (space(lambda m: NumberSpace(m) ** 2), Exception, "no free displacement dof"),
    (space(lambda m: LACSpace(VectorH1(m), slave="bottom")), ValueError, "V is itself a LACSpace"),
    (space(lambda m: H1(m), "hex"), Exception, "has 1 component.*3D; give a vector-valued space"),
    (space(lambda m: H1(m, dim=2), "hex"), Exception, "has 2 component.*3D"),
    (
        space(lambda m: VectorH1(m, complex=True), "hex"),
        Exception,
        "is complex; contact needs real",
    ),
    (lambda: LACSpace(VectorH1(Make1DMesh(3)), slave="left"), ValueError, "mesh of dimension 1"),
    (options(), TypeError, "slave = None must be a pattern of boundary names or a boundary region"),
    (options(slave=3), TypeError, "slave = 3 must be a pattern"),
    (options(slave=ElementId(VOL, 0)), TypeError, "slave = .* must be a pattern"),
    (options(slave="rim"), ValueError, "slave='rim' matches no boundary face; .*'bottom'"),
    (options(slave=OTHER.Boundaries("bottom")), ValueError, "region of another mesh"),
    (options(slave="bottom", components="2"), TypeError, "components = '2' must be 1, 2 or 3"),
    (options(slave="bottom", components=1.5), TypeError, "components = 1.5 must be 1, 2 or 3"),
    (options(slave="bottom", components=True), TypeError, "components = True"),
    (options(slave="bottom", components=4), ValueError, "components = 4 must be 1, 2 or 3"),
    (options(slave="bottom", autoupdate="no"), TypeError, "autoupdate = 'no' must be True or"),
    (options(slaves="bottom"), TypeError, "there is no argument 'slaves'; the arguments are V, "),
    (lambda: LACSpace(VectorH1(OTHER), "bottom"), TypeError, "'bottom' was given without a name; "),
    (
        lambda: LACSpace(VectorH1(OTHER, order=2), slave=OTHER.Materials(".*")),
        ValueError,
        "slave must be a boundary region",
    ),
    (method(lambda Q: Q.WithComponents(None)), TypeError, "components = None"),
    (method(lambda Q: Q.WithComponents(10**7)), ValueError, "components = 10000000 must be 1, 2"),
    (method(lambda Q: Q.CoreDofs(-1)), IndexError, "no macro-element -1"),
    (method(lambda Q: Q.CoreDofs("a")), TypeError, "macro = 'a'"),
]


def bubble(mesh=None, **flags):
    return lambda: BubbleVectorH1(mesh or OTHER, **flags)


BUBBLE = [
    (bubble(order=1), Exception, r"which boundaries get bubbles.* 'bottom', 'left'"),
    (bubble(slave="rim"), Exception, r"pattern 'rim' matches none of the boundaries 'bottom'"),
    (bubble(slave=OTHER.Boundaries("rim")), Exception, "region matches none"),
    (bubble(brick("quad"), slave=OTHER.Boundaries("left")), Exception, "belongs to another mesh"),
    (bubble(slave=OTHER.Materials(".*")), Exception, "must be one of boundaries"),
    (bubble(slave=7), TypeError, "pattern or a Region"),
    (bubble(slave=None), TypeError, "slave = None must be a pattern or a Region"),
    (bubble(slave="left", hoprolongation=True), Exception, "leaves no place for bubbles"),
    (bubble(slave="left", order_policy=ORDER_POLICY.CONSTANT), Exception, "VARIABLE"),
    (bubble(Make1DMesh(3), slave="left"), Exception, "two- or three-dimensional"),
    (bubble(slave="["), ValueError, r"slave = '\[' is no regular expression"),
    (bubble(slave=2.5), TypeError, "slave = 2.5 must be a pattern or a Region"),
    (bubble(slave="left", dirichlet="["), ValueError, r"dirichlet = '\[' is no regular expression"),
    (bubble(slave="left", dirichlet=2.5), TypeError, "dirichlet = 2.5 must be a pattern or a Reg"),
    *(
        (
            lambda mesh=mesh: BubbleVectorH1(mesh, slave="left"),
            TypeError,
            r"BubbleVectorH1: mesh = .* must be an ngsolve\.Mesh",
        )
        for mesh in (None, 3, "mesh", b"mesh")
    ),
    *(
        (
            bubble(slave="left", order=order),
            (TypeError, ValueError),
            r"order = .* must be an integer from 1",
        )
        for order in (0, -1, 2.5, "2", True, None, 10**6, 10**400)
    ),
]


def split(mesh, slave, **flags):
    return lambda: SplitSlaveFaces(mesh, slave, **flags)


def quadratic(dim):
    ngmesh = unstructured(dim, 0.5).ngmesh
    ngmesh.SecondOrder()
    return Mesh(ngmesh)


def five_edges():
    """A hole whose circle is met by five edges only: new vertices would leave the body."""
    body = MoveTo(-1.2, -1.2).Rectangle(2.4, 2.4).Face() - Circle((0, 0), 1).Face()
    body.edges.name = "rim"
    coarse = {"maxh": 10, "curvaturesafety": 0.5, "segmentsperedge": 0.5}
    return Mesh(OCCGeometry(body, dim=2).GenerateMesh(**coarse))


CUBE = unstructured(3, 0.5)
SPLIT = [
    *(
        case
        for mesh, other in ((OTHER, brick("quad")), (CUBE, brick("tet")))
        for case in (
            (split(mesh, "rim"), ValueError, "slave='rim' matches no boundary face; the boundarie"),
            (split(mesh, mesh.Boundaries("rim")), ValueError, "slave=<Region> matches no boundary"),
            (split(mesh, other.Boundaries("left")), Exception, "slave is a region of another mesh"),
            (split(mesh, mesh.Materials(".*")), Exception, "slave = .* must be a pattern of bound"),
            (split(mesh, mesh.BBoundaries(".*")), Exception, "slave = .* must be a pattern of bou"),
            (split(mesh, 3), TypeError, "slave = 3 must be a pattern"),
            (split(quadratic(mesh.dim), "top"), Exception, "second order"),
        )
    ),
    (split(OTHER.ngmesh, "left"), TypeError, r"mesh = <Mesh> must be an ngsolve\.Mesh"),
    (
        split(CUBE, "top", hexes="cubes"),
        ValueError,
        "hexes = 'cubes' must be one of 'pyramids', 'h",
    ),
    (split(Make1DMesh(3), "left"), Exception, "must be two- or three-dimensional"),
    # Tetrahedra with two faces on the sphere: no centre of one sees the other.
    (split(ball(3, 0.6, order=1), "surface"), Exception, "fold over"),
    (split(five_edges(), "rim"), Exception, "fold over"),
]


@pytest.mark.parametrize(("call", "error", "text"), [*LACSPACE, *BUBBLE, *SPLIT])
def test_refused(call, error, text):
    with pytest.raises(error, match=text):
        call()


def test_spaces_that_serve():
    for V in Compress(VectorH1(OTHER, order=2)), H1(OTHER, order=2, dim=2), H1(OTHER, order=2) ** 2:
        assert LACSpace(V, slave="bottom").nmacros == 4


def test_region_and_pattern_are_the_same():
    region = OTHER.Boundaries("left") + OTHER.Boundaries("top")
    spaces = [BubbleVectorH1(OTHER, slave=slave) for slave in ("left|top", region)]
    assert isinstance(spaces[0], VectorH1)
    dofs = [[list(el.dofs) for el in V.Elements(BND)] for V in spaces]
    assert dofs[0] == dofs[1]
    for mesh in (OTHER, CUBE):
        region = mesh.Boundaries("left") + mesh.Boundaries("top")
        meshes = [SplitSlaveFaces(mesh, slave) for slave in ("left|top", region)]
        vertices = [[[v.nr for v in el.vertices] for el in m.Elements()] for m in meshes]
        assert vertices[0] == vertices[1]
