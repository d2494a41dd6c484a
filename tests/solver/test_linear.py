"""All ways to solve linear systems find the same, whatever they are asked for."""

from dataclasses import replace

import numpy as np
import pytest
import scipy.sparse.linalg
from ngsolve import BilinearForm, ds
from press import linear as stiffness
from press import mixed_press, mixed_press3d, press, press3d, same, solved

from ngslac import BubbleVectorH1
from ngslac.arrays import Multiply, ToCSR
from ngslac.errors import LinearSolveError
from ngslac.linear import chain
from ngslac.linear.grounded import MostApart
from ngslac.linear.refine import Refine
from ngslac.linear.system import LinearSystem, Method
from ngslac.petsc import library


def pressed(u, v, load):
    """Forces on the upper block, which nothing holds but contact."""
    return [stiffness(u, v), load * (4 * v[2] - 0.2 * v[0]) * ds("top")]


TIED = {"tied": True, "friction": None}
FIRST = {"order": 1, "friction": 0.1, "n": (4, 3)}
BUBBLES = {"order": 1, "space": BubbleVectorH1, "flags": {"slave": "slave"}}
CASES = {
    "2D stick": (press, {"friction": 5.0}),
    "2D slip": (press, {"friction": 0.1}),
    "2D tied": (press, TIED),
    "2D frictionless": (press, {}),
    "2D bilateral": (press, {"bilateral": True, "friction": 0.2}),
    "2D tresca": (press, {"tresca": 0.5}),
    "2D mixed": (mixed_press, {}),
    "2D edges": (mixed_press, {"edges": True}),
    "2D finite": (mixed_press, {"finite": True}),
    "2D large": (mixed_press, {"finite": True, "nonlinear": True}),
    "2D condensed": (mixed_press, {"condense": True}),
    "2D first order": (mixed_press, {"order": 1}),
    "2D third order": (mixed_press, {"order": 3}),
    "2D bubbles": (mixed_press, BUBBLES),
    "2D held by contact": (press, {"flags": {"dirichlet": "bottom"}, "friction": 0.1}),
    "3D stick": (press3d, {"friction": 5.0}),
    "3D tied": (press3d, TIED),
    "3D frictionless": (press3d, {}),
    "3D mixed": (mixed_press3d, {}),
    "3D slip": (press3d, {"friction": 0.1}),
    "3D tets": (mixed_press3d, {"kinds": ("tet", "tet")}),
    "3D third order": (mixed_press3d, {"order": 3, "n": (3, 2)}),
    "3D first order": (press3d, FIRST | {"kinds": ("tet", "tet")}),
    "3D hexes": (press3d, FIRST | {"kinds": ("hex", "hex")}),
    "3D prisms": (press3d, FIRST | {"kinds": ("prism", "hex")}),
    "3D bubbles": (press3d, FIRST | BUBBLES),
    "3D in two directions": (
        press3d,
        FIRST | {"flags": {"dirichletx": "bottom", "dirichletz": "bottom"}},
    ),
    "3D held by contact": (press3d, FIRST | {"spring": 0.0, "bulk": pressed}),
}
try:
    library.LoadPETSc()
    missing = ""
except ImportError as error:
    missing = str(error)
needs_petsc = pytest.mark.skipif(bool(missing), reason=missing or "petsc4py is there")
# How near the displacements come to those of LU, relative to them.
METHODS = {"interface": 1e-11, "iterative": 1e-7, "petsc direct": 1e-9, "petsc iterative": 1e-7}
ALL = [*METHODS][:2] + [pytest.param(name, marks=needs_petsc) for name in [*METHODS][2:]]
OWN = {"scipy": ["2D frictionless", "2D finite", "2D condensed"]}
OWN["smoother"] = ["3D slip", "3D stick", "3D hexes"]


class SciPyLU(Method):
    """Factors of the whole matrix by SciPy, made anew for each system: a method of a user."""

    def __str__(self):
        return "factors of SciPy"

    def Solve(self, system, b):
        mat, free = system.matrix, system.free
        self.factorisations += 1
        factors = scipy.sparse.linalg.splu(ToCSR(mat)[free][:, free].tocsc())

        def Step(left):
            x = 0 * left
            x[free] = factors.solve(left[free])
            return x

        return Refine(Step, lambda x: (b - Multiply([mat], x)) * free, b)


def made(case):
    make, flags = CASES[case]
    return make(**flags)


def chosen(method, monkeypatch):
    """Options of a solver with a method; PETSc's depend on the size."""
    if method == "smoother":
        return {"preconditioner": lambda mat, free: mat.CreateSmoother(free)}
    monkeypatch.setitem(chain.METHODS, "scipy", lambda parts: SciPyLU())
    if method.startswith("petsc"):
        large = 0 if method.endswith("iterative") else 1e9
        monkeypatch.setitem(chain.LARGE, "petsc", {2: large, 3: large})
    return {"solver": method.split()[0]}


@pytest.mark.parametrize("method", ALL)
@pytest.mark.parametrize("case", CASES)
def test_same_solution(case, method, monkeypatch):
    check_solution(case, method, METHODS[method], monkeypatch)


@pytest.mark.parametrize(("method", "case"), [(m, c) for m, cases in OWN.items() for c in cases])
def test_same_solution_with_parts_of_ones_own(method, case, monkeypatch):
    """A method, and a preconditioner for the iterations."""
    check_solution(case, method, 1e-7, monkeypatch)


def check_solution(case, method, tol, monkeypatch):
    if (case, method) == ("2D large", "interface"):
        pytest.skip("the bulk has another matrix each time")
    reference, problem = made(case), made(case)
    expected = solved(reference, tol=1e-13, solver="direct")
    solver = solved(problem, **chosen(method, monkeypatch))
    linear = solver.linear
    iterates = "iterative" in method or method == "smoother"
    assert linear.method == ("iterative" if iterates else method.split()[-1])
    assert (linear.krylov > 0) == (linear.factorisations == 0) == iterates
    if method == "interface":
        assert linear.factorisations == 1
        assert len(solver.history) <= len(expected.history)
    same(problem, reference, tol)


@pytest.mark.parametrize(
    ("factor", "expected", "left"), [(0.9, 1.0, 1e-4), (3.0, 0.0, 1.0), (np.nan, 0.0, 1.0)]
)
def test_refinement_keeps_the_best(factor, expected, left):
    """Of four rounds, each with the same relative error."""
    b = np.arange(1.0, 4.0)
    x, error = Refine(lambda rhs: factor * rhs, lambda x: b - x, b)
    assert x == pytest.approx(expected * b, abs=1e-3)
    assert error == pytest.approx(left)


def Whole(mat, form, scale, rhs, linear):
    """The LinearSystem of a bulk and a contact, as a LinearSolver gives it to its methods."""
    bits, merged = linear.bits, linear._merged
    return LinearSystem(
        mat, [form.mat], form.MultiplierDofs(), scale, rhs, bits=bits, merged=merged
    )


@pytest.mark.parametrize("method", ["direct", *ALL])
def test_systems(method, monkeypatch):
    """Of any right hand side, with and without a diagonal that holds what nothing else does."""
    problem = press(friction=5.0)
    solver = problem.solver(**chosen(method, monkeypatch))
    solver.Solve(printing=False)
    (u, _), (v, _) = problem.X.TnT()
    loose, form = BilinearForm(stiffness(u, v)).Assemble().mat, problem.contact.form
    linear, scale = solver.linear, solver.system.scale
    own, free = linear._links[0].method, linear.free
    b = np.random.default_rng(0).standard_normal(len(free)) * free
    held = Whole(problem.a.mat, form, scale, b / scale, linear)
    shift = np.where(np.isin(np.arange(len(b)), form.MultiplierDofs()), 0, 1.0)
    shifted = replace(held, mat=loose, shift=shift)
    for system in (held, shifted, held):
        x, error = own.Solve(system, b)
        left = b - scale * Multiply([system.mat, form.mat], scale * x)
        left -= 0 if system.shift is None else shift * x
        assert error < 1e-9
        assert np.linalg.norm(left * free) < 1.1e-9 * np.linalg.norm(b)
        assert not np.any(x[~free])
        assert linear.Solve(system) == pytest.approx(scale * x, rel=1e-6, abs=1e-6)
    assert not np.any(linear.Solve(replace(held, rhs=0 * b)))
    own.NewBulk()
    own.SetState(own.State())
    assert np.linalg.norm(own.Solve(held, b)[0] - x) < 1e-7 * np.linalg.norm(x)


def test_springs_where_no_dof_is_free():
    none = np.zeros(0, dtype=int)
    assert not len(MostApart(none, np.zeros((0, 3))))


@pytest.mark.parametrize("method", ["direct", *ALL])
def test_singular_systems_are_told(method, monkeypatch):
    """Nothing holds the upper block sideways: no method says that it has a solution."""
    problem = press()
    solver = problem.solver(**chosen(method, monkeypatch))
    solver.Solve(printing=False)
    (u, _), (v, _) = problem.X.TnT()
    loose, form = BilinearForm(stiffness(u, v)).Assemble().mat, problem.contact.form
    own, free, scale = solver.linear._links[0].method, solver.linear.free, solver.system.scale
    b = np.random.default_rng(0).standard_normal(len(free)) * free
    try:
        _, error = own.Solve(Whole(loose, form, scale, b / scale, solver.linear), b)
    except (LinearSolveError, np.linalg.LinAlgError):
        return
    assert not error < 1e-5
