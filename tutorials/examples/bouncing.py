"""Bouncing: an elastic ring is thrown at a rigid ground with friction, and leaves it spinning.

Plane strain, neo-Hookean material, large deformation and rotation, gravity; the radius and the
density of the ring are 1. The ring flattens, rebounds and carries away a part of its energy as
vibration; friction slows it down and turns it. As long as it slips, the impulses along the ground
and across have the ratio of the coefficient of friction. Start it with::

    python tutorials/examples/bouncing.py --out results
"""

import numpy as np
from command import Main, NotNegative
from netgen.occ import Circle, Compound, MoveTo, OCCGeometry, Y
from ngsolve import *
from pictures import Bodies, Curves, Show

from ngslac import *

HEIGHT, NU = 0.05, 0.3  # of the lowest point at the start; Poisson's ratio


def RingMesh(h, thickness):
    """The ring above the ground: boundaries "slave" (outside), "inside", "master"."""
    outside, inside = (Circle((0, 1 + HEIGHT), r).Face() for r in (1, 1 - thickness))
    outside.edges.name, inside.edges.name = "slave", "inside"
    ring = outside - inside
    ring.faces.name = "ring"
    ring.faces.maxh = h
    ground = MoveTo(-1.5, -0.25).Rectangle(6, 0.25).Face()
    ground.faces.name, ground.edges.name = "ground", "fixed"
    ground.edges.Max(Y).name = "master"
    return Mesh(OCCGeometry(Compound([ring, ground]), dim=2).GenerateMesh(maxh=0.5)).Curve(2)


def Energy(u, young):
    """Energy per area of a compressible neo-Hookean material."""
    shear, lame = young / (2 * (1 + NU)), young * NU / ((1 + NU) * (1 - 2 * NU))
    F = Id(2) + Grad(u)
    volume = log(Det(F))
    return (shear / 2 * (Trace(F.trans * F) - 2 - 2 * volume) + lame / 2 * volume**2).Compile()


def Run(
    friction: NotNegative = 0.5, gravity: NotNegative = 0.5, velocity: float = (2.0, -1.0), end=2.4,
    h=0.17, dt=0.02, rho_inf: NotNegative = 0.9, thickness=0.1, young=2000.0, out=None
):  # fmt: skip
    """Throw the ring; numbers of the motion before and after the contact.

    friction : coefficient
    gravity : acceleration downwards
    velocity : along the ground, and up
    end : time at the end
    h : size of the elements of the ring
    dt : time step
    rho_inf : spectral radius of the time integration
    thickness : of the ring
    young : Young's modulus
    """
    if not thickness < 1:
        raise ValueError(f"thickness = {thickness} must be less than the radius 1")
    if not (velocity[1] < 0 and np.isfinite(velocity).all()):
        raise ValueError(f"velocity = {velocity} must be finite and point downwards")
    mesh = RingMesh(h, thickness)
    V = VectorH1(mesh, order=2, dirichlet="master|fixed")
    X = V * LACSpace(V, slave="slave")
    (u, lam), (v, _) = X.TnT()
    a, gf = BilinearForm(X), GridFunction(X)
    a += Variation(Energy(u, young) * dx)
    a += gravity * v[1] * dx("ring")
    contact = LACContact(u, lam, master="master", friction=friction, finite=True)
    moved, ring = gf.components[0], mesh.Materials("ring")
    solver, energy = ContactSolver(a, gf, contact), Energy(moved, young)
    stepper = TimeStepper(solver, 1.0, dt=dt, rho_inf=rho_inf, energy=energy)
    speed = stepper.velocity.components[0]
    speed.Set(mesh.MaterialCF({"ring": CF(tuple(velocity))}, default=CF((0, 0))), definedon=ring)
    mass, rows, places = Integrate(1, ring), [], []

    def Note(step=None):
        at = CF((x, y)) + moved
        center = np.array(Integrate(at, ring)) / mass
        arm = at - CF(tuple(center))
        spin = Integrate(arm[0] * speed[1] - arm[1] * speed[0], ring)
        closed = step is not None and np.any(contact.Table()["status"] > 0)
        mean = np.array(Integrate(speed, ring)) / mass
        rows.append((step.time if step else 0.0, closed, mean, spin))
        places.append(GridFunction(V))
        places[-1].vec.data = moved.vec

    Note()
    stepper.Integrate(end, printing=False, callback=Note)
    time, closed, mean, spin = (np.array(column) for column in zip(*rows, strict=True))
    if not closed.any():
        raise ValueError(f"the ring is in the air until the time {time[-1]:g}")
    first, last = np.flatnonzero(closed)[[0, -1]]
    before, after = first - 1, min(last + 1, len(rows) - 1)  # rows of flight
    aside, up = mass * (mean[after] - mean[before])
    up += mass * gravity * (time[after] - time[before])
    flight, table, start = spin[after:], stepper.Table(), mass / 2 * np.dot(velocity, velocity)
    figures = {
        "contact_end": time[last],
        "restitution": -mean[after][1] / mean[before][1],
        "friction_ratio": -aside / up,
        "spin": spin[after] / (mass * (1 - thickness / 2) ** 2),  # over the inertia of a thin ring
        "spin_ratio": spin[after] / aside if aside else 0.0,
        "flight_spin_drift": np.ptp(flight) / np.abs(flight).max() if flight.any() else 0.0,
        "flight_speed_drift": np.ptp(mean[after:, 0]),
        "energy_start": start,
        "energy_end": stepper.balance.total,
        **{name: table[name][-1] for name in ("friction", "impact", "algorithmic")},
        "largest_gain": np.diff(table["kinetic"] + table["internal"] - table["external"]).max(),
        "largest_contact_gain": -np.diff(table["friction"] + table["impact"]).min(),
        "steps": len(time) - 1,
        "cuts": sum(step.cuts for step in stepper.steps),
    }
    gone = sum(figures[name] for name in ("friction", "impact", "algorithmic"))
    balance = (figures["energy_end"] + gone - table["external"][-1]) / start - 1
    drift = figures["flight_speed_drift"]
    print("restitution {restitution:.4f}, friction_ratio {friction_ratio:.4f}".format(**figures))
    print(f"error of the energy balance {balance:.1e}, change of speed in flight {drift:.1e}")
    assert abs(balance) < 1e-9
    assert drift < 1e-8

    instants = [Bodies(places[k]) for k in np.linspace(0, len(rows) - 1, 6).astype(int)]
    names = "kinetic", "internal", "friction", "impact", "algorithmic"
    curves = {name: (table["time"], table[name], "-") for name in names}
    Show(out, "bouncing", moved, lambda axes: [draw(axes) for draw in instants],
         Curves("time", "energy", **curves), outside=contact)  # fmt: skip
    return figures


main = Main(Run)
