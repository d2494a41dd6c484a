"""Vibrations about contact states: bars, a beam, a ball, mode coupling by friction."""

from __future__ import annotations

import numpy as np
from report_bounds import Element, Extrapolated, Neglected
from report_case import Case, Outcome, Row
from report_pictures import BLUE, INK, ORANGE, Figure
from squeal import STIFF, exact, integrated, slider
from vibrating import (
    DENSITY,
    LENGTHS,
    NU,
    RADIUS,
    SPEED,
    ball,
    bars,
    cantilever,
    radius,
    resonance,
    stick_ratio,
)

from ngslac.analysis import Modes


def Vibrating(quick):
    thickness = 0.01
    closed, apart = (Modes(bars(offset), density=1, count=4) for offset in (-1e-5, 1e-5))
    # Dispersion of elements of degree p (Ainsworth 2004): (p! / (2p)!)^2 (k h)^(2p) / (2 (2p + 1)).
    wave = 2 * np.pi * 0.01 * closed.frequencies[-1] / SPEED
    mesh = Neglected((24 / 40320) ** 2 * wave**8 / 18, "dispersion of elements of degree 4")
    rows = [
        Row(f"pressed: frequency {n + 1}", f, (n + 1) * SPEED / (2 * sum(LENGTHS)), mesh, "Hz")
        for n, f in enumerate(closed.frequencies)
    ]
    alone = np.sort([SPEED / (4 * length) * odd for length in LENGTHS for odd in (1, 3, 5)])
    rows += [
        Row(f"apart: frequency {n + 1}", f, alone[n], mesh, "Hz")
        for n, f in enumerate(apart.frequencies)
    ]
    free, held = (
        Modes(cantilever(k, thickness=thickness), density=1, count=1).frequencies[0]
        for k in (False, True)
    )
    # Timoshenko: (1 + E / (k G)) (wave number times radius of gyration)^2 / 2, with G = E / 2.
    shear = 0.5 * (1 + 2 * 6 / 5) * (3.9266 * thickness) ** 2 / 12
    rows.append(
        Row("beam: supported over free", held / free, 4.38514, Neglected(2 * shear, "shear, twice"))
    )

    def Draw(ax):
        for k, (found, colour) in enumerate(((closed, BLUE), (apart, ORANGE))):
            name = ("pressed", "apart")[k]
            ax.plot(range(1, 5), found.frequencies / 1e3, "o", color=colour, label=name)
        ax.plot(range(1, 5), np.arange(1, 5) * SPEED / (2 * sum(LENGTHS)) / 1e3, color=INK, lw=0.8)
        ax.plot(range(1, 5), alone[:4] / 1e3, color=INK, lw=0.8)
        ax.set_xlabel("mode")
        ax.set_ylabel("frequency in kHz")
        ax.legend()

    return Outcome(rows, Figure(Draw, size=(5.5, 3.2)), "Frequencies of the bars; lines: exact.")


def Coupling(quick):
    soft = Neglected(10 / STIFF, "compliance of the mass")
    rows, frictions = [], (0.3, 0.6, 0.8, 1.0)
    for mu in frictions:
        problem = slider(mu)
        found = Modes(problem.solver, density=problem.density, count=2).eigenvalues
        for k, expected in enumerate(exact(mu)[:: 1 if mu < 0.75 else 2]):
            name = f"friction {mu:g}: angular frequency {k + 1}"
            rows.append(Row(name, found[k].imag, expected.real, soft))
        if mu > 0.75:
            growth = abs(exact(mu)[0].imag)
            rows.append(Row(f"friction {mu:g}: growth", found[0].real, growth, soft))
    problem = slider(1.0, n=1, stiff=1e3, light=1e-5)
    modes = Modes(problem.solver, density=problem.density, count=1)
    value = integrated(problem, modes, dt=0.1 if quick else 0.05)
    wanted = Neglected(0.01, "wanted accuracy of the comparison")
    rows.append(Row("growth by time integration", value.real, modes.growth[0], wanted))

    def Draw(ax):
        all_mu = np.linspace(0, 1.2, 200)
        curves = np.array([exact(mu) for mu in all_mu])
        ax.plot(all_mu, curves.real, color=INK, lw=0.8)
        ax.plot(all_mu, np.abs(curves.imag), color=INK, lw=0.8, ls="--")
        for mu in frictions:
            problem = slider(mu)
            found = Modes(problem.solver, density=problem.density, count=2).eigenvalues
            ax.plot([mu, mu], found.imag, "o", color=BLUE)
            ax.plot([mu, mu], np.abs(found.real), "s", color=ORANGE, ms=4)
        ax.set_xlabel("friction")
        ax.set_ylabel("frequency (full), growth (dashed)")

    return Outcome(
        rows, Figure(Draw, size=(5.5, 3.4)), "Two frequencies meet; then one mode grows."
    )


def Resonance(quick):
    faces = 16 if quick else 32
    forces, rows = np.array([1.0, 10.0, 100.0]), []
    found = np.array(
        [Modes(ball(f, faces), density=DENSITY, count=1).frequencies[0] for f in forces]
    )
    for force, frequency in zip(forces, found, strict=True):
        a = radius(force)
        # Half a face of the radius, of which the frequency is the root; and the ball is no point.
        size = 0.25 / faces + a / RADIUS
        bound = Element(size, "half a face, and contact radius over radius", kind="relative")
        rows.append(Row(f"{force:g} N", frequency, resonance(force), bound, "Hz"))
    slope = np.polyfit(np.log(forces), np.log(found), 1)[0]
    exponent = Element((0.25 / faces + radius(100.0) / RADIUS) / np.log(10), "the same at the ends")
    rows.append(Row("exponent of the force", slope, 1 / 6, exponent))
    pressure = ball(10.0, faces).contacts[0].Table()["pressure"].max()
    peak = 3 * 10.0 / (2 * np.pi * radius(10.0) ** 2)
    rows.append(Row("10 N: largest pressure over Hertz'", pressure / peak, 1, Element(1 / faces)))
    if not quick:
        small, large = (stick_ratio(far) for far in (6.0, 12.0))
        ratio, exact_ratio = 2 * large - small, 2 * (1 - NU) / (2 - NU)
        name = "full stick: stiffness along over across, extrapolated to half-spaces"
        rows.append(Row(name, ratio, exact_ratio, Extrapolated(ratio, large)))

    def Draw(ax):
        ax.loglog(forces, found, "o", color=BLUE, label="modes")
        ax.loglog(forces, [resonance(f) for f in forces], color=INK, lw=0.8, label="Hertz' spring")
        ax.set_xlabel("force in N")
        ax.set_ylabel("frequency in Hz")
        ax.legend()

    return Outcome(rows, Figure(Draw, size=(5, 3.2)), "The ball on its contact as a spring.")


CASES = [
    Case(
        "vibrating-bars",
        "Bars and a beam in contact vibrate",
        "Two bars between fixed ends, with a speed of sound of 5000 m/s and lengths of 0.1 and "
        "0.05 m, pressed on each other or apart; and a cantilever, thickness a hundredth of the "
        "length, whose tip is free or rests on a support.",
        "Waves in bars: n c / (2 (L1 + L2)) and odd multiples of c / (4 L); Euler's beam.",
        "pytest tests/validation/test_cases.py -k vibrating-bars",
        Vibrating,
    ),
    Case(
        "mode-coupling",
        "Squeal by mode coupling",
        "A mass on two inclined springs is pressed on a moving belt by a third one. With friction "
        "the matrix is not symmetric: above mu = 3/4 the two frequencies are equal, and one mode "
        "grows. Time integration after a small kick grows as fast.",
        "N. Hoffmann, M. Fischer, R. Allgaier, L. Gaul, Mech. Res. Comm. 29 (2002): "
        "omega^2 = 2 +- sqrt(1 - 4 mu / 3).",
        "pytest tests/validation/test_cases.py -k mode-coupling",
        Coupling,
    ),
    Case(
        "contact-resonance",
        "Contact resonance of a ball",
        "A steel ball, radius 10 mm, rests on a half-space under a force; here the half-space is "
        "rigid, and the ball as soft as both. It vibrates on its contact, which is a spring of "
        "2 E* a: the frequency grows with the sixth root of the force. Bodies of revolution; and, "
        "in 3D, a circle that sticks, between equal bodies whose mass is far from it.",
        "K. L. Johnson, Contact Mechanics, sections 4.2 and 7.2: f = sqrt(2 E* a / m) / (2 pi), "
        "and 2 (1 - nu) / (2 - nu) for the stiffness along over that across.",
        "pytest tests/validation/test_cases.py -k contact-resonance",
        Resonance,
    ),
]
