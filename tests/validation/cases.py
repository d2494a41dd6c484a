"""All reference cases, which tests and the validation report share."""

from __future__ import annotations

from importlib import import_module

__all__ = ["CASES", "MODULES"]

NAMES = (
    "patch balance stability rates hertz friction hertz3d friction3d large large_friction "
    "materials dynamics"
)
MODULES = [import_module(f"cases_{name}") for name in NAMES.split()]
CASES = {case.name: case for module in MODULES for case in module.CASES}
