# SPDX-License-Identifier: LGPL-2.1-or-later
"""Functions on a mesh as files for ParaView, written as a whole or not at all."""

import os

from ngsolve import VOL, VTKOutput

from ngslac.files import PathOf, Replacing

__all__ = ["VTUPath", "WriteVTK"]

END = b"</VTKFile>"


def VTUPath(filename):
    """The path of a file, with the ending .vtu where it is missing."""
    path = PathOf("filename", filename)
    return path if path.suffix == ".vtu" else path.with_name(path.name + ".vtu")


def WriteVTK(filename, mesh, functions, *, vb=VOL, drawelems=None, **options):
    """Write a VTU file by NGSolve's VTKOutput, which is whole or raises; return its path."""
    path = VTUPath(filename)
    with Replacing(path) as part:
        name = str(part.with_suffix(""))
        output = VTKOutput(mesh, list(functions.values()), list(functions), name, **options)
        output.Do(vb=vb, drawelems=drawelems)
        if not IsComplete(part):
            raise OSError(f"{path} could not be written: is the disk full?")
    return path


def IsComplete(path):
    """Does the file have its end?"""
    if not path.exists():
        return False
    with open(path, "rb") as stream:
        stream.seek(0, os.SEEK_END)
        stream.seek(max(0, stream.tell() - 2 * len(END)))
        return END in stream.read()
