"""The tables of `compare.py`."""

from __future__ import annotations

from dataclasses import dataclass

__all__ = ["Missing", "Table"]


@dataclass(frozen=True)
class Missing:
    """A run without a result, and why."""

    title: str
    h: float
    reason: str


def Table(case, rows, missing):
    """The result of a case as Markdown: a table sorted by time, notes, and what is missing."""
    head = ["", "order", "h", "dofs", "iterations", "time s", "cpu s", "GB", *case.errors]
    cells = [Cells(case, row) for row in sorted(rows, key=lambda r: (-r["h"], r["seconds"]))]
    widths = [max(len(line[i]) for line in [head, *cells]) for i in range(len(head))]
    lines = [f"### {case.title}", ""]
    if cells:
        ruler = ["-" * width + ("-" if i == 0 else ":") for i, width in enumerate(widths)]
        lines += [Line(head, widths), "|" + "|".join(f"-{r}" for r in ruler) + "|"]
        lines += [Line(line, widths) for line in cells] + [""]
    notes = {row["title"]: f"{row['title']} {row['version']}: {row['settings']}" for row in rows}
    lines += [f"- {note}" for note in notes.values()]
    lines += [f"- missing: {m.title} (h = {m.h:g}): {m.reason}" for m in missing]
    return "\n".join(lines) + "\n"


def Line(cells, widths):
    """A line of a Markdown table: the first column to the left, numbers to the right."""
    first, *numbers = zip(cells, widths, strict=True)
    return (
        " | ".join([f"| {first[0]:<{first[1]}}", *(f"{cell:>{width}}" for cell, width in numbers)])
        + " |"
    )


def Cells(case, row):
    """The cells of a row."""
    figures = [f"P{row['order']}", f"{row['h']:g}", str(row["dofs"]), str(row["iterations"])]
    figures += [f"{row['seconds']:.2f}", f"{row['cpu']:.2f}", f"{row['memory']:.2f}"]
    return [row["title"], *figures, *(Percent(row[name]) for name in case.errors)]


def Percent(value):
    """A relative error in per cent; of very small ones the size."""
    if abs(value) < 1e-5:
        return f"{100 * value:.0e} %"
    return f"{100 * value:.2f} %" if abs(value) >= 1e-3 else f"{100 * value:.3f} %"
