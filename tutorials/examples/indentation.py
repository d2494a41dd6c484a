"""Elastoplastic indentation: a rigid cylinder is pressed into a block and withdrawn.

Plane strain, small strains, no friction. The block (soft aluminium: E = 70 GPa, nu = 0.3, yield
stress 35 MPa) yields by von Mises with a little linear hardening; the cylinder has the radius
100 mm. Loaded until the flow is fully plastic, unloaded, loaded again. Start it with::

    python tutorials/examples/indentation.py --out results

Compared with K. L. Johnson, Contact Mechanics (1985): onset of yield at the peak pressure 1.79 Y
(section 6.1; the number holds for nu = 0.3), mean pressure 2.97 Y (Prandtl's (2 + pi) k) of the
rigid plastic body (6.2), unloading and loading again without further yield (6.4).
"""

import math
import time

import numpy as np
from command import Count, NotNegative, Options, Positive, Start
from ngsolve import (
    CF,
    H1,
    VOL,
    BilinearForm,
    Grad,
    GridFunction,
    InnerProduct,
    LinearForm,
    Parameter,
    Sym,
    Variation,
    VectorH1,
    dx,
)
from plasticity import J2Plasticity, PlaneStrain

from ngslac import ContactSolver, LACContact, LACSpace, LoadStepper
from ngslac.meshes import IndentationMesh

# Mean pressure over yield stress of a flat punch on a rigid plastic body: (2 + pi) Y/sqrt(3).
PRANDTL = (2 + math.pi) / math.sqrt(3)


def OnsetPressure(poisson):
    """Peak pressure over yield stress at which a line contact first yields (von Mises).

    From the stresses of Hertz' solution below the middle of the contact (Johnson 1985, section
    4.2), in plane strain: 1.79 for a Poisson ratio of 0.3.
    """
    z = np.linspace(0, 2, 20001)
    root = np.sqrt(1 + z**2)
    along, normal = -((1 + 2 * z**2) / root - 2 * z), -1 / root
    out = poisson * (along + normal)
    squares = (along - normal) ** 2 + (normal - out) ** 2 + (out - along) ** 2
    return float(1 / np.sqrt(squares / 2).max())


def Depths(depth=0.08, steps=16, back=16):
    """The depths of loading, of unloading down to the half, and of loading again.

    Loading is equal in the width of the contact (depth ~ step^2). Steps that resolve how the edge
    of the contact crosses the faces of the slave side change the force by up to 3 %.
    """
    there = [depth * (k / steps) ** 2 for k in range(1, steps + 1)]
    half = [depth * (1 - 0.5 * k / back) for k in range(1, back + 1)]
    return there, [0.998 * depth, *half], [depth * share for share in (0.85, 0.9, 0.95, 1.0)]


class Indentation:
    """Block, cylinder and solver, in mm and MPa; `curve` has an entry for each converged step.

    The contact zone has the half width `zone` and edges of the length `h`; the block has the half
    width and the height `size`.
    """

    def __init__(
        self,
        h=0.2,
        radius=100.0,
        young=70e3,
        poisson=0.3,
        yield_stress=35.0,
        hardening=70.0,
        zone=5.0,
        size=40.0,
    ):
        self.h, self.young, self.poisson, self.size = h, young, poisson, size
        self.yield_stress, self.curve = yield_stress, []
        self.scale = young / (1 - poisson**2) / (yield_stress * radius)  # of the width
        self.mesh = mesh = IndentationMesh(h, radius=radius, zone=zone, size=size)
        held = "master|back"  # the cylinder is rigid: all of its boundary is prescribed
        V = VectorH1(mesh, order=2, dirichletx=f"sym|bottom|{held}", dirichlety=f"bottom|{held}")
        X = V * LACSpace(V, slave="slave")
        (u, lam), (v, _) = X.TnT()
        self.material = J2Plasticity(
            mesh, young=young, poisson=poisson, yield_stress=yield_stress, hardening=hardening
        )
        energy, rules = self.material.Energy(PlaneStrain(Grad(u))), self.material.rules
        a = BilinearForm(X)
        a += Variation(energy * dx("block", intrules=rules))
        a += young * InnerProduct(Sym(Grad(u)), Sym(Grad(v))) * dx("cylinder")
        self.contact = LACContact(u, lam, master="master")
        self.gf, depth = GridFunction(X), Parameter(0.0)
        self.displacement = self.gf.components[0]
        self.strain = PlaneStrain(Grad(self.displacement))
        self.solver = ContactSolver(a, self.gf, self.contact)
        self.stepper = LoadStepper(self.solver, depth, prescribe={held: CF((0, -depth))})

    def Advance(self, depths, *, printing=False, maxit=30):
        """Go through these depths until the cylinder is free; returns the rows of these steps.

        The state of the material is committed after each converged step, which is then measured.
        """
        before = len(self.curve)

        def Accept(step):
            self.material.Commit(self.strain)
            self.curve.append(self.Measure() | {"iterations": step.iterations, "cuts": step.cuts})

        flags = {"callback": Accept, "printing": printing, "maxit": maxit}
        for depth in depths:
            self.stepper.Integrate(end=depth, steps=1, **flags)
            deepest = max(row["depth"] for row in self.curve)
            if depth < deepest and not self.curve[-1]["closed"]:
                break
        return self.curve[before:]

    def Cycle(self, *args, printing=False):
        """Load, unload and load again; the arguments are those of `Depths`."""
        loading, unloading, reloading = Depths(*args)
        self.loading = self.Advance(loading, printing=printing)
        self.residuals = [entry.equilibrium for entry in self.solver.history]
        self.unloading = self.Advance(unloading, printing=printing)
        self.imprint = GridFunction(self.displacement.space)
        self.imprint.vec.data = self.displacement.vec
        self.reloading = self.Advance(reloading, printing=printing)

    def Measure(self):
        """Depth, force, half width and pressures of the present, committed state.

        The force is that of the whole cylinder per unit of length. The edge of the contact lies in
        the last macro-element under pressure, at the share of it that its pressure has of that
        before.
        """
        table, material = self.contact.Table(), self.material
        order = np.argsort(table["x"][:, 0])
        pressure, area = table["pressure"][order], table["fullarea"][order].copy()
        closed = np.flatnonzero(table["status"][order] > 0)  # rounding leaves pressures on others
        if len(closed) > 1 and pressure[closed[-1]] < pressure[closed[-2]]:
            area[closed[-1]] *= pressure[closed[-1]] / pressure[closed[-2]]
        width, force = float(area[closed].sum()), -2 * float(self.contact.Force()[1])
        mises = GridFunction(material.points)
        mises.Interpolate(material.Mises(self.strain).Compile(), self.mesh.Materials("block"))
        return {
            "depth": float(self.stepper.load.Get()),
            "force": force,
            "reaction": 2 * self._Reaction(),
            "halfwidth": width,
            "mean_pressure": force / (2 * width) if width else 0.0,
            "scaled_width": self.scale * width,
            "peak_pressure": float(pressure.max()),
            "mises": float(mises.vec.FV().NumPy().max()),
            "plastic_strain": float(material.accumulated.vec.FV().NumPy().max()),
            "plastic_volume": material.Integral(material.accumulated),
            "gap": float(table["gap"].min()),
            "closed": len(closed),
        }

    def _Reaction(self):
        """Vertical force of the foundation on the bottom of the block."""
        forces, lift = self.gf.vec.CreateVector(), GridFunction(self.displacement.space)
        self.solver.a.Apply(self.gf.vec, forces)
        lift.Set((0, 1), definedon=self.mesh.Boundaries("bottom"))
        return float(np.dot(lift.vec.FV().NumPy(), forces.FV().NumPy()[: len(lift.vec)]))

    def Figures(self):
        """The numbers of the cycle."""
        peak, again = self.loading[-1], self.reloading[-1]
        first, released = self.unloading[0], self.unloading[-1]
        return {
            "onset_pressure_hertz": OnsetPressure(self.poisson),
            "mean_pressure_ratio": peak["mean_pressure"] / self.yield_stress,
            "prandtl": PRANDTL,
            "scaled_width": peak["scaled_width"],
            "peak_force": peak["force"],
            "halfwidth": peak["halfwidth"],
            "unloading_slope": (peak["force"] - first["force"]) / (peak["depth"] - first["depth"]),
            "permanent_depth": released["depth"] + released["gap"],
            # A little below: the cylinder's mesh has a point at the origin, too.
            "imprint_depth": -float(self.imprint(self.mesh(0, -1e-5 * self.h))[1]),
            "released": released["closed"] == 0,
            "reloading_force_ratio": again["force"] / peak["force"],
            "plastic_strain": peak["plastic_strain"],
            "reloading_plastic_ratio": again["plastic_volume"] / peak["plastic_volume"],
            "balance": max(abs(r["reaction"] - r["force"]) for r in self.curve) / peak["force"],
            "last_residuals": self.residuals,
            "steps": len(self.curve),
            "newton_iterations": [row["iterations"] for row in self.curve],
            "newton_max": max(row["iterations"] for row in self.curve),
            "cuts": sum(row["cuts"] for row in self.curve),
            "curve": [[row["depth"], row["force"]] for row in self.curve],
            "ndof": len(self.gf.vec),
            "h": self.h,
        }


def Onset(h=0.2, zone=5.0, size=40.0, radius=100.0, young=70e3, **options):
    """Peak pressure over yield stress when yield begins.

    In the elastic state all stresses grow together: one step on a block that does not yield tells
    the ratio of the peak pressure to the largest von Mises stress. The contact is small against the
    block, and wide against the mesh.
    """
    options |= {"radius": radius, "young": young, "yield_stress": young}
    elastic = Indentation(h=0.5 * h, zone=0.3 * zone, size=2.5 * size, **options)
    (row,) = elastic.Advance([1.5 * (0.3 * zone) ** 2 / radius])
    return row["peak_pressure"] / row["mises"]


def Imprint(problem, axes, factor=15):
    """The accumulated plastic strain on the block after the cylinder has left."""
    material, mesh = problem.material, problem.mesh
    space = H1(mesh, order=1, definedon="block")
    (u, v), rule = space.TnT(), dx("block", intrules=material.rules)
    mass = BilinearForm(u * v * rule).Assemble()
    load = LinearForm(material.accumulated * v * rule).Assemble()
    values = 100 * (mass.mat.Inverse(space.FreeDofs()) * load.vec).Evaluate().FV().NumPy()
    points = np.array([vertex.point for vertex in mesh.vertices])
    shift = problem.imprint.vec.FV().NumPy().reshape(2, -1)[:, : mesh.nv].T  # vertices come first
    faces = [[v.nr for v in el.vertices] for el in mesh.Elements(VOL) if el.mat == "block"]
    moved = points + factor * shift
    drawn = axes.tripcolor(*moved.T, faces, values, shading="gouraud", cmap="YlOrRd", vmin=0)
    axes.triplot(*moved.T, faces, color="k", lw=0.1)
    axes.figure.colorbar(drawn, ax=axes, label="accumulated plastic strain [%]", shrink=0.75)
    width = problem.loading[-1]["halfwidth"]
    axes.set(xlim=(0, 2.2 * width), ylim=(-2 * width, 1), aspect="equal")
    axes.set_title(f"displacement x {factor}")


def Write(problem, folder):
    """Force over depth, mean pressure over width, the imprint; the surface for ParaView."""
    from matplotlib import pyplot as plt

    folder.mkdir(parents=True, exist_ok=True)
    figure, (left, middle, right) = plt.subplots(1, 3, figsize=(11.5, 3.6), layout="constrained")
    for name in ("loading", "unloading", "reloading"):
        rows = [(row["depth"], row["force"]) for row in getattr(problem, name)]
        left.plot(*np.transpose(rows), ".-", lw=1, label=name)
    left.set(xlabel="depth of the cylinder [mm]", ylabel="force [N/mm]")
    rows = [(row["scaled_width"], row["mean_pressure"]) for row in problem.loading]
    width, mean = np.transpose([row for row in rows if row[1] > 0])
    elastic = np.linspace(0.1, 6)
    middle.semilogx(elastic, math.pi / 8 * elastic, "k", lw=0.9, label="Hertz")
    middle.axhline(PRANDTL, color="k", lw=0.9, ls="--", label="rigid plastic")
    middle.plot(width, mean / problem.yield_stress, ".-", label="computed")
    middle.set(xlabel="E* a / (Y R)", ylabel="mean pressure / Y", xlim=(1, None))
    for axes in (left, middle):
        axes.legend()
    Imprint(problem, right)
    figure.savefig(folder / "indentation.png", dpi=150)
    plt.close(figure)
    problem.contact.WriteVTU(folder / "indentation_top", displacement=problem.displacement)


def Run(depth=0.08, steps=16, back=16, out=None, quiet=True, **options):
    """Press in, withdraw, press again; the other options are those of `Indentation`."""
    start = time.perf_counter()
    problem = Indentation(**options)
    problem.Cycle(depth, steps, back, printing=not quiet)
    figures = {"onset_pressure": Onset(**options)} | problem.Figures()
    figures["seconds"] = time.perf_counter() - start
    if out:
        Write(problem, out)
    if not quiet:
        onset, hertz = figures["onset_pressure"], figures["onset_pressure_hertz"]
        print(f"peak pressure over yield stress at onset {onset:.4f}, Hertz {hertz:.4f}")
        mean = figures["mean_pressure_ratio"]
        print(f"mean pressure over yield stress {mean:.4f}, rigid plastic {PRANDTL:.4f}")
        print(f"depth left {figures['imprint_depth']:.5f} mm of {depth} mm")
    return figures


def main(argv=None):
    """Run the example from the command line."""
    parser = Options(__doc__)
    add = parser.add_argument
    add("--h", type=Positive, default=0.2, help="edge length in the contact zone, in mm")
    add("--depth", type=Positive, default=0.08, help="largest depth, in mm")
    add("--steps", type=Count, default=16, help="loading steps")
    add("--yield-stress", type=Positive, default=35.0, help="in MPa")
    add("--hardening", type=NotNegative, default=70.0, help="slope of the yield stress, in MPa")
    return Start(Run, parser, argv)


if __name__ == "__main__":
    main()
