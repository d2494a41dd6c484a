"""Run the stress set: share that converges without help, step cuts, iterations, wrong answers.

python tests/stress/run.py --json stress.json [--only PATTERN] [--verbose]
"""

import argparse
import fnmatch
import json
import time
from pathlib import Path

import stress_blocks2d  # noqa: F401  (the problems register themselves)
import stress_blocks3d  # noqa: F401
import stress_finite2d  # noqa: F401
import stress_finite3d  # noqa: F401
import stress_floating2d  # noqa: F401
from stress_check import Check, CheckEnd, WrongAnswerError
from stress_problem import PROBLEMS

from ngslac import ContactConvergenceError

__all__ = ["Main", "RunProblem"]


def RunProblem(name, printing=False):
    """Solve one problem and check every converged step; returns a dict of results."""
    problem = PROBLEMS[name]()
    result = {"name": name, "converged": False, "right": None, "error": ""}
    begin = time.perf_counter()
    counts = Counts()
    try:
        problem.Run(callback=lambda _: Check(problem), printing=printing, watch=counts)
        result["converged"] = True
        CheckEnd(problem)
        result["right"] = True
    except WrongAnswerError as error:
        result |= {"converged": True, "right": False, "error": str(error)}
    except Exception as error:  # whatever it is, the problem was not solved
        result["error"] = f"{type(error).__name__}: {error}"
    return result | {
        "steps": len(problem.stepper.steps),
        "cuts": counts.failed,
        "iterations": counts.iterations,
        "reached": problem.load.Get(),
        "seconds": round(time.perf_counter() - begin, 2),
    }


class Counts:
    """Counts what every Solve needs, also those that fail."""

    def __init__(self):
        self.failed = self.iterations = 0

    def __call__(self, solver):
        solve = solver.Solve

        def counted(**flags):
            try:
                return solve(**flags)
            except ContactConvergenceError:
                self.failed += 1
                raise
            finally:
                self.iterations += max(len(solver.history) - 1, 0)

        solver.Solve = counted


def Summary(results):
    solved = [r for r in results if r["converged"]]
    return {
        "problems": len(results),
        "converged": len(solved),
        "wrong": sum(r["right"] is False for r in results),
        "share": round(sum(bool(r["right"]) for r in results) / max(len(results), 1), 4),
        "steps": sum(r["steps"] for r in results),
        "cuts": sum(r["cuts"] for r in results),
        "iterations": sum(r["iterations"] for r in results),
        "seconds": round(sum(r["seconds"] for r in results), 1),
    }


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
        verdict = {True: "ok", False: "WRONG", None: "FAILED"}[r["right"]]
        print(
            f"{name:28s} {verdict:6s} steps {r['steps']:3d}  cuts {r['cuts']:3d}  "
            f"iterations {r['iterations']:4d}  {r['seconds']:6.2f} s  {r['error'][:150]}",
            flush=True,
        )
    summary = Summary(results)
    print("  ".join(f"{key} {value}" for key, value in summary.items()))
    if arguments.json:
        arguments.json.write_text(json.dumps({"summary": summary, "problems": results}, indent=1))


if __name__ == "__main__":
    Main()
