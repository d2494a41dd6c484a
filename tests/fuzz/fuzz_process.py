"""Cases in processes of their own, copies of one that has imported and built everything."""

import os
import resource
import signal
import sys
import tempfile

__all__ = ["Processes"]

MEMORY = 16 << 30  # of addresses: a case that asks for more gets an error, not the machine
LONGEST = 2000  # of a message: it has to fit into a pipe
SEPARATOR = "\0"


class Processes:
    """Runs cases on copies of a world.

    Parameters
    ----------
    world : World
    jobs : int
        Processes at a time.
    limit : int
        Seconds until a case counts as one that hangs.
    """

    def __init__(self, world, jobs, limit):
        self.world, self.jobs, self.limit = world, jobs, limit
        self.running = {}

    def Run(self, cases):
        """Yield (case, outcome, message) as they end."""
        for case in cases:
            if len(self.running) == self.jobs:
                yield self._Next()
            self._Start(case)
        while self.running:
            yield self._Next()

    def _Start(self, case):
        sys.stdout.flush()
        reading, writing = os.pipe()
        if not (child := os.fork()):
            os.close(reading)
            self._Child(case, writing)
        os.close(writing)
        self.running[child] = case, reading

    def _Child(self, case, writing):
        """Ends by itself: an error must not unwind into the code of the parent."""
        try:
            signal.signal(signal.SIGALRM, signal.SIG_DFL)
            signal.alarm(self.limit)
            resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))
            resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
            nowhere = os.open(os.devnull, os.O_RDWR)
            for stream in (0, 1, 2):
                os.dup2(nowhere, stream)
            # Files of odd names may be written there, and read by no other case.
            os.chdir(tempfile.mkdtemp(dir=self.world.folder.name))
            try:
                case.run(self.world)
                error = None
            except BaseException as raised:
                error = raised
            outcome, message = case.Judge(error)
            text = f"{outcome}{SEPARATOR}{message[:LONGEST]}"
            os.write(writing, text.encode(errors="replace"))
        finally:
            os._exit(0)

    def _Next(self):
        child, status = os.wait()
        case, reading = self.running.pop(child)
        with os.fdopen(reading, "rb") as stream:
            outcome, _, message = stream.read().decode(errors="replace").partition(SEPARATOR)
        if os.WIFSIGNALED(status):
            number = os.WTERMSIG(status)
            outcome = "hang" if number == signal.SIGALRM else "crash"
            message = signal.Signals(number).name
        return case, outcome or "crash", message or ("no answer" if not outcome else "")
