"""A contact law in NumPy through the door of the compiled one: a spring with a limit, and a drag.

The pressure grows with the overlap up to a limit, the tangential traction against the slip.
"""

import numpy as np
import pytest
from blocks import block_mesh, contact_form
from form import Form
from netgen.meshing import NgException
from ngsolve import CF, BilinearForm, Grad, GridFunction, InnerProduct, VectorH1, dx

from ngslac import ContactSolver, LACContact, LACSpace, LoadState, SaveState
from ngslac.meshes import TwoBlocks
from ngslac.meshes.blocks3d import TwoBlocks3D


class LimitedSpring:
    """Pressure ``min(k (start - gap), limit)``, and traction ``-drag slip`` with it."""

    def __init__(self, k=20.0, limit=np.inf, drag=3.0, start=0.0):
        self.k, self.limit, self.drag, self.start = k, limit, drag, start

    def __call__(self, places):
        normal, gap, slip = (places[name] for name in ("normal", "gap", "slip"))
        closed, eye = gap < self.start, np.eye(normal.shape[1])
        pressure = np.where(closed, np.minimum(self.k * (self.start - gap), self.limit), 0)
        grows = closed & (pressure < self.limit)
        across = self.drag * closed
        return {
            "traction": -pressure[:, None] * normal - across[:, None] * slip,
            "by_gap": self.k * grows[:, None] * normal,
            "by_slip": -np.multiply.outer(across, eye),
            "by_normal": -np.multiply.outer(pressure, eye),
            "status": np.where(closed, 1.0, 0.0),
        }


def with_law(dim, finite, law):
    mesh = block_mesh(dim) if dim == 2 else block_mesh(dim, "hex", "tet", 2, 1)
    return contact_form(mesh, finite=finite, law=law)


@pytest.mark.parametrize("finite", [False, True])
@pytest.mark.parametrize("dim", [2, 3])
def test_derivative(dim, finite):
    """Of every branch, where normals turn and slip counts from another configuration."""
    law = LimitedSpring()
    form = Form(with_law(dim, finite, law))
    form.bend(0.02, 0.0, degrees=20, noise=0.01, seed=1)
    form.commit()
    form.bend(0.04, 0.05, degrees=30, noise=0.01, seed=2)
    form.follow()
    form.values[form.multipliers] = np.random.default_rng(4).normal(size=form.multipliers.shape)
    gaps = np.unique(form.table()["gap"][form.table()["area"] > 0])
    law.start = gaps[-2:].mean()  # the last one is open, and the first one is at the limit
    law.limit = law.k * (law.start - gaps[:2].mean())
    assert set(form.table()["status"]) == {0, 1}
    assert form.derivative_error(40 if dim == 2 else 6) <= 1e-7


@pytest.mark.parametrize("limit", [np.inf, 4e-4])
@pytest.mark.parametrize("finite", [False, True])
@pytest.mark.parametrize("make", [lambda: TwoBlocks(0.3), lambda: TwoBlocks3D("hex", "tet", 3, 2)],
                         ids=["2D", "3D"])  # fmt: skip
def test_solve(make, finite, limit):
    """Columns in series: the pressure of two bodies of length 1 and a spring, up to its limit."""
    mesh, k, down = make(), 2.0, 1e-3
    V = VectorH1(mesh, order=2, dirichlet="bottom|top")
    X = V * LACSpace(V, slave="slave")
    (u, lam), (v, _) = X.TnT()
    law = LimitedSpring(k, limit, drag=0.0)
    contact = LACContact(u, lam, master="master", finite=finite, law=law)
    a = BilinearForm(X)
    a += InnerProduct(Grad(u) + Grad(u).trans, Grad(v)) * dx  # modulus 2, no Poisson effect
    gf = GridFunction(X)
    way = CF((0,) * (mesh.dim - 1) + (-down,))
    gf.components[0].Set(way, definedon=mesh.Boundaries("top"))
    ContactSolver(a, gf, contact).Solve(printing=False)
    expected = min(down / (0.5 + 0.5 + 1 / k), limit)
    assert contact.Table()["pressure"] == pytest.approx(expected, rel=5e-3 if finite else 1e-8)


def test_refused():
    with pytest.raises(ValueError, match="a law of your own says all: drop law, or"):
        contact_form(block_mesh(2), law=LimitedSpring(), friction=0.3)
    with pytest.raises(TypeError, match="law = 3 must be a function from places"):
        contact_form(block_mesh(2), law=3)
    contact = with_law(2, False, lambda places: None)
    with pytest.raises(NgException, match="law must return a dict of arrays of numbers, not"):
        contact.Evaluate(GridFunction(contact.form.fes))
    contact = with_law(2, False, lambda places: {"traction": places["normal"]})
    with pytest.raises(NgException, match="a law has given 0 numbers as 'by_gap' in place of"):
        contact.Evaluate(GridFunction(contact.form.fes))


def test_the_law_is_named_and_its_state_is_no_other_laws(tmp_path):
    solvers = []
    for options in ({"law": LimitedSpring()}, {"friction": 0.3}):
        V = VectorH1(TwoBlocks(0.3), order=2, dirichlet="bottom|top")
        X = V * LACSpace(V, slave="slave")
        (u, lam), (v, _) = X.TnT()
        a = BilinearForm(X)
        a += InnerProduct(Grad(u), Grad(v)) * dx
        contact = LACContact(u, lam, master="master", **options)
        solvers.append(ContactSolver(a, GridFunction(X), contact))
        solvers[-1].Solve(printing=False)
    assert "a law of its own" in repr(solvers[0].contacts[0])
    SaveState(tmp_path / "state", solvers[0])
    LoadState(tmp_path / "state", solvers[0])
    with pytest.raises(ValueError, match=r"another .*: .*a law of its own there"):
        LoadState(tmp_path / "state", solvers[1])
