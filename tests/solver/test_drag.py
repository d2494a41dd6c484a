"""What is dragged over a slave in long steps rubs on the macro-elements it comes over, too."""

import pytest
from netgen.occ import Compound, MoveTo, OCCGeometry, Y
from ngsolve import (
    CF,
    BilinearForm,
    Grad,
    GridFunction,
    Id,
    IfPos,
    Mesh,
    Parameter,
    Variation,
    VectorH1,
    dx,
)

from ngslac import ContactSolver, LACContact, LACSpace, LoadStepper, tools
from ngslac.materials import NeoHooke

FRICTION = 0.4


def slab_and_block():
    slab, block = MoveTo(0, -0.5).Rectangle(4, 0.5).Face(), MoveTo(2.6, 0).Rectangle(1, 0.5).Face()
    for body, side, name in ((slab, Y, "slab"), (block, -Y, "block")):
        body.faces.name, body.edges.name = name, f"{name}side"
        body.edges.Max(side).name, body.edges.Min(side).name = f"{name}face", f"{name}held"
    slab.faces.maxh, block.faces.maxh = 0.4, 0.3
    return Mesh(OCCGeometry(Compound([slab, block]), dim=2).GenerateMesh())


def path(load):
    """Down until the load is 1, then 2 to the left."""
    return -2 * IfPos(load - 1, load - 1, 0), -0.01 * IfPos(load - 1, 1, load)


def over_a_block(u, lam, load):
    return LACContact(u, lam, master="blockface", friction=FRICTION, finite=True), {
        "blockheld": CF(path(load))
    }


def over_a_tool(u, lam, load):
    box = tools.Polygon([(2.6, 0), (3.6, 0), (3.6, 0.5), (2.6, 0.5)])
    tool = box.Moved(shift=path(load))
    return LACContact(u, lam, obstacle=tool, friction=FRICTION, finite=True), {}


def ratios(partner, steps):
    """Tangential over normal force after each step."""
    V = VectorH1(slab_and_block(), order=2, dirichlet="slabheld|blockheld")
    X = V * LACSpace(V, slave="slabface")
    (u, lam), _ = X.TnT()
    gf, a, load, found = GridFunction(X), BilinearForm(X), Parameter(0.0), []
    a += Variation(NeoHooke(Id(2) + Grad(u), 1e3, 0.3) * dx)
    contact, prescribe = partner(u, lam, load)

    def note(_):
        right, up = contact.Force()
        found.append(abs(right / up))

    stepper = LoadStepper(ContactSolver(a, gf, [contact]), load, prescribe=prescribe)
    stepper.Integrate(1, steps=1, printing=False)
    stepper.Integrate(2, steps=steps, printing=False, callback=note)
    return found


@pytest.mark.parametrize("partner", [over_a_block, over_a_tool])
def test_long_steps_rub_as_short_ones(partner):
    """What they came over did not rub at all: 0.23 in place of 0.4."""
    for steps in (3, 9):
        assert ratios(partner, steps)[-1] == pytest.approx(FRICTION, rel=0.02)
