"""Block, cylinder and solver of the example `indentation`, and what is measured in a step."""

import numpy as np
from ngsolve import *
from plasticity import J2Plasticity, PlaneStrain

from ngslac import ContactSolver, LACContact, LACSpace, LoadStepper
from ngslac.meshes import IndentationMesh


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
