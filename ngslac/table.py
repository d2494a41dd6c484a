# SPDX-License-Identifier: LGPL-2.1-or-later
"""Columns of numbers and names that print as a table."""

from collections.abc import Iterator

import numpy as np

__all__ = ["Columns"]


class Columns(dict):
    """A dict of arrays with one row each; ``print`` shows them side by side."""

    def __str__(self) -> str:
        texts = [column for name, values in self.items() for column in _Texts(name, values)]
        return "\n".join("  ".join(row).rstrip() for row in zip(*texts, strict=True))


def _Texts(name: str, values: np.ndarray) -> Iterator[list[str]]:
    """Columns of text of equal width, one for each number of a row."""
    values = np.asarray(values)
    for column in values.reshape(len(values), -1).T if values.size else [values.ravel()]:
        words = [str(value) if isinstance(value, str) else f"{value:.6g}" for value in column]
        width = max(map(len, [name, *words]))
        yield [word.rjust(width) for word in (name, *words)]
        name = ""
