"""Elements that a deformation turns inside out."""

import numpy as np
from ngsolve import VOL, Det, ElementId, Grad, GridFunction, Id, IfPos, Integrate

from ngslac.errors import ContactConvergenceError

__all__ = ["InvertedError", "InvertedMessage"]


class InvertedError(ContactConvergenceError):
    """Newton's method converged to a state with elements turned inside out."""


def InvertedMessage(form, gf):
    """Which elements the displacement of a compiled contact form turns inside out; "" if none.

    Parameters
    ----------
    form : ContactForm
        Tells the displacement.
    gf : GridFunction
        On the product space.

    Returns
    -------
    str
    """
    space, mesh = form.component, form.fes.mesh
    u, first = GridFunction(space), form.offset * form.fes.dim
    values = u.vec.FV().NumPy()
    values[:] = gf.vec.FV().NumPy()[first : first + len(values)]
    folded = IfPos(Det(Id(mesh.dim) + Grad(u)), 0, 1)
    shares = Integrate(folded, mesh, order=2 * space.globalorder, element_wise=True)
    numbers = np.flatnonzero(np.asarray(shares.NumPy()) > 0)
    if not len(numbers):
        return ""
    element = mesh[ElementId(VOL, int(numbers[0]))]
    corners = [mesh[v].point for v in element.vertices]
    middle = tuple(float(x) for x in np.mean(corners, axis=0).round(6))
    count = f"{len(numbers)} elements turn" if len(numbers) > 1 else "an element turns"
    return f"{count} inside out (det F <= 0), the first in '{element.mat}' at {middle}"
