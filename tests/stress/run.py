"""Run the stress set: what converges without help, step cuts, iterations, wrong answers, messages.

python tests/stress/run.py --json stress.json [--only PATTERN] [--verbose]

The file holds the numbers of problems: solvable, those of them that converged and that are wrong;
unsolvable, and those of them of which the error named the cause; sums of iterations and cuts.
"""

import argparse
import fnmatch
import json
import re
import time
from importlib import import_module
from pathlib import Path

from stress_check import Check, CheckEnd, WrongAnswerError
from stress_problem import PROBLEMS
from verify import Verifier

from ngslac import ContactConvergenceError

for file in sorted(Path(__file__).parent.glob("stress_*.py")):
    import_module(file.stem)  # the problems register themselves

# Iterations and cuts of these are compared from one version to the next.
FIRST = ("stress_blocks", "stress_finite", "stress_floating2d")
MOST_SOLVES = 200  # linear systems until a problem without solution is named


def Module(name):
    """Where a problem is described."""
    return PROBLEMS[name].func.__module__


def RunProblem(name, printing=False):
    """Solve one problem and check every converged step; returns a dict of results."""
    problem, counts, begin = PROBLEMS[name](), Counts(), time.perf_counter()
    result = {"name": name, "unsolvable": bool(problem.says), "converged": False, "right": None}
    result |= {"error": "", "named": False}
    verify = Verifier(problem)

    def Checks(_):
        Check(problem)
        verify()

    try:
        problem.Run(callback=Checks, printing=printing, watch=counts)
        result["converged"] = True
        CheckEnd(problem)
        result["right"] = True
    except WrongAnswerError as error:
        result |= {"converged": True, "right": False, "error": str(error)}
    except Exception as error:  # whatever it is, the problem was not solved
        result["error"] = f"{type(error).__name__}: {error}"
        if problem.says and re.search(problem.says, str(error), re.IGNORECASE | re.DOTALL):
            result["named"] = counts.lost <= MOST_SOLVES
    return result | {
        "first": Module(name) in FIRST,
        "steps": len(problem.stepper.steps) if problem.stepper else 0,
        "cuts": counts.failed,
        "iterations": counts.iterations,
        "reached": problem.load.Get(),
        "seconds": round(time.perf_counter() - begin, 2),
    }


class Counts:
    """Counts what every Solve needs, also those that fail."""

    def __init__(self):
        self.failed = self.iterations = self.lost = 0  # lost: in solves that failed

    def __call__(self, solver):
        solve = solver.Solve

        def counted(**flags):
            try:
                return solve(**flags)
            except ContactConvergenceError:
                self.failed += 1
                self.lost += max(len(solver.history) - 1, 0)
                raise
            finally:
                self.iterations += max(len(solver.history) - 1, 0)

        solver.Solve = counted


def Summary(results):
    solvable = [r for r in results if not r["unsolvable"]]
    first = [r for r in solvable if r["first"]]

    def Sum(key, some):
        return sum(r[key] for r in some)

    return {
        "problems": len(results),
        "solvable": len(solvable),
        "converged": Sum("converged", solvable),
        "wrong": sum(r["right"] is False for r in solvable),
        "unsolvable": len(results) - len(solvable),
        "named": Sum("named", results),
        **{key: Sum(key, solvable) for key in ("iterations", "cuts", "steps")},
        **{f"{key}_old": Sum(key, first) for key in ("iterations", "cuts")},
        "seconds": round(Sum("seconds", results), 1),
    }


def Verdict(result):
    if result["unsolvable"]:
        return "named" if result["named"] else "NOT NAMED"
    return {True: "ok", False: "WRONG", None: "FAILED"}[result["right"]]


def Main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--json", type=Path, metavar="FILE", help="write the results")
    parser.add_argument("--only", default="*", metavar="PATTERN", help="names to run")
    parser.add_argument("--verbose", action="store_true", help="print every iteration")
    arguments = parser.parse_args()
    results = []
    for name in fnmatch.filter(PROBLEMS, arguments.only):
        r = RunProblem(name, arguments.verbose)
        results.append(r)
        print(
            f"{name:28s} {Verdict(r):9s} steps {r['steps']:3d}  cuts {r['cuts']:3d}  "
            f"iterations {r['iterations']:4d}  {r['seconds']:6.2f} s  {r['error'][:150]}",
            flush=True,
        )
    summary = Summary(results)
    print("  ".join(f"{key} {value}" for key, value in summary.items()))
    if arguments.json:
        arguments.json.write_text(json.dumps(summary | {"results": results}, indent=1))


if __name__ == "__main__":
    Main()
