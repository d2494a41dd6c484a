"""The frame of every example: the options of the command line, and what it does with numbers."""

import argparse
import inspect
import json
import math
import os
import re
import sys
import time
from contextlib import ExitStack, redirect_stderr, redirect_stdout
from importlib.util import find_spec
from pathlib import Path
from typing import get_args

from ngslac import ContactConvergenceError


def Communicator():
    """That of the processes that mpiexec has started; None in a single one."""
    if not any(int(os.environ.get(name, 1)) > 1 for name in ("OMPI_COMM_WORLD_SIZE", "PMI_SIZE")):
        return None
    from mpi4py import MPI

    return MPI.COMM_WORLD


def Speaks():
    """Is this the process that prints and writes? There is one."""
    comm = Communicator()
    return comm is None or comm.rank == 0


def Number(kind, holds, words):
    """Reads a number from the command line."""

    def Parse(text):
        value = kind(text)
        if not holds(value):
            raise argparse.ArgumentTypeError(f"{text} is no {words}")
        return value

    Parse.__name__ = words  # argparse says it where the text is no number
    return Parse


Positive = Number(float, lambda value: 0 < value < math.inf, "finite number > 0")
NotNegative = Number(float, lambda value: 0 <= value < math.inf, "finite number >= 0")
Count = Number(int, lambda value: value >= 1, "whole number >= 1")
KINDS = {float: Positive, int: Count, str: str}


class Help(argparse.ArgumentDefaultsHelpFormatter, argparse.RawDescriptionHelpFormatter):
    """Text as it is written, and the default of each option."""


def Options(run):
    """A parser with an option for each argument that has a line ``name : text`` in the docstring.

    What it takes follows from the default: a positive number, as many of them as a tuple has, or
    nothing for a switch; an annotation is a function that reads the text, or a Literal.
    """
    text = sys.modules[run.__module__].__doc__
    parser = argparse.ArgumentParser(description=text, formatter_class=Help)
    parser.add_argument("--out", metavar="DIR", type=Path, help="write pictures and files there")
    parser.add_argument("--json", metavar="FILE", type=Path, help="write the numbers to it")
    parser.add_argument("--quiet", action="store_true", help="print nothing")
    arguments = inspect.signature(run).parameters
    for name, about in re.findall(r"^ *(\w+) : (.+)", run.__doc__ or "", re.MULTILINE):
        default, kind = arguments[name].default, arguments[name].annotation
        flags = {"default": default, "help": about}
        if isinstance(default, bool):
            flags["action"] = "store_true"
        elif choices := get_args(kind):
            flags |= {"type": type(choices[0]), "choices": choices}
        else:
            one = default[0] if isinstance(default, tuple) else default
            flags["type"] = KINDS[type(one)] if kind is inspect.Parameter.empty else kind
        if isinstance(default, tuple):
            flags["nargs"] = "+" if get_args(kind) else len(default)
        parser.add_argument("--" + name.replace("_", "-"), **flags)
    return parser


def Main(run):
    """The ``main`` of an example: calls ``run(out=..., **options)`` for a dict of numbers.

    It writes and returns them, without the "solution", which tests look at. What failed when there
    were some numbers is the text "failure" among them, and the end of the script. Of several
    processes one prints and writes. In a script it is called at once.
    """

    def main(arguments=None):
        with ExitStack() as stack, open(os.devnull, "w") as nowhere:
            if not Speaks():
                stack.enter_context(redirect_stderr(nowhere))
                stack.enter_context(redirect_stdout(nowhere))
            parser = Options(run)
            options = vars(parser.parse_args(arguments))
            if options.pop("quiet"):
                stack.enter_context(redirect_stdout(nowhere))
            return _Start(run, parser, options.pop("json"), options)

    if run.__module__ == "__main__":
        main()
    return main


def _Start(run, parser, file, options):
    if options["out"] and not find_spec("matplotlib"):  # said before the work, not after it
        parser.error("--out: the pictures need matplotlib: pip install matplotlib")
    start = time.perf_counter()
    try:
        figures = run(**options)
    except KeyboardInterrupt:
        raise Ended("interrupted") from None
    except ContactConvergenceError as error:
        raise Ended(str(error)) from None
    except ValueError as error:
        parser.error(str(error))
    figures.pop("solution", None)
    figures["seconds"] = time.perf_counter() - start
    if file and Speaks():
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(json.dumps(figures, indent=2, default=lambda array: array.tolist()) + "\n")
    if figures.get("failure"):
        raise Ended(figures["failure"])
    return figures


def Ended(text):
    """The end of the script, with a text of one process."""
    return SystemExit(text if Speaks() else 1)
