"""Bouncing: an elastic ring is thrown at a rigid ground with friction, and leaves it spinning.

Plane strain, neo-Hookean material, large deformation and rotation, gravity; the radius and the
density of the ring are 1. The ring flattens, rebounds and carries away a part of its energy as
vibration; friction slows it down and turns it. As long as it slips, the impulses along the ground
and across have the ratio of the coefficient of friction. Start it with::

    python tutorials/examples/bouncing.py --out results
"""

import numpy as np
from command import Main, NotNegative, Picture, Positive
from deformed import Deformed
from netgen.occ import Circle, Compound, MoveTo, OCCGeometry, Y
from ngsolve import *

from ngslac import ContactSolver, LACContact, LACSpace, TimeStepper

HEIGHT, NU = 0.05, 0.3  # of the lowest point at the start; Poisson's ratio
ENERGIES = ("kinetic", "internal", "friction", "impact", "algorithmic")


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
    return shear / 2 * (Trace(F.trans * F) - 2 - 2 * volume) + lame / 2 * volume**2


class Ring:
    """Ring, ground and time stepper; `rows` has an entry for each step, the start included."""

    def __init__(
        self, h=0.17, thickness=0.1, young=2000.0, friction=0.5, gravity=0.5, velocity=(2.0, -1.0)
    ):
        if not thickness < 1:
            raise ValueError(f"thickness = {thickness} must be less than the radius 1")
        if not (velocity[1] < 0 and np.isfinite(velocity).all()):
            raise ValueError(f"velocity = {velocity} must be finite and point downwards")
        self.mesh, self.young, self.gravity = RingMesh(h, thickness), young, gravity
        self.thrown, self.rows, self.places = velocity, [], []
        self.inertia = (1 - thickness / 2) ** 2  # over the mass, of a thin ring
        V = VectorH1(self.mesh, order=2, dirichlet="master|fixed")
        X = V * LACSpace(V, slave="slave")
        (u, lam), (v, _) = X.TnT()
        self.a = BilinearForm(X)
        self.a += Variation(Energy(u, young).Compile() * dx)
        self.a += gravity * v[1] * dx("ring")
        self.gf = GridFunction(X)
        self.displacement = self.gf.components[0]
        self.contact = LACContact(u, lam, master="master", friction=friction, finite=True)

    def Throw(self, end=2.4, dt=0.02, rho_inf=0.9, printing=False):
        """Compute the motion until the time `end`."""
        solver = ContactSolver(self.a, self.gf, self.contact)
        energy = Energy(self.displacement, self.young).Compile()
        self.stepper = TimeStepper(solver, 1.0, dt=dt, rho_inf=rho_inf, energy=energy)
        throw = self.mesh.MaterialCF({"ring": CF(tuple(self.thrown))}, default=CF((0, 0)))
        velocity = self.stepper.velocity.components[0]
        velocity.Set(throw, definedon=self.mesh.Materials("ring"))
        self._Record()
        self.stepper.Integrate(end, printing=printing, callback=self._Record)

    def _Sum(self, function):
        return Integrate(function, self.mesh, definedon=self.mesh.Materials("ring"))

    def _Record(self, step=None):
        """Motion of the centre of mass, and angular momentum about it."""
        velocity, at, mass = self.stepper.velocity.components[0], CF((x, y)), self._Sum(1)
        at += self.displacement
        center = [self._Sum(at[i]) / mass for i in range(2)]
        arm = at - CF(tuple(center))
        status = self.contact.Table()["status"] if self.contact.form.paired else np.zeros(1)
        row = {"time": step.time if step else 0.0, "iterations": step.iterations if step else 0}
        row |= {"center": center, "closed": int(np.sum(status > 0))}
        row["velocity"] = np.array([self._Sum(velocity[i]) / mass for i in range(2)])
        row["spin"] = self._Sum(arm[0] * velocity[1] - arm[1] * velocity[0])
        self.rows.append(row)
        self.places.append(self.displacement.vec.FV().NumPy().copy())

    def Figures(self):
        """The numbers of the motion."""
        rows, table = self.rows, self.stepper.Table()
        closed = [k for k, row in enumerate(rows) if row["closed"]]
        if not closed:
            raise ValueError(f"the ring is in the air until the time {rows[-1]['time']:g}")
        before, after = rows[closed[0] - 1], rows[min(closed[-1] + 1, len(rows) - 1)]
        mass = self._Sum(1)
        aside, up = mass * (after["velocity"] - before["velocity"])
        up += mass * self.gravity * (after["time"] - before["time"])
        flight = [row for row in rows if row["time"] >= after["time"]]
        spins = np.array([row["spin"] for row in flight])
        mechanical = table["kinetic"] + table["internal"] - table["external"]
        return {
            "contact_begin": rows[closed[0]]["time"],
            "contact_end": rows[closed[-1]]["time"],
            "restitution": -after["velocity"][1] / before["velocity"][1],
            "impulse": [aside, up],
            "friction_ratio": -aside / up,
            "spin": after["spin"] / (mass * self.inertia),
            "spin_ratio": after["spin"] / aside if aside else 0.0,
            "flight_spin_drift": np.ptp(spins) / np.abs(spins).max() if spins.any() else 0.0,
            "flight_speed_drift": np.ptp([row["velocity"][0] for row in flight]),
            "energy_start": 0.5 * mass * np.dot(self.thrown, self.thrown),
            "energy_end": self.stepper.balance.total,
            **{k: table[k][-1] for k in ("external", "friction", "impact", "algorithmic")},
            "largest_gain": np.diff(mechanical).max(),
            "largest_contact_gain": -np.diff(table["friction"] + table["impact"]).min(),
            "steps": len(rows) - 1,
            "cuts": sum(step.cuts for step in self.stepper.steps),
            "iterations": max(row["iterations"] for row in rows),
            "unknowns": len(self.gf.vec),
        }


def Write(ring, folder):
    """Instants of the motion above the energies as a picture; the end for ParaView."""
    table, start = ring.stepper.Table(), ring.Figures()["energy_start"]
    parts = [[start * (name == "kinetic"), *np.maximum(table[name], 0)] for name in ENERGIES]
    with Picture(folder, "bouncing", rows=2, size=(8, 6.4)) as (above, below):
        for k in np.linspace(0, len(ring.rows) - 1, 6).astype(int):
            moved, faces = Deformed(ring.displacement, ("ring",), values=ring.places[k])
            above.triplot(*moved.T, faces, lw=0.6, label=f"t = {ring.rows[k]['time']:.2f}")
            above.plot(*moved[faces[0][0]], "ko", ms=4)  # moves with the material
        above.plot(*np.transpose([row["center"] for row in ring.rows]), "k--", lw=0.6)
        above.axhline(0, color="k")
        above.set_aspect("equal")
        above.legend(ncols=6, fontsize="small", loc="lower center", bbox_to_anchor=(0.5, 1))
        below.stackplot([0, *table["time"]], *parts, labels=ENERGIES)
        below.set(xlabel="time", ylabel="energy")
        below.legend(loc="lower left", ncols=5)
    ring.contact.WriteVTU(folder / "bouncing_outside", displacement=ring.displacement)


def Run(end=2.4, dt=0.02, rho_inf=0.9, out=None, quiet=True, **options):
    """Throw the ring; the other options are those of `Ring`. Returns the numbers of the motion."""
    ring = Ring(**options)
    ring.Throw(end, dt, rho_inf, printing=not quiet)
    figures = ring.Figures()
    if out:
        Write(ring, out)
    if not quiet:
        for name, value in figures.items():
            print(f"{name:20s} {np.round(value, 6)}")
    return figures


main = Main(
    Run,
    __doc__,
    Ring,
    friction=(NotNegative, "coefficient"),
    gravity=(NotNegative, "acceleration downwards"),
    velocity=(float, "along the ground, and up"),
    end=(Positive, "time at the end"),
    h=(Positive, "size of the elements of the ring"),
    dt=(Positive, "time step"),
    rho_inf=(NotNegative, "spectral radius of the time integration"),
    thickness=(Positive, "of the ring"),
    young=(Positive, "Young's modulus"),
)


if __name__ == "__main__":
    main()
