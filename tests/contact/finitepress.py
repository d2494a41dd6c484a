"""Two neo-Hookean blocks whose far sides are led along given paths: finite sliding in earnest."""

import numpy as np
from finiteform import POSITIONS, rotation
from ngsolve import (
    CF,
    BilinearForm,
    Det,
    Grad,
    GridFunction,
    Id,
    InnerProduct,
    Parameter,
    Variation,
    VectorH1,
    dx,
    log,
)

from ngslac import ContactSolver, LACContact, LACSpace, LoadStepper
from ngslac.meshes import TwoBlocks
from ngslac.meshes.blocks3d import TwoBlocks3D

MU, LAME = 40.0, 60.0


def neo_hooke(u):
    d = u.dim
    F = Id(d) + Grad(u)
    energy = MU / 2 * (InnerProduct(F, F) - d) - MU * log(Det(F)) + LAME / 2 * log(Det(F)) ** 2
    return Variation(energy.Compile() * dx)


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
    shift : callable
        Translation of everything, from the load.
    """

    def __init__(self, mesh, lead, *, turn=None, shift=None, order=2, axis=(1, -2, 0.5), **law):
        self.mesh, self.dim = mesh, mesh.dim
        self.lead, self.axis = lead, axis
        self.turn = turn or (lambda t: 0.0)
        self.shift = shift or (lambda t: np.zeros(mesh.dim))
        V = VectorH1(mesh, order=order, dirichlet="top|bottom")
        self.X = V * LACSpace(V, slave="slave")
        u, lam = self.X.TrialFunction()
        self.a = BilinearForm(self.X)
        self.a += neo_hooke(u)
        self.gf = GridFunction(self.X)
        self.load = Parameter(0.0)
        self.contact = LACContact(u, lam, master="master", finite=True, **law)
        self.solver = ContactSolver(self.a, self.gf, self.contact)
        self.stepper = LoadStepper(self.solver, self.load, prescribe=self.prescribe)
        positions = GridFunction(V)
        positions.Set(CF(POSITIONS[: self.dim]))
        self.reference = positions.vec.FV().NumPy().reshape(self.dim, -1).copy()

    def prescribe(self, gf):
        t = self.load.Get()
        R = rotation(self.dim, self.turn(t), self.axis)
        r = CF(POSITIONS[: self.dim])
        R, shift = CF(tuple(R.ravel()), dims=R.shape), CF(tuple(self.shift(t)))
        top = R * (r + CF(tuple(self.lead(t)))) - r + shift
        values = self.mesh.BoundaryCF({"top": top, "bottom": R * r - r + shift})
        gf.components[0].Set(values, definedon=self.mesh.Boundaries("top|bottom"))

    def run(self, end=1.0, steps=1, **flags):
        return self.stepper.Integrate(end, steps=steps, **({"printing": False} | flags))

    def solve(self, load, **flags):
        """A step that is not committed: slip stays that of the step."""
        self.load.Set(load)
        before = self.gf.vec.FV().NumPy().copy()
        self.prescribe(self.gf)
        wanted = self.gf.vec.FV().NumPy().copy()
        fixed = self.solver.constrained
        self.gf.vec.FV().NumPy()[:] = np.where(fixed, wanted, before)
        motion = np.where(fixed, wanted - before, 0.0)
        self.gf.vec.FV().NumPy()[:] = before
        return self.solver.Solve(printing=False, motion=motion, **flags)

    def table(self, gf=None):
        self.contact.Evaluate(gf or self.gf)
        return {k: v.copy() for k, v in self.contact.Table().items()}

    def moved(self, degrees, shift):
        """A copy of the solution after a rotation and a translation of everything."""
        R = rotation(self.dim, degrees, self.axis)
        gf = GridFunction(self.X)
        u = self.gf.components[0].vec.FV().NumPy().reshape(self.dim, -1)
        ones = GridFunction(self.gf.components[0].space)
        ones.Set(CF((1,) * self.dim))
        one = ones.vec.FV().NumPy().reshape(self.dim, -1)
        shifted = one * np.array(shift, dtype=float)[:, None]
        moved = R @ (self.reference + u) - self.reference + shifted
        gf.components[0].vec.FV().NumPy()[:] = moved.ravel()
        dofs = self.contact.form.MultiplierDofs().reshape(-1, self.dim)
        values = self.gf.vec.FV().NumPy()
        gf.vec.FV().NumPy()[dofs] = values[dofs] @ R.T
        return gf, R

    def residuals(self, gf):
        """Of the bulk and of the contact form."""
        bulk, contact = self.gf.vec.CreateVector(), self.gf.vec.CreateVector()
        self.a.Apply(gf.vec, bulk)
        self.contact.Apply(gf.vec, contact)
        return bulk.FV().NumPy().copy(), contact.FV().NumPy().copy()


def blocks2d(h=0.2, **flags):
    options = {"structured": True, "overhang": 0.3, "aligned": False, "height": 0.5}
    return TwoBlocks(h, **(options | flags))


def blocks3d(*kinds, n=(3, 2), **flags):
    options = {"overhang": 0.3, "aligned": False, "height": 0.6}
    return TwoBlocks3D(*kinds, *n, **(options | flags))
