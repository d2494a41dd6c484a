"""Finite sliding: the contact direction lies between both normals, nearer to the stiffer body's."""

import numpy as np
import pytest
from netgen.occ import Circle, Compound, MoveTo, OCCGeometry, Y
from ngsolve import (
    CF,
    BilinearForm,
    Det,
    Grad,
    GridFunction,
    Id,
    InnerProduct,
    Mesh,
    Parameter,
    Variation,
    VectorH1,
    ds,
    dx,
    log,
)

from ngslac import ContactSolver, LACContact, LACSpace, LoadStepper

FRICTION = 0.2


def neo_hooke(u, young):
    la, G = young * 0.3 / 1.3 / 0.4, young / 2.6
    F = Id(2) + Grad(u)
    return G / 2 * (InnerProduct(F, F) - 2 - 2 * log(Det(F))) + la / 2 * log(Det(F)) ** 2


class Block:
    """A block on a slab that is wider, both coarse; the top of the block is led."""

    def __init__(self, upper=1.0, lower=1e4, *, fixed="fixed", order=2, h=(0.25, 0.43)):
        block, slab = (
            MoveTo(0, 0).Rectangle(1, 0.4).Face(),
            MoveTo(-1, -0.5).Rectangle(3, 0.5).Face(),
        )
        block.faces.name, slab.faces.name = "block", "slab"
        block.edges.name, slab.edges.name = "side", "fixed"
        block.edges.Min(Y).name, block.edges.Max(Y).name = "slave", "top"
        slab.edges.Max(Y).name = "master"
        block.faces.maxh, slab.faces.maxh = h
        mesh = Mesh(OCCGeometry(Compound([block, slab]), dim=2).GenerateMesh(quad_dominated=True))
        V = VectorH1(mesh, order=order, dirichlet=fixed, dirichletx=f"{fixed}|top")
        fes = V * LACSpace(V, slave="slave")
        (u, lam), (v, _) = fes.TnT()
        a, self.press = BilinearForm(fes), Parameter(0)
        a += Variation(neo_hooke(u, mesh.MaterialCF({"block": upper, "slab": lower})) * dx)
        a += self.press * 0.05 * v[1] * ds("top")
        self.contact = LACContact(u, lam, master="master", finite=True, friction=FRICTION)
        self.solver = ContactSolver(a, GridFunction(fes), self.contact)

    def drag(self, way, steps):
        LoadStepper(self.solver, self.press).Integrate(steps=1, printing=False)
        drag = Parameter(0)
        mover = LoadStepper(self.solver, drag, prescribe={"top": CF((drag, 0))})
        mover.Integrate(way, steps=steps, printing=False)
        return self

    def share(self):
        self.solver.a.AssembleLinearization(self.solver.gf.vec)
        self.contact.Prepare(self.solver.a.mat)
        return self.contact.form.History()["share"][0]


def test_friction_on_a_rigid_slab_is_the_coefficient_times_the_force():
    """Along the normals of the slave, whose facets tilt, it was 4 % less."""
    block = Block().drag(0.25, 5)
    assert set(block.contact.Table()["status"]) == {2}
    right, up = block.contact.Force()
    assert abs(right / up) == pytest.approx(FRICTION, rel=1e-4)


def test_no_force_aside_on_a_coarse_disc():
    disc = (Circle((0, 0), 1).Face() - Circle((0, 0), 0.3).Face()).Move((0, 1, 0))
    floor = MoveTo(-2, -0.5).Rectangle(4, 0.5).Face()
    disc.faces.name, floor.faces.name, floor.edges.name = "disc", "floor", "fixed"
    for edge in disc.edges:
        far = max(np.hypot(v.p.x, v.p.y - 1) for v in edge.vertices) > 0.9
        edge.name = "rim" if far else "hub"
    floor.edges.Max(Y).name = "top"
    disc.faces.maxh = floor.faces.maxh = 0.3
    mesh = Mesh(OCCGeometry(Compound([floor, disc]), dim=2).GenerateMesh()).Curve(2)
    V = VectorH1(mesh, order=2, dirichlet="hub|fixed")
    fes = V * LACSpace(V, slave="rim")
    u, lam = fes.TrialFunction()
    a, t = BilinearForm(fes), Parameter(0)
    a += Variation(neo_hooke(u, mesh.MaterialCF({"disc": 1e3, "floor": 1e7})) * dx)
    contact = LACContact(u, lam, master="top", finite=True)
    stepper = LoadStepper(
        ContactSolver(a, GridFunction(fes), contact), t, prescribe={"hub": CF((0, -0.05 * t))}
    )
    stepper.Integrate(steps=2, printing=False)
    right, up = contact.Force()
    assert up > 30
    assert abs(right) < 1e-4 * up


@pytest.mark.parametrize(
    ("young", "share"), [((1, 1), 0.5), ((1, 1e3), 0.999), ((1e3, 1), 0.001), ((1, 3), 0.75)]
)
def test_share_is_that_of_the_stiffness(young, share):
    """Whatever meshes there are, within a little."""
    for h in (0.25, 0.43), (0.1, 0.4), (0.3, 0.1):
        found = Block(*young, h=h).share()
        assert found / (1 - found) == pytest.approx(share / (1 - share), rel=0.5)


def test_a_prescribed_surface_is_rigid():
    assert Block(fixed="fixed|master").share() == 1.0


def test_share_is_part_of_the_history():
    block = Block()
    assert block.share() > 0.99
    history = block.contact.form.History()
    other = Block(1.0, 1.0)
    other.share()
    other.contact.form.SetHistory(history)
    assert other.contact.form.History()["share"] == history["share"]
