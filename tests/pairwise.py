"""Choose fewer cases of a product of options: every pair of values, or cases in equal steps.

Mark the tests that take long, too: all of some rooms, and those that `slow.txt` lists.
"""

from itertools import combinations
from pathlib import Path

import pytest

HERE = Path(__file__).parent
SLOW_ROOMS = {"benchmarks", "docs", "examples", "fuzz", "parallel", "stress", "tutorials"}
SLOW_ROOMS |= {"validation"}


def Pairs(case):
    """All pairs of (option, value) of a case {option: value}; a single option counts as a pair."""
    values = sorted(case.items())
    return set(combinations(values, min(2, len(values))))


def CoveringArray(cases):
    """Choose cases, by position, so that every pair of values of any case is in a chosen one.

    Combinations that are not allowed are not among the cases. The choice is greedy and takes the
    first among equals: the same cases always give the same choice.
    """
    pairs = [Pairs(case) for case in cases]
    left, chosen = set().union(*pairs), []
    while left:
        chosen.append(max(range(len(cases)), key=lambda i: len(pairs[i] & left)))
        left -= pairs[chosen[-1]]
    return sorted(chosen)


def Options(item):
    """Values of a collected test by option; names that are parametrized together are one option."""
    names = [mark.args[0] for mark in item.iter_markers("parametrize")]
    groups = [tuple(n.replace(",", " ").split()) if isinstance(n, str) else tuple(n) for n in names]
    params = item.callspec.params
    groups += [(name,) for name in sorted(set(params).difference(*groups))]  # of fixtures
    # Many values have no hash: their ids stand for them, as all cases share the same objects.
    return {group: tuple(id(params[name]) for name in group) for group in groups}


def Sample(count, wanted):
    """Choose `wanted` positions of a list in equal steps, with the first and the last one."""
    return {round(k * (count - 1) / max(wanted - 1, 1)) for k in range(min(wanted, count))}


def MarkFull(items):
    """Mark `full` the cases that are neither in the sample nor needed by the pairs of options.

    This concerns tests that are marked `sample` or `pairwise`. Only collected cases count: a single
    case that the command line names runs.
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
    """Pairs of a file, relative to this folder, and the name of a function in it."""
    lines = (HERE / "slow.txt").read_text().splitlines()
    files = (line.split(": ") for line in lines if not line.startswith("#"))
    return {(file, name) for file, names in files for name in names.split()}


def MarkSlow(items):
    """Mark `slow` the tests that do not run after each change, the weekly ones included."""
    slow = SlowTests()
    for item in items:
        file = item.path.relative_to(HERE)
        listed = (file.as_posix(), getattr(item, "originalname", "")) in slow
        weekly = any(item.get_closest_marker(name) for name in ("full", "stress"))
        if listed or weekly or file.parts[0] in SLOW_ROOMS:
            item.add_marker(pytest.mark.slow)
