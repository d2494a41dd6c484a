"""Block, cylinder and solver of the example `indentation`, and what is measured in a step."""

import math
from itertools import pairwise

import numpy as np
from ngsolve import *
from plasticity import J2Plasticity, PlaneStrain

from ngslac import ContactSolver, LACContact, LACSpace, LoadStepper
from ngslac.meshes.geometry import (
    Arc,
    Body,
    Divisions,
    GenerateMesh,
    Line,
    NonMatchingDivisions,
    Polygon,
    Touching,
)

PUNCH = 100.0  # all is meshed with this radius: netgen has absolute lengths


def IndentationMesh(h, *, radius=100.0, zone=5.0, size=40.0):
    """Mesh of half a block and of the lowest part of a cylinder that touches it at the origin.

    Bodies (materials): "block" and "cylinder", of which only a slice above the arc is meshed: it is
    meant to be rigid. Boundaries: "slave" (the block's top where contact can be), "top" (the rest),
    "side", "bottom", "sym" (x = 0, block); "master" (the arc) and "back" (all else of the
    cylinder).

    `h` is the length of the slave edges, the arc's are nearly twice as long and curved; `zone` is
    the half width of the slave side, `size` the half width and the height of the block.
    """
    scale = radius / PUNCH
    h, zone, size = h / scale, zone / scale, size / scale
    if not zone < min(0.8 * size, 0.5 * PUNCH):
        raise ValueError(f"zone = {zone * scale:g} is too long for the block or the cylinder")
    return GenerateMesh(
        [HalfBlock(size, zone, Divisions(zone, h)), CylinderSlice(zone, Divisions(zone, h))],
        order=3,
        scale=scale,
        maxh=size / 5,
        grading=0.3,
    )


def HalfBlock(size, zone, count):
    corners = [(0, -size), (size, -size), (size, 0), (zone, 0), (0, 0)]
    return Polygon(corners, ("bottom", "side", "top", "slave", "sym"), "block", slave=count)


def CylinderSlice(zone, count):
    """The slice between the arc and a level line; its nodes avoid those of the slave side."""
    reach = 1.1 * zone
    angle = math.asin(reach / PUNCH)
    nodes = [PUNCH * math.asin(k * zone / count / PUNCH) for k in range(count + 1)]
    edges = NonMatchingDivisions(nodes, 0, PUNCH * angle, 1.8 * zone / count)
    point, level = Touching(PUNCH), PUNCH * (1 - math.cos(angle)) + 0.3 * zone
    corners = [point(angle), (reach, level), (0, level), point(0)]
    back = [Line(p, q, "back") for p, q in pairwise(corners)]
    return Body([Arc(point, 0, angle, "master", edges), *back], "cylinder")


class Indenter:
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
            "gap": float(np.nanmin(table["gap"])),
            "closed": len(closed),
        }

    def _Reaction(self):
        """Vertical force of the foundation on the bottom of the block."""
        forces, lift = self.gf.vec.CreateVector(), GridFunction(self.displacement.space)
        self.solver.a.Apply(self.gf.vec, forces)
        lift.Set((0, 1), definedon=self.mesh.Boundaries("bottom"))
        return float(np.dot(lift.vec.FV().NumPy(), forces.FV().NumPy()[: len(lift.vec)]))
