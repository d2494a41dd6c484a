"""Files of tests, each in an instrumented process of its own."""

import re
import subprocess
import sys
import tempfile
import time
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field
from pathlib import Path

from sanitizer_findings import Finding, Findings

__all__ = ["Outcome", "RunCommand", "RunTests"]

COUNT = re.compile(r"(\d+) (passed|failed|skipped|error)")
SUMMARY = re.compile(r"^.*\d+ (?:passed|failed|skipped|error).* in [\d.]+s", re.MULTILINE)
FAILED = re.compile(r"^(?:FAILED|ERROR) .*|^E   .*Error: .*", re.MULTILINE)
ENDS = {0: "", 1: "", 5: ""}  # exit codes of pytest: all passed, some failed, none collected


@dataclass
class Outcome:
    """What became of one file of tests.

    Attributes
    ----------
    name : str
    counts : dict
        How many tests passed, failed, were skipped.
    failed : list of str
        Tests that failed, and what pytest says of that.
    findings : list of Finding
    seconds : float
    ended : str
        Empty, or how the process ended before its time.
    """

    name: str
    counts: dict[str, int] = field(default_factory=dict)
    failed: list[str] = field(default_factory=list)
    findings: list[Finding] = field(default_factory=list)
    seconds: float = 0
    ended: str = ""


def RunTests(files, environment, jobs, limit):
    """Yield an `Outcome` for each file, in the order given.

    Parameters
    ----------
    files : list of Path
    environment : dict
    jobs : int
        Processes at a time.
    limit : float
        Seconds that a file may take.
    """
    with ThreadPoolExecutor(jobs) as pool:
        yield from pool.map(lambda file: _Run(file, environment, limit), files)


def _Run(file, environment, limit):
    options = ["-p", "no:cacheprovider", "--capture=sys", "--tb=line", "-rfE"]
    outcome = RunCommand(["-m", "pytest", *options, file], environment, limit)
    outcome.name = "/".join(Path(file).parts[-2:])
    return outcome


def RunCommand(arguments, environment, limit):
    """The `Outcome` of Python with these arguments."""
    command, start = [sys.executable, *map(str, arguments)], time.monotonic()
    with tempfile.TemporaryFile("w+", errors="replace") as output:
        try:
            code = subprocess.run(
                command, env=environment, timeout=limit, stdout=output, stderr=subprocess.STDOUT
            ).returncode
            ended = ENDS.get(code, f"ended with code {code}")
        except subprocess.TimeoutExpired:
            ended = f"stopped after {limit:g} s"
        output.seek(0)
        text = output.read()
    seconds = time.monotonic() - start
    return Outcome("", Counts(text), FAILED.findall(text), Findings(text), seconds, ended)


def Counts(text):
    """How many tests passed, failed, ..., from the last line of pytest."""
    summaries = SUMMARY.findall(text)
    return {word: int(number) for number, word in COUNT.findall(summaries[-1] if summaries else "")}
