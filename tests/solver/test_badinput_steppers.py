"""Wrong input to LoadStepper and TimeStepper: an error at once, which names the argument."""

import numpy as np
import pytest
from motions import on_ground
from ngsolve import CF, GridFunction, Parameter, x
from ngsolve.meshes import MakeStructured2DMesh
from press import numpy, press

from ngslac import LoadStepper, TimeStepper

NAN, INF = float("nan"), float("inf")


@pytest.fixture(scope="module")
def problem():
    return press(spring=0, flags={"dirichlet": "bottom|top"})


@pytest.fixture
def stepper(problem):
    problem.load.Set(0.0)
    return LoadStepper(problem.solver(), problem.load)


# --- load steps ----------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("flags", "error"),
    [
        ({"end": NAN}, ValueError),
        ({"end": INF}, ValueError),
        ({"end": "1"}, TypeError),
        ({"end": None}, TypeError),
        ({"steps": 0}, ValueError),
        ({"steps": -3}, ValueError),
        ({"steps": 2.5}, TypeError),
        ({"steps": NAN}, TypeError),
        ({"steps": 10**12}, ValueError),
        ({"callback": 3}, TypeError),
        ({"callback": CF(1)}, TypeError),
        ({"printing": "no"}, TypeError),
        ({"maxit": 0, "printing": False}, ValueError),
        ({"maxit": 2.0, "printing": False}, TypeError),
        ({"tol": 0.0, "printing": False}, ValueError),
        ({"tol": INF, "printing": False}, ValueError),
        ({"tol": NAN, "printing": False}, ValueError),
        ({"tol": None, "printing": False}, TypeError),
    ],
)
def test_arguments_of_load_steps(stepper, flags, error):
    before = numpy(stepper.solver.gf)
    with pytest.raises(error, match=f"{next(iter(flags))} = .* must be "):
        stepper.Integrate(**flags)
    assert stepper.load.Get() == 0
    assert np.array_equal(numpy(stepper.solver.gf), before)


@pytest.mark.parametrize("load", [1.0, 1 - 1e-15])
def test_a_load_that_is_at_its_end(stepper, load):
    stepper.load.Set(load)
    with pytest.raises(ValueError, match=r"end = 1 is the present value of the load.*load\.Set\(0"):
        stepper.Integrate(1.0, steps=3, printing=False)


def test_a_load_that_is_no_number(stepper):
    stepper.load.Set(NAN)
    with pytest.raises(ValueError, match=r"load\.Get\(\) = nan must be a finite number"):
        stepper.Integrate(1.0, steps=3, printing=False)


@pytest.mark.parametrize(
    ("flags", "error"),
    [
        ({"load": 1.0}, TypeError),
        ({"load": CF(1)}, TypeError),
        ({"solver": None}, TypeError),
        ({"predict": "no"}, TypeError),
        ({"predict": None}, TypeError),
        ({"maxcuts": -1}, ValueError),
        ({"maxcuts": 1.5}, TypeError),
        ({"maxcuts": NAN}, TypeError),
        ({"prescribe": CF((0, 1))}, TypeError),
        ({"prescribe": 3}, TypeError),
        ({"prescribe": "top"}, TypeError),
    ],
)
def test_arguments_of_a_load_stepper(problem, flags, error):
    given = {"solver": problem.solver(), "load": Parameter(0)} | flags
    with pytest.raises(error, match=f"{next(iter(flags))} = .* must be "):
        LoadStepper(given.pop("solver"), given.pop("load"), **given)


@pytest.mark.parametrize(
    ("values", "error", "message"),
    [
        ({"topp": CF((0, 1))}, ValueError, "region='topp' matches no boundary face; .* top,"),
        ({3: CF((0, 1))}, TypeError, "region = 3 must be a pattern"),
        ({"slave": CF((0, 1))}, ValueError, "no displacement is constrained on 'slave'"),
        ({"top": CF(1)}, ValueError, "'top' has 1 components, a displacement has 2"),
        ({"top": CF((0, 0, 1))}, ValueError, "'top' has 3 components, a displacement has 2"),
        ({"top": None}, TypeError, "the value of 'top' = None must be a displacement with 2"),
        ({"top": (None, 0)}, TypeError, "the value of 'top' = .None, 0. must be a displacement"),
        ({"top": "down"}, TypeError, "the value of 'top' = 'down' must be a displacement"),
        ({"top": CF((1j, 0))}, ValueError, "the value of 'top', .*, is complex"),
    ],
)
def test_prescribed_values(problem, values, error, message):
    """When the stepper is made, and when they are set later."""
    with pytest.raises(error, match=message):
        LoadStepper(problem.solver(), problem.load, prescribe=values)
    with pytest.raises(error, match=message):
        LoadStepper(problem.solver(), problem.load).prescribe = values


def test_prescribed_on_another_mesh(problem):
    other = MakeStructured2DMesh(nx=1, ny=1).Boundaries("top")
    with pytest.raises(ValueError, match="of another mesh"):
        LoadStepper(problem.solver(), problem.load, prescribe={other: CF((0, 1))})


def test_prescribed_values_that_are_not_finite(stepper):
    """Found in the first attempt: halving the step does not help."""
    stepper.prescribe = {"top": CF((0, 1 / (x - x)))}
    with pytest.raises(ValueError, match="value of 'top' is NaN or infinite"):
        stepper.Integrate(1.0, printing=False)
    assert stepper.load.Get() == 0


# --- time steps ----------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def static():
    return on_ground(dt=0.1).stepper.static


@pytest.mark.parametrize(
    ("density", "error"),
    [
        (0.0, ValueError),
        (-1.0, ValueError),
        (NAN, ValueError),
        (INF, ValueError),
        (None, TypeError),
        ("steel", TypeError),
        ([1.0], TypeError),
        (np.ones(3), TypeError),
        (CF(-1), ValueError),
        (CF(0), ValueError),
        (CF(NAN), ValueError),
        (CF(INF), ValueError),
        (CF((1, 1)), ValueError),
        (CF(1j), ValueError),
        (x - 0.5, ValueError),
        (Parameter(-1), ValueError),
    ],
)
def test_densities(static, density, error):
    with pytest.raises(error, match=r"density = .* must be a "):
        TimeStepper(static, density, dt=0.1)


@pytest.mark.parametrize("value", [-1.0, NAN])
def test_a_density_by_material(static, value):
    mesh = static.gf.space.mesh
    with pytest.raises(ValueError, match="in the material 'dom'"):
        TimeStepper(static, mesh.MaterialCF({"dom": value}), dt=0.1)


def test_a_density_that_changes(static):
    density = Parameter(1.0)
    stepper = TimeStepper(static, density, dt=0.1)
    stepper.Integrate(0.1, printing=False)
    density.Set(2.0)
    with pytest.raises(ValueError, match="the density has changed"):
        stepper.Integrate(0.2, printing=False)
    assert stepper.time.Get() == 0.1


@pytest.mark.parametrize(
    ("flags", "error"),
    [
        ({"dt": 0.0}, ValueError),
        ({"dt": NAN}, ValueError),
        ({"dt": INF}, ValueError),
        ({"dt": None}, TypeError),
        ({"dt": "0.1"}, TypeError),
        ({"rho_inf": 1.5}, ValueError),
        ({"rho_inf": NAN}, ValueError),
        ({"rho_inf": None}, TypeError),
        ({"time": 0.0}, TypeError),
        ({"energy": 3j}, TypeError),
        ({"energy": CF((1, 2))}, ValueError),
        ({"maxcuts": -1}, ValueError),
        ({"maxcuts": None}, TypeError),
        ({"prescribe": 3}, TypeError),
    ],
)
def test_arguments_of_a_time_stepper(static, flags, error):
    with pytest.raises(error, match=f"{next(iter(flags))} = .* must be "):
        TimeStepper(static, 1.0, **({"dt": 0.1} | flags))


def test_a_time_stepper_without_a_solver():
    with pytest.raises(TypeError, match="solver = None must be a ContactSolver"):
        TimeStepper(None, 1.0, dt=0.1)


@pytest.mark.parametrize(
    ("flags", "error", "message"),
    [
        ({"end": 0.0}, ValueError, "end = 0.0 is not after the time 0.0"),
        ({"end": 1e-300}, ValueError, "end = 1e-300 is nearer to the time 0.0 than any step"),
        ({"end": NAN}, ValueError, "end = nan must be"),
        ({"end": INF}, ValueError, "end = inf must be"),
        ({"end": None}, TypeError, "end = None must be"),
        ({"end": 0.1, "callback": 3}, TypeError, "callback = 3 must be"),
        ({"end": 0.1, "maxit": 0}, ValueError, "maxit = 0 must be"),
        ({"end": 0.1, "tol": INF}, ValueError, "tol = inf must be"),
    ],
)
def test_arguments_of_time_steps(static, flags, error, message):
    stepper = TimeStepper(static, 1.0, dt=0.1)
    with pytest.raises(error, match=message):
        stepper.Integrate(printing=False, **flags)
    assert stepper.time.Get() == 0
    assert stepper.balance is None or stepper.balance.time == 0


def test_a_velocity_that_is_not_finite(static):
    stepper = TimeStepper(static, 1.0, dt=0.1)
    stepper.velocity.vec[:] = NAN
    with pytest.raises(ValueError, match="velocity holds NaN"):
        stepper.Integrate(0.1, printing=False)


def test_a_gridfunction_as_density(static):
    """A field is fine."""
    density = GridFunction(static.gf.space.components[0].components[0])
    density.vec[:] = 1.0
    density.Set(1 + x)
    assert TimeStepper(static, density, dt=0.1).Integrate(0.1, printing=False)
