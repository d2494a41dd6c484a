"""Solves each case in one process and on several ranks, and compares.

``python tests/parallel/run.py --ranks 1 3 4 5 --only "hertz*"``: a line per case; the exit status
is 0 where all agree to 1e-9. Needs mpiexec, mpi4py and petsc4py.
"""

import argparse
import sys
import tempfile
import time
from fnmatch import fnmatch
from pathlib import Path

from parallel_compare import differences, largest
from parallel_start import missing, run
from parallel_worker import CASES


def compare(ranks, cases, folder, *, limit=30.0, line=print):
    """{(case, ranks): sentences of what differs}; each line goes to a function as it is known."""
    saved, faults = None, {}
    order = sorted(cases, key=lambda name: name == "restarted")  # after "saved", which it needs
    begin = time.monotonic()
    serial = run(0, order, folder, saved=folder / "state1", limit=limit)
    line(f"serial: {len(cases)} cases, {time.monotonic() - begin:.1f} s")
    for count in ranks:
        begin = time.monotonic()
        saved = saved or folder / f"state{count}"  # of the first number of ranks for all others
        found = run(count, order, folder, saved=saved, limit=limit)
        for case in order:
            faults[case, count] = differences(serial[case], found[case])
            line(report(case, count, faults[case, count], serial[case], found[case]))
        line(f"{count} ranks: {time.monotonic() - begin:.1f} s")
    return faults


def report(case, count, faults, serial, found):
    if faults:
        return f"{case:24} {count} ranks  FAILS  " + "; ".join(faults)
    worst = f"{largest(serial, found):.0e}"
    return f"{case:24} {count} ranks  agrees to {worst}, {found['seconds']:.1f} s"


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--ranks", type=int, nargs="+", default=[1, 3, 4, 5])
    parser.add_argument("--only", nargs="+", default=["*"], help="patterns of cases")
    parser.add_argument("--limit", type=float, default=30.0, help="seconds for one case")
    given = parser.parse_args()
    if lacks := missing():
        sys.exit(lacks)
    cases = [name for name in CASES if any(fnmatch(name, p) for p in given.only)]
    with tempfile.TemporaryDirectory() as folder:
        faults = compare(given.ranks, cases, Path(folder), limit=given.limit)
    failed = sum(map(bool, faults.values()))
    print(f"{len(faults) - failed} of {len(faults)} agree")
    sys.exit(failed > 0)


if __name__ == "__main__":
    main()
