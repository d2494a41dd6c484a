# SPDX-License-Identifier: LGPL-2.1-or-later
"""Print the installed versions and, with ``--check``, test them: ``python -m ngslac``."""

import argparse
import sys
from collections.abc import Sequence

from ngslac.installation.inventory import Inventory
from ngslac.installation.selfcheck import CASES, Differs

CHECK = "python -m ngslac --check"


def Check() -> int:
    """Solve small problems, print the results, and return the number of failures."""
    found = {name: Differs(*case) for name, case in CASES.items()}
    for name, differs in found.items():
        print(f"{name + ':':16}{differs or 'pass'}")
    wrong = sum(map(bool, found.values()))
    print(f"{wrong} of {len(found)} checks failed" if wrong else "pass")
    return wrong


def main(arguments: Sequence[str] | None = None) -> int:
    """Print versions, and run the check if asked to; return the exit status, 1 for a failure."""
    parser = argparse.ArgumentParser(prog="python -m ngslac", description=__doc__)
    parser.add_argument(
        "--check", action="store_true", help="solve small problems with known solutions"
    )
    check = parser.parse_args(arguments).check
    for name, what in Inventory().items():
        print(f"{name + ':':16}{what}")
    if check:
        return int(Check() > 0)
    print(f"to check:       {CHECK}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
