# SPDX-License-Identifier: LGPL-2.1-or-later
"""Files that are written as a whole or not at all."""

import os
import shutil
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from ngslac.arguments import CheckInstance

__all__ = ["PathOf", "Replacing"]


def PathOf(name: str, file: str | Path) -> Path:
    """An argument as pathlib.Path."""
    path = Path(CheckInstance(name, file, (str, os.PathLike), "the name of a file"))
    if not path.name or "\0" in path.name:
        raise ValueError(f"{name} = {str(file)!r} must be the name of a file")
    return path


@contextmanager
def Replacing(path: Path) -> Iterator[Path]:
    """The path of a new file for a ``with`` block, which then takes the place of `path`.

    After an error there is neither a part of it, nor is an older file changed. It is an OSError
    where the folder is missing, or `path` is there and no regular file.
    """
    target = Target(path)
    part = target.with_name(f".ngslac-{os.getpid()}{target.suffix}")
    try:
        yield part
        with open(part, "rb+") as stream:
            os.fsync(stream.fileno())
        if target.exists():
            shutil.copymode(target, part)
        os.replace(part, target)
    except BaseException:
        with suppress(FileNotFoundError):
            part.unlink()
        raise


def Target(path: Path) -> Path:
    """Where a file is written to; links are followed."""
    target = path.resolve()
    if not target.parent.is_dir():
        raise FileNotFoundError(f"{path}: the folder {target.parent} is missing; make it first")
    if target.is_dir():
        raise IsADirectoryError(f"{path} is a folder: give the name of a file")
    if target.exists() and not target.is_file():
        raise OSError(f"{path} is there and no regular file: give another name")
    return target
