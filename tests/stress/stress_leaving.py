"""Stress set: finite sliding where contact begins or ends within a step.

Bodies leave the end of their master, pressed or with a gap; piles of discs settle; parts touch for
the first time in one call of Solve.
"""

from functools import partial

import numpy as np
from netgen.occ import Circle
from stress_meshes import Disc, Grids, Part, Plate, Sketch
from stress_problem import Moved, Pressed, Problem, problem

# --- past the end of the master ------------------------------------------------------------------


@problem((0.01, 0.0, 12), (0.01, 0.3, 12), (0.01, 0.3, 4), (-0.01, 0.0, 12), (-0.01, 0.3, 4),
         (-0.01, 0.0, 2))  # fmt: skip
def PastTheEnd(depth, friction, steps):
    """A block is drawn off the end of its master, pressed or with a gap: at last all is open."""
    mesh = Grids(upper=((0, 0, 1, 0.5), (9, 4), "quad"), lower=((0, -0.5, 1, 0), (7, 4)))
    drive = {"upper_top": lambda t: (1.2 * Moved(t), -depth * Pressed(t))}
    p = Problem(mesh, 100.0, [("upper", "lower")], friction or None, True,
                drive=drive, path=[(1.0, 1), (2.0, steps)])  # fmt: skip
    return p.Expect("force", lambda p: np.abs(p.contacts[0].Force()).max(), 0.0, 1e-8)


@problem((0.01, 0.0), (0.01, 0.3), (-0.01, 0.0))
def PastTheCorner3D(depth, friction):
    """The same in space, over a corner."""
    mesh = Grids(upper=((0, 0, 0, 1, 1, 0.5), (3, 3, 1)), lower=((0, 0, -0.5, 1, 1, 0), (4, 4, 1)))
    drive = {"upper_top": lambda t: (1.2 * Moved(t), 0.7 * Moved(t), -depth * Pressed(t))}
    p = Problem(mesh, 100.0, [("upper", "lower")], friction or None, True,
                drive=drive, path=[(1.0, 1), (2.0, 6)])  # fmt: skip
    return p.Expect("force", lambda p: np.abs(p.contacts[0].Force()).max(), 0.0, 1e-8)


@problem(0.0, 0.3)
def ThereAndBack(friction):
    """Off the end, and back with the same press: it carries again."""
    mesh = Grids(upper=((0, 0, 1, 0.5), (9, 4), "quad"), lower=((0, -0.5, 1, 0), (7, 4)))
    drive = {"upper_top": lambda t: (1.2 * (Moved(t) - 2 * Moved(t - 1)), -0.005 * Pressed(t))}
    return Problem(mesh, 100.0, [("upper", "lower")], friction or None, True,
                   drive=drive, path=[(1.0, 1), (2.0, 8), (3.0, 8)])  # fmt: skip


# --- piles of discs ------------------------------------------------------------------------------


def Pile(rows, gap, h=0.22):
    """Discs of radius 0.5 in rows above each other in a box; all are `gap` apart."""
    width = rows[0] * (1 + gap) + gap
    box = Plate(-0.6, -0.6, width + 0.6, 1.0 * len(rows) + 0.2)
    box -= Plate(0, 0, width, 1.0 * len(rows) + 1)
    far, walls = [(width / 2, -0.6)], [(0, 0.5), (width, 0.5), (width / 2, 0)]
    parts = [Part("box", box, 0.6, {"walls": walls, "far": far}, {"walls": 1.3 * h})]
    high, low = 0.5 + gap, []
    for row, count in enumerate(rows):
        for k in range(count):
            cx = gap + 0.5 + k * (1 + gap) + (rows[0] - count) * (1 + gap) / 2
            name = f"disc{len(parts) - 1}"
            face = Circle((cx, high), 0.5).Face()
            parts.append(Part(name, face, h * (1 + 0.05 * k), {"round": [(cx, high + 0.5)]}))
            low.append((name, row))
        high += np.sqrt((1 + gap) ** 2 - (1 + gap) ** 2 / 4)
    pairs = [(f"{name}_round", "box_walls") for name, row in low if row == 0]
    for row in range(1, len(rows)):
        below = "|".join(f"{name}_round" for name, other in low if other == row - 1)
        pairs += [(f"{name}_round", below) for name, at in low if at == row]
    return Sketch(*parts, curve=2), pairs, [name for name, _ in low]


@problem((1, 1e-3, 0.3, 0, 0.0), (2, 1e-3, 0.3, 0, 0.0), (3, 1e-3, 0.3, 0, 0.0),
         (1, 0.02, 0.3, 0, 0.0), (1, 1e-3, 0.0, 0, 0.0), (2, 1e-3, 0.0, 0, 0.0),
         (1, 0.02, 0.3, 1, 0.01), (1, 1e-3, 0.3, 1, 0.0), (3, 1e-3, 0.3, 1, 0.0),
         (1, 0.1, 0.3, 1, 1e-3), (2, 1e-3, 0.3, 1, 1e-4))  # fmt: skip
def DiscPile(count, gap, friction, finite, spring):
    """Discs in a box under their weight; the box carries it, but for weak springs."""
    rows = {1: [1], 2: [2], 3: [2, 1]}[count]
    mesh, pairs, names = Pile(rows, gap)
    p = Problem(mesh, 100.0, pairs, friction or None, bool(finite), held="box_far", rough=3e-2)
    for name in names:
        p.Weight(name, (0, -0.1))
        if spring:
            p.Spring(f"{name}_round", (0, 0), spring)
    floor = [k for k, (_, other) in enumerate(pairs) if other == "box_walls"]
    error = 2e-2 + 200 * spring * gap
    return p.Expect("weight", lambda p: sum(p.contacts[k].Force()[1] for k in floor),
                    0.1 * count * np.pi / 4, 0.1 * count * error)  # fmt: skip


# --- the first touch in one call -----------------------------------------------------------------


@problem(10, 20, 40, 100)
def FirstTouch(force):
    """A soft cantilever comes down on a block; one call of Solve."""
    mesh = Grids(beam=((0, 0.05, 100, 4.05), (50, 2), "quad"), block=((78, -10, 82, 0), (3, 4)))
    p = Problem(mesh, 210e3, [("beam", "block")], None, True, nu=0.0, nonlinear=False,
                held="beam_left|block_bottom", once=True)  # fmt: skip
    return p.Traction("beam_right", (0, -force / 4))


@problem((0.0, 0.01), (0.3, 0.01), (0.0, 0.1))
def FirstPress(friction, gap):
    """A disc comes down on a block by a force on its guided top; one call of Solve."""
    disc = partial(Disc, radius=0.5)

    def raised(s, t):
        px, py = disc(s, t)
        return px, py + gap

    mesh = Grids(disc=(raised, (8, 8)), block=((-1, -0.8, 1, 0), (17, 5), "quad"))
    pairs = [("disc_left|disc_bottom|disc_right", "block_top")]
    p = Problem(mesh, 100.0, pairs, friction or None, True, held="block_bottom",
                heldx="disc_top", once=True)  # fmt: skip
    return p.Spring("disc_top", (0, 0), 1e-2).Traction("disc_top", (0, -2.0))
