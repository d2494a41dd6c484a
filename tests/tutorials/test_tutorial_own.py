"""Tutorial 10, your own problem, runs, and what it computes is right."""

import numpy as np
import pytest
from notebooks import Files, Tutorial

from ngslac.reference import HertzLine

own = Tutorial("10_your_own_problem", """
names = dict.fromkeys(mesh.GetBoundaries())
VALUES = dict(
    areas={name: Integrate(CF(1), mesh.Boundaries(name)) for name in names},
    paired=[[c.Check().paired_area, c.Check().min_gap, c.Check().max_gap] for c in contacts],
    rows=rows, reaction=reaction, steps=[[s.time, s.cuts] for s in steps],
    deep=[deep.min_gap, len(deep.penetrating)],
    punch=[[c.Check().macro_size[1], c.Force()[1], c.Table()["pressure"].max()]
           for c in (good, bad)],
)
""", pictures=2)  # fmt: skip
MESSAGES = [
    "slave='hole' matches no boundary face; the boundaries are: ",
    "slave and master never meet",
    "friction = -0.15 must be a finite number >= 0",
    "on boundary 'lug_hole'; it must be a number >= 0",
    "no macro-element can be made of 1 face(s) of boundary 'lug_hole'",
    "ContactWarning: body 'punch' is free (rotation)",
    "penetrating      ",
    "ContactConvergenceError: the residual holds NaN or infinite values",
]


@pytest.mark.parametrize("message", MESSAGES)
def test_mistakes_are_told(own, message):
    assert message in own.text


def test_faces_found_by_position(own):
    """All but the symmetry planes, which are those of two bodies."""
    hole, rim = 2 * np.pi * 6.05, 2 * np.pi * 6
    exact = {"pull": 24 * 5, "fixed": 24 * 6, "lug_hole": 5 * hole, "fork_hole": 6 * hole}
    exact |= {"pin": 13 * rim, "symmetry": 24 * 40 + np.pi * (12**2 / 2 - 6.05**2 + 6**2)}
    assert {name: own.areas[name] for name in exact} == pytest.approx(exact, rel=1e-3)


def test_pairing(own):
    """Moved until they touch: from 0 to twice the clearance."""
    for (paired, low, high), name in zip(own.paired, ("lug_hole", "fork_hole"), strict=True):
        assert paired == pytest.approx(own.areas[name], rel=1e-9)
        assert low == pytest.approx(0, abs=0.01)  # loaded by now
        assert 0.09 < high < 0.3


def test_steps_and_balance(own):
    lug, fork = own.rows[::2], own.rows[1::2]
    np.testing.assert_allclose(lug[:, 0], [0.04, 0.08, 0.12])
    force = -lug[:, 1]
    # The pin hands on what it gets; it is held in z by the plane of symmetry.
    np.testing.assert_allclose(fork[:, 1:3], -lug[:, 1:3], atol=1e-7 * force[-1])
    np.testing.assert_allclose(own.reaction, [force[-1], -force[-1]], rtol=1e-8)
    assert force[-1] == pytest.approx(6170, rel=0.03)
    assert np.all(np.diff(force, 2, prepend=0) > 0)  # the arc that touches grows
    assert np.all(np.diff(lug[:, -1]) > 0)
    assert np.all(np.diff(fork[:, -1]) > 0)


def test_penetration_is_seen(own):
    """The punch was lifted by -0.03; the mean over its lowest edge is a bit less."""
    gap, count = own.deep
    assert gap == pytest.approx(-0.03, abs=0.002)
    assert count > 3


def test_fine_and_coarse_slave(own):
    (fine, *good), (coarse, *bad) = own.punch
    assert fine < 0.1 < 0.2 < coarse
    assert good[0] == pytest.approx(bad[0], rel=0.05)  # the force is a mean
    young, nu = 2.75, 0.375  # of the Lame constants 3 and 1
    material = dict(young1=young, nu1=nu, young2=young, nu2=nu)
    peak = HertzLine(force=good[0], radius1=2, **material).peak
    assert good[1] == pytest.approx(peak, rel=0.1)
    assert abs(bad[1] - peak) > abs(good[1] - peak)


def test_halved_steps(own):
    times, cuts = own.steps.T
    assert times[-1] == pytest.approx(0.5)
    assert cuts[0] >= 1
    assert len(times) >= 2


def test_files(own):
    assert Files(own.folder) == ["hinge.step", "hinge.vtu", "hinge_fork.vtu", "hinge_lug.vtu"]
