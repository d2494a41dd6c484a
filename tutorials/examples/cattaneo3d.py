"""Cattaneo and Mindlin in 3D: a sphere on a block, pressed and then pushed sideways.

Small strains, the same material in both bodies (E = 70 GPa, nu = 0.3), friction 0.3; the half y >=
0 is computed. The upper side of the half sphere goes down, then along x until most of the contact
slips, then partly back. Computed are the curve of force and displacement with its hysteresis, the
stick zone and the tractions. Source: Mindlin (1949), Mindlin and Deresiewicz (1953); K. L.
Johnson, Contact Mechanics (1985), sections 7.2 and 7.4. Start it with::

    python tutorials/examples/cattaneo3d.py --out results

Mindlin's solution assumes tractions along the load, although slip also has a component across it
unless nu = 0. Computed tractions turn to the slip: at nu = 0.3 they have a component across of
about a twentieth of friction times the peak pressure (figure "lateral", best seen with ``--smooth
--elements 6``), and hardly a different resultant.
"""

from typing import Literal

import numpy as np
from command import Main, NotNegative, Positive
from movedsphere import FIRST, BulkCompliance, Sphere

from ngslac.reference import CattaneoMindlinPoint


def Partial(sphere, force, shear):
    """Mindlin's solution for a normal and a tangential force."""
    hertz = sphere.Hertz(force)
    return CattaneoMindlinPoint(hertz=hertz, shear=shear, friction=sphere.friction)


def Shifted(sphere, force, shift):
    """Mindlin's solution for a normal force and a displacement."""
    start = {"hertz": sphere.Hertz(force), "friction": sphere.friction}
    return CattaneoMindlinPoint.FromShift(shift=shift, **start)


def Run(model: Literal["half", "full"] = "half", elements=4.0, friction: Positive = 0.3,
        nu: NotNegative = 0.3, steps=5, shear=0.95, reverse: int = 2, smooth=False, press=2,
        out=None):  # fmt: skip
    """Press and push.

    model : part that is computed
    elements : element edges along the contact radius
    friction : coefficient of friction
    nu : Poisson's ratio
    steps : steps of the tangential load
    shear : largest Q/(F P)
    reverse : steps back
    smooth : no friction while pressing
    """
    if shear >= 1:
        raise ValueError(f"shear = {shear} must be less than 1: the sphere would slide")
    if reverse < 0:
        raise ValueError(f"reverse = {reverse} must not be less than 0")
    sphere = Sphere(model=model, elements=elements, friction=friction, nu=nu, smooth=smooth,
                    press=press)  # fmt: skip
    pressed, compliance = sphere.Press(), BulkCompliance(sphere)
    normal, limit = pressed.force[2], friction * pressed.force[2]
    top = Partial(sphere, normal, -shear * limit)
    path = [Partial(sphere, normal, -FIRST * limit)]
    path += [Shifted(sphere, normal, k / steps * top.shift) for k in range(1, steps + 1)]
    path += [top.Reverse(top.shear * (1 - 1.5 * k / reverse)) for k in range(1, reverse + 1)]
    first = sphere.Move("shift", *(-exact.shift - compliance * exact.shear for exact in path))[0]
    exact, rows = [], []
    for number, state in enumerate(sphere.moved):
        loading, (along, _, force) = number < steps, state.force
        exact.append(Partial(sphere, force, along) if loading else exact[steps - 1].Reverse(along))
        hertz, limit = sphere.Hertz(force), friction * force
        half_spaces = state.motion["shift"] + compliance * along
        wanted = Shifted(sphere, force, -half_spaces).shear if loading else None

        def Part(part, force=force, limit=limit):
            return Partial(sphere, force, -part * limit)

        row = {
            "shift": state.motion["shift"],
            "shift_half_spaces": half_spaces,
            "shift_exact": -exact[-1].shift,
            "shear": -along / limit,
            "shear_exact": -wanted / limit if loading else None,
            "lateral": np.abs(state.traction[:, 1]).max() / (friction * hertz.peak),
        }
        rows.append(row | sphere.Row(state, exact[-1], Part if loading else None))
    # Force over displacement before slip, relative to that of half-spaces that stick.
    force, a = pressed.force[0] - first.force[0], sphere.Hertz(first.force[2]).contact_radius
    stiffness = force / (first.motion["shift"] - compliance * force)
    normal = sphere.moved[0].force[2]
    slides = abs(Partial(sphere, normal, friction * normal).shift)
    figures = {
        "stiffness_ratio": stiffness * (2 - sphere.nu) / (4 * sphere.shear_modulus * a),
        "force_error": max(abs(r["shear"] / r["shear_exact"] - 1) for r in rows[:steps]),
        "shift_error": max(abs(r["shift_half_spaces"] - r["shift_exact"]) for r in rows) / slides,
        "compliance": compliance,
    }
    figures |= sphere.Summary(rows)
    columns = ["shift_half_spaces", "shift_exact", "shear", "shear_exact", "stick_ratio"]
    columns += ["stick_ratio_fit", "stick_ratio_exact", "lateral"]
    sphere.Tell(figures, columns, "force_error", "shift_error")
    assert max(figures["force_error"], figures["shift_error"]) < 0.2 / elements, figures
    assert figures["stick_error"] < 0.4 / elements, figures
    curve = ("shift_half_spaces", "shear"), ("shift_exact", "shear")
    sphere.Show(out, "cattaneo3d", rows, *curve)
    return figures | {"solution": (sphere, exact)}


main = Main(Run)
