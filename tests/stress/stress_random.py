"""Stress set: problems made at random, each from its number, and all of them solvable.

Why they are solvable: every body is pressed against the next one, down to a clamped base or a rigid
obstacle. Forces lie well inside of the cones of friction and of the widths of the contacts, or a
displacement is prescribed that closes all gaps, and what slides then is driven. A body that contact
alone holds rubs, or a weak spring guides it.
"""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from ngsolve import CF, sin, x, y
from stress_meshes import Block, Block3D, Grids, Grids3D
from stress_problem import Problem, problem

from ngslac import BubbleVectorH1

__all__ = ["Draw", "Frame", "Random"]

COUNT = 160
NUMBERS = [f"{k:03d}" for k in range(COUNT)]


@dataclass(frozen=True)
class Frame:
    """Unit of length, direction and place of the whole problem."""

    size: float
    angle: float
    origin: tuple

    def Shape(self, shape):
        """The map of a block, in the frame."""
        c, s = np.cos(self.angle), np.sin(self.angle)

        def placed(a, b):
            px, py = shape(a, b)
            return (
                self.origin[0] + self.size * (c * px - s * py),
                self.origin[1] + self.size * (s * px + c * py),
            )

        return placed

    def Vector(self, vx, vy):
        """A vector, in the frame, of the same length."""
        c, s = np.cos(self.angle), np.sin(self.angle)
        return CF((c * vx - s * vy, s * vx + c * vy))

    def Along(self):
        """The first coordinate, as it is in the block."""
        c, s = np.cos(self.angle), np.sin(self.angle)
        return (c * (x - self.origin[0]) + s * (y - self.origin[1])) / self.size


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
        """Nothing, or a little play."""
        return self.rng.choice([0.0, self.rng.uniform(0.001, 0.02)])

    def Cells(self):
        return int(self.rng.integers(3, 10)), int(self.rng.integers(2, 4)), self.rng.random() < 0.5

    def Wave(self):
        """The height of a lower side: flat, or a few waves above 0."""
        amplitude = self.rng.choice([0.0, self.rng.uniform(0.003, 0.015)])
        number, phase = self.rng.uniform(2, 9), self.rng.uniform(0, 6)
        return lambda s: amplitude * (1 + np.sin(number * s + phase))

    def Ratio(self, heights, width):
        """A sideways force over a downward one that neither slides nor tips a stack."""
        most = min(0.6 * min(self.friction), 0.15 * width / sum(heights))
        return self.rng.uniform(-most, most)


def Sheet(x0, x1, y0, y1, wave=None):
    """The map of a block with a wavy lower side."""

    def shape(s, t):
        low = y0 + (wave(s) if wave else 0)
        return x0 + (x1 - x0) * s, low + t * (y1 - low)

    return shape


@problem(*NUMBERS)
def Random(number):
    """Blocks of random sizes, materials, meshes and friction, under a random load."""
    draw = Draw(number)
    if int(number) % 8 == 7:
        return Random3D(draw)
    return {"tower": Tower, "bridge": Bridge, "obstacle": OnObstacle}[draw.kind](draw)


def Stack(draw, count, low=0.0, above="base"):
    """`count` blocks above a height; their blocks, pairs, and what is known of their sizes."""
    names = [above] + [f"block{k}" for k in range(1, count + 1)]
    blocks, heights, widths, play = [], [], [], 0.0
    for name in names[1:]:
        gap, wave = draw.Gap(), draw.Wave()
        height, width = draw.rng.uniform(0.25, 0.6), draw.rng.uniform(0.7, 1.0)
        middle = draw.rng.uniform(-0.05, 0.05)
        nx, ny, quads = draw.Cells()
        shape = Sheet(middle - width / 2, middle + width / 2, low + gap, low + gap + height, wave)
        blocks.append(Block(name, draw.frame.Shape(shape), nx, ny, bool(quads)))
        low += gap + height
        play += gap
        heights.append(height)
        widths.append(width)
    pairs = [(f"{upper}_bottom", f"{lower}_top") for lower, upper in pairwise(names)]
    return blocks, pairs, heights, min(widths), play


def Base(draw):
    nx, ny, quads = draw.Cells()
    return Block("base", draw.frame.Shape(Sheet(-1, 1, -0.6, 0)), nx + 4, ny, bool(quads))


def Make(draw, mesh, pairs, bodies, held):
    """The problem without its loads; `held` boundaries are clamped."""
    young = dict(zip(bodies, draw.young, strict=False))
    law = {"finite": True} if draw.finite else {}
    own = {k: {"friction": f} for k, f in enumerate(draw.friction[: len(pairs)]) if draw.rubs}
    bubble = {"space": BubbleVectorH1} if draw.order == 1 and draw.bubble else {}
    p = Problem(mesh, pairs, young, nonlinear=draw.finite, order=draw.order, law=law, own=own,
                flags={"dirichlet": "|".join(held)}, path=[(1.0, draw.steps)],
                **bubble)  # fmt: skip
    if not draw.rubs:
        for body in bodies:
            if f"{body}_bottom" not in held:
                p.Spring(f"{body}_left", CF((0,) * mesh.dim), 1e-3 * young[body] / draw.frame.size)
    return p


def Load(draw, p, loose, heights, width, play, part=1.0):
    """Press the stack `loose` together, and aside."""
    top, frame, rng = f"{loose[-1]}_top", draw.frame, draw.rng
    weakest = min(p.young.values())
    if draw.drive in ("displacement", "spring"):
        soft = heights[int(np.argmin([p.young[name] for name in loose]))]
        down = play + rng.uniform(0.01, 0.04) * soft
        motion = p.load * frame.size * frame.Vector(rng.uniform(-1, 1) * down, -down)
        if draw.drive == "spring":
            p.Spring(top, motion, 10 * weakest / frame.size)
        else:
            p.prescribe = {top: motion}
    else:
        force = part * rng.uniform(0.005, 0.03) * weakest
        vector = frame.Vector(force * draw.Ratio(heights, width), -force)
        if draw.drive == "force":
            p.Traction(top, p.load * vector)
        else:
            for name in loose:
                p.Weight(name, p.load * vector / (sum(heights) * frame.size))
    return p


def Held(draw, loose, *ground):
    """Boundaries that are clamped: the ground, and the top where its displacement is given."""
    return [*ground] + ([f"{loose[-1]}_top"] if draw.drive == "displacement" else [])


def Tower(draw):
    """Blocks on a clamped base."""
    blocks, pairs, heights, width, play = Stack(draw, draw.count)
    loose = [block.name for block in blocks]
    mesh = Grids(Base(draw), *blocks)
    p = Make(draw, mesh, pairs, ["base", *loose], Held(draw, loose, "base_bottom"))
    return Load(draw, p, loose, heights, width, play)


def OnObstacle(draw):
    """Blocks on a rigid, maybe wavy, obstacle: small sliding."""
    draw.finite = False
    blocks, pairs, heights, width, play = Stack(draw, draw.count)
    loose = [block.name for block in blocks]
    gap, waves = draw.rng.uniform(0, 0.01, 2)
    obstacle = gap + waves * (1 + sin(draw.rng.uniform(1, 8) * draw.frame.Along()))
    pairs[0] = (pairs[0][0], draw.frame.size * obstacle)
    p = Make(draw, Grids(*blocks), pairs, loose, Held(draw, loose))
    return Load(draw, p, loose, heights, width, play + gap + 2 * waves)


def Bridge(draw):
    """A beam on two pillars, of which one is a little lower, and blocks on its middle."""
    count = min(draw.count, 3)
    short = draw.Gap() / 4
    pillars = []
    for name, x0, height in (("base", -0.9, 0.0), ("other", 0.4, -short)):
        nx, ny, quads = draw.Cells()
        shape = draw.frame.Shape(Sheet(x0, x0 + 0.5, -0.6, height))
        pillars.append(Block(name, shape, nx, ny, bool(quads)))
    nx, ny, quads = draw.Cells()
    thick = draw.rng.uniform(0.2, 0.4)
    beam = Block("beam", draw.frame.Shape(Sheet(-1, 1, 0, thick)), 2 * nx, ny, bool(quads))
    blocks, pairs, heights, width, play = Stack(draw, count - 1, thick, "beam") if count > 1 else (
        [], [], [], 1.0, 0.0
    )  # fmt: skip
    loose = ["beam"] + [block.name for block in blocks]
    pairs = [("base_top", "beam_bottom"), ("other_top", "beam_bottom"), *pairs]
    held = Held(draw, loose, "base_bottom", "other_bottom")
    mesh = Grids(*pillars, beam, *blocks)
    p = Make(draw, mesh, pairs, ["base", "other", *loose], held)
    return Load(draw, p, loose, [thick, *heights], width, play + short, 0.1)  # it bends


# --- three dimensions ----------------------------------------------------------------------------


def Random3D(draw):
    """Two or three boxes on each other, upright."""
    rng = draw.rng
    count, low, blocks, play = min(draw.count, 2), 0.0, [], 0.0
    size, kinds = draw.frame.size, ["hex", "prism", "tet"]
    names = ["base"] + [f"block{k}" for k in range(1, count + 1)]
    n = int(rng.integers(2, 4))
    base = np.array((-0.7, -0.8, -0.5, 0.8, 0.7, 0.0))
    blocks = [Block3D("base", tuple(size * base), (n, n + 1, 1), rng.choice(kinds))]
    heights = []
    for k, name in enumerate(names[1:]):
        gap, height, half = draw.Gap(), rng.uniform(0.3, 0.6), rng.uniform(0.4, 0.5)
        box = size * np.array((-half, -half, low + gap, half, half, low + gap + height))
        n = int(rng.integers(2, 4)) + k
        blocks.append(Block3D(name, tuple(box), (n, n, 1), rng.choice(kinds)))
        low, play = low + gap + height, play + gap
        heights.append(height)
    pairs = [(f"{upper}_bottom", f"{lower}_top") for lower, upper in pairwise(names)]
    draw.order, draw.steps = max(2, min(draw.order, 2)), min(draw.steps, 5)
    p = Make(draw, Grids3D(*blocks), pairs, names, Held(draw, names, "base_bottom"))
    return Load3D(draw, p, names[1:], heights, play)


def Load3D(draw, p, loose, heights, play):
    """As in two dimensions, and turned about the normal where it is driven."""
    top, size, rng = f"{loose[-1]}_top", draw.frame.size, draw.rng
    weakest, angle = min(p.young.values()), rng.uniform(0, 2 * np.pi)
    aside = np.array((np.cos(angle), np.sin(angle)))
    if draw.drive in ("displacement", "spring"):
        down = play + rng.uniform(0.01, 0.04) * min(heights)
        slide, turn = rng.uniform(0, 0.5) * down * aside, rng.uniform(-0.03, 0.03)
        motion = CF((size * slide[0] - turn * y, size * slide[1] + turn * x, -size * down)) * p.load
        if draw.drive == "spring":
            p.Spring(top, motion, 10 * weakest / size)
        else:
            p.prescribe = {top: motion}
        return p
    force = rng.uniform(0.005, 0.03) * weakest
    sideways = force * draw.Ratio(heights, 0.8) * aside
    vector = p.load * CF((sideways[0], sideways[1], -force))
    if draw.drive == "force":
        p.Traction(top, vector)
    else:
        for name in loose:
            p.Weight(name, vector / (sum(heights) * size))
    return p
