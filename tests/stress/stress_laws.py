"""Stress set: laws as expressions of the contact's fields, and bodies of revolution."""

import numpy as np
from ngsolve import IfPos, InnerProduct, Norm, exp
from stress_blocks import Pushed, TwoBlocks
from stress_meshes import Grids
from stress_problem import ForceOf, Problem, Twin, problem

from ngslac import Law


@problem((0.1, False), (0.1, True), (1.0, False), (1.0, True))
def FallingFriction(speed, finite):
    """Friction that falls with the speed of slip, from .5 to .2."""

    def friction(z):
        return 0.2 + 0.3 * exp(-Norm(z.rate) / speed)

    def twin(_, way, step):
        return 0.2 + 0.3 * np.exp(-way / max(step, 1e-300) / speed)

    options = {"law": {"friction": friction}, "twin": Twin(friction=twin), "finite": finite}
    return Pushed(TwoBlocks(21, 0.01), (0.04, -0.05), nonlinear=finite, steps=4, **options)


@problem(0.02, 0.2)
def HardeningFriction(rate):
    """Friction that grows with the pressure."""
    options = {"law": {"friction": lambda z: 0.1 + rate * z.pressure}}
    twin = Twin(friction=lambda pressure, *_: 0.1 + rate * np.maximum(pressure, 0))
    return Pushed(TwoBlocks(22, 0.02), (0.04, -0.06), twin=twin, **options)


def Wear(rate):
    """The law, and its twin, of wear by Archard."""

    def worn(z):
        return z.History("worn", lambda w: w + rate * z.pressure * Norm(z.slip))

    def twin(pressure, way, before):
        return before + rate * np.maximum(pressure, 0) * way

    return {"law": {"offset": worn}, "twin": Twin(offset=twin)}


@problem((1e-3, False), (1e-3, True), (1.0, False), (0.02, True))
def Worn(rate, finite):
    """A block that is dragged and wears: little in a step, or all that is pressed."""
    options = Wear(rate) | {"finite": finite, "nonlinear": finite, "path": [(1, 1), (2, 4)]}

    def motion(t):
        return IfPos(t - 1, 0.1 * (t - 1), 0), -0.04 * IfPos(t - 1, 1, t)

    return Pushed(TwoBlocks(23, 0.005), motion, **options)


@problem(1e-3, 1.0)
def Worn3D(rate):
    """The same in space, under a force."""
    mesh = Grids(
        upper=((0, 0, 0, 1, 1, 0.5), (4, 4, 2)), lower=((-0.2, -0.2, -0.5, 1.4, 1.2, 0), (5, 5, 2))
    )
    p = Problem(mesh, steps=4, **Wear(rate), heldx="upper_top", heldy="upper_top")
    p.Spring("upper_top", lambda t: (0.2 * t, 0.05 * t, 0), 1000)
    return p.Traction("upper_top", lambda _: (0, 0, -1.0))


@problem(1e-3, 0.1, 10.0)
def SoftLayer(give):
    """Surfaces that give under a pressure by far more, or less, than the bodies; a force."""
    options = {"law": {"offset": lambda z: give * z.pressure}}
    twin = Twin(offset=lambda pressure, *_: give * np.maximum(pressure, 0))
    mesh = Grids(upper=((0, 0, 1, 1), (7, 5)), lower=((-0.3, -1, 1.3, 0), (9, 5)))
    p = Problem(mesh, twin=twin, heldx="upper_top", **options)
    return p.Traction("upper_top", (0, -0.5))


@problem((1e3, False), (1e3, True), (1e6, False))
def Coating(stiffness, finite):
    """A pressure by the square of the overlap."""

    def layer(z):
        return -IfPos(z.gap, 0, stiffness * z.gap**2) * z.normal

    def twin(normal, jump, before):
        overlap = np.maximum(np.sum(jump * normal, axis=1), 0)
        return -stiffness * (overlap**2)[:, None] * normal, before

    options = {"law": {"law": Law(layer)}, "twin": Twin(traction=twin), "finite": finite}
    return Pushed(TwoBlocks(24, 0.01), (0.02, -0.05), nonlinear=finite, **options)


@problem((0.02, 20), (0.1, 20), (0.1, 5))
def Peeled(last, steps):
    """A strip that is glued to a block and lifted at one end: the glue tears, in jumps if stiff."""
    first, stiffness = 0.001, 1e3
    mesh = Grids(strip=((0, 0, 3, 0.2), (40, 2), "quad"), base=((-0.2, -0.5, 3.2, 0), (37, 3)))

    def glue(z):
        opening = -InnerProduct(z.jump, z.normal)
        apart = IfPos(opening, opening, 0)
        far = z.History("far", lambda f: IfPos(apart - f, apart, f), start=first)
        whole = IfPos(last - far, first / far * (last - far) / (last - first), 0)
        pressed = (1 - whole) * IfPos(opening, 0, opening) * z.normal
        return -stiffness * (whole * z.jump - pressed)

    def twin(normal, jump, before):
        opening = -np.sum(jump * normal, axis=1)
        far = np.maximum(np.maximum(before, first), opening)
        whole = np.clip(first / far * (last - far) / (last - first), 0, 1)
        pressed = ((1 - whole) * np.minimum(opening, 0))[:, None] * normal
        return -stiffness * (whole[:, None] * jump - pressed), far

    options = {"law": {"law": Law(glue), "tied": True}, "twin": Twin(traction=twin)}
    options |= {"steps": steps, "drive": {"strip_right": (0, 0.4)}}
    return Problem(mesh, {"strip": 1e3, "base": 1e4}, [("strip", "base")], **options)


def Turned(**options):
    """A disc on a wider one, both around the axis."""
    mesh = Grids(upper=((0, 0.01, 1, 0.6), (8, 4)), lower=((0, -1, 1.5, 0), (10, 6), "quad"))
    axis = "upper_left|lower_left"
    return Problem(mesh, axisymmetric=True, heldx=axis, **options)


@problem((0.0, False), (0.4, False), (0.4, True))
def Discs(friction, finite):
    """Pressed by a motion, with friction in the section."""
    p = Turned(friction=friction, finite=finite)
    return p.Spring("upper_top", (0, -0.08), 1000)


@problem(0.0, 0.3)
def DiscUnderForce(friction):
    """Held by contact alone; the force is that on all of the circumference."""
    p = Turned(friction=friction).Traction("upper_top", (0, -1.0))
    return p.Expect("axial force", ForceOf([0], 1), np.pi, 1e-6)


@problem(1e-2, 1.0)
def WornDisc(rate):
    """Dragged in the section: a ring that is pushed outwards, and wears."""
    mesh = Grids(upper=((0.5, 0, 1, 0.4), (7, 4)), lower=((0.2, -0.5, 1.5, 0), (14, 4)))
    options = {"steps": 4, "drive": {"upper_top": (0.02, -0.03)}}
    return Problem(mesh, axisymmetric=True, **options, **Wear(rate))


@problem(0.0, 0.2)
def PressedRing(friction):
    """A ring that is too small for its hub."""
    mesh = Grids(hub=((0.3, 0, 1.01, 1), (6, 8)), ring=((1, 0, 1.6, 1), (5, 7)))
    pairs = [("hub_right", "ring_left")]
    held = {"held": "hub_bottom", "heldy": "ring_bottom"}
    return Problem(mesh, pairs=pairs, friction=friction, axisymmetric=True, **held)
