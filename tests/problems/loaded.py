"""A block held by contact alone and loaded by a traction."""

from ngsolve import CF, InnerProduct, ds
from press import press


def loaded(*still, side=0.0, gap=0.0, on="top", spring=0, **flags):
    """A traction (side * load + x, y) on a block that starts above another one by the gap.

    The rest goes to `press`; the load is 0.
    """
    problem = press(spring=spring, **flags)
    v, d = problem.X.TestFunction()[0], problem.mesh.dim
    moving = CF((side * problem.load,) + (0,) * (d - 1))
    problem.a += -InnerProduct(CF(still) + moving, v) * ds(on)
    problem.load.Set(0.0)
    apart = {"upper": CF((0,) * (d - 1) + (gap,))}
    problem.gf.components[0].Set(problem.mesh.MaterialCF(apart, default=CF((0,) * d)))
    return problem
