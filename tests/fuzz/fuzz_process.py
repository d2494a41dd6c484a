"""Cases in processes of their own, copies of one that has imported and built everything."""

import os
import resource
import signal
import sys
import tempfile

__all__ = ["RunAll"]

MEMORY = 16 << 30  # of addresses: a case that asks for more gets an error, not the machine
LONGEST = 2000  # of a message: it has to fit into a pipe
SEPARATOR = "\0"


def RunAll(cases, world, jobs, limit):
    """Yield (case, outcome, message) as they end; `limit` seconds each, `jobs` at a time."""
    running = {}
    for case in cases:
        if len(running) == jobs:
            yield Next(running)
        Start(case, world, limit, running)
    while running:
        yield Next(running)


def Start(case, world, limit, running):
    sys.stdout.flush()
    reading, writing = os.pipe()
    if not (child := os.fork()):
        os.close(reading)
        Child(case, world, limit, writing)
    os.close(writing)
    running[child] = case, reading


def Child(case, world, limit, writing):
    """Ends by itself: an error must not unwind into the code of the parent."""
    try:
        signal.signal(signal.SIGALRM, signal.SIG_DFL)
        signal.alarm(limit)
        resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))
        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
        nowhere = os.open(os.devnull, os.O_RDWR)
        for stream in (0, 1, 2):
            os.dup2(nowhere, stream)
        # Files of odd names may be written there, and read by no other case.
        os.chdir(tempfile.mkdtemp(dir=world.folder.name))
        error = None
        try:
            case.run(world)
        except BaseException as raised:
            error = raised
        outcome, message = case.Judge(error)
        text = f"{outcome}{SEPARATOR}{message[:LONGEST]}"
        os.write(writing, text.encode(errors="replace"))
    finally:
        os._exit(0)


def Next(running):
    child, status = os.wait()
    case, reading = running.pop(child)
    with os.fdopen(reading, "rb") as stream:
        outcome, _, message = stream.read().decode(errors="replace").partition(SEPARATOR)
    if os.WIFSIGNALED(status):
        number = os.WTERMSIG(status)
        outcome = "hang" if number == signal.SIGALRM else "crash"
        message = signal.Signals(number).name
    return case, outcome or "crash", message or ("no answer" if not outcome else "")
