"""Run tests with an instrumented plugin: addresses and undefined behaviour, ranges of indices.

python tests/sanitizers/run.py [--kind address|range|all] [--json F] [FILE ...]

Builds the plugin in build/sanitizers, looks whether errors planted on purpose are found, and runs
the tests of pairing, space, contact and solver. Exit code 0: no findings, all tests passed, all
files ran to their end. This takes a multiple of the ordinary time; a kind and files are a part.

address : ``-fsanitize=address,undefined`` without ``vptr``, whose types NGSolve's wheel hides.
    Memory on loan from a `LocalHeap` of the wheel counts as one piece. Findings in the wheel itself
    are listed with reasons in sanitizer_findings.py.
range : ``_GLIBCXX_ASSERTIONS``, and netgen's checks of indices of arrays, tables, vectors and
    matrices in our code. ``NETGEN_ENABLE_CHECK_RANGE`` for all of it is impossible: it changes the
    layout of `BareVector`, `BareSliceVector` and `BareSliceMatrix`. So indices into these are not
    checked, nor that both operands of a sum have one size; an operand that is too short is found by
    the index past its end.
"""

import argparse
import json
import os
from collections import Counter
from pathlib import Path

from sanitizer_build import KINDS, ROOT, Build, Environment
from sanitizer_tests import RunCommand, RunTests

__all__ = ["BAD", "IsGood", "Main"]

FOLDERS = ("pairing", "space", "contact", "solver")
BAD = ("findings in ngslac", "elsewhere", "planted errors missed", "failed", "error", "unfinished")
# Nor is an error found where the tests would get another plugin than the instrumented one.
PLANTED = """
import os
import ngsolve
from importlib.util import module_from_spec, spec_from_file_location
from ngslac import _ngslac

assert _ngslac.__file__ == os.environ["NGSLAC_PLUGIN"], _ngslac.__file__
spec = spec_from_file_location("planted", {path!r})
module = module_from_spec(spec)
spec.loader.exec_module(module)
module.{name}()
"""


def IsGood(numbers):
    """Whether those of `Check` are what one wants."""
    return not any(numbers[name] for name in BAD)


def Check(kind, files, jobs, limit):
    """Numbers of findings, tests and what did not work with one of `KINDS`; prints them, too."""
    plugin = Build(kind, ROOT / "build" / "sanitizers" / kind, jobs)
    environment = Environment(kind, plugin)
    missed = Missed(kind, plugin, environment)
    print(f"{kind}: planted errors missed: {' '.join(missed) or 'none'}", flush=True)
    counts, seen = Counter(), {}
    for file, outcome in RunTests(files, environment, jobs, limit):
        counts.update(outcome.counts)
        counts["unfinished"] += bool(outcome.ended)
        Print(f"{kind} {'/'.join(file.parts[-2:]):40}", outcome, seen)
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
    (planted,) = plugin.parent.glob("planted.*.so")

    def Found(name):
        code = PLANTED.format(path=str(planted), name=name)
        return RunCommand(["-c", code], environment, 300).findings

    return [name for name in KINDS[kind].planted.split() if not Found(name)]


def Print(head, outcome, seen):
    """A line for a file of tests, and what was found there for the first time."""
    counts = " ".join(f"{word} {count}" for word, count in outcome.counts.items())
    print(f"{head} {outcome.seconds:5.0f} s {counts} {outcome.ended}")
    texts = list(outcome.failed)
    for finding in outcome.findings:
        if finding.key not in seen and not finding.known:
            texts.append(finding.Text())
        seen.setdefault(finding.key, finding)
    print("".join(f"    {text}\n" for text in texts), end="", flush=True)


def Main(arguments=None):
    """Run the command; returns its exit code."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("files", nargs="*", type=Path, help="of tests; all of four folders if none")
    parser.add_argument("--kind", choices=(*KINDS, "all"), default="all")
    parser.add_argument("--jobs", type=int, default=os.cpu_count())
    parser.add_argument("--limit", type=float, default=1800, help="seconds that a file may take")
    parser.add_argument("--json", type=Path, help="write the numbers to this file")
    given = parser.parse_args(arguments)
    folders = [ROOT / "tests" / folder for folder in FOLDERS]
    files = given.files or [file for f in folders for file in sorted(f.glob("test_*.py"))]
    kinds = KINDS if given.kind == "all" else [given.kind]
    results = {kind: Check(kind, files, given.jobs, given.limit) for kind in kinds}
    if given.json:
        given.json.write_text(json.dumps(results, indent=1) + "\n")
    for kind, numbers in results.items():
        print(f"{kind}: " + ", ".join(f"{name} {number}" for name, number in numbers.items()))
    return int(not all(map(IsGood, results.values())))


if __name__ == "__main__":
    raise SystemExit(Main())
