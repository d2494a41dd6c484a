# SPDX-License-Identifier: LGPL-2.1-or-later
"""The versions that fit together."""

from importlib.metadata import PackageNotFoundError, requires, version

__all__ = ["CheckNGSolve", "__version__"]

try:
    __version__ = version("ngslac")
except PackageNotFoundError:  # a source tree on the path without an installation
    __version__ = "0.0.0"


def RequiredNGSolve() -> str | None:
    """The NGSolve version this package was built for, or None without an installation."""
    try:
        pins = requires("ngslac") or []
    except PackageNotFoundError:
        return None
    return next((p.split("==")[1].strip() for p in pins if p.startswith("ngsolve==")), None)


def CheckNGSolve() -> None:
    """Raise an ImportError that names both versions when the installed NGSolve does not fit."""
    needed = RequiredNGSolve()
    try:
        found = version("ngsolve")
    except PackageNotFoundError:
        found = None
    if needed and found != needed:
        raise ImportError(
            f"ngslac {__version__} was built for ngsolve {needed}, but "
            f"{'ngsolve ' + found if found else 'no ngsolve'} is installed: a compiled add-on fits "
            f"one NGSolve release only. Run: pip install ngsolve=={needed}"
        )
