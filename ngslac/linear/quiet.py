# SPDX-License-Identifier: LGPL-2.1-or-later
"""Keep the output of compiled libraries from the screen."""

from __future__ import annotations

import ctypes
import os
import sys
import tempfile

__all__ = ["Quiet"]


class Quiet:
    """A context in which nothing that libraries print reaches the screen."""

    def __init__(self):
        self.text, self._kept, self._file = "", [], None

    def __enter__(self) -> Quiet:
        """Send what is written to both streams into a file."""
        _Flush()
        try:
            self._file = tempfile.TemporaryFile()
            for stream in (1, 2):
                self._kept.append((os.dup(stream), stream))
                os.dup2(self._file.fileno(), stream)
        except OSError:  # no streams, or no place for a file: as it is
            self._Back()
        except BaseException:
            self._Back()
            raise
        return self

    def __exit__(self, *_) -> None:
        _Flush()
        self._Back()

    def _Back(self) -> None:
        """Give both streams back, and read what was written meanwhile."""
        while self._kept:
            copy, stream = self._kept.pop()
            os.dup2(copy, stream)
            os.close(copy)
        if self._file:
            self._file.seek(0)
            self.text = self._file.read().decode(errors="replace")
            self._file.close()


def _Flush() -> None:
    """Flush the buffers of Python and C."""
    for stream in (sys.stdout, sys.stderr):
        try:
            stream.flush()
        except (AttributeError, OSError, ValueError):  # there is none, or it is closed
            continue
    try:
        ctypes.CDLL(None).fflush(None)
    except (AttributeError, OSError, TypeError):  # no C library by that name
        return
