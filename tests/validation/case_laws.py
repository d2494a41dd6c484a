"""Laws as expressions: a double cantilever beam, wear of a rod, friction that falls with speed."""

from __future__ import annotations

from functools import cache

import numpy as np
from netgen.occ import Box, Compound, Glue, MoveTo, OCCGeometry, Rectangle, Y, Z
from ngsolve import (
    CF,
    GridFunction,
    IfPos,
    InnerProduct,
    Integrate,
    Mesh,
    Norm,
    Parameter,
    VectorH1,
    dx,
    exp,
)
from posed import elastic, posed
from report_bounds import Neglected, Step, Tolerance
from report_case import Case, Outcome, Row
from report_pictures import INK, ORANGE, Figure

from ngslac import Law, LoadStepper, TimeStepper, tools
from ngslac.meshes import TwoBlocks

# --- double cantilever beam ----------------------------------------------------------------------

WIDTH, YOUNG, TOUGHNESS, CRACK, ARM, LENGTH = 20.0, 135.3e3, 0.28, 30.0, 1.5, 100.0
STIFFNESS, STRENGTH = 1e5, 30.0  # of the glue, N/mm3 and MPa
INERTIA = WIDTH * ARM**3 / 12


def Softening(opening):
    """Force of beam theory while the crack grows."""
    energy = (WIDTH * YOUNG * INERTIA * TOUGHNESS) ** 1.5
    return np.sqrt(2 * energy / (3 * YOUNG * INERTIA * opening))


def Glued(fields):
    """Bilinear: damage by opening alone, full stiffness under pressure; energy per area 0.28."""
    first, last = STRENGTH / STIFFNESS, 2 * TOUGHNESS / STRENGTH
    opening = -InnerProduct(fields.jump, fields.normal)
    apart = IfPos(opening, opening, 0)
    far = fields.History("far", lambda f: IfPos(apart - f, apart, f), start=first)
    whole = IfPos(last - far, first / far * (last - far) / (last - first), 0)
    pressed = (1 - whole) * IfPos(opening, 0, opening) * fields.normal
    return -WIDTH * STIFFNESS * (whole * fields.jump - pressed)


def Beams(h):
    """Two arms, meshed apart and moved together; the crack is the part without glue."""
    arms = []
    for name, start, touches in (("lower", -ARM, "master"), ("upper", 1.0, "slave")):
        parts = (MoveTo(0, start).Rectangle(CRACK, ARM), MoveTo(CRACK, start))
        body = Glue([parts[0].Face(), parts[1].Rectangle(LENGTH - CRACK, ARM).Face()])
        level = 0.0 if name == "lower" else 1.0
        for edge in body.edges:
            at = edge.center
            edge.name = "side"
            if abs(at.y - level) < 1e-9:
                edge.name = touches if at.x > CRACK else f"crack_{name}"
                edge.maxh = h if name == "upper" else 1.17 * h
            elif abs(at.x) < 1e-9 or abs(at.x - LENGTH) < 1e-9:
                edge.name = f"{'tip' if at.x < 1 else 'end'}_{name}"
        arms.append(body)
    ngmesh = OCCGeometry(Compound(arms), dim=2).GenerateMesh(maxh=1.0)
    for vertex in ngmesh.Points():
        vertex[1] -= vertex[1] > 0.5
    return Mesh(ngmesh)


@cache
def Peeled(h, steps):
    """Openings and forces up to 8 mm."""
    V = VectorH1(Beams(h), order=2, dirichlet="end_lower", dirichlety="tip_.*")
    opening = Parameter(0)
    problem = posed(V, elastic(WIDTH * YOUNG), load=opening, tied=True, law=Law(Glued))
    ends = {"tip_upper": CF((0, opening / 2)), "tip_lower": CF((0, -opening / 2))}
    stepper = problem.stepper(prescribe=ends | {"end_lower": CF((0, 0))})
    a, gf, lift = problem.a, problem.gf, GridFunction(problem.X)
    force = gf.vec.CreateVector()
    lift.components[0].Set((0, 1), definedon=V.mesh.Boundaries("tip_upper"))
    openings, forces = np.linspace(0, 8, steps + 1)[1:], []
    for goal in openings:
        stepper.Integrate(goal, steps=1, printing=False)
        a.Apply(gf.vec, force)
        forces.append(InnerProduct(force, lift.vec))
    return openings, np.array(forces)


def Cantilever(quick):
    openings, forces = Peeled(0.3, 20 if quick else 40)
    rows = []
    for goal in (4.0, 6.0, 8.0):
        found = forces[np.argmin(np.abs(openings - goal))]
        bound = Neglected(0.02, "arm over crack .05 to .03, glue that gives way")
        rows.append(Row(f"force at an opening of {goal:g} mm [N]", found, Softening(goal), bound))
    rows.append(Row("largest force [N]", forces.max(), 68.815))

    def Draw(ax):
        growing = np.linspace(1.6276, 8, 200)
        linear = 3 * YOUNG * INERTIA / (2 * CRACK**3)
        ax.plot([0, 1.6276, *growing], [0, linear * 1.6276, *Softening(growing)], color=INK,
                lw=0.8, label="beam theory")  # fmt: skip
        ax.plot([0, *openings], [0, *forces], "o-", ms=3, color=ORANGE, label="computed")
        ax.set(xlabel="opening [mm]", ylabel="force [N]")
        ax.legend()

    caption = "Force over the opening: the largest one is that of a crack whose root turns."
    return Outcome(rows, Figure(Draw, size=(6, 3.4)), caption)


# --- wear, and friction that falls with speed ----------------------------------------------------


def Bar(young, *, density=None, held="bottom|top", mesh=0.25, weight=0.0, **law):
    """Two blocks with nu = 0, of height 1 each, and their contact."""
    mesh = TwoBlocks(mesh)
    V = VectorH1(mesh, order=2, dirichlet=held)
    return posed(V, elastic(young), lambda u, v, load: weight * v[1] * dx("upper"), **law).solver()


def Worn(steps):
    """Pressures as the upper bar slides by 1/2; at first the pressure is 1."""
    rate, way, load = 0.02, 0.5, Parameter(0)

    def Offset(z):
        return z.History("worn", lambda w: w + rate * z.pressure * Norm(z.slip))

    solver = Bar(100.0, offset=Offset)
    held = {"top": CF((load, -0.02)), "bottom": CF((0, 0))}
    stepper, pressures = LoadStepper(solver, load, prescribe=held), []
    for goal in np.linspace(0, way, steps + 1)[1:]:
        stepper.Integrate(goal, steps=1, printing=False)
        pressures.append(solver.contacts[0].Table()["pressure"].mean())
    return np.array(pressures)


def Braked(dt):
    """Velocities of a block that slides with friction .2 + .2 exp(-v), from 2 on."""
    solver = Bar(1e6, held="bottom", mesh=0.5, weight=9.81,
                 friction=lambda z: 0.2 + 0.2 * exp(-Norm(z.rate)))  # fmt: skip
    stepper = TimeStepper(solver, 1.0, dt=dt, rho_inf=0.5)
    mesh, speed = solver.contacts[0].mesh, stepper.velocity.components[0]
    speed.Set((2, 0), definedon=mesh.Materials("upper"))
    times, found = np.arange(1, 9) * 0.1, []
    for time in times:
        stepper.Integrate(time, printing=False)
        found.append(speed(mesh(0.5, 0.5))[0])
    return times, np.array(found)


def Histories(quick):
    steps = 5 if quick else 20
    pressures, factor = Worn(steps), 1 + 100 * 0.02 * 0.5 / steps / 2
    euler = factor ** -np.arange(1, steps + 1)
    rows = [Row("wear: pressure against implicit Euler's, largest difference",
                np.abs(pressures - euler).max(), 0, Tolerance(1e-8))]  # fmt: skip
    step = Step(0.5 * 0.25 / steps, "one step of the implicit Euler method, first order")
    rows.append(Row("wear: last pressure over the first one", pressures[-1], np.exp(-0.5), step))
    times, speeds = Braked(0.02 if quick else 0.01)
    low, gravity = 0.2, 9.81
    start = low * np.exp(2) + 0.2  # closed form of dv/dt = -g (low + .2 exp(-v))
    exact = np.log((start * np.exp(-gravity * low * times) - 0.2).clip(low) / low)
    for k in (2, 4):
        bound = Step(0.03, "steps of .01, elastic vibrations")
        rows.append(Row(f"speed after {times[k]:.1f} s", speeds[k], exact[k], bound))
    rest = Step(0.03 * 2, "the same, over the first speed", kind="absolute")
    rows.append(Row(f"speed after {times[7]:.1f} s", speeds[7], exact[7], rest))

    def Draw(*axes):
        ways = np.linspace(0, 0.5, steps + 1)
        axes[0].plot(ways, np.exp(-ways), color=INK, lw=0.8, label="exp(-E k s/L)")
        axes[0].plot(ways[1:], pressures, "o", ms=4, color=ORANGE, label="computed")
        axes[0].set(xlabel="way s", ylabel="pressure over the first one")
        axes[1].plot(times, exact, color=INK, lw=0.8, label="closed form")
        axes[1].plot(times, speeds, "o", ms=4, color=ORANGE, label="computed")
        axes[1].set(xlabel="time [s]", ylabel="speed [m/s]")
        for ax in axes:
            ax.legend()

    caption = "Left: a rod that wears between fixed ends. Right: a block that friction stops."
    return Outcome(rows, Figure(Draw, columns=2), caption)


# --- static and kinetic friction ------------------------------------------------------------------

LOAD, SPRING, BELT, STATIC, KINETIC = 10.0, 100.0, 0.01, 0.4, 0.3  # of a mass of 1


def OnBelt(fall, end):
    """Times and forces of a spring that holds a block on a belt; friction falls within `fall`."""
    block = Rectangle(1, 0.5).Face().Move((-0.5, 0, 0))
    block.edges.name = "free"
    block.edges.Min(Y).name = "slave"
    mesh = Mesh(OCCGeometry(block, dim=2).GenerateMesh(maxh=0.5))
    V = VectorH1(mesh, order=2)
    time = Parameter(0)
    belt = tools.Plane((0, 0), (0, 1)).Moved(shift=(BELT * time, 0))

    def Loads(u, v, load):
        return 2 * LOAD * v[1] * dx + 2 * SPRING * (u[0] + 0.02) * v[0] * dx

    def Friction(z):
        return KINETIC + (STATIC - KINETIC) * exp(-Norm(z.rate) / fall)

    law = {"obstacle": belt, "finite": True, "friction": Friction}
    solver = posed(V, elastic(1e6, 0.3), Loads, **law).solver()
    stepper = TimeStepper(solver, 2.0, dt=0.005, rho_inf=0.5, time=time)
    stepper.velocity.components[0].Set((BELT, 0))
    rows = []

    def Keep(step):
        way = 2 * Integrate(solver.gf.components[0][0], mesh)
        rows.append((step.time, SPRING * (way + 0.02)))

    while time.Get() < end - 1e-9:
        slow = not rows or (rows[-1][1] < 3.95 and time.Get() < 1.9)
        stepper.dt = 0.05 if slow else 0.005
        stepper.Integrate(time.Get() + stepper.dt, printing=False, callback=Keep)
    return np.array(rows).T


def StickSlip(quick):
    times, forces = OnBelt(0.02 if quick else 0.005, 2.6)
    swing, omega = (STATIC - KINETIC) * LOAD / SPRING, np.sqrt(SPRING)
    reach = SPRING * np.hypot(swing, BELT / omega)
    lasts = (2 * np.pi - 2 * np.arctan(swing * omega / BELT)) / omega
    before, after = np.argmax(forces), np.argmin(forces[1:]) + 1
    fall = Neglected(0.03, "friction that falls within .005 (quick: .02), not at once; steps")
    rows = [
        Row("largest force [N]", forces[before], KINETIC * LOAD + reach, fall),
        Row("least force [N]", forces[after], KINETIC * LOAD - reach, fall),
    ]
    took = times[after] - times[before]
    # From the largest force to the least one is half a period of the oscillator.
    rows.append(Row("time in between [s]", took, np.pi / omega, Step(0.1, "the fall, 5 ms steps")))

    def Draw(ax):
        ax.plot(times, forces, ".-", ms=3, color=ORANGE, label="computed")
        for level in (KINETIC * LOAD + reach, KINETIC * LOAD - reach):
            ax.axhline(level, color=INK, lw=0.8)
        ax.set(xlabel="time [s]", ylabel="force of the spring [N]")

    caption = f"The block sticks, slips for {lasts:.3f} s and sticks again; lines: closed form."
    return Outcome(rows, Figure(Draw, size=(6, 3.4)), caption)


# --- friction with a grain ------------------------------------------------------------------------

GRAIN = (0.1, 0.3)


def Grained(z):
    """Within an ellipse, and slip along its normal: Coulomb's law in stretched coordinates."""
    pressure, size = -InnerProduct(z.trial, z.normal), z.c / max(GRAIN) ** 2
    now = z.trial + z.c * z.slip
    y = CF(tuple(now[i] / mu - size * mu * z.slip[i] for i, mu in enumerate(GRAIN)))
    part = IfPos(Norm(y) - pressure, pressure / Norm(y), 1)
    friction = CF((GRAIN[0] * part * y[0], GRAIN[1] * part * y[1], 0))
    return IfPos(pressure, friction - pressure * z.normal, 0 * z.normal)


def Rule(angle):
    """Friction over the normal force, for a direction of slip (degrees)."""
    way = np.array([np.cos(np.radians(angle)), np.sin(np.radians(angle))])
    weighted = np.array(GRAIN) ** 2 * way
    return weighted / np.sqrt(weighted @ way)


def Dragged(angles, finite):
    """Friction over the normal force of a block that is dragged to angles (degrees)."""
    block = Box((-0.5, -0.5, 0), (0.5, 0.5, 0.5))
    block.faces.name = "free"
    block.faces.Min(Z).name, block.faces.Max(Z).name = "slave", "top"
    V = VectorH1(Mesh(OCCGeometry(block).GenerateMesh(maxh=0.34)), order=2, dirichlet="top")
    floor = {"obstacle": tools.Plane((0, 0, 0), (0, 0, 1)), "finite": True}
    law = {"law": Law(Grained)} | (floor if finite else {"obstacle": 0.0})
    found = []
    for angle in np.radians(angles):
        load = Parameter(0)
        problem = posed(V, elastic(1e4), load=load, **law)
        away = 0.1 * IfPos(load - 1, load - 1, 0)
        path = (away * np.cos(angle), away * np.sin(angle), -1e-4 * IfPos(load - 1, 1, load))
        stepper = problem.stepper(prescribe={"top": CF(path)})
        stepper.Integrate(1, steps=1, printing=False)
        stepper.Integrate(2, steps=4, printing=False)
        force = problem.contact.Force()
        found.append(-force[:2] / force[2])
    return np.array(found)


def Grain(quick):
    angles = (30, 60) if quick else (6.34019, 20, 45, 70)
    rows, found = [], {}
    for finite in (False, True):
        found[finite] = Dragged(angles, finite)
        kind = "large" if finite else "small"
        for angle, friction in zip(angles, found[finite], strict=True):
            elastic = Neglected(1e-8, "shear of the block across its way", kind="absolute")
            names = zip(("along", "across"), friction, Rule(angle), strict=True)
            rows += [
                Row(f"{kind} sliding to {angle:g} degrees: {name} the grain", *pair, elastic)
                for name, *pair in names
            ]

    def Draw(ax):
        turn = np.linspace(0, np.pi / 2, 200)
        ax.plot(GRAIN[0] * np.cos(turn), GRAIN[1] * np.sin(turn), color=INK, lw=0.8)
        ax.plot(*found[False].T, "o", ms=4, color=ORANGE)
        ax.set(xlabel="along the grain", ylabel="across", aspect="equal")

    caption = "Friction over the normal force (dots), and the ellipse of the coefficients."
    return Outcome(rows, Figure(Draw, size=(3.4, 3.4)), caption)


CASES = [
    Case(
        "cantilever",
        "A double cantilever beam is peeled",
        "Two arms of 1.5 mm, glued beyond a crack of 30 mm, are pulled apart: the glue is a "
        "bilinear law with damage, written as an expression, of a toughness of .28 N/mm.",
        "Beam theory; data of Alfano and Crisfield (2001).",
        "pytest tests/validation/test_cases.py -k cantilever",
        Cantilever,
    ),
    Case(
        "histories",
        "Wear, and friction that falls with speed",
        "A rod that slides between fixed ends wears by Archard's law; a block slides on a plane "
        "with friction .2 + .2 exp(-v).",
        "Closed forms: p = p0 exp(-E k s/L); dv/dt = -g (.2 + .2 exp(-v)).",
        "pytest tests/validation/test_cases.py -k histories",
        Histories,
    ),
    Case(
        "stick-slip",
        "A block sticks and slips on a belt",
        "A spring holds a block on a belt of .01 m/s. Friction is .4 at rest and falls to .3 with "
        "the speed of slip.",
        "The oscillator that starts with the velocity of the belt.",
        "pytest tests/validation/test_cases.py -k stick-slip",
        StickSlip,
    ),
    Case(
        "grain",
        "Friction that depends on the direction",
        "A block is dragged over a floor with the coefficients .1 along and .3 across a grain; "
        "friction is not opposite to the slip. The law is an expression of six lines.",
        "The associated rule: T_i = -mu_i^2 N d_i / |(mu_1 d_1, mu_2 d_2)|.",
        "pytest tests/validation/test_cases.py -k grain",
        Grain,
    ),
]
