"""Wrong parts of a problem: bulk forms, contacts, loads, free dofs, arguments of a solve."""

import numpy as np
import pytest
from netgen.meshing import NgException
from ngsolve import (
    BilinearForm,
    BitArray,
    GridFunction,
    InnerProduct,
    LinearForm,
    Parameter,
    ds,
    dx,
)
from press import linear, mixed_press, numpy, press, same, solved
from refused import calls, check_refused

from ngslac import ContactConvergenceError, ContactSolver, FormSum, LACContact, LACSpace
from ngslac.solve.residual import Norm


@pytest.fixture(scope="module")
def problem():
    return press(h=0.5)


class Calls:
    """The parts of a problem, and what the calls below do with them."""

    def __init__(self, p):
        self.p, self.X, self.gf, self.c = p, p.X, p.gf, p.contact
        (self.u, self.lam), (self.v, self.mu) = p.X.TnT()
        self.twin = LACContact(self.u, self.lam, master="master")
        self.wrong = GridFunction(p.X.components[0])
        self.locked = BitArray(p.X.FreeDofs())
        self.locked[p.X.Range(1).start] = False

    def bulk(self, *terms, **flags):
        """A bulk form with further terms or flags."""
        a = BilinearForm(self.X, **flags)
        a += linear(self.u, self.v) + 1000 * InnerProduct(self.u, self.v) * ds("top")
        for term in terms:
            a += term
        return a

    def weightless(self):
        a = BilinearForm(self.X, check_unused=False)
        a += 0 * self.u * self.v * dx - self.v[1] * ds("top")
        return a

    def load(self, *terms):
        f = LinearForm(self.X)
        for term in terms:
            f += term
        return f

    def vec(self, value, at=slice(None)):
        vec = self.gf.vec.CreateVector()
        vec[:] = 0
        vec.FV().NumPy()[at] = value
        return vec

    def start(self, value):
        gf = GridFunction(self.X)
        gf.vec.FV().NumPy()[3] = value
        return gf

    def make(self, a=None, gf=None, contacts=None, *, kind=ContactSolver, **flags):
        contacts = self.c if contacts is None else contacts
        return kind(self.p.a if a is None else a, gf or self.gf, contacts, **flags)

    def solve(self, *terms, kind=ContactSolver, given=(), **flags):
        """Solve with further terms in the bulk form."""
        solver = self.make(self.bulk(*terms), kind=kind, **flags)
        solver.Solve(**({"printing": False} | dict(given)))


BULK = "must be the bulk as a BilinearForm"
LAM = "a, the bulk form, holds terms with lam.*leave these terms out"
TESTS = "holds terms with the test function of lam"
NOCONTACT = "contacts = .* must be a LACContact, or a list of them"
EMPTY = "is empty: give at least one LACContact"
SHARED = "contacts: two contacts share one lam: give each a LACSpace of its own"
NOLOAD = "rhs = .* must be a LinearForm or a vector"
NEVER = "is a LinearForm that was never assembled"
BAD, NAME = "NaN or infinite values of rhs at the start", "must be the name of a sparse direct sol"
SOLVERS = "ContactSolver", "AugmentedLagrangianSolver"
REFUSED = [
    # the bulk form
    *(
        (
            f"{make}bulk({flag}=True))",
            f"a has the flag {flag}=True: .*make the Bil",
            ValueError,
        )
        for flag in ("nonassemble", "diagonal", "geom_free", "symmetric_storage")
        for make in ("make(", "FormSum(")
    ),
    (
        "make(bulk(eliminate_internal=True, keep_internal=False))",
        "a has the flag keep_internal=False: .*condense=True is enough",
        ValueError,
    ),
    ("ContactSolver(None, gf, c)", f"a = None {BULK}", TypeError),
    ("make(load())", f"a = <LinearForm> {BULK}", TypeError),
    ("FormSum('a', c)", f"a = 'a' {BULK}", TypeError),
    (
        "make(BilinearForm(VectorH1(p.mesh, complex=True)))",
        "a lives on a complex space",
        ValueError,
    ),
    *(
        (f"solve(1e-3 * {term} * ds('slave'), kind={kind})", LAM, ValueError)
        for kind in SOLVERS
        for term in ("lam * mu", "u.Trace() * mu", "lam * v.Trace()")
    ),
    ("solve(1e-3 * mu[1] * ds('slave'))", f"a, the bulk form, {TESTS}", ValueError),
    ("solve(CF(1j) * u * v * dx)", "^a, the bulk form, cannot be assembled: ", NgException),
    (
        "make(weightless()).Solve()",
        "a, the bulk form, has no stiffness: add that of the bodies",
        ValueError,
    ),
    # contacts and spaces
    *(
        (f"ContactSolver(p.a, gf, {c})", NOCONTACT, TypeError)
        for c in ("None", "'contact'", "3", "[None]", "['contact']", "[[c]]")
    ),
    ("make(contacts=[c, c])", SHARED, ValueError),
    ("make(contacts=[c, twin])", SHARED, ValueError),
    ("FormSum(p.a, c, twin)", SHARED, ValueError),
    ("FormSum(p.a, c, c)", SHARED, ValueError),
    ("FormSum(p.a)", rf"contacts = \(\) {EMPTY}", ValueError),
    ("make(contacts=[])", rf"contacts = \[\] {EMPTY}", ValueError),
    ("make(contacts=press(h=0.5).contact)", "must live on the same product space", ValueError),
    ("make(gf=wrong)", r"gf lives on another space than u and lam, with \d+ dofs", ValueError),
    ("make(press(h=0.5).a)", "a, the bulk form, lives on another space than u and", ValueError),
    # loads, free dofs, start
    ("make(rhs=1.0)", NOLOAD, TypeError),
    ("make(rhs='f')", NOLOAD, TypeError),
    ("make(rhs=np.zeros(X.ndof))", NOLOAD, TypeError),
    ("make(rhs=gf)", "rhs is a GridFunction: give its gf.vec", TypeError),
    ("make(rhs=CreateVVector(X.ndof, complex=True))", "rhs is a complex vector", ValueError),
    ("solve(rhs=lambda: None)", r"rhs\(\) = None must be a LinearForm or a vector", TypeError),
    ("make(rhs=LinearForm(wrong.space))", "rhs is a LinearForm on another space", ValueError),
    ("solve(rhs=load(v[1] * ds('top')))", f"^rhs {NEVER}", ValueError),
    ("solve(rhs=load(v[1](0.5, 0.5)))", f"^rhs {NEVER}", ValueError),
    ("solve(rhs=load(mu[1] * ds('slave')).Assemble())", f"rhs {TESTS}", ValueError),
    ("solve(rhs=wrong.vec)", "rhs"),
    ("solve(rhs=vec(NAN))", BAD, ContactConvergenceError),
    ("solve(rhs=vec(NAN, at=10))", BAD, ContactConvergenceError),
    ("make(freedofs=[True])", r"freedofs = \[True\] must be a BitArray such as X.Free", TypeError),
    ("make(freedofs=locked & ~locked)", "freedofs has no bit set: nothing is free", ValueError),
    ("make(freedofs=BitArray(3))", "freedofs has 3 bits, the product space", ValueError),
    ("make(freedofs=locked)", "freedofs takes dofs of lam away, which contact needs", ValueError),
    *(
        (f"make(gf=start({value}))", "the start value gf holds NaN or infinite values", ValueError)
        for value in ("INF", "-INF", "NAN")
    ),
    # names and numbers
    ("make(initial='all')", "initial = 'all' must be one of 'gap', 'none'", ValueError),
    *(
        (f"make(kind={kind}, inverse={name})", message, error)
        for kind in SOLVERS
        for name, message, error in (
            ("3", f"inverse = .* {NAME}", TypeError),
            ("['umfpack']", f"inverse = .* {NAME}", TypeError),
            ("''", "inverse='' is not available.*None takes the fastest", ValueError),
            ("'mumps'", "inverse='mumps' is not available.*None takes the fastest", ValueError),
        )
    ),
    (
        "make(solver='fast')",
        "one of 'interface', 'direct', 'iterative', 'petsc'",
        ValueError,
    ),
    ("make(solver=3)", "one of 'interface', 'direct', 'iterative', 'petsc'", TypeError),
    ("make(preconditioner='bddc')", "preconditioner = 'bddc' must be a function", TypeError),
    (
        "make(preconditioner=lambda mat, free: mat, solver='direct')",
        "preconditioner= goes with solver='iterative', not 'direct'",
        ValueError,
    ),
    *(
        (
            f"make(kind=AugmentedLagrangianSolver, augmentation={factor})",
            "augmentation = .* must be a positive factor",
            ValueError,
        )
        for factor in ("0.0", "-1.0", "NAN", "INF")
    ),
    *(
        (f"solve(given={{'{name}': {value}}})", f"{name} = .* must be", error)
        for name, error, values in (
            ("tol", TypeError, ("'1e-8'", "True", "1e-8j")),
            ("tol", ValueError, ("0", "-1e-8", "NAN", "INF", "1.0")),
            ("maxit", TypeError, ("3.0", "'30'")),
            ("maxit", ValueError, ("0", "10**400")),
            ("printing", TypeError, ("'no'",)),
            ("callback", TypeError, ("3",)),
            ("motion", TypeError, ("'down'",)),
            ("motion", ValueError, ("np.zeros(2)",)),
        )
        for value in values
    ),
]


@calls(REFUSED)
def test_refused(problem, row):
    problem.gf.vec[:] = 0
    given = Calls(problem)
    methods = {name: getattr(given, name) for name in dir(given) if not name.startswith("_")}
    check_refused(row, press=press, **methods)
    assert not np.any(numpy(problem.gf))


# --- what looks odd and is right -----------------------------------------------------------------


@pytest.mark.parametrize(
    "flags", [{"condense": True, "store_inner": True}, {"eliminate_hidden": True}, {"symmetric": 1}]
)
def test_flags_that_change_nothing(flags):
    plain, other = press(order=3, h=0.5), press(order=3, h=0.5)
    a = BilinearForm(other.X, **flags)
    for integrator in other.a.integrators:
        a += integrator
    other.a = a
    solved(plain)
    solved(other)
    same(other, plain, 1e-9)


def test_any_iterable_of_contacts(problem):
    for several in ([problem.contact], (problem.contact,), iter([problem.contact])):
        assert ContactSolver(problem.a, problem.gf, several).contacts == [problem.contact]


def test_two_multipliers_on_one_space(problem):
    """The same LACSpace twice in a product gives two multipliers: nothing is shared."""
    V = problem.X.components[0]
    Q = LACSpace(V, slave="slave")
    X = V * Q * Q
    u, *lams = X.TrialFunction()
    contacts = [LACContact(u, lam, master="master") for lam in lams]
    assert len(FormSum(BilinearForm(X), *contacts).contacts) == 2


def test_loads_that_are_zero_or_set_by_hand(problem):
    zero = LinearForm(Parameter(0) * problem.X.TestFunction()[0][1] * ds("top")).Assemble()
    filled = LinearForm(problem.X)
    filled.vec[0] = 1e-3
    for f in (zero, filled):
        Calls(problem).solve(rhs=f)


def test_reactions_of_a_solution_as_loads():
    """In the rows of the multipliers they hold what the solver took for zero."""
    problem = mixed_press(h=0.5)
    solved(problem)
    forces = problem.gf.vec.CreateVector()
    problem.a.Apply(problem.gf.vec, forces)
    problem.contact.AddApply(problem.gf.vec, forces)
    assert any(forces[int(dof)] for dof in problem.contact.form.MultiplierDofs())
    start = numpy(problem.gf)
    assert problem.solver(rhs=forces).Solve(printing=False).number <= 1
    assert numpy(problem.gf) == pytest.approx(start, abs=1e-12)


def test_sizes_whose_squares_are_no_numbers():
    for size in (1e-200, 1.0, 1e200):
        assert Norm(np.array([3 * size, -4 * size, 0])) == pytest.approx(5 * size, rel=1e-15, abs=0)
    assert Norm(np.array([1, np.inf])) == np.inf
    assert np.isnan(Norm(np.array([1, np.nan])))
