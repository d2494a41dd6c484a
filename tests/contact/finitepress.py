"""Two neo-Hookean blocks whose far sides are led along given paths: finite sliding in earnest."""

import numpy as np
from blocks import macro_dofs
from form import POSITIONS, rotation
from ngsolve import CF, BilinearForm, Grad, GridFunction, Id, Parameter, Variation, VectorH1, dx

from ngslac import ContactSolver, LACContact, LACSpace, LoadStepper
from ngslac.materials import NeoHooke
from ngslac.meshes import TwoBlocks
from ngslac.meshes.blocks3d import TwoBlocks3D


def soft(F):
    return NeoHooke(F, 104, 0.3)


class Led:
    """Blocks "upper" and "lower"; `lead(load)` says where the top goes, then both are turned.

    Parameters
    ----------
    mesh : Mesh
        With "top" and "bottom", which are held in all directions.
    lead : callable
        Displacement of the top as a tuple, from the load.
    turn : callable
        Angle in degrees of the rotation of everything, from the load.
    energy : callable
        Per volume, from the deformation gradient.
    """

    def __init__(self, mesh, lead=None, *, turn=lambda load: 0.0, order=2, energy=soft, **law):
        self.mesh, self.dim = mesh, mesh.dim
        self.lead, self.turn = lead, turn
        V = VectorH1(mesh, order=order, dirichlet="top|bottom")
        X = V * LACSpace(V, slave="slave")
        u, lam = X.TrialFunction()
        self.a = BilinearForm(X)
        self.a += Variation(energy(Id(self.dim) + Grad(u)).Compile() * dx)
        self.gf, self.load = GridFunction(X), Parameter(0.0)
        self.contact = LACContact(u, lam, master="master", finite=True, **law)
        self.solver = ContactSolver(self.a, self.gf, self.contact)
        self.stepper = LoadStepper(self.solver, self.load, prescribe=self.prescribe)
        self.reference = self.nodal(CF(POSITIONS[: self.dim]))

    def nodal(self, field):
        """Values of a field in the displacements' space, (dim, n)."""
        gf = GridFunction(self.gf.components[0].space)
        gf.Set(field)
        return gf.vec.FV().NumPy().reshape(self.dim, -1).copy()

    def prescribe(self, gf):
        t, r = self.load.Get(), CF(POSITIONS[: self.dim])
        R = rotation(self.dim, self.turn(t))
        R = CF(tuple(R.ravel()), dims=R.shape)
        values = self.mesh.BoundaryCF({"top": R * (r + CF(self.lead(t))) - r, "bottom": R * r - r})
        gf.components[0].Set(values, definedon=self.mesh.Boundaries("top|bottom"))

    def run(self, end=1.0, steps=1, **flags):
        return self.stepper.Integrate(end, steps=steps, **({"printing": False} | flags))

    def solve(self, load, **flags):
        """A step that is not committed: slip stays that of the step."""
        self.load.Set(load)
        values = self.gf.vec.FV().NumPy()
        before = values.copy()
        self.prescribe(self.gf)
        motion = np.where(self.solver.constrained, values - before, 0.0)
        values[:] = before
        return self.solver.Solve(printing=False, motion=motion, **flags)

    def table(self, gf=None):
        self.contact.Evaluate(gf or self.gf)
        return {k: v.copy() for k, v in self.contact.Table().items()}

    def moved(self, degrees, shift):
        """A copy of the solution after a rotation and a translation of everything."""
        gf, R = GridFunction(self.gf.space), rotation(self.dim, degrees)
        u = self.gf.components[0].vec.FV().NumPy().reshape(self.dim, -1)
        shifted = self.nodal(CF(tuple(map(float, shift))))
        moved = R @ (self.reference + u) - self.reference + shifted
        gf.components[0].vec.FV().NumPy()[:] = moved.ravel()
        dofs = macro_dofs(self.contact)
        gf.vec.FV().NumPy()[dofs] = self.gf.vec.FV().NumPy()[dofs] @ R.T
        return gf, R

    def residuals(self, gf):
        """Of the bulk and of the contact form."""
        found = []
        for part in (self.a, self.contact):
            out = self.gf.vec.CreateVector()
            part.Apply(gf.vec, out)
            found.append(out.FV().NumPy().copy())
        return found


def blocks2d(h=0.2, **flags):
    options = {"structured": True, "overhang": 0.3, "aligned": False, "height": 0.5}
    return TwoBlocks(h, **(options | flags))


def blocks3d(*kinds, n=(3, 2), **flags):
    options = {"overhang": 0.3, "aligned": False, "height": 0.6}
    return TwoBlocks3D(*kinds, *n, **(options | flags))
