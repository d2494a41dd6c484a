# SPDX-License-Identifier: LGPL-2.1-or-later
"""Sums, decisions and calls that the processes of a distributed mesh make together."""

from __future__ import annotations

import inspect
import math
import pickle
import sys
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import AbstractContextManager, contextmanager, nullcontext
from functools import wraps
from numbers import Real
from typing import TYPE_CHECKING, Any, ClassVar, TypeVar

import numpy as np
from netgen.meshing import NgException

from ngslac.parallel.farewell import Farewell
from ngslac.parallel.interrupts import Interrupts
from ngslac.progress import Silence

if TYPE_CHECKING:
    from ngsolve import Mesh

__all__ = ["ALONE", "OnAll", "OutOfStepError", "Portable", "Recall", "Together"]

PATIENCE = 60.0  # seconds to wait for others without a word
RULE = "what belongs to a distributed mesh has to be called on all processes, in the same order"
OWN = {"printing", "callback"}  # arguments that each process may choose
# Differences of numbers that were computed on each process: relative, and near zero.
SAME, NOTHING = 1e-9, 1e-14
Called = TypeVar("Called", bound=Callable)  # keeps what type checkers know of it
KEPT = 16  # things of a kind that are remembered, so that the memory of a long script is bounded
LEFT = -1  # in place of the length of a call: of a process whose script has ended


class OutOfStepError(RuntimeError):
    """Processes have called different things."""


class Together:
    """The processes of a distributed mesh.

    All of them call each method, in the same order.
    """

    known: ClassVar = []

    def __init__(self, comm: Any):
        self._original, self.comm, self._roll = comm, comm.Dup(), comm.Dup()
        self.rank, self.size = comm.rank, comm.size
        self.layouts, self.skins, self.extents, self._depth = [], [], [], 0
        self.interrupts = Interrupts()
        Farewell.Of(self._Leave)
        if self.rank:
            Silence()

    @classmethod
    def Of(cls, mesh: Mesh) -> Together:
        """Find the processes of a distributed mesh."""
        from mpi4py import MPI

        comm = mesh.comm.mpi4py
        for known in cls.known:
            if MPI.Comm.Compare(known._original, comm) in (MPI.IDENT, MPI.CONGRUENT):
                return known
        cls.known.append(cls(comm))
        return cls.known[-1]

    # --- calls ---------------------------------------------------------------------------------

    @contextmanager
    def Call(self, name: str, arguments: dict[str, Any]) -> Iterator[None]:
        """Enter a call that all processes make, with the same numbers and words as `arguments`.

        Interrupts wait until all of them know.
        """
        self._depth += 1
        try:
            with self.interrupts.Held():
                if self._depth == 1:
                    self._CallTheRoll(name, arguments)
                yield
                if self._depth == 1:
                    self.CheckInterrupts()
        finally:
            self._depth -= 1

    def ByUser(self, function: Callable, *args) -> Any:
        """Call a function of the user; where it fails on one process, it fails on all."""
        depth, self._depth = self._depth, 0
        try:
            with self.interrupts.Let():
                return self.Agree(lambda: function(*args), BaseException)
        finally:
            self._depth = depth

    def CheckInterrupts(self) -> None:
        """Raise an interrupt of any of the processes on all."""
        if self.Reduce(self.interrupts.came, "LOR"):
            self.interrupts.came = False
            raise KeyboardInterrupt

    def _CallTheRoll(self, name: str, arguments: dict[str, Any]) -> None:
        """Raise if another process calls something else, or with other arguments."""
        lengths = self._Lengths(0, name)
        if LEFT in lengths:
            other = int(np.flatnonzero(lengths == LEFT)[0])
            raise OutOfStepError(
                f"process {self.rank} calls {name} while process {other} has ended: {RULE}"
            )
        every = self._roll.allgather((name, arguments))
        for other, (called, _) in enumerate(every):
            if called != every[0][0]:
                raise OutOfStepError(
                    f"process 0 calls {every[0][0]} while process {other} calls {called}: {RULE}"
                )
        for other, (_, theirs) in enumerate(every):
            if argument := Difference(every[0][1], theirs):
                values = every[0][1].get(argument), theirs.get(argument)
                raise ValueError(
                    f"{name}: {argument} = {values[0]!r} on process 0 and {values[1]!r} on process "
                    f"{other}: give the same on all"
                )

    def _Lengths(self, own: int, name: str) -> np.ndarray:
        """Gather a number of each process, and tell the user when some process comes late."""
        found = np.zeros(self.size, dtype=np.int64)
        request = self._roll.Iallgather(np.array([own], dtype=np.int64), found)
        end = time.monotonic() + PATIENCE
        while not request.Test():
            if time.monotonic() > end:
                end = math.inf
                print(
                    f"process {self.rank} has been waiting for {PATIENCE:g} s for others to call "
                    f"{name}, too: {RULE}",
                    file=sys.stderr,
                    flush=True,
                )
            time.sleep(1e-5)
        return found

    def _Leave(self) -> Iterator[None]:
        """Wait, at the end of a script, until all processes have ended theirs."""
        while True:
            found = np.zeros(self.size, dtype=np.int64)
            request = self._roll.Iallgather(np.array([LEFT], dtype=np.int64), found)
            while not request.Test():
                yield
            if np.all(found == LEFT):
                return

    # --- numbers -------------------------------------------------------------------------------

    def Reduce(self, values: Any, operation: str) -> Any:
        """Combine numbers or arrays of all processes; MPI gives the same bits to all."""
        from mpi4py import MPI

        array = np.ascontiguousarray(values)
        kind = array.dtype
        if kind.kind == "b":
            array = array.astype(np.int8)
        found = np.empty_like(array)
        self.comm.Allreduce(array, found, op=getattr(MPI, operation))
        found = found.astype(kind)
        return found if np.ndim(values) else found[()] if found.ndim == 0 else found.ravel()[0]

    def Sum(self, values: Any) -> Any:
        """Sum up values of all processes."""
        return self.Reduce(values, "SUM")

    def Gather(self, thing: Any) -> list:
        """Return a list of the things of all processes."""
        return self.comm.allgather(thing)

    def Tell(self, thing: Any) -> Any:
        """Return the thing of the first process."""
        return self.comm.bcast(thing)

    def Rows(self, array: np.ndarray, counts: np.ndarray | None = None) -> np.ndarray:
        """Join the rows of all processes; `counts` has their numbers where these are known."""
        array = np.ascontiguousarray(array)
        counts = np.array(self.comm.allgather(len(array))) if counts is None else counts
        found = np.empty((counts.sum(), *array.shape[1:]), array.dtype)
        self.comm.Allgatherv(array, (found, counts * int(np.prod(array.shape[1:]))))
        return found

    def First(self, work: Callable[[], Any]) -> Any:
        """Let the first process alone do the work; all return its result or raise its error."""
        return self.Tell(self.Agree(work if self.rank == 0 else lambda: None, Exception))

    def Agree(self, work: Callable[[], Any], *errors: type[BaseException]) -> Any:
        """Do the work; one of these errors that a process raises is raised by all."""
        found = error = None
        try:
            found = work()
        except errors as problem:
            error = problem
        first = int(self.Reduce(self.size if error is None else self.rank, "MIN"))
        if first == self.size:
            return found
        said = self.comm.bcast(Portable(error), root=first)
        raise error if self.rank == first else said


class Alone:
    """A single process, with the methods of Together."""

    rank, size = 0, 1

    def Call(self, *_) -> AbstractContextManager:
        """See Together; no other process has to make the call."""
        return nullcontext()

    def ByUser(self, function: Callable, *args) -> Any:
        """See Together."""
        return function(*args)

    def CheckInterrupts(self) -> None:
        """See Together; interrupts of a single process come at once."""

    def First(self, work: Callable[[], Any]) -> Any:
        """See Together."""
        return work()

    def Reduce(self, values: Any, _: str) -> Any:
        """See Together."""
        return values

    def Sum(self, values: Any) -> Any:
        """See Together."""
        return values

    def Gather(self, thing: Any) -> list:
        """See Together."""
        return [thing]

    def Tell(self, thing: Any) -> Any:
        """See Together."""
        return thing

    def Rows(self, array: np.ndarray) -> np.ndarray:
        """See Together."""
        return array

    def Agree(self, work: Callable[[], Any], *_) -> Any:
        """See Together."""
        return work()


ALONE = Alone()


def Recall(known: list, fits: Callable[[Any], bool], make: Callable[[], Any]) -> Any:
    """Find a thing among those used last, or make it; all processes do so alike."""
    found = next((thing for thing in known if fits(thing)), None)
    if found is None:
        found = make()
    else:
        known.remove(found)
    known.append(found)
    del known[:-KEPT]
    return found


def OnAll(find: Callable) -> Callable[[Called], Called]:
    """Decorate functions and methods that all processes of a distributed mesh call together.

    `find` takes all arguments and returns the mesh.
    """

    def Decorate(function: Called) -> Called:
        @wraps(function)
        def Everywhere(*args, **options) -> Any:
            try:
                mesh = find(*args, **options)
            except TypeError:  # a wrong call, which the function refuses
                mesh = None
            if mesh is None or mesh.comm.size == 1:
                return function(*args, **options)
            with Together.Of(mesh).Call(NameOf(function, args), Words(function, args, options)):
                return function(*args, **options)

        # So that tracers and profiles tell one function from the other.
        Everywhere.__code__ = Everywhere.__code__.replace(co_name=function.__name__)
        return Everywhere

    return Decorate


def NameOf(function: Callable, args: Sequence) -> str:
    """The name by which users know a function."""
    if function.__name__ == "MacroElements":
        return "LACSpace"
    if "." not in function.__qualname__:
        return function.__name__
    name = type(args[0]).__name__
    return name if function.__name__ == "__init__" else f"{name}.{function.__name__}"


def Words(function: Callable, args: Sequence, options: dict[str, Any]) -> dict[str, Any]:
    """Numbers and words among the arguments of a call, by their names."""
    try:
        known = inspect.signature(function).bind_partial(*args, **options).arguments
    except TypeError:  # a wrong call, which is refused where it is made
        return {}
    return {name: value for name, value in known.items() if name not in OWN and IsWord(value)}


def IsWord(value: Any) -> bool:
    """Whether an argument is a number, a word, nothing, or a list of these."""
    if isinstance(value, (list, tuple)):
        return all(map(IsWord, value))
    return value is None or isinstance(value, (bool, Real, str))


def Difference(ours: dict[str, Any], others: dict[str, Any]) -> str | None:
    """The name of an argument that differs between two processes; None if there is none."""
    missing = object()
    for name in [*ours, *others]:
        if not Alike(ours.get(name, missing), others.get(name, missing)):
            return name
    return None


def Alike(one: Any, other: Any) -> bool:
    """Whether two arguments are equal, but for the rounding of numbers."""
    if isinstance(one, (list, tuple)) and isinstance(other, (list, tuple)):
        return len(one) == len(other) and all(map(Alike, one, other))
    if isinstance(one, Real) and isinstance(other, Real):
        near = math.isclose(one, other, rel_tol=SAME, abs_tol=NOTHING)
        return near or (math.isnan(one) and math.isnan(other))
    return one == other


def Portable(error: BaseException) -> BaseException:
    """An error that can be sent to other processes: itself, or one of a similar kind."""
    try:
        pickle.loads(pickle.dumps(error))
    except Exception:
        kind = next((k for k in (NgException, ValueError) if isinstance(error, k)), RuntimeError)
        return kind(f"{type(error).__name__}: {error}" if kind is RuntimeError else str(error))
    return error
