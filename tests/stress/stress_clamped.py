"""Stress set: parts that are clamped together; soft between stiff, and hot parts."""

import numpy as np
from ngsolve import CF, Grad, dx
from stress_meshes import Block, Block3D, Grids, Grids3D, Outline, Part, Plate, Sketch
from stress_problem import Problem, problem

PAIRS = [("gasket_bottom", "lower_top"), ("gasket_top", "upper_bottom")]
HELD = {"dirichlet": "lower_bottom"}


def Flanges(thickness=0.1, n=(9, 12, 7)):
    """A thin gasket between two flanges; nothing has a gap."""
    top = thickness + 1
    return Grids(
        Block("lower", (-0.2, -1, 1.2, 0), n[0], 5, quads=True),
        Block("gasket", (0, 0, 1, thickness), n[1], 2),
        Block("upper", (-0.1, thickness, 1.1, top), n[2], 5, quads=True),
    )


@problem((1e-4, 0.15), (1e-4, 0.6), (1e-2, 0.15), (1e-2, 0.6), (1e2, 0.15), (1e2, 0.6), (1e4, 0.15),
         (1e4, 0.6), (1.0, 0.3), (1e-3, 1.5))  # fmt: skip
def Gasket(argument):
    """Pressed and pushed aside by forces within friction, all in proportion to the load."""
    contrast, friction = argument
    p = Problem(Flanges(), PAIRS, {"lower": 1.0, "gasket": contrast, "upper": 1.0},
                flags=HELD, law={"friction": friction})  # fmt: skip
    weak = min(1.0, contrast)
    aside = min(0.03 * friction, 0.02)  # the flange is as tall as it is wide: it must not tip
    p.Traction("upper_top", p.load * weak * CF((aside, -0.1)))
    return p


@problem((1e-4, 0.3, 1), (1e-2, 0.6, 2), (1e2, 0.15, 5), (1e4, 0.3, 1), (1e-2, 1.5, 20))
def GasketDriven(argument):
    """The same, driven by displacements, which slide the upper flange."""
    contrast, friction, steps = argument
    p = Problem(Flanges(), PAIRS, {"lower": 1.0, "gasket": contrast, "upper": 1.0},
                flags={"dirichlet": "lower_bottom|upper_top"}, law={"friction": friction},
                path=[(1.0, steps)])  # fmt: skip
    p.prescribe = {"upper_top": p.load * CF((0.02, -0.01))}
    return p


@problem((0.01, 0.3), (1.0, 0.3), (100.0, 0.6))
def LargeGasket(argument):
    """The same with finite sliding."""
    contrast, friction = argument
    p = Problem(Flanges(0.2), PAIRS, {"lower": 1.0, "gasket": contrast, "upper": 1.0},
                nonlinear=True, flags={"dirichlet": "lower_bottom|upper_top"},
                law={"friction": friction, "finite": True}, path=[(1.0, 2)])  # fmt: skip
    p.prescribe = {"upper_top": p.load * CF((0.03, -0.03))}
    return p


# --- a clamp that holds a gasket between flanges -------------------------------------------------


def Clamp(maxh):
    """A C-shaped clamp around two flanges with a gasket between them."""
    clamp = Outline((30, -30), (75, -30), (75, 33), (30, 33), (30, 23), (65, 23), (65, -20),
                    (30, -20))  # fmt: skip
    return Sketch(
        Part("lower", Plate(0, -20, 60, 0), 5 * maxh, {"top": [(30, 0)], "bottom": [(30, -20)]}),
        Part("upper", Plate(0, 3, 60, 23), 5 * maxh, {"bottom": [(30, 3)], "top": [(30, 23)]}),
        Part("gasket", Plate(10, 0, 50, 3), 1.3 * maxh, {"bottom": [(17, 0)], "top": [(17, 3)]}),
        Part("clamp", clamp, 4.3 * maxh, {"low": [(47, -20)], "high": [(47, 23)],
                                          "back": [(75, 0)]}),
    )  # fmt: skip


CLAMPED = [("gasket_bottom", "lower_top"), ("gasket_top", "upper_bottom"),
           ("clamp_high", "upper_top"), ("clamp_low", "lower_bottom")]  # fmt: skip


@problem((50.0, 0.15, 1, 1.0), (50.0, 0.5, 1, 1.4), (5000.0, 0.15, 1, 1.4), (210e3, 0.15, 1, 1.4),
         (50.0, 0.15, 5, 1.4), (1.0, 0.3, 2, 1.4), (2e6, 0.3, 2, 1.4), (5000.0, 1.5, 1, 1.4),
         (50.0, 0.15, 1, 1.4), (5000.0, 0.6, 2, 1.8))  # fmt: skip
def ShrinkingClamp(argument):
    """The clamp shrinks; friction alone holds flanges and gasket."""
    young, friction, steps, size = argument
    bodies = dict.fromkeys(("lower", "upper", "clamp"), 210e3) | {"gasket": young}
    p = Problem(Clamp(size), CLAMPED, bodies, flags={"dirichlet": "clamp_back"},
                law={"friction": friction}, outlines=False, path=[(1.0, steps)])  # fmt: skip
    # It shrinks along its arms' distance only: the arms do not slide.
    stress = 210e3 / (1 - 0.3**2) * 1e-3 * p.load
    p.a += stress * Grad(p.v)[1, 1] * dx("clamp")
    return p


@problem(0.15, 0.6)
def BoltedPlates(friction):
    """Two plates in a 2D bolt of shape I, which shrinks; the lower one is clamped at its side."""
    bolt = Outline((-2, -2), (2, -2), (2, -1), (0.5, -1), (0.5, 1), (2, 1), (2, 2), (-2, 2),
                   (-2, 1), (-0.5, 1), (-0.5, -1), (-2, -1))  # fmt: skip
    parts = [
        Part("bolt", bolt, 0.4, {"low": [(1.2, -1), (-1.2, -1)], "high": [(1.2, 1), (-1.2, 1)]})
    ]
    pairs, held = [], []
    for side, x0, x1 in (("left", -4, -0.6), ("right", 0.6, 4)):
        far = x0 if side == "left" else x1
        for name, y0, y1 in ((f"{side}lower", -1, 0), (f"{side}upper", 0, 1)):
            middle = (x0 + x1) / 2
            parts.append(Part(name, Plate(x0, y0, x1, y1), 0.37 if y0 else 0.31,
                              {"low": [(middle, y0)], "high": [(middle, y1)],
                               "far": [(far, (y0 + y1) / 2)]}))  # fmt: skip
        pairs.append((f"{side}upper_low", f"{side}lower_high"))
        held.append(f"{side}lower_far")
    pairs += [("bolt_high", "leftupper_high|rightupper_high")]
    pairs += [("bolt_low", "leftlower_low|rightlower_low")]
    bodies = dict.fromkeys([part.name for part in parts], 210e3)
    p = Problem(Sketch(*parts), pairs, bodies, law={"friction": friction}, outlines=False,
                flags={"dirichlet": "|".join(held)})  # fmt: skip
    p.Growth("bolt", -1e-3 * p.load)
    p.Traction("rightupper_far|leftupper_far", p.load * CF((0, 0)))
    return p


# --- hot parts, held by slip ---------------------------------------------------------------------


@problem((2, 0.15, 1), (2, 0.15, 2), (3, 0.15, 2), (4, 0.3, 5), (8, 0.05, 2), (2, 0.6, 20),
         (5, 1.5, 2), (2, 0.15, 2, True), (4, 0.3, 3, True))  # fmt: skip
def HotBar(argument):
    """A bar grows on a plate under pressure: it slips outwards to both sides."""
    n, friction, steps, *finite = argument
    mesh = Grids(Block("bar", (0, 0, 2, 0.3), n, 2, quads=True),
                 Block("plate", (-0.5, -1, 2.5, 0), 11, 4))  # fmt: skip
    p = Problem(mesh, [("bar_bottom", "plate_top")], {"bar": 210e3, "plate": 210e3},
                flags={"dirichlet": "plate_bottom"},
                law={"friction": friction} | ({"finite": True} if finite else {}))  # fmt: skip
    p.Traction("bar_top", p.load * CF((0, -50)))
    p.Growth("bar", 2e-3 * p.load)
    p.path = [(1.0, steps)]
    return p


def Ring(radii=(4.5, 7.0), height=2.0):
    """Maps of a box to a ring around the z axis."""

    def bend(points):
        s, t, h = points.T
        angle, radius = 2 * np.pi * s, radii[0] + (radii[1] - radii[0]) * (1 - t)
        return np.stack([radius * np.cos(angle), radius * np.sin(angle), height * h], axis=1)

    return bend


@problem((10, 0.15, 1, "hex"), (10, 0.15, 2, "hex"), (8, 0.4, 5, "hex"), (12, 0.05, 2, "hex"),
         (10, 0.15, 2, "prism"), (9, 0.3, 2, "tet"))  # fmt: skip
def HotRing(argument):
    """A ring grows on a plate under pressure: it slips outwards everywhere, which holds it."""
    n, friction, steps, kind = argument
    mesh = Grids3D(
        Block3D("ring", (0, 0, 0, 1, 1, 1), (n, 1, 1), kind, Ring(), closed=True),
        Block3D("plate", (-9, -9, -3, 9, 9, 0), (5, 5, 1)),
    )
    p = Problem(mesh, [("ring_bottom", "plate_top")], {"ring": 210e3, "plate": 210e3},
                flags={"dirichlet": "plate_bottom"}, law={"friction": friction})  # fmt: skip
    p.Traction("ring_top", p.load * CF((0, 0, -50)))
    p.Growth("ring", 2e-3 * p.load)
    p.path = [(1.0, steps)]
    return p


@problem((2, 0.15), (3, 0.3), (2, 0.6))
def HotTile3D(argument):
    """A square tile grows on a plate: a few macro-elements slip away from its middle."""
    n, friction = argument
    mesh = Grids3D(
        Block3D("tile", (0, 0, 0, 1, 1, 0.3), (n, n, 1)),
        Block3D("plate", (-0.4, -0.4, -0.5, 1.4, 1.4, 0), (3, 4, 1)),
    )
    p = Problem(mesh, [("tile_bottom", "plate_top")], {"tile": 210e3, "plate": 210e3},
                flags={"dirichlet": "plate_bottom"}, law={"friction": friction})  # fmt: skip
    p.Traction("tile_top", p.load * CF((0, 0, -50)))
    p.Growth("tile", 2e-3 * p.load)
    p.path = [(1.0, 2)]
    return p


@problem(0.1, 0.5)
def ShrunkOn(friction):
    """A ring shrinks on a shaft that has a little play in it, and holds it."""

    def sector(r0, r1):
        def bent(s, t):
            angle, radius = np.pi / 2 * (1 - s), r0 + (r1 - r0) * t
            return radius * np.cos(angle), radius * np.sin(angle)

        return bent

    mesh = Grids(Block("shaft", sector(0.3, 1.0), 8, 4, quads=True),
                 Block("hub", sector(1.002, 1.6), 11, 4, quads=True))  # fmt: skip
    p = Problem(mesh, [("shaft_top", "hub_bottom")], {"shaft": 2e5, "hub": 7e4},
                law={"friction": friction},
                flags={"dirichlety": "shaft_right|hub_right", "dirichletx": "shaft_left|hub_left"},
                )  # fmt: skip
    p.Growth("hub", -8e-3 * p.load)
    p.path = [(1.0, 2)]
    return p
