"""Starts the cases in one process or under mpiexec, and sees to it that none hangs."""

import json
import os
import shutil
import signal
import subprocess
import sys
import time
from glob import glob
from importlib.util import find_spec
from pathlib import Path

WORKER = Path(__file__).with_name("parallel_worker.py")
START = 60.0  # more seconds for what comes before the first case, above all imports
PETSC = "/usr/lib/petscdir/*/*/lib/python3/dist-packages/petsc4py"  # Debian hides it there
# Of Open MPI: more processes than cores, which then must not wait busily; as root in a container.
OPTIONS = ("--oversubscribe", "--bind-to", "none")
ENVIRONMENT = {
    "OMPI_ALLOW_RUN_AS_ROOT": "1",
    "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1",
    "OMPI_MCA_mpi_yield_when_idle": "1",
    "OMP_NUM_THREADS": "1",
    "OPENBLAS_NUM_THREADS": "1",
    "NGS_NUM_THREADS": "1",
}


def missing():
    """What a distributed run lacks here, in words; None: nothing."""
    if not shutil.which("mpiexec"):
        return "there is no mpiexec"
    lacks = [] if find_spec("mpi4py") else ["mpi4py"]
    lacks += [] if find_spec("petsc4py") or glob(PETSC) else ["petsc4py"]
    return f"there is no {lacks[0]} for {sys.executable}" if lacks else None


def command(ranks, file, folder, saved, cases):
    """Of the serial run for 0 ranks."""
    start = ["mpiexec", *OPTIONS, "-n", str(ranks)] if ranks else []
    given = [*(["--comm"] if ranks else []), *(["--saved", str(saved)] if saved else [])]
    return [*start, sys.executable, str(WORKER), str(file), str(folder), *given, *cases]


def done(file):
    """What the cases that have ended have left."""
    text = file.read_text() if file.exists() else ""
    lines = text[: text.rfind("\n") + 1].splitlines()  # the last one may be half written
    return {found["case"]: found for found in map(json.loads, lines)}


def end(process):
    """End mpiexec and what it has started."""
    os.killpg(process.pid, signal.SIGTERM)
    try:
        process.wait(10)
    except subprocess.TimeoutExpired:
        os.killpg(process.pid, signal.SIGKILL)
        process.wait()


def watch(process, file, limit):
    """Wait until the process ends, or ends nothing within the limit; False: it hung."""
    count, since, allowed = -1, time.monotonic(), START + limit
    while process.poll() is None:
        time.sleep(0.05)
        now = len(done(file)) if file.exists() else -1
        if now > count:
            count, since, allowed = now, time.monotonic(), limit
        elif time.monotonic() - since > allowed:
            end(process)
            return False
    return True


def attempt(ranks, cases, file, folder, saved, limit):
    """Start processes for some cases; returns what the one at which they ended is charged with."""
    log = file.with_suffix(".log")
    with log.open("a") as said:
        process = subprocess.Popen(
            command(ranks, file, folder, saved, cases),
            stdout=said,
            stderr=subprocess.STDOUT,
            env=os.environ | ENVIRONMENT,
            cwd=folder,
            start_new_session=True,
        )
        ended = watch(process, file, limit)
    errors = file.with_suffix(".errors")
    raised = errors.read_text()[-2000:] if errors.exists() else ""
    if not ended:
        return f"hangs: nothing for {limit:g} s; {raised}"
    return f"ends with {process.returncode}: {log.read_text()[-2000:]}{raised}"


def run(ranks, cases, folder, *, saved=None, limit=30.0):
    """{case: what it found}, or what went wrong as its "failure", on a number of ranks."""
    file, left, found = folder / f"cases{ranks}.json", list(cases), {}
    while left:
        file.unlink(missing_ok=True)
        file.with_suffix(".errors").unlink(missing_ok=True)
        charge = attempt(ranks, left, file, folder, saved, limit)
        found |= done(file)
        left = [case for case in left if case not in found]
        if left:  # go on after the one that failed
            found[left.pop(0)] = {"failure": charge}
    return found
