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

import numpy as np
from command import Count, Main, NotNegative, Picture, Positive
from deformed import Deformed
from indenter import Indenter
from ngsolve import *

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


class Cycle:
    """Loading, unloading and loading again of an `Indenter`, each a list of the steps' rows."""

    def __init__(self, indenter, *args, printing=False):
        """The other arguments are those of `Depths`."""
        loading, unloading, reloading = Depths(*args)
        self.indenter, shift = indenter, indenter.displacement
        self.loading = indenter.Advance(loading, printing=printing)
        self.residuals = [entry.equilibrium for entry in indenter.solver.history]
        self.unloading = indenter.Advance(unloading, printing=printing)
        self.imprint = GridFunction(shift.space)
        self.imprint.vec.data = shift.vec
        self.reloading = indenter.Advance(reloading, printing=printing)

    def Figures(self):
        """The numbers of the cycle."""
        model, curve = self.indenter, self.indenter.curve
        peak, again = self.loading[-1], self.reloading[-1]
        first, released = self.unloading[0], self.unloading[-1]
        flowed = peak["plastic_volume"]
        return {
            "onset_pressure_hertz": OnsetPressure(model.poisson),
            "mean_pressure_ratio": peak["mean_pressure"] / model.yield_stress,
            "prandtl": PRANDTL,
            "scaled_width": peak["scaled_width"],
            "peak_force": peak["force"],
            "halfwidth": peak["halfwidth"],
            "unloading_slope": (peak["force"] - first["force"]) / (peak["depth"] - first["depth"]),
            "permanent_depth": released["depth"] + released["gap"],
            # A little below: the cylinder's mesh has a point at the origin, too.
            "imprint_depth": -float(self.imprint(model.mesh(0, -1e-5 * model.h))[1]),
            "released": released["closed"] == 0,
            "reloading_force_ratio": again["force"] / peak["force"],
            "plastic_strain": peak["plastic_strain"],
            "reloading_plastic_ratio": again["plastic_volume"] / flowed if flowed else 1.0,
            "balance": max(abs(r["reaction"] - r["force"]) for r in curve) / peak["force"],
            "last_residuals": self.residuals,
            "steps": len(curve),
            "newton_iterations": [row["iterations"] for row in curve],
            "newton_max": max(row["iterations"] for row in curve),
            "cuts": sum(row["cuts"] for row in curve),
            "curve": [[row["depth"], row["force"]] for row in curve],
            "ndof": len(model.gf.vec),
            "h": model.h,
        }


def Onset(h=0.2, zone=5.0, size=40.0, radius=100.0, young=70e3, **options):
    """Peak pressure over yield stress when yield begins.

    In the elastic state all stresses grow together: one step on a block that does not yield tells
    the ratio of the peak pressure to the largest von Mises stress. The contact is small against the
    block, and wide against the mesh.
    """
    options |= {"radius": radius, "young": young, "yield_stress": young}
    elastic = Indenter(h=0.5 * h, zone=0.3 * zone, size=2.5 * size, **options)
    (row,) = elastic.Advance([1.5 * (0.3 * zone) ** 2 / radius])
    return row["peak_pressure"] / row["mises"]


def Imprint(cycle, axes, factor=15):
    """The accumulated plastic strain on the block after the cylinder has left."""
    material = cycle.indenter.material
    space = H1(cycle.indenter.mesh, order=1, definedon="block")
    (u, v), rule = space.TnT(), dx("block", intrules=material.rules)
    mass = BilinearForm(u * v * rule).Assemble()
    load = LinearForm(material.accumulated * v * rule).Assemble()
    values = 100 * (mass.mat.Inverse(space.FreeDofs()) * load.vec).Evaluate().FV().NumPy()
    moved, faces = Deformed(cycle.imprint, ("block",), factor)
    drawn = axes.tripcolor(*moved.T, faces, values, shading="gouraud", cmap="YlOrRd", vmin=0)
    axes.triplot(*moved.T, faces, color="k", lw=0.1)
    axes.figure.colorbar(drawn, ax=axes, label="accumulated plastic strain [%]", shrink=0.75)
    width = cycle.loading[-1]["halfwidth"]
    axes.set(xlim=(0, 2.2 * width), ylim=(-2 * width, 1), aspect="equal")
    axes.set_title(f"displacement x {factor}")


def Write(cycle, folder):
    """Force over depth, mean pressure over width, the imprint; the surface for ParaView."""
    block, elastic = cycle.indenter, np.linspace(0.1, 6)
    rows = [row for row in cycle.loading if row["closed"] > 3]
    width = [row["scaled_width"] for row in rows]
    mean = [row["mean_pressure"] / block.yield_stress for row in rows]
    with Picture(folder, "indentation", columns=3, size=(11.5, 3.6)) as (left, middle, right):
        for name in ("loading", "unloading", "reloading"):
            path = [(row["depth"], row["force"]) for row in getattr(cycle, name)]
            left.plot(*np.transpose(path), ".-", lw=1, label=name)
        left.set(xlabel="depth of the cylinder [mm]", ylabel="force [N/mm]")
        middle.semilogx(elastic, math.pi / 8 * elastic, "k", lw=0.9, label="Hertz")
        middle.axhline(PRANDTL, color="k", lw=0.9, ls="--", label="rigid plastic")
        middle.plot(width, mean, ".-", label="computed")
        middle.set(xlabel="E* a / (Y R)", ylabel="mean pressure / Y", xlim=(1, None))
        left.legend()
        middle.legend()
        Imprint(cycle, right)
    block.contact.WriteVTU(folder / "indentation_top", displacement=block.displacement)


def Run(depth=0.08, steps=16, back=16, out=None, quiet=True, **options):
    """Press in, withdraw, press again; the other options are those of `Indenter`."""
    cycle = Cycle(Indenter(**options), depth, steps, back, printing=not quiet)
    figures = {"onset_pressure": Onset(**options)} | cycle.Figures()
    if out:
        Write(cycle, out)
    if not quiet:
        onset, hertz = figures["onset_pressure"], figures["onset_pressure_hertz"]
        print(f"peak pressure over yield stress at onset {onset:.4f}, Hertz {hertz:.4f}")
        mean = figures["mean_pressure_ratio"]
        print(f"mean pressure over yield stress {mean:.4f}, rigid plastic {PRANDTL:.4f}")
        print(f"depth left {figures['imprint_depth']:.5f} mm of {depth} mm")
    return figures


main = Main(
    Run,
    __doc__,
    Indenter,
    h=(Positive, "edge length in the contact zone, in mm"),
    depth=(Positive, "largest depth, in mm"),
    steps=(Count, "loading steps"),
    yield_stress=(Positive, "in MPa"),
    hardening=(NotNegative, "slope of the yield stress, in MPa"),
)


if __name__ == "__main__":
    main()
