"""A block on a rigid obstacle, in 2D and 3D: Signorini's problem."""

from bricks import brick
from ngsolve import CF, InnerProduct, VectorH1, ds
from posed import posed
from press import linear

RIM = {2: {"dirichletx": "left|right"}, 3: {"dirichletx": "left|right", "dirichlety": "front|back"}}


def block_on_obstacle(
    gap, *, dim=2, n=None, kind="hex", order=2, traction=None, flags=None, space=VectorH1, **law
):
    """The unit square or cube pressed onto an obstacle below it; the gap is a function.

    `traction` acts at the top, `flags` go to the displacement space, the rest to LACContact.
    """
    n = n or {2: 8, 3: 4}[dim]
    mesh = brick("trig", n, n) if dim == 2 else brick(kind, n)
    V = space(mesh, order=order, **(RIM[dim] if flags is None else flags))
    pressed = CF(traction or (0,) * (dim - 1) + (-1.0,))

    def bulk(u, v, load):
        return linear(u, v) - load * InnerProduct(pressed, v) * ds("top")

    return posed(V, bulk, slave="bottom", obstacle=CF(gap), **law)
