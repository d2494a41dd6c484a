"""Run tests with an instrumented plugin: addresses and undefined behaviour, ranges of indices.

python tests/sanitizers/run.py [--kind address|range|all] [--json F] [FILE ...]

Builds the plugin in build/sanitizers, looks whether errors planted on purpose are found, and runs
the tests of pairing, space, contact and solver. Exit code 0: no findings, all tests passed, all
files ran to their end.
"""

import argparse
import json
import os
from pathlib import Path

from sanitizer_build import KINDS, ROOT
from sanitizer_check import Check, IsGood

__all__ = ["Main"]

FOLDERS = ("pairing", "space", "contact", "solver")


def Arguments(arguments):
    """Of the command line."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("files", nargs="*", type=Path, help="of tests; all of four folders if none")
    parser.add_argument("--kind", choices=(*KINDS, "all"), default="all")
    parser.add_argument("--jobs", type=int, default=os.cpu_count())
    parser.add_argument("--limit", type=float, default=1800, help="seconds that a file may take")
    parser.add_argument("--json", type=Path, help="write the numbers to this file")
    return parser.parse_args(arguments)


def Main(arguments=None):
    """Run the command; returns its exit code."""
    given = Arguments(arguments)
    files = given.files or [
        file for folder in FOLDERS for file in sorted((ROOT / "tests" / folder).glob("test_*.py"))
    ]
    kinds = list(KINDS) if given.kind == "all" else [given.kind]
    results = {kind: Check(kind, files, given.jobs, given.limit) for kind in kinds}
    if given.json:
        given.json.write_text(json.dumps(results, indent=1) + "\n")
    for kind, numbers in results.items():
        print(f"{kind}: " + ", ".join(f"{name} {number}" for name, number in numbers.items()))
    return int(not all(map(IsGood, results.values())))


if __name__ == "__main__":
    raise SystemExit(Main())
