"""The tutorial on peeling: beam theory, J integral, energy, unloading, closing, element size."""

import numpy as np
import pytest
from notebooks import Tutorial

PEELING, VALUES = (
    "14_peeling",
    """
VALUES = dict(
    area=area, stiff=stiff, softening=softening, J=[low, high], balance=balance, offset=offset,
    line=line, rest=rest, closed=closed, first=first, again=again[1],
    healed=healed, last=last_softening, cracked=cracked, torn=torn_before,
    zone=zone_before, waves=[results[s].wave for s in (5.0, 6.0)] + [fine.wave],
    limits=[results[s].limit for s in (5.0, 6.0)] + [fine.limit],
    means=[results[s].mean for s in (5.0, 6.0)] + [fine.mean],
    zones=[results[s].zone for s in (5.0, 6.0)] + [fine.zone],
    delayed=[delayed[d].mean for d in (0.02, 0.004)], snaps=results[20.0].mean,
    most=[results[20.0].most, fine.most, delayed[0.004].most],
)
""",
)
peeling = Tutorial(PEELING, VALUES, pictures=5)


def test_law(peeling):
    assert peeling.area == pytest.approx(0.5, rel=1e-3)


def test_force_and_beam_theory(peeling):
    assert peeling.stiff == pytest.approx(0.983, abs=0.005)  # shear 0.3 %, local strains 1.4 %
    assert np.all(np.abs(peeling.softening - 1) < 0.005)
    assert peeling.last == pytest.approx(1, abs=0.005)


def test_energy(peeling):
    assert np.all(np.abs(peeling.J - 1) < 0.005)
    assert peeling.balance < 4e-3
    assert np.ptp(peeling.offset) < 0.15
    assert peeling.torn < peeling.cracked < peeling.torn + peeling.zone


def test_unloading(peeling):
    assert peeling.line < 1e-8
    assert peeling.rest < 1e-8


def test_closing_and_opening_again(peeling):
    assert np.all(np.abs(peeling.closed - 1) < 1e-3)
    assert peeling.again == pytest.approx(peeling.first, rel=1e-8)
    assert abs(peeling.healed) < 1e-8


def test_element_size(peeling):
    assert np.all(np.abs(peeling.means - 1) < 0.005)
    middle, coarse, fine = peeling.waves
    assert fine < 0.003
    assert 0.003 < middle < 0.0065 < coarse < 0.01
    assert np.all(peeling.waves < peeling.limits)
    estimates = (70e3 * 27 * 0.5 / (6 * np.array([5, 6, 20.0]) ** 2)) ** 0.25
    assert np.all(np.abs(peeling.zones / estimates - 1) < 0.4)


def test_snaps(peeling):
    assert 0 < peeling.snaps - 1 < 0.02
    snapping, fine, delayed = peeling.most
    assert delayed <= 8
    assert fine < snapping <= 120


def test_delay(peeling):
    long, short = peeling.delayed - 1
    assert 0.12 < long < 0.2
    assert 0 < short < long / 3
