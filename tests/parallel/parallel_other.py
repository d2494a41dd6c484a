"""Cases of other spaces, and of several objects on one mesh."""

import gc
import weakref

import numpy as np
from ngsolve import (
    CF,
    H1,
    L2,
    BilinearForm,
    FESpace,
    Grad,
    GridFunction,
    InnerProduct,
    Parameter,
    Sym,
    VectorH1,
    div,
    dx,
    x,
)
from parallel_misuse import refused
from parallel_problem import QUIET, Problem, linear, problem, results
from parallel_shapes import block_on_block, disc_on_block
from parallel_world import case

from ngslac import BubbleVectorH1, ContactSolver, LACContact, LACSpace, TimeStepper
from ngslac.parallel.spread import MaxAt, Spread, SumAt
from ngslac.parallel.together import Together

HELD = {"dirichlet": "bottom|top"}
COARSE = 0.25


def solved(made, solver=None, tilt=0.03):
    """Iterations with the top moved."""
    made.u.Set(CF((0.01, -0.02 - tilt * x)), definedon=made.mesh.Boundaries("top"))
    return (solver or made.solver()).Solve(**QUIET).number


def on_space(world, kind, **flags):
    """The problem with other displacements."""
    mesh = block_on_block(world.comm, COARSE)
    V = kind(mesh, **HELD, **flags)
    X = V * LACSpace(V, slave="slave")
    (u, lam), (v, _) = X.TnT()
    a = BilinearForm(X)
    a += linear(u, v, 100.0)
    contacts = [LACContact(u, lam, master="master", friction=0.3)]
    return Problem(mesh, X, a, GridFunction(X), contacts, Parameter(0.0))


class Inner:
    """The components of a solution's first component, displacement first."""

    def __init__(self, gf):
        self.components = gf.components[0].components[::-1]


@case
def blocks_of_dofs(world):
    made = on_space(world, H1, order=2, dim=2)
    return results(made, iterations=solved(made))


@case
def bubbles(world):
    """Where some processes have no slave faces."""
    made = on_space(world, BubbleVectorH1, order=1, slave="slave")
    return results(made, iterations=solved(made))


@case
def product_in_product(world):
    """Displacement and pressure are one component, and the multiplier another."""
    mesh = block_on_block(world.comm, COARSE)
    V = VectorH1(mesh, order=2, **HELD)
    X = FESpace([FESpace([L2(mesh, order=0), V]), LACSpace(V, slave="slave")])
    ((p, u), lam), ((q, v), _) = X.TnT()
    a, gf = BilinearForm(X), GridFunction(X)
    a += 80 * InnerProduct(Sym(Grad(u)), Sym(Grad(v))) * dx
    a += (p * div(v) + q * div(u) - 0.005 * p * q) * dx
    contacts = [LACContact(u, lam, master="master", friction=0.3)]
    made = Problem(mesh, X, a, Inner(gf), contacts, Parameter(0.0))
    solver = ContactSolver(a, gf, contacts)
    return results(made, iterations=solved(made, solver))


@case
def held_by_hand(world):
    """Dofs are taken away after the contact was made, and again for another solver."""
    made = problem(block_on_block(world.comm, COARSE), friction=0.3, flags={"dirichlet": "bottom"})
    for region in ("top", "side"):
        held = made.X.components[0].GetDofs(made.mesh.Boundaries(region))
        for k in np.flatnonzero(list(held)):
            made.X.FreeDofs()[made.X.Range(0).start + int(k)] = False
        iterations = solved(made)
    return results(made, iterations=iterations)


@case
def two_solvers(world):
    """Of one form, which take turns; other ones come and go."""
    made = problem(block_on_block(world.comm, COARSE), friction=0.3)
    solvers = [made.solver(solver="direct"), made.solver()]
    solved(made, made.solver())
    tilts = (0.03, 0.0, 0.01, 0.04)
    return results(made, iterations=[solved(made, solvers[k % 2], t) for k, t in enumerate(tilts)])


@case
def two_meshes(world):
    """Each has its problem; both in one solver are refused."""
    one = problem(block_on_block(world.comm, COARSE), friction=0.3)
    two = problem(disc_on_block(world.comm, 0.1), friction=0.2)
    error = refused(lambda: ContactSolver(one.a, one.gf, two.contacts), ValueError)
    solvers = [one.solver(), two.solver()]
    iterations = [solved(*pair) for pair in zip((one, two) * 2, solvers * 2, strict=True)]
    others = {f"other {name}": value for name, value in results(two).items()}
    return results(one, error=error, iterations=iterations) | others


@case
def curved_later(world):
    """After the first use of the mesh."""
    mesh = disc_on_block(world.comm, 0.1)
    solved(problem(mesh, friction=0.2))
    mesh.Curve(2)
    made = problem(mesh, friction=0.2)
    return results(made, iterations=solved(made))


@case
def many_solvers(world):
    """What no solver needs any more is dropped: copies of forms, their matrices and vectors."""
    made, counts, weights = problem(block_on_block(world.comm, COARSE)), [], []
    for weight in (1.0, 2.0, 3.0):
        a = BilinearForm(made.X)
        (u, _), (v, _) = made.X.TnT()
        a += weight * linear(u, v, 100.0)
        again = Problem(
            made.mesh, made.X, a, GridFunction(made.X), made.contacts, Parameter(weight)
        )
        solved(again)
        (contact,) = made.contacts
        counts.append(known(made.mesh))
        weights.append(contact.Force()[1])
    if world.comm is not None:
        assert len({*world.comm.allgather(tuple(counts[1:]))}) == 1  # all are in step
        assert counts[1] == counts[2], counts
    return results(again, weights=np.array(weights))


def known(mesh):
    """How many objects and functions of users this process keeps; 0 in a serial run."""
    if mesh.comm.size == 1:
        return 0, 0
    together = Together.Of(mesh)
    return len(together.layouts), len(together.skins)


@case
def one_after_the_other(world):
    """Problems on one mesh: the forms of those before, and so their matrices, are dropped."""
    mesh, forms = block_on_block(world.comm, 0.3), []
    for _ in range(3):
        made = problem(mesh, friction=0.3)
        stepper = TimeStepper(made.solver(), 1.0, dt=0.01)
        stepper.Integrate(0.01, printing=False)
        made.u.Set(CF((0.01, -0.02)), definedon=mesh.Boundaries("top"))
        made.solver().Solve(**QUIET)
        forms.append(weakref.ref(made.a))
        found = results(made)
        del made, stepper
        gc.collect()
    return found | {"forms": ([form() is None for form in forms[:-1]], None)}


@case
def arrays(world):
    """NumPy's functions of arrays of which each process has its rows, some of them shared."""
    full = np.random.default_rng(0).normal(size=(40, 3))
    a = full
    if world.size > 1:
        mesh = block_on_block(world.comm, COARSE)
        first, end = (40 * (world.rank + k) // world.size for k in (0, 1))
        rows = np.arange(max(first - 3, 0), end)
        a = Spread.Of(full[rows], rows >= first, Together.Of(mesh))
    v, w = a[:, 0], a[:, 1].copy()
    w[v < -1] = 2
    w *= 3.0
    positive, group = v > 0, (np.asarray(v) > 0).astype(int)
    found = {
        "sum": np.sum(v),
        "sums": a.sum(axis=0),
        "most": [np.max(np.abs(v)), np.abs(w).max(initial=9.0), np.min(v), np.ptp(w)],
        "yes": [np.any(v > 3), np.all(v < 3), np.count_nonzero(positive), (~positive).sum()],
        "norms": [np.linalg.norm(v), np.linalg.norm(v[positive]), np.mean(w)],
        "columns": np.linalg.norm(a, axis=0),
        "products": [v @ w, *(v @ a)],
        "gram": a.T @ a,
        "turned": a.T @ (v[:, None] * a),
        "fit": np.linalg.lstsq(a[:, :2], w, rcond=None)[0],
        "whole": np.abs(np.linalg.qr(a, mode="r")),
        "where": np.where(positive, v, -w).sum(),
        "rows": np.sum(np.square(a), axis=1).max(),
        "stacked": np.stack([v, w], axis=1).T @ v,
        "same": [np.array_equal(v, v.copy()), np.array_equal(v, w)],
        "groups": SumAt(group, w, 2),
        "largest": MaxAt(group, np.abs(a), 2),
        "moved": np.linalg.norm(a @ np.ones(3) - v),
        "median": np.median(v[v > np.min(v)]),  # of an odd number it is one of them
    }
    return {name: (np.asarray(value, dtype=float), None) for name, value in found.items()}
