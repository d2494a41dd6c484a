"""Bodies pressed by rigid tools: on paths, by forces and moments; against meshed tools."""

import numpy as np
import pytest
from bricks import brick
from netgen.meshing import NgException
from netgen.occ import Circle, Compound, OCCGeometry, Rectangle
from ngsolve import (
    CF,
    BilinearForm,
    Grad,
    GridFunction,
    Id,
    InnerProduct,
    Mesh,
    NumberSpace,
    Parameter,
    Variation,
    VectorH1,
    ds,
    dx,
)
from posed import posed
from press import linear

from ngslac import (
    ContactConvergenceError,
    ContactSolver,
    LACContact,
    LACSpace,
    LoadState,
    LoadStepper,
    SaveState,
    tools,
)
from ngslac.materials import NeoHooke

UP = {2: (0, 1), 3: (0, 0, 1)}


class Pressed:
    """A block, its far side held, over a tool; `make(load, *numbers)` returns the tool."""

    def __init__(self, dim, make, *, numbers=0, n=None, bulk=None, **law):
        mesh = brick("trig" if dim == 2 else "tet", n or {2: 8, 3: 4}[dim])
        V = VectorH1(mesh, order=2, dirichlet="top")
        X = V * LACSpace(V, slave="bottom")
        for _ in range(numbers):
            X = X * NumberSpace(mesh)
        (u, lam, *unknowns), (v, *_) = X.TnT()
        self.load, self.gf, self.mesh = Parameter(0), GridFunction(X), mesh
        a = BilinearForm(X)
        a += bulk(u, v) if bulk else Variation(NeoHooke(Id(dim) + Grad(u), 100, 0.3).Compile() * dx)
        tool = make(self.load, *unknowns)
        self.contact = LACContact(u, lam, obstacle=tool, finite=True, **law)
        self.solver = ContactSolver(a, self.gf, self.contact)
        self.stepper = LoadStepper(self.solver, self.load)

    def run(self, steps=2):
        return self.stepper.Integrate(steps=steps, printing=False)

    def travel(self):
        return [gf.vec[0] for gf in self.gf.components[2:]]


def ball(dim, gap=0.0, radius=1.0):
    return tools.Sphere((0.5,) * (dim - 1) + (-radius - gap,), radius)


@pytest.mark.parametrize("dim", [2, 3])
def test_constant_stress_on_a_plane(dim):
    """As on an obstacle of small sliding: constant pressure, to rounding."""
    mesh = brick("trig", 8, 8) if dim == 2 else brick("hex", 4)
    sides = {"dirichletx": "left|right"} | ({"dirichlety": "front|back"} if dim == 3 else {})
    V = VectorH1(mesh, order=2, **sides)
    plane = tools.Plane((0,) * (dim - 1) + (-0.01,), UP[dim])

    def bulk(u, v, load):
        return linear(u, v) + InnerProduct(CF(UP[dim]), v) * ds("top")

    problem = posed(V, bulk, slave="bottom", obstacle=plane, finite=True)
    problem.solver().Solve(printing=False)
    assert problem.contact.Table()["pressure"] == pytest.approx(1, rel=1e-10)
    assert problem.contact.Table()["gap"] == pytest.approx(0, abs=1e-12)


def test_newton_is_quadratic():
    """The last residuals of a step with friction."""
    case = Pressed(2, lambda t: ball(2).Moved(shift=(0.02 * t, 0.05 * t)), friction=0.3)
    case.run(1)
    last = [entry.equilibrium for entry in case.solver.history[-3:]]
    assert last[1] < 30 * last[0] ** 1.8
    assert last[2] < 30 * last[1] ** 1.8 or last[2] < 1e-13


def meshed_disc(h):
    """The force on a block from a half disc that is a mesh, and from one that is a function."""
    block = Rectangle(1, 0.5).Face().Move((-0.5, 0, 0))
    disc = Circle((0, -1), 1).Face() - Rectangle(4, 2).Face().Move((-2, -2.7, 0))
    block.faces.name, disc.faces.name = "block", "disc"
    for edge in block.edges:
        edge.name = {0.0: "slave", 0.5: "top"}.get(round(edge.center.y, 6), "side")
    for edge in disc.edges:
        edge.name = "master" if edge.center.y > -0.65 else "back"
    block.faces.maxh, disc.faces.maxh = h, 0.7 * h
    mesh = Mesh(OCCGeometry(Compound([block, disc]), dim=2).GenerateMesh()).Curve(3)
    V = VectorH1(mesh, order=2, dirichlet="top", definedon="block")
    X = V * LACSpace(V, slave="slave")
    u, lam = X.TrialFunction()
    forces = []
    for side in ({"master": "master"}, {"obstacle": tools.Sphere((0, -1), 1)}):
        a, gf, load = BilinearForm(X), GridFunction(X), Parameter(0)
        energy = NeoHooke(Id(2) + Grad(u), 100, 0.3).Compile()
        a += Variation(energy * dx("block"))
        contact = LACContact(u, lam, friction=0.3, finite=True, **side)
        way = {"top": CF((0.05 * load, -0.05 * load))}
        stepper = LoadStepper(ContactSolver(a, gf, contact), load, prescribe=way)
        stepper.Integrate(steps=4, printing=False)
        forces.append(contact.Force())
    return np.array(forces)


def test_a_function_presses_as_a_mesh_does():
    """The same force to the error of discretisation, which is that of finer meshes, too."""
    coarse, fine = meshed_disc(0.1), meshed_disc(0.05)
    size, step = np.linalg.norm(fine[1]), np.linalg.norm(fine[1] - coarse[1])
    assert step < 0.05 * size
    assert np.linalg.norm(fine[0] - fine[1]) < 0.1 * step


def test_facets_press_as_the_ball_does():
    forces = []
    disc = Circle((0.5, -1), 1).Face()
    curved = Mesh(OCCGeometry(disc, dim=2).GenerateMesh(maxh=0.3)).Curve(4)
    for tool in (ball(2), tools.FromMesh(curved, divisions=30)):
        case = Pressed(2, lambda t, tool=tool: tool.Moved(shift=(0.02 * t, 0.05 * t)), friction=0.3)
        case.run()
        forces.append(case.contact.Force())
    assert forces[1] == pytest.approx(forces[0], rel=5e-3)


@pytest.mark.parametrize("gap", [0.0, 0.1, 0.6])
@pytest.mark.parametrize("dim", [2, 3])
def test_a_force_presses_a_tool_that_is_away(dim, gap):
    """The travel is an unknown: the balance holds, and the path is the same one."""
    travel = [None] * dim

    def make(load, number):
        travel[-1] = number
        force = (0,) * (dim - 1) + (4 * load,)
        return ball(dim, gap).Driven(travel=travel, force=force)

    driven = Pressed(dim, make, numbers=1, friction=0.2)
    driven.run(1)
    force, (way,) = driven.contact.Force(), driven.travel()
    assert force[-1] == pytest.approx(4, rel=1e-9)
    led = Pressed(
        dim, lambda t: ball(dim, gap).Moved(shift=(0,) * (dim - 1) + (way * t,)), friction=0.2
    )
    led.run(1)
    assert led.contact.Force()[-1] == pytest.approx(4, rel=1e-3)  # on another way of the slip


@pytest.mark.parametrize("dim", [2, 3])
def test_a_tool_comes_nearer_in_steps_before_it_touches(dim):
    """Without any force there is nothing but rounding errors of the bulk, once it is nonlinear."""
    up = np.array(UP[dim])
    case = Pressed(dim, lambda t: ball(dim, gap=0.1).Moved(shift=tuple(0.2 * t * k for k in up)))
    steps = case.run(4)
    assert steps[0].iterations <= 2
    assert steps[1].iterations == 0
    assert case.contact.Force()[-1] > 1


def test_all_of_the_travel_follows_from_forces():
    def make(load, *numbers):
        return ball(3).Driven(travel=numbers, force=(0.1 * load, 0, 3 * load))

    case = Pressed(3, make, numbers=3, friction=0.5)
    case.run()
    assert case.contact.Force() == pytest.approx([0.1, 0, 3], abs=1e-8)
    assert case.travel()[0] > 1e-4


@pytest.mark.parametrize("dim", [2, 3])
def test_a_moment_turns_a_roll_that_a_force_presses(dim):
    center = (0.5,) * (dim - 1) + (-1.0,)

    def make(load, way, angle):
        given = {"center": center, "axis": (0, 1, 0) if dim == 3 else None}
        force = (0,) * (dim - 1) + (3 * load,)
        travel = (None,) * (dim - 1) + (way,)
        return ball(dim).Driven(travel=travel, force=force, turn=angle, moment=0.02 * load, **given)

    case = Pressed(dim, make, numbers=2, friction=0.3)
    case.run(3)
    way, angle = case.travel()
    now = np.array(center) + np.array(UP[dim]) * way
    moment = np.atleast_1d(case.contact.Moment(now))[0 if dim == 2 else 1]
    assert moment == pytest.approx(0.02, rel=1e-8)
    assert case.contact.Force()[-1] == pytest.approx(3, rel=1e-9)
    assert 1e-4 < angle < 0.05


def test_a_driven_tool_belongs_to_one_contact():
    mesh = brick("trig", 4)
    V = VectorH1(mesh, order=2, dirichlet="left")
    X = V * LACSpace(V, slave="bottom") * LACSpace(V, slave="top") * NumberSpace(mesh)
    u, *lams, number = X.TrialFunction()
    tool = ball(2).Driven(travel=(None, number), force=(0, 1))
    contacts = [LACContact(u, lam, obstacle=tool, finite=True) for lam in lams]
    with pytest.raises(ValueError, match="would count twice"):
        ContactSolver(BilinearForm(X), GridFunction(X), contacts)


def test_two_motions_of_a_tool_are_two_unknowns():
    with pytest.raises(NgException, match="two motions of a tool are one unknown"):
        Pressed(2, lambda t, q: ball(2).Driven(travel=(q, q), force=(0, 1)), numbers=1)


def test_a_tool_that_nothing_pushes_stays_where_it_is():
    def make(load, number):
        return ball(2, gap=0.1).Driven(travel=(None, number))

    case = Pressed(2, make, numbers=1, bulk=linear)
    case.run(1)
    assert case.travel() == [0]
    assert not np.any(case.contact.Force())


def test_a_tool_pulled_away_has_no_equilibrium():
    case = Pressed(
        2, lambda t, q: ball(2, gap=0.1).Driven(travel=(None, q), force=(0, -t)), numbers=1
    )
    with pytest.raises(ContactConvergenceError):
        case.run(1)
    assert not np.any(case.gf.vec.FV().NumPy())


@pytest.mark.parametrize("dim", [2, 3])
def test_a_slave_that_starts_inside_of_the_tool(dim):
    """Deeper than its macro-elements are large (2D)."""
    case = Pressed(dim, lambda t: ball(dim, gap=-0.15), friction=0.2)
    case.run(1)
    table = case.contact.Table()
    assert np.all(table["gap"] > -1e-8)
    assert case.contact.Force()[-1] > 1


@pytest.mark.parametrize(
    "tool",
    [
        tools.Polygon([(-1, -1), (0.5, -1), (0.5, 0), (-1, 0)]),
        tools.Polygon([(0.2, -1), (0.77, -1), (0.77, 0), (0.2, 0)]),
        tools.Polygon([(0.2, -1), (0.8, -1), (0.8, -0.05), (0.2, -0.05)]).Grown(0.05),
        tools.Polygon([(0.5, 0), (-1, -0.3), (2, -0.3)]),
    ],
    ids=["half", "punch", "rounded", "wedge"],
)
@pytest.mark.parametrize("n", [8, 12, 16])
def test_edges_and_corners(tool, n):
    case = Pressed(2, lambda t: tool.Moved(shift=(0, 0.05 * t)), friction=0.1, n=n)
    case.run()
    table = case.contact.Table()
    assert case.contact.Force()[1] > 2
    assert np.isfinite(table["traction"]).all()
    assert np.all(table["gap"][table["area"] > 0] > -1e-9)


def test_a_tool_on_a_path_has_no_limit_load():
    """What fails is the number of iterations allowed, and nothing else is said."""
    punch = tools.Polygon([(0.2, -1), (0.8, -1), (0.8, -0.05), (0.2, -0.05)]).Grown(0.05)
    case = Pressed(2, lambda t: punch.Moved(shift=(0.3 * t, 0.1 * t)), friction=0.3)
    case.stepper.Integrate(0.25, steps=2, printing=False)
    with pytest.raises(ContactConvergenceError, match="no convergence in 2 iterations"):
        case.stepper.Integrate(1.0, steps=1, maxit=2, printing=False)
    assert case.load.Get() == 0.25
    case.stepper.Integrate(0.5, steps=1, printing=False)


def test_a_run_that_goes_on_from_a_file(tmp_path):
    def make(load, number):
        led = ball(2).Moved(shift=(0.02 * load, 0))
        return led.Driven(travel=(None, number), force=(0, 4 * load))

    def build():
        return Pressed(2, make, numbers=1, friction=0.3)

    whole, begun, again = build(), build(), build()
    whole.stepper.Integrate(1.0, steps=4, printing=False)
    begun.stepper.Integrate(0.5, steps=2, printing=False)
    SaveState(tmp_path / "state", begun.stepper)
    LoadState(tmp_path / "state", again.stepper)
    again.stepper.Integrate(1.0, steps=2, printing=False)
    assert again.contact.Force() == pytest.approx(whole.contact.Force(), rel=1e-8)
    assert again.travel() == pytest.approx(whole.travel(), rel=1e-8)


def test_a_sheet_between_round_tools_starts_where_they_touch():
    """What is as near as 5 % of a macro-element but open on both sides would tear the sheet."""
    mesh = brick("quad", 10)
    V = VectorH1(mesh, order=2, dirichletx="left")
    X = V * LACSpace(V, slave="bottom") * LACSpace(V, slave="top") * NumberSpace(mesh)
    u, below, above, travel = X.TrialFunction()
    a, load, round_ = BilinearForm(X), Parameter(0), 0.4
    a += Variation(NeoHooke(Id(2) + Grad(u), 100, 0.3).Compile() * dx)
    left, right = -4.0, 0.25  # from the middle of the third face on the tools are round
    die = tools.Polygon([(left, -4), (right, -4), (right, -round_), (left, -round_)])
    high = [(left, 1 + round_), (right, 1 + round_), (right, 4), (left, 4)]
    holder = tools.Polygon(high).Grown(round_).Driven(travel=(None, travel), force=(0, -load))
    contacts = [
        LACContact(u, lam, obstacle=tool, finite=True, friction=0.1)
        for lam, tool in ((below, die.Grown(round_)), (above, holder))
    ]
    solver = ContactSolver(a, GridFunction(X), contacts)
    LoadStepper(solver, load).Integrate(steps=1, printing=False)
    first = solver.history[0]
    assert first.stick + first.slip == 4
    assert contacts[0].Force()[1] == pytest.approx(1, rel=1e-9)
