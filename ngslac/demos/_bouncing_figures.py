"""Figures of the bouncing ring."""

from __future__ import annotations

import numpy as np

__all__ = ["Figures", "Report"]


def Figures(results, seconds):
    """The numbers of the motion."""
    problem, model = results.problem, results.model
    states, table = model.states, model.stepper.Table()
    closed = [k for k, state in enumerate(states) if state.closed]
    before, after = states[closed[0] - 1], states[min(closed[-1] + 1, len(states) - 1)]
    mass = problem.density * model.area
    weight = mass * problem.gravity * (after.time - before.time)
    up = mass * (after.velocity[1] - before.velocity[1]) + weight
    aside = mass * (after.velocity[0] - before.velocity[0])
    mechanical = table["kinetic"] + table["internal"] - table["external"]
    flight = [s for s in states if s.time >= after.time]
    spins = np.array([s.angular_momentum for s in flight])
    inertia = mass * (problem.radius - problem.thickness / 2) ** 2
    return {
        "contact_begin": states[closed[0]].time,
        "contact_end": states[closed[-1]].time,
        "restitution": -after.velocity[1] / before.velocity[1],
        "impulse": [aside, up],
        "friction_ratio": -aside / up,
        "spin": after.angular_momentum / inertia,
        "spin_ratio": after.angular_momentum / (problem.radius * aside) if aside else 0.0,
        "flight_spin_drift": float(np.ptp(spins) / np.abs(spins).max()) if spins.any() else 0.0,
        "flight_speed_drift": float(np.ptp([s.velocity[0] for s in flight])),
        "energy_start": float(0.5 * mass * np.dot(problem.velocity, problem.velocity)),
        "energy_end": model.stepper.balance.total,
        **{k: float(table[k][-1]) for k in ("external", "friction", "impact", "algorithmic")},
        "largest_gain": float(np.diff(mechanical).max()),
        "largest_contact_gain": float(-np.diff(table["friction"] + table["impact"]).min()),
        "steps": len(states) - 1,
        "cuts": sum(step.cuts for step in model.stepper.steps),
        "iterations": max(state.iterations for state in states),
        "unknowns": len(model.gf.vec),
        "seconds": seconds,
    }


def Report(figures):
    """The figures as text."""
    return "\n".join(
        f"{name:20s} {value:.6g}" if isinstance(value, float) else f"{name:20s} {value}"
        for name, value in figures.items()
    )
