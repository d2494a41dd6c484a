"""Files of tests, each in an instrumented process of its own."""

import re
import subprocess
import sys
import tempfile
import time
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path

from sanitizer_findings import Finding, Findings

__all__ = ["Outcome", "RunCommand", "RunTests"]

COUNT = re.compile(r"(\d+) (passed|failed|skipped|error)")
SUMMARY = re.compile(r"^.*\d+ (?:passed|failed|skipped|error).* in [\d.]+s", re.MULTILINE)
FAILED = re.compile(r"^(?:FAILED|ERROR) .*|^E   .*Error: .*", re.MULTILINE)
ENDS = {0: "", 1: "", 5: ""}  # exit codes of pytest: all passed, some failed, none collected
OPTIONS = ("-m", "pytest", "-p", "no:cacheprovider", "--capture=sys", "--tb=line", "-rfE")


@dataclass
class Outcome:
    """What became of a process."""

    counts: dict[str, int]  # tests that passed, failed, were skipped
    failed: list[str]  # the tests that did, and what pytest says of that
    findings: list[Finding]
    seconds: float
    ended: str  # empty, or how it ended before its time


def RunTests(files, environment, jobs, limit):
    """Yield each file with its `Outcome`, in order; `limit` seconds for each, `jobs` at a time."""

    def Run(file):
        return file, RunCommand([*OPTIONS, file], environment, limit)

    with ThreadPoolExecutor(jobs) as pool:
        yield from pool.map(Run, map(Path, files))


def RunCommand(arguments, environment, limit):
    """The `Outcome` of Python with these arguments."""
    command, start = [sys.executable, *map(str, arguments)], time.monotonic()
    with tempfile.TemporaryFile("w+", errors="replace") as output:
        streams = {"stdout": output, "stderr": subprocess.STDOUT}
        try:
            code = subprocess.run(command, env=environment, timeout=limit, **streams).returncode
            ended = ENDS.get(code, f"ended with code {code}")
        except subprocess.TimeoutExpired:
            ended = f"stopped after {limit:g} s"
        output.seek(0)
        text = output.read()
    seconds = time.monotonic() - start
    last = (SUMMARY.findall(text) or [""])[-1]  # the line of pytest
    counts = {word: int(number) for number, word in COUNT.findall(last)}
    return Outcome(counts, FAILED.findall(text), Findings(text), seconds, ended)
