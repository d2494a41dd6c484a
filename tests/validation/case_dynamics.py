"""Impact, sliding, a bouncing ring."""

from __future__ import annotations

import bouncing
import numpy as np
from motions import bar, sliding, two_bars
from report_bounds import Rounding, Step, Tolerance
from report_case import Case, Outcome, Row
from report_pictures import BLUE, INK, ORANGE, Figure, FromFolder


def Impact(quick):
    n = 10 if quick else 20
    one, two = bar(n=n, dt=0.5 / n), two_bars(dt=0.025)
    time, pressure, energy, _ = one.run(2.6)
    times, pressures, _, _ = two.run(2.6)
    velocity = two.stepper.velocity
    during = (time > 0.3) & (time < 1.9)
    both = (times > 0.3) & (times < 1.8)
    touched = time[pressure > 0]
    passing = Step(1.5 / n, "a wave in an element, and one time step", kind="absolute")
    layer = Step(1 / n, "mass of a layer of elements")
    layers = Step(0.2, "mass of a layer of elements", kind="absolute")
    upper, lower = (two.mean(velocity, name)[1] for name in ("upper", "lower"))
    rows = [
        Row("bar: mean pressure of the impact", pressure[during].mean(), 1, layer),
        Row("bar: begin of the contact", touched[0], 0.1, passing),
        Row("bar: end of the contact", touched[-1], 2.1, passing),
        Row("bar: velocity afterwards", one.mean(one.stepper.velocity)[1], 1, layer),
        Row("bar: energy afterwards over that before", energy[-1] / 0.5, 1, layer),
        Row("two bars: mean pressure", pressures[both].mean(), 0.5, layers),
        Row("two bars: velocity of the one that was thrown", upper, 0, layers),
        Row("two bars: velocity of the other one", lower, -1, layers),
        Row("two bars: mean velocity of both", two.mean(velocity)[1], -0.5, Rounding()),
    ]

    def Draw(ax):
        exact = np.array([(0, 0), (0.1, 0), (0.1, 1), (2.1, 1), (2.1, 0), (2.6, 0)])
        ax.plot(*exact.T, color=INK, lw=0.8, label="exact, bar on a wall")
        ax.step(time, pressure, where="pre", color=BLUE, lw=1.2, label="bar on a wall")
        ax.step(times, pressures, where="pre", color=ORANGE, lw=1.2, label="two bars")
        ax.set_xlabel("time")
        ax.set_ylabel("pressure / (density c v)")
        ax.legend()

    return Outcome(rows, Figure(Draw, size=(6.5, 3.4)), "Contact pressures over the time.")


def Sliding(quick):
    dt, speed, braking = 0.05, 1.0, 0.3
    motion = sliding(speed=speed, friction=braking, dt=dt)
    time, force, _, tangential = motion.run(4.0)
    slides = time < 3.2
    ratio = -tangential[slides] / force[slides]
    farthest = ratio[np.abs(ratio - 0.3).argmax()]
    balance = motion.stepper.balance
    last = braking * dt  # the largest velocity at the begin of the step in which it stops
    way = Step(last * dt / 2, "way in the step in which it stops", kind="absolute")
    energy = Step((last / speed) ** 2, "energy at the begin of the step in which it stops")
    rows = [
        Row("way until it stops", motion.mean()[0], speed**2 / (2 * braking), way),
        Row("energy lost to friction", balance.friction, 0.05, energy),
        Row("friction over normal force while it slides", farthest, braking, Tolerance()),
        Row("energy lost by the time integration", balance.algorithmic, 0, Rounding()),
    ]

    def Draw(ax):
        table = motion.stepper.Table()
        for colour, name in zip((BLUE, ORANGE), ("kinetic", "friction"), strict=True):
            ax.plot(table["time"], table[name], color=colour, lw=1.2, label=name)
        exact = 0.05 * np.maximum(1 - 0.3 * table["time"], 0) ** 2
        ax.plot(table["time"], exact, color=INK, lw=0.8, ls="--", label="kinetic, exact")
        ax.set_xlabel("time")
        ax.set_ylabel("energy")
        ax.legend()

    return Outcome(rows, Figure(Draw, size=(6, 3.2)), "Kinetic energy becomes heat.")


def Bouncing(quick):
    options = {"h": 0.25, "dt": 0.04} if quick else {}
    options |= {"friction": 0.2, "gravity": 0.0, "end": 1.6}
    figures = bouncing.Run(**options)
    gone = figures["friction"] + figures["impact"] + figures["algorithmic"]
    end, start = figures["energy_end"], figures["energy_start"]
    ratio, drift = figures["friction_ratio"], figures["flight_speed_drift"]
    gain = max(0.0, figures["largest_contact_gain"]) / start
    rounding, relative = Rounding(), Rounding(kind="relative")
    rows = [
        Row("tangential over normal impulse, slipping all the time", ratio, 0.2),
        Row("energy at the end and all losses", end + gone, start, relative),
        Row("velocity along the ground in flight: change", drift, 0, rounding),
        Row("largest gain of energy in a step, over the energy", gain, 0, rounding),
    ]
    caption = "Instants of the motion, and where the energy goes."
    draw = FromFolder(lambda folder: bouncing.Run(**options, out=folder), "bouncing.png")
    return Outcome(rows, draw, caption)


CASES = [
    Case(
        "impact",
        "Impact of elastic bars",
        "A bar of length, density and speed of sound 1 is thrown at a wall with velocity 1: the "
        "pressure is 1 while a wave runs there and back, from t = 0.1 to 2.1. Two equal bars on "
        "meshes that do not match exchange their velocities. The layer of elements at the contact "
        "loses its kinetic energy, a loss of first order in their size.",
        "Waves in bars (one-dimensional, exact).",
        "pytest tests/validation/test_cases.py -k impact",
        Impact,
    ),
    Case(
        "sliding-block",
        "A sliding block stops",
        "A flat block on the ground gets the velocity 1; friction 0.3, gravity 1.",
        "Way v^2/(2 F g), and all energy lost to friction.",
        "pytest tests/validation/test_cases.py -k sliding-block",
        Sliding,
    ),
    Case(
        "bouncing-ring",
        "A bouncing ring",
        "An elastic ring is thrown at the ground so fast that it slips as long as it touches: "
        "friction slows it down and turns it. Large deformation and rotation, no gravity.",
        "Balances of momentum and energy; friction 0.2 as ratio of the impulses.",
        "python tutorials/examples/bouncing.py --gravity 0 --friction 0.2 --end 1.6 --out results",
        Bouncing,
    ),
]
