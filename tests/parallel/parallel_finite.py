"""Cases of large sliding, tools, and of dynamics."""

import numpy as np
from ngsolve import CF, IfPos, InnerProduct, ds, y
from parallel_problem import QUIET, problem, results, rubber
from parallel_shapes import ball_over_slab, block_on_block, cube_on_block, die_on_slab, slotted
from parallel_small import press
from parallel_world import case

from ngslac import LoadStepper, TimeStepper, tools


def slide(made, steps, stroke):
    """Down first, then along."""
    load = made.load
    down, along = IfPos(load - 1, 1, load), IfPos(load - 1, load - 1, 0)
    way = {"top": CF((stroke * along, -0.1 * down))}
    stepper, forces = LoadStepper(made.solver(), load, prescribe=way), []

    def note(step):
        forces.append([*made.contacts[0].Force(), *made.contacts[0].Table()["status"]])

    done = stepper.Integrate(1.0, steps=2, callback=note, **QUIET)
    done += stepper.Integrate(2.0, steps=steps, callback=note, **QUIET)
    return results(made, iterations=[step.iterations for step in done], forces=np.array(forces))


@case
def ironing(world):
    """The die goes along all of the slab: its partners are on one rank after the other."""
    mesh = die_on_slab(world.comm)
    made = problem(mesh, bulk=rubber, young={"die": 1000.0}, friction=0.2, finite=True)
    return slide(made, 12, 2.0)


@case
def sliding3d(world):
    made = problem(cube_on_block(world.comm, 0.45), bulk=rubber, friction=0.2, finite=True)
    return press(made, (0.2, 0.1, -0.06), steps=2)


@case
def selfcontact(world):
    law = {"master": "slave", "friction": 0.3, "finite": True}
    made = problem(slotted(world.comm), bulk=rubber, **law)
    return press(made, (0.05, -0.35), steps=4)


@case
def tied_finite(world):
    made = problem(block_on_block(world.comm), bulk=rubber, tied=True, finite=True)
    return press(made, (0.3, 0.1))


@case
def rigid_tool(world):
    """A ball goes into the upper side of the lower block, and then along."""
    mesh = block_on_block(world.comm)
    ball = tools.Sphere((0.4, -0.5), 0.5)
    made = problem(mesh, bulk=rubber, obstacle=ball, finite=True, friction=0.2)
    return press(made, (0.0, -0.05 + 0.02 * y), steps=2)


@case
def moving_tool(world):
    """A ball comes down on a slab, and goes along it: faces of one rank after the other."""

    def tool(load):
        along, down = IfPos(load - 1, load - 1, 0), IfPos(load - 1, 1, load)
        return tools.Sphere((0.8, 0.52), 0.5).Moved(shift=(1.6 * along, -0.1 * down))

    law = {"obstacle": tool, "finite": True, "friction": 0.1}
    made = problem(die_on_slab(world.comm, 0.3), {"master": {}}, bulk=rubber, **law)
    stepper = LoadStepper(made.solver(), made.load)
    done = stepper.Integrate(2.0, steps=12, **QUIET)
    return results(made, iterations=[step.iterations for step in done])


def flight(world, **options):
    made = problem(ball_over_slab(world.comm), bulk=rubber, friction=0.3, finite=True)
    stepper = TimeStepper(made.solver(), 1.0, dt=0.02, **options)
    body = made.mesh.Materials("ball")
    stepper.velocity.components[0].Set(CF((0.5, -1)), definedon=body)
    return made, stepper


@case
def dynamics(world):
    """A ball bounces."""
    made, stepper = flight(world, rho_inf=0.9)
    done = stepper.Integrate(0.12, printing=False)
    energies = {name: np.array(rows) for name, rows in stepper.Table().items()}
    sizes = max(float(np.abs(rows).max()) for name, rows in energies.items() if name != "time")
    found = results(made, iterations=[step.iterations for step in done])
    return found | {f"energy {name}": (rows, sizes) for name, rows in energies.items()}


@case
def dynamics_small(world):
    """A block on a spring falls on another one."""
    made = problem(
        block_on_block(world.comm, gap=0.01), friction=0.3, flags={"dirichlet": "bottom"}
    )
    u, v = made.X.TrialFunction()[0], made.X.TestFunction()[0]
    made.a += 10 * InnerProduct(u, v) * ds("top")
    stepper = TimeStepper(made.solver(), 1.0, dt=0.01, time=made.load)
    stepper.velocity.components[0].Set(CF((0.1, -1)), definedon=made.mesh.Materials("upper"))
    done = stepper.Integrate(0.05, printing=False)
    return results(made, iterations=[step.iterations for step in done])
