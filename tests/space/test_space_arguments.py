"""What LACSpace is given by mistake: messages name the argument, the value and what is wanted."""

import pytest
from ngsolve import (
    H1,
    L2,
    VOL,
    Compress,
    Discontinuous,
    ElementId,
    FacetFESpace,
    GridFunction,
    HCurl,
    NumberSpace,
    TangentialFacetFESpace,
    VectorH1,
)
from ngsolve.meshes import Make1DMesh, MakeStructured2DMesh

from ngslac import LACSpace


def Make():
    return MakeStructured2DMesh(nx=4, ny=3)


@pytest.mark.parametrize(
    ("space", "error", "text"),
    [
        (lambda m: None, TypeError, "V = None must be a displacement space, such as VectorH1"),
        (lambda m: m, TypeError, "V = <ngsolve.comp.Mesh"),
        (lambda m: GridFunction(VectorH1(m)), TypeError, "V = <ngsolve.comp.GridFunction"),
        (lambda m: "VectorH1", TypeError, "V = 'VectorH1' must be a displacement space"),
        (lambda m: Discontinuous(VectorH1(m)), Exception, "has no dofs there. Remedy"),
        (lambda m: VectorH1(m, definedon="no"), Exception, "has no dofs there. Remedy"),
        (lambda m: L2(m, order=1), ValueError, "no values on the boundary"),
        (lambda m: H1(m) * H1(m), ValueError, "no values on the boundary"),
        (lambda m: HCurl(m, order=1), Exception, "no displacement is free there along the normal"),
        (lambda m: TangentialFacetFESpace(m), Exception, "no displacement is free there along"),
        (lambda m: FacetFESpace(m), ValueError, r"1 component\(s\)"),
        (lambda m: NumberSpace(m), ValueError, r"1 component\(s\)"),
        (lambda m: NumberSpace(m) ** 2, Exception, "no free displacement dof"),
        (lambda m: LACSpace(VectorH1(m), slave="bottom"), ValueError, "V is itself a LACSpace"),
    ],
)
def test_space(space, error, text):
    with pytest.raises(error, match=text):
        LACSpace(space(Make()), slave="bottom")


def test_mesh_of_one_dimension():
    with pytest.raises(ValueError, match="mesh of dimension 1"):
        LACSpace(VectorH1(Make1DMesh(3)), slave="left")


@pytest.mark.parametrize(
    ("options", "error", "text"),
    [
        ({}, TypeError, "slave = None must be a pattern of boundary names or a boundary region"),
        ({"slave": 3}, TypeError, "slave = 3 must be a pattern"),
        ({"slave": ElementId(VOL, 0)}, TypeError, "slave = .* must be a pattern"),
        ({"slave": "rim"}, ValueError, "slave='rim' matches no boundary face; .*'bottom'"),
        ({"slave": Make().Boundaries("bottom")}, ValueError, "region of another mesh"),
        ({"slave": "bottom", "components": "2"}, TypeError, "components = '2' must be 1, 2 or 3"),
        ({"slave": "bottom", "components": 1.5}, TypeError, "components = 1.5 must be 1, 2 or 3"),
        ({"slave": "bottom", "components": True}, TypeError, "components = True"),
        ({"slave": "bottom", "components": 4}, ValueError, "components = 4 must be 1, 2 or 3"),
        ({"slave": "bottom", "autoupdate": "no"}, TypeError, "autoupdate = 'no' must be True or"),
        (
            {"slaves": "bottom"},
            TypeError,
            "there is no argument 'slaves'; the arguments are V, ",
        ),
    ],
)
def test_options(options, error, text):
    with pytest.raises(error, match=text):
        LACSpace(VectorH1(Make(), order=2), **options)


def test_slave_without_its_name():
    with pytest.raises(TypeError, match=r"'bottom' was given without a name; .* slave="):
        LACSpace(VectorH1(Make()), "bottom")


def test_region_of_the_volume():
    V = VectorH1(Make(), order=2)
    with pytest.raises(ValueError, match="slave must be a boundary region"):
        LACSpace(V, slave=V.mesh.Materials(".*"))


def test_spaces_that_serve():
    mesh = Make()
    for V in Compress(VectorH1(mesh, order=2)), H1(mesh, order=2, dim=2), H1(mesh, order=2) ** 2:
        assert LACSpace(V, slave="bottom").nmacros == 4


def test_methods():
    Q = LACSpace(VectorH1(Make(), order=2), slave="bottom")
    with pytest.raises(TypeError, match="components = None"):
        Q.WithComponents(None)
    with pytest.raises(ValueError, match="components = 10000000 must be 1, 2 or 3"):
        Q.WithComponents(10**7)
    with pytest.raises(IndexError, match="no macro-element -1"):
        Q.CoreDofs(-1)
    with pytest.raises(TypeError, match="macro = 'a'"):
        Q.CoreDofs("a")
