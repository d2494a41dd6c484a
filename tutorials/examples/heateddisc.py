"""A disc is heated inside of a cold ring, closes a clearance and presses against it.

Plane strain, Young's modulus 1, no friction; a quarter is computed. The pressure follows from
Lame's thick-walled cylinders. Start it with::

    python tutorials/examples/heateddisc.py --out results
"""

import numpy as np
from command import Main
from ngsolve import *
from pictures import Bodies, Show

from ngslac import *
from ngslac.materials import Stress
from ngslac.meshes import geometry

RADIUS, OUTER, POISSON = 50.0, 100.0, 0.3  # of the disc; of the ring


def DiscInRing(h, clearance):
    """A quarter of a disc of radius 50 inside of a ring, with a clearance.

    Boundaries: "slave" (the disc's rim, edges of length h), "master" (the ring's inner side, 0.73
    times as long), "outer", "symx" (x = 0), "symy" (y = 0). The clearance is radial.
    """
    r, inner, length = RADIUS, RADIUS + clearance, pi / 2 * RADIUS
    count = geometry.Divisions(length, h)
    nodes = [length * k / count for k in range(count + 1)]
    other = geometry.NonMatchingDivisions(nodes, 0, length, 0.73 * h)

    def Arc(radius, *ends):  # about the origin, between angles from the y axis, clockwise
        return geometry.Arc(lambda t: (radius * sin(t), radius * cos(t)), *ends)

    disc = [
        geometry.Line((0, 0), (r, 0), "symy"),
        Arc(r, pi / 2, 0, "slave", count),
        geometry.Line((0, r), (0, 0), "symx"),
    ]
    ring = [
        geometry.Line((inner, 0), (OUTER, 0), "symy"),
        Arc(OUTER, pi / 2, 0, "outer"),
        geometry.Line((0, OUTER), (0, inner), "symx"),
        Arc(inner, 0, pi / 2, "master", other),
    ]
    bodies = [geometry.Body(disc, "disc"), geometry.Body(ring, "ring")]
    return geometry.GenerateMesh(bodies, order=3, maxh=r / 4, grading=0.3)


def LamePressure(heating, clearance):
    """Over E: compression of the disc and widening of the ring share its expansion less the gap."""
    ratio, wide = (OUTER / RADIUS) ** 2, 1 + POISSON
    disc, ring = wide * (1 - 2 * POISSON), wide * ((1 - 2 * POISSON) + ratio) / (ratio - 1)
    return max(0.0, (wide * heating - clearance / RADIUS) / (disc + ring))


def Run(heating=1e-3, h=6.0, clearance=1e-3, out=None):
    """Heat the disc.

    heating : thermal expansion of the disc
    h : edge length on the rim
    clearance : radial, before the disc is heated
    """
    mesh = DiscInRing(h, clearance)
    V = VectorH1(mesh, order=2, dirichletx="symx", dirichlety="symy")
    X = V * LACSpace(V, slave="slave")
    (u, lam), (v, _) = X.TnT()
    hot = mesh.MaterialCF({"disc": heating}, default=0)

    def Hot(u):  # out of the plane nothing moves: the hot disc is held back there, too
        return Stress(Sym(Grad(u)), 1.0, POISSON) - hot / (1 - 2 * POISSON) * Id(2)

    a, gf = BilinearForm(X), GridFunction(X)
    a += InnerProduct(Hot(u), Sym(Grad(v))) * dx
    contact, moved = LACContact(u, lam, master="master"), gf.components[0]
    solver = ContactSolver(a, gf, contact)
    solver.Solve(printing=False)
    pressures, lame = contact.Table()["pressure"], LamePressure(heating, clearance)
    print(f"pressure over E {pressures.mean():.6e}, Lame {lame:.6e}")
    assert abs(pressures.mean() - lame) <= 2e-3 * lame * (h / 6) ** 2

    around = CF((-y, x)) / IfPos(x**2 + y**2, sqrt(x**2 + y**2), 1.0)
    hoop = InnerProduct(Hot(moved) * around, around)
    Show(out, "heateddisc", moved, Bodies(moved, hoop, "hoop stress / E", factor=200), rim=contact)
    figures = {"pressure": pressures.mean(), "lame": lame, "spread": np.ptp(pressures)}
    return figures | {"newton_iterations": len(solver.history) - 1, "solution": contact}


main = Main(Run)
