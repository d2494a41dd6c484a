"""NGSolve's own contact in the comparison: `ContactBoundary` with a penalty or Nitsche's method.

    python tests/benchmarks/peers/contactboundary.py sphere s.npz --variant penalty --json row.json

The README beside it has the method. The gap is measured along the normals of the undeformed slave.
The pressure is evaluated pointwise and projected in L2 to continuous functions, linear on the faces
(2D: to linear functions on each edge).
"""

from __future__ import annotations

import importlib.metadata
import sys

import ngsolve as ngs
import numpy as np
from elastic import CornerProjection, Displacements, Elastic, Errors, Loads, Projection, Read
from meshes import BODIES, SHIFT
from metrics import NU, RADIUS, STRAIN, YOUNG
from ngsolve import CF, H1, BilinearForm, GridFunction, IfPos, InnerProduct, SurfaceL2, x, y, z
from peercommand import Main

from ngslac.linear.factor import LU, Cholesky
from ngslac.materials import Stress

__all__ = ["Options", "Solve"]

TOLERANCE, MOST = 1e-10, 60  # residual over load, Newton steps
TANGENTIAL = 0.1  # times the normal penalty
SEARCH = {"hertz": 20.0, "sphere": 10.0, "patch": 0.3}  # mm: farther points do not pair


class Contact:
    """The contact law of a problem for `ContactBoundary.AddIntegrator`."""

    def __init__(self, peermesh, mesh, arguments):
        self.problem, self.mesh, self.arguments = peermesh.problem, mesh, arguments
        self.slave, _ = bodies = BODIES[self.problem]
        self.penalty = arguments.gamma * min(YOUNG[name] for name in bodies) / peermesh.h
        self.point = CF((x, y, z)[: mesh.dim])
        arm = self.point - CF((0.0,) * (mesh.dim - 1) + (RADIUS,))
        self.normal = CF((0, 0, -1)) if self.problem == "patch" else arm / ngs.Norm(arm)
        self.tangent = CF((-self.normal[1], self.normal[0]))
        self.nitsche = arguments.variant == "nitsche"
        self.old, self.sheared = None, None  # displacement and tangential traction of the last step

    def Pressure(self, u):
        """Pressure of a displacement, on the slave side."""
        depth = (self.point + u - self.point.Other() - u.Other()) * self.normal
        pressure = self.penalty * depth
        if self.nitsche:
            stress = Stress(ngs.Sym(ngs.Grad(u)), YOUNG[self.slave], NU)
            pressure -= InnerProduct(stress * self.normal, self.normal)
        return IfPos(pressure, pressure, 0)

    def Tangential(self, u):
        """Traction along the tangent of the slave edge in 2D: return mapping from the last step."""
        moved = u - u.Other()
        if self.old is not None:
            moved -= self.old - self.old.Other()
        limit = self.arguments.friction * self.Pressure(u)
        trial = self.sheared + TANGENTIAL * self.penalty * moved * self.tangent
        return IfPos(trial - limit, limit, IfPos(-limit - trial, -limit, trial))

    def Traction(self, u):
        """Of the slave on the master."""
        traction = self.Pressure(u) * self.normal
        if self.arguments.friction:
            traction += self.Tangential(u) * self.tangent
        return traction

    def AddTo(self, form, space, integrand):
        """A `ContactBoundary`, paired in the undeformed configuration; a form does not keep it."""
        sides = (self.mesh.Boundaries("slave"), self.mesh.Boundaries("master"))
        contact, order = ngs.ContactBoundary(*sides, volume=self.nitsche), self.arguments.order
        contact.AddIntegrator(integrand)
        distance = SEARCH[self.problem]
        contact.Update(GridFunction(space), form, intorder=2 * order + 4, maxdist=distance)
        return contact

    def Form(self, space):
        u, v = space.TnT()
        form = BilinearForm(space)
        form += Elastic(self.mesh, u, v)
        return form, self.AddTo(form, space, self.Traction(u) * (v - v.Other()))

    def Moments(self, quantity, displacement, space):
        """Integrals of ``quantity(u)`` times the basis functions of `space` over the slave."""
        product = displacement.space * space
        (u, _), (_, q) = product.TnT()
        form = BilinearForm(product)
        kept = self.AddTo(form, displacement.space, quantity(u) * q)
        state = GridFunction(product)
        state.components[0].vec.data = displacement.vec
        result = state.vec.CreateVector()
        form.Apply(state.vec, result)
        del kept
        part = product.Range(1)
        return result.FV().NumPy()[part.start : part.stop].copy()


# ---------------------------------------------------------------- Newton


def Solve(peermesh, arguments, watch):
    """Solve a problem; see `peercommand.Main`."""
    if arguments.friction and (peermesh.dim == 3 or arguments.variant == "nitsche"):
        raise ValueError("friction only in 2D and with the penalty")
    mesh = Read(arguments)
    with ngs.TaskManager():
        with watch.Running():
            space = Displacements(mesh, arguments)
            contact = Contact(peermesh, mesh, arguments)
            gf, iterations = Steps(peermesh, contact, space)
        errors = Errors(peermesh, mesh, gf, lambda: Pressure(mesh, contact, gf))
    method = {"penalty": "penalty", "nitsche": "Nitsche, incomplete,"}[arguments.variant]
    return {
        "version": importlib.metadata.version("ngsolve"),
        "dofs": space.ndof,
        "iterations": iterations,
        "settings": f"{method} gamma = {arguments.gamma:g}, {Inverse(arguments)}, "
        f"residual below {TOLERANCE:g}",
        **errors,
    }


def Inverse(arguments):
    """The fastest direct solver: of MKL if that is there, as ngslac takes it."""
    symmetric = arguments.variant == "penalty" and arguments.friction == 0
    return arguments.inverse or (Cholesky() if symmetric else LU())


def Start(contact, gf):
    """A first displacement: the slave is a little inside of the master, and contact holds it."""
    depth = SHIFT[contact.problem]
    if contact.problem == "patch":
        depth = STRAIN * (1 + YOUNG["upper"] / contact.penalty)
    down = CF((0.0,) * (contact.mesh.dim - 1) + (-depth,))
    gf.Set(down, definedon=contact.mesh.Materials(contact.slave))


def Steps(peermesh, contact, space):
    """All load steps; returns the displacement and the number of linear solves."""
    mesh, arguments = contact.mesh, contact.arguments
    gf, load = GridFunction(space), Loads(peermesh, space)
    Start(contact, gf)
    history = SurfaceL2(mesh, order=arguments.order)
    contact.sheared = GridFunction(history)
    iterations = 0
    for step in range(1, arguments.steps + 1):
        form, kept = contact.Form(space)
        iterations += Newton(form, gf, (step / arguments.steps) * load, Inverse(arguments))
        if arguments.friction:
            moments = contact.Moments(contact.Tangential, gf, history)
            contact.sheared.vec.data = Projection(mesh, moments, history).vec
            contact.old = GridFunction(space)
            contact.old.vec.data = gf.vec
        del kept
    return gf, iterations


def Newton(form, gf, load, inverse):
    """Newton's method; returns the number of linear solves."""
    space = gf.space
    free = np.fromiter(space.FreeDofs(), dtype=bool, count=space.ndof)
    load, residual = load.Evaluate(), gf.vec.CreateVector()
    size = np.linalg.norm(load.FV().NumPy())
    flags = {"ordering": "metis"} if inverse.startswith("pardiso") else {}
    if inverse == "pardisospd":
        flags["symmetric"] = True  # or it takes the whole matrix for a triangle
    for iteration in range(MOST + 1):
        form.Apply(gf.vec, residual)
        residual.data -= load
        if iteration and np.linalg.norm(residual.FV().NumPy()[free]) < TOLERANCE * size:
            return iteration
        form.AssembleLinearization(gf.vec)
        solver = form.mat.Inverse(space.FreeDofs(), inverse=inverse, flags=flags)
        gf.vec.data -= solver * residual
    raise RuntimeError(f"no convergence in {MOST} Newton steps")


def Pressure(mesh, contact, gf):
    """Samples of the pressure for `Errors`."""
    if mesh.dim == 3:
        return CornerProjection(mesh, contact.Moments(contact.Pressure, gf, H1(mesh, order=1)))
    # With Nitsche's method NGSolve cannot mix volume elements with a space on the surface.
    space = H1(mesh, order=gf.space.globalorder) if contact.nitsche else SurfaceL2(mesh, order=1)
    pressure = Projection(mesh, contact.Moments(contact.Pressure, gf, space), space)
    rule, samples = ngs.IntegrationRule(ngs.SEGM, 3), []
    for element in mesh.Boundaries("slave").Elements():
        transformation = mesh.GetTrafo(element)  # has to live as long as its points
        samples += [(x(p), pressure(p)) for p in map(transformation, rule)]
    return np.array(samples).T


def Options(parser):
    parser.add_argument("--variant", choices=("penalty", "nitsche"), default="penalty")
    parser.add_argument("--gamma", type=float, default=10.0, help="penalty times h / E")
    parser.add_argument("--inverse", help="sparse direct solver")


if __name__ == "__main__":
    sys.exit(Main(Solve, peer="ContactBoundary", options=Options))
