"""Derivatives of one solve against differences of full solves."""

import warnings

import numpy as np
import pytest
from netgen.occ import Circle, Compound, OCCGeometry, Rectangle, Y
from ngsolve import (
    CF,
    H1,
    L2,
    BilinearForm,
    Grad,
    GridFunction,
    IfPos,
    InnerProduct,
    Integrate,
    LinearForm,
    Mesh,
    Norm,
    NumberSpace,
    Parameter,
    Sym,
    Trace,
    VectorH1,
    ds,
    dx,
    grad,
    sqrt,
    x,
    y,
)
from obstacles import block_on_obstacle
from posed import posed
from press import mixed_press, press, stress
from varied import TOL, Moved, close, differences, solve, velocity

from ngslac import ContactSolver, ContactWarning, LACContact, LACSpace, Law, tools
from ngslac.analysis import Sensitivity, Shape
from ngslac.errors import LinearSolveError


def scaled(young):
    return lambda u, v, load: [young * InnerProduct(stress(u), Sym(Grad(v))) * dx]


def functionals(problem):
    """Integrals of trial functions, and a function of the same numbers and of contact forces."""
    u, lam = problem.X.TrialFunction()[0], problem.X.TrialFunction()[-1]
    d = problem.mesh.dim

    def Terms(u, strain, lam):
        return u[0] * u[d - 1] * ds("top") + lam[0] * ds("slave") + 0.1 * Trace(strain) ** 2 * dx

    solved, tractions = problem.gf.components[0], problem.gf.components[-1]
    known = Terms(solved, Grad(solved), tractions)

    def Numbers():
        return np.array([Integrate(known, problem.mesh), *problem.contact.Force()])

    return Terms(u, Grad(u), lam), Numbers


def check(problem, variable, step, tol=1e-6):
    solver = solve(problem)
    integrals, numbers = functionals(problem)
    adjoint, direct = Sensitivity(solver, integrals), Sensitivity(solver, numbers)
    varied = Moved(variable, problem.contact) if isinstance(variable, Shape) else variable

    def Look():
        solve(problem)
        return numbers()

    found = adjoint.By(variable), direct.By(variable)
    expected = differences(varied, Look, step)
    close(found[0], expected[0], tol)
    close(found[1], expected, tol)


MU, YOUNG, OFFSET = Parameter(0.15), Parameter(1.0), Parameter(0.0)
PROBLEMS = {
    "frictionless": lambda dim: press(dim=dim, offset=OFFSET, bulk=scaled(YOUNG)),
    "friction": lambda dim: press(dim=dim, friction=MU, offset=OFFSET, bulk=scaled(YOUNG)),
    "tresca": lambda dim: press(dim=dim, tresca=MU, offset=OFFSET, bulk=scaled(YOUNG)),
    "mixed": lambda dim: mixed_press(
        dim=dim, friction=IfPos(x - 0.3, MU, 2.0), offset=OFFSET, bulk=scaled(YOUNG)
    ),
    "bilateral": lambda dim: press(
        dim=dim, friction=MU, bilateral=True, offset=OFFSET, bulk=scaled(YOUNG)
    ),
    "finite": lambda dim: press(
        dim=dim, friction=MU, finite=True, offset=OFFSET, bulk=scaled(YOUNG)
    ),
}


@pytest.mark.sample(6)
@pytest.mark.parametrize("dim", [2, 3])
@pytest.mark.parametrize("kind", PROBLEMS)
def test_by_material_friction_obstacle_and_load(kind, dim):
    problem = PROBLEMS[kind](dim)
    variables = {YOUNG: 1e-4, OFFSET: 1e-6, problem.load: 1e-4}
    if kind != "frictionless":
        variables[MU] = 1e-5
    for variable, step in variables.items():
        check(problem, variable, step)


@pytest.mark.parametrize("dim", [2, 3])
@pytest.mark.parametrize("finite", [False, True])
def test_of_ties(dim, finite):
    problem = press(dim=dim, tied=True, finite=finite, bulk=scaled(YOUNG))
    check(problem, YOUNG, 1e-4)
    check(problem, Shape(problem.mesh, velocity(dim)), 1e-4)


@pytest.mark.sample(4)
@pytest.mark.parametrize("dim", [2, 3])
@pytest.mark.parametrize(
    "make",
    [
        lambda dim: press(dim=dim, friction=0.15, offset=0.01 * x**2),
        lambda dim: mixed_press(dim=dim),
        lambda dim: press(dim=dim, friction=0.15, finite=True, nonlinear=True),
        lambda dim: press(dim=dim, adjust=0.1, offset=0.001 * x),
    ],
    ids=["friction", "mixed", "finite", "adjust"],
)
def test_by_shape(make, dim):
    problem = make(dim)
    check(problem, Shape(problem.mesh, velocity(dim)), 1e-4)


def test_by_shape_with_sharp_ends():
    problem = press(edges=True)
    check(problem, Shape(problem.mesh, velocity(2)), 1e-4)


@pytest.mark.parametrize("dim", [2, 3])
def test_of_an_obstacle_by_its_place_and_by_shape(dim):
    depth = Parameter(0.01)
    gap = depth * (x**2 - 0.5) if dim == 2 else depth * (x**2 + y - 1)
    problem = block_on_obstacle(gap, dim=dim, traction=(0.1, -1) if dim == 2 else (0.1, 0, -1))
    solver = solve(problem)
    status = problem.contact.Table()["status"]
    assert 0 < np.count_nonzero(status) < len(status)
    look = lambda: problem.contact.Table()["pressure"]  # noqa: E731
    s = Sensitivity(solver, look)
    shape = Shape(problem.mesh, velocity(dim))
    for variable, varied in ((depth, depth), (shape, Moved(shape, problem.contact))):
        found = s.By(variable)
        step = 1e-6 if variable is depth else 1e-5
        close(found, differences(varied, lambda: solve(problem) and look(), step))


def test_of_a_tool_by_its_motion():
    travel = Parameter(0.03)
    mesh = Mesh(OCCGeometry(Named(Rectangle(2, 1).Face()), dim=2).GenerateMesh(maxh=0.2))
    V = VectorH1(mesh, order=2, dirichlet="bottom")
    tool = tools.Sphere((1, 2), 1).Moved(shift=(0, -travel))
    problem = posed(
        V,
        lambda u, v, load: InnerProduct(stress(u), Sym(Grad(v))) * dx,
        obstacle=tool,
        finite=True,
        friction=0.1,
    )
    force = problem.contact.Force

    def Solve():
        problem.gf.vec[:] = 0
        return solve(problem)

    close(
        Sensitivity(Solve(), force).By(travel),
        differences(travel, lambda: Solve() and force(), 1e-6),
    )


def Named(block):
    block.edges.name = "free"
    block.edges.Min(Y).name, block.edges.Max(Y).name = "bottom", "slave"
    return block


class Layer:
    """A law in NumPy with a constant, which is a variable through Get and Set."""

    stiffness = 200.0

    def __call__(self, places):
        closed = places["gap"] < 0
        way = places["normal"] + 0.5 * places["slip"]
        pressure = -self.stiffness * np.minimum(places["gap"], 0)
        return {
            "traction": -pressure[:, None] * way,
            "by_gap": (self.stiffness * closed)[:, None] * way,
            "by_slip": -0.5 * pressure[:, None, None] * np.eye(way.shape[1]),
        }

    def Get(self):
        return self.stiffness

    def Set(self, value):
        self.stiffness = value


@pytest.mark.parametrize("dim", [2, 3])
def test_by_constants_of_laws_of_ones_own(dim):
    layer = Layer()
    check(press(dim=dim, law=layer), layer, 1e-2)
    k = Parameter(1e4)
    soft = Law(lambda z: -IfPos(z.gap, 0, k * z.gap**2) * (z.normal + 0.5 * z.slip))
    check(press(dim=dim, law=soft), k, 1.0)
    falls = press(dim=dim, friction=lambda z: MU / (1 + 20 * Norm(z.slip)))
    check(falls, MU, 1e-5)


def test_by_the_entries_of_fields(monkeypatch):
    mesh = press().mesh
    young, gap = GridFunction(L2(mesh, order=0)), GridFunction(H1(mesh, order=1))
    young.Set(1 + 0.1 * x)
    gap.Set(0.002 * x)
    problem = press(change=lambda _: mesh, bulk=scaled(young), offset=gap, friction=0.15)
    integrals, _ = functionals(problem)
    s = Sensitivity(solve(problem), integrals)
    for field in (young, gap):
        gradient, start = s.By(field), field.vec.FV().NumPy().copy()
        assert gradient.shape == start.shape
        way = np.random.default_rng(7).normal(size=start.shape) * np.abs(start).max()

        class Along:
            def Get(self):
                return 0.0

            def Set(self, part, field=field, start=start, way=way):
                field.vec.FV().NumPy()[:] = start + part * way

        def Look():
            return Sensitivity(solve(problem), integrals).value

        close(gradient @ way, differences(Along(), Look, 1e-4))
    solver = solve(problem)
    field = young * problem.X.TrialFunction()[0][0] ** 2 * dx
    s, holding = Sensitivity(solver, integrals), Sensitivity(solver, field)
    together = s.By(young)
    monkeypatch.setattr(Sensitivity, "_Together", lambda *_: None)
    close(together, s.By(young), 1e-12)
    expected = holding.By(young)
    monkeypatch.undo()
    close(holding.By(young), expected, 1e-12)
    total = s.Gradient([young, problem.load])
    assert total.shape == (mesh.ne + 1,)
    assert total[-1] == s.By(problem.load)


@pytest.mark.parametrize("where", ["offset", "bulk"])
def test_a_field_of_which_the_gradient_occurs(where):
    """Adding a constant to it changes nothing."""
    mesh = press().mesh
    field = GridFunction(H1(mesh, order=1))
    field.Set(0.3 + 0.1 * x + 0.2 * y)
    slope = grad(field)
    law = {"offset": 0.02 * slope[0] * x} if where == "offset" else {}
    young = 1 + 10 * InnerProduct(slope, slope) if where == "bulk" else CF(1)

    def Solved():
        problem = press(change=lambda _: mesh, friction=0.15, bulk=scaled(young), **law)
        return problem, solve(problem)

    problem, solver = Solved()
    look = lambda problem: Integrate(problem.gf.components[0][1] * x * ds("top"), mesh)  # noqa: E731
    integral = problem.X.TrialFunction()[0][1] * x * ds("top")
    adjoint = Sensitivity(solver, integral).By(field)
    direct = Sensitivity(solver, lambda: look(problem)).By(field)
    values, expected = field.vec.FV().NumPy(), []
    chosen = np.argsort(-np.abs(adjoint))[:5]

    class Entry:
        def __init__(self, number):
            self.number = number

        def Get(self):
            return values[self.number]

        def Set(self, value):
            values[self.number] = value

    for number in chosen.tolist():
        expected.append(differences(Entry(number), lambda: look(Solved()[0]), 1e-5))
    close(adjoint[chosen], expected)
    close(direct[chosen], expected)


def test_what_is_not_loaded_yet_has_a_derivative():
    force = Parameter(0.0)
    problem = press(offset=0.01, spring=0, flags={"dirichlet": "bottom|top"})
    u, v = problem.X.TrialFunction()[0], problem.X.TestFunction()[0]
    problem.a += force * v[1] * ds("right_upper")
    value = lambda: Integrate(problem.gf.components[0][1] * ds("slave"), problem.mesh)  # noqa: E731
    solver = solve(problem)
    assert value() == 0
    found = [Sensitivity(solver, f).By(force) for f in (value, u[1] * ds("slave"))]
    expected = differences(force, lambda: solve(problem) and value(), 1e-4)
    assert abs(expected) > 1e-6
    close(found, [expected, expected])


@pytest.mark.parametrize("law", [{"friction": 0.3}, {"tresca": 1.0}, {"tied": True}])
def test_a_functional_that_is_zero_in_balance(law):
    aside = Parameter(0.0)
    problem = press(spring=0, **law)
    lam, v = problem.X.TrialFunction()[1], problem.X.TestFunction()[0]
    problem.a += ((1 + x) * v[1] - aside * v[0]) * ds("top")
    solver = solve(problem)
    s = Sensitivity(solver, lam[0] * ds("slave"))
    assert abs(s.value) < 1e-12
    close(abs(s.By(aside)), Integrate(CF(1) * ds("top"), problem.mesh), 1e-8)
    held = problem.gf.components[1][0] ** 2 + 0 * lam[0]  # that is not zero
    with pytest.raises(ValueError, match="TrialFunction"):
        Sensitivity(solver, held * ds("slave"))


def test_what_floats_is_named():
    problem = press(spring=0)
    u, v = problem.X.TnT()[0][0], problem.X.TnT()[1][0]
    problem.a += v[1] * ds("top")
    with pytest.warns(ContactWarning, match="free"):
        solver = solve(problem)
    with pytest.raises(LinearSolveError, match="'upper' floats"):
        Sensitivity(solver, u[0] * dx)
    before = problem.gf.vec.FV().NumPy().copy()
    with pytest.raises(LinearSolveError, match="'upper' floats"):
        Sensitivity(solver, problem.contact.Force).By(Shape(problem.mesh, velocity(2)))
    assert np.array_equal(before, problem.gf.vec.FV().NumPy())


def test_by_loads_and_dirichlet_values():
    force, push = Parameter(0.02), Parameter(0.01)
    problem = press(friction=0.1, flags={"dirichlet": "bottom|top"}, spring=0)
    v = problem.X.TestFunction()[0]
    rhs = LinearForm(force * v[0] * dx)
    prescribe = {"top": CF((0.3 * push**2, -push))}
    gf = problem.gf

    def Solve():
        gf.vec[:] = 0
        gf.components[0].Set(prescribe["top"], definedon=problem.mesh.Boundaries("top"))
        rhs.Assemble()
        solver = problem.solver(rhs=rhs)
        solver.Solve(printing=False, tol=TOL)
        return solver

    solver = Solve()
    u, lam = problem.X.TrialFunction()
    numbers = Sensitivity(solver, lambda: solver.Reaction("top"), prescribe=prescribe)
    integral = Sensitivity(solver, u[1] ** 2 * dx + lam[1] * ds("slave"), prescribe=prescribe)
    loads = rhs.vec.FV().NumPy().copy()
    for variable in (force, push):
        found = numbers.By(variable), integral.By(variable), integral.Solution(variable)
        assert np.array_equal(rhs.vec.FV().NumPy(), loads)
        close(found[0], differences(variable, lambda: Solve().Reaction("top"), 1e-6))

        def Look():
            Solve()
            u, lam = gf.components
            return Integrate(u[1] ** 2 * dx + lam[1] * ds("slave"), problem.mesh)

        close(found[1], differences(variable, Look, 1e-6))
        expected = differences(variable, lambda: Solve() and gf.vec.FV().NumPy().copy(), 1e-6)
        close(found[2].vec.FV().NumPy(), expected)
        Solve()


def test_a_coefficient_at_zero_that_may_not_be_negative():
    mu = Parameter(0.0)
    problem = press(friction=mu, push=(0.02, -0.02))
    s = Sensitivity(solve(problem), problem.contact.Force)
    found = s.By(mu)
    forces = []
    for value in (0.0, 1e-4, 2e-4):
        mu.Set(value)
        solve(problem)
        forces.append(problem.contact.Force())
    mu.Set(0)
    close(found, (-1.5 * forces[0] + 2 * forces[1] - 0.5 * forces[2]) / 1e-4)


@pytest.mark.parametrize("second", [False, True], ids=["Curve", "SecondOrder"])
def test_by_the_shape_of_curved_surfaces(second):
    roll = Circle((0, 1), 1).Face() * Rectangle(2, 0.8).Face().Move((-1, 0, 0))
    block = Rectangle(3, 1).Face().Move((-1.5, -1, 0))
    roll.edges.name, block.edges.name = "slave", "free"
    roll.edges.Max(Y).name = "top"
    block.edges.Min(Y).name, block.edges.Max(Y).name = "bottom", "master"
    roll.edges["slave"].maxh = block.edges["master"].maxh = 0.15
    ngmesh = OCCGeometry(Compound([roll, block]), dim=2).GenerateMesh(maxh=0.4)
    if second:
        ngmesh.SecondOrder()
    mesh = Mesh(ngmesh) if second else Mesh(ngmesh).Curve(2)
    problem = press(
        change=lambda _: mesh, push=(0, -0.05), mesh_flags={}, finite=True, friction=0.3
    )
    wider = IfPos(y + 1e-9, 1, 0) * CF((x, y))
    shape = Shape(mesh, GridFunctionOf(mesh, wider) if not second else CF((x * y, 0.2 * x * x)))
    s = Sensitivity(solve(problem), problem.contact.Force)
    found = s.By(shape)
    moved = Moved(shape, problem.contact)
    close(found, differences(moved, lambda: solve(problem) and problem.contact.Force(), 1e-5))


def GridFunctionOf(mesh, field):
    gf = GridFunction(VectorH1(mesh, order=1))
    gf.Set(field)
    return gf


def test_functionals_that_know_the_shape():
    problem = press()
    shape = Shape(problem.mesh, CF((x, 0)))
    u = problem.X.TrialFunction()[0]
    solver = solve(problem)
    area = Integrate(1, problem.mesh)
    close(Sensitivity(solver, lambda: Integrate(1, problem.mesh)).By(shape), area, 1e-9)
    rigid = Sensitivity(solver, (1 + 0 * u[0] ** 2) * dx)
    close(rigid.By(shape), area, 1e-9)
    weight = Parameter(2.0)  # of which the functional alone knows
    squares = Sensitivity(solver, weight * u[1] ** 2 * dx)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        close(squares.By(weight), squares.value / 2, 1e-9)


def test_what_is_at_the_verge_is_said():
    lift, place = Parameter(0.0), Parameter(10.0)
    problem = mixed_press(offset=IfPos((x - place) ** 2 - 0.05**2, 0.0, -lift))
    solver = solve(problem)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        Sensitivity(solver, problem.contact.Force)
    table = problem.contact.Table()
    (number,) = np.flatnonzero(table["status"] == 0)
    place.Set(table["x"][number, 0])
    lift.Set(1e-4)
    solve(problem)
    part = -problem.contact.form.Table()["offset"][number] / lift.Get()
    lift.Set(table["gap"][number] / part)  # so that it just touches
    solver = solve(problem)
    assert abs(problem.contact.Table()["gap"][number]) < 1e-12
    with pytest.warns(ContactWarning, match="1 macro-elements are at the verge"):
        Sensitivity(solver, problem.contact.Force)


def unchanged(problem, solver):
    """All that analyses must leave alone."""
    contact = problem.contact
    return (
        problem.gf.vec.FV().NumPy().copy(),
        {name: value.copy() for name, value in contact.Table().items()},
        contact.State(),
        problem.mesh.ngmesh.Coordinates().copy(),
        np.array([problem.load.Get(), contact.dt.Get(), MU.Get()]),
        contact.pressure.vec.FV().NumPy().copy(),
        contact.Force(),
        solver.State()["residual"],
    )


def alike(one, other):
    if isinstance(one, dict):
        return one.keys() == other.keys() and all(alike(one[k], other[k]) for k in one)
    return np.array_equal(one, other, equal_nan=np.asarray(one).dtype.kind == "f")


@pytest.mark.parametrize("finite", [False, True])
def test_nothing_changes_not_even_by_errors(finite):
    problem = mixed_press(friction=MU, finite=finite, nonlinear=finite)
    solver = solve(problem)
    before, form = unchanged(problem, solver), problem.contact.form
    calls = []

    def Interrupted():
        calls.append(1)
        if len(calls) > 2:
            raise KeyboardInterrupt
        return 1.0

    s = Sensitivity(solver, problem.contact.Force)
    shape = Shape(problem.mesh, velocity(2))
    for variable in (MU, problem.load, shape):
        s.By(variable)
    t = Sensitivity(solver, Interrupted)
    with pytest.raises(KeyboardInterrupt):
        t.By(shape)
    assert problem.contact.form is form
    assert all(map(alike, before, unchanged(problem, solver)))
    again = solver.Solve(printing=False, tol=TOL)
    assert again.number <= 2
    assert np.allclose(before[0], problem.gf.vec.FV().NumPy(), rtol=0, atol=1e-13)


@pytest.mark.parametrize("finite", [False, True])
def test_units_and_frames_do_not_matter(finite):
    mu = Parameter(0.15)

    def Relative(unit=1.0, angle=0.0, shift=0.0):
        turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])

        def Move(mesh):
            points = mesh.ngmesh.Coordinates()
            points[:] = points @ turn.T + shift
            return mesh

        push = tuple((turn @ (0.02, -0.02)).tolist())
        law = {"friction": mu, "finite": finite, "bulk": scaled(CF(unit))}
        problem = press(change=Move, push=push, spring=1000.0 * unit, **law)
        s = Sensitivity(solve(problem), lambda: problem.contact.Force() @ turn)
        field = Shape(problem.mesh, CF((x - shift, y - shift)))
        return np.array([s.By(mu), s.By(field)]) / np.linalg.norm(s.value)

    expected = Relative()
    for unit in (1e-6, 1e6):
        close(Relative(unit), expected, 1e-7)
    close(Relative(angle=0.5, shift=7.0), expected, 1e-7)


@pytest.mark.parametrize("finite", [False, True])
def test_a_history_of_earlier_solves_is_kept(finite):
    problem = press(friction=MU, finite=finite, nonlinear=finite)

    def Second():
        problem.contact.Update()
        problem.gf.vec[:] = 0
        with_mu, solver = MU.Get(), problem.solver()
        MU.Set(0.15)
        for load, mu in ((0.5, 0.15), (1.0, with_mu)):
            MU.Set(mu)
            problem.load.Set(load)
            solver.Solve(printing=False, tol=TOL)
            if load < 1:
                problem.contact.Commit(problem.gf)
        return solver

    s = Sensitivity(Second(), problem.contact.Force)
    found = s.By(MU)
    close(found, differences(MU, lambda: Second() and problem.contact.Force(), 1e-5))
    s = Sensitivity(Second(), problem.contact.Force)
    with pytest.raises(ValueError, match="before the first step"):
        s.By(Shape(problem.mesh, velocity(2)))


def test_bad_input_is_refused():
    problem = press(friction=MU)
    solver = problem.solver()
    with pytest.raises(ValueError, match="not solved anything"):
        Sensitivity(solver, problem.contact.Force)
    solver.Solve(printing=False)
    u = problem.X.TrialFunction()[0]
    with pytest.raises(TypeError, match="solver"):
        Sensitivity(problem.gf, problem.contact.Force)
    with pytest.raises(TypeError, match="functional"):
        Sensitivity(solver, u[0])
    with pytest.raises(ValueError, match="NaN"):
        Sensitivity(solver, lambda: float("nan"))
    with pytest.raises(TypeError, match="functional"):
        Sensitivity(solver, lambda: problem.gf)
    for field in (problem.gf.components[0][1], problem.contact.pressure):
        with pytest.raises(ValueError, match="TrialFunction"):
            Sensitivity(solver, (field + 0 * u[0]) * ds("slave"))
    s = Sensitivity(solver, u[0] ** 2 * dx)
    with pytest.raises(TypeError, match="variable"):
        s.By(1.0)
    for field in (problem.gf, problem.gf.components[0], problem.contact.traction):
        with pytest.raises(ValueError, match="result"):
            s.By(field)
    with pytest.raises(TypeError, match="a list of variables"):
        s.Gradient(MU)
    with pytest.raises(ValueError, match="another mesh"):
        s.By(Shape(press().mesh, velocity(2)))
    with pytest.warns(ContactWarning, match="hardly changes"):
        assert s.By(Parameter(3.0)) == 0
    problem.load.Set(1.1)
    with pytest.raises(ValueError, match="changed since"):
        s.By(MU)
    with pytest.raises(ValueError, match="not in equilibrium"):
        Sensitivity(solver, u[0] ** 2 * dx)
    condensed = press(condense=True)
    with pytest.raises(ValueError, match="condense"):
        Sensitivity(solve(condensed), condensed.contact.Force)


def test_shapes_are_checked():
    mesh = press().mesh
    with pytest.raises(TypeError, match="mesh"):
        Shape(3, velocity(2))
    with pytest.raises(ValueError, match="velocity"):
        Shape(mesh, CF((x, y, 0)))
    with pytest.raises(ValueError, match="zero"):
        Shape(mesh, CF((0, 0)))
    with pytest.raises(ValueError, match="NaN"):
        Shape(mesh, CF((sqrt(x - 100), 0)))
    shape = Shape(mesh, (x, y))
    with pytest.raises(ValueError, match="way"):
        shape.Move(np.inf)


@pytest.mark.parametrize("kinds", [("hex", "prism"), ("tet", "hex")])
def test_points_move_as_the_field_says(kinds):
    mesh = press(dim=3, kinds=kinds).mesh
    shape, points = Shape(mesh, velocity(3)), mesh.ngmesh.Coordinates()
    a, _, c = points.T
    close(shape.velocity, np.stack([0.1 * a, 0.1 * c, 0.3 * c + 0.2 * a], axis=1), 1e-12)


def test_of_heat_through_contact():
    film = Parameter(1.0)
    problem = press(flow=lambda z, T: (1 + film * z.pressure) * (z.Slave(T) - z.Master(T)))
    T, contact = problem.X.TrialFunction()[1], problem.contact
    solver = solve(problem)
    integral, flow = Sensitivity(solver, T * ds("slave")), Sensitivity(solver, contact.Flow)
    shape = Shape(problem.mesh, velocity(2))

    def Look():
        solve(problem)
        temperature = Integrate(problem.gf.components[1] * ds("slave"), problem.mesh)
        return [*contact.Flow(), temperature]

    for variable, varied in ((film, film), (shape, Moved(shape, contact))):
        found = [*flow.By(variable), integral.By(variable)]
        close(found, differences(varied, Look, 1e-4))


def test_of_a_tool_that_a_force_drives():
    mesh = Mesh(OCCGeometry(Named(Rectangle(2, 1).Face()), dim=2).GenerateMesh(maxh=0.2))
    V = VectorH1(mesh, order=2, dirichlet="bottom")
    X = V * LACSpace(V, slave="slave") * NumberSpace(mesh)
    (u, lam, down), (v, _, _) = X.TnT()
    force, radius = Parameter(1.0), Parameter(1.0)
    a = BilinearForm(InnerProduct(stress(u), Sym(Grad(v))) * dx)
    shape = tools.SignedDistance(sqrt((x - 1) ** 2 + (y - 1 - radius) ** 2) - radius, dim=2)
    tool = shape.Driven(travel=(None, down), force=(0, -force))
    contact, gf = LACContact(u, lam, obstacle=tool, finite=True), GridFunction(X)

    def Solve():
        gf.vec[:] = 0
        solver = ContactSolver(a, gf, contact)
        solver.Solve(printing=False, tol=TOL)
        return solver

    def Look():
        return [gf.components[2].vec[0], *contact.Table()["pressure"]]

    s = Sensitivity(Solve(), Look)
    for variable in (force, radius):
        close(s.By(variable), differences(variable, lambda: Solve() and Look(), 1e-5))
        Solve()


def test_of_two_contacts_one_above_the_other():
    def Block(k, below, above):
        block = Rectangle(1.23 - 0.2 * k, 0.4).Face().Move((0.1 * k, 0.4 * k, 0))
        block.edges.name = "free"
        block.edges.Min(Y).name, block.edges.Max(Y).name = below, above
        return block

    names = ("bottom", "m1"), ("s1", "m2"), ("s2", "top")
    stack = Compound([Block(k, *pair) for k, pair in enumerate(names)])
    mesh, mu = Mesh(OCCGeometry(stack, dim=2).GenerateMesh(maxh=0.2)), Parameter(0.2)
    V = VectorH1(mesh, order=2, dirichlet="bottom|top")
    X = V * LACSpace(V, slave="s1") * LACSpace(V, slave="s2")
    (u, one, two), (v, _, _) = X.TnT()
    a, gf = BilinearForm(InnerProduct(stress(u), Sym(Grad(v))) * dx), GridFunction(X)
    contacts = [
        LACContact(u, one, master="m1", friction=mu, offset=-0.01),
        LACContact(u, two, master="m2", friction=0.5 * mu, finite=True),
    ]

    def Solve():
        gf.vec[:] = 0
        gf.components[0].Set((0.02, -0.02), definedon=mesh.Boundaries("top"))
        for contact in contacts:
            contact.Update()
        solver = ContactSolver(a, gf, contacts)
        solver.Solve(printing=False, tol=TOL)
        return solver

    def Look():
        return np.concatenate([contact.Force() for contact in contacts])

    s, shape = Sensitivity(Solve(), Look), Shape(mesh, velocity(2))
    close(s.By(mu), differences(mu, lambda: Solve() and Look(), 1e-5))
    moved, found = Moved(shape, contacts[0]), s.By(shape)
    close(found, differences(moved, lambda: Solve() and Look(), 1e-4))
