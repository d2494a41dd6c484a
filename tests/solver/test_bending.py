"""Slender bodies that forces bend far, past and around tools: the residual grows on the way."""

import numpy as np
import pytest
from netgen.occ import OCCGeometry, WorkPlane
from ngsolve import (
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

from ngslac import ContactConvergenceError, ContactSolver, LACContact, LACSpace, LoadStepper
from ngslac.materials import NeoHooke
from ngslac.solve.nearness import Nearness
from ngslac.tools import Plane, Sphere

LENGTH, HEIGHT, YOUNG = 10.0, 0.2, 1000.0
BENDING = YOUNG * HEIGHT**3 / 12
# Bisshopp and Drucker, Quart. Appl. Math. 3 (1945): a force P at the end of a cantilever, which
# keeps its length. P L^2 / (E I), and how far the end goes down, over L.
ELASTICA = {1: 0.3017, 2: 0.4935, 5: 0.7138, 10: 0.8106}


class Strip:
    """A cantilever along x; its load is a force downwards at the end, and its tool lies below."""

    def __init__(self, force, tool, *, friction=None, nu=0.0, order=2):
        plane = WorkPlane().Line(LENGTH, "slave").Rotate(90).Line(HEIGHT, "end").Rotate(90)
        plane.Line(LENGTH, "top").Rotate(90).Line(HEIGHT, "held")
        self.mesh = Mesh(OCCGeometry(plane.Face(), dim=2).GenerateMesh(maxh=HEIGHT))
        V = VectorH1(self.mesh, order=order, dirichlet="held")
        X = V * LACSpace(V, slave="slave")
        (u, lam), (v, _) = X.TnT()
        a, self.load = BilinearForm(X), Parameter(0)
        a += Variation(NeoHooke(Id(2) + Grad(u), YOUNG, nu).Compile() * dx)
        a += self.load * force / HEIGHT * v[1] * ds("end")
        self.contact = LACContact(u, lam, obstacle=tool, finite=True, friction=friction)
        self.gf = GridFunction(X)
        self.solver = ContactSolver(a, self.gf, self.contact)
        self.stepper = LoadStepper(self.solver, self.load)

    def Bend(self, steps=1):
        """The steps to the whole force."""
        return self.stepper.Integrate(1.0, steps=steps, printing=False)

    def Tip(self):
        return np.array(self.gf.components[0](self.mesh(LENGTH, HEIGHT / 2)))


@pytest.mark.parametrize("steps", [1, 4])
@pytest.mark.parametrize("load", ELASTICA)
def test_elastica(load, steps):
    """It turns away from the tool far below, and is no thicker than a fiftieth of its length."""
    strip = Strip(load * BENDING / LENGTH**2, Plane((0, -2 * LENGTH), (0, 1)), order=3)
    found = strip.Bend(steps)
    assert -strip.Tip()[1] / LENGTH == pytest.approx(ELASTICA[load], abs=1e-3)
    assert sum(step.cuts for step in found) <= 2
    assert max(step.iterations for step in found) <= 30


def OverDisc(force, **options):
    """A strip that a disc below its middle holds up."""
    return Strip(force, Sphere((0.6 * LENGTH, -2.5), 2.0), nu=0.3, **options)


@pytest.mark.parametrize(("friction", "spread"), [(None, 1e-6), (0.3, 0.01)])
@pytest.mark.parametrize("steps", [1, 20])
def test_over_a_disc(friction, spread, steps):
    """Without friction the end does not depend on the steps."""
    strip = OverDisc(0.1, friction=friction)
    found = strip.Bend(steps)
    assert sum(step.iterations for step in found) <= 160
    force = 0.12089051 if friction is None else 0.1171
    assert strip.contact.Force()[1] == pytest.approx(force, rel=spread)
    assert strip.Tip()[1] == pytest.approx(-2.755, abs=0.005)


@pytest.mark.usefixtures("whole_systems")
def test_a_way_through_a_tool_is_refused():
    """The end beside the disc would be an equilibrium, too."""
    strip = OverDisc(0.1)
    strip.load.Set(1.0)
    with pytest.raises(ContactConvergenceError, match="has gone through the tool: take smaller"):
        strip.solver.Solve(printing=False)


def test_the_simplified_correction_is_newtons_at_the_same_place():
    strip = Strip(0.1, Plane((0, -0.1), (0, 1)))
    strip.Bend(5)
    system = strip.solver.system
    system.values[:] *= 1.01
    system.Assemble()
    state = system.Measure()
    correction = system.Correction(system.Linearize(state))
    assert system.SimplifiedCorrection() == pytest.approx(correction, rel=1e-6, abs=1e-9)
    assert Nearness(system, state, 1.01 * correction).Nears(1.0)
    assert not Nearness(system, state, 0.99 * correction).Nears(1.0)


@pytest.mark.usefixtures("whole_systems")
def test_a_step_that_led_away_is_taken_back(monkeypatch):
    """To where it began, to the last bit, with pairing and all."""
    seen, original = [], Nearness.Return

    def Return(nearness):
        state = original(nearness)
        seen.append(state)
        assert np.array_equal(nearness.system.values, nearness.place[0])
        assert np.array_equal(state.gaps, nearness.state.gaps, equal_nan=True)
        return state

    monkeypatch.setattr(Nearness, "Return", Return)
    OverDisc(0.1, friction=0.3).Bend(5)
    assert seen
