"""Multipliers against Hertz' pressure, averaged over the same macro-elements."""

from dataclasses import replace

import numpy as np
from scipy.optimize import minimize_scalar

from ngslac.reference import HertzLine

NEAR = 0.25  # times the contact radius: macro-elements that tell the peak pressure


def Radius(hertz):
    """Contact radius of a point contact, half width of a line contact."""
    return hertz.halfwidth if isinstance(hertz, HertzLine) else hertz.contact_radius


def Means(faces, hertz):
    """Hertz' pressure averaged over the macro-elements."""
    if isinstance(hertz, HertzLine):  # the faces are rectangles along y
        x = faces.corners[..., 0]
        return faces.Means(hertz.MeanPressure(x.min(axis=1), x.max(axis=1)))
    return faces.Means(hertz.MeanPressure(faces.corners))


def Shape(faces, hertz, radius):
    """Means of the pressure over its peak, had the force another contact radius."""
    power = 2 if isinstance(hertz, HertzLine) else 3
    wide = replace(hertz, force=hertz.force * (radius / Radius(hertz)) ** power)
    return Means(faces, wide) / wide.peak


def Fit(faces, hertz, pressure):
    """Peak and radius of the Hertz pressure that is nearest in L2 to these means."""
    radius = Radius(hertz)

    def Best(a):
        shape = Shape(faces, hertz, a)
        peak = (faces.area * shape) @ pressure / (faces.area @ shape**2)
        return peak, faces.area @ (pressure - peak * shape) ** 2

    bounds = 0.8 * radius, 1.25 * radius
    found = minimize_scalar(lambda a: Best(a)[1], bounds=bounds, method="bounded")
    return float(Best(found.x)[0]), float(found.x)


def Compare(faces, hertz, pressure):
    """Pressures of the macro-elements against Hertz'.

    ``p0_ratio``: over the macro-elements about the middle; ``p0_ratio_fit`` and
    ``contact_radius_ratio``: of the Hertz pressure with the least distance in L2;
    ``profile_error``: relative, in L2.
    """
    radius, exact = Radius(hertz), Means(faces, hertz)
    area, near = faces.area, faces.extent[:, 0] < NEAR * radius
    peak, fitted = Fit(faces, hertz, pressure)
    return {
        "p0_ratio": float(area[near] @ pressure[near] / (area[near] @ exact[near])),
        "p0_ratio_fit": peak / hertz.peak,
        "contact_radius_ratio": fitted / radius,
        "profile_error": float(np.sqrt(area @ (pressure - exact) ** 2 / (area @ exact**2))),
    }
