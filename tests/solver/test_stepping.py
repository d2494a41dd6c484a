"""LoadStepper and TimeStepper: steps and cuts, what callbacks see, what they may not do."""

import sys
from io import StringIO

import continued
import numpy as np
import pytest
from motions import bar, elastic, moving, neo_hooke, on_ground, sliding
from netgen.libngpy._meshing import _GetStatus
from netgen.occ import Circle, Compound, MoveTo, OCCGeometry, Y
from ngsolve import CF, BilinearForm, GridFunction, Mesh, Parameter, VectorH1, dx, sqrt, x
from ngsolve.meshes import MakeStructured2DMesh
from press import mixed_press, numpy, press
from press import neo_hooke as neo_hooke_2d

from ngslac import (
    ContactConvergenceError,
    ContactSolver,
    LACContact,
    LACSpace,
    LoadStepper,
    TimeStepper,
)
from ngslac.steps.control import StepControl


def loading(make=mixed_press, *, predict=True, **flags):
    problem = make(**flags)
    problem.load.Set(0.0)
    return LoadStepper(problem.solver(), problem.load, predict=predict)


# --- both kinds of steps -------------------------------------------------------------------------

TOOLS = {"load": lambda: loading(nonlinear=True), "time": lambda: bar(n=8, dt=0.25).stepper}


@pytest.fixture(params=TOOLS)
def name(request):
    return request.param


def ran(name, end=1.0, stepper=None, **flags):
    """A stepper after steps of 1/4."""
    stepper = stepper or TOOLS[name]()
    if name == "load":
        flags["steps"] = round(4 * (end - stepper.load.Get()))
    steps = stepper.Integrate(end, printing=False, **flags)
    return stepper, steps


def test_rounding_errors_are_no_step_of_their_own():
    control = StepControl(0.0, 0.3, 4, size=0.1)  # 0.1 + 0.1 + 0.1 > 0.3
    for _ in range(3):
        assert not control.done
        control.Reached(control.goal)
    assert control.done


def test_steps_reach_the_end_and_call_back(name):
    """NGSolve's status line follows them, and is as before after them."""
    seen, lines, before = [], [], _GetStatus()
    stepper, steps = ran(
        name, callback=lambda step: (seen.append(step), lines.append(_GetStatus()))
    )
    assert seen == steps
    assert [step.time for step in steps] == pytest.approx([0.25, 0.5, 0.75, 1.0])
    assert [step.number for step in steps] == [1, 2, 3, 4]
    assert all(step.iterations >= 1 and step.cuts == 0 for step in steps)
    assert getattr(stepper, name).Get() == 1.0
    assert lines == [(f"contact: {name} steps", pytest.approx(100 * step.time)) for step in steps]
    assert _GetStatus() == before


def test_continues_where_it_stopped(name):
    stepper, _ = ran(name, 0.5)
    ran(name, 1.0, stepper)
    other, _ = ran(name)
    assert numpy(stepper.solver.gf) == pytest.approx(numpy(other.solver.gf), abs=1e-13)
    assert [step.number for step in stepper.steps] == [1, 2, 3, 4]


ASIDE = {"friction": 2.0, "nonlinear": True, "push": (0.3, -0.05)}
HARD = {
    "turned": (lambda: loading(nonlinear=True, friction=None), 1.0, {"steps": 1}),
    "pushed aside": (lambda: loading(press, **ASIDE), 1.0, {"steps": 1}),
    "thrown": (
        lambda: on_ground(gap=0.01, dt=0.4, nonlinear=True, order=1).throw(0, -1).stepper,
        0.8,
        {},
    ),
}


@pytest.mark.usefixtures("whole_systems")
@pytest.mark.parametrize("name", HARD)
def test_a_failing_step_is_cut_and_grows_again(name, capsys):
    make, end, flags = HARD[name]
    stepper = make()
    steps = stepper.Integrate(end, maxit=4, **flags)
    assert sum(step.cuts for step in steps) > 0
    sizes = np.diff([0, *(step.time for step in steps)])
    assert sizes.min() > 0
    assert sizes.max() > 1.5 * sizes.min()
    assert getattr(stepper, "load" if flags else "time").Get() == steps[-1].time == end
    assert "halved" in capsys.readouterr().out
    if name == "turned":  # without friction the path does not matter
        fine = make()
        fine.Integrate(steps=8, printing=False)
        assert numpy(stepper.solver.gf) == pytest.approx(numpy(fine.solver.gf), abs=1e-8)


@pytest.mark.parametrize(
    ("wrong", "match"),
    [
        (lambda gf, parameter: parameter.Set(0.01), "callback has set the {} from .* to "),
        (
            lambda gf, parameter: gf.vec.FV().NumPy().fill(np.nan),
            "callback has put NaN or infinite values into gf",
        ),
    ],
)
def test_what_a_callback_must_not_do_between_steps(name, wrong, match):
    """With a load that is set back it would never come to an end."""
    stepper = TOOLS[name]()
    gf, parameter = stepper.solver.gf, getattr(stepper, name)
    with pytest.raises(ValueError, match=match.format(name)):
        ran(name, stepper=stepper, callback=lambda step: wrong(gf, parameter))


def test_what_a_callback_changes_stays():
    """A step that fails after it goes back to what it left, not to the state before."""
    stepper = continued.half(continued.bouncing())

    def prescribe(_):
        if stepper.time.Get() > 0.55:
            raise RuntimeError("enough")

    def stop(_):
        stepper.velocity.vec[:] = 0

    stepper.prescribe = prescribe
    with pytest.raises(RuntimeError, match="enough"):
        stepper.Integrate(0.58, printing=False, callback=stop)
    assert stepper.time.Get() == pytest.approx(0.54)
    assert not np.any(numpy(stepper.velocity))


# --- steps of a load -----------------------------------------------------------------------------


def test_the_callback_sees_the_committed_state():
    stepper, forces = loading(), []
    (contact,) = stepper.solver.contacts

    def callback(step):
        contact.Evaluate(stepper.solver.gf)
        table = contact.Table()
        assert table["slip"][table["status"] > 0] == pytest.approx(0, abs=1e-14)
        forces.append(contact.Force()[1])

    stepper.Integrate(steps=3, printing=False, callback=callback)
    assert np.all(np.diff(forces) > 0)


def test_unloading_goes_back():
    """Frictionless contact has no memory: back at zero nothing is left."""
    stepper = loading(friction=None)
    displacement = stepper.solver.gf.components[0]
    stepper.Integrate(1.0, steps=2, printing=False)
    assert np.abs(numpy(displacement)).max() > 1e-3
    stepper.Integrate(0.0, steps=2, printing=False)
    assert np.abs(numpy(displacement)).max() < 1e-12


def test_prediction_does_not_change_the_solution():
    ends = []
    for predict in (False, True):
        stepper = loading(nonlinear=True, predict=predict)
        stepper.Integrate(steps=3, printing=False)
        ends.append(numpy(stepper.solver.gf))
    assert ends[0] == pytest.approx(ends[1], abs=1e-8)


def test_a_prediction_that_is_worse_than_none_is_dropped():
    """Wrong by a factor of a thousand, the extrapolation leads astray: the last state is better."""
    stepper = loading(press, friction=0.5)
    solver, starts = stepper.solver, []
    stepper.Integrate(0.5, steps=2, printing=False)
    before, solve = numpy(solver.gf), solver.Solve
    solver.Solve = lambda **flags: (starts.append(numpy(solver.gf)), solve(**flags))[1]
    increment, size = stepper.State()["last"]
    stepper.SetState(stepper.State() | {"last": (increment, size / 1000)})
    stepper.Integrate(0.75, steps=1, printing=False)
    assert np.array_equal(starts[0], before)
    stepper.Integrate(1.0, steps=1, printing=False)  # a right one helps
    assert not np.array_equal(starts[1], before)


@pytest.mark.parametrize(
    ("push", "law", "said"),
    [
        ((0.02, -0.02), {"friction": 0.3}, "$"),
        (
            (0.3, -0.02),
            {"friction": 0.3},
            "; nearly all closed macro-elements slip: the load seems",
        ),
        ((0, 0.3 + 0.3 * x), {}, "; all macro-elements are open"),
    ],
)
def test_why_no_shorter_step_converges(push, law, said):
    stepper = loading(press, nonlinear=True, push=push, **law)
    stepper.Integrate(0.5, steps=1, printing=False)
    few = r"no step beyond load 0\.5 converges: no convergence in 1 iterations: [^;]*"
    with pytest.raises(ContactConvergenceError, match=few + said):
        stepper.Integrate(steps=1, maxit=1, tol=1e-14, printing=False)
    assert stepper.load.Get() == 0.5


def test_loose_bodies_may_need_time():
    """Where load steps end, the error names the stepper that can follow a fall."""

    def bulk(u, v, load):
        return neo_hooke_2d(u), load * v[1] * dx("upper")

    for finite in (False, True):
        stepper = loading(press, bulk=bulk, spring=0, friction=0.3, finite=finite)
        with pytest.raises(ContactConvergenceError) as caught:
            stepper.Integrate(steps=1, maxit=1, tol=1e-14, printing=False)
        assert ("let them move in time by TimeStepper" in str(caught.value)) == finite


# --- steps in time -------------------------------------------------------------------------------


def test_a_static_solution_stays():
    """In equilibrium nothing moves, and the static solver is as before."""
    motion = sliding(speed=0.0)
    before = numpy(motion.gf)
    size = np.abs(before).max()
    motion.run(0.2)
    assert numpy(motion.gf) == pytest.approx(before, abs=1e-12 * size)
    motion.stepper.static.Solve(printing=False)
    assert numpy(motion.gf) == pytest.approx(before, abs=1e-10 * size)


def test_displacement_anywhere_in_the_product_space():
    mesh = MakeStructured2DMesh(quads=True, nx=1, ny=1)
    V, W = VectorH1(mesh, order=2), VectorH1(mesh, order=1, dirichlet=".*")
    X = W * LACSpace(V, slave="bottom") * V
    (w, lam, u), (dw, _, v) = X.TnT()
    a = BilinearForm(elastic(u, v) + elastic(w, dw))
    gf, time = GridFunction(X), Parameter(0)
    contact = LACContact(u, lam, obstacle=CF(1.0))
    stepper = TimeStepper(ContactSolver(a, gf, contact), 2.0, dt=0.5, time=time)
    stepper.velocity.components[2].Set((0, -0.5))
    stepper.Integrate(1.0, printing=False)
    assert time.Get() == 1.0
    assert gf.components[2](mesh(0.3, 0.2)) == pytest.approx((0, -0.5), abs=1e-12)
    assert stepper.balance.kinetic == pytest.approx(0.25)


def test_a_state_without_energy_is_no_solution():
    motion = on_ground(gap=1.0, dt=0.1, maxcuts=1).throw(0, -1.0)
    motion.run(0.1)
    before = numpy(motion.gf)
    # Has no value below -0.15, as that of an element turned inside out.
    motion.stepper.energy = sqrt(motion.gf.components[0][1] + 0.15)
    with pytest.raises(ContactConvergenceError, match="inside out"):
        motion.run(0.2)
    assert numpy(motion.gf) == pytest.approx(before, abs=0.05 + 1e-12)
    assert motion.time.Get() <= 0.15
    motion.stepper.energy = CF(float("nan"))
    with pytest.raises(ValueError, match="energy is NaN or infinite where the motion begins"):
        motion.run(0.2)


def test_steps_that_bring_in_energy_are_cut(capsys):
    """A ball bounces off a block, in steps in which waves cross it nine times."""
    ball, block = Circle((0, 1.1), 1.0).Face(), MoveTo(-3, -1).Rectangle(6, 1).Face()
    ball.edges.name = ball.faces.name = "ball"
    block.edges.Max(Y).name, block.edges.Min(Y).name = "top", "fix"
    ball.faces.maxh, block.faces.maxh = 0.6, 1.0
    mesh = Mesh(OCCGeometry(Compound([block, ball]), dim=2).GenerateMesh()).Curve(2)
    flags = {"flags": {"dirichlet": "fix"}, "law": {"master": "top", "finite": True}}
    motion = moving(mesh, "ball", nonlinear=True, dt=12.0, rho_inf=0.8, **flags)
    motion.stepper.energy = neo_hooke(motion.gf.components[0])
    motion.throw(where=mesh.MaterialCF({"ball": CF((0, -0.0115))}, default=CF((0, 0))))
    totals = np.array([step.balance.total for step in motion.stepper.Integrate(60.0)])
    begin = 0.5 * np.pi * 0.0115**2
    assert totals.max() < 1.02 * begin
    assert totals[-1] > 0.3 * begin
    assert "of the energy; halved" in capsys.readouterr().out


class Terminal(StringIO):
    """What takes itself for a terminal."""

    def isatty(self):
        return True


@pytest.mark.parametrize(("printing", "lines"), [("steps", 2), (False, 0)])
def test_a_line_per_step(printing, lines, capsys, monkeypatch):
    """On a terminal one line changes as long as a step is under way; files get whole ones."""
    stepper = loading()
    stepper.Integrate(steps=2, printing=printing)
    out = capsys.readouterr().out.splitlines()
    assert len(out) == lines
    assert all(line.startswith(f"step {k + 1}  load") for k, line in enumerate(out))
    terminal = Terminal()
    monkeypatch.setattr(sys, "stderr", terminal)
    stepper.Integrate(2.0, steps=1, printing=printing)
    shown = terminal.getvalue()
    assert "equilibrium" in shown
    assert shown.count("\n") == (printing is False)


def test_what_may_be_printed():
    with pytest.raises(TypeError, match=r"True, False or .steps."):
        loading().Integrate(printing="lines")
