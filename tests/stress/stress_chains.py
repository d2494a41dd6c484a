"""Stress set: bodies that hold each other, in chains, stacks and between tools with play."""

from itertools import pairwise

from ngsolve import CF
from stress_meshes import Block, Grids, Outline, Part, Plate, Sketch
from stress_problem import Problem, problem


def Loose(gap=0.03, kind="trig", rest=0.0):
    """A base, a loose block on it, and a tool above."""
    return Grids(
        base=((-1, -1, 1, 0), (7, 4), kind),
        loose=((-0.5, rest, 0.5, 0.6 + rest), (5, 3)),
        tool=((-0.4, 0.6 + rest + gap, 0.4, 1.1 + rest + gap), (4, 3), kind),
    )


def Between(mesh, friction, steps, motion, young=1.0, finite=False):
    """The loose block of `mesh`; without friction a guide keeps it from sliding away."""
    options = {"finite": finite, "drive": {"tool_top": motion}, "steps": steps}
    p = Problem(mesh, young, [("loose", "base"), ("tool", "loose")], friction or None, **options)
    return p if friction else p.Spring("loose_left", (0, 0), 1e-3 * p.young["loose"])


@problem((1, 0.3, 0), (2, 0.3, 0), (5, 0.3, 0), (20, 0.3, 0), (1, 0.0, 0), (2, 0.0, 0), (5, 0.0, 0),
         (20, 1.5, 0), (2, 1.5, 0), (5, 0.05, 0), (1, 0.3, 1), (2, 0.3, 1), (5, 0.3, 1),
         (20, 0.3, 1), (5, 1.5, 1), (2, 0.0, 1))  # fmt: skip
def ThreeBlocks(steps, friction, finite):
    """The tool starts with a gap and closes it: any number of steps leads to the same state."""
    return Between(Loose(), friction, steps, (0, -0.05), finite=bool(finite))


@problem((2, 1e4, 1.0, 1.0), (5, 1.0, 1e-4, 1.0), (2, 1e-4, 1.0, 1e4), (5, 1e11, 2e5, 2e11))
def ThreeMaterials(steps, *young):
    """The same with bodies of very different stiffness."""
    bodies = dict(zip(("base", "loose", "tool"), young, strict=True))
    return Between(Loose(kind="quad"), 0.3, steps, (0, -0.05), bodies)


@problem((1, 0.01), (2, 0.01), (5, 0.02), (20, 0.0))
def BothGaps(steps, rest):
    """The loose block hangs between base and tool, which touches it first, and is pushed aside."""
    return Between(Loose(rest=rest, gap=0.004), 0.4, steps, (0.01, -0.05))


@problem(0.5, 2.5, 10.0)
def ThreeMeshes(young):
    """Another mesh, by OCC, and other numbers: rounding must not decide."""
    mesh = Sketch(
        Part("base", Plate(-1, -1, 1, 0), 0.3, {"bottom": [(0, -1)], "top": [(0, 0)]}),
        Part("loose", Plate(-0.5, 0, 0.5, 0.6), 0.2, {"bottom": [(0, 0)], "top": [(0, 0.6)]}),
        Part("tool", Plate(-0.4, 0.63, 0.4, 1.13), 0.17,
             {"bottom": [(0, 0.63)], "top": [(0, 1.13)]}),
    )  # fmt: skip
    return Between(mesh, 0.3, 2, (0, -0.05), young)


@problem((1, 0.3, 0), (5, 0.3, 0), (2, 0.3, 1), (1, 0.0, 0), (3, 1.0, 0))
def PushInGap(steps, friction, finite):
    """The tool moves by less than its gap: nothing happens, and that is an answer."""
    return Between(Loose(), friction, steps, (0, -0.02), finite=bool(finite))


@problem((1, 0.3), (5, 0.3), (2, 0.9))
def HeavyInGap(steps, friction):
    """The same; the loose block has a weight, and is as heavy as that at the end."""
    return Between(Loose(), friction, steps, (0, -0.02)).Weight("loose", CF((0, -0.01)))


def Tower(count, friction, gap, steps, force, weight=None, finite=False):
    """Blocks of width 1 and height 0.3 on a base, each held by friction alone, a force on top."""
    blocks = [Block("base", (-0.4, -0.5, 1.4, 0), (9, 3))]
    for k in range(count):
        low, kind = k * (0.3 + gap) + gap, ("quad", "trig")[k % 2]
        blocks.append(Block(f"block{k + 1}", (0, low, 1, low + 0.3), (5 + k % 3, 2), kind))
    pairs = [(above.name, below.name) for below, above in pairwise(blocks)]
    p = Problem(Grids(*blocks), 100.0, pairs, friction, finite, steps=steps)
    for above, _ in pairs if weight else []:
        p.Weight(above, weight)
    return p.Traction(f"block{count}_top", force)


@problem((2, 0.3, 0.0, 1), (3, 0.3, 0.005, 1), (4, 0.6, 0.0, 2), (5, 0.5, 0.002, 5),
         (6, 0.8, 0.0, 1), (3, 0.5, 0.0, 20), (3, 1.5, 0.01, 2), (8, 0.5, 0.0, 2))  # fmt: skip
def Pile(count, friction, gap, steps):
    """A stack with weights from the start, pushed at its top: well within friction and balance."""
    return Tower(count, friction, gap, steps, (0.2 * friction * 0.3, -0.1), CF((0, -1.0)))


@problem((2, 0.3, 1), (3, 0.5, 2), (4, 0.5, 5))
def PileUnderForce(count, friction, steps):
    """A stack without weights: the force on its top holds all of it."""
    return Tower(count, friction, 0.0, steps, (0.05, -1.0))


@problem((2, 0.4, 1), (3, 0.4, 2), (3, 0.8, 5))
def LargePile(count, friction, steps):
    """A stack with finite sliding."""
    return Tower(count, friction, 0.0, steps, (0.05, -0.5), (0, -1.0), finite=True)


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


@problem((1, 0.3, 1, 0.0), (2, 0.3, 1, 0.0), (3, 0.3, 2, 0.01), (2, 0.8, 5, 0.02),
         (1, 0.1, 20, 0.005), (2, 0.3, 2, 0.05), (4, 0.2, 1, 0.0))  # fmt: skip
def Chain(count, friction, steps, play):
    """Links with play are pulled by a force: each is held by the shoulders of the one before."""
    parts = []
    for k in range(count + 1):
        x0 = (2.0 - play) * k
        edges = {"head": [(x0 - 1, 0.3), (x0 - 1, -0.3)]} if k else {"wall": [(x0, 0.5)]}
        hook, far = {"hook": [(x0 + 1, 0.35), (x0 + 1, -0.35)]}, {"far": [(x0 + 1.4, 0.7)]}
        edges |= hook if k < count else far
        face = Outline(*Link(x0, k < count, k > 0))
        parts.append(Part(f"link{k}", face, 0.2 * (1 - 0.1 * (k % 3)), edges))
    pairs = [(f"link{k}_head", f"link{k - 1}_hook") for k in range(1, count + 1)]
    p = Problem(Sketch(*parts), 1000.0, pairs, friction, held="link0_wall", steps=steps)
    return p.Traction(f"link{count}_far", (1.0, 0))
