"""Figures of the indentation: what is measured in a step, and what it is compared with."""

from __future__ import annotations

import math

import numpy as np
from ngsolve import GridFunction

__all__ = ["PRANDTL", "Figures", "Measure", "OnsetPressure", "Report"]

# Mean pressure over yield stress of a flat punch on a rigid plastic body: (2 + pi) Y/sqrt(3).
PRANDTL = (2 + math.pi) / math.sqrt(3)


def OnsetPressure(poisson):
    """Peak pressure over yield stress at which a line contact first yields (von Mises).

    From the stresses of Hertz' solution below the middle of the contact (Johnson 1985, section
    4.2), in plane strain: 1.79 for a Poisson ratio of 0.3.
    """
    z = np.linspace(0, 2, 20001)
    root = np.sqrt(1 + z**2)
    along, normal = -((1 + 2 * z**2) / root - 2 * z), -1 / root
    out = poisson * (along + normal)
    squares = (along - normal) ** 2 + (normal - out) ** 2 + (out - along) ** 2
    return float(1 / np.sqrt(squares / 2).max())


def Measure(results):
    """Depth, force, half width and pressures of the present, committed state.

    The force is that of the whole cylinder per unit of length. The edge of the contact lies in the
    last macro-element under pressure, at the share of it that its pressure has of that before.
    """
    table, problem = results.contact.Table(), results.problem
    order = np.argsort(table["x"][:, 0])
    pressure, area = table["pressure"][order], table["fullarea"][order].copy()
    closed = np.flatnonzero(table["status"][order] > 0)  # rounding leaves pressures on open ones
    if len(closed) > 1 and pressure[closed[-1]] < pressure[closed[-2]]:
        area[closed[-1]] *= pressure[closed[-1]] / pressure[closed[-2]]
    width = float(area[closed].sum())
    force = -2 * float(results.contact.Force()[1])
    material = results.material
    mises = GridFunction(material.points)
    mises.Interpolate(material.Mises(results.strain).Compile(), _Block(results.mesh))
    return {
        "depth": float(results.stepper.load.Get()),
        "force": force,
        "reaction": 2 * Reaction(results),
        "halfwidth": width,
        "mean_pressure": force / (2 * width) if width else 0.0,
        "scaled_width": problem.modulus * width / (problem.yield_stress * problem.radius),
        "peak_pressure": float(pressure.max()),
        "mises": float(mises.vec.FV().NumPy().max()),
        "plastic_strain": float(material.accumulated.vec.FV().NumPy().max()),
        "plastic_volume": material.Integral(material.accumulated),
        "gap": float(table["gap"].min()),
        "closed": len(closed),
    }


def _Block(mesh):
    return mesh.Materials("block")


def Reaction(results):
    """Vertical force of the foundation on the bottom of the block."""
    a, gf = results.solver.a, results.solver.gf
    forces = gf.vec.CreateVector()
    a.Apply(gf.vec, forces)
    space = gf.components[0].space
    lift = GridFunction(space)
    lift.Set((0, 1), definedon=results.mesh.Boundaries("bottom"))
    return float(np.dot(lift.vec.FV().NumPy(), forces.FV().NumPy()[: space.ndof]))


def Figures(results, seconds):
    """All figures of the run, ready for JSON."""
    problem, peak = results.problem, results.loading[-1]
    first = results.unloading[0]
    released = results.unloading[-1]
    again = results.reloading[-1]
    return {
        "onset_pressure": results.onset,
        "onset_pressure_hertz": OnsetPressure(problem.poisson),
        "mean_pressure_ratio": peak["mean_pressure"] / problem.yield_stress,
        "prandtl": PRANDTL,
        "scaled_width": peak["scaled_width"],
        "peak_force": peak["force"],
        "halfwidth": peak["halfwidth"],
        "unloading_slope": (peak["force"] - first["force"]) / (peak["depth"] - first["depth"]),
        "permanent_depth": released["depth"] + released["gap"],
        # A little below: the cylinder's mesh has a point at the origin, too.
        "imprint_depth": -float(results.imprint(results.mesh(0, -1e-5 * problem.h))[1]),
        "released": released["closed"] == 0,
        "reloading_force_ratio": again["force"] / peak["force"],
        "plastic_strain": peak["plastic_strain"],
        "reloading_plastic_ratio": again["plastic_volume"] / peak["plastic_volume"],
        "balance": max(abs(r["reaction"] - r["force"]) for r in results.curve) / peak["force"],
        "last_residuals": results.residuals,
        "steps": len(results.curve),
        "newton_iterations": [row["iterations"] for row in results.curve],
        "newton_max": max(row["iterations"] for row in results.curve),
        "cuts": sum(row["cuts"] for row in results.curve),
        "curve": [[row["depth"], row["force"]] for row in results.curve],
        "ndof": len(results.solver.gf.vec),
        "seconds": seconds,
        "h": problem.h,
    }


def Report(results):
    """The most telling figures as text."""
    f = results.figures
    tail = "  ".join(f"{r:.1e}" for r in f["last_residuals"][-4:])
    return "\n".join(
        (
            f"Indentation: h = {f['h']:g} mm, {f['ndof']} unknowns, {f['steps']} steps",
            f"peak pressure over yield stress at onset  {f['onset_pressure']:.4f}"
            f"   (Hertz {f['onset_pressure_hertz']:.4f})",
            f"mean pressure over yield stress           {f['mean_pressure_ratio']:.4f}"
            f"   (rigid plastic {f['prandtl']:.4f}) at E*a/(YR) = {f['scaled_width']:.1f}",
            f"largest force, half width                 {f['peak_force']:.5g} N/mm, "
            f"{f['halfwidth']:.4g} mm",
            f"depth left: cylinder leaves, at x = 0     {f['permanent_depth']:.5f}, "
            f"{f['imprint_depth']:.5f} mm",
            f"loading again: force, plastic strain      {f['reloading_force_ratio']:.6f}, "
            f"{f['reloading_plastic_ratio']:.6f} of the first time",
            f"reaction against contact force            {f['balance']:.1e}",
            f"residuals of the last loading step        {tail}",
            f"Newton iterations {sum(f['newton_iterations'])} in all, at most {f['newton_max']}; "
            f"{f['cuts']} steps halved; {f['seconds']:.1f} s",
        )
    )
