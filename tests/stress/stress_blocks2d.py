"""Stress set in two dimensions: blocks with gaps, friction and far too large steps."""

import numpy as np
from ngsolve import CF, IfPos, sin, x
from stress_meshes import Block, Grids
from stress_problem import Problem, problem

from ngslac import BubbleVectorH1


def Waves(seed, amplitude, waves=4):
    """A random smooth function of arrays or CoefficientFunctions."""
    rng = np.random.default_rng(seed)
    sizes, phases = rng.uniform(-1, 1, waves), rng.uniform(0, 7, waves)
    sizes *= amplitude / np.abs(sizes).sum()

    def wave(s, sine=np.sin):
        terms = enumerate(zip(sizes, phases, strict=True))
        return sum(a * sine(3 * (k + 1) * s + p) for k, (a, p) in terms)

    return wave


def TwoBlocks(seed, amplitude, nx=(9, 7), quads=False, height=1.0):
    """A block with a wavy lower side on a flat, wider one."""
    wave = Waves(seed, amplitude)

    def upper(s, t):
        y = wave(s)
        return s, y + amplitude + t * (height - y)

    return Grids(
        Block("upper", upper, nx[0], 5, quads),
        Block("lower", (-0.3, -1, 1.3, 0), int(1.6 * nx[1]), 5, quads),
    )


CLAMPED = {"dirichlet": "lower_bottom"}
PAIR = [("upper_bottom", "lower_top")]


@problem((1, 0.0), (2, 0.3), (3, 0.7), (4, 1.5))
def RandomGap(argument):
    """A block pressed on a rigid wavy plane in one step, and sheared."""
    seed, friction = argument
    mesh = Grids(Block("block", (0, 0, 1, 0.6), 12, 5))
    gap = Waves(seed, 0.03)(x, sin) + 0.01
    p = Problem(mesh, [("block_bottom", gap)], {"block": 100.0}, law={"friction": friction})
    p.Spring("block_top", p.load * CF((0.03, -0.06)), 500)
    return p


@problem((1, 0.0), (2, 0.2), (3, 0.8), (4, 1.5), (5, 0.5), (6, 1.0))
def RandomSurface(argument):
    """Two blocks with random gaps, pressed and pushed aside in one step."""
    seed, friction = argument
    mesh = TwoBlocks(seed, 0.02, quads=seed % 2 == 0)
    p = Problem(mesh, PAIR, {"upper": 100.0, "lower": 60.0}, flags=CLAMPED,
                law={"friction": friction})  # fmt: skip
    p.Spring("upper_top", p.load * CF((0.04, -0.06 + 0.03 * (x - 0.5))), 1000)
    return p


@problem(1, 2, 3)
def BadStart(seed):
    """A random start vector of displacements and tractions."""
    mesh = TwoBlocks(seed, 0.02)
    p = Problem(mesh, PAIR, {"upper": 100.0, "lower": 100.0}, flags=CLAMPED, law={"friction": 0.4})
    p.Spring("upper_top", p.load * CF((0.02, -0.06)), 1000)
    values, free = p.gf.vec.FV().NumPy(), p.X.FreeDofs()
    values[:] = np.random.default_rng(seed).normal(size=len(values)) * [bool(b) for b in free]
    values[: p.X.components[0].ndof] *= 0.1
    values[p.X.components[0].ndof :] *= 30
    return p


@problem(0.0, 0.5)
def Plate(friction):
    """A thin plate pressed into a valley: contact begins at its ends."""

    def valley(s, t):
        px = -0.2 + 1.4 * s
        top = 0.3 * (px - 0.5) ** 2 - 0.075
        return px, -0.5 + t * (top + 0.5)

    mesh = Grids(Block("plate", (0, 0, 1, 0.02), 30, 1, quads=True), Block("valley", valley, 17, 4))
    p = Problem(mesh, [("plate_bottom", "valley_top")], {"plate": 1000.0, "valley": 1000.0},
                flags={"dirichlet": "valley_bottom"}, law={"friction": friction})  # fmt: skip
    p.Spring("plate_top", CF((0, 0)), 1e-3)
    p.Traction("plate_top", p.load * CF((0, -0.3)))
    return p


@problem(0.0, 0.6)
def Cantilever(friction):
    """A slender beam bent on a support in its middle and pulled beyond it."""
    mesh = Grids(
        Block("beam", (0, 0, 2, 0.1), 24, 2), Block("support", (1.2, -0.6, 1.7, -0.02), 7, 6)
    )
    p = Problem(mesh, [("support_top", "beam_bottom")], {"beam": 1000.0, "support": 1000.0},
                flags={"dirichlet": "beam_left|support_bottom"}, law={"friction": friction},
                nonlinear=False)  # fmt: skip
    p.Traction("beam_right", p.load * CF((0, -1.0)))
    return p


@problem((20, 5), (4, 24), (3, 40))
def Meshes(n):
    """A fine against a coarse mesh, and the reverse."""
    mesh = TwoBlocks(11, 0.01, nx=n)
    p = Problem(mesh, PAIR, {"upper": 100.0, "lower": 100.0}, flags=CLAMPED, law={"friction": 0.5})
    p.Spring("upper_top", p.load * CF((0.03, -0.05)), 1000)
    return p


@problem((1e6, 1.0), (1.0, 1e6), (1e11, 2e11))
def Stiffness(young):
    """Soft on stiff, stiff on soft, and Pascal as unit."""
    mesh = TwoBlocks(12, 0.02)
    p = Problem(mesh, PAIR, {"upper": young[0], "lower": young[1]}, flags=CLAMPED,
                law={"friction": 0.4})  # fmt: skip
    p.Spring("upper_top", p.load * CF((0.02, -0.05)), 10 * min(young))
    return p


@problem()
def SlipWave():
    """A pressed strip is pulled at one end: slip runs along it until all of it slides."""
    mesh = Grids(
        Block("strip", (0, 0, 3, 0.2), 40, 2, quads=True),
        Block("base", (-0.2, -0.5, 3.2, 0), 37, 3),
    )
    p = Problem(mesh, [("strip_bottom", "base_top")], {"strip": 100.0, "base": 1e4},
                flags={"dirichlet": "base_bottom"}, law={"friction": 0.4})  # fmt: skip
    p.Traction("strip_top", CF((0, -1)))
    p.Spring("strip_right", CF((p.load * 0.05, 0)), 1000)
    p.path = [(1.0, 3)]
    return p


@problem(0.3, 1.0)
def Cyclic(friction):
    """Shear to and fro, with changing pressure."""
    mesh = TwoBlocks(13, 0.005)
    p = Problem(mesh, PAIR, {"upper": 100.0, "lower": 100.0}, flags=CLAMPED,
                law={"friction": friction})  # fmt: skip
    t = p.load
    p.Spring("upper_top", CF((0.05 * sin(6.283 * t), -0.03 * IfPos(t - 0.25, 1, 4 * t))), 1000)
    p.path = [(2.0, 8)]
    return p


@problem(0.0, 0.8)
def PressAndLift(friction):
    """Pressed in one step, lifted beyond the first gap in one step, pressed again."""
    mesh = TwoBlocks(14, 0.02)
    p = Problem(mesh, PAIR, {"upper": 100.0, "lower": 100.0}, flags=CLAMPED,
                law={"friction": friction})  # fmt: skip
    p.Spring("upper_top", p.load * CF((0.02, -0.05)), 1000)
    p.path = [(1.0, 1), (-1.0, 1), (1.0, 1)]
    return p


@problem(0.0, 0.5)
def Rubber(friction):
    """Nearly incompressible neo-Hooke, compressed in one step."""
    mesh = TwoBlocks(15, 0.01, nx=(6, 7), quads=True)
    p = Problem(mesh, PAIR, {"upper": 1.0, "lower": 1000.0}, nu=0.49, nonlinear=True,
                flags=CLAMPED, law={"friction": friction}, order=3)  # fmt: skip
    p.Spring("upper_top", p.load * CF((0.0, -0.06)), 100)
    return p


@problem()
def Penetration():
    """The bodies overlap at the start; there is no other load."""
    mesh = Grids(Block("upper", (0, -0.05, 1, 1), 8, 6), Block("lower", (-0.3, -1, 1.3, 0), 9, 6))
    p = Problem(mesh, PAIR, {"upper": 100.0, "lower": 50.0}, law={"friction": 0.3},
                flags={"dirichlet": "lower_bottom|upper_top"})  # fmt: skip
    return p


@problem()
def Sandwich():
    """Three blocks, two contacts, the one in the middle held by them alone."""
    mesh = Grids(
        Block("upper", (0, 0.5, 1, 1), 8, 4),
        Block("middle", (-0.1, 0, 1.1, 0.49), 7, 4),
        Block("lower", (-0.3, -0.5, 1.3, -0.01), 9, 4),
    )
    pairs = [("upper_bottom", "middle_top"), ("middle_bottom", "lower_top")]
    p = Problem(mesh, pairs, {"upper": 100.0, "middle": 30.0, "lower": 100.0},
                flags=CLAMPED, law={"friction": 0.5})  # fmt: skip
    p.Spring("upper_top", p.load * CF((0.02, -0.06)), 1000)
    return p


@problem()
def Slab():
    """Greco's slab: friction 1, Pascal and metres, opening, slip and stick in one step."""
    mesh = Grids(Block("slab", (0, 0, 0.04, 0.04), 24, 8))
    p = Problem(mesh, [("slab_bottom", CF(0.0))], {"slab": 1.3e11}, nu=0.2,
                flags={"dirichletx": "slab_right"}, law={"friction": 1.0})  # fmt: skip
    p.Traction("slab_top", p.load * CF((0, -5e7)))
    p.Traction("slab_left", p.load * CF((15e7, 0)))
    return p


@problem()
def Wedge():
    """A wedge pressed between two inclined walls with friction, which may jam."""

    def wedge(s, t):
        return (s - 0.5) * (0.4 + 0.6 * t), t

    mesh = Grids(Block("wedge", wedge, 6, 10))
    p = Problem(mesh, [("wedge_left", CF(0.0)), ("wedge_right", CF(0.01))], {"wedge": 100.0},
                law={"friction": 0.3})  # fmt: skip
    p.Traction("wedge_top", p.load * CF((0.5, -5)))
    p.path = [(1.0, 1), (0.1, 1), (1.0, 1)]
    return p


@problem("bubble", "condense", "p3")
def Spaces(kind):
    """Other displacement spaces."""
    mesh = TwoBlocks(16, 0.02, nx=(7, 6), quads=kind == "condense")
    space = {"space": BubbleVectorH1, "order": 1} if kind == "bubble" else {}
    p = Problem(mesh, PAIR, {"upper": 100.0, "lower": 100.0}, flags=CLAMPED,
                law={"friction": 0.6}, **{"order": 3} | space,
                condense=kind == "condense")  # fmt: skip
    p.Spring("upper_top", p.load * CF((0.04, -0.05)), 1000)
    return p


@problem((21, 0.3), (22, 0.9))
def Rough(argument):
    """A random sawtooth of sixty slave faces on a coarse block: contact at many separate spots."""
    seed, friction = argument
    heights = np.random.default_rng(seed).uniform(0, 0.004, 61)

    def upper(s, t):
        bottom = np.interp(s, np.linspace(0, 1, 61), heights)
        return s, bottom + t * (0.5 - bottom)

    mesh = Grids(
        Block("upper", upper, 60, 5, quads=True), Block("lower", (-0.2, -0.5, 1.2, 0), 23, 6)
    )
    p = Problem(mesh, PAIR, {"upper": 100.0, "lower": 100.0}, flags=CLAMPED,
                law={"friction": friction})  # fmt: skip
    p.Spring("upper_top", p.load * CF((0.006, -0.012)), 1000)
    return p


@problem(0.4, 1.2)
def Neo(friction):
    """Neo-Hooke bodies; Dirichlet values press and shear by a multiple of the mesh size at once."""
    mesh = TwoBlocks(23, 0.01, nx=(10, 9))
    flags = {"dirichlet": "lower_bottom|upper_top"}
    p = Problem(mesh, PAIR, {"upper": 10.0, "lower": 100.0}, nonlinear=True, flags=flags,
                law={"friction": friction})  # fmt: skip
    p.prescribe = {"upper_top": p.load * CF((0.25, -0.15))}
    return p
