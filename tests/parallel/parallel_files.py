"""Cases that write files, and go on from them."""

from ngsolve import CF
from parallel_problem import QUIET, problem, results
from parallel_shapes import block_on_block
from parallel_world import case

from ngslac import LoadMesh, LoadState, LoadStepper, SaveState


def pushed(mesh):
    """Down first, then aside."""
    made = problem(mesh, friction=0.3)
    way = {"top": made.load * CF((0.03 * made.load, -0.03))}
    return made, LoadStepper(made.solver(), made.load, prescribe=way)


@case
def saved(world):
    """Half of the way; the state stays in the folder."""
    made, stepper = pushed(block_on_block(world.comm))
    stepper.Integrate(0.5, steps=2, **QUIET)
    SaveState(world.folder / f"state{world.size}", stepper)
    return results(made)


@case
def restarted(world):
    """The other half, from a state that any number of processes has left."""
    where = {} if world.comm is None else {"comm": world.comm}
    made, stepper = pushed(LoadMesh(world.saved, **where))
    LoadState(world.saved, stepper)
    done = stepper.Integrate(1.0, steps=2, **QUIET)
    return results(made, steps=[step.number for step in done])


@case
def vtu(world):
    """One set of files, of the same points, whatever the number of processes."""
    made, stepper = pushed(block_on_block(world.comm))
    stepper.Integrate(1.0, steps=1, **QUIET)
    folder = world.folder / f"files{world.size}{'' if world.comm is None else 'c'}"
    if world.rank == 0:
        folder.mkdir(parents=True)
    world.wait()
    (contact,) = made.contacts
    path = contact.WriteVTU(folder / "slave", displacement=made.u)
    contact.Segments().WriteVTU(folder / "segments")
    world.wait()
    names = sorted(file.name for file in folder.iterdir())
    head = (folder / "slave.vtu").read_bytes()[:2000].decode("ascii", "replace")
    piece = next(line.strip() for line in head.splitlines() if "<Piece" in line)
    return results(made, files=" ".join(names), name=path.name, piece=piece)
