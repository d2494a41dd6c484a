"""The patch test of two blocks with large strains: one deformation gradient in each block.

Two neo-Hookean materials, energy  mu/2 (F:F - d) - mu ln J + lame/2 (ln J)^2.  The blocks are
stretched along the interface and pushed on each other. Where both are stretched alike they may
be sheared as well and stick; without friction the stretches differ such that blocks of different
width end up equally wide: the surfaces then slide over each other, the edge of the slave to the
rim of the master.

Pressures stay below 1.1 times the slave's mu: at about 1.6 (order 2) these states lose their
stability, since a face that is held on average only may wrinkle under so large a pressure.
"""

import numpy as np
from elasticity import Displacements
from ngsolve import (
    CF,
    VOL,
    BilinearForm,
    Det,
    Grad,
    GridFunction,
    Id,
    InnerProduct,
    IntegrationRule,
    Parameter,
    Variation,
    ds,
    dx,
    log,
    specialcf,
    x,
    y,
    z,
)
from scipy.optimize import root

from ngslac import ContactSolver, LACContact, LACSpace, LoadStepper

MATERIALS = {"upper": (40.0, 60.0), "lower": (25.0, 70.0)}
SPRING = 1e3


def Piola(F, mu, lame):
    """First Piola-Kirchhoff stress (d, d)."""
    inverse = np.linalg.inv(F).T
    return mu * (F - inverse) + lame * np.log(np.linalg.det(F)) * inverse


def Gradients(stretches, total):
    """Deformation gradients of the upper and the lower block of equal heights.

    Parameters
    ----------
    stretches : (2,)
        Along the interface, of the upper and the lower block; both directions in 3D.
    total : (d,)
        Where a line across both blocks goes, per height of one block: twice the normal where
        nothing happens.
    """
    d = len(total)

    def gradients(upper):
        both = []
        for stretch, across in zip(stretches, (upper, total - upper), strict=True):
            F = stretch * np.eye(d)
            F[:, -1] = across
            both.append(F)
        return both

    def imbalance(upper):
        """Of the forces on the interface, both per area of the current configuration."""
        forces = [
            Piola(F, *material)[:, -1] / stretch ** (d - 1)
            for F, material, stretch in zip(
                gradients(upper), MATERIALS.values(), stretches, strict=True
            )
        ]
        return forces[0] - forces[1]

    upper = root(imbalance, total / 2, tol=1e-13).x
    assert np.abs(imbalance(upper)).max() <= 1e-11
    return gradients(upper)


class Block:
    """The exact solution of one block, as numbers and as functions that follow them."""

    def __init__(self, dim, origin, rotation, material):
        self.material, self.rotation, self.origin = material, rotation, rotation @ origin
        self.F, self.P = np.eye(dim), np.zeros((dim, dim))
        self._F = [Parameter(v) for v in self.F.ravel()]
        self._P = [Parameter(v) for v in self.P.ravel()]
        self._c = [Parameter(v) for v in self.origin]
        X = CF((x, y, z)[:dim])
        F, c = CF(tuple(self._F), dims=(dim, dim)), CF(tuple(self._c))
        self.displacement = F * (X - CF(tuple(self.origin))) + c - X
        self.stress = CF(tuple(self._P), dims=(dim, dim))

    def Set(self, F, place):
        """Gradient in the frame of the blocks, and where the origin goes."""
        self.F, self.P = F, Piola(F, *self.material)
        R = self.rotation
        values = (R @ F @ R.T, R @ self.P @ R.T, R @ place)
        for parameters, value in zip((self._F, self._P, self._c), values, strict=True):
            for p, v in zip(parameters, np.ravel(value), strict=True):
                p.Set(v)

    def Energy(self, u):
        mu, lame = self.material
        F = Id(u.dim) + Grad(u)
        return (
            mu / 2 * (InnerProduct(F, F) - u.dim) - mu * log(Det(F)) + lame / 2 * log(Det(F)) ** 2
        )


class LargePatch:
    """Blocks of height 1 on all outer faces of which act the exact tractions.

    Springs hold what the tractions leave free: normal to all outer faces, or, where the blocks
    `stick`, in all directions above and below. At the exact solution they carry nothing.
    """

    def __init__(self, mesh, kind, *, stretches, total, rotation=None, stick=False, **law):
        V = Displacements(mesh, kind)
        self.mesh, self.dim = V.mesh, V.mesh.dim
        self.stretches, self.total = np.array(stretches), np.array(total)
        self.rotation = np.eye(self.dim) if rotation is None else rotation
        X = V * LACSpace(V, slave="slave")
        (u, lam), (v, _) = X.TnT()
        self.middle = np.array([0.5] * (self.dim - 1) + [0.0])
        self.up = np.eye(self.dim)[-1]
        origins = {"upper": self.middle, "lower": self.middle - self.up}
        self.blocks = {
            name: Block(self.dim, origin, self.rotation, MATERIALS[name])
            for name, origin in origins.items()
        }
        self.a, self.gf, self.load = BilinearForm(X), GridFunction(X), Parameter(0.0)
        N = specialcf.normal(self.dim)
        for name, block in self.blocks.items():
            self.a += Variation(block.Energy(u).Compile() * dx(name))
            end = "top" if name == "upper" else "bottom"
            sides = f"{end}|(left|right|front|back)_{name}"
            self.a += -InnerProduct(block.stress * N, v) * ds(sides)
            off = u - block.displacement
            self.a += SPRING * (off * N) * (v * N) * ds(sides)
            if stick:
                self.a += SPRING * InnerProduct(off, v) * ds(end)
        self.contact = LACContact(u, lam, master="master", finite=True, **law)
        self.solver = ContactSolver(self.a, self.gf, self.contact)
        self.stepper = LoadStepper(self.solver, self.load, prescribe=self.Prescribe)

    def Prescribe(self, _):
        t = self.load.Get()
        stretches = 1 + t * (self.stretches - 1)
        total = 2 * self.up + t * (self.total - 2 * self.up)
        upper, lower = Gradients(stretches, total)
        self.blocks["lower"].Set(lower, self.middle - self.up)
        self.blocks["upper"].Set(upper, self.middle - self.up + lower[:, -1])

    def Run(self, steps):
        self.stepper.Integrate(steps=steps, printing=False, tol=1e-12)
        self.contact.Evaluate(self.gf)

    def Errors(self):
        """Largest ones of displacement (at nodes and inside), traction (relative) and gap."""
        exact = self.mesh.MaterialCF({n: b.displacement for n, b in self.blocks.items()})
        off = self.gf.components[0] - exact
        worst = max(
            np.abs(off(self.mesh.MapToAllElements(IntegrationRule(shape, 4), VOL))).max()
            for shape in {el.type for el in self.mesh.Elements(VOL)}
        )
        table, R = self.contact.Table(), self.rotation
        traction = R @ self.blocks["upper"].P @ -self.up
        size = np.linalg.norm(traction)
        pressure = self.up @ self.blocks["upper"].P @ -self.up
        return {
            "displacement": worst,
            "traction": np.abs(table["traction"] - traction).max() / size,
            "pressure": np.abs(table["pressure"] - pressure).max() / size,
            "gap": np.abs(table["gap"]).max(),
            "area": np.abs(table["area"] / table["fullarea"] - 1).max(),
        }
