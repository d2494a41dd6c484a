"""Wrong input to LACContact and the mesh tools in 2D and 3D: errors that say what and where."""

from contextlib import nullcontext
from itertools import count, repeat

import pytest
from netgen.occ import Box, Glue, MoveTo, OCCGeometry, Rectangle, Y, Z
from netgen.occ import Pnt as Point
from ngsolve import (
    CF,
    H1,
    BilinearForm,
    Grad,
    GridFunction,
    InnerProduct,
    Mesh,
    Parameter,
    TaskManager,
    VectorH1,
    dx,
    sqrt,
    x,
)

from ngslac import ContactSolver, LACContact, LACSpace, SplitSlaveFaces, TimeStepper
from ngslac.meshes import TwoBlocks, TwoBlocks3D

NAN, INF = float("nan"), float("inf")
MESHES = {2: lambda: TwoBlocks(0.34, structured=True), 3: lambda: TwoBlocks3D("hex", "tet", 3, 2)}


@pytest.fixture(scope="module", params=[2, 3])
def X(request):
    return product(MESHES[request.param]())


def product(mesh, slave="slave", **flags):
    V = VectorH1(mesh, order=2, dirichlet="bottom|top")
    return V * LACSpace(V, slave=slave, **flags)


def contact(X, **flags):
    u, lam = X.TrialFunction()
    return LACContact(u, lam, **({"master": "master"} | flags))


def made(**flags):
    return lambda X: contact(X, **flags)


def paired(at=None, **flags):
    return lambda X: contact(X, **flags).Update(at and at(X))


def after(use):
    """Of a paired contact."""

    def call(X):
        c = contact(X)
        c.Update()
        use(c, X)

    return call


def space(slave):
    return lambda X: LACSpace(X.components[0], slave=slave(X) if callable(slave) else slave)


def of_master(region):
    return lambda X: contact(X, master=region(X))


def lifted(X, by=0.2):
    gf, dim = GridFunction(X), X.mesh.dim
    up, rest = CF((0,) * (dim - 1) + (by,)), CF((0,) * dim)
    gf.components[0].Set(X.mesh.MaterialCF({"upper": up}, default=rest))
    return gf


def filled(value):
    def fill(X):
        gf = GridFunction(X)
        gf.components[0].vec.FV().NumPy()[:] = value
        return gf

    return fill


def other(X):
    return GridFunction(VectorH1(X.mesh, order=2))


def on(components):
    """A contact whose u and lam are of the space or of its test functions, by what is asked."""
    return lambda X: LACContact(*components(X), master="master")


NOWHERE = "matches no boundary face; the boundaries are: .*top"
PATTERN = "master = .* must be a pattern of boundary names"
EITHER = "either master= or obstacle=, not both and not none"
NOTRIAL = "trial function"
PRODUCTS = "u and lam belong to different product spaces"
REFUSED = [
    # regions
    *((space(s), Exception, f"slave='{s}' {NOWHERE}") for s in ("nowhere", "", "Slave")),
    (space(lambda X: X.mesh.Boundaries("nowhere")), Exception, "slave=Region matches no boundary"),
    (space(lambda X: X.mesh.Materials("upper")), Exception, "must be a boundary region"),
    (space(lambda X: X.mesh.BBoundaries(".*")), Exception, "must be a boundary region"),
    (space(lambda X: MESHES[X.mesh.dim]().Boundaries("slave")), Exception, "another mesh"),
    (lambda X: SplitSlaveFaces(X.mesh, "nowhere"), ValueError, f"slave='nowhere' {NOWHERE}"),
    (made(master="nowhere"), ValueError, f"master='nowhere' {NOWHERE}"),
    (of_master(lambda X: X.mesh.Boundaries("nowhere")), ValueError, "matches no boundary face"),
    (of_master(lambda X: X.mesh.Materials("lower")), TypeError, PATTERN),
    (of_master(lambda X: X.mesh.BBoundaries(".*")), TypeError, "boundary region"),
    (made(master=3), TypeError, PATTERN),
    (of_master(lambda X: MESHES[X.mesh.dim]().Boundaries("master")), Exception, "another mesh"),
    (made(master="slave|master"), ValueError, "boundaries slave are both slave and master"),
    (paired(master="bottom", maxdist=0.1), Exception, "slave and master never meet.*maxdist"),
    (paired(master="left_lower", maxdist=0.1), Exception, "never meet"),  # at right angles
    (paired(master="left_upper", maxdist=0.1), Exception, "never meet"),
    (paired(lifted, maxdist=0.19), Exception, "never meet: .*within maxdist = 0.19"),
    # coefficients
    *(
        (made(**{name: value}), ValueError, f"{name} = {value} must be a finite number >= 0")
        for name in ("friction", "tresca")
        for value in (-0.1, NAN, INF)
    ),
    *(
        (made(**{name: value}), ValueError, f"{name} = {value} must be a positive length")
        for name in ("maxdist", "penetration")
        for value in (0, -1.0, NAN, INF)
    ),
    *(
        (made(stiffness=value), ValueError, f"stiffness = {value} must be a positive factor")
        for value in (0, -1.0, NAN)
    ),
    *(
        (made(stiffness=value), ValueError, "stiffness = .* must be a positive factor from 1e-06")
        for value in (1e-300, 9e-7, 1.1e6, 1e300)
    ),
    (paired(master=None, obstacle=sqrt(x - 0.5)), Exception, r"gap to the obstacle is -?nan at \("),
    (made(obstacle=CF(0.1)), ValueError, EITHER),
    (made(master=None), ValueError, EITHER),
    *(
        (made(tied=True, **law), ValueError, "tied surfaces do not slide: drop friction and tresca")
        for law in ({"friction": 0.3}, {"tresca": 0.3})
    ),
    # fields
    (
        on(lambda X: (X.components[0] * VectorH1(X.mesh, order=1)).TrialFunction()),
        Exception,
        "lam must belong to a LACSpace, not to VectorH1",
    ),
    (
        lambda X: contact(product(X.mesh, components=1)),
        Exception,
        "need (2|3) components each",
    ),
    (on(lambda X: (X.TestFunction()[0], X.TrialFunction()[1])), Exception, "u .*must be a trial"),
    (on(lambda X: (X.TrialFunction()[0], X.TestFunction()[1])), Exception, "lam .*must be a trial"),
    (on(lambda X: (2 * X.TrialFunction()[0], X.TrialFunction()[1])), Exception, NOTRIAL),
    (on(lambda X: (GridFunction(X).components[0], X.TrialFunction()[1])), Exception, NOTRIAL),
    (
        on(lambda X: (X.TrialFunction()[0], product(X.mesh).TrialFunction()[1])),
        Exception,
        PRODUCTS,
    ),
    (on(lambda X: (other(X).space.TrialFunction(), X.TrialFunction()[1])), Exception, PRODUCTS),
    # states
    *(
        (paired(filled(value)), Exception, "configuration to pair in holds NaN or infinite coord")
        for value in (NAN, INF)
    ),
    (paired(other), Exception, "gf lives on another space than u and lam"),
    (after(lambda c, X: c.Evaluate(other(X))), Exception, "gf lives on another.* in place of"),
    (
        after(lambda c, X: c.Apply(GridFunction(X).vec, GridFunction(X).vec)),
        Exception,
        "the scale c is not set; call SetStiffness",
    ),
    *(
        (lambda X, use=use: use(contact(X), GridFunction(X)), Exception, r"no pairing yet; call Up")
        for use in (
            lambda c, gf: c.Apply(gf.vec, gf.vec.CreateVector()),
            lambda c, gf: c.AssembleLinearization(gf.vec),
            lambda c, gf: c.Evaluate(gf),
            lambda c, gf: c.Commit(gf),
            lambda c, gf: c.Table(),
            lambda c, gf: c.Force(),
            lambda c, gf: c.Moment((0,) * gf.space.mesh.dim),
        )
    ),
]


@pytest.mark.parametrize(("call", "error", "message"), REFUSED)
def test_refused(X, call, error, message):
    with pytest.raises(error, match=message):
        call(X)


def test_a_gap_within_maxdist_is_paired(X):
    contact(X, maxdist=0.21).Update(lifted(X))


@pytest.mark.parametrize("threads", [nullcontext, TaskManager])
@pytest.mark.parametrize(
    ("value", "text"), [(0.5 - x, "-0"), (sqrt(x - 0.5), "nan"), (Parameter(-0.1), "-0.1")]
)
def test_wrong_functions(X, value, text, threads):
    """Found where they are wrong: position and boundary are named."""
    point = ", ".join([r"[^,)]+"] * X.mesh.dim)
    expected = rf"friction is -?{text}.* at \({point}\) on boundary 'slave'; it must be a number >="
    with pytest.raises(Exception, match=expected), threads():
        contact(X, friction=value).Update()


def test_a_parameter_that_becomes_negative(X):
    parameter = Parameter(0.3)
    c = contact(X, friction=parameter)
    c.Update()
    c.form.SetConstant(1.0)
    gf = GridFunction(X)
    residual = gf.vec.CreateVector()
    c.Apply(gf.vec, residual)
    parameter.Set(-0.3)
    with pytest.raises(Exception, match=r"friction is -0\.3"):
        c.Apply(gf.vec, residual)


def glued(dim):
    """Bodies that share nodes have no surfaces that could separate."""
    if dim == 2:
        shape = Glue([MoveTo(0, -1).Rectangle(1, 1).Face(), Rectangle(1, 1).Face()])
        shape.edges.name = "outside"
        shape.edges.Sorted(Y)[len(shape.edges) // 2].name = "interface"
    else:
        lower, upper = Box(Point(0, 0, -1), Point(1, 1, 0)), Box(Point(0, 0, 0), Point(1, 1, 1))
        lower.faces.name = upper.faces.name = "outside"
        upper.faces.Min(Z).name = lower.faces.Max(Z).name = "interface"
        shape = Glue([lower, upper])
    return Mesh(OCCGeometry(shape, dim=dim).GenerateMesh(maxh=0.6))


@pytest.mark.parametrize("dim", [2, 3])
def test_glued_bodies(dim):
    X = product(glued(dim), slave="interface")
    with pytest.raises(Exception, match=r"'interface' has material on both sides.*share no nodes"):
        contact(X, master="outside").Update()


def test_each_body_with_a_space_of_its_own():
    """The master would count as a body at rest, and nothing would tell."""
    mesh = TwoBlocks(0.5)
    upper = VectorH1(mesh, order=2, definedon="upper")
    lower = VectorH1(mesh, order=2, definedon="lower", dirichlet="bottom")
    Q = LACSpace(upper, slave="slave")
    u, *_, lam = (upper * lower * Q).TrialFunction()
    with pytest.raises(ValueError, match="master = 'master' has no degrees of freedom of u"):
        LACContact(u[0] if isinstance(u, (list, tuple)) else u, lam, master="master")


@pytest.mark.parametrize("finite", [False, True])
def test_a_master_without_unknowns_is_a_rigid_body(finite):
    mesh = TwoBlocks(0.5)
    V = VectorH1(mesh, order=2, definedon="upper")
    X = V * H1(mesh) * LACSpace(V, slave="slave")  # a temperature is no displacement
    u, _, lam = X.TrialFunction()
    LACContact(u, lam, master="master", finite=finite).Update()


# --- functions without values, iterables without an end, spaces that were refined ----------------


class Problem:
    def __init__(self):
        self.mesh = TwoBlocks(0.5, overhang=0.2, aligned=False, structured=True)
        self.X = product(self.mesh)
        self.V, self.Q = self.X.components
        (self.u, self.lam), (self.v, _) = self.X.TnT()
        self.a = BilinearForm(InnerProduct(Grad(self.u), Grad(self.v)) * dx)
        self.gf, self.contact = GridFunction(self.X), contact(self.X)

    def solver(self, contacts=None):
        return ContactSolver(self.a, self.gf, contacts or self.contact)


def step(p, *, density=1, **flags):
    return TimeStepper(p.solver(), density, dt=0.1, **flags)


VALUES = "holds a trial or test function"
USES = [
    (lambda p: contact(p.X, friction=0.1 + p.u[1] * x), ValueError, f"^friction.* {VALUES}"),
    (lambda p: contact(p.X, tresca=p.lam[0]), ValueError, f"^tresca.* {VALUES}"),
    (lambda p: contact(p.X, master=None, obstacle=p.v[1]), ValueError, f"^obstacle.* {VALUES}"),
    (lambda p: p.contact.Draw(background=p.u, show=False), ValueError, f"^background.* {VALUES}"),
    (
        lambda p: p.contact.Draw(deformation=2 * p.v, show=False),
        ValueError,
        f"^deformation.* {VALUES}",
    ),
    (
        lambda p: p.contact.WriteVTU("none", displacement=p.u),
        ValueError,
        f"^displacement.* {VALUES}",
    ),
    (lambda p: step(p, density=1 + p.u[1]), ValueError, f"^density.* {VALUES}"),
    (lambda p: step(p, prescribe={"top": p.u}), ValueError, f"^prescribe.* {VALUES}"),
    (
        lambda p: LACSpace(p.V, slave="slave", macros=repeat(0)),
        ValueError,
        r"macros = repeat\(0\) has more entries",
    ),
    (
        lambda p: LACSpace(p.V, slave="slave", macros=p.mesh),
        TypeError,
        "macros = .*Mesh.* must be a list of integers",
    ),
    (
        lambda p: p.solver(repeat(p.contact)),
        ValueError,
        "contacts: two contacts share one lam",
    ),
    (lambda p: p.solver(count()), TypeError, "contacts = 0 must be a LACContact"),
]


@pytest.mark.parametrize(("use", "error", "message"), USES)
def test_refused_of_a_problem(use, error, message):
    with pytest.raises(error, match=message):
        use(Problem())


def test_a_refined_space_needs_a_new_solver():
    problem = Problem()
    solver = problem.solver()
    problem.mesh.Refine()
    for space in (problem.V, problem.Q, problem.X, problem.gf):
        space.Update()
    with pytest.raises(ValueError, match="the space was refined: make a new ContactSolver"):
        TimeStepper(solver, 1.0, dt=0.1)
