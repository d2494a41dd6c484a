"""Friction in 2D with closed-form solutions: Cattaneo-Mindlin, Spence."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import test_validation_cattaneo as cattaneo
import test_validation_spence as spence
from problems_cylinder import STICK, Model
from problems_punch import CoupledPunch, StickRatio
from report_bounds import Element, Means, MeshSpread, Tolerance
from report_case import Case, Outcome, Row
from report_pictures import BLUE, GREY, INK, ORANGE, Figure, Profile


def _OfShearedState(text, profile, state, shear, exact_shear):
    end, halfwidth = np.array(profile.Zone(STICK)), cattaneo.HERTZ.halfwidth
    ratio = abs(end[np.abs(np.abs(end) - state.stick).argmax()]) / halfwidth
    error = cattaneo.Errors(profile, state)[1]
    where = f"{text}: resultant along the contact over P"
    macro = Element(cattaneo.Macro(profile) / halfwidth)
    scale = cattaneo.PROBLEM.friction * cattaneo.HERTZ.peak
    means = Means(MeshSpread(state.Traction, profile.start, profile.end) / scale)
    return [
        Row(f"{text}: end of the stick zone over a", ratio, state.stick / halfwidth, macro),
        Row(f"{text}: error of the traction over F p0, in L2", error, 0, means),
        Row(where, shear, exact_shear, Tolerance()),
    ]


def Mindlin(quick):
    problem, exact = cattaneo.PROBLEM, [cattaneo.LOADED, *cattaneo.REVERSALS]
    if quick:
        problem = replace(problem, h=4 * problem.h)
    model = Model(problem)
    model.Press(3)
    force, friction = problem.force, problem.friction
    rows, profiles = [], []
    for state in exact:
        profile = model.Shear(state.shear)
        profiles.append(profile)
        text = f"Q = {state.shear / (friction * force):+.1f} F P"
        shear = model.contact.Force()[0] / force
        rows += _OfShearedState(text, profile, state, shear, state.shear / force)

    def Draw(*axes):
        a, scale = cattaneo.HERTZ.halfwidth, friction * cattaneo.HERTZ.peak
        x = np.linspace(-1.1, 1.1, 1001)
        for ax, profile, state in zip(axes, profiles, exact, strict=True):
            spans = profile.start / a, profile.end / a
            Profile(ax, *spans, profile.traction / scale, profile.status)
            ax.plot(x, state.Traction(x * a) / scale, color=INK, lw=0.8, label="exact")
            ax.set_xlim(-1.15, 1.15)
            ax.set_xlabel("x / a")
            ax.set_title(f"Q = {state.shear / (friction * force):+.1f} F P")
        axes[0].set_ylabel("traction / (F p0)")
        axes[0].legend(loc="lower center")

    caption = "Tractions after the first loading, after half of it is taken back, and reversed."
    return Outcome(rows, Figure(Draw, columns=3, sharey=True, size=(10, 3.4)), caption)


def Spence(quick):
    if quick:
        runs = {0.2: spence.Run.Of(replace(spence.FLAT[0.2], h=0.006))}
    else:
        runs = {friction: spence.Run.Of(problem) for friction, problem in spence.FLAT.items()}
    rows, exact = [], {}
    for friction, run in runs.items():
        guess = spence.GUESS[friction]
        punch = CoupledPunch(beta=abs(run.problem.hertz.beta), friction=friction)
        ratio = StickRatio(punch.beta, friction, guess)
        x, computed = run.Ratio()
        exact[friction] = x, computed, punch.HertzFriction(x, guess)
        error = float(np.sqrt(np.mean((computed - exact[friction][2]) ** 2)))
        text, closed = f"friction {friction:g}", run.spence.ratio
        coupled, macro = f"{text}: stick ratio c/a, coupled equations", Element(run.macro)
        half = run.macro / 2
        spread = MeshSpread(lambda x, p=punch, g=guess: p.HertzFriction(x, g), x - half, x + half)
        rows += [
            Row(coupled, run.stick, ratio, macro),
            Row(f"{text}: the same, Spence's closed form", run.stick, closed, macro),
            Row(f"{text}: error of |tau|/(F p) in L2", error, 0, Means(spread)),
        ]

    def Draw(ax):
        for colour, (friction, run) in zip((BLUE, ORANGE), runs.items(), strict=False):
            x, computed, coupled = exact[friction]
            ax.plot(x, computed, "o", ms=4, color=colour, label=f"computed, friction {friction:g}")
            ax.plot(x, coupled, color=INK, lw=0.9, label="coupled equations")
            at = np.linspace(0.01, 0.999, 300)
            closed = np.abs(run.spence.zone.HertzFriction(at)) / friction
            ax.plot(at, closed, color=GREY, lw=0.9, ls="--", label="Spence's closed form")
        ax.set_xlabel("x / a")
        ax.set_ylabel("|tau| / (F p)")
        ax.legend()

    caption = "Share of the friction that is used, over the contact; 1 is slip."
    return Outcome(rows, Figure(Draw, size=(6.5, 3.8)), caption)


CASES = [
    Case(
        "cattaneo2d",
        "Cattaneo and Mindlin in 2D, with a reversal",
        "Two cylinders of equal material are pressed together, then pushed sideways to 0.6 of "
        "what friction can carry, back to half of that, and reversed. The stick zone and the "
        "tractions remember the way (hysteresis).",
        "Mindlin, J. Appl. Mech. 16 (1949); Mindlin and Deresiewicz, J. Appl. Mech. 20 (1953); as "
        "`CattaneoMindlin` and `MindlinReversal`.",
        "pytest tests/validation/test_validation_cattaneo.py",
        Mindlin,
    ),
    Case(
        "spence",
        "Stick and slip under a growing load",
        "A steel cylinder on an aluminium block: under pressure the softer surface moves further "
        "inwards, friction holds it in a stick zone that keeps its share of the contact. The load "
        "is so low that both bodies are half-planes. Spence's closed form takes the pressure "
        "from the problem without friction; the coupled equations do not. Differences of the "
        "stick ratio are accepted up to one macro-element.",
        "Spence, Proc. Camb. Phil. Soc. 73 (1973) and J. Elasticity 5 (1975), as `SpenceLine`; "
        "coupled equations solved by quadrature (`tests/validation/problems_punch.py`).",
        "pytest tests/validation/test_validation_spence.py",
        Spence,
    ),
]
