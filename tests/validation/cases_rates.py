"""Rates of convergence against exact solutions."""

from __future__ import annotations

import numpy as np
from convergence_table import NAMES, Picture
from mms_large_table import PUBLISHED
from problems_mms_large import Manufactured, Rates
from report_bounds import Rate
from report_case import Case, Outcome, Row
from report_pictures import BLUE, GREEN, INK, ORANGE, Figure
from signorini import Measure
from signorini import Rates as MeanRate

COLOURS = (BLUE, ORANGE, GREEN, INK)
# Single halvings vary with the place of the contact's end: two sequences are averaged.
SEQUENCES = [(8, 16, 32), (10, 20, 40)]
THEORY = {
    1: {"energy": 1.0, "l2": 2.0, "mean": 1.0},
    2: {"energy": 1.5, "l2": 2.0, "mean": 1.0},
}
QUANTITIES = {
    "energy": "displacement, H1",
    "l2": "displacement, L2",
    "mean": "multipliers, means in L2",
}


def Signorini(quick):
    sequences = [(4, 8, 16)] if quick else SEQUENCES
    kinds = ["P2"] if quick else list(NAMES)
    errors = {kind: [[Measure(n, kind) for n in levels] for levels in sequences] for kind in kinds}
    rows = []
    for kind, parts in errors.items():
        for name, theory in THEORY[min(2, int(kind[1]))].items():
            rate = float(np.mean([MeanRate(part, name) for part in parts]))
            text = f"{NAMES[kind]}: rate of the {QUANTITIES[name]}"
            rows.append(Row(text, rate, theory, Rate()))
    shown = {kind: parts[0] for kind, parts in errors.items()}
    caption = "Errors over the mesh size; dashed the rates of the theory."
    return Outcome(rows, lambda file: Picture(shown, file), caption)


def ManufacturedLarge(quick):
    rows, curves = [], {}
    for case, (name, *published) in PUBLISHED.items():
        if quick and name != "TETRA4":
            continue
        levels = {1: (3, 6), 2: (2, 4)}[case.order]
        errors = []
        for n in levels:
            problem = Manufactured(case, n)
            problem.Solve()
            errors.append(problem.errors)
        rates = Rates(levels, errors)
        curves[name] = levels, errors
        theory = {1: (2.0, 0.5), 2: (2.5, 1.0)}[case.order]
        for k, key in enumerate(rates):
            text = f"{name} ({case.name}): rate of the {key} (code_aster: {published[k]:.2f})"
            rows.append(Row(text, rates[key], theory[k], Rate()))

    def Draw(*axes):
        for ax, key in zip(axes, ("displacement", "pressure"), strict=True):
            for k, (name, (levels, errors)) in enumerate(curves.items()):
                style = "--o" if levels[-1] == 6 else "-s"
                values = [error[key] for error in errors]
                sizes = [1 / n for n in levels]
                ax.loglog(sizes, values, style, ms=4, color=COLOURS[k % 4], label=name)
            ax.set_title(f"{key}, L2")
            ax.set_xlabel("mesh size")
            ax.set_xticks([1 / 6, 1 / 4, 1 / 3, 1 / 2], ["1/6", "1/4", "1/3", "1/2"])
            ax.minorticks_off()
        axes[0].set_ylabel("relative error")
        axes[1].legend(loc="center left", bbox_to_anchor=(1.01, 0.5))

    caption = "Relative errors on two meshes each; order 1 dashed, order 2 solid."
    return Outcome(rows, Figure(Draw, columns=2, size=(10, 4)), caption)


CASES = [
    Case(
        "signorini",
        "Two elastic bodies with an exact solution",
        "Two blocks of different materials touch without friction up to x = 4/3 and part beyond. "
        "The exact displacement has the singularity of contact problems: the pressure goes to "
        "zero like the root of the distance. Rates of convergence on non-matching meshes over two "
        "halvings, averaged over two sequences of meshes. The multipliers are compared with the "
        "means of the exact pressure over the macro-elements.",
        "Westergaard, J. Appl. Mech. 6 (1939) A49, as `ElasticSignorini`; rates: Drouet and Hild, "
        "Numer. Math. 136 (2017).",
        "python tests/validation/convergence_table.py --out convergence.png",
        Signorini,
    ),
    Case(
        "mms-large",
        "Large deformation with a known solution",
        "A cube of the material of St. Venant and Kirchhoff whose lower face is bent onto a rigid "
        "paraboloid; loads follow from the chosen displacement. Rates of convergence between two "
        "meshes, which are coarser than those of the published rates.",
        "Theory: 2 and 1/2 for order 1, 5/2 and 1 for order 2. Published for Local Average "
        "Contact: code_aster, test SSNV219 (modellings e to m).",
        "python tests/validation/mms_large_table.py --coarse",
        ManufacturedLarge,
    ),
]
