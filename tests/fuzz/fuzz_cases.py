"""All cases, and how their outcomes are judged."""

import re
from collections.abc import Callable
from dataclasses import dataclass

from fuzz_kinds import VALUES
from fuzz_odd import ODD
from fuzz_reentrant import REENTRANT
from fuzz_reference import REFERENCE_TARGETS
from fuzz_solids import SOLIDS
from fuzz_strange import STRANGE
from fuzz_targets import TARGETS
from netgen.meshing import NgException

from ngslac import ContactConvergenceError

__all__ = ["AllCases", "Case"]

ERRORS = (ValueError, TypeError, OSError, IndexError, NgException, ContactConvergenceError)
# How the languages below complain: no word of the user's mistake.
RAW = re.compile(r"incompatible (function|constructor) arguments|object has no attribute|^$")


@dataclass(frozen=True)
class Case:
    """One call."""

    target: str
    name: str
    run: Callable  # run(world)
    words: tuple  # the message has to hold one of them
    legal: bool  # may it work?

    def Judge(self, error):
        """The outcome, and the message, of a call that ended with an error or with None."""
        if error is None:
            return ("harmless" if self.legal else "silent"), ""
        message = " ".join(str(error).split())
        text = f"{type(error).__name__}: {message}"
        if not isinstance(error, ERRORS) or RAW.search(message):
            return "unnamed", text
        if self.legal:
            return "harmless", text
        path = isinstance(error, OSError) and (error.filename or "/" in message)
        named = path or any(re.search(rf"\b{re.escape(w)}", message) for w in self.words)
        return ("named" if named else "unnamed"), text


def Crossed(target, every):

    def Run(world, name, label):
        target.call(world, **(target.given(world) | {name: VALUES[label](world)}))

    for name, label, legal in target.Cases(every):
        run = lambda world, name=name, label=label: Run(world, name, label)  # noqa: E731
        yield Case(target.name, f"{target.name}({name}={label})", run, (name,), legal)


def AllCases(every=False):
    """The cases, with all odd values for each argument if `every` is set."""
    for target in (*TARGETS, *REFERENCE_TARGETS):
        yield from Crossed(target, every)
    for name, run, words in (*ODD, *STRANGE, *REENTRANT, *SOLIDS):
        yield Case("odd uses" if words else "legal uses", name, run, words, not words)
