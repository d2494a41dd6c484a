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
    with pytest.raises(TypeError, match=r"mesh = None must be an ngsolve.Mesh"):
        BubbleVectorH1(None, slave="left")
    for order in -1, 1.5, 10**6, "two":
        with pytest.raises(ValueError, match=r"order = .* must be an integer from 1 to 50"):
            BubbleVectorH1(mesh, order=order, slave="left")
    with pytest.raises(Exception, match="two- or three-dimensional"):
        BubbleVectorH1(Make1DMesh(3), slave="left")
