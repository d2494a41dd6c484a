"""Problems in three dimensions, and numbers that are complex or out of range."""

import numpy as np
from fuzz_strange import P1, P2, Problem, Times
from ngsolve import (
    CF,
    BilinearForm,
    GridFunction,
    InnerProduct,
    Mesh,
    VectorH1,
    dx,
    z,
)

from ngslac import (
    AugmentedLagrangianSolver,
    BubbleVectorH1,
    ContactSolver,
    LACSpace,
    LoadStepper,
    SplitSlaveFaces,
)
from ngslac.meshes import TwoBlocks3D

__all__ = ["SOLIDS", "SOLIDS_LEGAL"]


def Solid(make=P2, kinds=("hex", "hex"), n=(2, 1), **law):
    mesh = TwoBlocks3D(*kinds, *n, overhang=0.2, aligned=False)
    return Problem(make, mesh, **law)


def Split():
    """First order on split faces."""
    mesh = SplitSlaveFaces(TwoBlocks3D("tet", "tet", 2, 1, overhang=0.2, aligned=False), "slave")
    return Problem(P1, mesh).Converged()


def Mirrored():
    """All points mirrored: volumes are negative, forces those of the mirror image."""
    expected = Solid().Solve().contact.Force()
    ngmesh = TwoBlocks3D("hex", "hex", 2, 1, overhang=0.2, aligned=False).ngmesh
    for point in ngmesh.Points():
        point[1] = -point[1]
    found = Problem(P2, Mesh(ngmesh)).Solve().contact.Force()
    assert np.allclose(np.array(found) * (1, -1, 1), expected, rtol=1e-8, atol=1e-12)


def Flat():
    """All slave faces squeezed into one line."""
    ngmesh = TwoBlocks3D("hex", "hex", 2, 1, overhang=0.2, aligned=False).ngmesh
    for point in ngmesh.Points():
        point[1] = 0
    return Problem(P2, Mesh(ngmesh)).Solve()


def NaNPoint():
    """A vertex that is nowhere."""
    ngmesh = TwoBlocks3D("hex", "hex", 2, 1, overhang=0.2, aligned=False).ngmesh
    for point in ngmesh.Points():
        point[2] = np.nan
        break
    return Problem(P2, Mesh(ngmesh)).Solve()


def ComplexBulk(w):
    a = BilinearForm(w.X)
    a += w.Bulk()
    a += CF(1j) * InnerProduct(w.u, w.v) * dx
    return ContactSolver(a, w.gf, w.contact).Solve(printing=False)


def NoDofs():
    """A load vector without entries."""
    problem = Solid()
    return ContactSolver(problem.a, problem.gf, problem.contact, rhs=GridFunction(problem.V).vec)


MESH = ("mesh", "boundary element", "degenerate", "volume", "NaN", "coordinates", "inside out")
SOLIDS = {
    "a vector of the displacement as load": (lambda w: NoDofs(), ("rhs",)),
    "a flat mesh": (lambda w: Flat(), MESH),
    "a mesh with NaN": (lambda w: NaNPoint(), MESH),
    "a complex bulk": (ComplexBulk, ("a, the bulk form",)),
    "a displacement of two components in 3D": (
        lambda w: LACSpace(Two(Solid().mesh), slave="slave"),
        ("LACSpace",),
    ),
    "a prescribed vector of two components in 3D": (
        lambda w: Prescribed(Solid(lambda m: VectorH1(m, order=2, dirichlet="top")), CF((0, 0))),
        ("prescribe",),
    ),
    "a moment about a point of the plane": (
        lambda w: Solid().Solve().contact.Moment((0, 0)),
        ("point",),
    ),
    "macros of another mesh": (
        lambda w: LACSpace(Solid().V, slave="slave", macros=list(w.Q.macros)),
        ("macros",),
    ),
}


def Two(mesh):
    """Two scalar fields."""
    return VectorH1(mesh, order=2).components[0] ** 2


def Prescribed(problem, value):
    problem.load.Set(0)
    stepper = LoadStepper(problem.solver, problem.load, prescribe={"top": value})
    return stepper.Integrate(steps=1, printing=False)


def Shown(problem):
    contact = problem.Solve().contact
    for field in ("pressure", "traction", "gap", "status", "segments"):
        contact.Draw(field, show=False)
    contact.WriteVTU("solid", displacement=problem.gf.components[0])
    contact.Segments().WriteVTU("segments")
    return str(contact.Check()), contact.Force(), contact.Moment((0, 0, 1))


SOLIDS_LEGAL = {
    "a profile in 3D": lambda w: Solid().Solve().contact.Plot("pressure", along="z"),
    "a mirrored mesh": lambda w: Mirrored(),
    **{
        f"blocks of {a} on {b}": lambda w, a=a, b=b: Solid(kinds=(a, b)).Converged()
        for a, b in (("tet", "hex"), ("prism", "tet"), ("pyramid", "prism"), ("hex", "pyramid"))
    },
    "blocks that follow": lambda w: Solid(finite=True).Converged(),
    "blocks that are tied": lambda w: Solid(friction=None, tied=True).Converged(),
    "blocks of first order": lambda w: Split(),
    "blocks with bubbles": lambda w: Solid(
        lambda m: BubbleVectorH1(m, order=1, slave="slave"), ("tet", "tet")
    ).Converged(),
    "blocks on a plane": lambda w: Solid(master=None, obstacle=0.01 + z).Solve(),
    "blocks that are augmented": lambda w: AugmentedLagrangianSolver(
        (p := Solid()).a, p.gf, p.contact
    ).Solve(printing=False),
    "blocks in time": lambda w: Times(Solid()),
    "blocks that are shown": lambda w: Shown(Solid()),
    "blocks in one step by displacement": lambda w: Prescribed(
        Solid(lambda m: VectorH1(m, order=2, dirichlet="top|bottom")), CF((0, 0, -0.01))
    ),
}
