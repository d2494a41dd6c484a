"""Finite sliding: the contact direction lies between both normals, nearer to the stiffer body's."""

import numpy as np
import pytest
from netgen.occ import Circle, Compound, MoveTo, OCCGeometry, Y
from ngsolve import CF, Grad, Id, Mesh, Parameter, Variation, ds, dx
from press import press

from ngslac import LoadStepper, TimeStepper
from ngslac.materials import NeoHooke

FRICTION = 0.2


def bodies(young, *, pressure=0.0, **flags):
    """Neo-Hookean bodies, with their moduli by name; a load presses the top."""

    def bulk(u, v, load):
        law = NeoHooke(Id(2) + Grad(u), u.space.mesh.MaterialCF(young), 0.3)
        return Variation(law * dx), pressure * load * v[1] * ds("top")

    return press(spring=0, bulk=bulk, finite=True, **flags)


def block(upper=1.0, lower=1e4, *, h=(0.25, 0.43), fixed="bottom"):
    """A block on a wider slab, both coarse; the sideways motion of its top is prescribed."""
    mesh = {"h_master": h[1], "overhang": 1.0, "quads": True, "structured": False, "height": 0.5}
    held = {"dirichlet": fixed, "dirichletx": "top"}
    young = {"upper": upper, "lower": lower}
    return bodies(young, pressure=0.05, h=h[0], mesh_flags=mesh, flags=held, friction=FRICTION)


def share(*young, **flags):
    problem = block(*young, **flags)
    problem.a.AssembleLinearization(problem.gf.vec)
    problem.contact.Prepare(problem.a.mat)
    return problem.contact.State()["share"][0]


def test_friction_on_a_rigid_slab_is_the_coefficient_times_the_force():
    """It was 4 % less along the normals of the slave, because facets of the slave tilt."""
    problem, drag = block(), Parameter(0)
    solver, contact = problem.solver(), problem.contact
    problem.load.Set(0)
    LoadStepper(solver, problem.load).Integrate(steps=1, printing=False)
    mover = LoadStepper(solver, drag, prescribe={"top": CF((drag, 0))})
    mover.Integrate(0.25, steps=5, printing=False)
    assert set(contact.Table()["status"]) == {2}
    right, up = contact.Force()
    assert abs(right / up) == pytest.approx(FRICTION, rel=1e-4)


def test_no_force_aside_on_a_coarse_disc():
    disc = (Circle((0, 0), 1).Face() - Circle((0, 0), 0.3).Face()).Move((0, 1, 0))
    floor = MoveTo(-2, -0.5).Rectangle(4, 0.5).Face()
    disc.faces.name, floor.faces.name, floor.edges.name = "disc", "floor", "fixed"
    for edge in disc.edges:
        far = max(np.hypot(v.p.x, v.p.y - 1) for v in edge.vertices) > 0.9
        edge.name = "slave" if far else "hub"
    floor.edges.Max(Y).name = "master"
    disc.faces.maxh = floor.faces.maxh = 0.3
    mesh = Mesh(OCCGeometry(Compound([floor, disc]), dim=2).GenerateMesh()).Curve(2)
    held = {"dirichlet": "hub|fixed"}
    problem = bodies({"disc": 1e3, "floor": 1e7}, change=lambda _: mesh, flags=held)
    problem.load.Set(0)
    down = {"hub": CF((0, -0.05 * problem.load))}
    stepper = LoadStepper(problem.solver(), problem.load, prescribe=down)
    stepper.Integrate(steps=2, printing=False)
    right, up = problem.contact.Force()
    assert up > 30
    assert abs(right) < 1e-4 * up


@pytest.mark.parametrize("h", [(0.25, 0.43), (0.1, 0.4), (0.3, 0.1)])
@pytest.mark.parametrize("stiffer", [1, 1e3, 1e-3, 3])
def test_share_is_that_of_the_stiffness(stiffer, h):
    """The meshes change the ratio of the shares by at most a half."""
    found = share(1, stiffer, h=h)
    assert found / (1 - found) == pytest.approx(stiffer, rel=0.5)


def test_a_prescribed_surface_is_rigid():
    assert share(fixed="bottom|master") == 1.0


@pytest.mark.parametrize("dim", [2, 3])
@pytest.mark.parametrize("finite", [False, True])
def test_condensation_does_not_change_what_is_stiffer(dim, finite):
    """Condensation makes the diagonal of the matrix smaller, and more so at a higher order."""
    shares, forces = [], []
    for condense in (False, True):
        problem = press(
            dim=dim, order=3, condense=condense, finite=finite, friction=FRICTION, h=0.5
        )
        problem.solver().Solve(printing=False)
        shares.append(problem.contact.State()["share"][0])
        forces.append(problem.contact.Force())
    assert shares[0] == pytest.approx(shares[1], rel=1e-12)
    assert forces[0] == pytest.approx(forces[1], rel=1e-8)


@pytest.mark.parametrize("dt", [1e-2, 1e-6])
def test_inertia_does_not_change_what_is_stiffer(dt):
    problem = block()
    TimeStepper(problem.solver(), 1.0, dt=dt).Integrate(dt, printing=False)
    assert problem.contact.State()["share"][0] == pytest.approx(share(), rel=1e-12)


def test_the_form_of_another_space_is_refused():
    problem, other = block(), block()
    problem.a.AssembleLinearization(problem.gf.vec)
    with pytest.raises(ValueError, match="form lives on another space"):
        problem.contact.Prepare(problem.a.mat, form=other.a)
