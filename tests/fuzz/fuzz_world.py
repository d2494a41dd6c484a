"""The problem that every case gets a copy of: two blocks in contact, solved, and a second mesh."""

import tempfile
from functools import cached_property
from pathlib import Path

from ngsolve import (
    CF,
    BilinearForm,
    Grad,
    GridFunction,
    Id,
    InnerProduct,
    LinearForm,
    Parameter,
    SetNumThreads,
    Sym,
    Trace,
    VectorH1,
    ds,
    dx,
    x,
)

from ngslac import (
    AugmentedLagrangianSolver,
    ContactSolver,
    FormSum,
    LACContact,
    LACSpace,
    LoadStepper,
    SaveState,
    TimeStepper,
)
from ngslac.meshes import TwoBlocks

__all__ = ["World"]


class World:
    """Valid arguments of everything public. `other` is the same problem on a mesh of its own."""

    def __init__(self, h=0.5, other=True):
        SetNumThreads(1)  # a fork copies one thread only
        self.mesh = TwoBlocks(h, overhang=0.2, aligned=False, structured=True)
        self.V = VectorH1(self.mesh, order=2, dirichlet="bottom", dirichletx="top")
        self.Q = LACSpace(self.V, slave="slave")
        self.X = self.V * self.Q
        (self.u, self.lam), (self.v, self.mu) = self.X.TnT()
        self.load = Parameter(1.0)
        self.a = BilinearForm(self.X)
        self.a += self.Bulk() + self.load * 0.01 * self.v[1] * ds("top")
        self.f = LinearForm(-0.01 * self.v[1] * ds("top")).Assemble()
        self.gf = GridFunction(self.X)
        self.contact = LACContact(self.u, self.lam, master="master", friction=0.3)
        self.solver = ContactSolver(self.a, self.gf, self.contact)
        self.start = CF((0.01 * x, 0))
        if other:
            self.solver.Solve(printing=False)
            self.other = World(0.3, other=False)
            self.folder = tempfile.TemporaryDirectory(prefix="ngslac-fuzz-")
            self.file = Path(self.folder.name) / "state"
            SaveState(self.file, self.solver)

    def Bulk(self):
        """Linear elasticity, as an integral."""
        strain = Sym(Grad(self.u))
        return InnerProduct(2 * strain + 3 * Trace(strain) * Id(2), Sym(Grad(self.v))) * dx

    def Contact(self, **flags):
        """Another contact on the same product space."""
        return LACContact(self.u, self.lam, **({"master": "master"} | flags))

    def Form(self, *terms, **flags):
        """The bulk form with further terms or flags."""
        a = BilinearForm(self.X, **flags)
        a += self.Bulk() + 0.01 * self.v[1] * ds("top")
        for term in terms:
            a += term
        return a

    @cached_property
    def augmented(self):
        return AugmentedLagrangianSolver(self.a, self.gf, self.contact)

    @cached_property
    def form(self):
        form = FormSum(self.a, self.contact)
        form.AssembleLinearization(self.gf.vec)
        return form

    @cached_property
    def loads(self):
        self.load.Set(0)
        return LoadStepper(self.solver, self.load)

    @cached_property
    def times(self):
        return TimeStepper(self.solver, 1.0, dt=0.1)

    def Vector(self):
        """A vector on the product space."""
        vec = self.gf.vec.CreateVector()
        vec.data = self.gf.vec
        return vec
