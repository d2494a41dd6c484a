"""Problems in which Newton's method with active set fails, and what the other method does."""

import re
from types import SimpleNamespace

import numpy as np
import pytest
from netgen.occ import Box as Brick
from netgen.occ import Circle, Compound, Cylinder, MoveTo, OCCGeometry, Pnt, X, Y, Z
from ngsolve import (
    CF,
    BilinearForm,
    Grad,
    GridFunction,
    InnerProduct,
    Integrate,
    Mesh,
    Parameter,
    Sym,
    Trace,
    VectorH1,
    ds,
    dx,
    x,
)

from ngslac import (
    ContactConvergenceError,
    ContactSolver,
    FloatingBodyError,
    LACContact,
    LACSpace,
    LoadStepper,
)
from ngslac.errors import Reason
from ngslac.materials import Stress
from ngslac.solve.barrier import Barrier
from ngslac.solve.pressures import Bilateral, Unilateral

ROUNDING = 1e-15


pytestmark = pytest.mark.usefixtures("whole_systems")


def problem(mesh, pairs, load, *, held="", tied=(), guided=(), space=None, **law):
    """Displacement of order 2, a contact for each pair of slave and master; E = 1, nu = 0.3.

    `load(v, t)` is subtracted from the bulk, t the parameter `load` of the problem.
    """
    V = VectorH1(mesh, order=2, dirichlet=held, **(space or {}))
    fes = V
    for slave, _ in pairs:
        fes = fes * LACSpace(V, slave=slave)
    (u, *lams), (v, *_) = fes.TnT()
    t, a, gf = Parameter(1.0), BilinearForm(fes), GridFunction(fes)
    a += InnerProduct(Stress(Sym(Grad(u)), 1.0, 0.3), Sym(Grad(v))) * dx
    if load:
        a += -1.0 * load(u, v, t)
    contacts = [
        LACContact(
            u,
            lam,
            master=master,
            **({"tied": True} if slave in tied else law | {"bilateral": slave in guided}),
        )
        for lam, (slave, master) in zip(lams, pairs, strict=True)
    ]
    solver = ContactSolver(a, gf, contacts)
    return SimpleNamespace(load=t, gf=gf, contacts=contacts, mesh=mesh, solver=solver)


def solved(*args, off=(), **flags):
    """Force and contact table of each contact; those of these numbers are switched off."""
    p = problem(*args, **flags)
    for number in off:
        p.contacts[number].Deactivate()
    p.solver.Solve(printing=False)
    return [(c.Force(), c.Table()) for c in p.contacts]


def blocks(*boxes):
    """A face (x0, y0, x1, y1, maxh) for each, with edges low, high, left and right."""
    faces = []
    for k, (x0, y0, x1, y1, maxh) in enumerate(boxes):
        face = MoveTo(x0, y0).Rectangle(x1 - x0, y1 - y0).Face()
        face.faces.name, face.faces.maxh = f"block{k}", maxh
        face.edges.Min(X).name, face.edges.Max(X).name = f"left{k}", f"right{k}"
        face.edges.Min(Y).name, face.edges.Max(Y).name = f"low{k}", f"high{k}"
        faces.append(face)
    return Mesh(OCCGeometry(Compound(faces), dim=2).GenerateMesh())


ON_BASE = [("low1", "high0")]


def leaves(friction, tied=(), guided=(), off=(), count=2):
    """Thin leaves, clamped at the left; the last one is pressed down at its tip."""
    boxes = [(0, k, 30.0, k + 1, (1.3, 1.0)[k % 2]) for k in range(count)]
    pairs = [(f"low{k}", f"high{k - 1}") for k in range(1, count)]
    clamps, tip = "|".join(f"left{k}" for k in range(count)), f"right{count - 1}"
    press = lambda u, v, t: -1e-6 * t * v[1] * ds(tip)  # noqa: E731
    laws = {"tied": tied, "guided": guided, "off": off, "friction": friction}
    return solved(blocks(*boxes), pairs, press, held=clamps, **laws)


@pytest.mark.parametrize("friction", [None, 0.3, 1.0])
def test_leaves_in_bending(friction):
    """Two leaves meet at their tips alone, where the upper one hands on a part of its load."""
    ((force, table),) = leaves(friction)
    assert table["pressure"].min() >= -ROUNDING * table["pressure"].max()
    assert table["gap"].min() > -1e-10 * table["gap"].max()
    # Half of the load each: alike leaves that bend alike, the slope at the tip counts a little.
    assert force[1] == pytest.approx(0.5e-6, rel=0.05)
    assert table["x"][table["status"] > 0][:, 0].min() > 0.9 * 30


def test_a_state_that_carries_a_body_off_is_no_solution(monkeypatch):
    """However well it balances: the other method says what moves away."""
    said = "body 'leaf' moves off (rotation)"
    monkeypatch.setattr("ngslac.bodies.bodies.Bodies.Lost", lambda *_: [said])
    monkeypatch.setattr("ngslac.solve.system.Saddle.most", 2)  # it finds the status by itself
    with pytest.raises(FloatingBodyError, match=re.escape(said) + ": the loads exceed what contac"):
        leaves(0.3)


def test_newtons_error_stands_where_nothing_presses(monkeypatch):
    monkeypatch.setattr("ngslac.solve.interior.Springs.Pressure", lambda *_: 0.0)
    monkeypatch.setattr("ngslac.solve.system.Saddle.most", 2)
    with pytest.raises(ContactConvergenceError, match="no convergence in") as caught:
        leaves(0.3)
    # A traceback shows the other method's error as well.
    assert "nothing presses where the surfaces face" in str(caught.value.__cause__)


def test_leaves_some_of_them_tied():
    (force, _), (_, table) = leaves(None, tied=("low1",), count=3)
    assert force[1] + 1e-6 > 0
    assert table["pressure"].min() >= -ROUNDING * table["pressure"].max()


@pytest.mark.parametrize("friction", [None, 0.3])
def test_leaves_some_of_them_guided(friction):
    """The two lower ones slide on each other like leaves of one beam, and come not apart."""
    (_, guide), (_, table) = leaves(friction, guided=("low1",), count=3)
    assert set(guide["status"]) <= {1, 2}
    assert np.abs(guide["gap"]).max() < 1e-9 * np.abs(table["gap"]).max()
    assert guide["pressure"].min() < 0 < guide["pressure"].max()
    assert table["pressure"].min() >= -ROUNDING * table["pressure"].max()


def test_leaves_some_of_them_switched_off():
    """The lowest one is as if it were not there: two leaves meet at their tips."""
    (none, table), (force, _) = leaves(0.3, off=(0,), count=3)
    assert not np.any(none)
    assert np.all(table["status"] == 0)
    assert force[1] == pytest.approx(0.5e-6, rel=0.05)


@pytest.mark.parametrize("scale", [1e-3, 1.0, 1e3])
def test_pin_that_meets_its_hole_at_one_point(scale):
    """All of the load goes through contact, whatever the unit of length is."""
    radius, play = 1.0 * scale, 2e-3 * scale
    pin = Circle((0, -play), radius).Face()
    pin *= MoveTo(0, -5 * scale).Rectangle(5 * scale, 10 * scale).Face()
    plate = MoveTo(0, -4 * scale).Rectangle(4 * scale, 8 * scale).Face()
    plate -= Circle((0, 0), radius + play).Face()
    pin.faces.name, plate.faces.name = "pin", "plate"
    for face, name, size in ((pin, "slave", 0.12), (plate, "master", 0.16)):
        for edge in face.edges:
            edge.name = "far"
            if abs(edge.center.x) < 1e-9 * scale:
                edge.name = "middle"
            elif edge.center.x**2 + edge.center.y**2 < 1.5 * radius**2:
                edge.name, edge.maxh = name, size * scale
    mesh = Mesh(OCCGeometry(Compound([pin, plate]), dim=2).GenerateMesh(maxh=scale, grading=0.4))
    weight = 1e-4 / scale
    pull = lambda u, v, t: -weight * t * v[1] * dx("pin")  # noqa: E731
    free = {"dirichletx": "middle"}
    ((force, _),) = solved(mesh.Curve(2), [("slave", "master")], pull, held="far", space=free)
    area = Integrate(CF(1), mesh, definedon=mesh.Materials("pin"))
    assert force[1] == pytest.approx(weight * area, rel=1e-8)


def test_slip_in_all_directions_holds_a_ring():
    """A hot ring slips outwards everywhere; a second step in proportion needs no new status."""
    ring = Cylinder((0, 0, 0), Z, r=7, h=2) - Cylinder((0, 0, 0), Z, r=4.5, h=2)
    plate = Brick(Pnt(-9, -9, -3), Pnt(9, 9, 0))
    for solid, name, maxh in ((ring, "ring", 3.5), (plate, "plate", 6)):
        solid.mat(name)
        solid.faces.name, solid.maxh = name, maxh
    ring.faces.Min(Z).name, ring.faces.Max(Z).name = "slave", "top"
    plate.faces.Max(Z).name, plate.faces.Min(Z).name = "master", "bottom"
    mesh = Mesh(OCCGeometry(Compound([ring, plate])).GenerateMesh()).Curve(2)
    heat = mesh.MaterialCF({"ring": 2e-3}, default=0) / (1 - 2 * 0.3)

    def load(u, v, t):
        return heat * t * Trace(Grad(v)) * dx - 2e-4 * t * v[2] * ds("top")

    p = problem(mesh, [("slave", "master")], load, held="bottom", friction=0.15)
    p.load.Set(0)
    steps = LoadStepper(p.solver, p.load).Integrate(steps=3, printing=False)
    assert [step.cuts for step in steps] == [0, 0, 0]
    assert steps[-1].iterations == 0
    assert np.all(p.contacts[0].Table()["status"] == 2)


@pytest.mark.parametrize("steps", [1, 2, 5])
def test_loose_block_under_a_tool_that_comes_down(steps):
    """As long as the tool does not touch nothing pushes the block: it stays."""
    mesh = blocks((-1, -1, 1, 0, 0.5), (-0.5, 0, 0.5, 0.6, 0.35), (-0.4, 0.63, 0.4, 1.1, 0.3))
    pairs = [*ON_BASE, ("low2", "high1")]
    p = problem(mesh, pairs, None, held="low0|high2", friction=0.3)
    p.load.Set(0)
    down = {"high2": CF((0, -0.05)) * p.load}
    LoadStepper(p.solver, p.load, prescribe=down).Integrate(steps=steps, printing=False)
    force, other = (contact.Force()[1] for contact in p.contacts)
    assert force == pytest.approx(other, rel=1e-8)
    assert force > 0


@pytest.mark.parametrize("friction", [None, 0.3])
def test_block_that_nothing_pushes_stays_in_the_air(friction):
    mesh = blocks((-1, -1, 1, 0, 0.5), (-0.5, 0.02, 0.5, 0.6, 0.35))
    p = problem(mesh, ON_BASE, None, held="low0", friction=friction)
    p.solver.Solve(printing=False)
    assert np.abs(p.gf.vec.FV().NumPy()).max() < 1e-12


@pytest.mark.parametrize("size", [1e-4, 1e-10, 1e-16])
def test_force_is_that_of_the_load_however_small(size):
    mesh = blocks((0, -1, 1, 0, 0.35), (0, 1e-12, 1, 1, 0.26))
    press = lambda u, v, t: -size * t * v[1] * ds("high1")  # noqa: E731
    ((force, _),) = solved(mesh, ON_BASE, press, held="low0", friction=0.3)
    assert force[1] == pytest.approx(size, rel=1e-8)


def dragged(share):
    """A block that is pressed down and dragged to the side by a share of the friction."""
    mesh = blocks((-1, -1, 3, 0, 0.6), (0, 0, 2, 0.3, 0.21))
    drag = lambda u, v, t: -1e-3 * t * (v[1] - 0.3 * share * v[0]) * ds("low1")  # noqa: E731
    return problem(mesh, ON_BASE, drag, held="low0", friction=0.3)


def test_more_than_friction_carries():
    """The error comes soon, and says what happens to which body."""
    p = dragged(1.2)
    p.load.Set(0)
    with pytest.raises(FloatingBodyError, match=r"body 'block1' .*friction") as error:
        LoadStepper(p.solver, p.load).Integrate(steps=2, printing=False)
    assert Reason.EXHAUSTED in error.value.reason
    assert p.load.Get() == 0
    assert not np.any(p.gf.vec.FV().NumPy())


def test_nearly_all_that_friction_carries():
    p = dragged(0.97)
    p.solver.Solve(printing=False)
    along, normal = np.abs(p.contacts[0].Force())
    assert along == pytest.approx(0.3 * 0.97 * normal, rel=1e-8)


THREE = ((0, -1, 5, 0, 0.9), (0.2, 0, 1, 0.8, 0.4), (3.2, 0, 4, 0.8, 0.4))


@pytest.mark.parametrize(
    ("boxes", "slave", "load", "friction", "message"),
    [
        # Bodies of one material are told apart.
        (THREE, "low1|low2", lambda u, v, t: 1e-3 * v[1] * dx("block2"), 0.3, "body 'block2'"),
        (
            (THREE[0], (0.2, 0, 1, 0.8, 2.0)),
            "low1",
            lambda u, v, t: -1e-3 * x * v[1] * ds("high1"),
            0.3,
            "1 macro-elements only: refine its slave surface",
        ),
        (THREE[:2], "low1", lambda u, v, t: CF((1e-9, -1e-3)) * v * ds("high1"), None, "'block1'"),
    ],
)
def test_bodies_that_nothing_holds(boxes, slave, load, friction, message):
    with pytest.raises(FloatingBodyError, match=message):
        solved(blocks(*boxes), [(slave, "high0")], load, held="low0", friction=friction)


@pytest.mark.parametrize(("spring", "shift"), [(1e-7, 0.0), (1e-4, 1e5)])
def test_weak_spring_holds_a_block_that_slides_freely(spring, shift):
    """Also far from the origin."""
    mesh = blocks((shift, -1, shift + 5, 0, 0.9), (shift + 0.2, 0, shift + 1, 0.8, 0.4))
    pull = CF((1e-9, -1e-3))
    load = lambda u, v, t: (pull * v - spring * u[0] * v[0]) * ds("high1")  # noqa: E731
    p = problem(mesh, ON_BASE, load, held="low0")
    p.solver.Solve(printing=False)
    moved = Integrate(p.gf.components[0][0] * ds(mesh.Boundaries("high1")), mesh) / 0.8
    assert moved == pytest.approx(1e-9 / spring, rel=0.05)


def pressing(normal, gap, bound, bilateral=False):
    kind, start = (Bilateral, 0 * gap) if bilateral else (Unilateral, gap)
    return Barrier(kind(start, np.full(len(gap), 2.0), 1.0), normal, gap, bound, 15.0)


@pytest.mark.parametrize("bilateral", [False, True])
def test_step_of_the_barrier_is_a_newton_step(bilateral):
    """Change and Step solve the linearised equations, of Tresca's law where it rubs."""
    rng = np.random.default_rng(3)
    normal = rng.standard_normal((5, 3))
    normal /= np.linalg.norm(normal, axis=1)[:, None]
    gap, bound = rng.uniform(0.1, 1, 5), np.array([0.3, 0, 0.2, 0.5, 0])
    law = pressing(normal, gap, bound, bilateral)
    law.t = 0.1 * rng.standard_normal((5, 3)) * law.rubs[:, None]
    slip = rng.standard_normal((5, 3)) * law.rubs[:, None]
    slip -= np.sum(slip * normal, axis=1)[:, None] * normal
    law.Place(normal, gap, slip)
    law.w = law._Slack()
    law.nu = rng.uniform(0.5, 2, 5) * law.rubs
    stiffness, mu = law.Stiffness(), 1e-2
    jump = 1e-3 * rng.standard_normal((5, 3))
    step = law.Step(law.Change(mu) - np.einsum("kij,kj->ki", stiffness, jump))
    along = jump - np.sum(jump * normal, axis=1)[:, None] * normal
    closer, press = np.sum(jump * normal, axis=1), law.press
    if bilateral:
        assert step.press == pytest.approx(-press.slope * (gap - closer))
        assert law.products[1] == 3
    else:
        p, g = step.press
        assert press.p * g + press.g * p == pytest.approx(mu - press.products)
        assert g == pytest.approx(gap - press.g - closer)
    residual = slip + along + (law.nu + step.nu)[:, None] * law.t + law.nu[:, None] * step.t
    assert residual[law.rubs] == pytest.approx(0, abs=1e-12)
    product = law.nu * law.w + law.nu * step.w + law.w * step.nu
    assert product[law.rubs] == pytest.approx(mu)


def test_middle_of_the_barrier_is_inside_and_knows_the_gaps():
    normal = np.tile([0.0, 1.0], (4, 1))
    gap, bound = np.array([-1.0, 0.0, 1e-4, 50.0]), np.array([0.3, 0.3, 0, 0.3])
    law = pressing(normal, gap, bound)
    law.press.p, law.press.g = np.array([3.0, 1e-9, 1e-9, 1e-9]), np.full(4, 1e-3)
    law.t[:, 0] = bound
    law.Center(1e-2)
    assert law.press.products == pytest.approx(1e-2)
    assert (law.nu * law.w)[law.rubs] == pytest.approx(1e-2)
    assert np.all(np.linalg.norm(law.t, axis=1) <= 0.5 * law.s)
    assert law.press.p[0] == 3  # closed: the gap follows the pressure
    assert law.press.g[3] == pytest.approx(50)  # open: the pressure follows the gap
