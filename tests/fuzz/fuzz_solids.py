"""Problems in three dimensions, and numbers that are complex or out of range."""

import numpy as np
from fuzz_strange import Times
from fuzz_world import P1, P2, Problem
from ngsolve import CF, GridFunction, InnerProduct, Mesh, VectorH1, dx, z

import ngslac as lac
from ngslac.meshes import TwoBlocks3D

__all__ = ["SOLIDS", "SOLIDS_LEGAL"]


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


def WithLoad(problem, rhs):
    return lac.ContactSolver(problem.a, problem.gf, problem.contact, rhs=rhs)


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


# Words of which the message has to hold one: name: what is done.
SOLIDS = {
    "rhs": {
        "a vector of the displacement as load": lambda w: WithLoad(
            p := Solid(), GridFunction(p.V).vec
        ),
    },
    "mesh|boundary element|degenerate|volume|NaN|coordinates|inside out": {
        "a flat mesh": lambda w: Moved(Squeeze),
        "a mesh with NaN": lambda w: Moved(LoseFirst),
    },
    "a, the bulk form": {"a complex bulk": ComplexBulk},
    "LACSpace": {
        "a displacement of two components in 3D": lambda w: lac.LACSpace(
            P2(SolidMesh()).components[0] ** 2, slave="slave"
        ),
    },
    "prescribe": {
        "a prescribed vector of two components in 3D": lambda w: Prescribed("top", CF((0, 0))),
    },
    "point": {
        "a moment about a point of the plane": lambda w: Solid().Solve().contact.Moment((0, 0)),
    },
    "macros": {
        "macros of another mesh": lambda w: lac.LACSpace(
            P2(SolidMesh()), slave="slave", macros=list(w.Q.macros)
        ),
    },
}

KINDS = (("tet", "hex"), ("prism", "tet"), ("pyramid", "prism"), ("hex", "pyramid"))
SOLIDS_LEGAL = {
    "a profile in 3D": lambda w: Solid().Solve().contact.Plot("pressure", along="z"),
    "a mirrored mesh": lambda w: Mirrored(),
    **{
        f"blocks of {a} on {b}": lambda w, a=a, b=b: Solid(kinds=(a, b)).Converged()
        for a, b in KINDS
    },
    "blocks that follow": lambda w: Solid(finite=True).Converged(),
    "blocks that are tied": lambda w: Solid(friction=None, tied=True).Converged(),
    "blocks of first order": lambda w: Problem(
        P1, lac.SplitSlaveFaces(SolidMesh("tet", "tet"), "slave")
    ).Converged(),
    "blocks with bubbles": lambda w: Solid(
        lambda m: lac.BubbleVectorH1(m, order=1, slave="slave"), ("tet", "tet")
    ).Converged(),
    "blocks on a plane": lambda w: Solid(master=None, obstacle=0.01 + z).Solve(),
    "blocks that are augmented": lambda w: Augmented(Solid()),
    "blocks in time": lambda w: Times(Solid()),
    "blocks that are shown": lambda w: Shown(Solid()),
    "blocks in one step by displacement": lambda w: Prescribed("top|bottom", CF((0, 0, -0.01))),
}
