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
from command import Columns, Main, Picture, Positive
from ngsolve import *

from ngslac import ContactSolver, LACContact, LACSpace, LoadStepper
from ngslac.materials import NeoHooke
from ngslac.meshes import geometry
from ngslac.reference import HertzLine

RADIUS = 80.0  # of both rollers
DEPTH, SIDE = 15.0, 12.0  # from the surface to the hub; what is meshed on both sides
YOUNG, NU, FRICTION = 1.0, 0.3, 0.3
AROUND = 1.6  # of the middle of the contact, where the mesh is fine
SHARES = (0.25, 0.5, 0.75)


def Creep(share, halfwidth, radius=RADIUS / 2):
    """Of half-planes, for the part of the friction that the tangential force takes."""
    return FRICTION * halfwidth / radius * (1 - math.sqrt(1 - share))


def Share(creep, halfwidth, radius=RADIUS / 2):
    """The inverse of `Creep`."""
    part = creep * radius / (FRICTION * halfwidth)
    return 1 - (1 - min(part, 1.0)) ** 2


def Roller(name, side, way, h):
    """The part that matters of the roller above (side = 1) or below the origin (-1)."""
    ends = [-(way + AROUND + SIDE), -(way + AROUND), AROUND, AROUND + SIDE]
    angles = [end / RADIUS for end in ends]

    def At(radius):
        def Point(angle):  # what comes in by rolling is at x < 0
            return radius * math.sin(angle), side * (RADIUS - radius * math.cos(angle))

        return Point

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


class Rollers:
    """Both of them pressed together; `Roll` turns them by the same way, but for the creep.

    Parameters
    ----------
    creep : float
        Difference of the speeds of the surfaces over their mean.
    way : float
        Of rolling.
    h : float
        Edge length on the upper roller.
    """

    def __init__(self, creep, way, h):
        self.creep, self.h, self.rows = creep, h, []
        bodies = [Roller("upper", 1, way, h), Roller("lower", -1, way, 1.13 * h)]
        self.mesh = geometry.GenerateMesh(bodies, order=2, maxh=DEPTH / 4, grading=0.3)
        V = VectorH1(self.mesh, order=2, dirichlet="hub_.*")
        X = V * LACSpace(V, slave="upper")
        u, lam = X.TrialFunction()
        a = BilinearForm(X)
        a += Variation(NeoHooke(Id(2) + Grad(u), YOUNG, NU).Compile() * dx)
        self.gf = GridFunction(X)
        self.contact = LACContact(u, lam, master="lower", finite=True, friction=FRICTION)
        self.solver = ContactSolver(a, self.gf, self.contact)
        self.down, self.wound, self.way = Parameter(0), Parameter(0), Parameter(0)

    def Hub(self, side):
        """Displacement of a hub: moved by half of the way down, and turned."""
        angle = (side * self.way + (self.creep * self.way + self.wound) / 2) / RADIUS
        below = y - side * RADIUS  # from the axis
        turned = cos(angle) * x - sin(angle) * below, sin(angle) * x + cos(angle) * below
        return CF((turned[0] - x, turned[1] - below - side * self.down / 2))

    def Go(self, parameter, end, steps, printing, callback=None):
        hubs = {"hub_upper": self.Hub(1), "hub_lower": self.Hub(-1)}
        stepper = LoadStepper(self.solver, parameter, prescribe=hubs)
        stepper.Integrate(end, steps=steps, printing=printing, callback=callback)

    def Press(self, printing):
        """Until the contact is about 2 wide."""
        approach = 1.1 * (2 * math.log(2 * DEPTH) - NU / (1 - NU)) / (2 * RADIUS)
        self.Go(self.down, approach, 4, printing)

    def Wind(self, share, printing):
        """Wind the hubs against each other until friction takes about this share.

        Creep alone would take a way of 10 a for that, since the rollers are soft.
        """
        first = FRICTION * share * self.down.Get()
        self.Go(self.wound, first, 1, printing)
        self.Go(self.wound, first * share / self.share, 1, printing)
        self.softness = self.wound.Get() / self.share

    def Roll(self, way, printing):
        """By an edge in each step; what is measured is noted."""

        def Note(step):
            self.rows.append({"way": step.time, "share": self.share})

        self.Go(self.way, way, math.ceil(way / self.h), printing, Note)
        self._Measure()

    def _Measure(self):
        """Mean share and creep on the second half of the way.

        What still winds up the rollers is no creep of their surfaces.
        """
        way, share = np.transpose([(row["way"], row["share"]) for row in self.rows])
        late = way > way[-1] / 2 - 1e-9
        growth = np.polyfit(way[late], share[late], 1)[0]
        self.creep_found = self.creep - self.softness * growth
        self.share_found = float(share[late].mean())

    @property
    def share(self):
        """Tangential force over what friction can carry."""
        along, force = self.contact.Force()
        return -float(along / force) / FRICTION

    def Profile(self):
        """Place over the half width, pressure, traction over friction, stick; of what touches."""
        table, hertz = self.contact.Table(), self.hertz
        closed = table["status"] > 0
        place, normal = table["x"][closed, 0], table["normal"][closed]
        traction = table["traction"][closed] @ [1.0, 0.0]
        traction += table["pressure"][closed] * normal[:, 0]
        return {
            "place": place / hertz.halfwidth,
            "pressure": table["pressure"][closed] / hertz.peak,
            "traction": -traction / (FRICTION * hertz.peak),
            "stick": table["status"][closed] == 1,
        }

    def StickWidth(self):
        """Over the width of the contact; stick begins where the surfaces come in."""
        found = self.Profile()
        first = int(np.argmin(found["stick"])) if not found["stick"].all() else len(found["stick"])
        assert not found["stick"][first:].any(), found
        ends = (found["place"][1:] + found["place"][:-1]) / 2
        end = ends[first - 1] if first < len(found["place"]) else 1.0
        return (end + 1) / 2

    @property
    def exact(self):
        """Carter's share for the creep that was found."""
        return Share(self.creep_found, self.hertz.halfwidth)

    @property
    def hertz(self):
        """For the force that presses."""
        material = {"young1": YOUNG, "young2": YOUNG, "nu1": NU, "nu2": NU}
        force = float(self.contact.Force()[1])
        return HertzLine(force=force, radius1=RADIUS, radius2=RADIUS, **material)


def Traction(place, share):
    """Carter's, over friction times the peak pressure, in units of the half width."""

    def Ellipse(at, half):
        return np.sqrt(np.maximum(half**2 - at**2, 0))

    half = math.sqrt(1 - share)
    return Ellipse(place, 1) - Ellipse(place + 1 - half, half)


def Write(found, folder):
    place = np.linspace(-1, 1, 400)
    with Picture(folder, "carter", 1, 2, size=(9, 3.5)) as (left, right):
        for rollers in found:
            rows, exact = Columns(rollers.rows), rollers.exact
            (line,) = left.plot(rows["way"], rows["share"], ".-", ms=3)
            left.axhline(exact, color="k", ls="--", lw=0.8)
            profile = rollers.Profile()
            right.plot(profile["place"], profile["traction"], "o", ms=3, color=line.get_color())
            right.plot(place, Traction(place, exact), color=line.get_color(), lw=0.9)
        right.plot(place, np.sqrt(1 - place**2), "k--", lw=0.8)
        left.set(xlabel="way over half width", ylabel="Q / (mu P)", ylim=(0, 1))
        right.set(xlabel="place over half width", ylabel="traction / (mu p0)")
    found[-1].contact.WriteVTU(folder / "carter", displacement=found[-1].gf.components[0])


def Solve(share, h, way, start=1.0, printing=False):
    """Rollers with the creep that belongs to a share, after rolling."""
    rollers = Rollers(Creep(share, 1.0), way, h)
    rollers.Press(printing)
    rollers.Wind(start * share, printing)
    rollers.Roll(way, printing)
    return rollers


def Run(shares=SHARES, h=0.125, way=4.0, start=1.0, out=None, quiet=True):
    """Roll with the creeps that belong to some shares; returns what is measured."""
    if max(shares) >= 1:
        raise ValueError(f"shares = {shares} must be less than 1: the rollers would slide")
    found = [Solve(share, h, way, start) for share in shares]
    figures = {
        "creep": [rollers.creep_found for rollers in found],
        "share": [rollers.share_found for rollers in found],
        "share_exact": [rollers.exact for rollers in found],
        "stick": [rollers.StickWidth() for rollers in found],
        "halfwidth": found[0].hertz.halfwidth,
    }
    for share, exact in zip(figures["share"], figures["share_exact"], strict=True):
        assert abs(share - exact) < h / 4, (share, exact)  # half an edge over the width
    if out:
        Write(found, out)
    if not quiet:
        for rollers in found:
            share, exact = rollers.share_found, rollers.exact
            print(f"creep {rollers.creep_found:.5f}: Q/(mu P) {share:.4f}, Carter {exact:.4f};")
            print(f"sticks on {rollers.StickWidth():.3f}, Carter {math.sqrt(1 - exact):.3f}")
    return figures


main = Main(
    Run,
    __doc__,
    shares=(Positive, "Q/(mu P) by Carter, one for each creep"),
    h=(Positive, "edge length, and way of each step"),
    way=(Positive, "of rolling"),
    start=(Positive, "Q before the rollers roll, over that of Carter"),
)

if __name__ == "__main__":
    main()
