"""Stress set: bodies that hold each other, in chains, stacks and between tools with play."""

from itertools import pairwise

from ngsolve import CF
from stress_meshes import Block, Grids, Outline, Part, Plate, Sketch
from stress_problem import Problem, problem

__all__ = ["Tower"]

BETWEEN = [("loose_bottom", "base_top"), ("tool_bottom", "loose_top")]
TOOL = {"dirichlet": "base_bottom|tool_top"}


def Loose(gap=0.03, n=(7, 5, 4), quads=False, rest=0.0):
    """A base, a loose block on it, and a tool above."""
    return Grids(
        Block("base", (-1, -1, 1, 0), n[0], 4, quads),
        Block("loose", (-0.5, rest, 0.5, 0.6 + rest), n[1], 3),
        Block("tool", (-0.4, 0.6 + rest + gap, 0.4, 1.1 + rest + gap), n[2], 3, quads),
    )


def Between(mesh, friction, steps, finite=False, young=(1.0, 1.0, 1.0), **flags):
    """The loose block of `mesh`; without friction a guide keeps it from sliding away."""
    law = {"finite": True} if finite else {}
    if friction:
        law["friction"] = friction
    p = Problem(mesh, BETWEEN, dict(zip(("base", "loose", "tool"), young, strict=True)), law=law,
                nonlinear=finite, flags=TOOL | flags, path=[(1.0, steps)])  # fmt: skip
    if not friction:
        p.Spring("loose_left", CF((0, 0)), 1e-3 * young[1])
    return p


@problem((1, 0.3, 0), (2, 0.3, 0), (5, 0.3, 0), (20, 0.3, 0), (1, 0.0, 0), (2, 0.0, 0), (5, 0.0, 0),
         (20, 1.5, 0), (2, 1.5, 0), (5, 0.05, 0), (1, 0.3, 1), (2, 0.3, 1), (5, 0.3, 1),
         (20, 0.3, 1), (5, 1.5, 1), (2, 0.0, 1))  # fmt: skip
def ThreeBlocks(argument):
    """The tool starts with a gap and closes it: any number of steps leads to the same state."""
    steps, friction, finite = argument
    p = Between(Loose(), friction, steps, bool(finite))
    p.prescribe = {"tool_top": CF((0, -0.05 * p.load))}
    return p


@problem((2, 1e4, 1.0, 1.0), (5, 1.0, 1e-4, 1.0), (2, 1e-4, 1.0, 1e4), (5, 1e11, 2e5, 2e11))
def ThreeMaterials(argument):
    """The same with bodies of very different stiffness."""
    steps, *young = argument
    p = Between(Loose(quads=True), 0.3, steps, young=young)
    p.prescribe = {"tool_top": CF((0, -0.05 * p.load))}
    return p


@problem((1, 0.01), (2, 0.01), (5, 0.02), (20, 0.0))
def BothGaps(argument):
    """The loose block hangs between base and tool, which touches it first, and is pushed aside."""
    steps, rest = argument
    p = Between(Loose(rest=rest, gap=0.004), 0.4, steps)
    p.prescribe = {"tool_top": CF((0.01 * p.load, -0.05 * p.load))}
    return p


@problem(0.5, 2.5, 10.0)
def ThreeMeshes(young):
    """Another mesh, by OCC, and other numbers: rounding must not decide."""
    mesh = Sketch(
        Part("base", Plate(-1, -1, 1, 0), 0.3, {"bottom": [(0, -1)], "top": [(0, 0)]}),
        Part("loose", Plate(-0.5, 0, 0.5, 0.6), 0.2, {"bottom": [(0, 0)], "top": [(0, 0.6)]}),
        Part("tool", Plate(-0.4, 0.63, 0.4, 1.13), 0.17,
             {"bottom": [(0, 0.63)], "top": [(0, 1.13)]}),
    )  # fmt: skip
    p = Between(mesh, 0.3, 2, young=(young, young, young))
    p.outlines = False
    p.prescribe = {"tool_top": CF((0, -0.05 * p.load))}
    return p


@problem((1, 0.3, 0), (5, 0.3, 0), (2, 0.3, 1), (1, 0.0, 0), (3, 1.0, 0))
def PushInGap(argument):
    """The tool moves by less than its gap: nothing happens, and that is an answer."""
    steps, friction, finite = argument
    p = Between(Loose(), friction, steps, bool(finite))
    p.prescribe = {"tool_top": CF((0, -0.02 * p.load))}
    return p


@problem((1, 0.3), (5, 0.3), (2, 0.9))
def HeavyInGap(argument):
    """The same; the loose block has a weight, and is as heavy as that at the end."""
    steps, friction = argument
    p = Between(Loose(), friction, steps)
    p.Weight("loose", CF((0, -0.01)))
    p.prescribe = {"tool_top": CF((0, -0.02 * p.load))}
    return p


def Tower(count, friction, gap, finite=False, n=5):
    """Blocks of width 1 and height 0.3 on a base, each held by friction alone."""
    names = ["base"] + [f"block{k}" for k in range(1, count + 1)]
    blocks = [Block("base", (-0.4, -0.5, 1.4, 0), 9, 3)]
    for k, name in enumerate(names[1:]):
        low = k * (0.3 + gap) + gap
        blocks.append(Block(name, (0, low, 1, low + 0.3), n + k % 3, 2, quads=k % 2 == 0))
    pairs = [(f"{above}_bottom", f"{below}_top") for below, above in pairwise(names)]
    law = {"friction": friction} | ({"finite": True} if finite else {})
    return Problem(Grids(*blocks), pairs, dict.fromkeys(names, 100.0), law=law, nonlinear=finite,
                   flags={"dirichlet": "base_bottom"})  # fmt: skip


@problem((2, 0.3, 0.0, 1), (3, 0.3, 0.005, 1), (4, 0.6, 0.0, 2), (5, 0.5, 0.002, 5),
         (6, 0.8, 0.0, 1), (3, 0.5, 0.0, 20), (3, 1.5, 0.01, 2), (8, 0.5, 0.0, 2))  # fmt: skip
def Pile(argument):
    """A stack with weights from the start, pushed at its top: well within friction and balance."""
    count, friction, gap, steps = argument
    p = Tower(count, friction, gap)
    for k in range(1, count + 1):
        p.Weight(f"block{k}", CF((0, -1.0)))
    p.Traction(f"block{count}_top", p.load * CF((0.2 * friction * 0.3, -0.1)))
    p.path = [(1.0, steps)]
    return p


@problem((2, 0.3, 1), (3, 0.5, 2), (4, 0.5, 5))
def PileUnderForce(argument):
    """A stack without weights: the force on its top holds all of it."""
    count, friction, steps = argument
    p = Tower(count, friction, 0.0)
    p.Traction(f"block{count}_top", p.load * CF((0.05, -1.0)))
    p.path = [(1.0, steps)]
    return p


@problem((2, 0.4, 1), (3, 0.4, 2), (3, 0.8, 5))
def LargePile(argument):
    """A stack with finite sliding."""
    count, friction, steps = argument
    p = Tower(count, friction, 0.0, finite=True)
    for k in range(1, count + 1):
        p.Weight(f"block{k}", p.load * CF((0, -1.0)))
    p.Traction(f"block{count}_top", p.load * CF((0.05, -0.5)))
    p.path = [(1.0, steps)]
    return p


# --- chains that are pulled ----------------------------------------------------------------------


def Link(x0, hooked, headed):
    """Corners of a link: a head at its left, which fits the slot at the right of another one."""
    corners = [(x0, -0.8), (x0 + 1.4, -0.8)]
    if hooked:  # a slot with a narrow mouth
        corners += [(x0 + 1.4, -0.2), (x0 + 1.0, -0.2), (x0 + 1.0, -0.5), (x0 + 0.4, -0.5)]
        corners += [(x0 + 0.4, 0.5), (x0 + 1.0, 0.5), (x0 + 1.0, 0.2), (x0 + 1.4, 0.2)]
    corners += [(x0 + 1.4, 0.8), (x0, 0.8)]
    if headed:
        corners += [(x0, 0.15), (x0 - 1.0, 0.15), (x0 - 1.0, 0.4), (x0 - 1.4, 0.4)]
        corners += [(x0 - 1.4, -0.4), (x0 - 1.0, -0.4), (x0 - 1.0, -0.15), (x0, -0.15)]
    return corners


def Links(count, play, maxh=0.2):
    """A clamped link and `count` loose ones."""
    parts, pairs = [], []
    names = [f"link{k}" for k in range(count + 1)]
    for k, name in enumerate(names):
        x0 = (2.0 - play) * k
        edges = {"wall": [(x0, 0.5)]} if k == 0 else {"head": [(x0 - 1, 0.3), (x0 - 1, -0.3)]}
        edges |= {"far": [(x0 + 1.4, 0.7)]} if k == count else {
            "hook": [(x0 + 1, 0.35), (x0 + 1, -0.35)]
        }  # fmt: skip
        face = Outline(*Link(x0, k < count, k > 0))
        parts.append(Part(name, face, maxh * (1 - 0.1 * (k % 3)), edges))
        if k:
            pairs.append((f"{name}_head", f"{names[k - 1]}_hook"))
    return names, pairs, Sketch(*parts)


@problem((1, 0.3, 1, 0.0), (2, 0.3, 1, 0.0), (3, 0.3, 2, 0.01), (2, 0.8, 5, 0.02),
         (1, 0.1, 20, 0.005), (2, 0.3, 2, 0.05), (4, 0.2, 1, 0.0))  # fmt: skip
def Chain(argument):
    """Links with play are pulled by a force: each is held by the shoulders of the one before."""
    count, friction, steps, play = argument
    names, pairs, mesh = Links(count, play)
    p = Problem(mesh, pairs, dict.fromkeys(names, 1000.0), law={"friction": friction},
                flags={"dirichlet": "link0_wall"}, outlines=False)  # fmt: skip
    p.Traction(f"{names[-1]}_far", p.load * CF((1.0, 0)))
    p.path = [(1.0, steps)]
    return p
