# SPDX-License-Identifier: LGPL-2.1-or-later
"""The converged steps of a load stepper, recorded for derivatives."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

import numpy as np
from ngsolve import GridFunction

from ngslac.arguments import CheckFunction, CheckInstance
from ngslac.errors import RefuseCopy
from ngslac.steps.load import LoadStepper, Step

__all__ = ["Record", "Stage"]


@dataclass(frozen=True)
class Stage:
    """A converged step: load, its length, and the solution (n,)."""

    load: float | None
    dt: float
    values: np.ndarray = field(repr=False)
    step: object = None


class Record:
    """Notes the steps of a `LoadStepper`: the callback of its `Integrate`.

    Make it before the first step, in the state from which the steps go on.

    Parameters
    ----------
    stepper : LoadStepper
    commit : callable, optional
        Called with each converged `Step`, as the callback of `Integrate` would be: it accepts what
        the bulk remembers, such as plastic strains. It is called again where derivatives are made.
    memory : list of GridFunction
        All that `commit` changes.

    Attributes
    ----------
    stages : list
        The steps so far.

    Raises
    ------
    TypeError, ValueError
        If `stepper` is none, or `memory` holds no GridFunctions.

    Examples
    --------
    >>> from ngslac.analysis import Record
    >>> load.Set(0)
    >>> stepper = LoadStepper(solver, load)
    >>> record = Record(stepper)
    >>> steps = stepper.Integrate(steps=2, callback=record, printing=False)
    >>> len(record.stages)
    2
    """

    __deepcopy__ = __reduce_ex__ = RefuseCopy

    def __init__(
        self,
        stepper: LoadStepper,
        *,
        commit: Callable[[Step], object] | None = None,
        memory: Sequence[GridFunction] = (),
    ):
        CheckInstance("stepper", stepper, LoadStepper, "a LoadStepper")
        if stepper.solver.gf.space.mesh.comm.size > 1:
            raise ValueError("stepper is that of a distributed mesh: differentiate in one process")
        CheckFunction("commit", commit)
        self.memory = list(memory)
        for each in self.memory:
            CheckInstance("memory", each, GridFunction, "a list of GridFunctions")
        self.stepper, self.solver, self.commit = stepper, stepper.solver, commit
        self.stages, self._first = [], len(stepper.steps)
        contacts = self.solver.contacts
        self.states = [contact.State() for contact in contacts]
        self.fresh = all(contact._accepted is None for contact in contacts)
        self.kept = [each.vec.FV().NumPy().copy() for each in self.memory]
        self.begin = stepper.load.Get()

    def __repr__(self) -> str:
        return f"<Record: {len(self.stages)} steps of {self.stepper!r}>"

    def __call__(self, step: Step) -> None:
        """Note a step; called by `Integrate`.

        Parameters
        ----------
        step : Step
        """
        if step.number != self._first + len(self.stages) + 1:
            raise ValueError(
                f"step {step.number} does not follow the {len(self.stages)} of the record: make a "
                "new Record before Integrate, and give it as the callback each time"
            )
        values = self.solver.gf.vec.FV().NumPy().copy()
        self.stages.append(Stage(step.time, self.solver.contacts[0].dt.Get(), values, step))
        if self.commit:
            self.commit(step)
