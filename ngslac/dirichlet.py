# SPDX-License-Identifier: LGPL-2.1-or-later
"""Dirichlet conditions of displacement spaces that hold nothing: NGSolve accepts them silently."""

from collections.abc import Callable
from typing import Any

from ngsolve import BBBND, BBND, BND, FESpace, Mesh, ProductSpace, Region, VectorValued

from ngslac._ngslac import NamesInstead, Unmatched
from ngslac.errors import FloatingBodyError, Warn

__all__ = ["Blame", "KeepPatterns", "Unheld", "WarnOfUnheld"]

FLAG, KEPT = "dirichlet", "dirichlet_pattern"
COMPOUNDS = (ProductSpace, VectorValued)
KINDS = {"_bbbnd": (BBBND, "point"), "_bbnd": (BBND, "edge or point"), "": (BND, "boundary")}


def KeepPatterns() -> None:
    """Let spaces keep the pattern of dirichlet=, in place of which NGSolve keeps numbers."""
    treated = FESpace.__special_treated_flags__

    def Treated() -> dict[str, Callable]:
        """Return NGSolve's treatment of flags, which now keeps patterns of Dirichlet conditions."""
        known = dict(treated())
        replace = known[FLAG]

        def Keep(condition: Any, flags: Any, info: list) -> None:
            replace(condition, flags, info)
            if isinstance(condition, str):
                flags.Set(KEPT, condition)

        return known | {FLAG: Keep}

    FESpace.__special_treated_flags__ = staticmethod(Treated)


def Unheld(space: FESpace) -> str:
    """Describe Dirichlet conditions that hold nothing, or of which a part does not."""
    return "; ".join(filter(None, (_Words(space.mesh, *c) for c in _Conditions(space))))


def WarnOfUnheld(space: FESpace) -> str:
    """Warn with the text of `Unheld`, and return it."""
    words = Unheld(space)
    if words:
        Warn(words)
    return words


def Blame(error: Exception, words: str) -> None:
    """Add to the error about an unheld body which conditions hold nothing."""
    if isinstance(error, FloatingBodyError) and words and words not in str(error):
        error.args = (f"{error}. Note: {words}",)


def _Words(mesh: Mesh, name: str, condition: Region | str) -> str:
    """Describe the boundaries that a condition does not find; "" if it finds all of them."""
    vb, what = next(kind for end, kind in KINDS.items() if name.endswith(end))
    if isinstance(condition, Region):
        dead, shown = [] if condition.Mask().NumSet() else [""], "<Region>"
    else:
        dead, shown = Unmatched(mesh, vb, condition), repr(condition)
    if not dead:
        return ""
    some = isinstance(condition, str) and Region(mesh, vb, condition).Mask().NumSet()
    part = f"of which {', '.join(map(repr, dead))}" if some else "which"
    return (
        f"the displacement space has {name}={shown}, {part} matches no {what} and holds nothing; "
        f"the names are: {NamesInstead(mesh, vb, '|'.join(dead))}"
    )


def _Conditions(space: FESpace) -> list[tuple[str, Region | str]]:
    """Pairs of flag and pattern or region: of a space, or else of its components."""
    flags = {k: v for k, v in space.flags.ToDict().items() if k.startswith(FLAG)}
    if not flags:
        parts = space.components if isinstance(space, COMPOUNDS) else ()
        return list(dict.fromkeys(pair for part in parts for pair in _Conditions(part)))
    if KEPT in flags:
        flags[FLAG] = flags.pop(KEPT)
    return [(k, v) for k, v in flags.items() if isinstance(v, (str, Region))]
