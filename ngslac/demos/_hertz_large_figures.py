"""Figures of the flattened cylinder: force, energy, half width, comparisons."""

from __future__ import annotations

import numpy as np

from ._hertz_large_model import RADIUS, Approach
from ._ironing_figures import Quadratic

__all__ = ["EnergyError", "Figures", "HertzForce", "Report"]


def HertzForce(approach, young, nu):
    """Hertz' force for an approach: the inverse of `Approach`.

    Parameters
    ----------
    approach : float
        Of the middle to a plate, in mm.
    young, nu : float
        Young's modulus in MPa and Poisson's ratio.

    Examples
    --------
    >>> round(HertzForce(float(Approach(0.01, 1.0, 0.5)), 1.0, 0.5), 9)
    0.01
    """
    low, high = 0.0, young * RADIUS
    for _ in range(80):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if Approach(middle, young, nu) < approach else (low, middle)
    return 0.5 * (low + high)


def EnergyError(approach, force, energy):
    """Work of the force, by Simpson's rule over pairs of equal steps, against the energy.

    The first pair starts at rest, where the force is zero but its slope is not smooth: the work is
    counted from its end on.

    Returns
    -------
    float
        Error of the energy gained relative to the energy gained.
    """
    n = (len(force) - 2) // 2 * 2
    if n < 2:
        return float("nan")
    d, f, w = (np.asarray(values)[-n - 1 :] for values in (approach, force, energy))
    weights = np.ones(n + 1)
    weights[1:-1:2], weights[2:-1:2] = 4, 2
    work = weights @ f * (d[1] - d[0]) / 3
    return float(work / (w[-1] - w[0]) - 1)


def Figures(results, seconds):
    """All figures of the run, ready for JSON."""
    problem, states = results.problem, results.states
    approach, force = [s.approach for s in states], [s.force for s in states]
    energy = [s.energy for s in states]
    even = bool(states) and len(np.unique(np.round(np.diff([0.0, *approach]), 9))) == 1
    return {
        "steps": problem.steps,
        "converged_steps": len(states),
        "cuts": sum(s.cuts for s in states),
        "iterations": [s.iterations for s in states],
        "quadratic_steps": sum(Quadratic(s.residuals) for s in states),
        "approach": approach,
        "force": force,
        "energy": energy,
        "halfwidth": [s.halfwidth for s in states],
        "peak": [s.peak for s in states],
        "hertz": [HertzForce(d, problem.young, problem.nu) for d in approach],
        "energy_error": EnergyError(approach, force, energy) if even else None,
        "failure": results.failure,
        "ndof": len(results.model.solution.vec),
        "h": problem.h,
        "order": problem.order,
        "nu": problem.nu,
        "friction": problem.friction,
        "seconds": seconds,
    }


def Report(results):
    """The figures as text."""
    f = results.figures
    lines = [
        f"{f['ndof']} unknowns, {f['converged_steps']} steps, {f['cuts']} cuts, "
        f"{sum(f['iterations'])} iterations, quadratic in {f['quadratic_steps']} steps; "
        f"{f['seconds']:.1f} s",
        f"{'approach':>9}{'force':>10}{'Hertz':>10}{'half width':>12}   N/mm, mm",
    ]
    count = len(f["force"])
    for k in sorted({0, count // 3, 2 * count // 3, count - 1} if count else ()):
        lines.append(
            f"{f['approach'][k]:9.3f}{f['force'][k]:10.5f}{f['hertz'][k]:10.5f}"
            f"{f['halfwidth'][k]:12.3f}"
        )
    if f["energy_error"] is not None:
        lines.append(f"work of the plates against the strain energy: {f['energy_error']:+.1e}")
    return "\n".join(lines)
