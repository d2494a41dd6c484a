# SPDX-License-Identifier: LGPL-2.1-or-later
"""The processes of a distributed mesh: the first one conducts, the others work for it.

NGSolve leaves the first process without elements. It runs the serial code of contact, Newton's
method and steppers, and orders from the others what only they can do: to evaluate forms on their
parts of the mesh, and to take part in linear solves. All messages go between the conductor and one
worker each, so that nobody waits for somebody who has failed.
"""

import sys
import time
from collections import defaultdict, deque

from ngslac.errors import Portable
from ngslac.parallel.interrupts import Interrupts
from ngslac.parallel.plain import Difference

__all__ = ["Crew", "OutOfStepError"]

# Kinds of messages to the conductor and from it.
ENTERED, DONE, FAILED, ORDER, END = "entered", "done", "failed", "order", "end"
LEFT = "left"  # of a worker whose script has ended

PATIENCE = 60.0  # seconds to wait for others without a word
RULE = "what belongs to a distributed mesh has to be called on all processes, in the same order"


class OutOfStepError(RuntimeError):
    """Processes have called different things."""


class Messages:
    """Messages between the conductor and one worker each; one that is early can be put back."""

    def __init__(self, comm):
        self.comm = comm.Dup()
        self._put_back = defaultdict(deque)

    def Send(self, rank, message):
        """Send what can be pickled."""
        self.comm.send(message, dest=rank)

    def Receive(self, rank, name=None):
        """The next message of a process, which may never come where it does not call `name`."""
        if self._put_back[rank]:
            return self._put_back[rank].popleft()
        if name is not None:
            self._Await(rank, name)
        return self.comm.recv(source=rank)

    def Has(self, rank):
        """Is there a message of a process?"""
        return bool(self._put_back[rank]) or self.comm.iprobe(source=rank)

    def _Await(self, rank, name):
        """Wait for a message, and say it when that takes long: others may be in calls of MPI."""
        end = time.monotonic() + PATIENCE
        while not self.comm.iprobe(source=rank):
            if time.monotonic() > end:
                print(
                    f"process {self.comm.rank} has been waiting for {PATIENCE:g} s for process "
                    f"{rank} to call {name}, too: {RULE}",
                    file=sys.stderr,
                    flush=True,
                )
                return
            time.sleep(1e-4)

    def PutBack(self, rank, message):
        """The next one is this one, once more."""
        self._put_back[rank].appendleft(message)


class Crew:
    """Runs calls that all processes make, and orders of the conductor in the middle of them."""

    def __init__(self, comm):
        self.messages = Messages(comm)
        # The conductor is the process without elements; workers carry out tasks by their names.
        self.conducts, self.workers = comm.rank == 0, range(1, comm.size)
        self.tasks, self._depth, self.interrupts = {}, 0, Interrupts()
        self._present = set(self.workers)

    def Call(self, name, work, arguments):
        """The result of `work` on the conductor, on all processes; workers serve meanwhile.

        `arguments` are the numbers and words by name that all have to call it with.
        """
        self._depth += 1
        try:
            if self.conducts:
                return self._Conduct(name, work, arguments)
            with self.interrupts.Held():
                return self._Serve(name, arguments)
        finally:
            self._depth -= 1

    def _Conduct(self, name, work, arguments):
        entered = []
        try:
            with self.interrupts.Held():
                self._Gather(name, entered, arguments)
            result, error = work(), None
        except BaseException as problem:
            result, error = None, problem
        for rank in entered:
            self.messages.Send(rank, (END, self._depth, result, Portable(error)))
        if error is not None:
            raise error
        return result

    def _Gather(self, name, entered, arguments):
        """Wait until all workers make this call; who makes any is noted in `entered`."""
        others, different = {}, None
        for rank in self.workers:
            message = kind, depth, called, *theirs = self._Hear(rank, self._depth, name)
            if depth < self._depth:
                self.messages.PutBack(rank, message)
            else:
                entered.append(rank)
            if (kind, depth, called) != (ENTERED, self._depth, name):
                does = {ENTERED: f"calls {called}", LEFT: "has ended"}
                others[rank] = does.get(kind, "calls nothing")
            elif argument := Difference(arguments, *theirs):
                values = arguments.get(argument), theirs[0].get(argument)
                different = (
                    f"{name}: {argument} = {values[0]!r} on process 0 and {values[1]!r} on process "
                    f"{rank}: give the same on all"
                )
        if others:
            rank, does = next(iter(others.items()))
            raise OutOfStepError(f"process 0 calls {name} while process {rank} {does}: {RULE}")
        if different:
            raise ValueError(different)

    def _Hear(self, rank, depth, name=None):
        """The next message of a worker at a depth; what it calls alone is refused."""
        while True:
            message = kind, at, *rest = self.messages.Receive(rank, name)
            if kind != ENTERED or at <= depth:
                return message
            error = OutOfStepError(
                f"process {rank} alone calls {rest[0]}: call it on all processes"
            )
            self.messages.Send(rank, (END, at, None, error))

    def _Serve(self, name, arguments):
        self.messages.Send(0, (ENTERED, self._depth, name, arguments))
        while True:
            kind, depth, *rest = self.messages.Receive(0, name)
            name = None  # it has come
            if kind == END and depth == self._depth:
                result, error = rest
                if error is not None:
                    self.interrupts.came = False
                    raise error
                return result
            if kind == ORDER and depth == self._depth:
                self._Obey(*rest)

    def _Obey(self, task, args):
        try:
            answer = DONE, self._depth, self.tasks[task](*args)
        except BaseException as error:
            answer = FAILED, self._depth, Portable(error)
        if self.interrupts.came:
            self.interrupts.came = False
            answer = FAILED, self._depth, KeyboardInterrupt()
        self.messages.Send(0, answer)

    def Order(self, task, *args, own=None, each=None):
        """What the workers' task returns, as a list, after that of the conductor."""
        with self.interrupts.Held():
            return self._Order(task, args, own, each)

    def _Order(self, task, args, own, each):
        for k, rank in enumerate(self.workers):
            special = () if each is None else (each[k],)
            self.messages.Send(rank, (ORDER, self._depth, task, (*args, *special)))
        answers, errors = [None], []
        try:
            answers[0] = own() if own else None
        except BaseException as error:
            errors.append(error)
        for rank in self.workers:
            kind, _, answer = self._Hear(rank, self._depth)
            (errors if kind == FAILED else answers).append(answer)
        if errors:  # where one fails, others only miss it
            raise min(errors, key=lambda error: isinstance(error, OutOfStepError))
        return answers

    # --- the end -------------------------------------------------------------------------------

    def Leave(self):
        """A worker calls nothing any more."""
        if not self.conducts:
            self.messages.Send(0, (LEFT, 0, None))

    def Dismiss(self):
        """Refuse what workers call of a conductor that has ended; False: some may call more."""
        if not self.conducts:
            return True
        for rank in sorted(self._present):
            while rank in self._present and self.messages.Has(rank):
                kind, at, called, *_ = self.messages.Receive(rank)
                if kind == LEFT:
                    self._present.remove(rank)
                elif kind == ENTERED:
                    error = OutOfStepError(
                        f"process {rank} calls {called} while process 0 has ended: {RULE}"
                    )
                    self.messages.Send(rank, (END, at, None, error))
        return not self._present
