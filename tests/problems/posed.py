"""Bodies with one contact, from a displacement space and functions that give their integrals."""

from dataclasses import dataclass

from ngsolve import BilinearForm, Grad, GridFunction, InnerProduct, Parameter, Sym, dx, pi, x

from ngslac import ContactSolver, LACContact, LACSpace, LoadStepper
from ngslac.materials import AxisymmetricGrad, Stress


@dataclass
class Posed:
    """The parts of a problem; `load` is a Parameter that some of them know."""

    mesh: object
    X: object
    a: object
    gf: object
    contact: object
    load: object

    def solver(self, **flags):
        return ContactSolver(self.a, self.gf, self.contact, **flags)

    def stepper(self, **flags):
        return LoadStepper(self.solver(), self.load, **flags)


def elastic(young, nu=0.0):
    """The integral of linear elasticity."""
    return lambda u, v, load: InnerProduct(Stress(Sym(Grad(u)), young, nu), Sym(Grad(v))) * dx


def revolved(young, nu):
    """The same of a body of revolution."""

    def Integral(u, v, load):
        strain, virtual = (Sym(AxisymmetricGrad(w)) for w in (u, v))
        return 2 * pi * x * InnerProduct(Stress(strain, young, nu), virtual) * dx

    return Integral


def stressed(stress):
    """The integral of a stress that is a function of the gradient."""
    return lambda u, v, load: InnerProduct(stress(Grad(u)), Grad(v)) * dx


def posed(V, *bulk, slave="slave", axisymmetric=False, condense=False, load=None, **law):
    """The parts of a problem on the displacement space V, with a LACSpace on one surface.

    ``bulk(u, v, load)`` are the integrals; the rest goes to LACContact, whose master is "master" if
    there is no obstacle.
    """
    X = V * LACSpace(V, slave=slave, axisymmetric=axisymmetric)
    (u, lam), (v, _) = X.TnT()
    a, load = BilinearForm(X, condense=condense), Parameter(1.0) if load is None else load
    for integral in bulk:
        a += integral(u, v, load)
    law = law if "obstacle" in law else {"master": "master"} | law
    return Posed(V.mesh, X, a, GridFunction(X), LACContact(u, lam, **law), load)
