"""Twist: a sphere on a block, pressed and then turned about its axis.

Small strains, the same material in both bodies (E = 70 GPa, nu = 0.3), friction 0.3. The upper
side of the half sphere goes down, then turns about the axis through the contact. Slip comes in from
the edge. Computed are the curve of moment and angle, the stick zone and the tractions, to be
compared with the solution of J. L. Lubkin, J. Appl. Mech. 18 (1951). Start it with::

    python tutorials/examples/twist.py --out results

By default a quarter is computed, with conditions of antisymmetry for the twist; ``--model full``
needs no such argument, and four times as many unknowns.
"""

from typing import Literal

import numpy as np
from command import Main, NotNegative, Positive
from lubkin import TwistPoint
from movedsphere import FIRST, Sphere


def Twisted(sphere, force, moment):
    """Lubkin's solution for a normal force and a moment."""
    return TwistPoint(hertz=sphere.Hertz(force), moment=moment, friction=sphere.friction)


def Angles(sphere, force, steps, angle):
    """The angles of the steps, at a normal force; the largest in units of F p0 / (2 G*)."""
    unit = sphere.friction * sphere.Hertz(force).peak / sphere.shear_modulus
    return unit * np.array([FIRST, *angle * np.arange(1, steps + 1) / steps])


def Run(model: Literal["quarter", "full"] = "quarter", elements=6.0, friction: Positive = 0.3,
        nu: NotNegative = 0.3, steps=5, angle=1.5, smooth=False, press=2, out=None):  # fmt: skip
    """Press and turn.

    model : part that is computed
    elements : element edges along the contact radius
    friction : coefficient of friction
    nu : Poisson's ratio
    steps : steps of the tangential load
    angle : largest angle
    smooth : no friction while pressing
    """
    sphere = Sphere(model=model, elements=elements, friction=friction, nu=nu, smooth=smooth,
                    press=press)  # fmt: skip
    pressed = sphere.Press()
    first = sphere.Move("angle", *Angles(sphere, pressed.force[2], steps, angle))[0]
    exact, rows = [], []
    for state in sphere.moved:
        force, turned = state.force[2], state.motion["angle"]
        limit = Twisted(sphere, force, 0.0).limit
        exact.append(Twisted(sphere, force, float(np.clip(state.moment, -limit, limit))))
        at = {"hertz": sphere.Hertz(force), "friction": sphere.friction}
        moment = TwistPoint.FromAngle(angle=turned, **at).moment
        row = {"angle": turned, "moment_ratio": -state.moment / limit}
        row["moment_exact"] = moment / limit

        def Part(part, force=force, limit=limit):
            return Twisted(sphere, force, -part * limit)

        rows.append(row | sphere.Row(state, exact[-1], Part))
    slope = (pressed.moment - first.moment) / first.motion["angle"]
    figures = {
        "stiffness_ratio": slope / Twisted(sphere, first.force[2], 0.0).stiffness,
        "moment_error": max(abs(r["moment_ratio"] / r["moment_exact"] - 1) for r in rows),
    }
    figures |= sphere.Summary(rows)
    columns = ["angle", "moment_ratio", "moment_exact", "stick_ratio", "stick_ratio_fit"]
    sphere.Tell(figures, [*columns, "stick_ratio_exact", "traction_misfit"], "moment_error")
    assert figures["moment_error"] < 0.2 / elements, figures
    assert figures["stick_error"] < 0.4 / elements, figures
    sphere.Show(out, "twist", rows, ("angle", "moment_ratio"), ("angle", "moment_exact"))
    return figures | {"solution": (sphere, exact)}


main = Main(Run)
