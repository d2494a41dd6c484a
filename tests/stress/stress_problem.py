"""A problem of the stress set: what a user would write, and nothing tuned."""

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import partial

import numpy as np
from ngsolve import (
    CF,
    H1,
    BilinearForm,
    CoefficientFunction,
    Det,
    Grad,
    GridFunction,
    Id,
    IfPos,
    InnerProduct,
    Integrate,
    Parameter,
    Sym,
    Trace,
    Variation,
    VectorH1,
    ds,
    dx,
    log,
    pi,
    x,
)

from ngslac import BubbleVectorH1, ContactSolver, Flux, LACContact, LACSpace, LoadStepper
from ngslac.materials import AxisymmetricGrad

__all__ = [
    "GROUND",
    "PROBLEMS",
    "ForceOf",
    "Heat",
    "Lame",
    "MeanOf",
    "MeanPressure",
    "Moved",
    "Pressed",
    "Problem",
    "Twin",
    "problem",
]

PROBLEMS = {}
GROUND = "(base|lower)_bottom"  # is held where nothing else is told


def problem(*arguments):
    """Register a function as problems NAME-ARGUMENT-..., one for each; without any as NAME."""

    def register(function):
        for argument in arguments or [()]:
            values = argument if isinstance(argument, tuple) else (argument,)
            name = "-".join([function.__name__.lower(), *map(str, values)])
            PROBLEMS[name] = partial(function, *values)
        return function

    return register


def Lame(E, nu):
    """Both of Lame's constants."""
    return E / 2 / (1 + nu), E * nu / (1 + nu) / (1 - 2 * nu)


def Pressed(t):
    """Grows to 1 until the load is 1."""
    return IfPos(t - 1, 1, t)


def Moved(t):
    """Grows from there on."""
    return IfPos(t - 1, t - 1, 0)


@dataclass
class Twin:
    """The same law in numpy: of arrays over the macro-elements, for the checks.

    `friction` gets pressures, lengths of slip and the length of the step; `offset` gets pressures,
    lengths of slip and what it was before; `traction` gets normals, jumps and what was remembered
    before, and returns tractions and what is remembered now.
    """

    friction: Callable | None = None
    offset: Callable | None = None
    traction: Callable | None = None


@dataclass
class Heat:
    """A temperature: hot where the upper body is driven, 0 where the lower one is held.

    `flow` gets fields and temperature; `twin` is the same in numpy, of pressures, gaps and means on
    both sides.
    """

    flow: Callable
    twin: Callable
    hot: float = 1.0
    expansion: float = 0.0
    rubs: bool = False  # does friction set heat free?
    share: float = 0.3  # of the slave in that
    friction: Callable | None = None  # of the means on both sides, where it depends on these


@dataclass
class Problem:
    """Bodies, contacts, loads and the path of the load parameter.

    Vectors of loads and motions are numbers, which grow with the load, or functions of the load, or
    coefficient functions, which do not grow. The name of a body in `pairs` means its bottom, if it
    is the slave, or its top; in place of a master there may be the gap function of an obstacle.
    """

    mesh: object
    young: object = 100.0  # of all bodies, or a dict
    pairs: list = field(default_factory=lambda: [("upper", "lower")])
    friction: float | None = None
    finite: bool = False
    law: dict = field(default_factory=dict)  # of every LACContact
    own: dict = field(default_factory=dict)  # number of a pair -> what differs for it
    nonlinear: bool | None = None  # neo-Hooke; None: with finite sliding
    nu: float = 0.3
    order: int = 2
    bubble: bool = False
    condense: bool = False
    held: str = GROUND  # boundaries; heldx, ...: components
    heldx: str = ""
    heldy: str = ""
    heldz: str = ""
    drive: dict = field(default_factory=dict)  # region -> motion; is held, too
    prescribe: dict = field(default_factory=dict)
    steps: int = 1
    path: list | None = None  # (end, steps), ...
    resultant: tuple | None = None  # of the first contact at the end
    says: str = ""  # pattern of the error, if there is no solution
    once: bool = False  # one call of Solve at the end of the path, and no stepper
    rough: float = 1e-6  # part of the forces that facets make false where bodies may spin
    expected: list = field(default_factory=list)  # of the end: see Expect
    axisymmetric: bool = False
    twin: Twin | None = None  # of a law that is an expression
    heat: Heat | None = None

    def __post_init__(self):
        self.load, self.stepper = Parameter(0.0), None
        self.largest = self.work = 0.0  # traction and force so far, for the checks
        self.path = self.path or [(1.0, self.steps)]
        if not isinstance(self.young, dict):
            self.young = dict.fromkeys(self.mesh.GetMaterials(), self.young)
        if self.nonlinear is None:
            self.nonlinear = self.finite
        points = np.array([v.point for v in self.mesh.vertices])
        self.extent = np.ptp(points, axis=0).max()
        self.pairs = [(_Side(s, "bottom"), self._Partner(m)) for s, m in self.pairs]
        self._AddSpaces()
        for body, E in self.young.items():
            self._AddBody(body, *Lame(E, self.nu))
        self._AddContacts()
        moved = self.drive | self.prescribe
        self.prescribe = {region: self._Vector(value) for region, value in moved.items()} or None

    def _Partner(self, other):
        if isinstance(other, str):
            return _Side(other, "top")
        return other if isinstance(other, CoefficientFunction) else other(self.load)

    def _AddSpaces(self):
        slaves = [slave for slave, _ in self.pairs]
        held = {"dirichlet": "|".join(filter(None, [self.held, *self.drive]))}
        held |= {"dirichletx": self.heldx, "dirichlety": self.heldy, "dirichletz": self.heldz}
        flags = {"order": self.order} | {name: value for name, value in held.items() if value}
        flags |= {"slave": "|".join(slaves)} if self.bubble else {}
        self.X = V = (BubbleVectorH1 if self.bubble else VectorH1)(self.mesh, **flags)
        for slave in slaves:
            self.X = self.X * LACSpace(V, slave=slave, axisymmetric=self.axisymmetric)
        if self.heat:
            self.X = self.X * H1(self.mesh, order=self.order, dirichlet=f"{GROUND}|upper_top")
        (self.u, *others), (self.v, *tests) = self.X.TnT()
        self.lams, self.T = others[: len(slaves)], others[-1]
        self.gf = GridFunction(self.X)
        self.a = BilinearForm(self.X, condense=self.condense)
        if self.heat:
            self.a += self.ring * Grad(self.T) * Grad(tests[-1]) * dx
            top = self.mesh.Boundaries("upper_top")
            self.gf.components[-1].Set(self.heat.hot, definedon=top)

    def _AddBody(self, body, mu, lame):
        d = 3 if self.axisymmetric else self.mesh.dim
        gradient = AxisymmetricGrad if self.axisymmetric else Grad
        if self.nonlinear:
            F = Id(d) + gradient(self.u)
            energy = mu / 2 * (InnerProduct(F, F) - d) - mu * log(Det(F))
            energy += lame / 2 * log(Det(F)) ** 2
            self.a += Variation((self.ring * energy).Compile() * dx(body))
        else:
            strain = Sym(gradient(self.u))
            if self.heat:
                strain = strain - self.heat.expansion * self.T * Id(d)
            stress = 2 * mu * strain + lame * Trace(strain) * Id(d)
            self.a += self.ring * InnerProduct(stress, Sym(gradient(self.v))) * dx(body)

    def _AddContacts(self):
        law = {} if self.friction is None else {"friction": self.friction}
        law |= ({"finite": True} if self.finite else {}) | self.law
        if self.heat:
            law |= {name: partial(self._OfHeat, f) for name, f in self.law.items()}
            rubs = (lambda z: z.power) if self.heat.rubs else None
            flow = partial(self._OfHeat, self.heat.flow)
            law["flux"] = Flux(self.T, flow, heat=rubs, share=self.heat.share)
        self.laws, self.contacts = [], []
        for k, ((_, other), lam) in enumerate(zip(self.pairs, self.lams, strict=True)):
            self.laws.append(law | self.own.get(k, {}))
            side = "master" if isinstance(other, str) else "obstacle"
            self.contacts.append(LACContact(self.u, lam, **{side: other}, **self.laws[-1]))

    def _OfHeat(self, function, fields):
        return function(fields, self.T)

    def _Vector(self, value):
        if isinstance(value, tuple):
            return self.load * CF(value)
        if not isinstance(value, CoefficientFunction):
            value = value(self.load)
        return CF(value) if isinstance(value, tuple) else value

    @property
    def ring(self):
        """The way around the axis."""
        return 2 * pi * x if self.axisymmetric else CF(1)

    # --- loads -----------------------------------------------------------------------------------

    def Spring(self, region, motion, stiffness):
        """Springs between a boundary and something that moves by `motion`."""
        motion = self._Vector(motion)
        self.a += stiffness * self.ring * InnerProduct(self.u - motion, self.v) * ds(region)
        return self

    def Traction(self, region, traction):
        self.a += -self.ring * InnerProduct(self._Vector(traction), self.v) * ds(region)
        return self

    def Weight(self, body, force):
        self.a += -self.ring * InnerProduct(self._Vector(force), self.v) * dx(body)
        return self

    def Growth(self, body, strain):
        """Thermal strain of a body, the same in all directions; linear bulk only."""
        mu, lame = Lame(self.young[body], self.nu)
        stress = (2 * mu + self.mesh.dim * lame) * (strain * self.load)
        self.a += -stress * Trace(Grad(self.v)) * dx(body)
        return self

    def Scatter(self, seed, displacement, traction):
        """A random start vector."""
        values, free = self.gf.vec.FV().NumPy(), self.X.FreeDofs()
        values[:] = np.random.default_rng(seed).normal(size=len(values)) * [bool(b) for b in free]
        values[: self.X.components[0].ndof] *= displacement
        values[self.X.components[0].ndof :] *= traction
        return self

    # --- what is known of the end ---------------------------------------------------------------

    def Expect(self, what, measure, value, error):
        """The number `measure(problem)` at the end is `value`, but for an error."""
        self.expected.append((what, measure, value, error))
        return self

    def StaysAside(self, body, *axes, error=1e-6):
        """The mean displacement of a body along axes is 0, but for a part of its size."""
        for axis in axes:
            self.Expect(f"drift of {body}", MeanOf(body, axis), 0.0, error * self.extent)
        return self

    def Carries(self, force, *numbers, error=1e-6):
        """The sum of the forces of contacts (all of them, unless told) is that one."""
        for axis, value in enumerate(force):
            allowed = error * max(map(abs, force))
            self.Expect("force", ForceOf(numbers or range(len(self.pairs)), axis), value, allowed)
        return self

    # --- the script ------------------------------------------------------------------------------

    def Run(self, callback=None, printing=False, watch=None):
        """What every user writes: no argument is tuned."""
        self.solver = ContactSolver(self.a, self.gf, self.contacts)
        if watch:
            watch(self.solver)
        if self.once:
            self.load.Set(self.path[-1][0])
            self.solver.Solve(printing=printing)
            return callback(self) if callback else None
        self.stepper = LoadStepper(self.solver, self.load, prescribe=self.prescribe)
        for end, steps in self.path:
            self.stepper.Integrate(end, steps=steps, callback=callback, printing=printing)
        return self.stepper.steps


def MeanOf(body, axis):
    """The mean of one component of the displacement of a body."""

    def Measured(problem):
        region = problem.mesh.Materials(body)
        return Integrate(problem.gf.components[0][axis], region) / Integrate(1.0, region)

    return Measured


def ForceOf(numbers, axis):
    """One component of the sum of the forces of contacts."""
    return lambda problem: sum(problem.contacts[k].Force()[axis] for k in numbers)


def MeanPressure(number=0):
    """The mean pressure of what is paired."""

    def Measured(problem):
        table = problem.contacts[number].Table()
        return (table["pressure"] * table["area"]).sum() / table["area"].sum()

    return Measured


def _Side(name, side):
    return name if "_" in name else f"{name}_{side}"
