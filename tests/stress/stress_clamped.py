"""Stress set: parts that are clamped together; soft between stiff, and hot parts."""

import numpy as np
from ngsolve import CF, Grad, dx
from stress_meshes import Grids, Outline, Part, Plate, Polar, Sketch
from stress_problem import Problem, problem

PAIRS = [("gasket", "lower"), ("gasket_top", "upper_bottom")]


def Flanges(contrast, friction, thickness=0.1, **options):
    """A thin gasket between two flanges; nothing has a gap."""
    top = thickness + 1
    mesh = Grids(
        lower=((-0.2, -1, 1.2, 0), (9, 5), "quad"),
        gasket=((0, 0, 1, thickness), (12, 2)),
        upper=((-0.1, thickness, 1.1, top), (7, 5), "quad"),
    )
    young = {"lower": 1.0, "gasket": contrast, "upper": 1.0}
    return Problem(mesh, young, PAIRS, friction, **options)


@problem((1e-4, 0.15), (1e-4, 0.6), (1e-2, 0.15), (1e-2, 0.6), (1e2, 0.15), (1e2, 0.6), (1e4, 0.15),
         (1e4, 0.6), (1.0, 0.3), (1e-3, 1.5))  # fmt: skip
def Gasket(contrast, friction):
    """Pressed and pushed aside by forces within friction, all in proportion to the load."""
    weak = min(1.0, contrast)
    aside = min(0.03 * friction, 0.02)  # the flange is as tall as it is wide: it must not tip
    p = Flanges(contrast, friction)
    return p.Traction("upper_top", p.load * weak * CF((aside, -0.1)))


@problem((1e-4, 0.3, 1), (1e-2, 0.6, 2), (1e2, 0.15, 5), (1e4, 0.3, 1), (1e-2, 1.5, 20))
def GasketDriven(contrast, friction, steps):
    """The same, driven by displacements, which slide the upper flange."""
    return Flanges(contrast, friction, steps=steps, drive={"upper_top": (0.02, -0.01)})


@problem((0.01, 0.3), (1.0, 0.3), (100.0, 0.6))
def LargeGasket(contrast, friction):
    """The same with finite sliding."""
    options = {"finite": True, "drive": {"upper_top": (0.03, -0.03)}, "steps": 2}
    return Flanges(contrast, friction, 0.2, **options)


# --- a clamp that holds a gasket between flanges -------------------------------------------------


def Clamp(maxh):
    """A C-shaped clamp around two flanges with a gasket between them."""
    clamp = Outline((30, -30), (75, -30), (75, 33), (30, 33), (30, 23), (65, 23), (65, -20),
                    (30, -20))  # fmt: skip
    sides = {"low": [(47, -20)], "high": [(47, 23)], "back": [(75, 0)]}
    return Sketch(
        Part("lower", Plate(0, -20, 60, 0), 5 * maxh, {"top": [(30, 0)], "bottom": [(30, -20)]}),
        Part("upper", Plate(0, 3, 60, 23), 5 * maxh, {"bottom": [(30, 3)], "top": [(30, 23)]}),
        Part("gasket", Plate(10, 0, 50, 3), 1.3 * maxh, {"bottom": [(17, 0)], "top": [(17, 3)]}),
        Part("clamp", clamp, 4.3 * maxh, sides),
    )


@problem((50.0, 0.15, 1, 1.0), (50.0, 0.5, 1, 1.4), (5000.0, 0.15, 1, 1.4), (210e3, 0.15, 1, 1.4),
         (50.0, 0.15, 5, 1.4), (1.0, 0.3, 2, 1.4), (2e6, 0.3, 2, 1.4), (5000.0, 1.5, 1, 1.4),
         (50.0, 0.15, 1, 1.4), (5000.0, 0.6, 2, 1.8))  # fmt: skip
def ShrinkingClamp(young, friction, steps, size):
    """The clamp shrinks; friction alone holds flanges and gasket."""
    bodies = dict.fromkeys(("lower", "upper", "clamp"), 210e3) | {"gasket": young}
    pairs = [*PAIRS, ("clamp_high", "upper_top"), ("clamp_low", "lower_bottom")]
    p = Problem(Clamp(size), bodies, pairs, friction, held="clamp_back", steps=steps)
    # It shrinks along its arms' distance only: the arms do not slide.
    stress = 210e3 / (1 - 0.3**2) * 1e-3 * p.load
    p.a += stress * Grad(p.v)[1, 1] * dx("clamp")
    return p


@problem(0.15, 0.6)
def BoltedPlates(friction):
    """Two plates in a 2D bolt of shape I, which shrinks; the lower one is clamped at its side."""
    bolt = Outline((-2, -2), (2, -2), (2, -1), (0.5, -1), (0.5, 1), (2, 1), (2, 2), (-2, 2),
                   (-2, 1), (-0.5, 1), (-0.5, -1), (-2, -1))  # fmt: skip
    sides = {"low": [(1.2, -1), (-1.2, -1)], "high": [(1.2, 1), (-1.2, 1)]}
    parts, pairs = [Part("bolt", bolt, 0.4, sides)], []
    for side, x0, x1, far in (("left", -4, -0.6, -4), ("right", 0.6, 4, 4)):
        middle = (x0 + x1) / 2
        for name, y0, y1, maxh in (("lower", -1, 0, 0.37), ("upper", 0, 1, 0.31)):
            sides = {"low": [(middle, y0)], "high": [(middle, y1)], "far": [(far, (y0 + y1) / 2)]}
            parts.append(Part(side + name, Plate(x0, y0, x1, y1), maxh, sides))
        pairs.append((f"{side}upper_low", f"{side}lower_high"))
    pairs += [("bolt_high", "leftupper_high|rightupper_high")]
    pairs += [("bolt_low", "leftlower_low|rightlower_low")]
    p = Problem(Sketch(*parts), 210e3, pairs, friction, held="leftlower_far|rightlower_far")
    return p.Growth("bolt", -1e-3).Traction("rightupper_far|leftupper_far", (0, 0))


# --- hot parts, held by slip ---------------------------------------------------------------------


def Hot(mesh, body, friction, steps, finite=False):
    """A body is pressed on a plate and grows."""
    options = {"nonlinear": False, "held": "plate_bottom", "steps": steps}
    p = Problem(mesh, 210e3, [(body, "plate")], friction, finite, **options)
    p.Traction(f"{body}_top", (0,) * (mesh.dim - 1) + (-50,))
    return p.Growth(body, 2e-3)


@problem((2, 0.15, 1), (2, 0.15, 2), (3, 0.15, 2), (4, 0.3, 5), (8, 0.05, 2), (2, 0.6, 20),
         (5, 1.5, 2), (2, 0.15, 2, True), (4, 0.3, 3, True))  # fmt: skip
def HotBar(n, friction, steps, finite=False):
    """A bar grows on a plate under pressure: it slips outwards to both sides."""
    mesh = Grids(bar=((0, 0, 2, 0.3), (n, 2), "quad"), plate=((-0.5, -1, 2.5, 0), (11, 4)))
    return Hot(mesh, "bar", friction, steps, finite)


def Ring(points):
    """The unit cube as a ring around the z axis."""
    s, t, h = points.T
    angle, radius = 2 * np.pi * s, 4.5 + (7.0 - 4.5) * (1 - t)
    return np.stack([radius * np.cos(angle), radius * np.sin(angle), 2.0 * h], axis=1)


@problem((10, 0.15, 1, "hex"), (10, 0.15, 2, "hex"), (8, 0.4, 5, "hex"), (12, 0.05, 2, "hex"),
         (10, 0.15, 2, "prism"), (9, 0.3, 2, "tet"))  # fmt: skip
def HotRing(n, friction, steps, kind):
    """A ring grows on a plate under pressure: it slips outwards everywhere, which holds it."""
    ring = ((0, 0, 0, 1, 1, 1), (n, 1, 1), kind, Ring, True)
    mesh = Grids(ring=ring, plate=((-9, -9, -3, 9, 9, 0), (5, 5, 1)))
    return Hot(mesh, "ring", friction, steps)


@problem((2, 0.15), (3, 0.3), (2, 0.6))
def HotTile3D(n, friction):
    """A square tile grows on a plate: a few macro-elements slip away from its middle."""
    plate = ((-0.4, -0.4, -0.5, 1.4, 1.4, 0), (3, 4, 1))
    return Hot(Grids(tile=((0, 0, 0, 1, 1, 0.3), (n, n, 1)), plate=plate), "tile", friction, 2)


@problem(0.1, 0.5)
def ShrunkOn(friction):
    """A ring shrinks on a shaft that has a little play in it, and holds it."""

    def sector(r0, r1):
        return lambda s, t: Polar(np.pi / 2 * (1 - s), r0 + (r1 - r0) * t)

    hub = (sector(1.002, 1.6), (11, 4), "quad")
    mesh = Grids(shaft=(sector(0.3, 1.0), (8, 4), "quad"), hub=hub)
    sides = {"heldx": "shaft_left|hub_left", "heldy": "shaft_right|hub_right"}
    pairs = [("shaft_top", "hub_bottom")]
    p = Problem(mesh, {"shaft": 2e5, "hub": 7e4}, pairs, friction, steps=2, **sides)
    return p.Growth("hub", -8e-3)
