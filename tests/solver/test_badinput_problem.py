"""Wrong parts of a problem: bulk forms, contacts, loads, free dofs, arguments of a solve."""

import numpy as np
import pytest
from netgen.meshing import NgException
from ngsolve import (
    CF,
    BilinearForm,
    BitArray,
    Grad,
    GridFunction,
    InnerProduct,
    LinearForm,
    Parameter,
    VectorH1,
    ds,
    dx,
)
from press import linear, mixed_press, numpy, press

from ngslac import (
    AugmentedLagrangianSolver,
    ContactConvergenceError,
    ContactSolver,
    FormSum,
    LACContact,
    LACSpace,
)
from ngslac.solve.residual import Norm

NAN, INF = float("nan"), float("inf")
SOLVERS = (ContactSolver, AugmentedLagrangianSolver)


@pytest.fixture(scope="module")
def problem():
    return press(h=0.5)


def bulk(p, *terms, **flags):
    """The bulk form of a problem with further terms or flags."""
    (u, _), (v, _) = p.X.TnT()
    a = BilinearForm(p.X, **flags)
    a += linear(u, v) + 1000 * InnerProduct(u, v) * ds("top")
    for term in terms:
        a += term
    return a


def weightless(p):
    (u, _), (v, _) = p.X.TnT()
    a = BilinearForm(p.X, check_unused=False)
    a += 0 * u * v * dx - v[1] * ds("top")
    return a


def of(a, kind=ContactSolver, *, solve=False):
    """A solver with that bulk form, which a function of the problem makes."""

    def make(p):
        solver = kind(a(p), p.gf, p.contact)
        if solve:
            solver.Solve(printing=False)

    return make


def with_term(term, kind=ContactSolver):
    """Solve with a term more in the bulk form: a function of u, lam, v, mu."""
    return of(lambda p: bulk(p, term(*(f for pair in p.X.TnT() for f in pair))), kind, solve=True)


def solver(**flags):
    return lambda p: p.solver(**flags)


def solve(**flags):
    return lambda p: p.solver().Solve(**({"printing": False} | flags))


def loaded(rhs, *, a=bulk):
    """Solve with a load that a function of the problem makes."""
    return lambda p: ContactSolver(a(p), p.gf, p.contact, rhs=rhs(p)).Solve(printing=False)


def load(*terms):
    def make(p):
        f = LinearForm(p.X)
        for term in terms:
            f += term(*p.X.TestFunction())
        return f

    return make


def vector(value, at=slice(None)):
    def make(p):
        vec = p.gf.vec.CreateVector()
        vec[:] = 0
        vec.FV().NumPy()[at] = value
        return vec

    return make


def start(value):
    def make(p):
        gf = GridFunction(p.X)
        gf.vec.FV().NumPy()[3] = value
        return ContactSolver(p.a, gf, p.contact)

    return make


def twins(p):
    return LACContact(*p.X.TrialFunction(), master="master"), p.contact


def without_a_multiplier(p):
    bits = BitArray(p.X.FreeDofs())
    bits[int(p.contact.form.MultiplierDofs()[0])] = False
    return p.solver(freedofs=bits)


BULK = "must be the bulk as a BilinearForm"
LAM = "a, the bulk form, holds terms with lam.*leave these terms out"
NOCONTACT = "contacts = .* must be a LACContact, or a list of them"
NOLOAD = "rhs = .* must be a LinearForm or a vector"
NEVER = "^rhs.* is a LinearForm that was never assembled"
BAD = "NaN or infinite values of rhs at the start"
SHARED = "contacts: two contacts share one lam: give each a LACSpace of its own"
REFUSED = [
    # the bulk form
    *(
        (of(lambda p, f=f: bulk(p, **{f: True}), kind=kind), ValueError, f"a has the flag {f}=True")
        for f in ("nonassemble", "diagonal", "geom_free", "symmetric_storage")
        for kind in (ContactSolver, lambda a, gf, contact: FormSum(a, contact))
    ),
    (
        of(lambda p: bulk(p, eliminate_internal=True, keep_internal=False)),
        ValueError,
        "a has the flag keep_internal=False: .*condense=True is enough",
    ),
    (of(lambda p: None), TypeError, f"a = None {BULK}"),
    (of(lambda p: LinearForm(p.X)), TypeError, f"a = <LinearForm> {BULK}"),
    (lambda p: FormSum("a", p.contact), TypeError, f"a = 'a' {BULK}"),
    (
        of(lambda p: BilinearForm(VectorH1(p.mesh, complex=True))),
        ValueError,
        "a lives on a complex space",
    ),
    *(
        (with_term(term, kind), ValueError, LAM)
        for kind in SOLVERS
        for term in (
            lambda u, lam, v, mu: 1e-3 * lam * mu * ds("slave"),
            lambda u, lam, v, mu: 1e-3 * u.Trace() * mu * ds("slave"),
            lambda u, lam, v, mu: 1e-3 * lam * v.Trace() * ds("slave"),
        )
    ),
    (
        with_term(lambda u, lam, v, mu: 1e-3 * mu[1] * ds("slave")),
        ValueError,
        "a, the bulk form, holds terms with the test function of lam",
    ),
    (
        with_term(lambda u, lam, v, mu: CF(1j) * u * v * dx),
        NgException,
        "^a, the bulk form, cannot be assembled: ",
    ),
    (
        of(weightless, solve=True),
        ValueError,
        "a, the bulk form, has no stiffness: add that of the bodies",
    ),
    # contacts and spaces
    *(
        (lambda p, c=c: ContactSolver(p.a, p.gf, c), TypeError, NOCONTACT)
        for c in (None, "contact", 3, [None], ["contact"])
    ),
    (
        lambda p: ContactSolver(p.a, p.gf, [[p.contact]]),
        TypeError,
        r"contacts = \[<LACContact: .* must be a LACContact",
    ),
    *(
        (make, ValueError, SHARED)
        for make in (
            lambda p: ContactSolver(p.a, p.gf, [p.contact] * 2),
            lambda p: ContactSolver(p.a, p.gf, twins(p)),
            lambda p: FormSum(p.a, *twins(p)),
        )
    ),
    (lambda p: FormSum(p.a), ValueError, r"contacts = \(\) is empty: give at least one LACContact"),
    (
        lambda p: ContactSolver(p.a, p.gf, []),
        ValueError,
        r"contacts = \[\] is empty: give at least one LACContact",
    ),
    (
        lambda p: ContactSolver(p.a, p.gf, press(h=0.5).contact),
        ValueError,
        "a, gf and the contacts must live on the same product space",
    ),
    (
        lambda p: ContactSolver(p.a, GridFunction(p.X.components[0]), p.contact),
        ValueError,
        r"gf lives on another space than u and lam, with \d+ dofs",
    ),
    (of(lambda p: press(h=0.5).a), ValueError, "gf lives on another space"),
    # loads, free dofs, start
    (solver(rhs=1.0), TypeError, NOLOAD),
    (solver(rhs="f"), TypeError, NOLOAD),
    (lambda p: p.solver(rhs=np.zeros(p.X.ndof)), TypeError, NOLOAD),
    (loaded(lambda p: lambda: None), TypeError, r"rhs\(\) = None must be a LinearForm or a vector"),
    (
        loaded(lambda p: LinearForm(p.X.components[0].TestFunction()[1] * dx).Assemble()),
        ValueError,
        "rhs is a LinearForm on another space",
    ),
    *(
        (loaded(wrap), ValueError, NEVER)
        for f in (load(lambda v, _: v[1] * ds("top")), load(lambda v, _: v[1](0.5, 0.5)))
        for wrap in (f, lambda p, f=f: lambda: f(p))
    ),
    (
        loaded(lambda p: load(lambda v, mu: 1e-3 * mu[1] * ds("slave") + v[1] * dx)(p).Assemble()),
        ValueError,
        "rhs holds terms with the test function of lam",
    ),
    (loaded(lambda p: GridFunction(p.X.components[0]).vec), Exception, "rhs"),
    (loaded(vector(NAN)), ContactConvergenceError, BAD),
    (loaded(vector(NAN, at=10)), ContactConvergenceError, BAD),
    (
        solver(freedofs=[True]),
        TypeError,
        r"freedofs = \[True\] must be a BitArray such as X.FreeDofs\(\)",
    ),
    (solver(freedofs=BitArray(3)), ValueError, "freedofs has 3 bits, the product space"),
    (without_a_multiplier, ValueError, "freedofs takes dofs of lam away, which contact needs"),
    *(
        (start(value), ValueError, "the start value gf holds NaN or infinite values")
        for value in (INF, -INF, NAN)
    ),
    # names and numbers
    (solver(initial="all"), ValueError, "initial = 'all' must be one of 'gap', 'none'"),
    *(
        (lambda p, i=i, k=kind: k(p.a, p.gf, p.contact, inverse=i), error, message)
        for kind in SOLVERS
        for i, error, message in (
            (3, TypeError, "inverse = .* must be the name of a sparse direct solver"),
            (["umfpack"], TypeError, "inverse = .* must be the name of a sparse direct solver"),
            ("", ValueError, "inverse='' is not available.*None takes the fastest"),
            ("mumps", ValueError, "inverse='mumps' is not available.*None takes the fastest"),
        )
    ),
    (solver(solver="fast"), ValueError, "must be one of 'direct', 'iterative', 'saddle'"),
    (solver(solver=3), TypeError, "must be one of 'direct', 'iterative', 'saddle'"),
    (solver(preconditioner="bddc"), TypeError, "preconditioner = 'bddc' must be a function"),
    (
        solver(preconditioner=lambda mat, free: mat, solver="direct"),
        ValueError,
        "preconditioner= goes with solver='iterative', not 'direct'",
    ),
    *(
        (
            lambda p, f=factor: AugmentedLagrangianSolver(p.a, p.gf, p.contact, augmentation=f),
            ValueError,
            r"augmentation = .* must be a positive factor",
        )
        for factor in (0.0, -1.0, NAN, INF)
    ),
    *(
        (solve(**{name: value}), error, f"{name} = .* must be")
        for name, value, error in (
            ("tol", "1e-8", TypeError),
            ("tol", True, TypeError),
            ("tol", 1e-8j, TypeError),
            ("tol", 0, ValueError),
            ("tol", -1e-8, ValueError),
            ("tol", NAN, ValueError),
            ("tol", INF, ValueError),
            ("tol", 1.0, ValueError),
            ("maxit", 0, ValueError),
            ("maxit", 3.0, TypeError),
            ("maxit", "30", TypeError),
            ("maxit", 10**400, ValueError),
            ("printing", "no", TypeError),
            ("callback", 3, TypeError),
            ("motion", "down", TypeError),
            ("motion", np.zeros(2), ValueError),
        )
    ),
]


@pytest.mark.parametrize(("call", "error", "message"), REFUSED)
def test_refused(problem, call, error, message):
    problem.gf.vec[:] = 0
    with pytest.raises(error, match=message):
        call(problem)
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
    plain.solver().Solve(printing=False)
    ContactSolver(a, other.gf, other.contact).Solve(printing=False)
    assert numpy(other.gf) == pytest.approx(numpy(plain.gf), rel=1e-9, abs=1e-12)


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
        loaded(lambda _, f=f: f)(problem)


def test_reactions_of_a_solution_as_loads():
    """In the rows of the multipliers they hold what the solver took for zero."""
    problem = mixed_press(h=0.5)
    problem.solver().Solve(printing=False)
    forces = problem.gf.vec.CreateVector()
    problem.a.Apply(problem.gf.vec, forces)
    problem.contact.AddApply(problem.gf.vec, forces)
    assert any(forces[int(dof)] for dof in problem.contact.form.MultiplierDofs())
    start = numpy(problem.gf)
    solver = ContactSolver(problem.a, problem.gf, problem.contact, rhs=forces)
    assert solver.Solve(printing=False).number <= 1
    assert numpy(problem.gf) == pytest.approx(start, abs=1e-12)


@pytest.mark.parametrize("size", [1e-140, 1e140])
def test_forces_of_any_unit(problem, size):
    (u, _), (v, _) = problem.X.TnT()
    forces = []
    for factor in (1, size):
        contact = LACContact(*problem.X.TrialFunction(), master="master")
        a, gf = BilinearForm(problem.X), GridFunction(problem.X)
        a += factor * (InnerProduct(Grad(u), Grad(v)) * dx + u * v * ds("top|bottom"))
        a += factor * 0.01 * v[1] * ds("top")
        ContactSolver(a, gf, contact).Solve(printing=False)
        forces.append(contact.Force()[1] / factor)
    assert forces[1] == pytest.approx(forces[0], rel=1e-12)


def test_sizes_whose_squares_are_no_numbers():
    for size in (1e-200, 1.0, 1e200):
        assert Norm(np.array([3 * size, -4 * size, 0])) == pytest.approx(5 * size, rel=1e-15)
    assert Norm(np.array([1, np.inf])) == np.inf
    assert np.isnan(Norm(np.array([1, np.nan])))
