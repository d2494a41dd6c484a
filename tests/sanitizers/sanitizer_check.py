"""Build, run tests, count: one kind of instrumentation."""

import sys
from collections import Counter

from sanitizer_build import KINDS, ROOT, Build, Environment
from sanitizer_tests import RunCommand, RunTests

__all__ = ["Check", "IsGood"]

PLANTED = """
import ngsolve
from importlib.util import module_from_spec, spec_from_file_location

spec = spec_from_file_location("planted", {path!r})
module = module_from_spec(spec)
spec.loader.exec_module(module)
module.{name}()
"""
BAD = ("findings in ngslac", "elsewhere", "planted errors missed", "failed", "error", "unfinished")


def IsGood(numbers):
    """Whether those of `Check` are what one wants."""
    return not any(numbers[name] for name in BAD)


def Check(kind, files, jobs, limit):
    """Numbers of findings, tests and what did not work; prints the findings.

    Parameters
    ----------
    kind : str
        One of `KINDS`.
    files : list of Path
        Of tests.
    jobs : int
        Compilers and files at a time.
    limit : float
        Seconds for a file.
    """
    plugin = Build(kind, ROOT / "build" / "sanitizers" / kind, jobs)
    environment = Environment(kind, plugin)
    missed = Missed(kind, plugin, environment)
    print(f"{kind}: planted errors missed: {' '.join(missed) or 'none'}", flush=True)
    counts, seen = Counter(), {}
    for outcome in RunTests(files, environment, jobs, limit):
        counts.update(outcome.counts)
        counts["unfinished"] += bool(outcome.ended)
        Print(kind, outcome, seen)
    found = [finding for finding in seen.values() if not finding.known]
    ours = sum(finding.ours for finding in found)
    return {
        "findings in ngslac": ours,
        "elsewhere": len(found) - ours,
        "known of the wheel": len(seen) - len(found),
        "planted errors missed": len(missed),
        **{name: counts[name] for name in ("passed", "failed", "error", "skipped", "unfinished")},
    }


def Missed(kind, plugin, environment):
    """Planted errors that were not found."""
    (planted,) = plugin.parent.glob("planted.*.so")
    codes = {name: PLANTED.format(path=str(planted), name=name) for name in KINDS[kind].planted}
    return [
        name
        for name, code in codes.items()
        if not RunCommand(["-c", code], environment, 300).findings
    ]


def Print(kind, outcome, seen):
    """A line for a file of tests, and what was found there for the first time."""
    counts = " ".join(f"{word} {count}" for word, count in outcome.counts.items())
    print(f"{kind} {outcome.name:40} {outcome.seconds:5.0f} s {counts} {outcome.ended}")
    for line in outcome.failed:
        print(f"    {line}")
    for finding in outcome.findings:
        if finding.key not in seen:
            seen[finding.key] = finding
            if not finding.known:
                print(f"    {finding.Text()}")
    sys.stdout.flush()
