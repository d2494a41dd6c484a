"""Stress set: problems without solution, each with the words that its error has to say.

A pattern asks for the cause and for the body in any order: `Says("friction", "brick")`.
"""

import numpy as np
from ngsolve import CF, Grad, Id, IfPos, InnerProduct, Trace, Variation, dx, x
from stress_meshes import Block, Block3D, Grids, Grids3D, Rotated
from stress_problem import Lame, Problem, problem

PAIR = [("brick_bottom", "base_top")]
HELD = {"dirichlet": "base_bottom"}
YOUNG = {"brick": 100.0, "base": 100.0}

SLIDES = "friction"
AWAY = "pull|away|lift|leaves|moves off"
FREE = "float|held by nothing|holds it"
COLLAPSE = "limit load .* collapses"


def Says(*patterns):
    """All of the patterns, in any order."""
    return "".join(f"(?=.*(?:{pattern}))" for pattern in patterns)


def Which(number, place):
    """One of several bodies of a material: its number, or the first coordinate of its middle."""
    return rf"\b{number} of|around \({place:.3g}"


def Brick(gap=0.0, friction=0.3, finite=False, steps=1, n=(5, 9), **flags):
    """A brick on a base."""
    mesh = Grids(Block("brick", (0, gap, 1, gap + 0.5), n[0], 2, quads=True),
                 Block("base", (-0.4, -0.8, 1.4, 0), n[1], 4))  # fmt: skip
    law = ({"friction": friction} if friction else {}) | ({"finite": True} if finite else {})
    return Problem(mesh, PAIR, YOUNG, law=law, nonlinear=finite, path=[(1.0, steps)],
                   **{"flags": HELD} | flags)  # fmt: skip


# --- loads beyond friction -----------------------------------------------------------------------


@problem((0.2, 1, 0, 0.0), (0.5, 1, 0, 0.0), (0.2, 5, 0, 0.0), (0.3, 2, 1, 0.0), (0.5, 1, 0, 0.01),
         (1.0, 20, 0, 0.0))  # fmt: skip
def NoSlidesAway(argument):
    """The sideways force exceeds what friction carries, or tips the brick over before that."""
    friction, steps, finite, gap = argument
    p = Brick(gap, friction, bool(finite), steps)
    p.says = Says(SLIDES if friction < 0.77 else "tips over", "brick")
    p.Traction("brick_top", p.load * CF((1.3 * friction, -1.0)))
    return p


@problem(0.2, 0.4)
def NoSlope(friction):
    """A brick on a slope steeper than friction holds."""
    degrees = np.degrees(np.arctan(1.2 * friction))
    mesh = Grids(
        Block("brick", Rotated(lambda s, t: (s, 0.3 * t), degrees), 5, 2),
        Block("base", Rotated(lambda s, t: (-0.5 + 2 * s, -0.5 + 0.5 * t), degrees), 13, 4),
    )
    p = Problem(mesh, PAIR, YOUNG, flags=HELD, law={"friction": friction})
    p.says = Says(SLIDES, "brick")
    p.Weight("brick", p.load * CF((0, -1.0)))
    return p


@problem(0.3)
def NoSlides3D(friction):
    """The same in three dimensions."""
    mesh = Grids3D(Block3D("brick", (0, 0, 0, 1, 1, 0.5), (2, 2, 1)),
                   Block3D("base", (-0.4, -0.3, -0.5, 1.4, 1.3, 0), (3, 4, 1)))  # fmt: skip
    p = Problem(mesh, PAIR, YOUNG, flags=HELD, law={"friction": friction})
    p.says = Says(SLIDES, "brick")
    p.Traction("brick_top", p.load * CF((0.3, 0.25, -1.0)))
    return p


@problem(1, 2)
def NoStackSlides(which):
    """One of the blocks of a stack slides off, the others hold."""
    names = ["base", "first", "second"]
    mesh = Grids(Block("base", (-0.4, -0.8, 1.4, 0), 9, 4), Block("first", (0, 0, 1, 0.3), 5, 2),
                 Block("second", (0, 0.3, 1, 0.6), 6, 2))  # fmt: skip
    pairs = [("first_bottom", "base_top"), ("second_bottom", "first_top")]
    own = {k: {"friction": 0.2 if k + 1 == which else 0.8} for k in range(2)}
    p = Problem(mesh, pairs, dict.fromkeys(names, 100.0), flags=HELD, own=own)
    p.says = Says(SLIDES, names[which])
    p.Traction("second_top", p.load * CF((0.3, -1.0)))
    return p


# --- bodies that are pulled away or not held -----------------------------------------------------


@problem((0.3, 0, 0.0), (0.0, 0, 0.0), (0.5, 1, 0.0), (0.3, 0, 0.01))
def NoPull(argument):
    """A brick is pulled away from its base."""
    friction, finite, gap = argument
    p = Brick(gap, friction, bool(finite))
    p.says = Says(f"{AWAY}|{FREE}", "brick")
    p.Traction("brick_top", p.load * CF((0.0, 0.5)))
    return p


@problem(0.3)
def NoLift(friction):
    """A heavy brick is lifted off by a growing force, in several steps."""
    p = Brick(0.0, friction, steps=5)
    p.says = Says(f"{AWAY}|{FREE}", "brick")
    p.Weight("brick", CF((0, -1.0)))
    p.Traction("brick_top", p.load * CF((0.0, 1.0)))
    return p


@problem(0.5)
def NoTipping(friction):
    """A tall block is tipped over by a force at its top that friction would carry."""
    mesh = Grids(Block("brick", (0, 0, 0.4, 1.6), 3, 7, quads=True),
                 Block("base", (-0.4, -0.8, 0.8, 0), 9, 4))  # fmt: skip
    p = Problem(mesh, PAIR, YOUNG, flags=HELD, law={"friction": friction})
    p.says = Says(f"{FREE}|tip|turn|rotation|{AWAY}", "brick")
    p.Weight("brick", CF((0, -1.0)))
    p.Traction("brick_right", p.load * CF((0.15, 0)))
    return p


@problem(0.0)
def NoFriction(_):
    """Nothing holds a brick sideways, without friction, and a force pushes it there."""
    p = Brick(0.0, 0.0)
    p.says = Says(FREE, "brick", "translation in x")
    p.Traction("brick_top", p.load * CF((0.1, -1.0)))
    return p


@problem(0, 1)
def NoHold(which):
    """Of two bodies of one material one is in no contact: the error tells which."""
    blocks = [Block("brick", (0, 0, 1, 0.5), 5, 2, quads=True),
              Block("brick", (2, 0.8, 3, 1.3), 5, 2, quads=True)]  # fmt: skip
    base = Block("base", (-0.4, -0.8, 1.4, 0), 9, 4)
    mesh = Grids(base, *(blocks if which else blocks[::-1]))
    p = Problem(mesh, PAIR, YOUNG, flags=HELD, law={"friction": 0.3})
    p.says = Says(FREE, "brick", Which(2 if which else 1, 2.5))
    p.Weight("brick", p.load * CF((0, -1.0)))
    return p


@problem((0.3, 3), (0.3, 8))
def NoRowHold(argument):
    """A row of bricks of one material; one is pulled up."""
    friction, count = argument
    lift = count - 1
    blocks = [Block("brick", (1.2 * k, 0, 1.2 * k + 1, 0.5), 4, 2) for k in range(count)]
    mesh = Grids(Block("base", (-0.4, -0.8, 1.2 * count, 0), 4 * count + 1, 3), *blocks)
    p = Problem(mesh, PAIR, YOUNG, flags=HELD, law={"friction": friction})
    p.says = Says(f"{AWAY}|{FREE}", "brick", Which(count, 1.2 * lift + 0.5))
    p.Weight("brick", CF((0, p.load * IfPos(x - 1.2 * lift + 0.1, 1.0, -1.0))))
    return p


@problem()
def NoSupport():
    """Nothing is clamped at all."""
    p = Brick(flags={})
    p.says = Says(FREE, "base|brick")
    p.Traction("brick_top", p.load * CF((0, -1.0)))
    return p


# --- meshes that do not fit ----------------------------------------------------------------------


@problem("side", "above", "back")
def NoMeeting(kind):
    """Surfaces that never meet: beside each other, out of reach, and looking the same way."""
    place = {"side": (3, 0, 4, 0.5), "above": (0, 5.0, 1, 5.5), "back": (0, 0.0, 1, 0.5)}[kind]
    mesh = Grids(Block("brick", place, 5, 2), Block("base", (-0.4, -0.8, 1.4, 0), 9, 4))
    slave = "brick_top" if kind == "back" else "brick_bottom"
    law = {"friction": 0.3} | ({"maxdist": 1.0} if kind == "above" else {})
    p = Problem(mesh, [(slave, "base_top")], YOUNG, flags=HELD, law=law)
    p.says = "never meet"
    p.Traction("brick_top" if kind != "back" else "brick_bottom", p.load * CF((0, -1.0)))
    return p


@problem((0.15, 0), (0.3, 0), (0.2, 1))
def NoOverlap(argument):
    """Bodies overlap by more than a tenth of the slave's diameter: the option is named."""
    depth, finite = argument
    p = Brick(-depth, 0.3, bool(finite))
    p.says = "penetration"
    p.Traction("brick_top", p.load * CF((0, -1.0)))
    return p


# --- collapse ------------------------------------------------------------------------------------


def Crushed(p, body):
    """Saint Venant and Kirchhoff's material, which carries no more than a certain pressure."""
    mu, lame = Lame(p.young[body], p.nu)
    F = Id(p.mesh.dim) + Grad(p.u)
    E = 0.5 * (F.trans * F - Id(p.mesh.dim))
    p.a += Variation((mu * InnerProduct(E, E) + lame / 2 * Trace(E) ** 2).Compile() * dx(body))


@problem((1, 0), (5, 0), (2, 1))
def NoCrush(argument):
    """A force beyond the largest that a softening brick can carry."""
    steps, finite = argument
    mesh = Grids(Block("brick", (0, 0, 1, 0.5), 5, 3, quads=True),
                 Block("base", (-0.4, -0.8, 1.4, 0), 9, 4))  # fmt: skip
    # With friction the slip of macro-elements crushed by a third depends on how it is averaged.
    law = {"finite": True} if finite else {"friction": 0.3}
    p = Problem(mesh, PAIR, {"base": 1e4}, flags=HELD | {"dirichletx": "brick_top"}, law=law,
                path=[(1.0, steps)])  # fmt: skip
    p.young["brick"] = 100.0
    Crushed(p, "brick")
    p.says = Says(COLLAPSE, "brick")
    p.Traction("brick_top", p.load * CF((0, -60.0)))
    return p


@problem(1, 4)
def NoArch(steps):
    """A shallow arch of a material that softens snaps under a force, and finds nothing below."""

    def arch(s, t):
        px = 4 * s - 2
        return px, 0.5 * (1 - (px / 2) ** 2) + 0.08 * t

    mesh = Grids(Block("arch", arch, 20, 1, quads=True),
                 Block("tool", (-0.3, 0.59, 0.3, 0.9), 5, 3))  # fmt: skip
    p = Problem(mesh, [("tool_bottom", "arch_top")], {"tool": 1e4}, law={"friction": 0.3},
                flags={"dirichlet": "arch_left|arch_right", "dirichletx": "tool_top"},
                path=[(1.0, steps)])  # fmt: skip
    p.young["arch"] = 100.0
    Crushed(p, "arch")
    p.says = Says(COLLAPSE, "arch")
    p.Traction("tool_top", p.load * CF((0, -60.0)))
    return p
