"""Two-body contact against an exact solution with the singularity of contact problems.

Two blocks of different materials, (0, 2) x (0, 1) on (0, 2) x (-1, 0), touch without friction for
x < 4/3 and part beyond; `ElasticSignorini` is the solution, and Dirichlet data on all sides but the
interface. The slave has N edges on the interface, the master about 1.37 N.
"""

from __future__ import annotations

from math import log2, sqrt

import ngsolve
import numpy as np
from elasticity import NAMES, Displacements, Material, Pair
from exact_signorini import ElasticSignorini
from ngsolve import BND, CF, InnerProduct, Integrate, dx, x, y
from report_bounds import Rate
from report_case import Case, Outcome, Row
from report_pictures import BLUE, GREEN, GREY, INK, ORANGE, Figure
from scipy.special import roots_legendre

from ngslac.meshes import TwoBlocks

WIDTH = 2.0
EXACT = ElasticSignorini(young1=3.0, nu1=0.3, young2=1.0, nu2=0.2, tip=4 / 3, strength=1.0)
SIDES = "top|bottom|left_upper|right_upper|left_lower|right_lower"
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
    "traction": "multipliers, L2",
}
SLOPES = {"energy": (1.0, 1.5), "l2": (2.0, 2.5), "traction": (1.0,)}
STYLE = dict(zip(NAMES, zip((BLUE, ORANGE, GREEN, INK, GREY), "os^Dv", strict=True), strict=True))


def Both(field):
    """A field of both bodies as one coefficient function each."""
    bodies = {"upper": 1, "lower": 2}
    return {name: CF(field(x, y, body=b, sqrt=ngsolve.sqrt)) for name, b in bodies.items()}


def Solved(n, kind):
    """The discrete solution, as a `Pair`, and the last iteration."""
    mesh = TwoBlocks(WIDTH / n, WIDTH / n / 1.37, width=WIDTH, structured=True)
    V = Displacements(mesh, kind, dirichlet=SIDES)
    mesh = V.mesh
    young = mesh.MaterialCF({"upper": EXACT.young1, "lower": EXACT.young2})
    nu = mesh.MaterialCF({"upper": EXACT.nu1, "lower": EXACT.nu2})
    pair, both = Pair(V, Material(young=young, nu=nu)), Both(EXACT.Displacement)
    body = {
        name: "upper" if "upper" in name or name == "top" else "lower" for name in SIDES.split("|")
    }
    pair.Hold(mesh.BoundaryCF({side: both[name] for side, name in body.items()}), SIDES)
    return pair, pair.Solve(tol=1e-11)


def Measure(n, kind):
    """Relative errors.

    `energy` of the displacement (equivalent to its H1 error by Korn's inequality), `l2` of the
    displacement, `traction` of the multiplier in L2, `mean` of the multiplier against the averages
    of the exact pressure over the macro-elements; `iterations` of the solver.
    """
    pair, last = Solved(n, kind)
    mesh, u = pair.mesh, pair.displacement
    exact = mesh.MaterialCF(Both(EXACT.Displacement))
    s = mesh.MaterialCF(Both(EXACT.Stress))
    stress = CF((s[0], s[2], s[2], s[1]), dims=(2, 2))

    def Ratio(density, error, whole):
        order = dx(bonus_intorder=6)
        return sqrt(
            Integrate(density(error) * order, mesh) / Integrate(density(whole) * order, mesh)
        )

    traction, mean = MultiplierErrors(pair)
    return {
        "n": n,
        "energy": Ratio(lambda t: Energy(pair.material, t), pair.stress - stress, stress),
        "l2": Ratio(lambda w: InnerProduct(w, w), u - exact, exact),
        "traction": traction,
        "mean": mean,
        "iterations": last.number,
    }


def Energy(material, stress):
    """Twice the density of the complementary energy in plane strain."""
    trace = stress[0, 0] + stress[1, 1]
    part = InnerProduct(stress, stress) - material.nu * trace * trace
    return (1 + material.nu) / material.young * part


def MultiplierErrors(pair):
    """Errors in L2, true and of the averages, relative to the exact pressure."""
    faces = [el for el in pair.mesh.Elements(BND) if el.mat == "slave"]
    ends = np.sort([[pair.mesh[v].point[0] for v in el.vertices] for el in faces], axis=1)
    macro = np.array([pair.Q.macros[el.nr] for el in faces])
    table = pair.contact.Table()
    traction = table["traction"][macro]
    size = ends[:, 1] - ends[:, 0]
    nodes, weights = roots_legendre(64)
    exact = EXACT.Pressure(ends[:, :1] + 0.5 * size[:, None] * (1 + nodes))
    true = (exact - traction[:, 1:]) ** 2 + traction[:, :1] ** 2
    norm = np.sum(0.5 * size * (exact**2 @ weights))
    mean = np.zeros(len(table["pressure"]))
    np.add.at(mean, macro, size * EXACT.MeanPressure(ends[:, 0], ends[:, 1]))
    mean /= table["fullarea"]
    averages = np.sum(table["fullarea"] * (mean - table["pressure"]) ** 2)
    return sqrt(np.sum(0.5 * size * (true @ weights)) / norm), sqrt(averages / norm)


def MeanRate(sequences, name):
    """Rate of all halvings together, averaged over sequences of meshes."""
    return float(
        np.mean([log2(part[0][name] / part[-1][name]) / (len(part) - 1) for part in sequences])
    )


def Signorini(quick):
    sequences = [(4, 8, 16)] if quick else SEQUENCES
    kinds = ["P2"] if quick else list(NAMES)
    errors = {kind: [[Measure(n, kind) for n in levels] for levels in sequences] for kind in kinds}
    rows = []
    for kind, parts in errors.items():
        for name, theory in THEORY[min(2, int(kind[1]))].items():
            text = f"{NAMES[kind]}: rate of the {QUANTITIES[name]}"
            rows.append(Row(text, MeanRate(parts, name), theory, Rate()))

    def Draw(*axes):
        for ax, name in zip(axes, SLOPES, strict=True):
            Curves(ax, {kind: parts[0] for kind, parts in errors.items()}, name)
        axes[0].set_ylabel("relative error")
        axes[-1].legend(loc="center left", bbox_to_anchor=(1.01, 0.5))

    caption = "Errors over the mesh size; dashed the rates of the theory."
    return Outcome(rows, Figure(Draw, columns=3, size=(11.5, 3.4)), caption)


def Curves(ax, results, name):
    """Errors over the mesh size, and dashed lines of the expected rates below them."""
    for kind, errors in results.items():
        sizes, values = [1 / e["n"] for e in errors], [e[name] for e in errors]
        colour, marker = STYLE[kind]
        ax.loglog(sizes, values, color=colour, marker=marker, ms=4, label=NAMES[kind])
    ordered = sorted(results.values(), key=lambda errors: errors[-1][name])
    curves = [ordered[0]] if len(SLOPES[name]) == 1 else [ordered[-1], ordered[0]]
    for slope, errors in zip(SLOPES[name], curves, strict=True):
        shift = 0.55 * min(e[name] * e["n"] ** slope for e in errors)
        ax.loglog(sizes, [shift * h**slope for h in sizes], color=GREY, lw=0.9, ls="--")
        ax.text(sizes[1], shift * sizes[1] ** slope, f"rate {slope:g}", va="top", fontsize=8)
    ax.set_title(QUANTITIES[name])
    ax.set_xlabel("mesh size over the length of the interface")
    ax.set_xticks(sizes, [f"1/{round(1 / h)}" for h in sizes])
    ax.minorticks_off()


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
        "pytest tests/validation/test_signorini.py",
        Signorini,
    ),
]
