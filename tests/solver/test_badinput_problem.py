"""Wrong parts of a problem: bulk forms, contacts, loads, free dofs, and names of solvers."""

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


def raises(text, kind=ValueError):
    return pytest.raises(kind, match=text)


@pytest.fixture(scope="module")
def problem():
    return press(h=0.5)


def bulk(problem, *terms, **flags):
    """The bulk form of a problem with further terms or flags."""
    (u, _), (v, _) = problem.X.TnT()
    a = BilinearForm(problem.X, **flags)
    a += linear(u, v) + 1000 * InnerProduct(u, v) * ds("top")
    for term in terms:
        a += term
    return a


# --- the bulk form -----------------------------------------------------------------------------


@pytest.mark.parametrize("flag", ["nonassemble", "diagonal", "geom_free", "symmetric_storage"])
def test_flags_that_leave_no_matrix(problem, flag):
    a = bulk(problem, **{flag: True})
    for make in (lambda: ContactSolver(a, problem.gf, problem.contact), lambda: FormSum(a)):
        with raises(f"a has the flag {flag}=True: .*make the BilinearForm without"):
            make()


def test_inner_displacements_that_are_thrown_away(problem):
    a = bulk(problem, eliminate_internal=True, keep_internal=False)
    with raises("a has the flag keep_internal=False: .*condense=True is enough"):
        ContactSolver(a, problem.gf, problem.contact)


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


def test_what_is_no_bulk_form(problem):
    with raises("a = None must be the bulk as a BilinearForm", TypeError):
        ContactSolver(None, problem.gf, problem.contact)
    with raises("a = <LinearForm> must be the bulk as a BilinearForm", TypeError):
        ContactSolver(LinearForm(problem.X), problem.gf, problem.contact)
    with raises("a = 'a' must be the bulk as a BilinearForm", TypeError):
        FormSum("a", problem.contact)
    complex_space = VectorH1(problem.X.mesh, order=1, complex=True)
    with raises("a lives on a complex space"):
        ContactSolver(BilinearForm(complex_space), problem.gf, problem.contact)


@pytest.mark.parametrize("kind", ["lam mu", "u mu", "lam v"])
@pytest.mark.parametrize("solver", [ContactSolver, AugmentedLagrangianSolver])
def test_multipliers_in_the_bulk_form(problem, kind, solver):
    """They would change the contact law, or be counted twice."""
    (u, lam), (v, mu) = problem.X.TnT()
    pairs = {"lam mu": (lam, mu), "u mu": (u.Trace(), mu), "lam v": (lam, v.Trace())}
    a = bulk(problem, 1e-3 * InnerProduct(*pairs[kind]) * ds("slave"))
    with raises("a, the bulk form, holds terms with lam.*leave these terms out"):
        solver(a, problem.gf, problem.contact).Solve(printing=False)


def test_loads_of_the_multipliers(problem):
    (_, _), (v, mu) = problem.X.TnT()
    with raises("a, the bulk form, holds terms with the test function of lam"):
        a = bulk(problem, 1e-3 * mu[1] * ds("slave"))
        ContactSolver(a, problem.gf, problem.contact).Solve(printing=False)
    f = LinearForm(1e-3 * mu[1] * ds("slave") + v[1] * ds("top")).Assemble()
    with raises("rhs holds terms with the test function of lam"):
        ContactSolver(bulk(problem), problem.gf, problem.contact, rhs=f).Solve(printing=False)


# --- contacts ----------------------------------------------------------------------------------


@pytest.mark.parametrize("wrong", [None, "contact", 3, [None], ["contact"]])
def test_what_is_no_contact(problem, wrong):
    with raises("contacts = .* must be a LACContact, or a list of them", TypeError):
        ContactSolver(problem.a, problem.gf, wrong)


def test_contacts_in_a_list_in_a_list(problem):
    with raises(r"contacts = \[<LACContact: .* must be a LACContact", TypeError):
        ContactSolver(problem.a, problem.gf, [[problem.contact]])


def test_any_iterable_of_contacts(problem):
    for several in ([problem.contact], (problem.contact,), iter([problem.contact])):
        assert ContactSolver(problem.a, problem.gf, several).contacts == [problem.contact]


def test_contacts_that_share_a_multiplier(problem):
    u, lam = problem.X.TrialFunction()
    same = LACContact(u, lam, master="master")
    for pair in ([problem.contact, problem.contact], [problem.contact, same]):
        with raises("contacts: two contacts share one lam: give each a LACSpace of its own"):
            ContactSolver(problem.a, problem.gf, pair)
        with raises("contacts: two contacts share one lam"):
            FormSum(problem.a, *pair)


def test_two_multipliers_on_one_space(problem):
    """The same LACSpace twice in a product gives two multipliers: nothing is shared."""
    V = problem.X.components[0]
    Q = LACSpace(V, slave="slave")
    X = V * Q * Q
    u, first, second = X.TrialFunction()
    contacts = [LACContact(u, lam, master="master") for lam in (first, second)]
    assert len(FormSum(BilinearForm(X), *contacts).contacts) == 2


def test_a_sum_without_contact(problem):
    with raises(r"contacts = \(\) is empty: give at least one LACContact"):
        FormSum(problem.a)


# --- loads, free dofs, start, solvers ----------------------------------------------------------


@pytest.mark.parametrize("make", [lambda _: 1.0, lambda _: "f", lambda p: np.zeros(p.X.ndof)])
def test_what_is_no_load(problem, make):
    with raises("rhs = .* must be a LinearForm or a vector", TypeError):
        problem.solver(rhs=make(problem))


def test_a_function_without_a_load(problem):
    with raises(r"rhs\(\) = None must be a LinearForm or a vector", TypeError):
        problem.solver(rhs=lambda: None).Solve(printing=False)


def test_a_load_on_another_space(problem):
    v = problem.X.components[0].TestFunction()
    with raises("rhs is a LinearForm on another space"):
        problem.solver(rhs=LinearForm(v[1] * dx).Assemble())


def test_a_load_that_was_never_assembled(problem):
    v = problem.X.TestFunction()[0]
    for terms in (v[1] * ds("top"), v[1](0.5, 0.5)):
        f = LinearForm(problem.X)
        f += terms
        for rhs, name in ((f, "rhs"), (lambda f=f: f, r"rhs\(\)")):
            solver = ContactSolver(bulk(problem), problem.gf, problem.contact, rhs=rhs)
            with raises(f"^{name} is a LinearForm that was never assembled"):
                solver.Solve(printing=False)


def test_loads_that_are_zero_or_set_by_hand(problem):
    v = problem.X.TestFunction()[0]
    load = Parameter(0)
    zero, filled = LinearForm(load * v[1] * ds("top")).Assemble(), LinearForm(problem.X)
    filled.vec[0] = 1e-3
    for f in (zero, filled):
        solver = ContactSolver(bulk(problem), problem.gf, problem.contact, rhs=f)
        solver.Solve(printing=False)


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


def test_free_dofs(problem):
    with raises(r"freedofs = \[True\] must be a BitArray such as X.FreeDofs\(\)", TypeError):
        problem.solver(freedofs=[True])
    with raises("freedofs has 3 bits, the product space"):
        problem.solver(freedofs=BitArray(3))
    bits = BitArray(problem.X.FreeDofs())
    bits[int(problem.contact.form.MultiplierDofs()[0])] = False
    with raises("freedofs takes dofs of lam away, which contact needs"):
        problem.solver(freedofs=bits)


def test_a_load_that_is_not_a_number(problem):
    load = problem.gf.vec.CreateVector()
    load[:] = np.nan
    with raises("NaN or infinite values of rhs at the start", ContactConvergenceError):
        problem.solver(rhs=load).Solve(printing=False)


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


@pytest.mark.parametrize("value", [np.inf, -np.inf, np.nan])
def test_a_start_that_is_not_finite(problem, value):
    gf = GridFunction(problem.X)
    gf.vec.FV().NumPy()[3] = value
    with raises("the start value gf holds NaN or infinite values"):
        ContactSolver(problem.a, gf, problem.contact)


@pytest.mark.parametrize("solver", [ContactSolver, AugmentedLagrangianSolver])
def test_names_of_solvers(problem, solver):
    for wrong in (3, b"umfpack", ["umfpack"]):
        with raises("inverse = .* must be the name of a sparse direct solver", TypeError):
            solver(problem.a, problem.gf, problem.contact, inverse=wrong)
    for wrong in ("", "UMFPACK", "nonsense"):
        with raises(f"inverse='{wrong}' is not available.*None takes the fastest"):
            solver(problem.a, problem.gf, problem.contact, inverse=wrong)


def test_a_preconditioner_that_is_no_function(problem):
    with raises("preconditioner = 'bddc' must be a function", TypeError):
        problem.solver(preconditioner="bddc")
    with raises("preconditioner= goes with solver='iterative', not 'direct'"):
        problem.solver(preconditioner=lambda mat, free: mat, solver="direct")


@pytest.mark.parametrize(
    ("flags", "kind"),
    [
        ({"tol": "1e-8"}, TypeError),
        ({"tol": True}, TypeError),
        ({"tol": 1e-8j}, TypeError),
        ({"maxit": 3.0}, TypeError),
        ({"maxit": "30"}, TypeError),
        ({"maxit": 10**400}, ValueError),
        ({"printing": "no"}, TypeError),
        ({"callback": 3}, TypeError),
        ({"motion": "down"}, TypeError),
        ({"motion": np.zeros(2)}, ValueError),
    ],
)
def test_arguments_of_a_solve(problem, flags, kind):
    (name,) = flags
    with raises(f"{name} = .* must be", kind):
        problem.solver().Solve(**({"printing": False} | flags))


# --- the scale of the contact law --------------------------------------------------------------


@pytest.mark.parametrize("factor", [1e-300, 9e-7, 1.1e6, 1e300])
def test_a_scale_that_costs_all_digits(factor):
    with raises("stiffness = .* must be a positive factor from 1e-06 to 1e"):
        press(stiffness=factor)


def test_results_do_not_depend_on_the_scale():
    forces = []
    for factor in (1e-6, 1.0, 1e6):
        made = press(h=0.5, friction=0.3, stiffness=factor)
        made.solver().Solve(printing=False)
        forces.append(made.contact.Force())
    assert forces[0] == pytest.approx(forces[1], rel=1e-9)
    assert forces[2] == pytest.approx(forces[1], rel=1e-9)


def test_a_bulk_that_cannot_be_assembled(problem):
    (u, _), (v, _) = problem.X.TnT()
    a = bulk(problem, CF(1j) * InnerProduct(u, v) * dx)
    with raises("^a, the bulk form, cannot be assembled: ", NgException):
        ContactSolver(a, problem.gf, problem.contact).Solve(printing=False)
