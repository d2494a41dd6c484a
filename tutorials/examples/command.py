"""The command line that the examples share."""

import argparse
import json
import math
from importlib.util import find_spec
from pathlib import Path

from ngslac import ContactConvergenceError

__all__ = ["Count", "NotNegative", "Options", "Positive", "Start"]


class Help(argparse.ArgumentDefaultsHelpFormatter, argparse.RawDescriptionHelpFormatter):
    """Text as it is written, and the default of each option."""


def Options(text):
    """A parser with what every example takes."""
    parser = argparse.ArgumentParser(description=text, formatter_class=Help)
    parser.add_argument("--out", metavar="DIR", type=Path, help="write pictures and files there")
    parser.add_argument("--json", metavar="FILE", type=Path, help="write the numbers to this file")
    parser.add_argument("--quiet", action="store_true", help="print nothing")
    return parser


def Positive(text):
    """A finite number > 0."""
    value = float(text)
    if not 0 < value < math.inf:
        raise argparse.ArgumentTypeError(f"{text} is no finite number > 0")
    return value


def NotNegative(text):
    """A finite number >= 0."""
    value = float(text)
    if not 0 <= value < math.inf:
        raise argparse.ArgumentTypeError(f"{text} is no finite number >= 0")
    return value


def Count(text):
    """A whole number >= 1."""
    value = int(text)
    if value < 1:
        raise argparse.ArgumentTypeError(f"{text} is less than 1")
    return value


def Start(run, parser, arguments=None):
    """Call ``run(**options)``, which returns a dict of numbers; write and return them."""
    options = vars(parser.parse_args(arguments))
    file = options.pop("json")
    if options["out"] and not find_spec("matplotlib"):  # said before the work, not after it
        parser.error("--out: the pictures need matplotlib: pip install matplotlib")
    try:
        figures = run(**options)
    except KeyboardInterrupt:
        raise SystemExit("interrupted") from None
    except ContactConvergenceError as error:
        raise SystemExit(str(error)) from None
    except ValueError as error:
        parser.error(str(error))
    if file:
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(json.dumps(figures, indent=2, default=float) + "\n")
    return figures
