"""Stress set: blocks with gaps, friction and far too large steps, in two and three dimensions."""

import numpy as np
from ngsolve import CF, IfPos, cos, sin, x, y
from stress_meshes import Grids
from stress_problem import GROUND, Problem, problem


def Waves(seed, amplitude, waves=4):
    """A random smooth function of arrays or CoefficientFunctions."""
    rng = np.random.default_rng(seed)
    sizes, phases = rng.uniform(-1, 1, waves), rng.uniform(0, 7, waves)
    sizes *= amplitude / np.abs(sizes).sum()

    def wave(s, sine=np.sin):
        terms = enumerate(zip(sizes, phases, strict=True))
        return sum(a * sine(3 * (k + 1) * s + p) for k, (a, p) in terms)

    return wave


def TwoBlocks(seed, amplitude, n=(9, 7), kind="trig"):
    """A block with a wavy lower side on a flat, wider one."""
    wave = Waves(seed, amplitude)

    def upper(s, t):
        y = wave(s)
        return s, y + amplitude + t * (1.0 - y)

    lower = (-0.3, -1, 1.3, 0)
    return Grids(upper=(upper, (n[0], 5), kind), lower=(lower, (int(1.6 * n[1]), 5), kind))


def Pushed(mesh, motion, stiffness=1000, **options):
    """Two blocks, the upper one behind a spring that moves."""
    return Problem(mesh, **options).Spring("upper_top", motion, stiffness)


@problem((1, 0.0), (2, 0.3), (3, 0.7), (4, 1.5))
def RandomGap(seed, friction):
    """A block pressed on a rigid wavy plane in one step, and sheared."""
    gap = Waves(seed, 0.03)(x, sin) + 0.01
    mesh = Grids(block=((0, 0, 1, 0.6), (12, 5)))
    p = Problem(mesh, pairs=[("block", gap)], friction=friction)
    return p.Spring("block_top", (0.03, -0.06), 500)


@problem((1, 0.0), (2, 0.2), (3, 0.8), (4, 1.5), (5, 0.5), (6, 1.0))
def RandomSurface(seed, friction):
    """Two blocks with random gaps, pressed and pushed aside in one step."""
    mesh = TwoBlocks(seed, 0.02, kind=("quad", "trig")[seed % 2])
    young = {"upper": 100.0, "lower": 60.0}
    return Pushed(mesh, (0.04, -0.06 + 0.03 * (x - 0.5)), young=young, friction=friction)


@problem(1, 2, 3)
def BadStart(seed):
    """A random start vector of displacements and tractions."""
    return Pushed(TwoBlocks(seed, 0.02), (0.02, -0.06), friction=0.4).Scatter(seed, 0.1, 30)


@problem(0.0, 0.5)
def Plate(friction):
    """A thin plate pressed into a valley: contact begins at its ends."""

    def valley(s, t):
        px = -0.2 + 1.4 * s
        top = 0.3 * (px - 0.5) ** 2 - 0.075
        return px, -0.5 + t * (top + 0.5)

    mesh = Grids(plate=((0, 0, 1, 0.02), (30, 1), "quad"), valley=(valley, (17, 4)))
    p = Problem(mesh, 1000.0, [("plate", "valley")], friction, held="valley_bottom")
    return p.Spring("plate_top", (0, 0), 1e-3).Traction("plate_top", (0, -0.3))


@problem(0.0, 0.6)
def Cantilever(friction):
    """A slender beam bent on a support in its middle and pulled beyond it."""
    mesh = Grids(beam=((0, 0, 2, 0.1), (24, 2)), support=((1.2, -0.6, 1.7, -0.02), (7, 6)))
    held, pairs = "beam_left|support_bottom", [("support_top", "beam_bottom")]
    return Problem(mesh, 1000.0, pairs, friction, held=held).Traction("beam_right", (0, -1.0))


@problem((20, 5), (4, 24), (3, 40))
def Meshes(*n):
    """A fine against a coarse mesh, and the reverse."""
    return Pushed(TwoBlocks(11, 0.01, n), (0.03, -0.05), friction=0.5)


@problem((1e6, 1.0), (1.0, 1e6), (1e11, 2e11))
def Stiffness(upper, lower):
    """Soft on stiff, stiff on soft, and Pascal as unit."""
    young = {"upper": upper, "lower": lower}
    mesh, spring = TwoBlocks(12, 0.02), 10 * min(upper, lower)
    return Pushed(mesh, (0.02, -0.05), spring, young=young, friction=0.4)


@problem()
def SlipWave():
    """A pressed strip is pulled at one end: slip runs along it until all of it slides."""
    mesh = Grids(strip=((0, 0, 3, 0.2), (40, 2), "quad"), base=((-0.2, -0.5, 3.2, 0), (37, 3)))
    p = Problem(mesh, {"strip": 100.0, "base": 1e4}, [("strip", "base")], friction=0.4, steps=3)
    return p.Traction("strip_top", CF((0, -1))).Spring("strip_right", (0.05, 0), 1000)


@problem(0.3, 1.0)
def Cyclic(friction):
    """Shear to and fro, with changing pressure."""

    def motion(t):
        return 0.05 * sin(6.283 * t), -0.03 * IfPos(t - 0.25, 1, 4 * t)

    return Pushed(TwoBlocks(13, 0.005), motion, friction=friction, path=[(2.0, 8)])


@problem(0.0, 0.8)
def PressAndLift(friction):
    """Pressed in one step, lifted beyond the first gap in one step, pressed again."""
    path = [(1.0, 1), (-1.0, 1), (1.0, 1)]
    return Pushed(TwoBlocks(14, 0.02), (0.02, -0.05), friction=friction, path=path)


@problem(0.0, 0.5)
def Rubber(friction):
    """Nearly incompressible neo-Hooke, compressed in one step."""
    young = {"upper": 1.0, "lower": 1000.0}
    rubber = {"young": young, "nu": 0.49, "nonlinear": True, "order": 3}
    mesh = TwoBlocks(15, 0.01, (6, 7), "quad")
    return Pushed(mesh, (0.0, -0.06), 100, friction=friction, **rubber)


@problem()
def Penetration():
    """The bodies overlap at the start; there is no other load."""
    mesh = Grids(upper=((0, -0.05, 1, 1), (8, 6)), lower=((-0.3, -1, 1.3, 0), (9, 6)))
    young = {"upper": 100.0, "lower": 50.0}
    return Problem(mesh, young, friction=0.3, held=f"{GROUND}|upper_top")


@problem()
def Sandwich():
    """Three blocks, two contacts, the one in the middle held by them alone."""
    mesh = Grids(
        upper=((0, 0.5, 1, 1), (8, 4)),
        middle=((-0.1, 0, 1.1, 0.49), (7, 4)),
        lower=((-0.3, -0.5, 1.3, -0.01), (9, 4)),
    )
    young = {"upper": 100.0, "middle": 30.0, "lower": 100.0}
    pairs = [("upper", "middle"), ("middle", "lower")]
    return Pushed(mesh, (0.02, -0.06), young=young, pairs=pairs, friction=0.5)


@problem()
def Slab():
    """Greco's slab: friction 1, Pascal and metres, opening, slip and stick in one step."""
    mesh, plane = Grids(slab=((0, 0, 0.04, 0.04), (24, 8))), [("slab", CF(0.0))]
    p = Problem(mesh, 1.3e11, plane, nu=0.2, heldx="slab_right", friction=1.0)
    return p.Traction("slab_top", (0, -5e7)).Traction("slab_left", (15e7, 0))


@problem()
def Wedge():
    """A wedge pressed between two inclined walls with friction, which may jam."""

    def wedge(s, t):
        return (s - 0.5) * (0.4 + 0.6 * t), t

    walls = [("wedge_left", CF(0.0)), ("wedge_right", CF(0.01))]
    path = [(1.0, 1), (0.1, 1), (1.0, 1)]
    p = Problem(Grids(wedge=(wedge, (6, 10))), pairs=walls, friction=0.3, path=path)
    return p.Traction("wedge_top", (0.5, -5))


@problem("bubble", "condense", "p3")
def Spaces(kind):
    """Other displacement spaces."""
    order, mesh = {"bubble": 1}.get(kind, 3), ("trig", "quad")[kind == "condense"]
    options = {"order": order, "bubble": kind == "bubble", "condense": kind == "condense"}
    return Pushed(TwoBlocks(16, 0.02, (7, 6), mesh), (0.04, -0.05), friction=0.6, **options)


@problem((21, 0.3), (22, 0.9))
def Rough(seed, friction):
    """A random sawtooth of sixty slave faces on a coarse block: contact at many separate spots."""
    heights = np.random.default_rng(seed).uniform(0, 0.004, 61)

    def upper(s, t):
        bottom = np.interp(s, np.linspace(0, 1, 61), heights)
        return s, bottom + t * (0.5 - bottom)

    mesh = Grids(upper=(upper, (60, 5), "quad"), lower=((-0.2, -0.5, 1.2, 0), (23, 6)))
    return Pushed(mesh, (0.006, -0.012), friction=friction)


@problem(0.4, 1.2)
def Neo(friction):
    """Neo-Hooke bodies; Dirichlet values press and shear by a multiple of the mesh size at once."""
    young, drive = {"upper": 10.0, "lower": 100.0}, {"upper_top": (0.25, -0.15)}
    mesh = TwoBlocks(23, 0.01, (10, 9))
    return Problem(mesh, young, friction=friction, nonlinear=True, drive=drive)


# --- in three dimensions: small meshes, the same troubles ----------------------------------------


def TwoBoxes(n=(3, 3), kind="hex", gap=0.01, waves=0.0, seed=0):
    """A block with a wavy lower side above a wider one."""
    phase = np.random.default_rng(seed).uniform(0, 6, 2)

    def bend(points):
        px, py, pz = points.T
        wave = waves * np.sin(4 * px + phase[0]) * np.cos(3 * py + phase[1])
        return np.stack([px, py, pz + wave * (1 - (pz - gap) / 0.6)], axis=1)

    return Grids(
        upper=((0, 0, gap, 1, 1, gap + 0.6), (n[0], n[0], 2), kind, bend),
        lower=((-0.25, -0.3, -0.6, 1.3, 1.25, 0), (n[1], n[1] + 1, 2)),
    )


UNEQUAL = {"upper": 100.0, "lower": 60.0}  # Young's moduli
SPRING = 10 * 60.0


@problem((1, 0.0), (2, 0.4), (3, 1.5))
def RandomGap3D(seed, friction):
    """A brick pressed on a rigid wavy plane in one step, and sheared."""
    mesh = Grids(brick=((0, 0, 0, 1, 1, 0.5), (4, 4, 2), "prism"))
    a, b = np.random.default_rng(seed).uniform(0, 6, 2)
    gap = 0.02 + 0.02 * sin(4 * x + a) * cos(5 * y + b)
    p = Problem(mesh, pairs=[("brick", gap)], friction=friction)
    return p.Spring("brick_top", (0.03, 0.02, -0.06), 500)


@problem((1, 0.2), (2, 0.7), (3, 1.5))
def RandomSurface3D(seed, friction):
    """Two bricks with random gaps, pressed, pushed aside and turned in one step."""
    mesh = TwoBoxes((4, 3), ["hex", "prism", "tet"][seed - 1], waves=0.02, seed=seed)
    motion = (0.03 - 0.04 * (y - 0.5), 0.04 * (x - 0.5), -0.05)
    return Pushed(mesh, motion, SPRING, young=UNEQUAL, friction=friction)


@problem()
def BadStart3D():
    """A random start vector of displacements and tractions."""
    p = Pushed(TwoBoxes(), (0.02, 0.01, -0.05), SPRING, young=UNEQUAL, friction=0.4)
    return p.Scatter(5, 0.1, 30)


@problem((6, 2), (2, 6))
def Meshes3D(*n):
    """A fine against a coarse mesh, and the reverse."""
    mesh = TwoBoxes(n, waves=0.01)
    return Pushed(mesh, (0.03, -0.02, -0.05), SPRING, young=UNEQUAL, friction=0.5)


@problem(0.3, 1.0)
def Brick3D(friction):
    """A brick with four macro-elements above a rigid plane, heavy, pushed aside."""
    mesh, plane = Grids(brick=((0, 0, 0, 1, 1, 0.5), (2, 2, 1))), [("brick", CF(0.01))]
    p = Problem(mesh, pairs=plane, friction=friction, resultant=(-0.1, -0.05, 1))
    return p.Traction("brick_top", (0.1, 0.05, -1))


@problem()
def Plate3D():
    """A thin plate, pressed into a valley."""

    def valley(points):
        px, py, pz = points.T
        return np.stack([px, py, pz + (pz + 0.5) * (0.6 * (px - 0.5) ** 2 - 0.15)], axis=1)

    mesh = Grids(
        upper=((0, 0, 0, 1, 0.5, 0.03), (9, 3, 1)),
        lower=((-0.2, -0.2, -0.5, 1.2, 0.7, 0), (7, 4, 2), "hex", valley),
    )
    p = Pushed(mesh, (0, 0, 0), 1e-3, young=1000.0, friction=0.3)
    return p.Traction("upper_top", (0, 0, -0.5))


@problem()
def Cyclic3D():
    """Circular shear under changing pressure: the direction of slip turns."""

    def motion(t):
        return 0.04 * sin(6.283 * t), 0.04 * cos(6.283 * t), -0.04

    return Pushed(TwoBoxes(waves=0.005), motion, friction=0.4, steps=8)


@problem()
def PressAndLift3D():
    """Pressed in one step, lifted beyond the first gap in one step, pressed again."""
    path, mesh = [(1.0, 1), (-1.0, 1), (1.0, 1)], TwoBoxes((3, 4), "tet")
    options = {"young": UNEQUAL, "friction": 0.8, "path": path}
    return Pushed(mesh, (0.02, 0.01, -0.05), SPRING, **options)


@problem()
def Rubber3D():
    """Nearly incompressible neo-Hooke, compressed in one step."""
    rubber = {"young": {"upper": 1.0, "lower": 1000.0}, "nu": 0.49, "nonlinear": True}
    return Pushed(TwoBoxes((2, 3)), (0.02, 0, -0.06), 10.0, friction=0.5, **rubber)
