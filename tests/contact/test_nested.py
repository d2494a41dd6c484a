"""Contact in products of products, and in powers: it is found, or refused; nothing crashes."""

import subprocess
import sys
from pathlib import Path

import press
import pytest

HOME = Path(press.__file__).parent
SOLVE = """
import sys
from ngsolve import H1, BilinearForm, Compress, FESpace, GridFunction, NumberSpace, Periodic
from ngsolve import VectorH1, VectorValued, ds, dx
from press import linear, two_blocks
from ngslac import ContactSolver, LACContact, LACSpace

mesh = two_blocks(2, h=0.5)
V = VectorH1(mesh, order=2, dirichlet="bottom|top")
Q, S, N = LACSpace(V, slave="slave"), H1(mesh), NumberSpace(mesh)
X = eval(sys.argv[1])


def every(t):
    return [q for p in t for q in every(p)] if isinstance(t, (list, tuple)) else [t]


def at(t, path):
    for k in path:
        t = t[k]
    return t


trial, test = X.TnT()
(u, lam), v = (at(trial, eval(path)) for path in sys.argv[2:]), at(test, eval(sys.argv[2]))
contact = LACContact(u, lam, master="master")
contact.Update()
a = BilinearForm(X)
a += linear(u, v) + v[1] * ds("slave")
for p, q in zip(every(trial), every(test)):
    if p is not u and p is not lam and "**" not in sys.argv[1]:
        a += p * q * dx
gf = GridFunction(X)
ContactSolver(a, gf, contact).Solve(printing=False)
print("force", round(contact.Force()[1], 6))
"""
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


def run(space, *paths):
    """What a process of its own prints, and the last line of its errors."""
    command = [sys.executable, "-c", SOLVE, space, *map(repr, paths)]
    done = subprocess.run(
        command, capture_output=True, text=True, check=False, cwd=HOME, timeout=120
    )
    assert done.returncode >= 0, f"signal {-done.returncode}"
    return done.stdout, done.stderr


@pytest.fixture(scope="module")
def force():
    return run("V * Q", (0,), (1,))[0].splitlines()[-1]


@pytest.mark.parametrize(("space", "u", "lam"), FOUND)
def test_contact_in_products(space, u, lam, force):
    out, err = run(space, u, lam)
    assert out.splitlines()[-1:] == [force], err


@pytest.mark.parametrize(("space", "u", "lam", "words"), REFUSED)
def test_what_is_no_place_for_contact(space, u, lam, words):
    assert words in run(space, u, lam)[1]
