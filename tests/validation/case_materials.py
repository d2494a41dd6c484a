"""Materials under contact, of the examples: plasticity, rubber, thermal strain."""

from __future__ import annotations

import indentation
import materials
import numpy as np
from indentation import PRANDTL, Depths
from indenter import Indenter
from report_bounds import Meshes, Neglected, Tolerance
from report_case import Case, Outcome, Row
from report_pictures import FromFolder


def Indentation(quick):
    h, steps = (0.4, 8) if quick else (0.2, 16)
    cycles = [indentation.Cycle(Indenter(h=size), 0.08, steps, steps) for size in (h, 2 * h)]
    figures, coarser = (
        cycle.Figures() | {"onset_pressure": indentation.Onset(h=cycle.indenter.h)}
        for cycle in cycles
    )

    names = ("onset_pressure", "imprint_depth")
    onset, imprint = (Meshes(figures[name], coarser[name], 2) for name in names)
    peak, hertz = figures["onset_pressure"], figures["onset_pressure_hertz"]
    mean, where = figures["mean_pressure_ratio"], "where the cylinder leaves, and at the middle"
    depths = figures["permanent_depth"], figures["imprint_depth"]
    rows = [
        Row("peak pressure over yield stress at onset", peak, hertz, onset),
        Row("mean pressure over yield stress, fully plastic", mean, PRANDTL),
        Row(f"depth left: {where}", *depths, imprint, "mm"),
        Row("force at the end of the second loading", figures["reloading_force_ratio"], 1),
        Row("reaction against contact force", figures["balance"], 0, Tolerance()),
    ]
    if not quick:
        rows.append(Row("mean pressure over yield stress, soft block", *RigidPlastic()))
    caption = "Force over depth, mean pressure over the width, plastic strain and imprint."
    draw = FromFolder(lambda folder: indentation.Write(cycles[0], folder), "indentation.png")
    return Outcome(rows, draw, caption)


def RigidPlastic():
    """Mean pressure where elasticity plays no role, and Prandtl's."""
    problem = Indenter(h=0.4, yield_stress=8.0, hardening=1.6)
    last = problem.Advance(Depths(steps=8)[0])[-1]
    return last["mean_pressure"] / problem.yield_stress, PRANDTL


def Rubber(quick):
    results = {"rubber": materials.Rubber(), "thermal": materials.Thermal()}
    rubber, thermal = (result.figures for result in results.values())
    small = materials.Rubber(h=2.0 if quick else 1.0, squeeze=0.005, steps=1).figures["force"]
    hot = materials.Thermal(h=3.0).figures
    exact = materials.SqueezeForce(0.005)
    # Half of the contact over the diameter of the cord, with the modulus 4 G: Hertz.
    strain = Neglected(np.sqrt(exact / (2 * np.pi)), "strains of a/(2 R)")
    meshes = Meshes(hot["pressure"], thermal["pressure"], 2)
    rows = [
        Row("cord: force at half a percent", small, exact, strain, "G D"),
        Row("cord: change of the volume at a quarter", rubber["volume_change"], 0),
        Row("heated disc: pressure over E, faces of 6", thermal["pressure"], thermal["lame"]),
        Row("heated disc: the same, finer", hot["pressure"], hot["lame"], meshes),
    ]
    if not quick:
        fine = materials.Rubber(h=2.5, order=3, steps=3).figures
        for key in ("force", "peak_pressure"):
            text = f"cord: {key.replace('_', ' ')} at a quarter, against order 3"
            rows.append(Row(text, rubber[key], fine[key]))
    caption = "Force of the cord over the squeeze; pressure in the rubber; hoop stress of the disc."
    draw = FromFolder(lambda folder: materials.Write(results, folder), "materials.png")
    return Outcome(rows, draw, caption)


CASES = [
    Case(
        "indentation",
        "Elastoplastic indentation",
        "A rigid cylinder is pressed into a block that yields (von Mises, a little hardening), "
        "withdrawn, and pressed again. The mean pressure rises from Hertz' at the onset of yield "
        "to Prandtl's of the rigid plastic body, which a block reaches only if it is soft enough.",
        "Johnson (1985), sections 6.1, 6.2 and 6.4: 1.79 Y at the onset, (2 + pi) k when fully "
        "plastic.",
        "python tutorials/examples/indentation.py --out results",
        Indentation,
    ),
    Case(
        "materials",
        "Rubber and thermal strain",
        "A cord of nearly incompressible rubber is squeezed by a quarter of its diameter, with "
        "displacement and hydrostatic pressure as unknowns; a heated disc presses against the "
        "cold ring around it.",
        "Johnson (1985), equation 5.57, for small squeezes; Lamé's thick-walled cylinders; order "
        "3 on a finer mesh.",
        "python tutorials/examples/materials.py --out results",
        Rubber,
    ),
]
