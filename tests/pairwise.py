"""Fewer cases of a product of options: every pair of values occurs, or some in equal steps.

Beside that, the tests that take long: those of some rooms, and of others by `slow.txt`.
"""

from itertools import combinations
from pathlib import Path

import pytest

HERE = Path(__file__).parent
SLOW_ROOMS = {"benchmarks", "docs", "examples", "fuzz", "parallel", "stress", "tutorials"}
SLOW_ROOMS |= {"validation"}


def Pairs(case):
    """All pairs of (option, value) of a case, which maps options to values; a single one alone."""
    values = sorted(case.items())
    return set(combinations(values, min(2, len(values))))


def CoveringArray(cases):
    """Positions of some of the cases that have every pair of values that any case has.

    Combinations that are not allowed are just not among the cases. Greedy, the first among equals:
    the same cases always give the same choice.
    """
    pairs = [Pairs(case) for case in cases]
    left, chosen = set().union(*pairs), []
    while left:
        chosen.append(max(range(len(cases)), key=lambda i: len(pairs[i] & left)))
        left -= pairs[chosen[-1]]
    return sorted(chosen)


def Options(item):
    """The values of a collected test by names; what is parametrized together is one option."""
    names = [mark.args[0] for mark in item.iter_markers("parametrize")]
    groups = [tuple(n.replace(",", " ").split()) if isinstance(n, str) else tuple(n) for n in names]
    params = item.callspec.params
    groups += [(name,) for name in sorted(set(params).difference(*groups))]  # of fixtures
    # All cases share the objects that are their values, of which many have no hash.
    return {group: tuple(id(params[name]) for name in group) for group in groups}


def Sample(count, wanted):
    """So many positions of a list in equal steps, the first and the last one among them."""
    return {round(k * (count - 1) / max(wanted - 1, 1)) for k in range(min(wanted, count))}


def MarkFull(items):
    """Mark `full` the cases that are neither in the sample nor needed by the pairs of options.

    Of the tests marked sample, or pairwise. Only what was collected counts: a single case named on
    the command line runs.
    """
    families = {}
    for item in items:
        if item.get_closest_marker("pairwise") or item.get_closest_marker("sample"):
            families.setdefault((item.parent, item.originalname), []).append(item)
    for family in families.values():
        if sample := family[0].get_closest_marker("sample"):
            needed = Sample(len(family), *sample.args)
        else:
            needed = set(CoveringArray([Options(item) for item in family]))
        for position, item in enumerate(family):
            if position not in needed:
                item.add_marker(pytest.mark.full)


def SlowTests():
    """Pairs of a file, in the folder of the tests, and a function of it."""
    lines = (HERE / "slow.txt").read_text().splitlines()
    files = (line.split(": ") for line in lines if not line.startswith("#"))
    return {(file, name) for file, names in files for name in names.split()}


def MarkSlow(items):
    """Mark `slow` all that is not for each change: also what is for each week alone."""
    slow = SlowTests()
    for item in items:
        file = item.path.relative_to(HERE)
        listed = (file.as_posix(), getattr(item, "originalname", "")) in slow
        weekly = any(item.get_closest_marker(name) for name in ("full", "stress"))
        if listed or weekly or file.parts[0] in SLOW_ROOMS:
            item.add_marker(pytest.mark.slow)
