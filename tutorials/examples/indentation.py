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
from types import SimpleNamespace

import numpy as np
from command import Main, NotNegative
from flatpunch import PRANDTL
from ngsolve import *
from pictures import Bodies, Curves, Show
from plasticity import J2Plasticity, PlaneStrain

from ngslac import *
from ngslac.meshes import geometry


def BlockMesh(h, radius, zone, size):
    """Half a block: "slave" (edges of length `h`), "top" (the rest), "side", "bottom", "sym"."""
    scale = radius / 100  # netgen has absolute lengths
    h, zone, size = h / scale, zone / scale, size / scale
    corners = [(0, -size), (size, -size), (size, 0), (zone, 0), (0, 0)]
    names, count = ("bottom", "side", "top", "slave", "sym"), geometry.Divisions(zone, h)
    block = geometry.Polygon(corners, names, "block", slave=count)
    return geometry.GenerateMesh([block], scale=scale, maxh=size / 5, grading=0.2)


class Indenter:
    """Block, cylinder and solver, in mm and MPa; `curve` has an entry for each converged step.

    The contact zone has the half width `zone` and edges of the length `h`; the block has the half
    width and the height `size`.
    """

    def __init__(self, h=0.2, radius=100.0, young=70e3, poisson=0.3, yield_stress=35.0,
                 hardening=70.0, zone=5.0, size=40.0):  # fmt: skip
        self.h, self.young, self.poisson, self.size = h, young, poisson, size
        self.yield_stress, self.curve = yield_stress, []
        self.scale = young / (1 - poisson**2) / (yield_stress * radius)  # of the width
        self.mesh = mesh = BlockMesh(h, radius, zone, size)
        V = VectorH1(mesh, order=2, dirichletx="sym|bottom", dirichlety="bottom")
        X = V * LACSpace(V, slave="slave")
        u, lam = X.TrialFunction()
        law = {"young": young, "poisson": poisson, "yield_stress": yield_stress}
        self.material = material = J2Plasticity(mesh, **law, hardening=hardening)
        a, self.gf, depth = BilinearForm(X), GridFunction(X), Parameter(0.0)
        a += Variation(material.Energy(PlaneStrain(Grad(u))) * dx(intrules=material.rules))
        gap = radius - sqrt(radius**2 - x**2) - depth  # from the top to the cylinder
        self.contact = LACContact(u, lam, obstacle=gap)
        self.displacement = self.gf.components[0]
        self.strain = PlaneStrain(Grad(self.displacement))
        self.solver = ContactSolver(a, self.gf, self.contact)
        self.stepper = LoadStepper(self.solver, depth)

    def Advance(self, depths, *, maxit=30):
        """Go through these depths until the cylinder is free; returns the rows of these steps.

        The state of the material is committed after each converged step, which is then measured.
        """
        before = len(self.curve)

        def Accept(step):
            self.material.Commit(self.strain)
            self.curve.append(self.Measure() | {"iterations": step.iterations, "cuts": step.cuts})

        for depth in depths:
            self.stepper.Integrate(depth, steps=1, callback=Accept, printing=False, maxit=maxit)
            deepest = max(row["depth"] for row in self.curve)
            if depth < deepest and not self.curve[-1]["closed"]:
                break
        return self.curve[before:]

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
        mises.Interpolate(material.Mises(self.strain).Compile())
        forces, lift = self.gf.vec.CreateVector(), GridFunction(self.gf.space)
        self.solver.a.Apply(self.gf.vec, forces)
        lift.components[0].Set((0, 1), definedon=self.mesh.Boundaries("bottom"))
        return {
            "depth": float(self.stepper.load.Get()),
            "force": force,
            "reaction": 2 * InnerProduct(lift.vec, forces),  # of the foundation, upwards
            "halfwidth": width,
            "mean_pressure": force / (2 * width) if width else 0.0,
            "scaled_width": self.scale * width,
            "peak_pressure": float(pressure.max()),
            "mises": float(mises.vec.FV().NumPy().max()),
            "plastic_volume": material.Integral(material.accumulated),
            "gap": float(np.nanmin(table["gap"])),
            "closed": len(closed),
        }


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


def Onset(h=0.2, hardening=70.0):
    """Peak pressure over yield stress when yield begins.

    In the elastic state all stresses grow together: one step on a block that does not yield tells
    the ratio of the peak pressure to the largest von Mises stress. The contact is small against the
    block, and wide against the mesh.
    """
    elastic = Indenter(h / 2, yield_stress=70e3, hardening=hardening, zone=1.5, size=400.0)
    (row,) = elastic.Advance([1.5 * 1.5**2 / 100.0])
    return row["peak_pressure"] / row["mises"]


def Depths(depth=0.08, steps=16, back=16):
    """The depths of loading, of unloading down to the half, and of loading again.

    Loading is equal in the width of the contact (depth ~ step^2). Steps that resolve how the edge
    of the contact crosses the faces of the slave side change the force by up to 3 %.
    """
    there = [depth * (k / steps) ** 2 for k in range(1, steps + 1)]
    half = [depth * (1 - 0.5 * k / back) for k in range(1, back + 1)]
    return there, [0.998 * depth, *half], [depth * share for share in (0.85, 0.9, 0.95, 1.0)]


def Cycle(indenter, *depths):
    """Load, unload and load an `Indenter` again: rows of the steps, the imprint, figures."""
    loading, unloading, reloading = Depths(*depths)
    loading = indenter.Advance(loading)
    residuals = [entry.equilibrium for entry in indenter.solver.history]
    unloading, imprint = indenter.Advance(unloading), GridFunction(indenter.displacement.space)
    imprint.vec.data = indenter.displacement.vec
    reloading, curve = indenter.Advance(reloading), indenter.curve
    peak, first, released = loading[-1], unloading[0], unloading[-1]
    figures = {
        "onset_pressure_hertz": OnsetPressure(indenter.poisson),
        "mean_pressure_ratio": peak["mean_pressure"] / indenter.yield_stress,
        "prandtl": PRANDTL,
        "scaled_width": peak["scaled_width"],
        "halfwidth": peak["halfwidth"],
        "unloading_slope": (peak["force"] - first["force"]) / (peak["depth"] - first["depth"]),
        "permanent_depth": released["depth"] + released["gap"],
        "imprint_depth": -float(imprint(indenter.mesh(0, 0))[1]),
        "released": released["closed"] == 0,
        "reloading_force_ratio": reloading[-1]["force"] / peak["force"],
        "balance": max(abs(r["reaction"] - r["force"]) for r in curve) / peak["force"],
        "cuts": sum(row["cuts"] for row in curve),
        "curve": [[row["depth"], row["force"]] for row in curve],
    }
    return SimpleNamespace(
        indenter=indenter, loading=loading, unloading=unloading, reloading=reloading,
        residuals=residuals, imprint=imprint, figures=figures
    )  # fmt: skip


def Draw(cycle, folder):
    """Force over depth, mean pressure over width, the imprint."""
    block, elastic = cycle.indenter, np.linspace(0.1, 6)
    rows = [row for row in cycle.loading if row["closed"] > 3]
    width, mean = np.transpose([(row["scaled_width"], row["mean_pressure"]) for row in rows])
    paths = {"loading": cycle.loading, "unloading": cycle.unloading, "again": cycle.reloading}
    forces = {
        name: (*np.transpose([(row["depth"], row["force"]) for row in path]), ".-")
        for name, path in paths.items()
    }
    pressures = {"Hertz": (elastic, math.pi / 8 * elastic, "k-")}
    pressures["rigid plastic"] = width[[0, -1]], [PRANDTL] * 2, "k--"
    pressures["computed"] = width, mean / block.yield_stress, ".-"
    reach, strain = cycle.loading[-1]["halfwidth"], 100 * block.material.Smoothed()
    window = 0, 2.2 * reach, -2 * reach, reach / 2
    Show(folder, "indentation", block.displacement,
         Curves("depth of the cylinder [mm]", "force [N/mm]", **forces),
         Curves("E* a / (Y R)", "mean pressure / Y", xscale="log", **pressures),
         Bodies(cycle.imprint, strain, "plastic strain [%]", factor=15, window=window),
         top=block.contact)  # fmt: skip


def Run(h=0.2, depth=0.08, steps=16, yield_stress=35.0, hardening: NotNegative = 70.0, out=None):
    """Press in, withdraw, press again.

    h : edge length in the contact zone, in mm
    depth : largest depth, in mm
    steps : loading steps
    yield_stress : in MPa
    hardening : slope of the yield stress, in MPa
    """
    options = {"h": h, "yield_stress": yield_stress, "hardening": hardening}
    onset, cycle = Onset(h, hardening), Cycle(Indenter(**options), depth, steps)
    figures = {"onset_pressure": onset} | cycle.figures
    hertz, mean = figures["onset_pressure_hertz"], figures["mean_pressure_ratio"]
    print(f"peak pressure over yield stress at onset {onset:.4f}, Hertz {hertz:.4f}")
    print(f"mean pressure over yield stress {mean:.4f}, rigid plastic {PRANDTL:.4f}")
    print(f"depth left {figures['imprint_depth']:.5f} mm of {depth} mm")
    assert abs(onset / hertz - 1) < 0.1 * h, (onset, hertz)
    assert figures["balance"] < 1e-8, figures
    assert -1e-9 < figures["imprint_depth"] < depth
    Draw(cycle, out)
    return figures


main = Main(Run)
