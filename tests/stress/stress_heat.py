"""Stress set: heat through contact, by pressure and gap, of friction, with bodies that grow."""

import numpy as np
from ngsolve import CF, IfPos, exp, sin, x
from stress_blocks import TwoBlocks
from stress_meshes import Grids
from stress_problem import Heat, Problem, Twin, problem


def ByPressure(scale, least=0.0):
    """A conductance that grows with the pressure."""
    return {
        "flow": lambda z, T: (least + scale * z.pressure) * (z.Slave(T) - z.Master(T)),
        "twin": lambda p, _, one, other: (least + scale * np.maximum(p, 0)) * (one - other),
    }


def Pressed(heat, mesh=None, motion=(0.01, -0.04), **options):
    """A warm block on a cold one; the motion is that of its top."""
    options = {"drive": {"upper_top": motion}} | options
    return Problem(mesh or TwoBlocks(31, 0.01), heat=Heat(**({"hot": 1.0} | heat)), **options)


@problem((0.0, False), (0.4, False), (0.4, True), (1.2, True))
def WarmBlock(friction, finite):
    """It grows by its own size over ten, and conducts the better the more it is pressed."""
    heat = ByPressure(0.1) | {"expansion": 0.03}
    return Pressed(heat, friction=friction, finite=finite, nonlinear=False)


@problem((1e-3, 0.0), (10.0, 0.3), (1e4, 0.0))
def Resistance(scale, friction):
    """From next to none to next to perfect conductance."""
    return Pressed(ByPressure(scale, 1e-6) | {"expansion": 0.02}, friction=friction)


@problem(False, True)
def GrowsOverAGap(finite):
    """A block whose heat closes the gap through which it gets out."""
    mesh = Grids(upper=((0, 0.01, 1, 1), (7, 6)), lower=((-0.3, -1, 1.3, 0), (11, 5)))
    heat = ByPressure(0.05, 0.1) | {"expansion": 0.05}
    return Pressed(heat, mesh, (0, 0), finite=finite, nonlinear=False)


@problem((0.3, False), (0.3, True), (0.8, True))
def Rubbing(friction, finite):
    """Friction heats the surfaces, and gets less by that."""
    law = {"friction": lambda z, T: friction * exp(-z.Slave(T) - z.Master(T))}
    heat = ByPressure(1.0) | {"rubs": True, "expansion": 0.01, "hot": 0.0}
    heat |= {"friction": lambda one, other: friction * np.exp(-one - other)}
    path = [(1, 1), (2, 3)]

    def motion(t):
        return IfPos(t - 1, 0.15 * (t - 1), 0), -0.04 * IfPos(t - 1, 1, t)

    p = Pressed(heat, motion=motion, law=law, path=path, finite=finite, nonlinear=finite)
    p.twin = Twin(friction=lambda *_: p.contacts[0].Table()["friction"])  # checked by `Heat`
    return p


@problem(0.02, 0.5)
def OverTheGap(length):
    """Heat that crosses the gap of a wavy surface which is not pressed flat."""
    heat = {
        "flow": lambda z, T: exp(-z.gap / length) * (z.Slave(T) - z.Master(T)),
        "twin": lambda _, gap, one, other: np.exp(-gap / length) * (one - other),
    }
    return Pressed(heat | {"expansion": 0.01}, TwoBlocks(32, 0.04), (0, -0.03), friction=0.3)


@problem((0.3, False), (0.3, True))
def InSpace(friction, finite):
    """Blocks in space, pressed and pushed aside."""
    mesh = Grids(
        upper=((0, 0, 0, 1, 1, 0.5), (4, 4, 2)), lower=((-0.2, -0.2, -0.5, 1.4, 1.2, 0), (5, 5, 2))
    )
    heat = ByPressure(0.3) | {"rubs": True, "expansion": 0.01}
    return Pressed(heat, mesh, (0.06, 0.02, -0.03), friction=friction, finite=finite, steps=2)


@problem(0.0, 0.4)
def WarmDisc(friction):
    """Around the axis, under a force; friction in the section heats it."""
    mesh = Grids(upper=((0, 0, 1, 0.6), (8, 4)), lower=((0, -1, 1.5, 0), (10, 6), "quad"))
    heat = Heat(**ByPressure(0.5), expansion=0.02, hot=1.0, rubs=True)
    p = Problem(
        mesh, axisymmetric=True, heldx="upper_left|lower_left", heat=heat, friction=friction
    )
    return p.Traction("upper_top", (0, -1.0))


@problem(False, True)
def LooseWarmBlock(finite):
    """Held by friction alone, under a force, and warm."""
    mesh = Grids(upper=((0, 0, 1, 0.6), (7, 5)), lower=((-0.3, -1, 1.3, 0), (9, 5)))
    heat = Heat(**ByPressure(0.5, 0.01), expansion=0.005, hot=1.0)
    p = Problem(mesh, heat=heat, friction=0.5, finite=finite, nonlinear=False)
    return p.Traction("upper_top", CF((0.05 + 0.02 * sin(3 * x), -0.6)))
