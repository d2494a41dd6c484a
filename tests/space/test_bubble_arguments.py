"""BubbleVectorH1: how the slave boundary is given, and what is refused."""

import pytest
from ngsolve import BND, ORDER_POLICY, VectorH1
from ngsolve.meshes import Make1DMesh
from splitmeshes import square

from ngslac import BubbleVectorH1


def test_region_and_pattern_are_the_same():
    mesh = square()
    region = mesh.Boundaries("left") + mesh.Boundaries("top")
    spaces = [BubbleVectorH1(mesh, slave=slave) for slave in ("left|top", region)]
    assert isinstance(spaces[0], VectorH1)
    assert [list(el.dofs) for el in spaces[0].Elements(BND)] == [
        list(el.dofs) for el in spaces[1].Elements(BND)
    ]


def test_wrong_arguments():
    mesh, other = square(), square()
    with pytest.raises(Exception, match=r"which boundaries get bubbles.* 'bottom', 'left'"):
        BubbleVectorH1(mesh, order=1)
    with pytest.raises(Exception, match=r"pattern 'rim' matches none of the boundaries 'bottom'"):
        BubbleVectorH1(mesh, slave="rim")
    with pytest.raises(Exception, match="region matches none"):
        BubbleVectorH1(mesh, slave=mesh.Boundaries("rim"))
    with pytest.raises(Exception, match="belongs to another mesh"):
        BubbleVectorH1(mesh, slave=other.Boundaries("left"))
    with pytest.raises(Exception, match="must be one of boundaries"):
        BubbleVectorH1(mesh, slave=mesh.Materials(".*"))
    with pytest.raises(TypeError, match="pattern or a Region"):
        BubbleVectorH1(mesh, slave=7)
    with pytest.raises(Exception, match="leaves no place for bubbles"):
        BubbleVectorH1(mesh, slave="left", hoprolongation=True)
    with pytest.raises(Exception, match="VARIABLE"):
        BubbleVectorH1(mesh, slave="left", order_policy=ORDER_POLICY.CONSTANT)
    with pytest.raises(Exception, match="two- or three-dimensional"):
        BubbleVectorH1(Make1DMesh(3), slave="left")


@pytest.mark.parametrize("wrong", [None, 3, "mesh", b"mesh"])
def test_what_is_no_mesh(wrong):
    with pytest.raises(TypeError, match=r"BubbleVectorH1: mesh = .* must be an ngsolve\.Mesh"):
        BubbleVectorH1(wrong, slave="left")


@pytest.mark.parametrize("wrong", [0, -1, 2.5, "2", True, None, 10**6, 10**400])
def test_what_is_no_order(wrong):
    with pytest.raises((TypeError, ValueError), match=r"order = .* must be an integer from 1"):
        BubbleVectorH1(square(), slave="left", order=wrong)


def test_no_slave():
    with pytest.raises(TypeError, match="slave = None must be a pattern or a Region"):
        BubbleVectorH1(square(), slave=None)


@pytest.mark.parametrize("name", ["slave", "dirichlet"])
def test_what_is_no_pattern(name):
    flags = {"slave": "left"}
    with pytest.raises(ValueError, match=rf"{name} = '\[' is no regular expression"):
        BubbleVectorH1(square(), **(flags | {name: "["}))
    with pytest.raises(TypeError, match=f"{name} = 2.5 must be a pattern or a Region"):
        BubbleVectorH1(square(), **(flags | {name: 2.5}))
