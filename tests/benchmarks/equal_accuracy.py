"""Times at equal accuracy: each peer beside the fastest run of ngslac that errs no more.

Only runs of the same order of elements are compared. Where the exact solution is not that of the
problem (Hertz' half-spaces, the friction left out) errors below the distance of the two, the
`floor` of a case, say nothing: there all count as equal.
"""

from __future__ import annotations

from dataclasses import dataclass

from benchmark_frame import Markdown

__all__ = ["Match", "MatchTable", "Matches"]


@dataclass(frozen=True)
class Match:
    """A run of a peer and the run of ngslac beside it; None: none errs so little."""

    peer: dict
    own: dict | None


def Error(case, row):
    """What decides; of two pressures that a program has the better one."""
    return min(row[name] for name in case.decisive if name in row)


def Matches(case, rows):
    """A `Match` for each run of a peer, in the order of `rows`."""
    ours = sorted((row for row in rows if row["peer"] == "ngslac"), key=lambda row: row["seconds"])
    return [Match(row, Fastest(case, row, ours)) for row in rows if row["peer"] != "ngslac"]


def Fastest(case, peer, ours):
    bound = max(Error(case, peer), case.floor)
    good = (row for row in ours if row["order"] == peer["order"] and Error(case, row) <= bound)
    return next(good, None)


def MatchTable(case, rows, form):
    """Lines of Markdown; `form` writes an error."""
    head = ["", "order", "error", "time s", "cpu s", "ngslac: h", "error", "time s", "cpu s"]
    cells = [Cells(case, match, form) for match in Matches(case, rows)]
    return [*Markdown([*head, "time ratio", "cpu ratio"], cells), ""] if cells else []


def Cells(case, match, form):
    peer, own = match.peer, match.own
    cells = [f"{peer['title']}, h = {peer['h']:g}", f"P{peer['order']}", *Figures(case, peer, form)]
    if own is None:
        return [*cells, "none errs so little", *["-"] * 5]
    ratios = (f"{peer[name] / own[name]:.1f}" for name in ("seconds", "cpu"))
    return [*cells, f"{own['title']}, {own['h']:g}", *Figures(case, own, form), *ratios]


def Figures(case, row, form):
    return [form(Error(case, row)), *(f"{row[name]:.2f}" for name in ("seconds", "cpu"))]
