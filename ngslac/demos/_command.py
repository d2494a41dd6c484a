"""What the command lines of the demos share."""

from __future__ import annotations

import argparse
import json
from pathlib import Path

__all__ = ["CommandParser", "RunCommand", "WriteJSON"]


def CommandParser(name, text):
    """Parser of ``python -m ngslac.demos.<name>`` with the options that every demo has."""
    parser = argparse.ArgumentParser(prog=f"python -m ngslac.demos.{name}", description=text)
    parser.formatter_class = argparse.RawDescriptionHelpFormatter
    parser.add_argument("--json", metavar="FILE", help="write the figures to this file")
    parser.add_argument("--quiet", action="store_true", help="print nothing")
    return parser


def RunCommand(run, options):
    """Call ``run(**options)`` and write its figures where ``json`` says.

    Parameters
    ----------
    run : callable
        Returns results with `figures`, and maybe with a `failure` that ends the command.
    options : dict
        Of the parsed command line, ``json`` among them.
    """
    file = options.pop("json")
    results = run(**options)
    if file:
        WriteJSON(results.figures, file)
    if getattr(results, "failure", None):
        raise SystemExit(results.failure)
    return results


def WriteJSON(figures, file):
    """Write figures to a file, whose directory is made."""
    Path(file).parent.mkdir(parents=True, exist_ok=True)
    Path(file).write_text(json.dumps(figures, indent=2, default=float) + "\n")
