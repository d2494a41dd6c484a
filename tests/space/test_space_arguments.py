"""What spaces and SplitSlaveFaces are given by mistake: the argument, its value, the remedy."""

from functools import partial

import ngsolve as ngs
import pytest
from bricks import ball, brick, unstructured
from netgen.occ import Circle, MoveTo, OCCGeometry
from ngsolve.meshes import Make1DMesh

from ngslac import BubbleVectorH1, LACSpace, SplitSlaveFaces

MESH, OTHER, CUBE = brick("trig"), brick("quad"), unstructured(3, 0.5)
P2 = ngs.VectorH1(MESH, order=2)
Q = LACSpace(P2, slave="bottom")


def space(V):
    return partial(LACSpace, V, slave="bottom")


def lac(**flags):
    return partial(LACSpace, P2, **flags)


def bubble(mesh=MESH, **flags):
    return partial(BubbleVectorH1, mesh, **flags)


def split(mesh, slave, **flags):
    return partial(SplitSlaveFaces, mesh, slave, **flags)


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


NORMAL = "no displacement is free there along the norm"
LACSPACE = [
    (space(None), TypeError, "V = None must be a displacement space, such as VectorH1"),
    (space(MESH), TypeError, "V = <ngsolve.comp.Mesh"),
    (space(ngs.GridFunction(P2)), TypeError, "V = <ngsolve.comp.GridFunction"),
    (space("VectorH1"), TypeError, "V = 'VectorH1' must be a displacement space"),
    (space(ngs.Discontinuous(ngs.VectorH1(MESH))), Exception, "has no dofs there. Remedy"),
    (space(ngs.VectorH1(MESH, definedon="no")), Exception, "has no dofs there. Remedy"),
    (space(ngs.L2(MESH, order=1)), ValueError, "no values on the boundary"),
    (space(ngs.H1(MESH) * ngs.H1(MESH)), ValueError, "no values on the boundary"),
    (space(ngs.HCurl(MESH, order=1)), Exception, NORMAL),
    (space(ngs.TangentialFacetFESpace(MESH)), Exception, NORMAL),
    (space(ngs.FacetFESpace(MESH)), ValueError, r"1 component\(s\)"),
    (space(ngs.NumberSpace(MESH)), ValueError, r"1 component\(s\)"),
    (space(ngs.NumberSpace(MESH) ** 2), Exception, "no free displacement dof"),
    (space(Q), ValueError, "V is itself a LACSpace"),
    (
        partial(LACSpace, ngs.VectorH1(Make1DMesh(3)), slave="left"),
        ValueError,
        "mesh of dimension 1",
    ),
    (lac(), TypeError, "slave = None must be a pattern of boundary names or a boundary region"),
    (lac(slave=ngs.ElementId(ngs.VOL, 0)), TypeError, "slave = .* must be a pattern"),
    (lac(slave="rim"), ValueError, "slave='rim' matches no boundary face; .*'bottom'"),
    (lac(slave=OTHER.Boundaries("bottom")), ValueError, "region of another mesh"),
    (lac(slave=MESH.Materials(".*")), ValueError, "slave must be a boundary region"),
    (lac(slave="bottom", components="2"), TypeError, "components = '2' must be 1, 2 or 3"),
    (lac(slave="bottom", components=1.5), TypeError, "components = 1.5 must be 1, 2 or 3"),
    (lac(slave="bottom", components=True), TypeError, "components = True"),
    (lac(slave="bottom", components=4), ValueError, "components = 4 must be 1, 2 or 3"),
    (lac(slave="bottom", autoupdate="no"), TypeError, "autoupdate = 'no' must be True or"),
    (lac(slaves="bottom"), TypeError, "there is no argument 'slaves'; the arguments are V, "),
    (partial(Q.WithComponents, None), TypeError, "components = None"),
    (partial(Q.WithComponents, 10**7), ValueError, "components = 10000000 must be 1, 2 or 3"),
    (partial(Q.CoreDofs, -1), IndexError, "no macro-element -1"),
    (partial(Q.CoreDofs, "a"), TypeError, "macro = 'a'"),
]
NO_MESH = r"BubbleVectorH1: mesh = .* must be an ngsolve\.Mesh"
NO_ORDER = (TypeError, ValueError), r"order = .* must be an integer from 1"
BUBBLE = [
    (bubble(order=1), Exception, r"which boundaries get bubbles.* 'bottom', 'left'"),
    (bubble(slave="rim"), Exception, r"pattern 'rim' matches none of the boundaries 'bottom'"),
    (bubble(slave=MESH.Boundaries("rim")), Exception, "region matches none"),
    (bubble(slave=OTHER.Boundaries("left")), Exception, "belongs to another mesh"),
    (bubble(slave=MESH.Materials(".*")), Exception, "must be one of boundaries"),
    (bubble(slave=None), TypeError, "slave = None must be a pattern or a Region"),
    (bubble(slave="left", hoprolongation=True), Exception, "leaves no place for bubbles"),
    (bubble(slave="left", order_policy=ngs.ORDER_POLICY.CONSTANT), Exception, "VARIABLE"),
    (bubble(Make1DMesh(3), slave="left"), Exception, "two- or three-dimensional"),
    (bubble(slave="["), ValueError, r"slave = '\[' is no regular expression"),
    (bubble(slave=2.5), TypeError, "slave = 2.5 must be a pattern or a Region"),
    (bubble(slave="left", dirichlet="["), ValueError, r"dirichlet = '\[' is no regular expression"),
    (bubble(slave="left", dirichlet=2.5), TypeError, "dirichlet = 2.5 must be a pattern or a Reg"),
    *((bubble(mesh, slave="left"), TypeError, NO_MESH) for mesh in (None, 3, "mesh", b"mesh")),
    *(
        (bubble(slave="left", order=order), *NO_ORDER)
        for order in (0, -1, 2.5, "2", True, None, 10**6, 10**400)
    ),
]
NO_PATTERN = "slave = .* must be a pattern of boundary names"
SPLIT = [
    *((split(m, "rim"), ValueError, "slave='rim' matches no boundary face") for m in (MESH, CUBE)),
    *((split(m, CUBE.Materials(".*")), Exception, NO_PATTERN) for m in (MESH, CUBE)),
    *((split(quadratic(dim), "top"), Exception, "second order") for dim in (2, 3)),
    (split(CUBE, CUBE.BBoundaries(".*")), Exception, NO_PATTERN),
    (split(MESH, MESH.Boundaries("rim")), ValueError, "slave=<Region> matches no boundary"),
    (split(MESH, OTHER.Boundaries("left")), Exception, "slave is a region of another mesh"),
    (split(MESH, 3), TypeError, "slave = 3 must be a pattern"),
    (split(MESH.ngmesh, "left"), TypeError, r"mesh = <Mesh> must be an ngsolve\.Mesh"),
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
