"""A problem of the stress set: what a user would write, and nothing tuned."""

from dataclasses import dataclass, field

import numpy as np
from ngsolve import (
    BilinearForm,
    CoefficientFunction,
    Det,
    Grad,
    GridFunction,
    Id,
    InnerProduct,
    Parameter,
    Sym,
    Trace,
    Variation,
    VectorH1,
    ds,
    dx,
    log,
)

from ngslac import ContactSolver, LACContact, LACSpace, LoadStepper

__all__ = ["PROBLEMS", "Problem", "problem"]

PROBLEMS = {}


@dataclass(frozen=True)
class Made:
    """Builds a problem when called; knows the module that describes it."""

    function: object
    arguments: tuple
    flags: dict

    @property
    def module(self):
        return self.function.__module__

    def __call__(self):
        return self.function(*self.arguments, **self.flags)


def problem(*arguments, **flags):
    """Register a function of one argument as problems NAME-ARGUMENT; without arguments as NAME."""

    def register(function):
        name = function.__name__.lower()
        for argument in arguments:
            key = name + "-" + "-".join(map(str, np.atleast_1d(np.array(argument, dtype=object))))
            PROBLEMS[key] = Made(function, (argument,), flags)
        if not arguments:
            PROBLEMS[name] = Made(function, (), flags)
        return function

    return register


def Lame(E, nu):
    """Both of Lame's constants."""
    return E / 2 / (1 + nu), E * nu / (1 + nu) / (1 - 2 * nu)


@dataclass
class Problem:
    """Bodies, contacts, loads and the path of the load parameter.

    Parameters
    ----------
    mesh : ngsolve.Mesh
    pairs : list of (slave, master) or (slave, gap function of a rigid obstacle)
    young : dict
        Young's modulus of each body.
    nonlinear : bool
        Neo-Hooke in place of linear elasticity.
    law : dict
        For every LACContact.
    own : dict
        Number of a pair -> what differs for its LACContact.
    path : list of (end, steps)
        For `LoadStepper.Integrate`.
    """

    mesh: object
    pairs: list
    young: dict
    nu: float = 0.3
    nonlinear: bool = False
    order: int = 2
    space: object = VectorH1
    flags: dict = field(default_factory=dict)  # of the displacement space
    law: dict = field(default_factory=dict)
    own: dict = field(default_factory=dict)
    path: list = field(default_factory=lambda: [(1.0, 1)])
    condense: bool = False
    load: object = field(default_factory=lambda: Parameter(0.0))
    prescribe: object = None
    exact: object = None  # exact(problem) raises AssertionError if the end is wrong
    outlines: bool = True  # the boundary of each body is one chain of edges, as Grids makes it
    says: str = ""  # what the error of a problem without solution has to say, as a pattern

    def __post_init__(self):
        self.stepper = None
        self.largest = self.work = 0.0  # traction and force so far, for the checks
        slaves = [pair[0] for pair in self.pairs]
        self.laws = [self.law | self.own.get(k, {}) for k in range(len(self.pairs))]
        V = (
            self.space(self.mesh, order=self.order, slave="|".join(slaves), **self.flags)
            if (self.space is not VectorH1)
            else VectorH1(self.mesh, order=self.order, **self.flags)
        )
        points = np.array([v.point for v in self.mesh.vertices])
        self.extent = np.ptp(points, axis=0).max()
        self.X = V
        for slave in slaves:
            self.X = self.X * LACSpace(V, slave=slave)
        (self.u, *lams), (self.v, *_) = self.X.TnT()
        self.gf = GridFunction(self.X)
        self.a = BilinearForm(self.X, condense=self.condense)
        for body, E in self.young.items():
            self._AddBody(body, *Lame(E, self.nu))
        self.contacts = []
        for (_, other), lam, law in zip(self.pairs, lams, self.laws, strict=True):
            side = "obstacle" if isinstance(other, CoefficientFunction) else "master"
            self.contacts.append(LACContact(self.u, lam, **{side: other}, **law))

    def _AddBody(self, body, mu, lame):
        d, u, v = self.mesh.dim, self.u, self.v
        if self.nonlinear:
            F = Id(d) + Grad(u)
            energy = mu / 2 * (InnerProduct(F, F) - d) - mu * log(Det(F))
            self.a += Variation((energy + lame / 2 * log(Det(F)) ** 2).Compile() * dx(body))
        else:
            strain = Sym(Grad(u))
            stress = 2 * mu * strain + lame * Trace(strain) * Id(d)
            self.a += InnerProduct(stress, Sym(Grad(v))) * dx(body)

    # --- loads -----------------------------------------------------------------------------------

    def Spring(self, region, motion, stiffness):
        """Springs between a boundary and something that moves by `motion`."""
        self.a += stiffness * InnerProduct(self.u - motion, self.v) * ds(region)

    def Traction(self, region, traction):
        self.a += -InnerProduct(traction, self.v) * ds(region)

    def Weight(self, body, force):
        self.a += -InnerProduct(force, self.v) * dx(body)

    def Growth(self, body, strain):
        """Thermal strain of a body, the same in all directions; linear bulk only."""
        mu, lame = Lame(self.young[body], self.nu)
        stress = (2 * mu + self.mesh.dim * lame) * strain
        self.a += -stress * Trace(Grad(self.v)) * dx(body)

    # --- the script ------------------------------------------------------------------------------

    def Run(self, callback=None, printing=False, watch=None):
        """What every user writes: no argument is tuned."""
        self.solver = ContactSolver(self.a, self.gf, self.contacts)
        if watch:
            watch(self.solver)
        self.stepper = LoadStepper(self.solver, self.load, prescribe=self.prescribe)
        for end, steps in self.path:
            self.stepper.Integrate(end, steps=steps, callback=callback, printing=printing)
        return self.stepper.steps
