"""Two elastic bodies of any shape, the upper one moved down by a prescribed displacement."""

import numpy as np
from netgen.occ import Compound, OCCGeometry, Y, Z
from ngsolve import CF, Mesh, TaskManager, VectorH1
from posed import posed
from press import linear


def body(shape, dim, name, h, contact, held):
    """`contact` tells of the centre of a side whether it is one of contact, `held` whether held."""
    axis = Y if dim == 2 else Z
    sides = shape.edges if dim == 2 else shape.faces
    (shape.faces if dim == 2 else shape.solids).name = name
    sides.name = name + "_side"
    for side in sides:
        at = np.array([side.center.x, side.center.y, side.center.z][:dim])
        if contact(at):
            side.name = name + "_contact"
    far = sides.Min(axis) if held == "below" else sides.Max(axis)
    far.name = name + "_held"
    shape.maxh = h
    return shape


def meshed(dim, *bodies, curve=1):
    mesh = Mesh(OCCGeometry(Compound(bodies), dim=dim).GenerateMesh())
    return mesh.Curve(curve) if curve > 1 else mesh


def pressed(mesh, down, *, slave="up", master="low", order=2, held="up_held|low_held", **options):
    """Solved where "up_held" has moved down by `down`, with a linear bulk."""
    dim = mesh.dim
    V = VectorH1(mesh, order=order, dirichlet=held)
    if "obstacle" not in options:
        options = {"master": f"{master}_contact"} | options
    problem = posed(V, lambda u, v, load: linear(u, v), slave=f"{slave}_contact", **options)
    way = CF((0,) * (dim - 1) + (-down,))
    problem.gf.components[0].Set(way, definedon=mesh.Boundaries("up_held"))
    with TaskManager():
        problem.solver().Solve(printing=False)
    return problem


__all__ = ["body", "meshed", "pressed"]
