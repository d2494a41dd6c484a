"""Stress set: problems made at random, each from its number, and all of them solvable.

Why they are solvable: every body is pressed against the next one, down to a clamped base or a rigid
obstacle. Forces lie well inside of the cones of friction and of the widths of the contacts, or a
displacement is prescribed that closes all gaps, and what slides then is driven. A body that contact
alone holds rubs, or a weak spring guides it.
"""

from dataclasses import dataclass

import numpy as np
from ngsolve import CF, sin, x, y
from stress_meshes import Block, Grids, Turned
from stress_problem import Problem, problem

NUMBERS = [f"{k:03d}" for k in range(160)]
KINDS = ["hex", "prism", "tet"]
FEW = 6  # cells along a side that have at least three macro-elements


@dataclass(frozen=True)
class Frame:
    """Unit of length, direction and place of the whole problem."""

    size: float
    angle: float
    origin: tuple

    def Shape(self, shape):
        """The map of a block, in the frame."""

        def placed(a, b):
            turned = Turned(self.angle, *shape(a, b))
            return tuple(o + self.size * p for o, p in zip(self.origin, turned, strict=True))

        return placed

    def Vector(self, vx, vy):
        """A vector, in the frame, of the same length."""
        return CF(Turned(self.angle, vx, vy))

    def Along(self):
        """The first coordinate, as it is in the block."""
        return Turned(-self.angle, x - self.origin[0], y - self.origin[1])[0] / self.size


class Draw:
    """The random choices of one problem, in words."""

    def __init__(self, number):
        self.rng = np.random.default_rng([2718, int(number)])
        rng = self.rng
        self.kind = rng.choice(["tower", "bridge", "obstacle"], p=[0.6, 0.2, 0.2])
        self.count = int(rng.integers(1, 5))  # blocks above the base
        self.drive = rng.choice(["displacement", "spring", "force", "weight"])
        self.finite = bool(rng.random() < 0.35)
        self.steps = int(rng.choice([1, 2, 5, 20], p=[0.5, 0.25, 0.17, 0.08]))
        self.order = int(rng.choice([1, 2, 3], p=[0.15, 0.65, 0.2]))
        self.bubble = bool(rng.random() < 0.5)
        self.rubs = self.drive in ("force", "weight") or rng.random() < 0.8
        self.young = self._Unit(-6, 12, 100.0) * 10 ** (
            rng.choice([0, 1, 2, 4]) * rng.uniform(-0.5, 0.5, self.count + 2)
        )
        most = 1.5 if self.count == 1 else 1.0
        self.friction = rng.uniform(0.1, most, self.count + 1)
        tilted, shifted = rng.random(2) < (0.4, 0.2)
        size = self._Unit(-6, 3, 1.0)
        origin = size * rng.uniform(-50, 50, 2) if shifted else np.zeros(2)
        self.frame = Frame(size, rng.uniform(-np.pi, np.pi) if tilted else 0.0, tuple(origin))

    def _Unit(self, low, high, usual):
        """Mostly the usual number, else one of any magnitude."""
        other = 10 ** self.rng.uniform(low, high)
        return other if self.rng.random() < 0.25 else usual

    def Gap(self):
        return self.rng.choice([0.0, self.rng.uniform(0.001, 0.02)])

    def Cells(self):
        nx, ny = (int(self.rng.integers(*ends)) for ends in ((3, 10), (2, 4)))
        # Of order 1 two macro-elements a side would leave a block free to turn and to yield.
        n = (max(nx, FEW) if self.order == 1 and not self.bubble else nx), ny
        return n, "quad" if self.rng.random() < 0.5 else "trig"

    def Wave(self):
        """The height of a lower side: flat, or a few waves above 0."""
        amplitude = self.rng.choice([0.0, self.rng.uniform(0.003, 0.015)])
        number, phase = self.rng.uniform(2, 9), self.rng.uniform(0, 6)
        return lambda s: amplitude * (1 + np.sin(number * s + phase))

    def Aside(self):
        angle = self.rng.uniform(0, 2 * np.pi)
        return np.array((np.cos(angle), np.sin(angle)))

    def Ratio(self, heights, width):
        """A sideways force over a downward one that neither slides nor tips a stack."""
        most = min(0.6 * min(self.friction), 0.15 * width / sum(heights))
        return self.rng.uniform(-most, most)


def Base(draw):
    (nx, ny), kind = draw.Cells()
    return Block("base", draw.frame.Shape(Sheet(-1, 1, -0.6, 0)), (nx + 4, ny), kind)


def Sheet(x0, x1, y0, y1, wave=None):
    """The map of a block with a wavy lower side."""

    def shape(s, t):
        low = y0 + (wave(s) if wave else 0)
        return x0 + (x1 - x0) * s, low + t * (y1 - low)

    return shape


@dataclass
class Stack:
    """Bodies above another one, and what the load has to know of them."""

    blocks: list
    pairs: list
    heights: list
    width: float
    play: float  # sum of the gaps

    @property
    def names(self):
        return [block.name for block in self.blocks]

    @property
    def dim(self):
        return len(self.blocks[0].n)


@problem(*NUMBERS)
def Random(number):
    """Blocks of random sizes, materials, meshes and friction, under a random load."""
    draw = Draw(number)
    if int(number) % 8 == 7:
        return Tower3D(draw)
    return {"tower": Tower, "bridge": Bridge, "obstacle": OnObstacle}[draw.kind](draw)


def Pile(draw, count, low=0.0, below="base"):
    """`count` blocks above a height."""
    stack = Stack([], [], [], 1.0, 0.0)
    for k in range(1, count + 1):
        gap, wave = draw.Gap(), draw.Wave()
        height, width = draw.rng.uniform(0.25, 0.6), draw.rng.uniform(0.7, 1.0)
        middle = draw.rng.uniform(-0.05, 0.05)
        shape = Sheet(middle - width / 2, middle + width / 2, low + gap, low + gap + height, wave)
        stack.blocks.append(Block(f"block{k}", draw.frame.Shape(shape), *draw.Cells()))
        stack.pairs.append((f"block{k}", f"block{k - 1}" if k > 1 else below))
        stack.heights.append(height)
        stack.width = min(stack.width, width)
        stack.play += gap
        low += gap + height
    return stack


def Make(draw, mesh, stack, below=(), part=1.0):
    """The problem: the bodies below are clamped, the stack is pressed together, and aside."""
    bodies, size, top = [*below, *stack.names], draw.frame.size, f"{stack.names[-1]}_top"
    young = dict(zip(bodies, draw.young, strict=False))
    weakest = min(young.values())
    driven = draw.drive in ("displacement", "spring")
    vector = Motion(draw, stack, young) if driven else Force(draw, stack, weakest, part)
    own = {k: {"friction": f} for k, f in enumerate(draw.friction[: len(stack.pairs)]) if draw.rubs}
    options = {"order": draw.order, "bubble": draw.order == 1 and draw.bubble, "steps": draw.steps}
    options |= {"held": "|".join(f"{name}_bottom" for name in below), "own": own}
    options |= {"drive": {top: vector}} if draw.drive == "displacement" else {}
    p = Problem(mesh, young, stack.pairs, finite=draw.finite, **options)
    for body in [] if draw.rubs else stack.names:
        p.Spring(f"{body}_left", (0,) * mesh.dim, 1e-3 * young[body] / size)
    if draw.drive == "spring":
        p.Spring(top, vector, 10 * weakest / size)
    elif draw.drive == "force":
        p.Traction(top, p.load * vector)
    elif draw.drive == "weight":
        for name in stack.names:
            p.Weight(name, p.load * vector / (sum(stack.heights) * size))
    return p


def Motion(draw, stack, young):
    """A motion of the top that closes all gaps, in space turned about the normal, too."""
    frame, rng, heights = draw.frame, draw.rng, stack.heights
    if stack.dim == 3:
        aside = draw.Aside()
        down = stack.play + rng.uniform(0.01, 0.04) * min(heights)
        (a, b), turn = frame.size * (rng.uniform(0, 0.5) * down * aside), rng.uniform(-0.03, 0.03)
        return lambda t: t * CF((a - turn * y, b + turn * x, -frame.size * down))
    soft = heights[int(np.argmin([young[name] for name in stack.names]))]
    down = stack.play + rng.uniform(0.01, 0.04) * soft
    vector = frame.Vector(rng.uniform(-1, 1) * down, -down)
    return lambda t: t * frame.size * vector


def Force(draw, stack, weakest, part):
    """A force that neither slides nor tips the stack."""
    aside = draw.Aside() if stack.dim == 3 else None
    force = part * draw.rng.uniform(0.005, 0.03) * weakest
    sideways = force * draw.Ratio(stack.heights, stack.width)
    if stack.dim == 3:
        return CF((*(sideways * aside), -force))
    return draw.frame.Vector(sideways, -force)


def Tower(draw):
    """Blocks on a clamped base."""
    stack = Pile(draw, draw.count)
    return Make(draw, Grids(Base(draw), *stack.blocks), stack, ["base"])


def OnObstacle(draw):
    """Blocks on a rigid, maybe wavy, obstacle: small sliding."""
    draw.finite = False
    stack = Pile(draw, draw.count)
    gap, waves = draw.rng.uniform(0, 0.01, 2)
    obstacle = gap + waves * (1 + sin(draw.rng.uniform(1, 8) * draw.frame.Along()))
    stack.pairs[0] = ("block1", draw.frame.size * obstacle)
    stack.play = stack.play + gap + 2 * waves
    return Make(draw, Grids(*stack.blocks), stack)


def Bridge(draw):
    """A beam on two pillars, of which one is a little lower, and blocks on its middle."""
    count, short, pillars = min(draw.count, 3), draw.Gap() / 4, []
    for name, x0, height in (("base", -0.9, 0.0), ("other", 0.4, -short)):
        shape = draw.frame.Shape(Sheet(x0, x0 + 0.5, -0.6, height))
        pillars.append(Block(name, shape, *draw.Cells()))
    (nx, ny), kind = draw.Cells()
    thick = draw.rng.uniform(0.2, 0.4)
    beam = Block("beam", draw.frame.Shape(Sheet(-1, 1, 0, thick)), (2 * nx, ny), kind)
    stack = Pile(draw, count - 1, thick, "beam")
    stack.pairs[:0] = [("base_top", "beam_bottom"), ("other_top", "beam_bottom")]
    stack.blocks.insert(0, beam)
    stack.heights.insert(0, thick)
    stack.play += short
    return Make(draw, Grids(*pillars, *stack.blocks), stack, ["base", "other"], 0.1)  # it bends


def Tower3D(draw):
    """One or two boxes on a base, upright."""
    rng, low, size = draw.rng, 0.0, draw.frame.size
    n, stack = int(rng.integers(2, 4)), Stack([], [], [], 0.8, 0.0)
    place = size * np.array((-0.7, -0.8, -0.5, 0.8, 0.7, 0.0))
    base = Block("base", tuple(place), (n, n + 1, 1), rng.choice(KINDS))
    for k in range(min(draw.count, 2)):
        gap, height, half = draw.Gap(), rng.uniform(0.3, 0.6), rng.uniform(0.4, 0.5)
        place = size * np.array((-half, -half, low + gap, half, half, low + gap + height))
        n = int(rng.integers(2, 4)) + k
        stack.blocks.append(Block(f"block{k + 1}", tuple(place), (n, n, 1), rng.choice(KINDS)))
        stack.pairs.append((f"block{k + 1}", f"block{k}" if k else "base"))
        stack.heights.append(height)
        low, stack.play = low + gap + height, stack.play + gap
    draw.order, draw.steps = 2, min(draw.steps, 5)
    return Make(draw, Grids(base, *stack.blocks), stack, ["base"])
