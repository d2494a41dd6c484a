"""Finite sliding: the contact direction lies between both normals, nearer to the stiffer body's."""

import numpy as np
import pytest
from netgen.occ import Circle, Compound, MoveTo, OCCGeometry, Y
from ngsolve import (
    CF,
    BilinearForm,
    Grad,
    GridFunction,
    Id,
    Mesh,
    Parameter,
    Variation,
    VectorH1,
    ds,
    dx,
)

from ngslac import ContactSolver, LACContact, LACSpace, LoadStepper
from ngslac.materials import NeoHooke
from ngslac.meshes import TwoBlocks

FRICTION = 0.2


def bodies(mesh, young, slave="slave", master="master", *, pressure=0.0, friction=None, **flags):
    """A solver for neo-Hookean bodies of these moduli, by names."""
    V = VectorH1(mesh, order=2, **flags)
    X = V * LACSpace(V, slave=slave)
    (u, lam), (v, _) = X.TnT()
    a = BilinearForm(X)
    a += Variation(NeoHooke(Id(2) + Grad(u), mesh.MaterialCF(young), 0.3) * dx)
    a += pressure * v[1] * ds("top")
    contact = LACContact(u, lam, master=master, finite=True, friction=friction)
    return ContactSolver(a, GridFunction(X), contact)


def block(upper=1.0, lower=1e4, *, h=(0.25, 0.43), fixed="bottom", **flags):
    """A block on a slab that is wider, both coarse; the top of the block is led sideways."""
    mesh = TwoBlocks(*h, overhang=1.0, aligned=False, quads=True, height=0.5)
    held = {"dirichlet": fixed, "dirichletx": "top"}
    return bodies(mesh, {"upper": upper, "lower": lower}, friction=FRICTION, **held, **flags)


def share(*young, **flags):
    solver = block(*young, **flags)
    (contact,) = solver.contacts
    solver.a.AssembleLinearization(solver.gf.vec)
    contact.Prepare(solver.a.mat)
    return contact.State()["share"][0]


def test_friction_on_a_rigid_slab_is_the_coefficient_times_the_force():
    """Along the normals of the slave, whose facets tilt, it was 4 % less."""
    press, drag = Parameter(0), Parameter(0)
    solver = block(pressure=0.05 * press)
    LoadStepper(solver, press).Integrate(steps=1, printing=False)
    mover = LoadStepper(solver, drag, prescribe={"top": CF((drag, 0))})
    mover.Integrate(0.25, steps=5, printing=False)
    (contact,) = solver.contacts
    assert set(contact.Table()["status"]) == {2}
    right, up = contact.Force()
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
    solver = bodies(mesh, {"disc": 1e3, "floor": 1e7}, "rim", "top", dirichlet="hub|fixed")
    t = Parameter(0)
    stepper = LoadStepper(solver, t, prescribe={"hub": CF((0, -0.05 * t))})
    stepper.Integrate(steps=2, printing=False)
    right, up = solver.contacts[0].Force()
    assert up > 30
    assert abs(right) < 1e-4 * up


@pytest.mark.parametrize("h", [(0.25, 0.43), (0.1, 0.4), (0.3, 0.1)])
@pytest.mark.parametrize("stiffer", [1, 1e3, 1e-3, 3])
def test_share_is_that_of_the_stiffness(stiffer, h):
    """Whatever meshes there are, within a little."""
    found = share(1, stiffer, h=h)
    assert found / (1 - found) == pytest.approx(stiffer, rel=0.5)


def test_a_prescribed_surface_is_rigid():
    assert share(fixed="bottom|master") == 1.0
