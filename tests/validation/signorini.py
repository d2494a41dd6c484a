"""Errors of two-body contact against an exact solution with the singularity of contact problems.

Two blocks of different materials, (0, 2) x (0, 1) on (0, 2) x (-1, 0), touch without friction for
x < 4/3 and part beyond; `ElasticSignorini` is the solution, and Dirichlet data on all sides but the
interface. The slave has N edges on the interface, the master about 1.37 N.
"""

from dataclasses import dataclass
from math import log2, sqrt

import ngsolve
import numpy as np
from elasticity import Displacements, Material, Pair
from ngsolve import BND, CF, InnerProduct, Integrate, dx, x, y
from scipy.special import roots_legendre

from ngslac.meshes import TwoBlocks
from ngslac.reference import ElasticSignorini

__all__ = ["EXACT", "Errors", "Measure", "Rates", "Solved"]

WIDTH = 2.0
EXACT = ElasticSignorini(young1=3.0, nu1=0.3, young2=1.0, nu2=0.2, tip=4 / 3, strength=1.0)
SIDES = "top|bottom|left_upper|right_upper|left_lower|right_lower"


@dataclass(frozen=True)
class Errors:
    """Relative errors.

    `energy` of the displacement (equivalent to its H1 error by Korn's inequality), `l2` of the
    displacement, `traction` of the multiplier in L2, `mean` of the multiplier against the averages
    of the exact pressure over the macro-elements; `iterations` of the solver.
    """

    n: int
    energy: float
    l2: float
    traction: float
    mean: float
    iterations: int


def Both(field):
    """A field of both bodies as one coefficient function."""
    values = {
        name: field(x, y, body=b, sqrt=ngsolve.sqrt) for name, b in (("upper", 1), ("lower", 2))
    }
    return {name: CF(value) for name, value in values.items()}


def Solved(n, kind, *, structured=True, quads=False):
    """The discrete solution, as a `Pair`, and the last iteration."""
    mesh = TwoBlocks(WIDTH / n, WIDTH / n / 1.37, width=WIDTH, structured=structured, quads=quads)
    V = Displacements(mesh, kind, dirichlet=SIDES)
    mesh = V.mesh
    young = mesh.MaterialCF({"upper": EXACT.young1, "lower": EXACT.young2})
    nu = mesh.MaterialCF({"upper": EXACT.nu1, "lower": EXACT.nu2})
    pair = Pair(V, Material(young=young, nu=nu))
    upper, lower = Both(EXACT.Displacement).values()
    sides = {
        name: upper if name in ("top", "left_upper", "right_upper") else lower
        for name in SIDES.split("|")
    }
    pair.Hold(mesh.BoundaryCF(sides), SIDES)
    return pair, pair.Solve(tol=1e-11)


def Measure(n, kind, **options):
    """Solve and compare."""
    pair, last = Solved(n, kind, **options)
    mesh, u = pair.mesh, pair.displacement
    exact = mesh.MaterialCF(Both(EXACT.Displacement))
    s = mesh.MaterialCF(Both(EXACT.Stress))
    stress = CF((s[0], s[2], s[2], s[1]), dims=(2, 2))
    order = dx(bonus_intorder=6)
    energy = [
        Integrate(Energy(pair.material, t) * order, mesh) for t in (pair.stress - stress, stress)
    ]
    l2 = [Integrate(InnerProduct(w, w) * order, mesh) for w in (u - exact, exact)]
    traction, mean = MultiplierErrors(pair)
    return Errors(n, sqrt(energy[0] / energy[1]), sqrt(l2[0] / l2[1]), traction, mean, last.number)


def Energy(material, stress):
    """Twice the density of the complementary energy in plane strain."""
    trace = stress[0, 0] + stress[1, 1]
    return (
        (1 + material.nu)
        / material.young
        * (InnerProduct(stress, stress) - material.nu * trace * trace)
    )


def Spans(pair):
    """Ends of the slave faces and the macro-element of each."""
    faces = [el for el in pair.mesh.Elements(BND) if el.mat == "slave"]
    ends = np.array([[pair.mesh[v].point[0] for v in el.vertices] for el in faces])
    return np.sort(ends, axis=1), np.array([pair.Q.macros[el.nr] for el in faces])


def MultiplierErrors(pair):
    """Errors in L2, true and of the averages, relative to the exact pressure."""
    ends, macro = Spans(pair)
    table = pair.contact.Table()
    traction = table["traction"][macro]
    size = ends[:, 1] - ends[:, 0]
    nodes, weights = roots_legendre(64)
    at = ends[:, :1] + 0.5 * size[:, None] * (1 + nodes)
    exact = EXACT.Pressure(at)
    true = (exact - traction[:, 1:]) ** 2 + traction[:, :1] ** 2
    norm = np.sum(0.5 * size * (exact**2 @ weights))
    mean = np.zeros(len(table["pressure"]))
    np.add.at(mean, macro, size * EXACT.MeanPressure(ends[:, 0], ends[:, 1]))
    mean /= table["fullarea"]
    averages = np.sum(table["fullarea"] * (mean - table["pressure"]) ** 2)
    return sqrt(np.sum(0.5 * size * (true @ weights)) / norm), sqrt(averages / norm)


def Rates(errors, name, steps=2):
    """Rate of the last `steps` halvings together (single ones vary with the place of the tip)."""
    values = [getattr(e, name) for e in errors]
    return log2(values[-1 - steps] / values[-1]) / steps
