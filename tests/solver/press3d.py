"""One block pressed on another one and pushed aside in 3D: a small problem for the solver."""

import numpy as np
from netgen.meshing import Mesh as NetgenMesh
from ngsolve import (
    CF,
    BilinearForm,
    Det,
    Grad,
    GridFunction,
    Id,
    IfPos,
    InnerProduct,
    Mesh,
    Parameter,
    Sym,
    Trace,
    Variation,
    VectorH1,
    ds,
    dx,
    log,
    x,
    y,
)
from press import LAME, MU, Press, numpy

from ngslac import LACContact, LACSpace
from ngslac.meshes.blocks3d import TwoBlocks3D
from ngslac.meshes.boxes import AddBody, StructuredBox

__all__ = ["brick", "linear3d", "mixed_press3d", "neo_hooke3d", "numpy", "press3d", "solved"]


def brick(n, kind="hex"):
    """The unit cube in n x n x 2 bricks, with the names of its sides."""
    mesh, lateral = NetgenMesh(dim=3), np.linspace(0, 1, n + 1)
    AddBody(mesh, "body", StructuredBox(lateral, lateral, [0, 0.5, 1], kind))
    mesh.Compress()
    return Mesh(mesh)


def linear3d(u, v):
    strain = Sym(Grad(u))
    stress = 2 * MU * strain + LAME * Trace(strain) * Id(3)
    return InnerProduct(stress, Sym(Grad(v))) * dx


def neo_hooke3d(u):
    F = Id(3) + Grad(u)
    energy = MU / 2 * (InnerProduct(F, F) - 3) - MU * log(Det(F)) + LAME / 2 * log(Det(F)) ** 2
    return Variation(energy.Compile() * dx)


def press3d(
    *,
    kinds=("hex", "prism"),
    order=2,
    push=(0.02, 0.01, -0.02),
    n=(3, 2),
    nonlinear=False,
    spring=1000.0,
    condense=False,
    space=VectorH1,
    mesh_flags=None,
    change=None,
    flags=None,
    master="master",
    **law,
):
    """Block "upper", its top held by springs that move by load * push, on a clamped block "lower".

    `n` are the divisions of slave and master, `mesh_flags` go to TwoBlocks3D, `change` makes
    another mesh of it, `flags` go to the displacement space, the rest to LACContact.
    """
    options = {"overhang": 0.2, "aligned": False} | (mesh_flags or {})
    mesh = TwoBlocks3D(*kinds, *n, **options)
    if change:
        mesh = change(mesh)
    V = space(mesh, order=order, **({"dirichlet": "bottom"} | (flags or {})))
    X = V * LACSpace(V, slave="slave")
    (u, lam), (v, _) = X.TnT()
    load = Parameter(1.0)
    a = BilinearForm(X, condense=condense)
    a += neo_hooke3d(u) if nonlinear else linear3d(u, v)
    if spring:
        a += spring * InnerProduct(u - load * CF(push), v) * ds("top")
    contact = LACContact(u, lam, master=master, **law)
    return Press(mesh, X, a, GridFunction(X), contact, load)


def mixed_press3d(**flags):
    """Stick, slip and open at once: the top is turned, and friction is high on one side only."""
    size = 3 if flags.get("nonlinear") else 1
    push = (0.005 * size, 0.003 * size, (-0.02 + 0.02 * x + 0.01 * y) * size)
    return press3d(**{"push": push, "n": (4, 3), "friction": IfPos(x - 0.3, 0.1, 2.0)} | flags)


def solved(problem, **flags):
    solver = problem.solver(**flags)
    solver.Solve(printing=False)
    return solver
