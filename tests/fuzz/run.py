"""Call everything public with malformed and odd arguments, each in a process of its own.

python tests/fuzz/run.py [--json F] [--jobs N] [--only PATTERN] [--sample N] [--every] [--verbose]

An error is good if it is of the documented kinds and names the argument. Exit code 0: no crash, no
hang, nothing malformed accepted in silence, no error without the name of the argument.

A new argument gets its odd values in fuzz_targets.py. An odd use is a line below the words that its
error has to hold, in fuzz_odd.py, or fuzz_strange.py (spaces, meshes), fuzz_solids.py (3D) or
fuzz_reentrant.py.
"""

import os

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # read when NGSolve is imported

import argparse
import fnmatch
import json
import random
from collections import Counter, defaultdict
from pathlib import Path

from fuzz_cases import AllCases
from fuzz_process import RunAll
from fuzz_world import World

__all__ = ["Main"]

BAD = ("crash", "hang", "silent", "unnamed")
OUTCOMES = ("named", "harmless", *BAD)


def Parser():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    add = parser.add_argument
    add("--json", type=Path, help="write the numbers to this file")
    add("--jobs", type=int, default=os.cpu_count())
    add("--only", default="*", help="pattern of the names of cases")
    add("--sample", type=int, help="so many cases, by a fixed seed")
    add("--every", action="store_true", help="all odd values for each argument")
    add("--limit", type=int, default=20, help="seconds that a case may take")
    add("--verbose", action="store_true", help="print each case")
    return parser


def Main(arguments=None):
    """Run the command; returns its exit code."""
    given = Parser().parse_args(arguments)
    cases = [case for case in AllCases(given.every) if fnmatch.fnmatch(case.name, given.only)]
    if given.sample is not None:
        cases = random.Random(1).sample(cases, min(given.sample, len(cases)))
    outcomes = defaultdict(Counter)
    for case, outcome, message in RunAll(cases, World(), given.jobs, given.limit):
        outcomes[case.target][outcome] += 1
        if outcome in BAD or given.verbose:
            print(f"{outcome:8} {case.name}: {message}", flush=True)
    print(f"{'':42}" + "".join(f"{name:>10}" for name in OUTCOMES))
    for target, counts in outcomes.items():
        print(f"{target:42}" + "".join(f"{counts[name]:>10}" for name in OUTCOMES))
    total = sum(outcomes.values(), Counter())
    result = {"cases": len(cases), "crashes": total["crash"], "hangs": total["hang"]}
    result |= {name: total[name] for name in ("silent", "unnamed", "named", "harmless")}
    if given.json:
        given.json.write_text(json.dumps(result, indent=1) + "\n")
    print(", ".join(f"{name} {count}" for name, count in result.items()))
    return int(any(total[name] for name in BAD))


if __name__ == "__main__":
    raise SystemExit(Main())
