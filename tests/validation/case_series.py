"""Two hyperelastic blocks in series between walls: uniaxial strain, from one scalar equation."""

from __future__ import annotations

import numpy as np
from ngsolve import CF, Parameter, VectorH1
from posed import posed
from press import neo_hooke
from report_bounds import Tolerance
from report_case import Case, Outcome, Row
from report_pictures import Bodies, Figure
from scipy.optimize import brentq

from ngslac.meshes import TwoBlocks

STIFF, SOFT = (40.0, 60.0), (15.0, 30.0)  # shear modulus and Lame's constant: upper, lower block
WALLS = "left_upper|right_upper|left_lower|right_lower|top|bottom"


def NominalStress(stretch, shear, lame):
    """Of the compressible neo-Hooke material in uniaxial strain, per reference area."""
    return shear * (stretch - 1 / stretch) + lame * np.log(stretch) / stretch


def Stretch():
    """Of the upper block."""

    def Difference(stretch):
        return NominalStress(stretch, *STIFF) - NominalStress(1.4 - stretch, *SOFT)

    return brentq(Difference, 0.5, 0.95, xtol=1e-15)


def Squeezed(finite):
    """Two blocks pressed by 0.6: displacement and contact."""
    mesh = TwoBlocks(0.34, structured=True)
    V = VectorH1(mesh, order=2, dirichletx=WALLS, dirichlety="top|bottom")
    both = zip(STIFF, SOFT, strict=True)
    shear, lame = (mesh.MaterialCF({"upper": up, "lower": low}) for up, low in both)
    problem = posed(
        V, lambda u, v, load: neo_hooke(u, mu=shear, lame=lame), load=Parameter(0), finite=finite
    )
    stepper = problem.stepper(prescribe={"top": CF((0, -0.6 * problem.load))})
    stepper.Integrate(steps=3, printing=False)
    return problem.gf.components[0], problem.contact


def Series(quick):
    stretch, tolerance, rows = Stretch(), Tolerance(kind="relative"), []
    exact = -NominalStress(stretch, *STIFF)
    for finite in (False, True):
        gf, contact = Squeezed(finite)
        pressure = contact.Table()["pressure"]
        farthest = pressure[np.abs(pressure - exact).argmax()]
        text = "finite sliding" if finite else "small sliding"
        middle, place = gf(gf.space.mesh(0.31, 0.5))[1], -0.6 + 0.5 * (1 - stretch)
        rows += [
            Row(f"{text}: pressure", farthest, exact, tolerance),
            Row(f"{text}: displacement in the upper block", middle, place, tolerance),
        ]

    def Draw(left, right):
        Bodies(left, gf.space.mesh, gf, factor=0)
        Bodies(right, gf.space.mesh, gf)

    caption = "At rest, and squeezed to 70 % of the height."
    return Outcome(rows, Figure(Draw, columns=2, sharex=True, sharey=True), caption)


CASES = [
    Case(
        "series",
        "Hyperelastic blocks in series",
        "Two neo-Hookean blocks between walls, squeezed to 70 %: uniaxial strain, and the "
        "stretches follow from one equation.",
        "That equation, solved to rounding.",
        "pytest tests/validation/test_cases.py -k series",
        Series,
    ),
]
