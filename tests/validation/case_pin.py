"""The loaded pin of the NAFEMS contact benchmarks, in plane strain (code_aster SSNP156).

A steel pin of radius 50 mm fills the hole of an aluminium sheet, 0 <= x <= 200 with a round end of
radius 100 about (200, 0); the upper half is meshed. The sheet is fixed at x = 0, a force along x
acts in the middle of the pin. Geometry and loads from code_aster's mesh and deck: no clearance,
10 kN on the half model of thickness 1. (A. Konter, Advanced Finite Element Contact Benchmarks,
NAFEMS R0094, 2006, has the pin in three dimensions.)
"""

from __future__ import annotations

import math
from functools import cache
from itertools import count

from ngsolve import VectorH1
from problems_large import Model, SaintVenant, Small
from report_bounds import Spread, Tolerance
from report_case import Case, Outcome, Row
from report_pictures import Bodies, Figure

from ngslac.meshes.geometry import Arc, Body, CheckNonMatching, GenerateMesh, Line

YOUNG = {"pin": 210e3, "sheet": 70e3}  # MPa
FORCE = 10e3  # N/mm
MIDDLE, RADIUS, OUTER = 200.0, 50.0, 100.0

# Displacements of the sheet where the pin pushes, and of the pin at its back, mm: code_aster with
# quadratic and linear elements (SSNP156), in small strain; without friction linear ones (CONT014).
QUADRATIC, LINEAR, SMALL, SMOOTH, BACK = 0.73617, 0.71799, 0.73924, 0.75485, 0.77928
PUSHED, BEHIND = (250.0, 0.0), (150.0, 0.0)


@cache
def PinMesh(slave):
    """Mesh with `slave` edges on the pin, and fewer on the hole (coprime numbers)."""
    master = next(n for n in count(3 * slave // 4) if math.gcd(slave, n) == 1)
    bodies, size = [_Pin(slave), _Sheet(master)], 2.5 * RADIUS * math.pi / slave
    mesh = GenerateMesh(bodies, order=2, maxh=size, grading=0.3)
    CheckNonMatching(mesh, slave="pin", master="hole")
    return mesh


def _Round(radius):
    return lambda angle: (MIDDLE - radius * math.cos(angle), radius * math.sin(angle))


def _Pin(edges):
    middle, left, right = (MIDDLE, 0), _Round(RADIUS)(0), _Round(RADIUS)(math.pi)
    arc = Arc(_Round(RADIUS), math.pi, 0, "pin", edges)
    pin = Body([Line(left, middle, "axis"), Line(middle, right, "axis"), arc], "pin")
    for vertex in pin.vertices:
        if abs(vertex.p.x - MIDDLE) < 1e-6 and abs(vertex.p.y) < 1e-6:
            vertex.name = "load"
    return pin


def _Sheet(edges):
    left, right = _Round(RADIUS)(0), _Round(RADIUS)(math.pi)
    sides = [
        Arc(_Round(RADIUS), 0, math.pi, "hole", edges),
        Line(right, (MIDDLE + OUTER, 0), "axis"),
        Arc(_Round(OUTER), math.pi, math.pi / 2, "free"),
        Line((MIDDLE, OUTER), (0, OUTER), "free"),
        Line((0, OUTER), (0, 0), "fixed"),
        Line((0, 0), left, "axis"),
    ]
    return Body(sides, "sheet")


@cache
def Pushed(edges, steps=1, *, slave="pin", energy=SaintVenant, friction=None, finite=True):
    """The problem, solved, and after each step the front of the sheet and what is closed."""
    V = VectorH1(PinMesh(edges), order=2, dirichletx="fixed", dirichlety="fixed|axis")
    sides = {"slave": slave, "master": "hole" if slave == "pin" else "pin"}
    law = {"friction": friction, "finite": finite, "forces": {"load": (FORCE, 0.0)}}
    model, states = Model(V, energy, YOUNG, **sides, **law), []

    def Record(_):
        closed = model.contact.Table()["status"] > 0
        states.append((model.At("sheet", PUSHED)[0], closed))

    model.Run(steps=steps, callback=Record)
    return model, states


def PinRows(quick):
    edges = 20 if quick else 30
    rough, _ = Pushed(edges, 2, friction=0.1)
    smooth, _ = Pushed(edges)
    linear, _ = Pushed(edges, energy=Small, finite=False, friction=0.1)
    spread = Spread(QUADRATIC, [LINEAR], "linear against quadratic elements, friction 0.1")
    front = [model.At("sheet", PUSHED)[0] for model in (rough, linear, smooth)]
    back, at = smooth.At("pin", BEHIND)[0], "in front of the pin"
    rows = [
        Row(f"large displacements, friction 0.1: {at}", front[0], QUADRATIC, spread, "mm"),
        Row(f"small strain, friction 0.1: {at}", front[1], SMALL, spread, "mm"),
        Row(f"frictionless: {at}", front[2], SMOOTH, spread, "mm"),
        Row("frictionless: back of the pin", back, BACK, spread, "mm"),
        Row("contact force over load", -rough.contact.Force()[0] / FORCE, 1, Tolerance()),
    ]

    def Draw(ax):
        Bodies(ax, PinMesh(edges), rough.displacement, factor=20)

    caption = "Displacements 20 times as large: the contact opens behind the pin."
    return Outcome(rows, Figure(Draw, size=(7, 3)), caption)


CASES = [
    Case(
        "pin",
        "A loaded pin",
        "A steel pin fills the hole of an aluminium sheet without clearance and is pushed towards "
        "its round end; the contact opens at the back of the pin (receding contact).",
        "Code_aster, test SSNP156 with quadratic elements, and CONT014 with linear ones for the "
        "rows without friction.",
        "pytest tests/validation/test_large.py -k pin",
        PinRows,
    ),
]
