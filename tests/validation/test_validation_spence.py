"""Stick and slip under a growing normal load (Spence): stick ratio and traction profile.

The load is raised such that the half width of the contact grows by equal parts: with 20 steps and
21 macro-elements in the half width, by one macro-element in each step. With fewer steps the stick
zone is smaller (0.76 of the contact with 5 steps), with 40 the same but for one macro-element.

Near its end at k the ratio |tau|/(F p) approaches 1 like (k - x/a)^(3/2). The end of the stick zone
is therefore more sensitive to errors than the tractions are.
"""

from dataclasses import dataclass, replace

import numpy as np
import pytest
from problems_cylinder import SLIP, STICK, Cylinder, Model
from problems_punch import CoupledPunch, StickRatio

from ngslac.reference import SpenceLine, StickZone

STEPS = 20
# Start of the search for the stick ratio of the coupled problem.
GUESS = {0.1: 0.4, 0.2: 0.9}

# A hundredth of the paper's load: contact width over radius 1/80.
LOW = Cylinder(force=350.0, friction=0.2, h=0.03, zone=0.8)
# A tenth of its size, where the contact is flat: 1/800.
FLAT = {F: Cylinder(force=3.5, friction=F, h=0.003, zone=0.07) for F in GUESS}


@dataclass
class Run:
    problem: Cylinder
    profile: object
    force: np.ndarray
    steps: list

    @classmethod
    def Of(cls, problem):
        model = Model(problem)
        profile = model.Press(STEPS)
        return cls(problem, profile, np.asarray(model.contact.Force()), model.normal.steps)

    @property
    def halfwidth(self):
        return self.problem.hertz.halfwidth

    @property
    def spence(self):
        return SpenceLine(hertz=self.problem.hertz, friction=self.problem.friction)

    @property
    def macro(self):
        """Size of a macro-element over the half width of the contact."""
        return np.max(self.profile.end - self.profile.start) / self.halfwidth

    @property
    def stick(self):
        """End of the stick zone over the half width."""
        return self.profile.Zone(STICK)[1] / self.halfwidth

    def Ratio(self):
        """Positions x/a and |tau|/(F p), without the first macro-elements and the last.

        The first ones came into contact in the first steps, when they were the whole contact.
        """
        x = self.profile.middle / self.halfwidth
        inner = (x > 0.15) & (x < 0.95)
        ratio = np.abs(self.profile.traction) / self.problem.friction
        return x[inner], ratio[inner] / self.profile.pressure[inner]


@pytest.fixture(scope="module")
def low():
    return Run.Of(LOW)


@pytest.fixture(scope="module", params=GUESS)
def flat(request):
    return Run.Of(FLAT[request.param])


def CheckStickRatio(run):
    assert run.stick == pytest.approx(run.spence.ratio, abs=run.macro)
    assert run.stick == pytest.approx(run.spence.ratio, rel=0.02)


def test_low_load_stick_ratio_agrees_with_spence(low):
    # The zone ends at a node; on this mesh one lies near enough for the second bound.
    CheckStickRatio(low)


@pytest.mark.slow
def test_low_load_stick_ratio_agrees_with_spence_on_a_finer_mesh():
    # Here a macro-element is 2.4 % of the half width.
    CheckStickRatio(Run.Of(replace(LOW, h=0.015)))


def test_low_load_traction_agrees_with_spence(low):
    x, ratio = low.Ratio()
    exact = np.abs(low.spence.zone.HertzFriction(x)) / LOW.friction
    assert np.abs(ratio - exact).max() <= 0.06


def test_low_load_difference_is_the_slope_of_the_slave_surface(low):
    # The shear traction on the flat master is that on the slave plus p x/R. In the compatibility
    # of both, each counts with the compliance of its body: 1/4 steel, 3/4 of it the block's.
    x, ratio = low.Ratio()
    slope = x * low.halfwidth / low.problem.hertz.radius
    stick = x < low.stick
    exact = np.abs(low.spence.zone.HertzFriction(x)) / LOW.friction
    before = np.sqrt(np.mean((ratio - exact)[stick] ** 2))
    after = np.sqrt(np.mean((ratio + 0.75 * slope / LOW.friction - exact)[stick] ** 2))
    assert after <= 0.015
    assert after <= 0.6 * before


def test_contact_is_a_stick_zone_inside_a_slip_zone_and_carries_the_load(low):
    profile = low.profile
    assert profile.Zone(STICK)[0] == pytest.approx(0.0, abs=1e-12)
    assert profile.Zone(STICK)[1] == pytest.approx(profile.Zone(SLIP)[0], abs=1e-12)
    assert profile.Zone(STICK, SLIP)[1] == pytest.approx(
        low.halfwidth, abs=low.macro * low.halfwidth
    )
    assert low.force[1] == pytest.approx(LOW.force / 2, rel=1e-10)
    assert [step.cuts for step in low.steps] == [0] * STEPS
    slips = profile.status == SLIP
    np.testing.assert_allclose(
        profile.traction[slips], -LOW.friction * profile.pressure[slips], rtol=1e-10
    )


def test_coupled_punch_agrees_with_the_closed_form_where_that_is_exact():
    for friction, guess in GUESS.items():
        exact = StickZone(beta=1 / 7, friction=friction)
        ratio = StickRatio(1 / 7, friction, guess, coupled=False)
        assert ratio == pytest.approx(exact.ratio, rel=2e-4)
        x = np.array([0.1, 0.3, 0.5, 0.7, 0.85])
        punch = CoupledPunch(beta=1 / 7, friction=friction, coupled=False)
        expected = exact.HertzFriction(x) / friction
        np.testing.assert_allclose(punch.HertzFriction(x, guess), expected, atol=5e-4)


def test_flat_stick_zone_ends_within_one_macro_element_of_the_exact_one(flat):
    friction = flat.problem.friction
    exact = StickRatio(abs(flat.problem.hertz.beta), friction, GUESS[friction])
    assert flat.stick == pytest.approx(exact, abs=flat.macro)
    # What Goodman's approximation changes is less than that.
    assert exact == pytest.approx(flat.spence.ratio, rel=0.03)


def test_flat_traction_agrees_with_the_coupled_solution(flat):
    friction = flat.problem.friction
    x, ratio = flat.Ratio()
    punch = CoupledPunch(beta=abs(flat.problem.hertz.beta), friction=friction)
    error = ratio - punch.HertzFriction(x, GUESS[friction])
    assert np.abs(error).max() <= 0.015
    assert np.sqrt(np.mean(error**2)) <= 0.006
    # Coupled is better than Goodman's approximation: the difference is seen.
    goodman = ratio - np.abs(flat.spence.zone.HertzFriction(x)) / friction
    assert np.linalg.norm(error) < 0.8 * np.linalg.norm(goodman)
