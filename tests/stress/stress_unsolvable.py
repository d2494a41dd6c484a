"""Stress set: problems without solution, each with the words that its error has to say.

A pattern asks for the cause and for the body in any order: `Says("friction", "brick")`.
"""

import numpy as np
from ngsolve import CF, Grad, Id, IfPos, InnerProduct, Trace, Variation, dx, x
from stress_meshes import Block, Grids, Rotated
from stress_problem import Lame, Problem, problem

PAIR = [("brick", "base")]
BASE = ((-0.4, -0.8, 1.4, 0), (9, 4))

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


def Brick(says, gap=0.0, friction=0.3, finite=False, **options):
    """A brick on a base."""
    mesh = Grids(brick=((0, gap, 1, gap + 0.5), (5, 2), "quad"), base=BASE)
    return Problem(mesh, 100.0, PAIR, friction or None, bool(finite), says=says, **options)


def TallBrick(says, friction, **options):
    """A tall and heavy block, with a force at its top."""
    mesh = Grids(brick=((0, 0, 0.4, 1.6), (3, 7), "quad"), base=((-0.4, -0.8, 0.8, 0), (9, 4)))
    p = Problem(mesh, 100.0, PAIR, friction, says=says, **options)
    return p.Weight("brick", CF((0, -1.0))).Traction("brick_right", (0.15, 0))


# --- loads beyond friction -----------------------------------------------------------------------


@problem((0.2, 1, 0, 0.0), (0.5, 1, 0, 0.0), (0.2, 5, 0, 0.0), (0.3, 2, 1, 0.0), (0.5, 1, 0, 0.01),
         (1.0, 20, 0, 0.0))  # fmt: skip
def NoSlidesAway(friction, steps, finite, gap):
    """The sideways force exceeds what friction carries, or tips the brick over before that."""
    says = Says(SLIDES if friction < 0.77 else "tips over", "brick")
    p = Brick(says, gap, friction, finite, steps=steps)
    return p.Traction("brick_top", (1.3 * friction, -1.0))


@problem(0.2, 0.4)
def NoSlope(friction):
    """A brick on a slope steeper than friction holds."""
    degrees = np.degrees(np.arctan(1.2 * friction))
    mesh = Grids(
        brick=(Rotated(lambda s, t: (s, 0.3 * t), degrees), (5, 2)),
        base=(Rotated(lambda s, t: (-0.5 + 2 * s, -0.5 + 0.5 * t), degrees), (13, 4)),
    )
    p = Problem(mesh, 100.0, PAIR, friction, says=Says(SLIDES, "brick"))
    return p.Weight("brick", (0, -1.0))


@problem(0.3)
def NoSlides3D(friction):
    """The same in three dimensions."""
    base = ((-0.4, -0.3, -0.5, 1.4, 1.3, 0), (3, 4, 1))
    mesh = Grids(brick=((0, 0, 0, 1, 1, 0.5), (2, 2, 1)), base=base)
    p = Problem(mesh, 100.0, PAIR, friction, says=Says(SLIDES, "brick"))
    return p.Traction("brick_top", (0.3, 0.25, -1.0))


@problem(1, 2)
def NoStackSlides(which):
    """One of the blocks of a stack slides off, the others hold."""
    mesh = Grids(base=BASE, first=((0, 0, 1, 0.3), (5, 2)), second=((0, 0.3, 1, 0.6), (6, 2)))
    pairs = [("first", "base"), ("second", "first")]
    says = Says(SLIDES, pairs[which - 1][0])
    own = {k: {"friction": 0.2 if k + 1 == which else 0.8} for k in range(2)}
    return Problem(mesh, 100.0, pairs, own=own, says=says).Traction("second_top", (0.3, -1.0))


# --- bodies that are pulled away or not held -----------------------------------------------------


@problem((0.3, 0, 0.0), (0.0, 0, 0.0), (0.5, 1, 0.0), (0.3, 0, 0.01))
def NoPull(friction, finite, gap):
    """A brick is pulled away from its base."""
    p = Brick(Says(f"{AWAY}|{FREE}", "brick"), gap, friction, finite)
    return p.Traction("brick_top", (0.0, 0.5))


@problem(0.3)
def NoLift(friction):
    """A heavy brick is lifted off by a growing force, in several steps."""
    p = Brick(Says(f"{AWAY}|{FREE}", "brick"), friction=friction, steps=5)
    return p.Weight("brick", CF((0, -1.0))).Traction("brick_top", (0.0, 1.0))


@problem(0.5)
def NoTipping(friction):
    """A tall block is tipped over by a force at its top that friction would carry."""
    return TallBrick(Says(f"{FREE}|tip|turn|rotation|{AWAY}", "brick"), friction)


@problem(0.0)
def NoFriction(friction):
    """Nothing holds a brick sideways, without friction, and a force pushes it there."""
    p = Brick(Says(FREE, "brick", "translation in x"), friction=friction)
    return p.Traction("brick_top", (0.1, -1.0))


@problem(0, 1)
def NoHold(which):
    """Of two bodies of one material one is in no contact: the error tells which."""
    places = [(0, 0, 1, 0.5), (2, 0.8, 3, 1.3)]
    blocks = [Block("brick", place, (5, 2), "quad") for place in places]
    mesh = Grids(Block("base", *BASE), *(blocks if which else blocks[::-1]))
    says = Says(FREE, "brick", Which(2 if which else 1, 2.5))
    return Problem(mesh, 100.0, PAIR, 0.3, says=says).Weight("brick", (0, -1.0))


@problem((0.3, 3), (0.3, 8))
def NoRowHold(friction, count):
    """A row of bricks of one material; one is pulled up."""
    lift = count - 1
    blocks = [Block("brick", (1.2 * k, 0, 1.2 * k + 1, 0.5), (4, 2)) for k in range(count)]
    base = Block("base", (-0.4, -0.8, 1.2 * count, 0), (4 * count + 1, 3))
    says = Says(f"{AWAY}|{FREE}", "brick", Which(count, 1.2 * lift + 0.5))
    p = Problem(Grids(base, *blocks), 100.0, PAIR, friction, says=says)
    return p.Weight("brick", (0, IfPos(x - 1.2 * lift + 0.1, 1.0, -1.0)))


@problem()
def NoSupport():
    """Nothing is clamped at all."""
    return Brick(Says(FREE, "base|brick"), held="").Traction("brick_top", (0, -1.0))


# --- meshes that do not fit ----------------------------------------------------------------------


@problem("side", "above", "back")
def NoMeeting(kind):
    """Surfaces that never meet: beside each other, out of reach, and looking the same way."""
    place = {"side": (3, 0, 4, 0.5), "above": (0, 5.0, 1, 5.5), "back": (0, 0.0, 1, 0.5)}[kind]
    slave, loaded = "brick_bottom", "brick_top"
    if kind == "back":
        slave, loaded = loaded, slave
    law = {"maxdist": 1.0} if kind == "above" else {}
    mesh, pairs = Grids(brick=(place, (5, 2)), base=BASE), [(slave, "base_top")]
    p = Problem(mesh, 100.0, pairs, 0.3, law=law, says="never meet")
    return p.Traction(loaded, (0, -1.0))


@problem((0.15, 0), (0.3, 0), (0.2, 1))
def NoOverlap(depth, finite):
    """Bodies overlap by more than a tenth of the slave's diameter: the option is named."""
    return Brick("penetration", -depth, finite=finite).Traction("brick_top", (0, -1.0))


# --- collapse ------------------------------------------------------------------------------------


def Crushed(p, body):
    """Saint Venant and Kirchhoff's material, which carries no more than a certain pressure."""
    p.young[body] = 100.0
    mu, lame = Lame(p.young[body], p.nu)
    F = Id(p.mesh.dim) + Grad(p.u)
    E = 0.5 * (F.trans * F - Id(p.mesh.dim))
    p.a += Variation((mu * InnerProduct(E, E) + lame / 2 * Trace(E) ** 2).Compile() * dx(body))
    return p


@problem((1, 0), (5, 0), (2, 1))
def NoCrush(steps, finite):
    """A force beyond the largest that a softening brick can carry."""
    mesh = Grids(brick=((0, 0, 1, 0.5), (5, 3), "quad"), base=BASE)
    # With friction the slip of macro-elements crushed by a third depends on how it is averaged.
    options = {"friction": None if finite else 0.3, "finite": bool(finite), "nonlinear": False}
    options |= {"heldx": "brick_top", "steps": steps, "says": Says(COLLAPSE, "brick")}
    p = Crushed(Problem(mesh, {"base": 1e4}, PAIR, **options), "brick")
    return p.Traction("brick_top", (0, -60.0))


@problem(1, 4)
def NoArch(steps):
    """A shallow arch of a material that softens snaps under a force, and finds nothing below."""

    def arch(s, t):
        px = 4 * s - 2
        return px, 0.5 * (1 - (px / 2) ** 2) + 0.08 * t

    tool = (-0.3, 0.59, 0.3, 0.9)
    mesh = Grids(arch=(arch, (20, 1), "quad"), tool=(tool, (5, 3)))
    options = {"held": "arch_left|arch_right", "heldx": "tool_top", "steps": steps}
    options |= {"says": Says(COLLAPSE, "arch")}
    p = Problem(mesh, {"tool": 1e4}, [("tool", "arch")], 0.3, **options)
    return Crushed(p, "arch").Traction("tool_top", (0, -60.0))
