"""Strange problems: spaces, meshes and lives of objects that a stranger would try."""

import gc

import ngsolve as ngs
from fuzz_world import P1, P2, Blocks, Problem
from netgen.geom2d import unit_square
from netgen.occ import Box, Compound, IdentificationType, MoveTo, OCCGeometry, Pnt, X, Y
from ngsolve import CF, H1, Compress, GridFunction, Mesh, Periodic, VectorH1
from ngsolve.meshes import Make1DMesh

import ngslac as lac

__all__ = ["STRANGE", "STRANGE_LEGAL", "Times"]


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


def OnSurfaces(**flags):
    """A contact of a plane and a mesh of surfaces."""
    V = P2(SurfaceMesh())
    u, lam = (V * lac.LACSpace(V, slave="slave")).TrialFunction()
    return lac.LACContact(u, lam, master=None, obstacle=CF(0), **flags).Update()


def Order(order, **flags):
    """A problem with a space of another order, or with other flags."""
    return Problem(lambda m: VectorH1(m, order=order, **flags))


def Refined(update=True):
    """A problem whose mesh is refined after it was solved; spaces follow if `update`."""
    problem = Problem().Solve()
    Refine(problem, update)
    return problem


def Refine(problem, update=True):
    problem.mesh.Refine()
    if update:
        for space in (problem.V, problem.Q, problem.X):
            space.Update()
        problem.gf.Update()


def RefinedInTime():
    """A stepper whose mesh is refined between two calls."""
    problem = Problem()
    stepper = lac.TimeStepper(problem.solver, 1.0, dt=0.01)
    stepper.Integrate(0.01, printing=False)
    problem.Solve()
    Refine(problem)
    stepper.Integrate(0.02, printing=False)


def RefinedInSteps():
    problem = Refined()
    stepper = lac.LoadStepper(problem.solver, problem.load)
    stepper.Integrate(2.0, steps=1, printing=False)


def NewContact():
    """Paired again on a refined mesh."""
    problem = Refined()
    problem.contact.Update()
    lac.ContactSolver(problem.a, problem.gf, problem.contact).Solve(printing=False)


def NewMesh():
    mesh = Blocks()
    mesh.Refine()
    return Problem(mesh=mesh).Converged()


def CurvedLate():
    problem = Problem()
    problem.mesh.Curve(3)
    return problem.Converged()


def Orphans():
    """What is left when the names of everything else are gone."""
    problem = Problem().Solve()
    contact, solver = problem.contact, problem.solver
    del problem
    gc.collect()
    Blocks()
    solver.Solve(printing=False)
    return contact.Table(), contact.Check(), contact.Force()


def Deformed(during):
    """A mesh deformation that comes, or goes, between pairing and solve."""
    problem = Problem()
    field = GridFunction(P1(problem.mesh))
    field.Set(CF((0.05, 0)))
    problem.mesh.SetDeformation(field)
    if during:
        problem.contact.Update()
        problem.mesh.UnsetDeformation()
    problem.Solve()
    problem.mesh.UnsetDeformation()
    return problem.contact.Table()


def SavedFor(other):
    """The state of the usual problem for another one."""
    lac.SaveState("state", Problem().Solve().solver)
    lac.LoadState("state", other.solver)


def Times(problem, density=1.0):
    stepper = lac.TimeStepper(problem.solver, density, dt=0.01)
    return stepper.Integrate(0.02, printing=False)


def Contact(X, **flags):
    return lac.LACContact(*X.TrialFunction(), master="master", **flags)


# Words of which the message has to hold one: name: what is done.
STRANGE = {
    "LACSpace|V |V=": {
        "space of L2": lambda w: Problem(lambda m: ngs.VectorL2(m, order=2)),
        "space of numbers": lambda w: Problem(lambda m: ngs.NumberSpace(m) ** 2),
        "space on the lower body": lambda w: Order(2, definedon="lower"),
        "space discontinuous": lambda w: Problem(lambda m: ngs.Discontinuous(P2(m))),
        "space with dirichlet everywhere": lambda w: Order(2, dirichlet=".*"),
    },
    "lam|mesh": {
        "space of another mesh in the product": lambda w: Contact(
            w.V * lac.LACSpace(w.other.V, slave="slave")
        ),
    },
    "lam|u ": {
        "space of lam that belongs to another displacement": lambda w: Contact(
            P1(w.mesh) * w.Q
        ).Update(),
    },
    "dimension|mesh": {
        "mesh of one dimension": lambda w: lac.LACSpace(P2(Make1DMesh(3)), slave="left"),
    },
    "slave": {"mesh of surfaces": lambda w: OnSurfaces()},
    "finite": {"mesh of surfaces that follow": lambda w: OnSurfaces(finite=True)},
    "master": {
        "mesh of one body": lambda w: Problem(
            P2, Mesh(unit_square.GenerateMesh(maxh=0.5)), slave="left"
        ),
    },
    "mesh|space|Update": {
        "mesh refined behind the back": lambda w: Refined(False).solver.Solve(printing=False),
        "mesh refined, and the solver goes on": lambda w: Refined().solver.Solve(printing=False),
        "mesh refined, and the stepper goes on": lambda w: RefinedInSteps(),
        "mesh refined, and the time goes on": lambda w: RefinedInTime(),
        "mesh refined, and a new stepper takes the old solver": lambda w: Times(Refined()),
    },
    "mesh": {"mesh refined before a state is loaded": lambda w: SavedFor(Refined())},
    "mesh|space|dofs": {"state of another order": lambda w: SavedFor(Order(3))},
    "contact|state|finite": {
        "state of another kind of contact": lambda w: SavedFor(Problem(finite=True)),
    },
    "friction": {
        "friction that depends on lam": lambda w: w.Contact(friction=w.lam[0]),
        "friction of a test function": lambda w: w.Contact(friction=0.1 + w.v[0]),
    },
    "obstacle": {
        "obstacle of a trial function": lambda w: w.Contact(master=None, obstacle=w.u[1]),
    },
    "density": {"density of a trial function": lambda w: Times(w, 1 + w.u[1])},
    "prescribe": {
        "prescribed by a trial function": lambda w: lac.LoadStepper(
            w.solver, w.load, prescribe={"bottom": w.u}
        ),
    },
    "u|lam": {
        "u of one space and lam of another": lambda w: lac.LACContact(
            w.u, (w.V * w.Q).TrialFunction()[1], master="master"
        ),
    },
}


STRANGE_LEGAL = {
    "space of facets": lambda w: lac.LACSpace(
        ngs.VectorFacetFESpace(w.mesh, order=2), slave="slave"
    ),
    "gf of several vectors": lambda w: lac.ContactSolver(
        w.a, GridFunction(w.X, multidim=3), w.contact
    ).Solve(printing=False),
    "mesh of surfaces to split": lambda w: lac.SplitSlaveFaces(SurfaceMesh(), "slave"),
    "space of components": lambda w: Problem(
        lambda m: ngs.VectorValued(H1(m, order=2))
    ).Converged(),
    "space of a power": lambda w: Problem(lambda m: H1(m, order=2) ** 2).Converged(),
    "space compressed": lambda w: Problem(lambda m: Compress(P2(m))).Converged(),
    "space compressed on one body": lambda w: Problem(
        lambda m: Compress(VectorH1(m, order=2, definedon="upper")), master=None, obstacle=CF(0)
    ).Solve(),
    "space periodic": lambda w: Problem(lambda m: Periodic(P2(m)), PeriodicMesh()).Converged(),
    "space periodic of first order": lambda w: Problem(
        lambda m: Periodic(P1(m)), PeriodicMesh()
    ).Converged(),
    "space of order 9": lambda w: Order(9).Converged(),
    "space of bubbles": lambda w: Problem(
        lambda m: lac.BubbleVectorH1(m, order=1, slave="slave")
    ).Converged(),
    "space in HDiv": lambda w: lac.LACSpace(ngs.HDiv(w.mesh, order=2), slave="slave"),
    "space that is hidden in part": lambda w: Order(4, autoupdate=True).Converged(),
    "mesh curved late": lambda w: CurvedLate(),
    "mesh deformed": lambda w: Deformed(False),
    "mesh deformed while paired": lambda w: Deformed(True),
    "mesh refined, everything new": lambda w: NewMesh(),
    "mesh refined, contact anew": lambda w: NewContact(),
    "objects that nobody names": lambda w: Orphans(),
    "time with a finite contact": lambda w: Times(Problem(finite=True)),
}
