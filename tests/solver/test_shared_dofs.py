"""Spaces whose vertices share dofs: iterated as they are factored."""

import numpy as np
import pytest
from netgen.occ import Box, Compound, IdentificationType, OCCGeometry, Pnt, X, Y, Z
from ngsolve import Compress, Mesh, Periodic, VectorH1
from press import press3d, same, solved

from ngslac import LACSpace
from ngslac.linear.vertices import FirstOnly


def periodic_blocks(_):
    """Two blocks, each the same at its left and its right, and at its front and its back."""
    lower, upper = Box(Pnt(0, 0, -0.5), Pnt(1, 1, 0)), Box(Pnt(0, 0, 0), Pnt(1, 1, 0.5))
    for name, block, size in (("lower", lower, 0.45), ("upper", upper, 0.35)):
        block.mat(name).maxh = size
        for axis in (X, Y):
            ends = block.faces.Max(axis), block.faces.Min(axis)
            ends[0].Identify(ends[1], f"{name}{axis}", IdentificationType.PERIODIC)
    lower.faces.Max(Z).name, lower.faces.Min(Z).name = "master", "bottom"
    upper.faces.Min(Z).name, upper.faces.Max(Z).name = "slave", "top"
    return Mesh(OCCGeometry(Compound([lower, upper])).GenerateMesh())


SPACES = {
    "periodic": lambda mesh, **flags: Periodic(VectorH1(mesh, **flags)),
    "compressed": lambda mesh, **flags: Compress(Periodic(VectorH1(mesh, **flags))),
    "quasi-periodic": lambda mesh, **flags: Periodic(VectorH1(mesh, **flags), phase=[-1.0] * 4),
}


@pytest.mark.parametrize("space", SPACES)
def test_as_the_direct_solver(space):
    given = {"space": SPACES[space], "change": periodic_blocks, "friction": 0.2}
    problem, reference = press3d(**given), press3d(**given)
    linear = solved(problem, solver="iterative").linear
    solved(reference, solver="direct")
    assert (linear.method, linear.factorisations) == ("iterative", 0)
    same(problem, reference, 1e-8)


def test_the_first_node_keeps_what_is_shared():
    dofs = np.array([[4, 5, 6], [-1, -1, -1], [4, 5, 6], [4, 8, 9]])
    expected = [[4, 5, 6], [-1, -1, -1], [-1, -1, -1], [-1, 8, 9]]
    assert FirstOnly(dofs).tolist() == expected


def test_interleaved_components_are_refused():
    mesh = press3d(order=1).mesh
    with pytest.raises(ValueError, match="make V without interleaved"):
        LACSpace(VectorH1(mesh, order=2, interleaved=True), slave="slave")
