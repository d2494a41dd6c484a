"""Vibrations of contact states against closed forms, dense algebra and time integration."""

import numpy as np
import pytest
import scipy
from motions import on_ground
from netgen.occ import Compound, MoveTo, OCCGeometry, Y
from ngsolve import (
    CF,
    BilinearForm,
    Grad,
    GridFunction,
    Id,
    InnerProduct,
    Mesh,
    Norm,
    NumberSpace,
    Parameter,
    Variation,
    VectorH1,
    dx,
    exp,
)
from ngsolve.meshes import MakeStructured2DMesh
from posed import elastic, posed
from press import mixed_press, press, solved
from resting import any_rotation
from squeal import ACROSS, exact, integrated, slider
from vibrating import LENGTHS, SPEED, bars

from ngslac import (
    AugmentedLagrangianSolver,
    ContactSolver,
    LACContact,
    LACSpace,
    LoadStepper,
    tools,
)
from ngslac.analysis import Modes, Sensitivity, modes, pencil, steadysliding
from ngslac.analysis.tangent import Tangent
from ngslac.errors import ContactWarning
from ngslac.materials import NeoHooke
from ngslac.steps.inertia import Mass

FOOT = 4 / 3  # stiffness of the slider's foot, also along and across


def vibrations(problem, count=2, **options):
    return Modes(problem.solver, density=problem.density, count=count, **options).eigenvalues


def near(found, expected, tol):
    """Each expected number is there."""
    return np.abs(found[:, None] - expected).min(axis=0) <= tol * np.abs(expected)


# --- friction ------------------------------------------------------------------------------------


@pytest.mark.parametrize("mu", [0.3, 0.6, 0.8, 1.0])
@pytest.mark.parametrize("dim", [2, 3])
def test_mode_coupling(dim, mu):
    found = vibrations(slider(mu, dim=dim), dim)
    assert np.all(near(found, 1j * exact(mu), 5e-6))
    if dim == 3:
        assert near(found, np.array([1j * ACROSS**0.5]), 1e-6)


@pytest.mark.parametrize("dim", [2, 3])
def test_neither_frame_nor_units_matter(dim):
    time, expected = 1e-2, vibrations(slider(1.0, dim=dim), dim)
    turned = slider(1.0, dim=dim, turn=any_rotation(dim, 3), units=(1e-3, 1e3, time))
    assert vibrations(turned, dim) * time == pytest.approx(expected, rel=1e-9)


def test_growth_is_that_of_time_integration():
    problem = slider(1.0, n=1, stiff=1e3, light=1e-5)
    found = Modes(problem.solver, density=problem.density, count=1)
    value = integrated(problem, found, dt=0.1)
    assert value.real == pytest.approx(found.growth[0], rel=0.01)
    assert value.imag == pytest.approx(2 * np.pi * found.frequencies[0], rel=0.002)


def test_speed_resists_across_the_sliding():
    problem = slider(0.3, dim=3)
    for speed in (1e-3, 0.1):
        damper = 0.3 * problem.pressing / speed  # in series with the foot
        cubic = np.polymul([1, 0, ACROSS + FOOT], [damper, FOOT]) - np.array([0, 0, 0, FOOT**2])
        expected = np.roots(cubic)
        expected = expected[expected.imag > 0]
        for given in (speed, CF(speed)):
            found = vibrations(problem, 4, speed=given)
            assert near(found, expected, 1e-5)
            assert np.all(near(found, 1j * exact(0.3), 5e-6))


@pytest.mark.parametrize("slope", [-10.0, 10.0])
def test_friction_that_changes_with_speed(slope):
    mu, problem = 0.3, slider(0.3)
    damper = slope * problem.pressing
    system = np.zeros((5, 5))  # mass (x, y), its velocity, foot
    system[[0, 1], [2, 3]] = 1
    system[2, [0, 1, 4]] = -2 - FOOT, -1, FOOT
    system[3, :2] = -1, -2
    system[4, [0, 1, 4]] = np.array([FOOT, mu * FOOT, -FOOT]) / damper
    expected = np.linalg.eigvals(system)
    assert np.all(near(vibrations(problem, slope=slope), expected[expected.imag > 0], 1e-5))


def test_the_length_of_the_last_step_does_not_matter():
    short, long = (vibrations(slider(0.8, dim=3, way=way), 3) for way in (0.3, 30.0))
    assert short == pytest.approx(long, rel=1e-9)


@pytest.mark.parametrize("dim", [2, 3])
def test_rows_of_what_slips(dim):
    """With small sliding: lam = (mu d - n) p, with the direction d of friction as it is."""
    problem = mixed_press(dim=dim)
    solver = solved(problem)
    found = Modes(solver, density=1, count=3)
    table, tangent = problem.contact.Table(), Tangent(solver)
    matrix = tangent.matrix.toarray()
    dofs = np.asarray(problem.contact.form.MultiplierDofs()).reshape(-1, dim)
    for m in np.flatnonzero(table["status"] == 2):
        n, own = table["normal"][m], dofs[m]
        along = table["traction"][m] + table["pressure"][m] * n
        rows = np.outer(n, n @ matrix[own])
        law = np.outer(n, n) - np.eye(dim) - np.outer(along / table["pressure"][m], n)
        rows[:, own] += law * np.abs(rows).max()
        matrix[own] = rows
    free = np.flatnonzero(tangent.free)
    units = np.outer(*2 * [tangent.scale[free]])
    mass = Mass(problem.a, problem.contact, 1, tangent.free).matrix.entries[free][:, free].toarray()
    inverse = np.linalg.solve(matrix[np.ix_(free, free)] * units, mass * units)
    squares = 1 / np.array(sorted(np.linalg.eigvals(inverse), key=abs)[:-4:-1])
    assert found.eigenvalues == pytest.approx(1j * np.sqrt(squares), rel=1e-8)
    assert len(np.unique(table["status"])) == 3


# --- states --------------------------------------------------------------------------------------


def alike(one, other):
    if isinstance(one, dict):
        return one.keys() == other.keys() and all(alike(one[k], other[k]) for k in one)
    if isinstance(one, list):
        return len(one) == len(other) and all(map(alike, one, other))
    if isinstance(one, np.ndarray):
        return np.array_equal(one, other, equal_nan=one.dtype.kind == "f")
    return one is other or one == other


def everything(solver):
    fields = [
        [getattr(c, n).vec.FV().NumPy().copy() for n in ("slip", "status")] for c in solver.contacts
    ]
    return [solver.State(), [contact.Table() for contact in solver.contacts], fields]


@pytest.mark.parametrize("dim", [2, 3])
@pytest.mark.parametrize("finite", [False, True])
def test_the_state_stays(dim, finite, monkeypatch):
    problem = mixed_press(dim=dim, finite=finite, nonlinear=finite)
    solver = solved(problem)
    first = None
    for commit in (False, True):
        if commit:  # then there is no slip left to tell its direction
            problem.contact.Commit(problem.gf)
        before = everything(solver)
        found = Modes(LoadStepper(solver, problem.load), density=1, count=3)
        assert alike(everything(solver), before)
        assert first is None or found.eigenvalues == pytest.approx(first, rel=1e-9)
        first = found.eigenvalues

    class Interrupted(Tangent):
        def __init__(self, solver):
            super().__init__(solver)
            raise KeyboardInterrupt

    monkeypatch.setattr(steadysliding, "Tangent", Interrupted)
    with pytest.raises(KeyboardInterrupt):
        Modes(solver, density=1)
    assert alike(everything(solver), before)


@pytest.mark.parametrize("finite", [False, True])
def test_what_a_law_remembers_stays(finite):
    wear = lambda z: z.History("worn", lambda w: w + 1e-3 * z.pressure)  # noqa: E731
    problem = press(offset=wear, friction=5.0, finite=finite)
    solver = solved(problem)  # not committed: the wear is that of the step
    before = everything(solver)
    assert np.all(before[1][0]["worn"] > 0)
    Modes(solver, density=1, count=2)
    assert alike(everything(solver), before)


def test_bodies_that_float_have_zeros():
    free = on_ground(divisions=(3, 3), gravity=0.01, dt=0.1)
    with pytest.warns(ContactWarning, match="is free"):
        free.settle()
    rubbing = on_ground(divisions=(3, 3), gravity=0.01, dt=0.1, friction=0.3).settle()
    found = Modes(free.stepper, density=1, count=3).eigenvalues
    assert found[0] == 0
    assert np.all(found[1:].imag > 0.1)
    assert np.all(Modes(rubbing.stepper, density=1, count=3).eigenvalues.imag > 0.1)


# --- without friction ----------------------------------------------------------------------------


@pytest.mark.parametrize("options", [{"friction": 0.3}, {"lengths": (0.05, 0.03, 0.07)}])
def test_pressed_bars(options):
    """That stick, and three with two contacts."""
    found = Modes(bars(-1e-5, **options), density=1, count=4).frequencies
    assert found == pytest.approx(SPEED / (2 * sum(LENGTHS)) * np.arange(1, 5), rel=1e-7)


def column(pressed):
    """The square of the frequency of Euler's cantilever, length 1, under part of its critical load.

    Times mass over bending stiffness: neither a moment nor a force across acts on the free end.
    """
    p = pressed * np.pi**2 / 4

    def Determinant(square):
        root = np.sqrt(p**2 + 4 * square)
        a, b = np.sqrt((root - p) / 2), np.sqrt((root + p) / 2)
        bent = a * a * np.cosh(a) + b * b * np.cos(b), a * np.sinh(a) + b * np.sin(b)
        sheared = [
            a**3 * np.sinh(a) - b**3 * np.sin(b) + p * (a * np.sinh(a) + b * np.sin(b)),
            a**2 * np.cosh(a) + b**2 * np.cos(b) + p * (np.cosh(a) - np.cos(b)),
        ]
        return bent[0] * sheared[1] - bent[1] * sheared[0]

    return scipy.optimize.brentq(Determinant, 1e-6, 13.0)


def test_a_column_buckles_under_the_pressure_of_contact():
    thickness = 0.05
    place = lambda s, t: (s, thickness * t)  # noqa: E731
    mesh = MakeStructured2DMesh(nx=10, ny=1, mapping=place)
    V = VectorH1(mesh, order=3, dirichlet="left")
    push = Parameter(0)
    plane = tools.Plane((1, 0), (-1, 0)).Moved(shift=(-push, 0))
    stepper = posed(
        V,
        lambda u, v, load: Variation(NeoHooke(Id(2) + Grad(u), 1.0, 0.0) * dx),
        slave="right",
        load=push,
        obstacle=plane,
        finite=True,
    ).stepper()
    critical, scale = (np.pi * thickness) ** 2 / 48, thickness**2 / 12
    for share in (0.01, 0.4, 0.8):
        stepper.Integrate(share * critical, steps=1, printing=False)
        found = (2 * np.pi * Modes(stepper, 1.0, count=1).frequencies[0]) ** 2
        assert found == pytest.approx(scale * column(share), abs=0.01 * scale * column(0))
    stepper.Integrate(1.5 * critical, steps=1, printing=False)
    found = Modes(stepper, 1.0, count=1)
    assert found.growth[0] > 0
    assert "leaves the state (divergence)" in str(found)


def test_all_modes_of_a_small_mesh():
    motion = on_ground(divisions=(2, 1), gravity=0.01, dt=0.1, friction=5.0).settle()
    found = Modes(motion.stepper, density=1, count=26)
    assert len(found.eigenvalues) == 2 * 15 - 4  # two macro-elements stick
    assert np.all(found.residuals < 1e-9)
    with pytest.raises(ValueError, match="count = 28 must be at most 27"):
        Modes(motion.stepper, density=1, count=28)


@pytest.mark.parametrize("flags", [{"tied": True}, {"friction": 10.0}, {}])
def test_modes_of_symmetric_states_are_orthogonal(flags):
    problem = press(dim=3, **flags)
    solver = solved(problem)
    found = Modes(solver, density=2.0, count=5)
    mass = Mass(problem.a, problem.contact, 2.0, Tangent(solver).free).matrix.entries
    assert not np.any(found.vectors.imag)
    assert found.vectors.T @ mass @ found.vectors == pytest.approx(np.eye(5), abs=1e-9)
    assert not np.any(found.growth)
    assert np.all(found.residuals < 1e-9)


@pytest.mark.parametrize("friction", [None, 0.3])
def test_a_tool_that_a_force_drives_has_no_mass(friction):
    mesh = MakeStructured2DMesh(nx=4, ny=4)
    V = VectorH1(mesh, order=3, dirichlet="bottom")
    fes = V * LACSpace(V, slave="top") * NumberSpace(mesh)
    (u, lam, down), (v, *_) = fes.TnT()
    a = BilinearForm(InnerProduct(Grad(u), Grad(v)) * dx)
    punch = tools.Plane((0, 1.1), (0, -1)).Driven(travel=(None, down), force=(0, -0.1))
    contact = LACContact(u, lam, obstacle=punch, finite=True, friction=friction)
    solver = ContactSolver(a, GridFunction(fes), contact)
    solver.Solve(printing=False)
    found = Modes(solver, density=1, count=4)
    # Along the vertical the top moves with the tool, and keeps nothing; sideways it sticks or not.
    sideways = 0.25 if friction is None else 0.5
    for expected in (0.25, sideways):
        assert np.abs(found.frequencies - expected).min() < 1e-4


def test_without_friction_speed_changes_nothing():
    problem = press(dim=3)
    solver = solved(problem)
    assert np.all(problem.contact.Table()["status"] == 2)
    still, fast = (Modes(solver, 1, count=3, speed=speed) for speed in (None, 0.1))
    assert np.array_equal(still.eigenvalues, fast.eigenvalues)


def test_damping_of_the_bulk():
    problem = press(friction=0.1)
    solver = solved(problem)
    plain = 2 * np.pi * Modes(solver, density=1, count=3).frequencies
    found = Modes(solver, density=1, count=3, damping=(0.1, 0))
    assert found.growth == pytest.approx(-0.05, rel=1e-9)
    assert found.frequencies * 2 * np.pi == pytest.approx(np.sqrt(plain**2 - 0.05**2), rel=1e-9)
    (u, _), (v, _) = problem.X.TnT()
    form = BilinearForm(0.1 * InnerProduct(u, v) * dx)
    same = Modes(solver, density=1, count=3, damping=form)
    assert same.eigenvalues == pytest.approx(found.eigenvalues, rel=1e-9)
    stiff = Modes(bars(-1e-5), density=1, count=2, damping=(0, 1e-6))
    assert stiff.growth == pytest.approx(-0.5e-6 * np.abs(stiff.eigenvalues) ** 2, rel=1e-9)


# --- the object ----------------------------------------------------------------------------------


def test_results_are_shown():
    problem = slider(1.0)
    found = Modes(problem.stepper, density=problem.density, count=1)
    assert len(found.eigenvalues) == 2  # the pair stays together
    assert found.unstable.tolist() == [0]
    assert "mode 0 grows by exp(0.20207 t): it vibrates (flutter)" in str(found)
    assert repr(found) == "<Modes: 2, 1 growing; open 0, stick 0, slip 1>"
    assert found.Table()["frequency"] == pytest.approx(found.frequencies)
    real, imaginary = found.Shape(1)
    assert real.vec.Norm() > imaginary.vec.Norm() > 0
    found.Draw(0, show=False)
    data = found.Draw(1, scale=0.1, show=False).GetData()
    assert len(data["multidim_data"]) == modes.PICTURES - 1
    with pytest.raises(ValueError, match="k = 2 must be the number of a mode, from 0 to 1"):
        found.Shape(2)


WRONG = {
    "density = <CoefficientFunction> must be a finite number > 0": {"density": -1},
    "count = 0 must be a whole number": {"count": 0},
    "count = 100000 must be at most": {"count": 100000},
    "speed = -1 must be a finite number > 0": {"speed": -1},
    r"damping\[1\] = -1 must be a finite number >= 0": {"damping": (0, -1)},
}


@pytest.mark.parametrize("message", WRONG)
def test_wrong_numbers_are_refused(message):
    solver = solved(press())
    with pytest.raises(ValueError, match=message):
        Modes(solver, **({"density": 1} | WRONG[message]))
    with pytest.raises(TypeError, match="slope"):
        Modes(solver, density=1, slope="1")
    with pytest.raises(TypeError, match="damping = 1 must be two factors"):
        Modes(solver, density=1, damping=1)


def test_wrong_problems_are_refused():
    problem = press()
    with pytest.raises(ValueError, match="has not solved anything"):
        Modes(problem.solver(), density=1)
    with pytest.raises(TypeError, match="solver"):
        Modes(problem.gf, density=1)
    with pytest.raises(ValueError, match="condense=True"):
        Modes(solved(press(condense=True)), density=1)
    other = BilinearForm(VectorH1(problem.mesh))
    with pytest.raises(ValueError, match="damping lives on another space"):
        Modes(solved(problem), density=1, damping=other)
    with pytest.raises(ValueError, match="flux="):
        Modes(solved(press(flow=lambda z, T: z.Slave(T) - z.Master(T))), density=1)
    falling = press(friction=lambda z: 0.05 + 0.01 * exp(-Norm(z.rate)))
    with pytest.raises(ValueError, match="as slope="):
        Modes(solved(falling), density=1)
    across = slider(0.3, dim=3)
    with pytest.raises(ValueError, match="wherever contact slips"):
        Modes(across.solver, density=across.density, speed=CF(-1.0))


def test_the_method_of_solution_does_not_matter():
    """The matrices of the augmented Lagrangian are softer than contact."""
    one, other = press(friction=0.1), press(friction=0.1)
    augmented = AugmentedLagrangianSolver(other.a, other.gf, other.contact)
    augmented.Solve(printing=False)
    found = Modes(augmented, density=1, count=4).frequencies
    assert found == pytest.approx(Modes(solved(one), density=1, count=4).frequencies, rel=1e-6)


@pytest.mark.parametrize("damping", [None, (0.1, 0.01)])
def test_equal_bodies_have_a_copy_of_each_mode(damping, monkeypatch):
    """A Krylov space knows one vector of an eigenvalue alone; beyond 300 dofs it is used."""
    blocks = [MoveTo(2 * k, 0).Rectangle(1, 1).Face() for k in range(6)]
    for block in blocks:
        block.edges.name = "free"
        block.edges.Min(Y).name = "slave"
    mesh = Mesh(OCCGeometry(Compound(blocks), dim=2).GenerateMesh(maxh=0.5))
    V = VectorH1(mesh, order=3)
    solver = solved(
        posed(V, elastic(10, 0.3), lambda u, v, load: v[1] * dx, obstacle=0, friction=0.5)
    )
    options = {"density": 1, "damping": damping}
    found = [Modes(solver, count=count, **options).eigenvalues for count in (4, 7, 18)]
    monkeypatch.setattr(pencil, "SMALL", 10_000)  # by dense algebra
    exact = Modes(solver, count=20, **options).eigenvalues
    assert np.sum(np.abs(exact - exact[-1]) < 1e-3) > 1
    for some in found:
        assert some == pytest.approx(exact[: len(some)], rel=1e-7, abs=1e-9)


def test_a_derivative_may_follow():
    """The contact does not take the state for the end of a step."""
    problem = press(friction=0.1)
    solver = solved(problem)
    before = Sensitivity(solver, problem.contact.Force).By(problem.load)
    Modes(solver, density=1, count=2)
    assert Sensitivity(solver, problem.contact.Force).By(problem.load) == pytest.approx(before)
