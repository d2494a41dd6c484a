"""Figures of the twisting blocks: torques, balances, symmetry, convergence."""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np

from ._ironing_figures import Quadratic
from ._twistblocks_model import WIDTH

__all__ = ["MEAN_DISTANCE", "Figures", "FrictionTorque", "Report", "SymmetryError"]

# Of the points of a square from its middle, over its width.
MEAN_DISTANCE = (math.sqrt(2) + math.asinh(1)) / 6


def FrictionTorque(table, friction):
    """Torque of the friction on macro-elements that all slip about the z axis.

    Their tractions are friction times pressure, at right angles to the distance from the axis;
    that is taken at the middle of each (N mm for MPa and mm).
    """
    distance = np.linalg.norm(table["x"][:, :2], axis=1)
    return friction * float(table["area"] * table["pressure"] @ distance)


def SymmetryError(table, n):
    """Largest change of the pressures under a quarter turn, relative to the largest of them."""
    number = np.lexsort((table["reference"][:, 0].round(9), table["reference"][:, 1].round(9)))
    pressure = table["pressure"][number].reshape(n, n)
    return float(np.abs(pressure - np.rot90(pressure)).max() / np.abs(pressure).max())


def _Energies(states):
    """Work of the top, strain energy gained and work of friction, from the end of pressing on."""
    work = 0.0
    for before, after in pairwise(states[1:]):
        turn = math.radians(after.angle - before.angle)
        work += 0.5 * (before.top[1] + after.top[1]) * turn
    gained = states[-1].energy - states[1].energy
    return work, gained, sum(state.dissipated for state in states[2:])


def _TangentialTorque(table):
    """Torque of the tangential tractions alone, taken at the middles of the macro-elements.

    The face of the slave is not quite parallel to the plane in each macro-element, and the pressure
    acts along its normal. What is missing to the whole torque vanishes with the mesh size.
    """
    traction, normal = table["traction"], table["normal"]
    tangential = traction - np.sum(traction * normal, axis=1)[:, None] * normal
    return float(table["area"] @ np.cross(table["x"], tangential)[:, 2])


def _DissipationRatio(states):
    """Work of friction over that of the tangential torque in the last step, from its end values.

    In steady slip by the angle h the tractions are those of the chord of the way, h/2 from the
    tangent, and the ratio is tan(h/2) / (h/2).
    """
    if len(states) < 3 or not states[-1].dissipated:
        return None
    turn = math.radians(states[-1].angle - states[-2].angle)
    return states[-1].dissipated / (-_TangentialTorque(states[-1].table) * turn)


def _Balance(state):
    """Errors of the balances: forces and moments on the upper block, and on both."""
    (top, turn), (bottom, back) = state.top, state.bottom
    force, torque = np.linalg.norm(state.force), max(abs(state.torque), 1e-12)
    return {
        "force_upper": float(np.linalg.norm(top + state.force) / force),
        "force_both": float(np.linalg.norm(top + bottom) / force),
        "torque_upper": abs(turn + state.torque) / torque,
        "torque_both": abs(turn + back) / torque,
    }


def Figures(results, seconds):
    """All figures of the run, ready for JSON."""
    problem, states = results.problem, results.states
    turned = [s for s in states if s.angle > 0]
    balances = [_Balance(s) for s in turned]
    punch = [problem.friction * s.force[2] * WIDTH * MEAN_DISTANCE for s in turned]
    friction = [FrictionTorque(s.table, problem.friction) for s in turned]
    torque = [-s.torque for s in turned]
    work = _Energies(states) if len(states) > 2 else (0.0, 0.0, 0.0)
    return {
        "steps": problem.steps,
        "converged_steps": len(turned),
        "cuts": sum(s.cuts for s in states),
        "iterations": [s.iterations for s in states],
        "quadratic_steps": sum(Quadratic(s.residuals) for s in states),
        "residuals": [list(s.residuals) for s in states],
        "angle": [s.angle for s in turned],
        "pressing_force": states[1].force[2] if len(states) > 1 else None,
        "force": [s.force[2] for s in turned],
        "torque": torque,
        "punch_ratio": [t / p if p else None for t, p in zip(torque, punch, strict=True)],
        "friction_ratio": [t / f if f else None for t, f in zip(torque, friction, strict=True)],
        "status": [[int((s.table["status"] == k).sum()) for k in range(3)] for s in turned],
        "balance": {key: max(b[key] for b in balances) for key in balances[0]} if balances else {},
        "sideways": max((float(np.abs(s.force[:2]).max()) for s in turned), default=0.0),
        "symmetry_error": max((SymmetryError(s.table, problem.n) for s in turned), default=0.0),
        "work": work[0],
        "stored": work[1],
        "dissipated": work[2],
        "energy_error": abs(work[0] - work[1] - work[2]) / max(abs(work[0]), 1e-300),
        "tangential_share": [
            _TangentialTorque(s.table) / s.torque if s.torque else None for s in turned
        ],
        "dissipation_ratio": _DissipationRatio(states),
        "failure": results.failure,
        "ndof": len(results.model.solution.vec),
        "n": problem.n,
        "order": problem.order,
        "friction": problem.friction,
        "rigid": problem.rigid,
        "seconds": seconds,
    }


def Report(results):
    """The figures as text."""
    f = results.figures
    lines = [
        f"{f['ndof']} unknowns, {f['converged_steps']} of {f['steps']} steps, {f['cuts']} cuts, "
        f"{sum(f['iterations'])} iterations, quadratic in {f['quadratic_steps']} of "
        f"{len(f['iterations'])} steps; {f['seconds']:.1f} s",
    ]
    if f["converged_steps"] == 0:
        return "\n".join(lines)
    if f["friction"]:
        lines += [
            f"steady torque {f['torque'][-1]:.6f} N mm = {f['punch_ratio'][-1]:.4f} x 0.3826 mu F a"
            f" = {f['friction_ratio'][-1]:.4f} x mu sum(p A r)",
            f"work {f['work']:.5f} N mm, stored {f['stored']:.5f}, friction {f['dissipated']:.5f}: "
            f"error {100 * f['energy_error']:.2f} %",
        ]
    balance = ", ".join(f"{name} {value:.1e}" for name, value in f["balance"].items())
    return "\n".join(
        [*lines, f"errors of the balances: {balance}; symmetry {f['symmetry_error']:.1e}"]
    )
