"""A block that slides on a slab: it slows down as Newton and Coulomb say."""

import pytest
from netgen.occ import Compound, MoveTo, OCCGeometry, Y
from ngsolve import (
    CF,
    Grad,
    Id,
    Integrate,
    Mesh,
    Variation,
    VectorH1,
    dx,
)
from posed import posed
from press import solved

from ngslac import TimeStepper
from ngslac.materials import NeoHooke

FRICTION = 0.1


def slider(slave, finite):
    """A block of weight 0.5 at rest on a slab that is held below."""
    block, slab = MoveTo(0, 0).Rectangle(1, 0.5).Face(), MoveTo(-0.5, -0.5).Rectangle(5, 0.5).Face()
    for body, side, name in ((block, Y, "block"), (slab, -Y, "slab")):
        body.faces.name, body.edges.name = name, f"{name}side"
        body.edges.Min(side).name = f"{name}face"
    slab.edges.Min(Y).name = "fixed"
    block.faces.maxh, slab.faces.maxh = 0.4, 0.5
    mesh = Mesh(OCCGeometry(Compound([block, slab]), dim=2).GenerateMesh())
    V = VectorH1(mesh, order=2, dirichlet="fixed")
    other = {"block": "slab", "slab": "block"}[slave]
    law = {"friction": FRICTION, "finite": finite}
    problem = posed(
        V,
        lambda u, v, load: Variation(NeoHooke(Id(2) + Grad(u), 1e4, 0.3) * dx),
        lambda u, v, load: v[1] * dx("block"),
        slave=f"{slave}face",
        master=f"{other}face",
        **law,
    )
    solver = solved(problem)
    problem.contact.Commit(problem.gf)
    return solver


@pytest.mark.parametrize("slave", ["block", "slab"])
@pytest.mark.parametrize("finite", [False, True])
def test_friction_alone_slows_down_what_slides(slave, finite):
    """Taking energy out of the velocities once held the block up, as if the slab were sticky."""
    solver = slider(slave, finite)
    stepper = TimeStepper(solver, 1.0, dt=0.2, rho_inf=0.5)
    mesh, velocity = solver.gf.space.mesh, stepper.velocity.components[0]
    velocity.Set(mesh.MaterialCF({"block": CF((3, 0))}, default=CF((0, 0))))

    def speed():
        return Integrate(velocity[0] * dx("block"), mesh) / 0.5

    stepper.Integrate(0.2, printing=False)
    before = speed()
    stepper.Integrate(1.0, printing=False)
    assert before - speed() == pytest.approx(0.8 * FRICTION, rel=0.02)
