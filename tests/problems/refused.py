"""Calls that have to be refused, each a line of Python with the error that it has to give."""

from itertools import count, repeat

import ngsolve
import numpy as np
import pytest

import ngslac

NAMES = vars(ngsolve) | vars(ngslac) | {"np": np, "count": count, "repeat": repeat}
NAMES |= {"NAN": float("nan"), "INF": float("inf")}


def calls(rows):
    """Parametrize a test by `row`: (call, regular expression) or (call, expression, error)."""
    return pytest.mark.parametrize("row", rows, ids=[row[0] for row in rows])


def check_refused(row, **names):
    """The names of NGSolve and of ngslac are known in a call, and those that are given."""
    call, message, *error = row
    with pytest.raises(*(error or [Exception]), match=message) as caught:
        eval(call, NAMES | names)
    assert not isinstance(caught.value, (NameError, AttributeError, SyntaxError))
