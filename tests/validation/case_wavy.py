"""Waves on a plane that a pressure flattens: Westergaard's solution."""

from __future__ import annotations

from functools import cache

import numpy as np
from elasticity import Sorted
from netgen.occ import OCCGeometry, Rectangle, Y
from ngsolve import (
    Mesh,
    VectorH1,
    cos,
    ds,
    pi,
    x,
)
from posed import elastic, posed
from report_bounds import Element, Neglected
from report_case import Case, Outcome, Row
from report_pictures import INK, ORANGE, Figure

NU, HEIGHT = 0.3, 0.01  # E = 1, wave length 1
FULL = np.pi * HEIGHT / (1 - NU**2)  # mean pressure at which all touches
SHARES = (0.1, 0.25, 0.5, 0.75, 0.9)


def Edge(share):
    """Half the length of contact, for a share of the full pressure."""
    return np.arcsin(np.sqrt(share)) / np.pi


@cache
def Pressed(faces):
    """Tables of half a wave under shares of the full pressure; its ends keep their place."""
    block = Rectangle(0.5, 1.5).Face()
    block.edges.name = "side"
    block.edges.Min(Y).name, block.edges.Max(Y).name = "slave", "top"
    block.edges["slave"].maxh = 0.5 / faces
    mesh = Mesh(OCCGeometry(block, dim=2).GenerateMesh(maxh=5 / faces))
    V = VectorH1(mesh, order=2, dirichletx="side")
    wave = HEIGHT * (1 - cos(2 * pi * x))
    problem = posed(V, elastic(1.0, NU), lambda u, v, load: load * v[1] * ds("top"), obstacle=wave)
    solver, tables = problem.solver(), []
    for share in SHARES:
        problem.load.Set(share * FULL)
        solver.Solve(printing=False)
        tables.append(Sorted(problem.contact.Table()))
    return tables


def Touching(table):
    """Half the length of contact."""
    return table["area"][table["status"] > 0].sum()


def Wavy(quick):
    tables, rows = Pressed(60 if quick else 100), []
    for share, table in zip(SHARES, tables, strict=True):
        size = 2 * table["area"].max()
        bound = Element(size, f"{size:.4f} wave lengths")
        name = f"under {share:g} of the full pressure"
        rows.append(Row(f"part in contact {name}", 2 * Touching(table), 2 * Edge(share), bound))
        peak = table["pressure"].max() / FULL
        ends = Neglected(1e-3, "the first face's mean, 2e-4, and where contact ends")
        rows.append(Row(f"peak {name}", peak, 2 * np.sqrt(share), ends))

    def Draw(ax):
        for share, table in zip(SHARES, tables, strict=True):
            place = np.linspace(0, Edge(share), 200)
            exact = (
                2 * np.cos(np.pi * place) * np.sqrt((share - np.sin(np.pi * place) ** 2).clip(0))
            )
            ax.plot(place, exact, color=INK, lw=0.8)
            every = slice(None, None, max(1, len(table["x"]) // 50))
            ax.plot(table["x"][every, 0], table["pressure"][every] / FULL, ".", ms=4, color=ORANGE)
        ax.set(xlabel="place over the wave length", ylabel="pressure over that at full contact")

    caption = "Pressures on half a wave (dots), and Westergaard's."
    return Outcome(rows, Figure(Draw, size=(6, 3.4)), caption)


CASES = [
    Case(
        "wavy",
        "A wavy surface is flattened",
        "A half-space with waves on its surface is pressed on a rigid plane. It touches along "
        "strips, up to full contact at the mean pressure pi E* D/l (height 2 D, length l).",
        "Westergaard (1939); K. L. Johnson, Contact Mechanics, section 13.2.",
        "pytest tests/validation/test_cases.py -k wavy",
        Wavy,
    )
]
