"""Contact in products of products, and in powers: it is found, or refused; nothing crashes."""

import pytest
from ngsolve import (
    H1,
    BilinearForm,
    Compress,
    FESpace,
    GridFunction,
    NumberSpace,
    Periodic,
    VectorH1,
    VectorValued,
    ds,
    dx,
)
from press import linear, two_blocks

from ngslac import ContactSolver, LACContact, LACSpace

FOUND = [
    ("V * Q * N", (0,), (1,)),
    ("S * Q * V", (2,), (1,)),
    ("FESpace([V * Q, S])", (0, 0), (0, 1)),
    ("FESpace([S, V * Q])", (1, 0), (1, 1)),
    ("FESpace([FESpace([FESpace([V, S]), Q]), N])", (0, 0, 0), (0, 1)),
    ("FESpace([V * S, S * Q])", (0, 0), (1, 1)),
    ("FESpace([V, Q, (S * S)**2])", (0,), (1,)),
]
REFUSED = [
    ("(V * Q)**2", (0, 0), (0, 1), "u belongs to a power of a space"),
    ("(V * Q)**2", (0, 0), (1, 1), "u belongs to a power of a space"),
    ("(V * Q)**1", (0, 0), (0, 1), "u belongs to a power of a space"),
    ("((V * Q)**2)**2", (0, 0, 0), (0, 0, 1), "u belongs to a power of a space"),
    ("FESpace([(V * Q)**2, S])", (0, 0, 0), (0, 0, 1), "u belongs to a power of a space"),
    ("FESpace([V, (Q * S)**2])", (0,), (1, 0, 0), "lam belongs to a power of a space"),
    ("VectorValued(V * Q, 2)", (0, 0), (0, 1), "u belongs to a power of a space"),
    ("FESpace([V, Q**2])", (0,), (1,), "lam must belong to a LACSpace"),
    ("(V**2) * Q", (0,), (1,), "lam was made for another displacement space"),
    ("Compress(V * Q)", (0,), (1,), "lam must belong to a LACSpace"),
    ("Periodic(V * Q)", (0,), (1,), "lam must belong to a LACSpace"),
]


@pytest.fixture(scope="module")
def spaces():
    mesh = two_blocks(2, h=0.5)
    V = VectorH1(mesh, order=2, dirichlet="bottom|top")
    factors = {"V": V, "Q": LACSpace(V, slave="slave"), "S": H1(mesh), "N": NumberSpace(mesh)}
    kinds = (Compress, FESpace, Periodic, VectorValued)
    return factors | {kind.__name__: kind for kind in kinds}


def every(t):
    """All functions of a nested product."""
    return [q for p in t for q in every(p)] if isinstance(t, (list, tuple)) else [t]


def at(t, path):
    for k in path:
        t = t[k]
    return t


def force(X, u, lam, *, others=True):
    """The force of the contact; `others` get a mass, which NGSolve does not have for powers."""
    trial, test = X.TnT()
    a = BilinearForm(X)
    a += linear(at(trial, u), at(test, u)) + at(test, u)[1] * ds("slave")
    for p, q in zip(every(trial), every(test), strict=True):
        if others and p is not at(trial, u) and p is not at(trial, lam):
            a += p * q * dx
    contact = LACContact(at(trial, u), at(trial, lam), master="master")
    ContactSolver(a, GridFunction(X), contact).Solve(printing=False)
    return contact.Force()[1]


@pytest.mark.parametrize(("space", "u", "lam"), FOUND)
def test_contact_in_products(space, u, lam, spaces):
    expected = force(spaces["V"] * spaces["Q"], (0,), (1,))
    found = force(eval(space, spaces), u, lam, others="**" not in space)
    assert found == pytest.approx(expected, rel=1e-6)


@pytest.mark.parametrize(("space", "u", "lam", "words"), REFUSED)
def test_what_is_no_place_for_contact(space, u, lam, words, spaces):
    X = eval(space, spaces)
    with pytest.raises(Exception, match=words):
        LACContact(at(X.TrialFunction(), u), at(X.TrialFunction(), lam), master="master").Update()
