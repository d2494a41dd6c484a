"""What bubbles and split faces do to the condition number of the stiffness matrix."""

import numpy as np
import pytest
from ngsolve import BilinearForm, Grad, InnerProduct, Sym, VectorH1, div, dx
from scipy.linalg import eigvalsh
from scipy.sparse import csr_matrix
from spaces3d import KINDS, brick

from ngslac import BubbleVectorH1, SplitSlaveFaces

HELD = {"dirichlet": "top"}


def grid(kind, order):
    return brick(3, kind, 3) if order == 1 else brick(2, kind, 1)


def condition(V):
    """Of elasticity with both Lame constants 1, scaled to a diagonal of ones."""
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
def test_bubbles_keep_the_condition_number(kind, order):
    """They are nearly orthogonal to the rest: 13 % at most."""
    mesh = grid(kind, order)
    plain = condition(VectorH1(mesh, order=order, **HELD))
    assert condition(BubbleVectorH1(mesh, order=order, slave="bottom", **HELD)) < 1.15 * plain


@pytest.mark.parametrize(
    ("kind", "hexes", "factor"),
    [
        ("tet", "pyramids", 4),
        ("hex", "pyramids", 4),
        ("hex", "hexes", 6),
        ("prism", "pyramids", 8),
        ("prism_side", "pyramids", 3),
        ("pyramid", "pyramids", 2),
    ],
)
@pytest.mark.parametrize("order", [1, 2])
def test_split_faces_raise_the_condition_number(kind, hexes, factor, order):
    """Up to eight times, for high prisms: bubbles are the better choice for iterative solvers."""
    mesh = grid(kind, order)
    split = SplitSlaveFaces(mesh, "bottom", hexes=hexes)
    plain, after = (condition(VectorH1(m, order=order, **HELD)) for m in (mesh, split))
    assert after < factor * plain
