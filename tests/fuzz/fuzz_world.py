"""A solved problem of two blocks in contact, and one on a second mesh; every case gets a copy."""

import tempfile
from functools import cached_property
from pathlib import Path

import ngsolve as ngs
from ngsolve import CF, Grad, Id, InnerProduct, Sym, Trace, VectorH1, ds, dx

import ngslac as lac
from ngslac.meshes import TwoBlocks

__all__ = ["P1", "P2", "Blocks", "Elastic", "Problem", "Refine", "Times", "World"]


def P1(mesh):
    return VectorH1(mesh, order=1)


def P2(mesh):
    return VectorH1(mesh, order=2)


def Held(mesh):
    return VectorH1(mesh, order=2, dirichlet="bottom", dirichletx="top")


def Blocks(h=0.5):
    return TwoBlocks(h, overhang=0.2, aligned=False, structured=True)


def Elastic(u, v):
    """Linear elasticity, as an integral."""
    strain, dim = Sym(Grad(u)), u.dim
    return InnerProduct(2 * strain + 3 * Trace(strain) * Id(dim), Sym(Grad(v))) * dx


def Springs(u, v, load):
    """Springs at both ends; the load pushes the upper ones."""
    push = load * CF((0.01, -0.02) if u.dim == 2 else (0.01, 0, -0.02))
    return 10 * InnerProduct(u - push, v) * ds("top") + 10 * InnerProduct(u, v) * ds("bottom")


def Pressed(u, v, load):
    return 0.01 * load * v[1] * ds("top")


class Problem:
    """Two blocks with any displacement space; by default springs hold and press them."""

    def __init__(self, make=P2, mesh=None, slave="slave", forces=Springs, **law):
        self.mesh = mesh or Blocks()
        self.V = make(self.mesh)
        self.Q = lac.LACSpace(self.V, slave=slave)
        self.X = self.V * self.Q
        (self.u, self.lam), (self.v, self.mu) = self.X.TnT()
        self.load = ngs.Parameter(1.0)
        self.a = ngs.BilinearForm(self.X)
        self.a += Elastic(self.u, self.v) + forces(self.u, self.v, self.load)
        self.gf = ngs.GridFunction(self.X)
        self.contact = self.Contact(**({"friction": 0.3} | law))
        self.solver = lac.ContactSolver(self.a, self.gf, self.contact)

    def Contact(self, **flags):
        """Another contact on the same product space."""
        return lac.LACContact(self.u, self.lam, **({"master": "master"} | flags))

    def Solve(self):
        self.solver.Solve(printing=False)
        return self

    def Converged(self):
        """Solve, and check that a force acts between the blocks."""
        self.Solve()
        assert abs(self.contact.Force()[-1]) > 1e-6
        return self


def Refine(problem, update=True):
    """Refine the mesh; spaces follow if `update`."""
    problem.mesh.Refine()
    if update:
        for space in (problem.V, problem.Q, problem.X):
            space.Update()
        problem.gf.Update()


def Times(problem, density=1.0):
    stepper = lac.TimeStepper(problem.solver, density, dt=0.01)
    return stepper.Integrate(0.02, printing=False)


class World(Problem):
    """Valid arguments for everything public. `other` is the same problem on a mesh of its own."""

    def __init__(self, h=0.5, other=True):
        ngs.SetNumThreads(1)  # a fork copies one thread only
        super().__init__(Held, Blocks(h), forces=Pressed)
        self.T = ngs.H1(self.mesh).TrialFunction()
        self.f = ngs.LinearForm(-0.01 * self.v[1] * ds("top")).Assemble()
        if other:
            self.Solve()
            self.other = World(0.3, other=False)
            self.folder = tempfile.TemporaryDirectory(prefix="ngslac-fuzz-")
            self.file = Path(self.folder.name) / "state"
            lac.SaveState(self.file, self.solver)

    def Conducting(self):
        """An evaluated contact with a flux."""
        fes = self.V * ngs.H1(self.mesh) * self.Q
        u, T, lam = fes.TrialFunction()
        flux = lac.Flux(T, lambda z: z.Slave(T) - z.Master(T))
        contact = lac.LACContact(u, lam, master="master", flux=flux)
        contact.Update()
        contact.form.SetConstant(1.0)
        contact.Evaluate(ngs.GridFunction(fes))
        return contact

    def Form(self, *terms, **flags):
        """The bulk form with further terms or flags."""
        a = ngs.BilinearForm(self.X, **flags)
        for term in (Elastic(self.u, self.v), Pressed(self.u, self.v, 1), *terms):
            a += term
        return a

    @cached_property
    def augmented(self):
        return lac.AugmentedLagrangianSolver(self.a, self.gf, self.contact)

    @cached_property
    def form(self):
        form = lac.FormSum(self.a, self.contact)
        form.AssembleLinearization(self.gf.vec)
        return form

    @cached_property
    def loads(self):
        self.load.Set(0)
        return lac.LoadStepper(self.solver, self.load)

    @cached_property
    def times(self):
        return lac.TimeStepper(self.solver, 1.0, dt=0.1)

    @property
    def segments(self):
        return self.contact.Segments()

    def Vector(self):
        vec = self.gf.vec.CreateVector()
        vec.data = self.gf.vec
        return vec
