"""Several contact forms in one problem: their sum is what is solved."""

from types import SimpleNamespace

import numpy as np
import pytest
from netgen.meshing import Mesh as NetgenMesh
from ngsolve import CF, BilinearForm, GridFunction, InnerProduct, Mesh, VectorH1, ds, x, y, z
from ngsolve.nonlinearsolvers import NewtonSolver
from press import linear, numpy, two_blocks

from ngslac import AugmentedLagrangianSolver, ContactSolver, FormSum, LACContact, LACSpace
from ngslac.meshes.boxes import StructuredBox

BODIES = {"top": (2, "hex"), "middle": (3, "prism"), "base": (2, "tet")}  # divisions, shape
TRACTION = {2: (0.1, -1.0), 3: (0.1, 0.05, -1.0)}
MASTERS = {
    "slave": "master",
    "top_bottom": "middle_top",
    "middle_top": "top_bottom",
    "middle_bottom": "base_top",
    "base_top": "middle_bottom",
}


def three_blocks():
    """Blocks of height 1/2 on each other; their sides are named after the body."""
    mesh = NetgenMesh(dim=3)
    for level, (body, (n, kind)) in zip((2, 1, 0), BODIES.items(), strict=True):
        wider = 0.1 * (2 - level)
        lateral = np.linspace(-wider, 1 + wider, n + 1)
        names = lambda side, _, body=body: f"{body}_{side}"  # noqa: E731
        height = [0.5 * level, 0.5 * level + 0.5]
        StructuredBox(lateral, lateral, height, kind, names=names).AddTo(mesh, body)
    mesh.Compress()
    return Mesh(mesh)


def pile(dim, slaves=("top_bottom", "middle_bottom"), *, load=None, held="base_bottom", laws=None):
    """Blocks on each other, held by friction on a rigid floor (2D) or a clamped base (3D)."""
    mesh = two_blocks(2, h=0.34) if dim == 2 else three_blocks()
    top, slaves = ("top", ("slave", "bottom")) if dim == 2 else ("top_top", slaves)
    V = VectorH1(mesh, order=2, dirichlet="" if dim == 2 else held)
    X = V * LACSpace(V, slave=slaves[0]) * LACSpace(V, slave=slaves[1])
    (u, *lams), (v, *_) = X.TnT()
    a = BilinearForm(X)
    a += linear(u, v) - InnerProduct(CF(load or TRACTION[dim]), v) * ds(top)
    laws = laws or [{"friction": 0.5}] * 2
    partners = [{"master": MASTERS[s]} if s in MASTERS else {"obstacle": CF(0)} for s in slaves]
    contacts = [
        LACContact(u, lam, **(partner | law))
        for lam, partner, law in zip(lams, partners, laws, strict=True)
    ]
    return SimpleNamespace(a=a, gf=GridFunction(X), contacts=contacts, slaves=slaves)


def solved(p, kind=ContactSolver):
    return kind(p.a, p.gf, p.contacts).Solve(printing=False)


@pytest.mark.parametrize(
    ("dim", "slaves"),
    [
        (2, None),
        (3, ("top_bottom", "middle_bottom")),
        (3, ("middle_top", "middle_bottom")),  # the block in between is the slave of both
        (3, ("top_bottom", "base_top")),  # and now the master of both
    ],
)
def test_forces_pass_through_the_pile(dim, slaves):
    p = pile(dim, slaves)
    last = solved(p)
    force = np.array(TRACTION[dim])
    arm = np.array((0.5, 1.0) if dim == 2 else (0.5, 0.5, 1.5))  # middle of the top
    moment = np.cross(*(np.pad(vector, (0, 3 - dim)) for vector in (arm, force)))
    moment, origin = moment if dim == 3 else moment[2], (0,) * dim
    for contact, slave in zip(p.contacts, p.slaves, strict=True):
        sign = -1 if slave in ("middle_top", "base_top") else 1
        assert sign * contact.Force() == pytest.approx(-force, abs=1e-9)
        assert sign * contact.Moment(origin) == pytest.approx(-moment, abs=1e-8)
    statuses = np.concatenate([c.Table()["status"] for c in p.contacts])
    assert np.bincount(statuses, minlength=3).tolist() == [last.open, last.stick, last.slip]
    assert last.open + last.stick + last.slip == sum(c.space.nmacros for c in p.contacts)


def test_the_augmented_lagrangian_holds_the_pile():
    """All is open at the start."""
    p = pile(2)
    solved(p, AugmentedLagrangianSolver)
    for contact in p.contacts:
        assert contact.Force() == pytest.approx([-0.1, 1.0], abs=1e-9)


@pytest.mark.parametrize("dim", [2, 3])
def test_form_sum_and_order_of_the_contacts(dim):
    """The stock solver on the sum, from a start that is closed everywhere; turned around."""
    p, turned = pile(dim), pile(dim)
    solved(p)
    expected = numpy(p.gf)
    turned.contacts.reverse()
    solved(turned)
    assert numpy(turned.gf) == pytest.approx(expected, abs=1e-11)
    p.gf.vec.FV().NumPy()[:] *= 0.9
    form = FormSum(p.a, *p.contacts)
    newton = NewtonSolver(form, p.gf, freedofs=p.gf.space.FreeDofs(), inverse="umfpack")
    newton.Solve(maxerr=1e-12, maxit=20, printing=False)
    assert numpy(p.gf) == pytest.approx(expected, abs=1e-10 * np.abs(expected).max())


def test_different_laws_in_one_problem():
    """Tied above, sliding below: the whole pile slides over the base."""
    p = pile(3, load=(0.02, 0.0, -1.0), laws=[{"tied": True}, {"friction": 0.01}])
    u, v = p.gf.space.TrialFunction()[0], p.gf.space.TestFunction()[0]
    p.a += 0.3 * (u[0] * v[0] + u[1] * v[1]) * ds("top_top")  # soft springs hold the rest
    solved(p)
    tied, sliding = p.contacts
    assert tied.Force() == pytest.approx(sliding.Force(), abs=1e-9)
    assert sliding.Force()[2] == pytest.approx(1, rel=1e-9)
    assert sliding.Force()[0] == pytest.approx(-0.01, rel=0.05)
    assert set(tied.Table()["status"]) == {1}
    assert 2 in sliding.Table()["status"]


def test_a_master_and_an_obstacle():
    """Two blocks of the pile without the base: the lower one stands on a rigid floor."""
    floor = {"master": None, "obstacle": 0.5 - z, "friction": 0.5}
    load = (0.05 * (1 + y), 0.02, -(1 + x))
    p = pile(3, load=load, held="base.*", laws=[{"friction": 0.5}, floor])
    solved(p)
    between, below = p.contacts
    for contact in p.contacts:
        assert contact.Force() == pytest.approx([-0.075, -0.02, 1.5], abs=1e-9)
    assert between.Moment((0, 0, 0)) == pytest.approx(below.Moment((0, 0, 0)), abs=1e-8)
