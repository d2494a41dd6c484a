"""The cases of a product that run have every pair of options, and no case gets lost."""

import os
import random
import re
import subprocess
import sys
from itertools import combinations, product
from pathlib import Path

import pytest
from pairwise import HERE, CoveringArray, SlowTests

HOOK = f"""
import sys
sys.path.insert(0, {str(Path(__file__).parent)!r})
from pairwise import MarkFull
def pytest_collection_modifyitems(items):
    MarkFull(items)
"""
MARKERS = "[pytest]\nmarkers =\n  pairwise\n  sample\n  full\n"
TESTS = """
import pytest

@pytest.fixture(params="uv")
def fixed(request):
    return request.param

@pytest.mark.pairwise
@pytest.mark.parametrize("law", [{}, {"friction": 0.3}, {"tied": True}])
@pytest.mark.parametrize(("shape", "order"), [("tet", 1), ("tet", 2), ("hex", 1)])
def test_thinned(shape, order, law, fixed):
    pass

@pytest.mark.parametrize("a", range(3))
@pytest.mark.parametrize("b", range(3))
@pytest.mark.parametrize("c", range(3))
def test_whole(a, b, c):
    pass

@pytest.mark.sample(3)
@pytest.mark.parametrize("n", range(10))
def test_some(n):
    pass
"""


def PairsByHand(cases):
    names = sorted(cases[0])
    return {(a, b, case[a], case[b]) for case in cases for a, b in combinations(names, 2)}


def AllowedCases(draw):
    """A product of up to four options, without the cases that hold one of some pairs."""
    sizes = [draw.randint(1, 4) for _ in range(draw.randint(2, 4))]
    cases = [dict(zip("abcd", values, strict=False)) for values in product(*map(range, sizes))]
    pairs = sorted(PairsByHand(cases))
    forbidden = draw.sample(pairs, draw.randint(0, len(pairs) // 2))
    return [c for c in cases if not PairsByHand([c]).intersection(forbidden)] or cases[:1]


@pytest.mark.parametrize("seed", range(100))
def test_every_allowed_pair_occurs(seed):
    cases = AllowedCases(random.Random(seed))
    chosen = CoveringArray(cases)
    assert chosen == sorted(set(chosen))
    assert PairsByHand([cases[i] for i in chosen]) == PairsByHand(cases)
    assert chosen == CoveringArray([dict(reversed(case.items())) for case in cases])


@pytest.mark.parametrize(
    ("sizes", "most"),
    [((11, 5, 3), 55), ((5, 5, 4), 25), ((3, 3, 3, 3), 12), ((2,) * 6, 8), ((7,), 7)],
)
def test_cases_are_few(sizes, most):
    """Never fewer than the product of the two largest options; here as many, or few more."""
    cases = [dict(enumerate(values)) for values in product(*map(range, sizes))]
    assert len(CoveringArray(cases)) <= most


def Collected(folder, *selection):
    """Names of tests and cases that pytest collects; plugins would only take time."""
    command = [sys.executable, "-m", "pytest", "--collect-only", "-q", *selection]
    environment = os.environ | {"PYTEST_DISABLE_PLUGIN_AUTOLOAD": "1"}
    done = subprocess.run(
        command, cwd=folder, env=environment, capture_output=True, text=True, check=True
    )
    return re.findall(r"::(test_\w+)\[(.+)\]", done.stdout)


def test_the_other_cases_are_marked_full(tmp_path):
    (tmp_path / "conftest.py").write_text(HOOK)
    (tmp_path / "pytest.ini").write_text(MARKERS)
    (tmp_path / "test_it.py").write_text(TESTS)
    everything = Collected(tmp_path)
    default, rest = Collected(tmp_path, "-m", "not full"), Collected(tmp_path, "-m", "full")
    assert sorted(default + rest) == sorted(everything)
    assert {name for name, _ in rest} == {"test_thinned", "test_some"}
    assert [case for name, case in default if name == "test_some"] == ["0", "4", "9"]
    assert sum(name == "test_thinned" for name, _ in everything) == 18
    assert sum(name == "test_thinned" for name, _ in default) == 9
    one = f"test_it.py::test_thinned[{rest[0][1]}]"
    assert Collected(tmp_path, "-m", "not full", one) == [rest[0]]


def test_slow_tests_are_there():
    for file, name in SlowTests():
        assert f"def {name}(" in (HERE / file).read_text(), f"slow.txt: {file} has no {name}"
