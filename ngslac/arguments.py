"""Arguments as users write them, checked."""

import math

from ngsolve import BND, CoefficientFunction, Region

__all__ = ["BoundaryRegion", "CheckDistinct", "Coefficient"]


def BoundaryRegion(mesh, region, name):
    """The boundary region for a pattern or Region; ValueError if it has no faces."""
    if isinstance(region, str):
        found = mesh.Boundaries(region)
    elif isinstance(region, Region) and region.VB() == BND:
        found = region
    else:
        raise TypeError(f"{name} must be a pattern of boundary names or a boundary region")
    mask = found.Mask()
    if not any(mask[e.index] for e in mesh.Elements(BND)):
        names = ", ".join(dict.fromkeys(mesh.GetBoundaries()))
        raise ValueError(f"{name}={region!r} matches no boundary face; the boundaries are: {names}")
    return found


def Coefficient(value, name):
    """A number, CoefficientFunction or Parameter as CoefficientFunction; None stays None."""
    if value is None or isinstance(value, CoefficientFunction):
        return value
    if not math.isfinite(value) or value < 0:
        raise ValueError(f"{name} = {value} must be a finite number >= 0")
    return CoefficientFunction(float(value))


def CheckDistinct(slave, master):
    """Raise ValueError where the two regions share boundaries."""
    both, names = (slave * master).Mask(), slave.mesh.GetBoundaries()
    shared = [name for name, common in zip(names, both, strict=True) if common]
    if shared:
        raise ValueError(
            f"boundaries {', '.join(shared)} are both slave and master: self-contact needs "
            "finite=True"
        )
