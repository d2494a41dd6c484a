"""The validation report: every reference case, computed, with tables and pictures.

Writes ``index.md``, a page per case and ``pictures/*.png`` to the folder ``--out``. All cases
together take a quarter of an hour on two cores::

    python docs/validation/report.py --out docs/validation

Cases and what they solve are in ``tests/validation``, and the tests assert the same rows.
"""

from __future__ import annotations

import argparse
import os
import sys
import time
from pathlib import Path

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

ROOT = Path(__file__).resolve().parents[2]
TESTS = ("validation", "solver", "contact", "problems", "reference")
FOLDERS = (ROOT / "tutorials/examples", *(ROOT / "tests" / n for n in TESTS))
for folder in FOLDERS:
    if str(folder) not in sys.path:
        sys.path.insert(0, str(folder))

from cases import CASES  # noqa: E402
from report_page import CasePage, Compute, Page  # noqa: E402

__all__ = ["CASES", "Report", "main"]

COMMAND = "python docs/validation/report.py --out docs/validation"


def Report(out, *, names=None, quick=False, quiet=True, command=COMMAND):
    """Compute cases and write the pages with their pictures.

    Parameters
    ----------
    out : str or path
        Folder, made if there is none.
    names : list of str, optional
        Of the cases; default: all.
    quick : bool
        Small sizes, for a look at the page; the numbers are worse.
    quiet : bool
        Print nothing.
    command : str
        Which the page names.

    Returns
    -------
    list of Result
        One for each case, see `report_page`.
    """
    out, results = Path(out), []
    for name in names or CASES:
        results.append(Compute(CASES[name], quick, out))
        if not quiet:
            result = results[-1]
            state = "holds" if result.holds else result.error or "does not hold"
            print(f"{name:24s}{result.seconds:8.1f} s  {state}", flush=True)
    out.mkdir(parents=True, exist_ok=True)
    (out / "index.md").write_text(Page(results, command))
    for result in results:
        (out / f"{result.case.name}.md").write_text(CasePage(result))
    return results


def main(argv=None):
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--out", metavar="DIR", help="folder of the page (docs/validation)")
    parser.add_argument("--cases", nargs="+", choices=CASES, metavar="NAME", help=", ".join(CASES))
    parser.add_argument("--quick", action="store_true", help="small sizes")
    options = parser.parse_args(argv)
    if (options.cases or options.quick) and not options.out:
        parser.error("--cases and --quick make a page of their own: give its folder by --out")
    start = time.perf_counter()
    shown = COMMAND if argv is None and len(sys.argv) < 2 else None
    arguments = sys.argv[1:] if argv is None else argv
    shown = shown or " ".join(["python docs/validation/report.py", *arguments])
    out = options.out or Path(__file__).parent
    results = Report(out, names=options.cases, quick=options.quick, quiet=False, command=shown)
    print(f"{time.perf_counter() - start:.0f} s; {Path(out) / 'index.md'}")
    if not all(result.holds for result in results):
        raise SystemExit("some cases do not hold")


if __name__ == "__main__":
    main()
