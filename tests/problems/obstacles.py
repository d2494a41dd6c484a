"""A block on a rigid obstacle, in 2D and 3D: Signorini's problem."""

from bricks import brick
from ngsolve import CF, BilinearForm, GridFunction, InnerProduct, Parameter, VectorH1, ds
from press import Press, linear

from ngslac import LACContact, LACSpace

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
    X = V * LACSpace(V, slave="bottom")
    (u, lam), (v, _) = X.TnT()
    load, a = Parameter(1.0), BilinearForm(X)
    pressed = CF(traction or (0,) * (dim - 1) + (-1.0,))
    a += linear(u, v) - load * InnerProduct(pressed, v) * ds("top")
    contact = LACContact(u, lam, obstacle=CF(gap), **law)
    return Press(mesh, X, a, GridFunction(X), contact, load)
