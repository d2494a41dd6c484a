"""Runs cases in one process, or in each of those that mpiexec starts, and writes the numbers.

``python parallel_worker.py FILE FOLDER [--comm] [--saved FILE] CASE ...``: a line of JSON per case,
of the first process, as soon as all have ended it. With --comm the mesh is distributed to all.
"""

import argparse
import contextlib
import io
import json
import time
import traceback
from pathlib import Path

import numpy as np
import parallel_files
import parallel_finite
import parallel_misuse
import parallel_more
import parallel_other
import parallel_small
from parallel_world import CASES, World

from ngslac.solve.system import System

MODULES = (
    parallel_small,
    parallel_finite,
    parallel_files,
    parallel_misuse,
    parallel_more,
    parallel_other,
)


def plain(value):
    """Numbers and names as JSON has them."""
    return value if isinstance(value, str) else np.asarray(value).tolist()


def attempt(name, world, complaints):
    """What a case returns, or what it raised; and what it printed.

    What was raised goes to the file of complaints at once: the others may wait for ever.
    """
    begin, said = time.perf_counter(), io.StringIO()
    found = {"values": {}, "error": None}
    try:
        with contextlib.redirect_stdout(said):
            values = CASES[name](world)
        found["values"] = {
            key: (plain(value), None if size is None else float(size))
            for key, (value, size) in values.items()
        }
    except Exception as error:
        found["error"] = f"{type(error).__name__}: {error}"
        found["trace"] = traceback.format_exc()
        with complaints.open("a") as file:
            file.write(f"rank {world.rank}, {name}: {found['trace']}\n")
    return found | {"said": said.getvalue(), "seconds": time.perf_counter() - begin}


def together(found, comm):
    """What the first process found, and in which ranks there is something else."""
    everywhere = [found] if comm is None else comm.gather(found)
    if everywhere is None:
        return None
    first = everywhere[0]
    texts = [json.dumps((each["values"], each["error"])) for each in everywhere]  # NaN is NaN there
    first["other"] = [rank for rank, text in enumerate(texts) if text != texts[0]]
    first["errors"] = [each["error"] for each in everywhere]
    first["talkers"] = [rank for rank, each in enumerate(everywhere) if rank and each["said"]]
    return first


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("file", type=Path)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--comm", action="store_true")
    parser.add_argument("--saved", type=Path)
    parser.add_argument("cases", nargs="+")
    given, comm = parser.parse_args(), None
    if given.comm:
        from mpi4py import MPI

        comm = MPI.COMM_WORLD
    if comm is None:  # takes as many linear systems as the others
        System.ContactCorrection = lambda *_: None
    world = World(given.folder, comm, given.saved)
    if world.rank == 0:
        given.file.touch()  # all are there
    for name in given.cases:
        found = together(attempt(name, world, given.file.with_suffix(".errors")), comm)
        if found is not None:
            with given.file.open("a") as file:
                file.write(json.dumps({"case": name} | found) + "\n")


if __name__ == "__main__":
    main()
