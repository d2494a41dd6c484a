"""Figures of the Hertz problems in 3D: from the macro-elements to numbers and a table."""

from __future__ import annotations

import numpy as np
from scipy.optimize import minimize_scalar

__all__ = ["Comparison", "Figures", "Radius", "Report"]

NEAR = 0.25  # times the contact radius: macro-elements that tell the peak pressure
INNER = 0.8  # times the contact radius: macro-elements whose pressures are smooth


def Radius(hertz):
    """Contact radius of a point contact, half width of a line contact."""
    return hertz.halfwidth if hasattr(hertz, "halfwidth") else hertz.contact_radius


def Fit(macros, pressure, guess):
    """Peak and radius of the Hertz pressure that is nearest in L2 to these means."""

    def Best(radius):
        shape = macros.Shape(radius)
        weighted = macros.area * shape
        peak = weighted @ pressure / (weighted @ shape)
        return peak, macros.area @ (pressure - peak * shape) ** 2

    bounds = 0.8 * guess, 1.25 * guess
    found = minimize_scalar(lambda a: Best(a)[1], bounds=bounds, method="bounded")
    return float(Best(found.x)[0]), float(found.x)


def Comparison(macros, hertz, pressure, status):
    """Compare pressures of the macro-elements with the means of Hertz' pressure over them.

    Parameters
    ----------
    macros : Macros
    hertz : HertzPoint or HertzLine
    pressure, status : (n,) arrays

    Returns
    -------
    dict
        ``p0_ratio``: over the macro-elements about the middle; ``p0_ratio_fit`` and
        ``contact_radius_ratio``: of the Hertz pressure with the least distance in L2;
        ``p0_ratio_raw``: largest pressure over Hertz' peak; ``contact_edge_interval``: where the
        first open macro-element begins and the last closed one ends, over the radius;
        ``macro_size``: mean size over the radius; ``profile_error``: relative, in L2;
        ``second_difference``, ``second_difference_exact``, ``oscillation``: the largest
        differences to the mean of the neighbours of the pressures, of the exact means, and of the
        errors, over the peak, inside of 80 % of the radius (None if there is no macro-element).
    """
    radius = Radius(hertz)
    exact = hertz.peak * macros.Shape(radius)
    low, high = macros.extent.T
    near = low < NEAR * radius
    peak, fitted = Fit(macros, pressure, radius)
    closed = status > 0
    edge = [low[~closed].min(initial=np.inf), high[closed].max(initial=0.0)]
    error = np.sqrt(macros.area @ (pressure - exact) ** 2 / (macros.area @ exact**2))
    return {
        "p0_ratio": float(macros.area[near] @ pressure[near] / (macros.area[near] @ exact[near])),
        "p0_ratio_fit": peak / hertz.peak,
        "p0_ratio_raw": float(pressure.max() / hertz.peak),
        "contact_radius_ratio": fitted / radius,
        "contact_edge_interval": [float(r / radius) for r in edge],
        "macro_size": float(np.sqrt(macros.area.mean()) / radius),
        "profile_error": float(error),
        **_Oscillation(macros, pressure / hertz.peak, exact / hertz.peak, radius),
    }


def _Oscillation(macros, pressure, exact, radius):
    """Second differences between neighbouring macro-elements over the peak pressure."""
    names = ("second_difference", "second_difference_exact", "oscillation")
    inner = macros.extent[:, 1] < INNER * radius
    if not inner.any():
        return dict.fromkeys(names)
    values = (pressure, exact, pressure - exact)
    return {
        name: float(np.abs(macros.Bends(v)[inner]).max())
        for name, v in zip(names, values, strict=True)
    }


def Figures(results):
    """All figures of the run, ready for JSON."""
    problem, states, macros = results.problem, results.states, results.macros
    iterations = [int(state.iterations) for state in states]
    hertz = problem.Hertz()
    radius = Radius(hertz)
    inside = macros.extent[:, 0] < radius
    return {
        **Comparison(
            macros, problem.Hertz(states[-1].time), states[-1].pressure, states[-1].status
        ),
        "force_ratio": states[-1].force,
        "newton_iterations": iterations,
        "newton_max": max(iterations),
        "ndof": len(results.solution.vec),
        "macros": len(macros.area),
        "macros_inside": int(inside.sum()),
        "elements_per_radius": radius / problem.h,
        "seconds": sum(results.seconds.values()),
        "seconds_per_phase": dict(results.seconds),
        "hertz": {"contact_radius": radius, "peak": hertz.peak, "force": hertz.force},
        **{
            name: getattr(problem, name)
            for name in ("shape", "model", "order", "h", "friction", "steps", "stabilize")
        },
    }


def Report(results):
    """The table of computed and analytical values as text."""
    problem, figures = results.problem, results.figures
    hertz = problem.Hertz(results.states[-1].time)
    radius = Radius(hertz)
    lines = [
        f"Hertz in 3D: {problem.shape}, {problem.model} model, order {problem.order}, "
        f"h = {problem.h:g} mm, {figures['elements_per_radius']:.3g} elements along the contact "
        f"radius, {figures['ndof']} unknowns, {figures['macros']} macro-elements",
        "",
        f"{'':<28}{'computed':>12}{'Hertz':>12}{'ratio':>10}",
    ]
    for name, exact, ratio in (
        ("peak pressure       [MPa]", hertz.peak, figures["p0_ratio"]),
        ("contact radius       [mm]", radius, figures["contact_radius_ratio"]),
        ("force                    ", hertz.force, figures["force_ratio"]),
    ):
        lines += [f"{name:<28}{exact * ratio:>12.4f}{exact:>12.4f}{ratio:>10.5f}"]
    low, high = (radius * r for r in figures["contact_edge_interval"])
    lines += [
        f"first open macro-element begins at {low:.3f} mm, last closed one ends at {high:.3f} mm",
        f"error of the pressure profile, L2 norm   {100 * figures['profile_error']:.2f} %",
    ]
    if figures["oscillation"] is not None:
        lines += [
            f"second differences over the peak: {figures['second_difference']:.4f} "
            f"(exact {figures['second_difference_exact']:.4f}, "
            f"difference {figures['oscillation']:.4f})"
        ]
    counts = " ".join(str(n) for n in figures["newton_iterations"])
    lines += ["", f"Newton iterations {counts}"]
    parts = ", ".join(f"{name} {t:.1f}" for name, t in figures["seconds_per_phase"].items())
    lines += [f"{figures['seconds']:.1f} s without pictures: {parts}"]
    return "\n".join(lines)
