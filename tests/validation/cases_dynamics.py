"""Impact, sliding, a bouncing ring; and saved states."""

from __future__ import annotations

import subprocess
import sys
import tempfile
from pathlib import Path

import bouncing
import continued
import numpy as np
from motions import bar, sliding, two_bars
from report_bounds import Exact, Rounding, Step, Tolerance
from report_case import Case, Outcome, Row
from report_pictures import BLUE, INK, ORANGE, Figure, FromFolder

from ngslac import SaveState


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
    ring = bouncing.Ring(h=0.25 if quick else 0.17, friction=0.2, gravity=0.0)
    ring.Throw(1.6, 0.04 if quick else 0.02)
    figures = ring.Figures()
    gone = figures["friction"] + figures["impact"] + figures["algorithmic"]
    rows = [
        Row(
            "tangential over normal impulse, slipping all the time",
            figures["friction_ratio"],
            0.2,
        ),
        Row(
            "energy at the end and all losses",
            figures["energy_end"] + gone,
            figures["energy_start"],
            Rounding(kind="relative"),
        ),
        Row(
            "velocity along the ground in flight: change",
            figures["flight_speed_drift"],
            0,
            Rounding(),
        ),
        Row(
            "largest gain of energy in a step, over the energy",
            max(0.0, figures["largest_contact_gain"]) / figures["energy_start"],
            0,
            Rounding(),
        ),
    ]
    caption = "Instants of the motion, and where the energy goes."
    draw = FromFolder(lambda folder: bouncing.Write(ring, folder), "bouncing.png")
    return Outcome(rows, draw, caption)


def Restart(quick):
    rows, curves = [], {}
    kinds = ["linear"] if quick else list(continued.MAKE)
    with tempfile.TemporaryDirectory() as folder:
        steppers = {kind: continued.half(continued.MAKE[kind](), 1) for kind in continued.MAKE}
        for kind, stepper in steppers.items():
            SaveState(Path(folder) / kind, stepper)
        ends = {kind: continued.outcome(continued.half(s, 2)) for kind, s in steppers.items()}
        subprocess.run(
            [sys.executable, continued.__file__, folder],
            check=True,
            cwd=Path(continued.__file__).parent,
        )
        for kind in kinds:
            with np.load(Path(folder) / f"{kind}.npz") as found:
                worst = max(
                    float(np.abs(np.subtract(found[name], value, dtype=float)).max(initial=0))
                    for name, value in ends[kind].items()
                )
                curves[kind] = ends[kind]["pressure"], found["pressure"]
            accepted = Rounding() if kind == "bouncing" else Exact()
            text = f"{kind}: largest difference of {len(ends[kind])} arrays of end values"
            rows.append(Row(text, worst, 0, accepted))

    def Draw(ax):
        for k, both in enumerate(curves.values()):
            for style, values in zip("ox", both, strict=True):
                colour = ORANGE if style == "x" else BLUE
                ax.plot(k + np.linspace(-0.3, 0.3, len(values)), values, style, color=colour)
        ax.set_xticks(range(len(curves)), curves)
        ax.set_ylabel("pressure of the macro-elements")

    caption = "End pressures without interruption (circles) and saved and continued (crosses)."
    return Outcome(rows, Figure(Draw, size=(6, 3.2)), caption)


CASES = [
    Case(
        "impact",
        "Impact of elastic bars",
        "A bar of length, density and speed of sound 1 is thrown at a wall with velocity 1: the "
        "pressure is 1 while a wave runs there and back, from t = 0.1 to 2.1. Two equal bars on "
        "meshes that do not match exchange their velocities. The layer of elements at the contact "
        "loses its kinetic energy, a loss of first order in their size.",
        "Waves in bars (one-dimensional, exact).",
        "pytest tests/solver/test_dynamics.py -k bar",
        Impact,
    ),
    Case(
        "sliding-block",
        "A sliding block stops",
        "A flat block on the ground gets the velocity 1; friction 0.3, gravity 1.",
        "Way v^2/(2 F g), and all energy lost to friction.",
        "pytest tests/solver/test_dynamics.py -k sliding",
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
    Case(
        "restart",
        "Saved and continued",
        "Five computations (a load path with friction, the same with a linear bulk, with large "
        "sliding, with self-contact, and a block in flight) are saved half way and continued in "
        "another process. The end values agree to the last bit; for the flight to rounding, since "
        "the last digits of dense products depend on where arrays lie in memory.",
        "The computations without interruption.",
        "pytest tests/solver/test_restart.py",
        Restart,
    ),
]
