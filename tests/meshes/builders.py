"""Meshes of the builders with the exact sizes of their bodies and boundaries."""

from functools import cache
from math import asin, cos, hypot, pi, radians, sin, sqrt, tan
from unittest.mock import ANY

import pytest
from heateddisc import DiscInRing

from ngslac import meshes
from ngslac.meshes.boxes import KINDS

FLAGS = ("", "quads", "structured", "structured quads", "curved")
KINDS2D = [dict.fromkeys(names.split(), True) for names in FLAGS]


def Sizes(rel=1e-12, factor=1, **sizes):
    return {name: pytest.approx(factor * size, rel=rel) for name, size in sizes.items()}


def Hertz(half):
    n = 1 if half else 2
    sizes = Sizes(1e-12, n, block=20000, master=16, top=84, bottom=100, side=200)
    sizes |= Sizes(1e-8, n, slave=15) | Sizes(2e-5, n, cylinder=pi * 1250, arc=50 * pi - 15)
    return sizes | (Sizes(sym=300) if half else {})


def Blocks(rise, turn=None, rounding=1e-12):
    """Sizes of unit blocks; the interface rises by `rise` along x, in 3D turned by an angle."""
    along = {"left": rise / 2, "right": -rise / 2}
    if turn is not None:
        along = {side: cos(radians(turn)) * dz for side, dz in along.items()}
        along["front"] = sin(radians(turn)) * rise / 2
        along["back"] = -along["front"]
    sides = {
        f"{s}_{b}": 1 + n * dz for b, n in (("upper", 1), ("lower", -1)) for s, dz in along.items()
    }
    contact = dict.fromkeys(("slave", "master"), hypot(1, rise))
    return Sizes(top=1, bottom=1, **contact, **sides) | Sizes(rounding, upper=1, lower=1)


MODELS = {"quarter": (1, {"sym_x": 1, "sym_y": 1}), "half": (2, {"sym_y": 2}), "full": (4, {})}


def Zone(radius, zone):
    """Areas of a quarter of a spherical cap, and of the rest of the half sphere."""
    rest = sqrt(radius**2 - zone**2)
    return pi / 2 * radius * (radius - rest), pi / 2 * radius * rest


def Ball(model):
    n, planes = MODELS[model]
    (slave, cap), master = Zone(50, 6), pi * 6.4**2 / 4
    sizes = Sizes(1e-12, n, block=1e6, bottom=1e4, side=2e4)
    sizes |= Sizes(1e-4, n, slave=slave, master=master, surface=1e4 - master)
    sizes |= Sizes(1e-2, n, sphere=pi * 50**3 / 6, top=pi * 625, cap=cap)
    return sizes | Sizes(1e-2, 1e4 + pi * 625, **planes)


def Balls(model):
    n, planes = MODELS[model]
    (slave, upper), (master, lower) = Zone(50, 13), Zone(80, 13 * 16 / 15)
    sizes = Sizes(1e-3, n, slave=slave, master=master)
    sizes |= Sizes(1e-2, n, upper=pi * 50**3 / 6, lower=pi * 80**3 / 6, top=pi * 625)
    sizes |= Sizes(1e-2, n, cap_upper=upper, cap_lower=lower, bottom=pi * 1600)
    return sizes | Sizes(1e-2, pi / 4 * 8900, **planes)


def Slice(model):
    n, arc = (1 if model == "quarter" else 2), 50 * asin(3.3 / 50)
    sizes = Sizes(1e-12, n, block=1e4, master=3.52, surface=96.48, top=50, bottom=100, side=100)
    sizes |= Sizes(1e-3, n, slave=arc) | Sizes(0.03, n, cylinder=pi * 625, cap=25 * pi - arc)
    sizes |= Sizes(0.03, n, sym_y=2 * (1e4 + pi * 625))
    return sizes | (Sizes(sym_x=150) if model == "quarter" else {})


RING = Sizes(symx=98, symy=98) | Sizes(1e-5, disc=pi * 625, ring=pi / 4 * (100**2 - 52**2))
RING |= Sizes(1e-5, slave=25 * pi, master=26 * pi, outer=50 * pi)
RISES = {"flat": 0.0, "oblique": tan(radians(15))}

CASES = {  # function, its arguments, sizes of materials and boundaries
    "ring": (DiscInRing, {"h": 4.0, "clearance": 2.0}, RING),
}
for half in (0, 1):
    CASES[f"hertz {half}"] = meshes.HertzMesh, {"h": 1.0, "half": half}, Hertz(half)
for shape, rise in RISES.items():
    given = {"shape": shape, "slope": 15}
    for kind in KINDS2D:
        sizes = Blocks(rise) | ({"arc": ANY} if "curved" in kind else {})
        CASES[f"{shape} {kind}"] = meshes.TwoBlocks, given | kind, sizes
    for kind in KINDS:
        sizes = Blocks(rise, 30, 3e-10 if kind == "pyramid" else 1e-12)
        options = given | {"kind_upper": kind, "perturb": 0.2}
        CASES[f"{shape} {kind}"] = meshes.TwoBlocks3D, options, sizes
for model in MODELS:
    given, two = {"model": model, "h": 1.5}, {"h": 2.5, "radius_lower": 80, "zone": 13}
    CASES[f"ball {model}"] = meshes.SphereOnBlock, given | {"zone": 6}, Ball(model)
    CASES[f"balls {model}"] = meshes.TwoSpheres, given | two, Balls(model)
    if model != "half":
        options = given | {"h": 1.0, "zone": 3.3}
        CASES[f"slice {model}"] = meshes.CylinderOnBlock, options, Slice(model)


@cache
def MeshOf(name):
    make, arguments, _ = CASES[name]
    return make(**arguments)
