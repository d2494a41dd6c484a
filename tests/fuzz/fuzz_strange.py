"""Strange problems: spaces, meshes and lives of objects that a stranger would try."""

import gc

from netgen.geom2d import unit_square
from netgen.occ import Box, Compound, IdentificationType, MoveTo, OCCGeometry, Pnt, X, Y
from ngsolve import (
    CF,
    H1,
    BilinearForm,
    Compress,
    Discontinuous,
    Grad,
    GridFunction,
    HDiv,
    Id,
    InnerProduct,
    Mesh,
    NumberSpace,
    Parameter,
    Periodic,
    Sym,
    Trace,
    VectorFacetFESpace,
    VectorH1,
    VectorL2,
    VectorValued,
    ds,
    dx,
)
from ngsolve.meshes import Make1DMesh

from ngslac import (
    BubbleVectorH1,
    ContactSolver,
    LACContact,
    LACSpace,
    LoadState,
    LoadStepper,
    SaveState,
    SplitSlaveFaces,
    TimeStepper,
)
from ngslac.meshes import TwoBlocks

__all__ = ["STRANGE", "STRANGE_LEGAL"]


def Blocks(**flags):
    return TwoBlocks(0.5, **({"overhang": 0.2, "aligned": False, "structured": True} | flags))


class Problem:
    """Two blocks, the upper one held by springs and pressed, with any displacement space."""

    def __init__(self, make, mesh=None, before=(), slave="slave", **law):
        self.mesh = mesh or Blocks()
        self.V = make(self.mesh)
        self.Q = LACSpace(self.V, slave=slave)
        self.X = self.V * self.Q
        (self.u, self.lam), (self.v, _) = self.X.TnT()
        self.load = Parameter(1.0)
        self.a = BilinearForm(self.X)
        strain = Sym(Grad(self.u))
        stress = 2 * strain + 3 * Trace(strain) * Id(self.mesh.dim)
        push = CF((0.01, -0.02)) if self.mesh.dim == 2 else CF((0.01, 0, -0.02))
        self.a += InnerProduct(stress, Sym(Grad(self.v))) * dx
        self.a += 10 * InnerProduct(self.u - self.load * push, self.v) * ds("top")
        self.a += 10 * InnerProduct(self.u, self.v) * ds("bottom")
        self.gf = GridFunction(self.X)
        self.contact = LACContact(self.u, self.lam, **({"master": "master", "friction": 0.3} | law))
        self.solver = ContactSolver(self.a, self.gf, self.contact)

    def Solve(self):
        self.solver.Solve(printing=False)
        return self

    def Converged(self):
        """Solved, with the forces on both ends in balance."""
        self.Solve()
        assert abs(self.contact.Force()[-1]) > 1e-6
        return self


def P2(mesh):
    return VectorH1(mesh, order=2)


def P1(mesh):
    return VectorH1(mesh, order=1)


def PeriodicMesh():
    """The sides of the upper block are one."""
    lower, upper = MoveTo(-0.5, -1).Rectangle(2, 1).Face(), MoveTo(0, 0).Rectangle(1, 1).Face()
    lower.edges.Max(Y).name, lower.edges.Min(Y).name = "master", "bottom"
    upper.edges.Min(Y).name, upper.edges.Max(Y).name = "slave", "top"
    upper.edges.Min(X).Identify(upper.edges.Max(X), "sides", IdentificationType.PERIODIC)
    lower.edges.maxh, upper.edges.maxh = 0.4, 0.25
    return Mesh(OCCGeometry(Compound([lower, upper]), dim=2).GenerateMesh(maxh=0.4))


def SurfaceMesh():
    """A box without volume elements."""
    box = Box(Pnt(0, 0, 0), Pnt(1, 1, 1))
    box.faces.name = "slave"
    return Mesh(OCCGeometry(box).GenerateMesh(maxh=0.6, perfstepsend=4))


def OnObstacle(V, **flags):
    """A contact of a space whose slave side meets a plane."""
    X = V * LACSpace(V, slave="slave")
    return LACContact(*X.TrialFunction(), master=None, obstacle=CF(0), **flags)


def Refined(problem, update):
    """A problem whose mesh is refined after it was solved; spaces follow if `update`."""
    problem.Solve()
    problem.mesh.Refine()
    if update:
        for space in (problem.V, problem.Q, problem.X):
            space.Update()
        problem.gf.Update()
    return problem


def RefinedInTime(problem):
    """A stepper whose mesh is refined between two calls."""
    stepper = TimeStepper(problem.solver, 1.0, dt=0.01)
    stepper.Integrate(0.01, printing=False)
    Refined(problem, True)
    stepper.Integrate(0.02, printing=False)


def Orphans():
    """What is left when the names of everything else are gone."""
    problem = Problem(P2).Solve()
    contact, solver = problem.contact, problem.solver
    del problem
    gc.collect()
    Blocks()
    solver.Solve(printing=False)
    return contact.Table(), contact.Check(), contact.Force()


def Deformed(during):
    """A mesh deformation that comes, or goes, between pairing and solve."""
    problem = Problem(P2)
    field = GridFunction(VectorH1(problem.mesh, order=1))
    field.Set(CF((0.05, 0)))
    problem.mesh.SetDeformation(field)
    if during:
        problem.contact.Update()
        problem.mesh.UnsetDeformation()
    problem.Solve()
    problem.mesh.UnsetDeformation()
    return problem.contact.Table()


def ByTwo(first, second):
    first.Solve()
    file = "state"
    SaveState(file, first.solver)
    LoadState(file, second.solver)


def Times(problem, **flags):
    stepper = TimeStepper(problem.solver, 1.0, dt=0.01, **flags)
    return stepper.Integrate(0.02, printing=False)


SPACE = ("LACSpace", "V ", "V=")
# name: (what is done, words of which the message has to hold one)
STRANGE = {
    # --- spaces
    "space of L2": (lambda w: Problem(lambda m: VectorL2(m, order=2)), SPACE),
    "space of numbers": (lambda w: Problem(lambda m: NumberSpace(m) ** 2), SPACE),
    "space on the lower body": (
        lambda w: Problem(lambda m: VectorH1(m, order=2, definedon="lower")),
        SPACE,
    ),
    "space discontinuous": (lambda w: Problem(lambda m: Discontinuous(P2(m))), SPACE),
    "space with dirichlet everywhere": (
        lambda w: Problem(lambda m: VectorH1(m, order=2, dirichlet=".*")),
        SPACE,
    ),
    "space of another mesh in the product": (
        lambda w: LACContact(
            *(w.V * LACSpace(w.other.V, slave="slave")).TrialFunction(), master="master"
        ),
        ("lam", "mesh"),
    ),
    "space of lam that belongs to another displacement": (
        lambda w: LACContact(*(P1(w.mesh) * w.Q).TrialFunction(), master="master").Update(),
        ("lam", "u "),
    ),
    # --- meshes
    "mesh of one dimension": (
        lambda w: LACSpace(VectorH1(Make1DMesh(3), order=2), slave="left"),
        ("dimension", "mesh"),
    ),
    "mesh of surfaces": (
        lambda w: OnObstacle(P2(SurfaceMesh())).Update(),
        ("slave",),
    ),
    "mesh of surfaces that follow": (
        lambda w: OnObstacle(P2(SurfaceMesh()), finite=True).Update(),
        ("finite",),
    ),
    "mesh of one body": (
        lambda w: Problem(P2, Mesh(unit_square.GenerateMesh(maxh=0.5)), slave="left"),
        ("master",),
    ),
    "mesh refined behind the back": (
        lambda w: Refined(Problem(P2), False).solver.Solve(printing=False),
        ("mesh", "space", "Update"),
    ),
    "mesh refined, and the solver goes on": (
        lambda w: Refined(Problem(P2), True).solver.Solve(printing=False),
        ("mesh", "space", "Update"),
    ),
    "mesh refined, and the stepper goes on": (
        lambda w: LoadStepper(
            (problem := Refined(Problem(P2), True)).solver, problem.load
        ).Integrate(2.0, steps=1, printing=False),
        ("mesh", "space", "Update"),
    ),
    "mesh refined, and the time goes on": (
        lambda w: RefinedInTime(Problem(P2)),
        ("mesh", "space", "Update"),
    ),
    "mesh refined, and a new stepper takes the old solver": (
        lambda w: Times(Refined(Problem(P2), True)),
        ("mesh", "space", "Update"),
    ),
    "mesh refined before a state is loaded": (
        lambda w: ByTwo(Problem(P2), Refined(Problem(P2), True)),
        ("mesh",),
    ),
    "state of another order": (
        lambda w: ByTwo(Problem(P2), Problem(lambda m: VectorH1(m, order=3))),
        ("mesh", "space", "dofs"),
    ),
    "state of another kind of contact": (
        lambda w: ByTwo(Problem(P2), Problem(P2, finite=True)),
        ("contact", "state", "finite"),
    ),
    # --- values
    "friction that depends on lam": (lambda w: w.Contact(friction=w.lam[0]), ("friction",)),
    "friction of a test function": (lambda w: w.Contact(friction=0.1 + w.v[0]), ("friction",)),
    "obstacle of a trial function": (
        lambda w: w.Contact(master=None, obstacle=w.u[1]),
        ("obstacle",),
    ),
    "density of a trial function": (
        lambda w: TimeStepper(w.solver, 1 + w.u[1], dt=0.1),
        ("density",),
    ),
    "prescribed by a trial function": (
        lambda w: LoadStepper(w.solver, w.load, prescribe={"bottom": w.u}),
        ("prescribe",),
    ),
    "u of one space and lam of another": (
        lambda w: LACContact(w.u, (w.V * w.Q).TrialFunction()[1], master="master"),
        ("u", "lam"),
    ),
}


STRANGE_LEGAL = {
    "space of facets": lambda w: LACSpace(VectorFacetFESpace(w.mesh, order=2), slave="slave"),
    "gf of several vectors": lambda w: ContactSolver(
        w.a, GridFunction(w.X, multidim=3), w.contact
    ).Solve(printing=False),
    "mesh of surfaces to split": lambda w: SplitSlaveFaces(SurfaceMesh(), "slave"),
    "space of components": lambda w: Problem(lambda m: VectorValued(H1(m, order=2))).Converged(),
    "space of a power": lambda w: Problem(lambda m: H1(m, order=2) ** 2).Converged(),
    "space compressed": lambda w: Problem(lambda m: Compress(P2(m))).Converged(),
    "space compressed on one body": lambda w: Problem(
        lambda m: Compress(VectorH1(m, order=2, definedon="upper")), master=None, obstacle=CF(0)
    ).Solve(),
    "space periodic": lambda w: Problem(
        lambda m: Periodic(VectorH1(m, order=2)), PeriodicMesh()
    ).Converged(),
    "space periodic of first order": lambda w: Problem(
        lambda m: Periodic(VectorH1(m, order=1)), PeriodicMesh()
    ).Converged(),
    "space of order 9": lambda w: Problem(lambda m: VectorH1(m, order=9)).Converged(),
    "space of bubbles": lambda w: Problem(
        lambda m: BubbleVectorH1(m, order=1, slave="slave")
    ).Converged(),
    "space in HDiv": lambda w: LACSpace(HDiv(w.mesh, order=2), slave="slave"),
    "space that is hidden in part": lambda w: Problem(
        lambda m: VectorH1(m, order=4, autoupdate=True)
    ).Converged(),
    "mesh curved late": lambda w: (p := Problem(P2), p.mesh.Curve(3), p.Converged()),
    "mesh deformed": lambda w: Deformed(False),
    "mesh deformed while paired": lambda w: Deformed(True),
    "mesh refined, everything new": lambda w: (
        mesh := Blocks(),
        mesh.Refine(),
        Problem(P2, mesh).Converged(),
    ),
    "mesh refined, contact anew": lambda w: (
        p := Refined(Problem(P2), True),
        p.contact.Update(),
        ContactSolver(p.a, p.gf, p.contact).Solve(printing=False),
    ),
    "objects that nobody names": lambda w: Orphans(),
    "time with a finite contact": lambda w: Times(Problem(P2, finite=True)),
}
