"""What the commands share: command line, processes, tables, pictures, files."""

from __future__ import annotations

import argparse
import json
import multiprocessing
from concurrent.futures import ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager
from pathlib import Path

import numpy as np

__all__ = ["Columns", "Growth", "InProcess", "Markdown", "Parser", "Picture", "WriteJSON"]


def Parser(doc):
    """A command line; all have the option --json."""
    raw = argparse.RawDescriptionHelpFormatter
    parser = argparse.ArgumentParser(description=doc, formatter_class=raw)
    parser.add_argument("--json", metavar="FILE", help="write all figures to this file")
    return parser


def WriteJSON(file, figures):
    """Rows are objects with attributes or dictionaries; without a file nothing is written."""
    if file:
        Path(file).write_text(json.dumps(figures, indent=2, default=vars) + "\n")


def Columns(cells):
    """A line of a table that is printed as it grows."""
    return " ".join(f"{cell:>9}" for cell in cells)


def Markdown(head, rows):
    """A table: the first column to the left, numbers to the right."""
    widths = [max(map(len, column)) for column in zip(head, *rows, strict=True)]
    sides = ["<", *">" * (len(head) - 1)]
    lines = [
        "| " + " | ".join(f"{c:{s}{w}}" for c, s, w in zip(line, sides, widths, strict=True)) + " |"
        for line in (head, *rows)
    ]
    ruler = ["-" * (width + 2) for width in widths]
    lines.insert(1, "|" + "|".join([ruler[0], *(r[:-1] + ":" for r in ruler[1:])]) + "|")
    return lines


def InProcess(function, *args, **options):
    """Call a function in a new process; None if that was killed, as for lack of memory."""
    spawn = multiprocessing.get_context("spawn")
    try:
        with ProcessPoolExecutor(1, mp_context=spawn) as pool:
            return pool.submit(function, *args, **options).result()
    except BrokenProcessPool:
        return None


def Growth(n, values):
    """Exponent of n in the least squares line through the logarithms; nan for one point."""
    return float(np.polyfit(np.log(n), np.log(values), 1)[0]) if len(n) > 1 else float("nan")


@contextmanager
def Picture(file, title, rows, columns, **options):
    """Axes (rows, columns) to draw on, which are written to the file then."""
    import matplotlib

    matplotlib.use("Agg")
    from matplotlib import pyplot as plt

    options |= {"squeeze": False, "layout": "constrained"}
    figure, axes = plt.subplots(rows, columns, **options)
    yield axes
    figure.suptitle(title)
    figure.savefig(file, dpi=150)
    plt.close(figure)
