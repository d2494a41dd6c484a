# SPDX-License-Identifier: LGPL-2.1-or-later
"""Functions on a mesh as files for ParaView, written as a whole or not at all."""

from __future__ import annotations

import os
from pathlib import Path
from typing import TYPE_CHECKING

from ngsolve import VOL, BitArray, CoefficientFunction, Mesh, VTKOutput

from ngslac.files import PathOf, Replacing

if TYPE_CHECKING:
    from ngsolve.comp import VorB

__all__ = ["VTUPath", "WriteVTK"]

END = b"</VTKFile>"


def VTUPath(filename: str | Path) -> Path:
    """The path of a file, with the ending .vtu where it is missing."""
    path = PathOf("filename", filename)
    return path if path.suffix == ".vtu" else path.with_name(path.name + ".vtu")


def WriteVTK(
    filename: str | Path,
    mesh: Mesh,
    functions: dict[str, CoefficientFunction],
    *,
    vb: VorB = VOL,
    drawelems: BitArray | None = None,
    **options,
) -> Path:
    """Write a VTU file by NGSolve's VTKOutput, which is whole or raises; return its path."""
    path = VTUPath(filename)
    with Replacing(path) as part:
        name = str(part.with_suffix(""))
        output = VTKOutput(mesh, list(functions.values()), list(functions), name, **options)
        output.Do(vb=vb, drawelems=drawelems)
        if not IsComplete(part):
            raise OSError(f"{path} could not be written: is the disk full?")
    return path


def IsComplete(path: Path) -> bool:
    """Does the file have its end?"""
    if not path.exists():
        return False
    with open(path, "rb") as stream:
        stream.seek(0, os.SEEK_END)
        stream.seek(max(0, stream.tell() - 2 * len(END)))
        return END in stream.read()
