"""Strange problems: spaces, meshes and lives of objects that a stranger would try."""

import gc

import ngsolve as ngs
from fuzz_uses import Uses
from fuzz_world import P1, P2, Blocks, Problem, Refine
from netgen.geom2d import unit_square
from netgen.occ import Box, Compound, IdentificationType, MoveTo, OCCGeometry, Pnt, X, Y
from ngsolve.meshes import Make1DMesh

import ngslac as lac

__all__ = ["STRANGE"]


def PeriodicMesh():
    """The sides of the upper block are one."""
    lower, upper = MoveTo(-0.5, -1).Rectangle(2, 1).Face(), MoveTo(0, 0).Rectangle(1, 1).Face()
    lower.edges.Max(Y).name, lower.edges.Min(Y).name = "master", "bottom"
    upper.edges.Min(Y).name, upper.edges.Max(Y).name = "slave", "top"
    upper.edges.Min(X).Identify(upper.edges.Max(X), "sides", IdentificationType.PERIODIC)
    lower.edges.maxh, upper.edges.maxh = 0.4, 0.25
    return ngs.Mesh(OCCGeometry(Compound([lower, upper]), dim=2).GenerateMesh(maxh=0.4))


def SurfaceMesh():
    """A box without volume elements."""
    box = Box(Pnt(0, 0, 0), Pnt(1, 1, 1))
    box.faces.name = "slave"
    return ngs.Mesh(OCCGeometry(box).GenerateMesh(maxh=0.6, perfstepsend=4))


def OnSurfaces(**flags):
    """A contact of a plane and a mesh of surfaces."""
    V = P2(SurfaceMesh())
    u, lam = (V * lac.LACSpace(V, slave="slave")).TrialFunction()
    return lac.LACContact(u, lam, master=None, obstacle=ngs.CF(0), **flags).Update()


def LineSpace():
    return lac.LACSpace(P2(Make1DMesh(3)), slave="left")


def OneBody():
    return Problem(P2, ngs.Mesh(unit_square.GenerateMesh(maxh=0.5)), slave="left")


def Order(order, **flags):
    """A problem with a space of another order, or with other flags."""
    return Problem(lambda m: ngs.VectorH1(m, order=order, **flags))


def Refined(update=True):
    """A problem whose mesh is refined after it was solved."""
    problem = Problem().Solve()
    Refine(problem, update)
    return problem


def RefinedInTime():
    """A stepper whose mesh is refined between two calls."""
    problem = Problem()
    stepper = lac.TimeStepper(problem.solver, 1.0, dt=0.01)
    stepper.Integrate(0.01, printing=False)
    Refine(problem.Solve())
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
    field = ngs.GridFunction(P1(problem.mesh))
    field.Set(ngs.CF((0.05, 0)))
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


def Space(V):
    return lac.LACSpace(V, slave="slave")


def Upper(mesh):
    return ngs.Compress(ngs.VectorH1(mesh, order=2, definedon="upper"))


def Solve(w, gf):
    return lac.ContactSolver(w.a, gf, w.contact).Solve(printing=False)


def Trials(X):
    return X.TrialFunction()


def Contact(u, lam):
    return lac.LACContact(u, lam, master="master")


USES = """
[LACSpace|V |V=]
space of L2 | Problem(lambda m: VectorL2(m, order=2))
space of numbers | Problem(lambda m: NumberSpace(m) ** 2)
space on the lower body | Order(2, definedon="lower")
space discontinuous | Problem(lambda m: Discontinuous(P2(m)))
space with dirichlet everywhere | Order(2, dirichlet=".*")
[lam|mesh]
space of another mesh in the product | Contact(*Trials(w.V * Space(w.other.V)))
[lam|u ]
space of lam that belongs to another displacement | Contact(*Trials(P1(w.mesh) * w.Q)).Update()
[u|lam]
u of one space and lam of another | Contact(w.u, Trials(w.V * w.Q)[1])
[dimension|mesh]
mesh of one dimension | LineSpace()
[slave]
mesh of surfaces | OnSurfaces()
[finite]
mesh of surfaces that follow | OnSurfaces(finite=True)
[master]
mesh of one body | OneBody()
[mesh|space|Update]
mesh refined behind the back | Refined(False).solver.Solve(printing=False)
mesh refined, and the solver goes on | Refined().solver.Solve(printing=False)
mesh refined, and the stepper goes on | RefinedInSteps()
mesh refined, and the time goes on | RefinedInTime()
mesh refined, and a new stepper takes the old solver | Times(Refined())
[mesh]
mesh refined before a state is loaded | SavedFor(Refined())
[mesh|space|dofs]
state of another order | SavedFor(Order(3))
[contact|state|finite]
state of another kind of contact | SavedFor(Problem(finite=True))
[friction]
friction that depends on lam | w.Contact(friction=w.lam[0])
friction of a test function | w.Contact(friction=0.1 + w.v[0])
[obstacle]
obstacle of a trial function | w.Contact(master=None, obstacle=w.u[1])
[density]
density of a trial function | Times(w, 1 + w.u[1])
[prescribe]
prescribed by a trial function | LoadStepper(w.solver, w.load, prescribe={"bottom": w.u})

[]
space of facets | Space(VectorFacetFESpace(w.mesh, order=2))
space in HDiv | Space(HDiv(w.mesh, order=2))
space of components | Problem(lambda m: VectorValued(H1(m, order=2))).Converged()
space of a power | Problem(lambda m: H1(m, order=2) ** 2).Converged()
space compressed | Problem(lambda m: Compress(P2(m))).Converged()
space compressed on one body | Problem(Upper, master=None, obstacle=CF(0)).Solve()
space periodic | Problem(lambda m: Periodic(P2(m)), PeriodicMesh()).Converged()
space periodic of first order | Problem(lambda m: Periodic(P1(m)), PeriodicMesh()).Converged()
space of order 9 | Order(9).Converged()
space of bubbles | Problem(lambda m: BubbleVectorH1(m, order=1, slave="slave")).Converged()
space that is hidden in part | Order(4, autoupdate=True).Converged()
gf of several vectors | Solve(w, GridFunction(w.X, multidim=3))
mesh of surfaces to split | SplitSlaveFaces(SurfaceMesh(), "slave")
mesh curved late | CurvedLate()
mesh deformed | Deformed(False)
mesh deformed while paired | Deformed(True)
mesh refined, everything new | NewMesh()
mesh refined, contact anew | NewContact()
objects that nobody names | Orphans()
time with a finite contact | Times(Problem(finite=True))
"""
STRANGE = [*Uses(globals(), USES)]
