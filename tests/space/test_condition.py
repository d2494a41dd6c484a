"""What bubbles and split faces do to the condition number of the stiffness matrix."""

import numpy as np
import pytest
from bricks import KINDS, brick
from ngsolve import BilinearForm, Grad, InnerProduct, Sym, VectorH1, div, dx
from scipy.linalg import eigvalsh
from scipy.sparse import csr_matrix

from ngslac import BubbleVectorH1, SplitSlaveFaces


def condition(space, mesh, order, **flags):
    """Of elasticity with both Lame constants 1, scaled to a diagonal of ones."""
    V = space(mesh, order=order, dirichlet="top", **flags)
    u, v = V.TnT()
    a = BilinearForm(InnerProduct(Sym(Grad(u)), 2 * Sym(Grad(v))) * dx + div(u) * div(v) * dx)
    values, columns, starts = (np.array(part) for part in a.Assemble().mat.CSR())
    free = np.flatnonzero(list(V.FreeDofs()))
    matrix = csr_matrix((values, columns, starts))[free][:, free].toarray()
    scale = 1 / np.sqrt(matrix.diagonal())
    eigenvalues = eigvalsh(matrix * np.outer(scale, scale))
    return eigenvalues[-1] / eigenvalues[0]


@pytest.mark.parametrize("order", [1, 2])
@pytest.mark.parametrize("kind", KINDS)
def test_bubbles_keep_it_and_split_faces_raise_it(kind, order):
    """Bubbles are nearly orthogonal to the rest: 13 % at most.

    Split high cells have eight times the number: bubbles are better for iterative solvers.
    """
    mesh = brick(kind, 3, 3) if order == 1 else brick(kind, 2, 1)
    plain = condition(VectorH1, mesh, order)
    assert condition(BubbleVectorH1, mesh, order, slave="bottom") < 1.15 * plain
    limits = {"pyramids": {"quad": 9, "prism": 8, "prism_side": 3, "pyramid": 2}.get(kind, 4)}
    if kind == "hex":
        limits["hexes"] = 6
    for hexes, factor in limits.items():
        split = SplitSlaveFaces(mesh, "bottom", hexes=hexes)
        assert condition(VectorH1, split, order) < factor * plain
