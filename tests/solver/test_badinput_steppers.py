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


@pytest.fixture(scope="module")
def static():
    return on_ground(dt=0.1).stepper.static


@pytest.fixture(params=["load", "time"])
def integrated(request, problem, static):
    """A stepper and its parameter, of which a refused call leaves value and solution alone."""
    problem.load.Set(0.0)
    if request.param == "load":
        stepper = LoadStepper(problem.solver(), problem.load)
        yield stepper, stepper.load, stepper.solver.gf
    else:
        stepper = TimeStepper(static, 1.0, dt=0.1)
        yield stepper, stepper.time, stepper.gf


INTEGRATE = [
    *(({"end": v}, ValueError) for v in (NAN, INF)),
    *(({"end": v}, TypeError) for v in ("1", None)),
    *(({"callback": v}, TypeError) for v in (3, CF(1))),
    ({"printing": "no"}, TypeError),
    ({"maxit": 0}, ValueError),
    ({"maxit": 2.0}, TypeError),
    *(({"tol": v}, ValueError) for v in (0.0, INF, NAN)),
    ({"tol": None}, TypeError),
]


@pytest.mark.parametrize(("flags", "error"), INTEGRATE)
def test_arguments_of_steps(integrated, flags, error):
    stepper, parameter, gf = integrated
    before = numpy(gf)
    with pytest.raises(error, match=f"{next(iter(flags))} = .* must be "):
        stepper.Integrate(**({"end": 0.1, "printing": False} | flags))
    assert parameter.Get() == 0
    assert np.array_equal(numpy(gf), before)


STEPS = [
    (0, ValueError),
    (-3, ValueError),
    (2.5, TypeError),
    (NAN, TypeError),
    (10**12, ValueError),
]


@pytest.mark.parametrize(
    ("load", "flags", "error", "message"),
    [
        *((0.0, {"steps": n}, error, "steps = .* must be ") for n, error in STEPS),
        (1.0, {}, ValueError, r"end = 1 is the present value of the load.*load\.Set\(0"),
        (1 - 1e-15, {}, ValueError, r"end = 1 is the present value of the load"),
        (NAN, {}, ValueError, r"load\.Get\(\) = nan must be a finite number"),
    ],
)
def test_load_steps(problem, load, flags, error, message):
    problem.load.Set(load)
    with pytest.raises(error, match=message):
        LoadStepper(problem.solver(), problem.load).Integrate(1, printing=False, **flags)


@pytest.mark.parametrize(
    ("end", "message"),
    [
        (0.0, "end = 0.0 is not after the time 0.0"),
        (1e-300, "end = 1e-300 is nearer to the time 0.0 than any step"),
    ],
)
def test_time_steps(static, end, message):
    stepper = TimeStepper(static, 1.0, dt=0.1)
    with pytest.raises(ValueError, match=message):
        stepper.Integrate(end, printing=False)
    assert stepper.time.Get() == 0
    assert stepper.balance is None or stepper.balance.time == 0


BOTH = [
    ("solver", None, TypeError),
    ("maxcuts", -1, ValueError),
    *(("maxcuts", v, TypeError) for v in (1.5, NAN, None)),
    *(("prescribe", v, TypeError) for v in (3, "top", CF((0, 1)))),
]
LOAD = [
    *(("load", v, TypeError) for v in (1.0, CF(1))),
    *(("predict", v, TypeError) for v in ("no", None)),
]
TIME = [
    *(("dt", v, ValueError) for v in (0.0, NAN, INF)),
    *(("dt", v, TypeError) for v in (None, "0.1")),
    *(("rho_inf", v, ValueError) for v in (1.5, NAN)),
    ("rho_inf", None, TypeError),
    ("time", 0.0, TypeError),
    ("energy", 3j, TypeError),
    ("energy", CF((1, 2)), ValueError),
    *(("density", v, ValueError) for v in (0.0, -1.0, NAN, INF)),
    *(("density", CF(v), ValueError) for v in (-1, 0, NAN, INF, (1, 1), 1j, x - 0.5)),
    ("density", Parameter(-1), ValueError),
    *(("density", v, TypeError) for v in (None, "steel", [1.0], np.ones(3))),
]


@pytest.mark.parametrize(
    ("kind", "name", "value", "error"),
    [
        *((LoadStepper, *row) for row in BOTH + LOAD),
        *((TimeStepper, *row) for row in BOTH + TIME),
    ],
)
def test_arguments_of_steppers(problem, static, kind, name, value, error):
    if kind is LoadStepper:
        given = {"solver": problem.solver(), "load": Parameter(0)}
    else:
        given = {"solver": static, "density": 1.0, "dt": 0.1}
    given[name] = value
    solver, second, *_ = given
    with pytest.raises(error, match=f"{name} = .* must be "):
        kind(given.pop(solver), given.pop(second), **given)


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
        (
            {MakeStructured2DMesh(nx=1, ny=1).Boundaries("top"): CF((0, 1))},
            ValueError,
            "of another mesh",
        ),
    ],
)
def test_prescribed_values(problem, values, error, message):
    """When the stepper is made, and when they are set later."""
    with pytest.raises(error, match=message):
        LoadStepper(problem.solver(), problem.load, prescribe=values)
    with pytest.raises(error, match=message):
        LoadStepper(problem.solver(), problem.load).prescribe = values


def test_prescribed_values_that_are_not_finite(problem):
    """Found in the first attempt: halving the step does not help."""
    problem.load.Set(0.0)
    top = {"top": CF((0, 1 / (x - x)))}
    with pytest.raises(ValueError, match="value of 'top' is NaN or infinite"):
        LoadStepper(problem.solver(), problem.load, prescribe=top).Integrate(1.0, printing=False)
    assert problem.load.Get() == 0


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


def test_a_velocity_that_is_not_finite(static):
    stepper = TimeStepper(static, 1.0, dt=0.1)
    stepper.velocity.vec[:] = NAN
    with pytest.raises(ValueError, match="velocity holds NaN"):
        stepper.Integrate(0.1, printing=False)


def test_a_gridfunction_as_density(static):
    density = GridFunction(static.gf.space.components[0].components[0])
    density.Set(1 + x)
    assert TimeStepper(static, density, dt=0.1).Integrate(0.1, printing=False)
