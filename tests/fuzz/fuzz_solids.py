"""Problems in three dimensions, and numbers that are complex or out of range."""

import numpy as np
from fuzz_uses import Uses
from fuzz_world import P2, Problem
from ngsolve import CF, GridFunction, InnerProduct, Mesh, VectorH1, dx

import ngslac as lac
from ngslac.meshes import TwoBlocks3D

__all__ = ["SOLIDS"]


def SolidMesh(*kinds):
    return TwoBlocks3D(*(kinds or ("hex", "hex")), 2, 1, overhang=0.2, aligned=False)


def Solid(make=P2, kinds=(), **law):
    return Problem(make, SolidMesh(*kinds), **law)


def Moved(move):
    """The problem with other points: `move` is called with the number and each of them."""
    ngmesh = SolidMesh().ngmesh
    for number, point in enumerate(ngmesh.Points()):
        move(number, point)
    return Problem(P2, Mesh(ngmesh)).Solve()


def Squeeze(number, point):
    point[1] = 0


def LoseFirst(number, point):
    point[2] = point[2] if number else np.nan


def Mirror(number, point):
    point[1] = -point[1]


def Mirrored():
    """Volumes are negative, forces those of the mirror image."""
    expected, found = Solid().Solve().contact.Force(), Moved(Mirror).contact.Force()
    assert np.allclose(np.array(found) * (1, -1, 1), expected, rtol=1e-8, atol=1e-12)


def ComplexBulk(w):
    a = w.Form(CF(1j) * InnerProduct(w.u, w.v) * dx)
    return lac.ContactSolver(a, w.gf, w.contact).Solve(printing=False)


def ShortLoad(problem):
    load = GridFunction(problem.V).vec
    return lac.ContactSolver(problem.a, problem.gf, problem.contact, rhs=load)


def Bubbles(mesh):
    return lac.BubbleVectorH1(mesh, order=1, slave="slave")


def Prescribed(held, value):
    problem = Solid(lambda m: VectorH1(m, order=2, dirichlet=held))
    problem.load.Set(0)
    stepper = lac.LoadStepper(problem.solver, problem.load, prescribe={"top": value})
    return stepper.Integrate(steps=1, printing=False)


def Shown(problem):
    contact = problem.Solve().contact
    for field in ("pressure", "traction", "gap", "status", "segments"):
        contact.Draw(field, show=False)
    contact.WriteVTU("solid", displacement=problem.gf.components[0])
    contact.Segments().WriteVTU("segments")
    return str(contact.Check()), contact.Force(), contact.Moment((0, 0, 1))


def Augmented(problem):
    solver = lac.AugmentedLagrangianSolver(problem.a, problem.gf, problem.contact)
    return solver.Solve(printing=False)


USES = """
[rhs]
a vector of the displacement as load | ShortLoad(Solid())
[mesh|boundary element|degenerate|volume|NaN|coordinates|inside out]
a flat mesh | Moved(Squeeze)
a mesh with NaN | Moved(LoseFirst)
[a, the bulk form]
a complex bulk | ComplexBulk(w)
[LACSpace]
a displacement of two components in 3D | LACSpace(P2(SolidMesh()).components[0] ** 2, slave="slave")
[prescribe]
a prescribed vector of two components in 3D | Prescribed("top", CF((0, 0)))
[point]
a moment about a point of the plane | Solid().Solve().contact.Moment((0, 0))
[macros]
macros of another mesh | LACSpace(P2(SolidMesh()), slave="slave", macros=list(w.Q.macros))

[]
a profile in 3D | Solid().Solve().contact.Plot("pressure", along="z")
a mirrored mesh | Mirrored()
blocks of tet on hex | Solid(kinds=("tet", "hex")).Converged()
blocks of prism on tet | Solid(kinds=("prism", "tet")).Converged()
blocks of pyramid on prism | Solid(kinds=("pyramid", "prism")).Converged()
blocks of hex on pyramid | Solid(kinds=("hex", "pyramid")).Converged()
blocks that follow | Solid(finite=True).Converged()
blocks that are tied | Solid(friction=None, tied=True).Converged()
blocks of first order | Problem(P1, SplitSlaveFaces(SolidMesh("tet", "tet"), "slave")).Converged()
blocks with bubbles | Solid(Bubbles, ("tet", "tet")).Converged()
blocks on a plane | Solid(master=None, obstacle=0.01 + z).Solve()
blocks that are augmented | Augmented(Solid())
blocks in time | Times(Solid())
blocks that are shown | Shown(Solid())
blocks in one step by displacement | Prescribed("top|bottom", CF((0, 0, -0.01)))
"""
SOLIDS = [*Uses(globals(), USES)]
