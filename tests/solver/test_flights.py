"""TimeStepper with large sliding: energy, momenta, directions."""

import flights
import numpy as np
import pytest
from form import rotation
from interrupts import same, seen
from motions import values
from ngsolve import CF, x, y

MOST = 1.001  # of the energy at the start


def cylinder_turning():
    """A disc that rolls backwards when it hits."""
    flight = flights.on_slab(dt=0.01)
    spinning = CF((1 - 4 * (y - 1.02), -1 + 4 * x))
    flight.velocity.Set(spinning, definedon=flight.bodies)
    flight.start = flight.energy()
    return flight


CONSERVATIVE = {  # motion, end
    "long steps": (lambda: flights.on_slab((0.5, -1), dt=0.05), 0.5),
    "short steps": (lambda: flights.on_slab((0.5, -1), dt=0.005), 0.4),
    "dissipative": (lambda: flights.on_slab((1, -1), dt=0.02, rho_inf=0.8), 0.4),
    "very dissipative": (lambda: flights.on_slab((1, -1), dt=0.02, rho_inf=0.0), 0.4),
    "turning": (cylinder_turning, 0.4),
    "the slab is the slave": (lambda: flights.on_slab((0.5, -1), dt=0.02, swap=True), 0.4),
    "stiff": (lambda: flights.on_slab((1, -1), dt=0.002, young=1e5), 0.1),
    "rigid slab": (lambda: flights.on_slab((1, -1), dt=0.02, rigid=True), 0.4),
    "order 1": (lambda: flights.on_slab((1, -1), dt=0.02, order=1), 0.4),
    "two discs": (lambda: flights.two_discs(spin=4, dt=0.02), 0.6),
    "3D": (lambda: flights.ball_on_plate(dt=0.03), 0.3),
}


# Of the energy, at the end: where pressures do no work along the surfaces no more is lost.
LEFT = {"the slab is the slave": 0.95, "order 1": 0.88, "turning": 0.98}

# Each week; in 3D, by default, the bowl.
LONG = ("short steps", "long steps", "dissipative", "very dissipative", "turning", "stiff", "3D")


@pytest.mark.parametrize(
    "name", [pytest.param(n, marks=pytest.mark.full if n in LONG else ()) for n in CONSERVATIVE]
)
def test_a_frictionless_impact_wins_no_energy(name):
    make, end = CONSERVATIVE[name]
    flight = make().run(end)
    table = flight.stepper.Table()
    assert max(flight.closed) > 0
    assert flight.closed[-1] == 0
    assert LEFT.get(name, 0) < flight.total[-1] <= max(flight.total) <= MOST
    assert np.all(np.diff(table["impact"]) > -1e-12 * flight.start)
    assert np.all(table["friction"] == 0)
    assert table["kinetic"][-1] > 0.5 * flight.start or "dissipative" in name
    # What the balance says is what the fields say.
    total = table["kinetic"] + table["internal"]
    assert total / flight.start == pytest.approx(flight.total, abs=1e-6)


@pytest.mark.full
@pytest.mark.parametrize(
    ("friction", "end"),
    [(0.3, 1.0), *(pytest.param(f, 2.0, marks=pytest.mark.full) for f in (None, 0.3))],
)
def test_three_balls_in_a_bowl(friction, end):
    """All have hit the bowl and each other by the time 1."""
    flight = flights.three_in_bowl(friction=friction, dt=0.02).run(end)
    table = flight.stepper.Table()
    assert max(flight.closed) >= 3
    assert max(flight.total) <= MOST
    losses = np.diff(table["friction"] + table["impact"], prepend=0)
    assert losses.min() > -1e-12 * flight.start
    assert np.diff(table["friction"], prepend=0).min() > -1e-12 * flight.start
    assert (table["friction"][-1] > 0) == bool(friction)


@pytest.mark.parametrize("rho_inf", [pytest.param(1.0, marks=pytest.mark.full), 0.5])
def test_free_bodies_keep_their_momenta(rho_inf):
    flight = flights.two_discs(spin=4, dt=0.02, rho_inf=rho_inf)
    before = flight.momentum()
    flight.run(0.6)
    drift = np.abs(np.array(flight.path) - before).max(axis=0) / np.abs(before).max()
    assert max(flight.closed) > 0
    assert drift.max() < 1e-10


@pytest.mark.parametrize(
    "turn", [10.0, *(pytest.param(turn, marks=pytest.mark.full) for turn in (0.0, 20.0))]
)
def test_a_disc_bounces_vertically(turn):
    """Although faces of its mesh lie obliquely where it touches."""
    flight = flights.on_slab(turn=turn, h=0.6, rigid=True, dt=0.02).run(0.5)
    assert 1 in flight.closed
    assert flight.closed[-1] == 0
    assert abs(flight.direction()) < 1e-6


OFF = np.degrees(2 * np.arcsin(0.14))


@pytest.mark.full
def test_a_ball_leaves_a_bowl_by_the_law_of_reflection():
    """A stiff ball on a bowl whose normal is off by asin(0.14) leaves by twice that angle."""
    fall = flights.in_bowl(-0.14, dt=0.005).run(0.15)
    assert fall.direction() == pytest.approx(OFF, abs=1.0)


@pytest.mark.full
@pytest.mark.parametrize("swap", [False, True])
def test_mirror_images_leave_in_mirror_directions(swap):
    falls = [flights.in_bowl(offset, swap=swap, dt=0.005).run(0.15) for offset in (-0.14, 0.14)]
    right, left = (flight.direction() for flight in falls)
    assert [right, -left] == pytest.approx([OFF, OFF], abs=1.0)
    assert right + left == pytest.approx(0, abs=0.5)


@pytest.mark.full
def test_second_order_of_bodies_that_turn():
    """Soft ones, that swing slowly, in free flight."""
    ends = []
    for steps in (10, 20, 80):
        flight = flights.two_discs(spin=1, aside=9, young=0.2, h=0.5, dt=0.6 / steps).run(0.6)
        ends.append(values(flight.u))
    coarse, fine = (np.abs(end - ends[-1]).max() for end in ends[:2])
    assert np.log2(coarse / fine) > 1.8


def turned(degrees):
    """Two discs that meet, somewhere else and in other directions; without strain."""
    flight, R = flights.two_discs(spin=4, dt=0.02), rotation(2, degrees)
    flight.u.Set(CF(tuple(R @ (x, y))) + CF((3 - x, -2 - y)))
    flight.velocity.vec.FV().NumPy()[:] = (R @ values(flight.velocity).reshape(2, -1)).ravel()
    return flight.run(0.3), R


@pytest.mark.full
def test_where_the_bodies_are_and_how_they_are_turned_does_not_matter():
    """Up to the share of the bodies in the direction, from the diagonal of a matrix."""
    straight, _ = turned(0)
    assert max(straight.closed) > 0
    for degrees, accuracy in ((90, 1e-8), (37, 1e-4)):
        other, R = turned(degrees)
        assert other.total == pytest.approx(straight.total, abs=accuracy)
        assert other.path[-1][:2] == pytest.approx(R @ straight.path[-1][:2], abs=accuracy)


# --- steps that fail -----------------------------------------------------------------------------


class FailsError(Exception):
    pass


def test_a_failure_in_the_middle_leaves_the_last_state(monkeypatch):
    """In a step with contact, when the velocities are already new."""
    flight, other = (flights.on_slab((1, -1), dt=0.02, rho_inf=0.9).run(0.1) for _ in range(2))
    before = seen(flight.stepper)

    def fail(*_, **__):
        raise FailsError

    with monkeypatch.context() as patch:
        patch.setattr(flight.stepper._end._conservation, "Settle", fail)
        with pytest.raises(FailsError):
            flight.run(0.14)
    assert max(flight.closed) > 0
    assert same(before, seen(flight.stepper)) == set(before)
    for one in (flight, other):
        one.run(0.2)
    assert values(flight.gf) == pytest.approx(values(other.gf), abs=1e-10)
    assert values(flight.velocity) == pytest.approx(values(other.velocity), abs=1e-8)
