# SPDX-License-Identifier: LGPL-2.1-or-later
"""Save the state of a computation, and continue it in another process."""

from __future__ import annotations

import hashlib
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from ngsolve import BaseVector, FESpace, GridFunction, Mesh, Parameter

from ngslac._ngslac import DofFingerprint
from ngslac.arguments import CheckInstance, Shown
from ngslac.errors import Warn
from ngslac.files import PathOf
from ngslac.parallel.layout import LayoutOf
from ngslac.parallel.spread import Spread
from ngslac.parallel.together import Alone, OnAll, Together
from ngslac.parallel.whole import AsWhole, Itself, WholeCopy
from ngslac.solve.iteration import Iteration
from ngslac.solve.snapshot import Snapshot
from ngslac.solve.solver import ContactSolver, Equilibrium
from ngslac.steps.balance import EnergyBalance, TimeStep
from ngslac.steps.load import LoadStepper, Step
from ngslac.steps.meshstate import MeshOf, MeshState
from ngslac.steps.statefile import ReadTree, WriteTree
from ngslac.steps.time import TimeStepper

if TYPE_CHECKING:
    from ngslac.contact.contact import LACContact

__all__ = ["LoadMesh", "LoadState", "SaveState"]

SAME = 1e-9  # relative difference of means that are computed anew
RECORDS = (EnergyBalance, Iteration, Step, TimeStep)


def _MeshOf(file: object = None, tool: object = None, **_) -> Mesh | None:
    """The mesh of a tool; None where it is none of ours."""
    known = isinstance(tool, (ContactSolver, LoadStepper, TimeStepper))
    return _Solver(tool).gf.space.mesh if known else None


@OnAll(_MeshOf)
def SaveState(
    file: str | Path,
    tool: ContactSolver | LoadStepper | TimeStepper,
    *,
    also: dict[str, GridFunction | BaseVector | Parameter] | None = None,
) -> None:
    """Write all that the next step depends on to a file: solution, histories, mesh.

    NGSolve cannot store forms: the script that continues makes the same problem again, on the mesh
    of the file, and calls `LoadState`. What it computes then is what the uninterrupted computation
    would have computed: to the last bit, where the linear solver and the threads used can repeat
    themselves: ``inverse="umfpack"`` without a TaskManager, or ``ngsolve.SetNumThreads(1)``, since
    "sparsecholesky" starts threads of its own, whose order varies; Pardiso's rounding errors differ
    from run to run.

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
    OSError
        If the file cannot be written: nothing is left of it, and an older one stays.

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
    path, solver, also = PathOf("file", file), _Solver(tool), _Also(also)
    # Matrices and factorisations are not saved: both runs go on with new ones.
    solver.system.StartAfresh()
    whole, first = AsWhole(solver.gf.space), solver.system.layout.together.rank == 0
    tree = {
        "tool": type(tool).__name__,
        "space": _Fingerprint(whole.space) if first else "",
        "contacts": [_Kind(contact) for contact in solver.contacts],
        "limits": [_Limits(contact) for contact in solver.contacts],
        "state": _Rows(tool.State(), whole.Gather),
        "linear": solver.linear.State(),
        "also": {name: thing.Gather() for name, thing in also.items()},
        "mesh": MeshState(whole.space.mesh) if first else {},
    }
    write = (lambda: WriteTree(path, tree, RECORDS)) if first else (lambda: None)
    solver.system.layout.together.Agree(write, Exception)


def LoadMesh(file: str | Path, *, comm: object = None) -> Mesh:
    """The mesh of a file of `SaveState`, with the numbering that its values refer to.

    It comes back exactly; where it is curved and was refined, up to rounding. Call `SetDeformation`
    again where the mesh had a deformation.

    Parameters
    ----------
    file : str or Path
    comm : mpi4py.MPI.Comm, optional
        Distributes the mesh to these processes, as many as you like.

    Returns
    -------
    ngsolve.Mesh

    Raises
    ------
    ValueError
        If the file is no saved state, or damaged. No code in a file is ever run.

    Examples
    --------
    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     SaveState(folder + "/state", solver)
    ...     found = LoadMesh(folder + "/state")
    >>> found.nv == mesh.nv and found.GetBoundaries() == mesh.GetBoundaries()
    True
    """
    from ngslac.meshes.distributed import Distributed

    return Distributed(lambda: MeshOf(ReadTree(PathOf("file", file), RECORDS)["mesh"]), comm)


@OnAll(_MeshOf)
def LoadState(
    file: str | Path,
    tool: ContactSolver | LoadStepper | TimeStepper,
    *,
    also: dict[str, GridFunction | BaseVector | Parameter] | None = None,
) -> None:
    """Put a computation into the state that `SaveState` wrote.

    Parameters
    ----------
    file : str or Path
    tool : LoadStepper, TimeStepper or ContactSolver
        Of the kind that was saved, for the same problem on the mesh of `LoadMesh` (or on one made
        in the same way).
    also : dict of str to GridFunction, BaseVector or Parameter, optional
        The counterparts of what was saved, under the same names.

    Raises
    ------
    ValueError
        If the file is no saved state, or damaged, or belongs to another kind of tool, mesh, space,
        contacts or dict `also`. Nothing is changed then, nor by any other error.

    Warns
    -----
    ContactWarning
        If a contact has other values of `friction`, `tresca`, `offset`, `maxdist`, `penetration` or
        `adjust` than in the file, with all Parameters as they are after the load.

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
    solver, also = _Solver(tool), _Also(also)
    together, whole = solver.system.layout.together, AsWhole(solver.gf.space)
    first, path = together.rank == 0, PathOf("file", file)
    read = (lambda: ReadTree(path, RECORDS)) if first else (lambda: {})
    found = together.Agree(read, Exception)
    found.pop("mesh", None)
    space = together.Tell(_Fingerprint(whole.space) if first else None)
    saved = found.pop("also", {})
    found = _Spread(found, whole, together)
    found["also"] = _SpreadAlso(saved, also, together)
    _Compare("tool", found["tool"], type(tool).__name__)
    _Compare("displacement and mesh", found["space"], space)
    kinds = [_Kind(contact) for contact in solver.contacts]
    _Compare("number of contacts", len(found["contacts"]), len(kinds))
    for kind, saved in zip(kinds, found["contacts"], strict=True):
        _Compare("kind of contact", saved, kind)
    _Compare("names in also", sorted(found["also"]), sorted(also))
    for name, thing in also.items():
        _Compare(f"kind or size of {name}", _Shape(found["also"][name]), _Shape(thing.State()))
    solver.system.StartAfresh()
    with Snapshot(tool, *also.values()):
        for name, thing in also.items():
            thing.SetState(found["also"][name])
        tool.SetState(found["state"])
        solver.linear.SetState(found["linear"])
        limits = found.get("limits", [])  # older files have none
        for number, saved in enumerate(limits):
            _WarnOfOther(f"contact number {number}", saved, _Limits(solver.contacts[number]))


# Names of the entries that have a row for each dof.
ROWS = ("gf", "scale", "push", "paired", "velocity", "momentum", "rate", "forces", "last")


def _Rows(tree: Any, gather: Callable[[np.ndarray], np.ndarray]) -> Any:
    """A state with the rows of all processes in place of those of this one."""
    if isinstance(tree, Spread):
        return gather(tree)
    if isinstance(tree, dict):
        return {name: _Rows(part, gather) for name, part in tree.items()}
    if isinstance(tree, (list, tuple)) and not hasattr(tree, "__dataclass_fields__"):
        return type(tree)(_Rows(part, gather) for part in tree)
    return tree


def _Spread(
    tree: Any, whole: WholeCopy | Itself, together: Together | Alone, name: str = ""
) -> Any:
    """The inverse, of a state that the first process has read."""
    if together.size == 1:
        return tree
    kind, keys = together.Tell(_Outline(tree, whole.size, name))
    if kind == "rows":
        return whole.Scatter(tree)
    if kind == "dict":
        return {k: _Spread(tree[k] if tree else None, whole, together, k) for k in keys}
    if kind in ("list", "tuple"):
        parts = tree if together.rank == 0 else [None] * keys
        found = [_Spread(part, whole, together, name) for part in parts]
        return found if kind == "list" else tuple(found)
    return keys


def _SpreadAlso(saved: dict, also: dict[str, _Stored], together: Together | Alone) -> dict:
    """The same of what else was saved, under the names that are known here."""
    if together.size == 1:
        return saved
    found = {}
    for name in together.Tell(list(saved)):
        value = saved.get(name)
        if name in also and also[name].gf is not None:
            same = together.Tell(value is not None and value.shape)
            fits = same == (AsWhole(also[name].gf.space).size,)
            found[name] = also[name].Scatter(value) if fits else np.zeros(same or 0)
        else:
            found[name] = together.Tell(value)
    return found


def _Outline(tree: Any, size: int, name: str) -> tuple[str, Any]:
    """Of which kind a part of a state is, and what else others have to know of it."""
    if isinstance(tree, np.ndarray) and name in ROWS and tree.shape[:1] == (size,):
        return "rows", None
    if isinstance(tree, dict):
        return "dict", list(tree)
    if type(tree) in (list, tuple):
        return type(tree).__name__, len(tree)
    return "plain", tree


def _Limits(contact: LACContact) -> dict[str, Any]:
    """The coefficients and limits of the law on macro-elements, with Parameters as now."""
    setup, form = contact._state.setup, contact.form
    limits = {name: setup[name] for name in ("maxdist", "penetration", "adjust")}
    if form.paired:
        form.Reevaluate()
        table = form.Table()
        plain = {"friction", "tresca", "offset"} - setup.get("slopes", {}).keys()
        limits |= {name: table[name] for name in plain}
    return limits


def _WarnOfOther(contact: str, saved: dict, here: dict) -> None:
    """Warn of values that are not the saved ones: they may have been changed on purpose."""
    for name in saved.keys() & here.keys():
        there, now = np.broadcast_arrays(saved[name], here[name])
        far = np.abs(there - now) > SAME * np.maximum(np.abs(there), np.abs(now))
        if np.any(far):
            there, now = (_ShownLimit(name, values[far].flat[0]) for values in (there, now))
            Warn(
                f"{contact} has {name} = {now} where the saved state has {there}: its forces and "
                "slips are those of another law. Make the contact as it was made then, if that is "
                "not what you mean"
            )


def _ShownLimit(name: str, value: float) -> str:
    none = value < 0 if name in ("friction", "tresca") else value == 0 and name != "offset"
    return "None" if none else f"{value:g}"


def _Compare(what: str, saved: object, here: object) -> None:
    if saved != here:
        raise ValueError(f"the saved state has another {what}: {saved} there, {here} here")


def _Fingerprint(space: FESpace) -> str:
    """A value that is equal for two spaces with the same meaning of their dofs."""
    mesh = space.mesh
    digest = hashlib.sha256(np.ascontiguousarray(mesh.ngmesh.Coordinates()))
    digest.update(f"{DofFingerprint(space)} {mesh.GetCurveOrder()}".encode())
    if mesh.deformation is not None:
        digest.update(mesh.deformation.vec.FV().NumPy())
    return f"{space.ndof} dofs, {mesh.ne} elements, {digest.hexdigest()[:12]}"


def _Kind(contact: LACContact) -> str:
    """Describe the contacts that a saved state of this one fits to."""
    sliding = "finite" if contact.finite else "small"
    setup = contact._state.setup
    sides = {"master": "a master", "tool": "a tool", "obstacle": "an obstacle"}
    words = [words for name, words in sides.items() if setup[name] is not None]
    words += [name for name in ("tied", "bilateral", "edges") if setup[name]]
    words += ["a law of its own"] * contact.own_law + [f"its {name}" for name in setup["kept"]]
    return f"{sliding} sliding of {contact.space.nmacros} macro-elements on {', '.join(words)}"


def _Solver(tool: object) -> Equilibrium:
    """The solver of a tool; refuses what is none of ours."""
    if isinstance(tool, ContactSolver):
        return tool
    if isinstance(tool, (LoadStepper, TimeStepper)):
        return tool.solver
    raise TypeError(
        f"tool = {Shown(tool)} is a {type(tool).__name__}: give a LoadStepper, TimeStepper or "
        "ContactSolver"
    )


# --- what else belongs to a state ----------------------------------------------------------------


class _Stored:
    """A GridFunction, vector or Parameter whose values can be put back."""

    def __init__(self, name: str, thing: GridFunction | BaseVector | Parameter):
        self.gf = thing if isinstance(thing, GridFunction) else None
        self.thing = thing.vec if self.gf else thing
        if not isinstance(self.thing, (Parameter, BaseVector)):
            raise TypeError(
                f"also[{name!r}] = {Shown(thing)} is neither a GridFunction, a BaseVector nor a "
                "Parameter"
            )

    def State(self) -> np.ndarray | float:
        if isinstance(self.thing, Parameter):
            return self.thing.Get()
        return self._values.copy()

    @property
    def _values(self) -> np.ndarray:
        if self.gf is None:
            return self.thing.FV().NumPy()
        return LayoutOf(self.gf.space).Values(self.thing)

    def Gather(self) -> np.ndarray | float:
        """The state on the first process, of all rows."""
        values = self.State()
        return AsWhole(self.gf.space).Gather(values) if self.gf is not None else values

    def Scatter(self, values: np.ndarray) -> np.ndarray:
        """The inverse."""
        return AsWhole(self.gf.space).Scatter(values) if self.gf is not None else values

    def SetState(self, values: np.ndarray | float) -> None:
        if isinstance(self.thing, Parameter):
            self.thing.Set(values)
        else:
            self._values[:] = values


def _Also(things: dict[str, GridFunction | BaseVector | Parameter] | None) -> dict[str, _Stored]:
    """Check the things that a user saves besides, and return a `_Stored` for each."""
    things = {} if things is None else things
    CheckInstance("also", things, dict, "a dict of names and GridFunctions")
    for name in things:
        CheckInstance("also: name", name, str, "a string")
    found = {name: _Stored(name, thing) for name, thing in things.items()}
    for name, stored in found.items():
        if stored.gf is None and getattr(stored.thing, "comm", None) and stored.thing.comm.size > 1:
            raise ValueError(f"also[{name!r}] is a vector of many processes: give a GridFunction")
    return found


def _Shape(values: np.ndarray | float) -> str:
    if isinstance(values, float):
        return "a number"
    return f"{values.size} numbers of the kind {values.dtype}"
