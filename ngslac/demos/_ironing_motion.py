"""A driven body: Dirichlet values that grow with the load, and a start that fits them."""

from __future__ import annotations

import numpy as np

__all__ = ["RigidMotion"]


class RigidMotion:
    """Sets the displacement of a driven boundary by moving the whole body, for `LoadStepper`.

    Moving only the boundary would crush the elements at it in the start of Newton's method. Where
    the extrapolation of the last steps has put the boundary in its place already, nothing is moved.

    Parameters
    ----------
    V : ngsolve.VectorH1
        Displacement space, the first component of the product space.
    body : str
        Material of the body.
    driven : str
        Boundary with the prescribed displacement, the same in all of its points.
    target : callable
        ``target()`` is the wanted displacement, one number per direction.

    Examples
    --------
    >>> from netgen.occ import unit_square
    >>> from ngsolve import GridFunction, Mesh, VectorH1
    >>> mesh = Mesh(unit_square.GenerateMesh(maxh=1))
    >>> V = VectorH1(mesh, order=2, dirichlet="top")
    >>> gf = GridFunction(V * V)
    >>> RigidMotion(V, body=".*", driven="top", target=lambda: (0.1, -0.2))(gf)
    >>> [round(value, 12) for value in gf.components[0](mesh(0.3, 0.4))]
    [0.1, -0.2]
    """

    def __init__(self, V, *, body, driven, target):
        self.target = target
        self.first = [V.Range(k).start for k in range(V.mesh.dim)]
        self.vertices = np.array(_Vertices(V.mesh.Materials(body)))
        self.leader = _Vertices(V.mesh.Boundaries(driven))[0]

    def __call__(self, gf):
        """Move the body in `gf`, on the product space."""
        values = gf.components[0].vec.FV().NumPy()
        for first, wanted in zip(self.first, self.target(), strict=True):
            # Vertex functions add up to 1; those of edges and faces do not take part.
            values[first + self.vertices] += wanted - values[first + self.leader]


def _Vertices(region):
    return sorted({vertex.nr for element in region.Elements() for vertex in element.vertices})
