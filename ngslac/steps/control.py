# SPDX-License-Identifier: LGPL-2.1-or-later
"""The length of the next step, and the record of those that converged."""

from __future__ import annotations

import logging
import math
from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any

from ngslac.progress import Progress, Say, ShowLive
from ngslac.solve.callback import TellStep
from ngslac.solve.snapshot import Snapshot

if TYPE_CHECKING:
    from ngsolve import GridFunction, Parameter

__all__ = ["Journal", "StepControl", "StepLine"]

# Relative length of a remainder that is no step of its own.
REST = 1e-9


class StepControl:
    """Goals on the way to a target: nearer ones where a step fails."""

    def __init__(self, begin: float, target: float, maxcuts: int, size: float = math.inf):
        self.at, self.target, self.full = begin, target, target - begin
        self.size = math.copysign(min(abs(self.full), size), self.full)
        self.least, self.cuts = 0.99 * abs(self.full) * 0.5**maxcuts, 0

    @property
    def done(self) -> bool:
        """Is this the target?"""
        return self.at == self.target

    @property
    def goal(self) -> float:
        """Where the next step leads."""
        left = abs(self.target - self.at)
        return self.target if abs(self.size) >= (1 - REST) * left else self.at + self.size

    @property
    def half(self) -> float:
        """Half of the next step."""
        return (self.goal - self.at) / 2

    @property
    def smallest(self) -> bool:
        """Is half of the next step too short?"""
        return abs(self.half) < self.least

    def Reached(self, goal: float) -> int:
        """Go on from there; returns how many steps have failed before."""
        cuts, self.at, self.cuts = self.cuts, goal, 0
        return cuts


def StepLine(step: Any, name: str) -> str:
    """The beginning of the line of a Step or TimeStep, whose parameter has this name."""
    halved = f"  halved {step.cuts} times" if step.cuts else ""
    return f"step {step.number}  {name} {step.time:g}  {step.iterations} iterations{halved}"


class Journal:
    """The converged steps of a tool; no state before that after the last can be restored."""

    def __init__(self, tool: Any, name: str, parameter: Parameter):
        self.tool, self.name, self.parameter = tool, name, parameter

    def Begin(self) -> Snapshot:
        """Take the present state as the one to go back to; returns it."""
        self.saved = Snapshot(self.tool)
        return self.saved

    def Run(
        self,
        targets: Sequence[float],
        reach: Callable[[float], list],
        prepare: Callable[[], object] = lambda: None,
    ) -> list:
        """Reach one target after the other; after any error the state is that of the last step."""
        before = begun = self.Begin()
        done, name = [], f"contact: {self.name} steps"
        try:
            prepare()
            begun = self.Begin()
            with Progress(name, self.parameter.Get(), targets[-1]) as self.progress:
                for target in targets:
                    done += reach(target)
        except BaseException:
            (before if self.saved is begun else self.saved).Restore()
            raise
        return done

    def Add(
        self, step: Any, callback: Callable[[Any], object] | None, **fields: GridFunction
    ) -> Any:
        """Record a step, and report it."""
        self.tool.steps.append(step)
        logging.getLogger("ngslac").info("%s", step)
        if self.tool.printing == "steps":
            ShowLive("")
            Say(step)
        elif not self.tool.printing:
            ShowLive(f"{step}\n")
        self.saved = Snapshot(self.tool)
        self.progress.At(step.time)
        if callback:
            TellStep(callback, step, self.name, self.parameter, **fields)
            self.saved = Snapshot(self.tool)  # which may have changed something
        return step
