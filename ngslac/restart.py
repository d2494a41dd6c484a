"""Save the state of a computation, and continue it in another process."""

import hashlib
import os
import pickle
from pathlib import Path

import numpy as np
from ngsolve import BaseVector, GridFunction, Parameter

from ngslac.dynamics import TimeStepper
from ngslac.solver import ContactSolver
from ngslac.stepping import LoadStepper

__all__ = ["LoadMesh", "LoadState", "SaveState"]

FORMAT = "ngslac state 1"
# What a solver and its residual remember from one solve to the next.
OWN = ("history", "scale")
MEASURES = ("converged", "forces", "reference", "rows", "tol")


def SaveState(file, tool, *, also=None):
    """Write all that the next step depends on to a file: solution, histories, mesh.

    NGSolve cannot store forms: the script that continues makes the same problem again, on the mesh
    of the file, and calls `LoadState`. What it computes then is what the uninterrupted computation
    would have computed: to the last bit, where the linear solver and the threads used can repeat
    themselves (``inverse="umfpack"`` without a TaskManager; Pardiso's rounding errors differ from
    run to run).

    Parameters
    ----------
    file : str or Path
        An older file of this name is replaced when the new one is complete.
    tool : LoadStepper, TimeStepper or ContactSolver
        Its solver, contacts and solution are saved with it.
    also : dict of str to GridFunction, BaseVector or Parameter, optional
        What else belongs to the state, such as plastic strains or a second load.

    Raises
    ------
    TypeError
        If `tool` or an entry of `also` is of another kind.

    Examples
    --------
    >>> import tempfile
    >>> folder = tempfile.TemporaryDirectory()
    >>> stepper = LoadStepper(solver, load)
    >>> last = stepper.Integrate(0.5, steps=1, printing=False)
    >>> SaveState(folder.name + "/state", stepper)

    In another process, after ``mesh = LoadMesh(...)`` and with the problem made again:

    >>> LoadState(folder.name + "/state", stepper)
    >>> last = stepper.Integrate(1.0, steps=1, printing=False)
    >>> folder.cleanup()
    """
    solver = _Solver(tool)
    solver.StartAfresh()
    state = {
        "kind": type(tool).__name__,
        "space": _Fingerprint(solver.gf.space),
        "ncontacts": len(solver.contacts),
        "state": tool.State(),
        "linear": solver.linear.State(),
    }
    state["also"] = {name: _Values(thing) for name, thing in (also or {}).items()}
    file = Path(file)
    part = file.with_name(file.name + ".part")
    with open(part, "wb") as stream:
        pickle.dump(FORMAT, stream)
        pickle.dump(_Solver(tool).gf.space.mesh, stream)
        pickle.dump(state, stream)
    os.replace(part, file)


def LoadMesh(file):
    """The mesh of a file of `SaveState`, with the numbering that its values refer to.

    Parameters
    ----------
    file : str or Path
        From a source you trust: reading a pickle can run any code.

    Returns
    -------
    ngsolve.Mesh

    Raises
    ------
    ValueError
        If the file is no saved state.

    Examples
    --------
    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     SaveState(folder + "/state", solver)
    ...     found = LoadMesh(folder + "/state")
    >>> found.nv == mesh.nv and found.GetBoundaries() == mesh.GetBoundaries()
    True
    """
    with open(file, "rb") as stream:
        _CheckFormat(stream, file)
        return pickle.load(stream)


def LoadState(file, tool, *, also=None):
    """Put a computation into the state that `SaveState` wrote.

    Parameters
    ----------
    file : str or Path
        From a source you trust: reading a pickle can run any code.
    tool : LoadStepper, TimeStepper or ContactSolver
        Of the kind that was saved, for the same problem on the mesh of `LoadMesh` (or on one made
        in the same way).
    also : dict of str to GridFunction, BaseVector or Parameter, optional
        The counterparts of what was saved, under the same names.

    Raises
    ------
    ValueError
        If the file is no saved state, or belongs to another kind of tool, mesh, space, number of
        contacts or dict `also`. Nothing is changed then.

    Examples
    --------
    Back to a saved state, of a parameter as well:

    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     SaveState(folder + "/state", solver, also={"load": load})
    ...     load.Set(2)
    ...     LoadState(folder + "/state", solver, also={"load": load})
    >>> load.Get()
    1.0
    """
    with open(file, "rb") as stream:
        _CheckFormat(stream, file)
        pickle.load(stream)  # the mesh
        state = pickle.load(stream)
    also, solver = also or {}, _Solver(tool)
    _Compare("tool", state["kind"], type(tool).__name__)
    _Compare("displacement and mesh", state["space"], _Fingerprint(solver.gf.space))
    _Compare("number of contacts", state["ncontacts"], len(solver.contacts))
    _Compare("names in also", sorted(state["also"]), sorted(also))
    for name, thing in also.items():
        _Compare(f"size of {name}", np.size(state["also"][name]), np.size(_Values(thing)))
    for name, thing in also.items():
        _SetValues(thing, state["also"][name])
    tool.SetState(state["state"])
    solver.linear.SetState(state["linear"])
    solver.StartAfresh()


def _CheckFormat(stream, file):
    try:
        found = pickle.load(stream)
    except (pickle.UnpicklingError, EOFError):
        found = None
    if found != FORMAT:
        raise ValueError(f"{file} was not written by SaveState of this version of ngslac")


def _Compare(what, saved, here):
    if saved != here:
        raise ValueError(f"the saved state has another {what}: {saved} there, {here} here")


def _Fingerprint(space):
    """What two spaces with the same meaning of their dofs have in common."""
    points = np.array([v.point for v in space.mesh.vertices])
    dofs = [d for element in space.Elements() for d in element.dofs]
    digest = hashlib.sha256(points.tobytes() + np.array(dofs).tobytes())
    return f"{space.ndof} dofs, {space.mesh.ne} elements, {digest.hexdigest()[:12]}"


# --- values --------------------------------------------------------------------------------------


def _Values(thing):
    if isinstance(thing, Parameter):
        return thing.Get()
    if isinstance(thing, GridFunction):
        thing = thing.vec
    if isinstance(thing, BaseVector):
        return thing.FV().NumPy().copy()
    raise TypeError(f"{thing!r} is neither a GridFunction, a BaseVector nor a Parameter")


def _SetValues(thing, values):
    if isinstance(thing, Parameter):
        thing.Set(values)
    else:
        getattr(thing, "vec", thing).FV().NumPy()[:] = values


# --- solver and steppers -------------------------------------------------------------------------


def _Solver(tool):
    if isinstance(tool, ContactSolver):
        return tool
    if isinstance(tool, (LoadStepper, TimeStepper)):
        return tool.solver
    raise TypeError(f"tool is a {type(tool).__name__}: give a LoadStepper, TimeStepper or solver")
