"""Figures of the Hertz problem: from the macro-elements to numbers, a table and pictures."""

from __future__ import annotations

import math

import numpy as np
from ngsolve import BND

from ngslac.output.vtkfile import WriteVTK

from ._multiplier_picture import MultiplierPicture
from ._stress_picture import StressPicture

__all__ = [
    "Comparison",
    "ContactEdge",
    "Figures",
    "Macros",
    "PeakPressure",
    "Report",
    "Spans",
    "Write",
]


def Spans(problem, mesh, macros):
    """Start and end x of each macro-element in mm, from its faces.

    `macros` has the macro-element of each boundary element of the mesh, -1 off the slave side.
    """
    macros = np.asarray(macros)
    spans = np.full((macros.max() + 1, 2), (np.inf, -np.inf))
    for el, macro in zip(mesh.Elements(BND), macros, strict=True):
        if macro >= 0:
            points = np.array([mesh.vertices[v.nr].point for v in el.vertices])
            x = points @ problem.frame[0] / problem.length
            spans[macro] = min(spans[macro, 0], x.min()), max(spans[macro, 1], x.max())
    return spans


def Macros(problem, table, spans):
    """Macro-elements ordered by x, in the frame of the problem, in mm and MPa."""
    frame = problem.frame.T
    traction, normal = (np.asarray(table[name]) @ frame for name in ("traction", "normal"))
    tangential = normal[:, 0] * traction[:, 1] - normal[:, 1] * traction[:, 0]
    macros = {
        "start": spans[:, 0],
        "end": spans[:, 1],
        "pressure": np.asarray(table["pressure"]) / problem.stress,
        "traction": tangential / problem.stress,
        "status": np.asarray(table["status"]).astype(int),
    }
    order = np.argsort(spans[:, 0])
    return {name: values[order] for name, values in macros.items()}


def PeakPressure(macros, hertz):
    """Pressure at the origin over Hertz' p0, from the macro-elements at the origin.

    Their multiplier is a mean value. It is compared with the mean of Hertz' pressure over the same
    macro-element (the first value); the second one is the multiplier over p0.
    """
    start, end = macros["start"], macros["end"]
    near = 1e-3 * (end - start)
    first = (start <= near) & (end >= -near)
    pressure = macros["pressure"][first]
    exact = hertz.MeanPressure(start[first], end[first])
    return float(np.mean(pressure / exact)), float(np.mean(pressure) / hertz.peak)


def ContactEdge(macros):
    """The last macro-element in contact (start, end), and an estimate of the edge inside.

    The estimate extends p^2, which is linear in x^2 for Hertz' pressure, from the outer half of the
    contact without the last macro-element; it is None with fewer than three values.
    """
    active = (macros["status"] > 0) & (macros["end"] > 0)
    if not active.any():
        return (0.0, 0.0), None
    start, end, pressure = (macros[name][active] for name in ("start", "end", "pressure"))
    middle = 0.5 * (start + end)
    outer = middle[:-1] > 0.4 * end[-1]
    interval = float(start[-1]), float(end[-1])
    if outer.sum() < 3:
        return interval, None
    slope, constant = np.polyfit(middle[:-1][outer] ** 2, pressure[:-1][outer] ** 2, 1)
    return interval, math.sqrt(-constant / slope) if slope < 0 < constant else None


def Comparison(problem, state):
    """Figures of one state."""
    hertz = problem.Hertz(state.time)
    ratio, raw = PeakPressure(state.macros, hertz)
    interval, estimate = ContactEdge(state.macros)
    return {
        "p0_ratio": ratio,
        "p0_ratio_raw": raw,
        "contact_edge": interval[1],
        "contact_edge_interval": list(interval),
        "contact_edge_estimate": estimate,
        "force_ratio": state.force,
    }


def Figures(results, seconds):
    """All figures of the run, ready for JSON."""
    problem, states = results.problem, results.states
    iterations = [int(state.iterations) for state in states]
    half = results.At(0.5)
    return {
        **Comparison(problem, states[-1]),
        "newton_iterations": iterations,
        "newton_max": max(iterations),
        "ndof": len(results.solution.vec),
        "seconds": seconds,
        "hertz": {"halfwidth": problem.Hertz().halfwidth, "peak": problem.Hertz().peak},
        "half_load": Comparison(problem, half) if half else None,
        "order": problem.order,
        "h": problem.h,
        "friction": problem.friction,
        "steps": problem.steps,
        "stabilize": problem.stabilize,
    }


def Report(results):
    """The table of computed and analytical values as text."""
    problem, figures = results.problem, results.figures
    lines = [
        f"Hertz problem: order {problem.order}, h = {problem.h:g} mm, "
        f"friction {problem.friction:g}, {problem.steps} steps, "
        f"stabilize {problem.stabilize}, {figures['ndof']} unknowns",
        "",
        f"{'t':>5}  {'':<24}{'computed':>14}{'Hertz':>12}{'ratio':>10}",
    ]
    for state in filter(None, (results.At(0.5), results.states[-1])):
        lines += _Rows(problem, state)
    counts = " ".join(str(n) for n in figures["newton_iterations"])
    lines += ["", f"Newton iterations {counts}   (at most {figures['newton_max']})"]
    lines += [f"{figures['seconds']:.1f} s without pictures"]
    return "\n".join(lines)


def _Rows(problem, state):
    """Rows of the table for one state."""
    hertz, values = problem.Hertz(state.time), Comparison(problem, state)
    first, last = values["contact_edge_interval"]
    load = hertz.force * (0.5 if problem.half else 1.0)
    force = values["force_ratio"] * load
    rows = [
        ("pressure p(0)     [MPa]", values["p0_ratio"] * hertz.peak, hertz.peak),
        ("contact edge       [mm]", values["contact_edge_estimate"], hertz.halfwidth),
        ("contact force    [N/mm]", force, load),
    ]
    text = [
        f"{'':>5}  {name:<24}{value:>14.3f}{exact:>12.3f}{value / exact:>10.5f}"
        for name, value, exact in rows
        if value is not None
    ]
    text[0] = f"{state.time:>5g}{text[0][5:]}"
    return [*text, f"{'':>5}  last macro in contact    {first:.3f}..{last:.3f} mm"]


def Write(results, directory):
    """Write pictures of the paper (figures 1 to 3) and a VTU file of the final state."""
    directory.mkdir(parents=True, exist_ok=True)
    components = {
        r"$\sigma_{xy}$": results.stress[0, 1],
        r"$\sigma_{yy}$": results.stress[1, 1],
    }
    solution = results.solution.vec
    for state in filter(None, (results.At(0.5), results.At(1.0))):
        solution.data = state.vector
        StressPicture(
            results.mesh,
            results.displacement,
            components,
            directory / f"hertz_stress_t{state.time:.1f}.png",
            window=(0, 14, -13, 9),
            title=f"Hertz problem with friction {results.problem.friction:g}, t = {state.time:.1f}",
        )
    last = results.states[-1]
    solution.data = last.vector
    MultiplierPicture(
        results.mesh,
        results.displacement,
        last.macros,
        directory / "hertz_multipliers.png",
        exact=results.problem.Hertz(last.time).Pressure,
        friction=results.problem.friction,
        window=(0, 9, -6.2, 2.8),
        limit=9,
    )
    names = ("displacement", "stress_xy", "stress_yy", "stress_xx")
    shown = (results.displacement, *components.values(), results.stress[0, 0])
    WriteVTK(
        directory / "hertz",
        results.mesh,
        dict(zip(names, shown, strict=True)),
        subdivision=max(0, results.problem.order - 1),
    )
