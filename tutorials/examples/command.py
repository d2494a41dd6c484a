"""What the examples share: the command line, the numbers of the steps, pictures."""

import argparse
import inspect
import json
import math
import os
import time
from contextlib import contextmanager, redirect_stderr, redirect_stdout
from importlib.util import find_spec
from pathlib import Path

from ngslac import ContactConvergenceError


def Communicator():
    """That of the processes that mpiexec has started; None in a single one."""
    sizes = (os.environ.get(name, "1") for name in ("OMPI_COMM_WORLD_SIZE", "PMI_SIZE"))
    if not any(int(size) > 1 for size in sizes):
        return None
    from mpi4py import MPI

    return MPI.COMM_WORLD


def Speaks():
    """Is this the process that prints and writes? There is one."""
    comm = Communicator()
    return comm is None or comm.rank == 0


@contextmanager
def Ordered():
    """Nothing is printed but by one process."""
    if Speaks():
        yield
        return
    with open(os.devnull, "w") as nowhere, redirect_stdout(nowhere), redirect_stderr(nowhere):
        yield


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
    """Call ``run(**options)``, which returns a dict of numbers; write and return them.

    What failed when there were some numbers is a text among them, and the end of the script. Of
    several processes one prints and writes.
    """
    with Ordered():
        return _Start(run, parser, arguments)


def _Start(run, parser, arguments):
    options = vars(parser.parse_args(arguments))
    file = options.pop("json")
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
    figures["seconds"] = time.perf_counter() - start
    if file and Speaks():
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(json.dumps(figures, indent=2, default=float) + "\n")
    if figures.get("failure"):
        raise Ended(figures["failure"])
    return figures


def Ended(text):
    """The end of the script, with a text of one process."""
    return SystemExit(text if Speaks() else 1)


def Main(run, text, *others, **options):
    """The ``main`` of an example: ``name=(kind, help)`` is the option --name.

    The kind is a type, or a tuple of choices, or bool for a switch. Defaults are those of the
    arguments of `run`, or of `others` that it calls; a tuple stands for as many values, or for some
    of the choices.
    """
    arguments_of = [inspect.signature(call).parameters for call in (*others, run)]
    defaults = {name: p.default for found in arguments_of for name, p in found.items()}

    def main(arguments=None):
        parser = Options(text)
        for name, (kind, about) in options.items():
            default = defaults[name]
            flags = {"default": default, "help": about}
            if kind is bool:
                flags["action"] = "store_true"
            elif isinstance(kind, tuple):
                flags |= {"type": type(kind[0]), "choices": kind}
            else:
                flags["type"] = kind
            if isinstance(default, tuple):
                flags["nargs"] = "+" if isinstance(kind, tuple) else len(default)
            parser.add_argument("--" + name.replace("_", "-"), **flags)
        return Start(run, parser, arguments)

    return main


def Columns(rows):
    """Each number of the steps as a list."""
    return {name: [row[name] for row in rows] for name in rows[0]}


@contextmanager
def _Figure(folder, name, size):
    """A new figure, which is then written to a folder."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=size, layout="constrained")
    yield figure
    if not Speaks():
        return
    folder.mkdir(parents=True, exist_ok=True)
    figure.savefig(folder / f"{name}.png", dpi=150)


@contextmanager
def Picture(folder, name, rows=1, columns=1, size=None, **options):
    """The axes of a new picture, which is then written to a folder."""
    with _Figure(folder, name, size) as figure:
        yield figure.subplots(rows, columns, **options)


@contextmanager
def Mosaic(folder, name, layout, size=None, **options):
    """The axes by name of a new picture of panels, which is then written to a folder."""
    with _Figure(folder, name, size) as figure:
        yield figure.subplot_mosaic(layout, **options)
