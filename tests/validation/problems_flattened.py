"""A flattened rubber cylinder: its force by a penalty method, and the work against the energy."""

import numpy as np
from hertz_large import YOUNG, CylinderMesh
from ngsolve import (
    BND,
    CF,
    BilinearForm,
    Grad,
    GridFunction,
    Id,
    IfPos,
    InnerProduct,
    Integrate,
    Variation,
    VectorH1,
    ds,
    dx,
    y,
)

from ngslac.materials import NeoHooke


def Penalty(h, depth, steps, factor):
    """Force by a penalty on the rigid plane y = 0, by NGSolve alone."""
    mesh = CylinderMesh(h)
    V = VectorH1(
        mesh, order=2, dirichletx="sym", dirichlety="middle", definedon=mesh.Materials("cylinder")
    )
    u, gf, down = V.TrialFunction(), GridFunction(V), GridFunction(V)
    below = -(y + u[1])
    a = BilinearForm(V)
    a += Variation(NeoHooke(Id(2) + Grad(u), YOUNG, 0.49).Compile() * dx("cylinder"))
    a += Variation(factor / 2 * IfPos(below, below, 0) ** 2 * ds("slave", bonus_intorder=10))
    down.Set(CF((0, -depth / steps)))
    residual, step = gf.vec.CreateVector(), gf.vec.CreateVector()
    for _ in range(steps):
        gf.vec.data += down.vec
        for _ in range(40):
            a.Apply(gf.vec, residual)
            a.AssembleLinearization(gf.vec)
            step.data = a.mat.Inverse(V.FreeDofs()) * residual
            gf.vec.data -= step
            if abs(InnerProduct(step, residual)) < 1e-22:
                break
        else:
            raise RuntimeError("the penalty solution does not converge")
    below = -(y + gf[1])
    pressure = factor * IfPos(below, below, 0)
    return 2 * Integrate(pressure, mesh, BND, definedon=mesh.Boundaries("slave"), order=20)


def EnergyError(approach, force, energy):
    """Error of the work of the force relative to the energy gained; NaN of too few steps.

    By Simpson's rule over pairs of equal steps. The first pair starts at rest, where the slope of
    the force is not smooth: the work is counted from its end on.
    """
    n = (len(force) - 2) // 2 * 2
    if n < 2:
        return float("nan")
    d, f, w = (np.asarray(values)[-n - 1 :] for values in (approach, force, energy))
    weights = np.ones(n + 1)
    weights[1:-1:2], weights[2:-1:2] = 4, 2
    work = weights @ f * (d[1] - d[0]) / 3
    return float(work / (w[-1] - w[0]) - 1)
