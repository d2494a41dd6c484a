"""One block pressed on another one and pushed aside, in 2D and 3D: a small complete problem."""

from functools import partial

import numpy as np
from ngsolve import (
    CF,
    H1,
    BilinearForm,
    Det,
    FESpace,
    Grad,
    GridFunction,
    Id,
    IfPos,
    InnerProduct,
    Parameter,
    Sym,
    Trace,
    Variation,
    VectorH1,
    ds,
    dx,
    grad,
    log,
    x,
    y,
)
from posed import Posed

from ngslac import Flux, LACContact, LACSpace
from ngslac.meshes import TwoBlocks, TwoBlocks3D
from ngslac.parallel.layout import LayoutOf

MU, LAME = 40.0, 60.0
PUSH = {2: (0.02, -0.02), 3: (0.02, 0.01, -0.02)}


def stress(u):
    strain = Sym(Grad(u))
    return 2 * MU * strain + LAME * Trace(strain) * Id(strain.dims[0])


def linear(u, v, dx=dx):
    return InnerProduct(stress(u), Sym(Grad(v))) * dx


def neo_hooke(u, dx=dx, *, mu=MU, lame=LAME):
    F = Id(u.dim) + Grad(u)
    volume = log(Det(F))
    energy = mu / 2 * (InnerProduct(F, F) - u.dim) - mu * volume + lame / 2 * volume**2
    return Variation(energy.Compile() * dx)


def two_blocks(dim, *, h=0.25, kinds=("hex", "prism"), n=(3, 2), **flags):
    """A block on a wider one, not aligned; `n` the divisions of slave and master."""
    flags = {"overhang": 0.2, "aligned": False} | flags
    if dim == 3:
        return TwoBlocks3D(*kinds, *n, **flags)
    return TwoBlocks(h, **({"structured": True} | flags))


def press(
    *,
    dim=2,
    order=2,
    push=None,
    nonlinear=False,
    bulk=None,
    spring=1000.0,
    condense=False,
    space=VectorH1,
    mesh_flags=None,
    change=None,
    flags=None,
    master="master",
    h=0.25,
    kinds=("hex", "prism"),
    n=(3, 2),
    flow=None,
    **law,
):
    """Block "upper", its top held by springs that move by load * push, on a clamped block "lower".

    `h` is of 2D, `kinds` and `n` are of 3D; `mesh_flags` go to TwoBlocks or TwoBlocks3D, `change`
    makes another mesh of it, `bulk(u, v, load)` other integrals, `flags` go to the displacement
    space, `flow(fields, T)` is a flux of a temperature, the rest goes to LACContact.
    """
    mesh = two_blocks(dim, h=h, kinds=kinds, n=n, **(mesh_flags or {}))
    if change:
        mesh = change(mesh)
    V = space(mesh, order=order, **({"dirichlet": "bottom"} | (flags or {})))
    W = [H1(mesh, order=order, dirichlet="bottom")] if flow else []
    X = FESpace([V, *W, LACSpace(V, slave="slave")])
    (u, *T, lam), (v, *S, _) = X.TnT()
    load = Parameter(1.0)
    a = BilinearForm(X, condense=condense)
    for t, s in zip(T, S, strict=True):
        a += grad(t) * grad(s) * dx + 10 * (t - 1) * s * ds("top")
        law["flux"] = Flux(t, lambda fields: flow(fields, T[0]))
    for part in bulk(u, v, load) if bulk else [neo_hooke(u) if nonlinear else linear(u, v)]:
        a += part
    if spring:
        a += spring * InnerProduct(u - load * CF(push or PUSH[dim]), v) * ds("top")
    contact = LACContact(u, lam, master=master, **law)
    return Posed(mesh, X, a, GridFunction(X), contact, load)


def mixed_press(*, dim=2, **flags):
    """Stick, slip and open at once: the top is turned, and friction is high on one side only."""
    size = (6 - dim) if flags.get("nonlinear") else 1
    push = (0.005, -0.02 + 0.025 * x) if dim == 2 else (0.005, 0.003, -0.02 + 0.02 * x + 0.01 * y)
    given = {"push": tuple(size * p for p in push), "friction": IfPos(x - 0.3, 0.1, 2.0)}
    return press(dim=dim, **(given | {"h": 0.15, "n": (4, 3)} | flags))


press3d, mixed_press3d = (partial(make, dim=3) for make in (press, mixed_press))


def solved(problem, tol=1e-10, **flags):
    """The solver of a problem that it has solved."""
    solver = problem.solver(**flags)
    solver.Solve(printing=False, tol=tol)
    return solver


def same(problem, other, tol=1e-10):
    """Displacements and tractions agree, each in its own size."""
    for one, two in zip(problem.gf.components, other.gf.components, strict=True):
        expected = numpy(two)
        assert np.abs(numpy(one) - expected).max() <= tol * np.abs(expected).max()


def numpy(vec):
    """A copy of the entries of a vector or GridFunction; of one on many processes a Spread."""
    if isinstance(vec, GridFunction):
        return LayoutOf(vec.space).Values(vec.vec).copy()
    return vec.FV().NumPy().copy()
