"""Carter's problem: two equal rollers on each other, one of them turns a little faster.

Plane strain, neo-Hookean, large rotations. The rollers touch along a width 2a that is small against
their radii; friction holds near the leading edge, where the surfaces come in, and slips behind. In
units of a, of Hertz' XX::

    python tutorials/examples/carter.py --out results

Compared with F. W. Carter, Proc. R. Soc. Lond. A 112 (1926) 151-157, as in K. L. Johnson, Contact
Mechanics (1985), section 8.3: half-planes with the creep (mu a/R) (1 - sqrt(1 - Q/(mu P))), and a
stick zone at the leading edge of the width 2a sqrt(1 - Q/(mu P)).
"""

import math

import numpy as np
from command import Main
from ngsolve import *
from pictures import Curves, Show

from ngslac import *
from ngslac.materials import NeoHooke
from ngslac.meshes import geometry
from ngslac.reference import HertzLine

RADIUS = 80.0  # of both rollers
DEPTH, SIDE = 15.0, 12.0  # from the surface to the hub; what is meshed on both sides
YOUNG, NU, FRICTION = 1.0, 0.3, 0.3
AROUND = 1.6  # of the middle of the contact, where the mesh is fine
SHARES = (0.25, 0.5, 0.75)


def Roller(name, side, way, h):
    """The part that matters of the roller above (side = 1) or below the origin (-1)."""
    ends = [-(way + AROUND + SIDE), -(way + AROUND), AROUND, AROUND + SIDE]
    angles = [end / RADIUS for end in ends]

    def At(radius):  # what comes in by rolling is at x < 0
        return lambda angle: (radius * math.sin(angle), side * (RADIUS - radius * math.cos(angle)))

    outer, inner = At(RADIUS), At(RADIUS - DEPTH)
    sides = [
        geometry.Arc(outer, *angles[:2], "free"),
        geometry.Arc(outer, *angles[1:3], name, geometry.Divisions(way + 2 * AROUND, h)),
        geometry.Arc(outer, *angles[2:], "free"),
        geometry.Line(outer(angles[3]), inner(angles[3]), "free"),
        geometry.Arc(inner, angles[3], angles[0], f"hub_{name}"),
        geometry.Line(inner(angles[0]), outer(angles[0]), "free"),
    ]
    return geometry.Body(sides, name)


def Solve(share, h, way, start=1.0):
    """Rollers with the creep that belongs to a share, pressed, wound up, and rolled by a way."""
    bodies = [Roller("upper", 1, way, h), Roller("lower", -1, way, 1.13 * h)]
    mesh = geometry.GenerateMesh(bodies, order=2, maxh=DEPTH / 4, grading=0.3)
    V = VectorH1(mesh, order=2, dirichlet="hub_.*")
    X = V * LACSpace(V, slave="upper")
    u, lam = X.TrialFunction()
    a, gf = BilinearForm(X), GridFunction(X)
    a += Variation(NeoHooke(Id(2) + Grad(u), YOUNG, NU).Compile() * dx)
    contact = LACContact(u, lam, master="lower", finite=True, friction=FRICTION)
    solver = ContactSolver(a, gf, contact)
    creep = FRICTION / (RADIUS / 2) * (1 - math.sqrt(1 - share))
    down, wound, rolled = Parameter(0), Parameter(0), Parameter(0)

    def Hub(side):
        """Moved by half of the way down, and turned."""
        angle = (side * rolled + (creep * rolled + wound) / 2) / RADIUS
        below = y - side * RADIUS  # from the axis
        turned = cos(angle) * x - sin(angle) * below, sin(angle) * x + cos(angle) * below
        return CF((turned[0] - x, turned[1] - below - side * down / 2))

    hubs, rows = {"hub_upper": Hub(1), "hub_lower": Hub(-1)}, []

    def Go(parameter, end, steps, callback=None):
        stepper = LoadStepper(solver, parameter, prescribe=hubs)
        stepper.Integrate(end, steps=steps, printing=False, callback=callback)

    def Taken():
        """Tangential force over what friction can carry."""
        along, force = contact.Force()
        return -float(along / force) / FRICTION

    # Until the contact is about 2 wide.
    approach = 1.1 * (2 * math.log(2 * DEPTH) - NU / (1 - NU)) / (2 * RADIUS)
    Go(down, approach, 4)
    # Creep alone would take a way of 10 a until friction takes this share: the rollers are soft.
    first = FRICTION * start * share * approach
    Go(wound, first, 1)
    Go(wound, first * start * share / Taken(), 1)
    softness = wound.Get() / Taken()
    Go(rolled, way, math.ceil(way / h), lambda step: rows.append((step.time, Taken())))

    # Means of the second half of the way; what still winds the rollers up is no creep.
    ways, shares = np.transpose(rows)
    late = ways > ways[-1] / 2 - 1e-9
    creep -= softness * np.polyfit(ways[late], shares[late], 1)[0]
    bodies = {"young1": YOUNG, "young2": YOUNG, "nu1": NU, "nu2": NU}
    force = float(contact.Force()[1])
    hertz = HertzLine(force=force, radius1=RADIUS, radius2=RADIUS, **bodies)
    taken = min(creep * RADIUS / 2 / (FRICTION * hertz.halfwidth), 1.0)
    table = contact.Table()
    closed = table["status"] > 0
    place, pressure = table["x"][closed, 0] / hertz.halfwidth, table["pressure"][closed]
    traction = -table["traction"][closed, 0] - pressure * table["normal"][closed, 0]
    figures = {"creep": creep, "share": float(shares[late].mean())}
    figures |= {"share_exact": 1 - (1 - taken) ** 2, "halfwidth": hertz.halfwidth}
    figures["stick"] = StickWidth(place, table["status"][closed] == 1)
    profile = place, traction / (FRICTION * hertz.peak), "."
    return figures, (ways, shares, ".-"), profile, (gf.components[0], contact)


def StickWidth(place, sticks):
    """Over the width of the contact; stick begins where the surfaces come in."""
    first = len(sticks) if sticks.all() else int(np.argmin(sticks))
    assert not sticks[first:].any(), sticks
    end = (place[first - 1] + place[first]) / 2 if first < len(place) else 1.0
    return (end + 1) / 2


def Traction(place, share):
    """Carter's, over friction times the peak pressure, in units of the half width."""

    def Ellipse(at, half):
        return np.sqrt(np.maximum(half**2 - at**2, 0))

    half = math.sqrt(1 - share)
    return Ellipse(place, 1) - Ellipse(place + 1 - half, half)


def Run(shares=SHARES, h=0.125, way=4.0, start=1.0, out=None):
    """Roll with the creeps that belong to some shares.

    shares : Q/(mu P) by Carter, one for each creep
    h : edge length, and way of each step
    way : of rolling
    start : Q before the rollers roll, over that of Carter
    """
    if max(shares) >= 1:
        raise ValueError(f"shares = {shares} must be less than 1: the rollers would slide")
    solved, place = [Solve(share, h, way, start) for share in shares], np.linspace(-1, 1, 400)
    paths, profiles, found = {}, {}, [figures for figures, *_ in solved]
    for each, path, profile, _ in solved:
        share, exact, stick = (each[name] for name in ("share", "share_exact", "stick"))
        print(f"creep {each['creep']:.5f}: Q/(mu P) {share:.4f}, Carter {exact:.4f};")
        print(f"sticks on {stick:.3f}, Carter {math.sqrt(1 - exact):.3f}")
        assert abs(share - exact) < h / 4  # half an edge over the width
        name = f"creep {each['creep']:.5f}"
        paths |= {name: path, f"{name}, Carter": ([0, way], [exact] * 2, "k--")}
        profiles |= {name: profile, f"{name}, Carter": (place, Traction(place, exact), "k-")}
    moved, contact = solved[-1][-1]
    Show(out, "carter", moved, Curves("way over half width", "Q / (mu P)", **paths),
         Curves("place over half width", "traction / (mu p0)", **profiles),
         upper=contact)  # fmt: skip
    figures = {name: [each[name] for each in found] for name in found[0]}
    return figures | {"halfwidth": found[0]["halfwidth"]}


main = Main(Run)
