"""Cases of small sliding."""

from contextlib import contextmanager

from ngsolve import CF, InnerProduct, LinearForm, ds, dx, x
from parallel_problem import QUIET, problem, results, rubber
from parallel_shapes import (
    block_on_block,
    cube_on_block,
    disc_on_block,
    leaves,
    ring_and_disc,
    sphere_on_block,
    two_discs_on_block,
)
from parallel_world import case

from ngslac import AugmentedLagrangianSolver, LoadStepper
from ngslac.meshes import Distributed, TwoBlocks
from ngslac.solve.system import Saddle

YOUNG = {"disc": 200.0, "sphere": 200.0}


def press(made, way, *, steps=2, solver=None, **options):
    """In load steps, the top moved by load * way."""
    way = {"top": way} if isinstance(way, tuple) else way
    prescribe = {key: made.load * CF(value) for key, value in way.items()}
    stepper = LoadStepper(solver or made.solver(), made.load, prescribe=prescribe)
    done = stepper.Integrate(steps=steps, **QUIET, **options)
    return results(made, iterations=[step.iterations for step in done])


@case
def hertz2d(world):
    made = problem(disc_on_block(world.comm), young=YOUNG, friction=0.3)
    return press(made, (0.05, -0.1), steps=3)


@case
def hertz3d(world):
    made = problem(sphere_on_block(world.comm), young=YOUNG, friction=0.3)
    return press(made, (0.06, 0.02, -0.12))


@case
def blocks3d(world):
    """Flat faces, of which one edge lifts off."""
    made = problem(cube_on_block(world.comm), friction=0.2)
    return press(made, (0.02, 0.0, -0.06 + 0.08 * x))


@case
def builder(world):
    """The mesh of a builder, which makes it in one process."""
    mesh = Distributed(
        lambda: TwoBlocks(0.1, overhang=0.2, structured=True, quads=True), world.comm
    )
    return press(problem(mesh, friction=0.3), (0.02, -0.03 + 0.05 * x))


@case
def order3(world):
    mesh = disc_on_block(world.comm, 0.1)
    return press(problem(mesh, order=3, young=YOUNG, friction=0.3), (0.02, -0.1))


@case
def curved(world):
    mesh = disc_on_block(world.comm).Curve(2)
    return press(problem(mesh, young=YOUNG, friction=0.3), (0.02, -0.1))


@case
def curved3d(world):
    mesh = sphere_on_block(world.comm).Curve(2)
    return press(problem(mesh, young=YOUNG, friction=0.3), (0.06, 0.02, -0.12))


@case
def order1(world):
    made = problem(disc_on_block(world.comm, 0.03), order=1, young=YOUNG, friction=0.3)
    return press(made, (0.02, -0.1))


@case
def two_contacts(world):
    laws = {"slave0": {"friction": 0.2}, "slave1": {"tresca": 0.5}}
    made = problem(two_discs_on_block(world.comm), laws, flags={"dirichlet": "bottom|top0|top1"})
    return press(made, {"top0": (0.01, -0.1), "top1": (-0.03, -0.06)})


@case
def condensed(world):
    made = problem(block_on_block(world.comm), friction=0.3, order=3, condense=True)
    return press(made, (0.02, -0.03 + 0.05 * x))


@case
def nonlinear(world):
    made = problem(block_on_block(world.comm), bulk=rubber, friction=0.3)
    return press(made, (0.05, -0.1 + 0.1 * x))


@case
def augmented(world):
    made = problem(block_on_block(world.comm), friction=0.3)
    solver = AugmentedLagrangianSolver(made.a, made.gf, made.contacts)
    return press(made, (0.02, -0.03 + 0.05 * x), steps=1, solver=solver)


@case
def bilateral(world):
    made = problem(block_on_block(world.comm), bilateral=True, friction=0.3)
    return press(made, (0.02, 0.01 + 0.02 * x))


@case
def tied(world):
    made = problem(block_on_block(world.comm), tied=True)
    return press(made, (0.05, 0.05), steps=1)


@case
def tied3d(world):
    made = problem(cube_on_block(world.comm), tied=True)
    return press(made, (0.05, 0.02, 0.05), steps=1)


@case
def interference(world):
    """A press fit, by an offset."""
    made = problem(block_on_block(world.comm), offset=-0.01, friction=0.2)
    made.solver().Solve(**QUIET)
    return results(made)


@case
def obstacle(world):
    """A gap function; the other block does not take part."""
    gap = 0.02 + 0.1 * (x - 0.4) ** 2
    made = problem(block_on_block(world.comm), obstacle=CF(gap), friction=0.2)
    return press(made, (0.02, -0.06))


@case
def heat(world):
    """A hot disc in a cold ring."""
    flags = {"dirichletx": "symx", "dirichlety": "symy"}
    mesh = ring_and_disc(world.comm).Curve(3)
    made = problem(mesh, flags=flags, friction=0.3)
    v = made.X.TestFunction()[0]
    hot = mesh.MaterialCF({"disc": 1.0}, default=0.0) * (1 + x)
    made.a += -made.load * hot * (v.Deriv()[0, 0] + v.Deriv()[1, 1]) * dx
    done = LoadStepper(made.solver(), made.load).Integrate(steps=2, **QUIET)
    return results(made, iterations=[step.iterations for step in done])


def floating_blocks(comm, **law):
    """The upper block is held by contact and friction alone."""
    law = {"friction": 0.4, "flags": {"dirichlet": "bottom"}} | law
    made = problem(block_on_block(comm, gap=0.01), **law)
    v = made.X.TestFunction()[0]
    made.a += -made.load * InnerProduct(CF((0.2 * made.load, -1.0)), v) * ds("top")
    return made


@case
def floating(world):
    made = floating_blocks(world.comm)
    done = LoadStepper(made.solver(), made.load).Integrate(steps=2, **QUIET)
    return results(made, iterations=[step.iterations for step in done])


@case
def floating3d(world):
    law = {"friction": 0.4, "flags": {"dirichlet": "bottom"}}
    made = problem(cube_on_block(world.comm), **law)
    v = made.X.TestFunction()[0]
    made.a += -made.load * InnerProduct(CF((0.2, 0.1, -1.0)), v) * ds("top")
    made.load.Set(1.0)
    last = made.solver().Solve(**QUIET)
    return results(made, iterations=last.number)


@case
def prescribed_by_function(world):
    """The values of the top are set by a function of the solution, as NGSolve's own scripts do."""
    mesh = disc_on_block(world.comm)
    made = problem(mesh, young=YOUNG, friction=0.3)

    def values(gf):
        way = made.load * CF((0.02, -0.1))
        gf.components[0].Set(way, definedon=mesh.Boundaries("top"))

    stepper = LoadStepper(made.solver(), made.load, prescribe=values)
    done = stepper.Integrate(steps=2, **QUIET)
    return results(made, iterations=[step.iterations for step in done])


def pressed_by_form(comm):
    """Bodies, and the load at the top as a form of its own."""
    made = problem(block_on_block(comm), friction=0.4, flags={"dirichlet": "bottom"})
    rhs, v = LinearForm(made.X), made.X.TestFunction()[0]
    rhs += made.load * InnerProduct(CF((0.2, -1.0)), v) * ds("top")
    return made, rhs


@case
def load_as_linearform(world):
    made, rhs = pressed_by_form(world.comm)
    made.load.Set(1.0)
    last = made.solver(rhs=rhs.Assemble()).Solve(**QUIET)
    return results(made, iterations=last.number)


@case
def load_by_function(world):
    made, rhs = pressed_by_form(world.comm)
    stepper = LoadStepper(made.solver(rhs=lambda: rhs.Assemble().vec), made.load)
    done = stepper.Integrate(steps=2, **QUIET)
    return results(made, iterations=[step.iterations for step in done])


@case
def one_solve(world):
    """Without a stepper, and with the default tolerance."""
    made = problem(block_on_block(world.comm), friction=0.4)
    made.u.Set(CF((0.01, -0.02)), definedon=made.mesh.Boundaries("top"))
    last = made.solver().Solve(printing=False)
    return results(made, iterations=last.number)


@contextmanager
def few_iterations(most=2):
    """Newton's method gives up soon, and the interior point method takes over."""
    before, Saddle.most = Saddle.most, most
    try:
        yield
    finally:
        Saddle.most = before


@case
def interior_point(world):
    """Condensed, too, and with prescribed motions of the next step."""
    found = {}
    for condense in (False, True):
        made = problem(
            leaves(world.comm), flags={"dirichlet": "clamp"}, friction=0.3, condense=condense
        )
        v = made.X.TestFunction()[0]
        made.a += 1e-4 * made.load * v[1] * ds("pressed")
        with few_iterations():
            done = LoadStepper(made.solver(), made.load).Integrate(steps=2, **QUIET)
        numbers = results(made, iterations=[step.iterations for step in done])
        found |= {f"{name}, {condense}": value for name, value in numbers.items()}
    return found
