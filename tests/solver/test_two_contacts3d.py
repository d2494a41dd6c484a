"""Several contacts in one problem in 3D: blocks on each other, and on a rigid floor."""

import numpy as np
import pytest
from netgen.meshing import Mesh as NetgenMesh
from ngsolve import CF, BilinearForm, GridFunction, InnerProduct, Mesh, VectorH1, ds, x, y, z
from ngsolve.nonlinearsolvers import NewtonSolver
from press import linear, numpy

from ngslac import ContactSolver, FormSum, LACContact, LACSpace
from ngslac.meshes.boxes import AddBody, StructuredBox

BODIES = {"top": (2, "hex"), "middle": (3, "prism"), "base": (2, "tet")}  # divisions, shape
TRACTION = (0.1, 0.05, -1.0)


def pile_mesh():
    """Three blocks of height 1/2 on each other; their sides are named after the body."""
    mesh = NetgenMesh(dim=3)
    for level, (body, (n, kind)) in zip((2, 1, 0), BODIES.items(), strict=True):
        wider = 0.1 * (2 - level)
        lateral = np.linspace(-wider, 1 + wider, n + 1)
        height = np.array([0.5 * level, 0.5 * level + 0.5])
        names = _names(body)
        AddBody(mesh, body, StructuredBox(lateral, lateral, height, kind, names=names))
    mesh.Compress()
    return Mesh(mesh)


def _names(body):
    return lambda side, centre: f"{body}_{side}"


def pile(traction=TRACTION, friction=0.5, slaves=("top_bottom", "middle_bottom")):
    """All of it held by friction on the clamped base; the slave sides are the given ones."""
    mesh = pile_mesh()
    masters = {
        "top_bottom": "middle_top",
        "middle_top": "top_bottom",
        "middle_bottom": "base_top",
        "base_top": "middle_bottom",
    }
    V = VectorH1(mesh, order=2, dirichlet="base_bottom")
    X = V * LACSpace(V, slave=slaves[0]) * LACSpace(V, slave=slaves[1])
    (u, *lams), (v, *_) = X.TnT()
    a = BilinearForm(X)
    a += linear(u, v) - InnerProduct(CF(traction), v) * ds("top_top")
    contacts = [
        LACContact(u, lam, master=masters[slave], friction=friction)
        for lam, slave in zip(lams, slaves, strict=True)
    ]
    return a, GridFunction(X), contacts


@pytest.mark.parametrize(
    "slaves",
    [
        ("top_bottom", "middle_bottom"),
        ("middle_top", "middle_bottom"),  # the block in between is the slave of both
        ("top_bottom", "base_top"),  # and now the master of both
    ],
)
def test_forces_pass_through_the_pile_in_3d(slaves):
    a, gf, contacts = pile(slaves=slaves)
    last = ContactSolver(a, gf, contacts).Solve(printing=False)
    moment = np.cross((0.5, 0.5, 1.5), TRACTION)  # of the load about the origin
    for contact, slave in zip(contacts, slaves, strict=True):
        sign = 1 if slave.endswith("bottom") else -1
        assert sign * contact.Force() == pytest.approx(-np.array(TRACTION), abs=1e-9)
        assert sign * contact.Moment((0, 0, 0)) == pytest.approx(-moment, abs=1e-8)
    statuses = np.concatenate([c.Table()["status"] for c in contacts])
    assert np.bincount(statuses, minlength=3).tolist() == [last.open, last.stick, last.slip]
    assert last.open + last.stick + last.slip == sum(c.space.nmacros for c in contacts)


def test_form_sum_of_two_contacts_in_3d():
    """The stock solver on the sum, from a start that is closed everywhere."""
    a, gf, contacts = pile()
    ContactSolver(a, gf, contacts).Solve(printing=False)
    expected = numpy(gf)
    gf.vec.FV().NumPy()[:] *= 0.9
    form = FormSum(a, *contacts)
    newton = NewtonSolver(form, gf, freedofs=gf.space.FreeDofs(), inverse="umfpack")
    newton.Solve(maxerr=1e-12, maxit=20, printing=False)
    assert numpy(gf) == pytest.approx(expected, abs=1e-10 * np.abs(expected).max())


def test_order_of_the_contacts_does_not_matter_in_3d():
    results = []
    for turned in (False, True):
        a, gf, contacts = pile()
        ContactSolver(a, gf, contacts[::-1] if turned else contacts).Solve(printing=False)
        results.append(numpy(gf))
    assert results[0] == pytest.approx(results[1], abs=1e-11)


def test_different_laws_in_one_problem():
    """Tied above, sliding below: the whole pile slides over the base."""
    a, gf, _ = pile(traction=(0.02, 0.0, -1.0))
    u, lam, floor = gf.space.TrialFunction()
    v = gf.space.TestFunction()[0]
    a += 0.3 * (u[0] * v[0] + u[1] * v[1]) * ds("top_top")  # soft springs hold the rest
    tied = LACContact(u, lam, master="middle_top", tied=True)
    sliding = LACContact(u, floor, master="base_top", friction=0.01)
    ContactSolver(a, gf, [tied, sliding]).Solve(printing=False)
    assert tied.Force() == pytest.approx(sliding.Force(), abs=1e-9)
    assert sliding.Force()[2] == pytest.approx(1, rel=1e-9)
    assert sliding.Force()[0] == pytest.approx(-0.01, rel=0.05)
    assert set(tied.Table()["status"]) == {1}
    assert 2 in sliding.Table()["status"]


def test_a_master_and_an_obstacle():
    """Two blocks of the pile without the base: the lower one stands on a rigid floor."""
    mesh = pile_mesh()
    V = VectorH1(mesh, order=2, dirichlet="base.*")
    X = V * LACSpace(V, slave="top_bottom") * LACSpace(V, slave="middle_bottom")
    (u, upper, floor), (v, *_) = X.TnT()
    load = CF((0.05 * (1 + y), 0.02, -(1 + x)))
    a, gf = BilinearForm(X), GridFunction(X)
    a += linear(u, v) - InnerProduct(load, v) * ds("top_top")
    between = LACContact(u, upper, master="middle_top", friction=0.5)
    below = LACContact(u, floor, obstacle=0.5 - z, friction=0.5)
    ContactSolver(a, gf, [between, below]).Solve(printing=False)
    expected = [-0.075, -0.02, 1.5]
    assert between.Force() == pytest.approx(expected, abs=1e-9)
    assert below.Force() == pytest.approx(expected, abs=1e-9)
    assert between.Moment((0, 0, 0)) == pytest.approx(below.Moment((0, 0, 0)), abs=1e-8)
