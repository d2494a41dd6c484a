"""Inf-sup constants."""

from __future__ import annotations

import numpy as np
from convergence_table import NAMES as NAMES_2D
from infsup import Body, Square
from infsup3d import Body3D, Cube
from report_bounds import HalfDigit, Rate
from report_case import Case, Outcome, Row
from report_pictures import BLUE, GREEN, GREY, INK, ORANGE, Figure
from test_infsup import RIM, TABLE, UNSTABLE
from test_infsup3d import CLAMPED_TABLE
from test_infsup3d import RIM as RIM_3D
from test_infsup3d import TABLE as TABLE_3D
from test_infsup3d import UNSTABLE as UNSTABLE_3D

NAMES_3D = NAMES_2D | {"P1": "order 1, stars of faces", "P2bubble": "order 2, bubbles"}
COLOURS = (BLUE, ORANGE, GREEN, GREY, INK)


def InfSup2D(quick):
    divisions = (5, 10) if quick else (5, 10, 20)
    bodies = [Body(Square(n)) for n in divisions]
    clamped = [Body(Square(n, "trigs"), **RIM) for n in divisions]
    found = {kind: [body.InfSup(kind) for body in bodies] for kind in TABLE}
    single = [body.InfSupPerFace(1) for body in bodies]
    rim = {kind: [body.InfSup(kind) for body in clamped] for kind in (*TABLE, "P3")}
    rows = []
    for kind, constants in found.items():
        for n, ours, published in zip(divisions, constants, TABLE[kind], strict=False):
            rows.append(Row(f"{NAMES_2D[kind]}, h = 1/{n}", ours, published, HalfDigit(1e-3)))
    for n, ours, published in zip(divisions, single, UNSTABLE, strict=False):
        rows.append(
            Row(f"order 1, one face each (unstable), h = 1/{n}", ours, published, HalfDigit(1e-3))
        )
    for kind, constants in rim.items():
        text = f"{NAMES_2D[kind]}, structured, clamped rim: order in the mesh size"
        rows.append(Row(text, Order(divisions, constants), 0, Rate()))
    text = "order 1, one face each (unstable): order in the mesh size"
    rows.append(Row(text, Order(divisions, single), -1))
    curves = {NAMES_2D[kind]: values for kind, values in found.items()}
    caption = (
        "Inf-sup constants of the macro-elements that `LACSpace` makes stay away from zero; that "
        "of one multiplier for each face of order 1 decays like the mesh size."
    )
    return Outcome(rows, Curves(divisions, curves | {"order 1, one face each": single}), caption)


def Order(divisions, constants):
    """Minus the power of the mesh size that the constants decay with: 0 or more is stable."""
    finer = divisions[-1] / divisions[0]
    return float(np.log(constants[-1] / constants[0]) / np.log(finer))


def InfSup3D(quick):
    levels = (4,) if quick else (4, 6, 8)
    tables = {"": (TABLE_3D, {}), ", clamped rim": (CLAMPED_TABLE, {"dirichlet": RIM_3D})}
    rows, curves = [], {}
    for note, (table, flags) in tables.items():
        bodies = {(kind, n): Body3D(Cube(n, kind), **flags) for kind, _ in table for n in levels}
        for (kind, element), published in table.items():
            name = f"{kind}, {NAMES_3D[element]}{note}"
            curves[name] = [bodies[kind, n].InfSup(element) for n in levels]
            for n, ours, constant in zip(levels, curves[name], published, strict=False):
                rows.append(Row(f"{name}, n = {n}", ours, constant, HalfDigit(1e-3)))
        if not note:
            single = [bodies["tet", n].InfSupPerFace(2) for n in levels]
    curves["tet, order 2, one triangle each"] = single
    for n, ours, constant in zip(levels, single, UNSTABLE_3D, strict=False):
        rows.append(
            Row(
                f"tet, order 2, one triangle each (unstable), n = {n}",
                ours,
                constant,
                HalfDigit(1e-3),
            )
        )
    caption = "The same in 3D, over the number of elements along the edge of the contact face."
    return Outcome(rows, Curves(levels, curves), caption)


def Curves(levels, curves):
    def Draw(ax):
        for k, (name, values) in enumerate(curves.items()):
            style = "--x" if "each" in name else "-s" if "clamped" in name else "-o"
            ax.plot(levels, values, style, ms=4, lw=1, color=COLOURS[k % 5], label=name)
        ax.set_xticks(levels)
        ax.set_ylim(0, 1)
        ax.set_xlabel("elements along the edge")
        ax.set_ylabel("inf-sup constant")
        ax.legend(loc="center left", bbox_to_anchor=(1.01, 0.5))

    return Figure(Draw, size=(7.5, 3.6))


CASES = [
    Case(
        "infsup2d",
        "Inf-sup constants in 2D",
        "The constant that tells whether displacements and contact tractions fit together, for "
        "the unit square with its lower edge as slave side: the smallest eigenvalue of the Schur "
        "complement against that of displacements of order 5.",
        "For unstructured triangles, constants computed with a program of others; the method's "
        "condition: Abbas, Drouet, Hild, Pignet (2017), section 2.2.",
        "pytest tests/validation/test_infsup.py",
        InfSup2D,
    ),
    Case(
        "infsup3d",
        "Inf-sup constants in 3D",
        "The same for a box with structured tetrahedra or hexahedra, free or clamped all around "
        "the contact face. On triangles order 2 needs macro-elements of two faces, or bubbles.",
        "Constants computed with a program of others.",
        "pytest tests/validation/test_infsup3d.py",
        InfSup3D,
    ),
]
