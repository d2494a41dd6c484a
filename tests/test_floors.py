"""Includes of the C++ sources run one way: from a folder to those below it."""

import re
from pathlib import Path

import pytest

CPP = Path(__file__).parents[1] / "cpp"
# What stands beside the folders is for all of them, but for the list of what Python gets.
BELOW = {
    "linear": [],
    "mesh": [],
    "surface": ["mesh"],
    "pairing": ["mesh", "surface"],
    "space": ["mesh", "surface", "pairing"],
    "contact": ["linear", "mesh", "surface", "pairing", "space"],
}
SOURCES = {str(p.relative_to(CPP)): p for p in sorted(CPP.rglob("*.[ch]pp"))}
ROOT = {name for name in SOURCES if "/" not in name}
INCLUDE = re.compile(r'^#include "(.+)"$', re.MULTILINE)


def included(name):
    """What a source includes of ours, from its own folder or from the root."""
    home = name.rpartition("/")[0]
    for target in INCLUDE.findall(SOURCES[name].read_text()):
        yield f"{home}/{target}" if "/" not in target and target not in ROOT else target


def test_every_folder_has_a_floor():
    assert {name.partition("/")[0] for name in SOURCES} - ROOT == set(BELOW)


@pytest.mark.parametrize("name", SOURCES)
def test_includes_run_downwards(name):
    home = name.partition("/")[0]
    if name in ROOT:
        assert [*included(name)] == []
        return
    targets = [*included(name)]
    assert set(targets) <= set(SOURCES)
    folders = {t.partition("/")[0] for t in targets if t not in ROOT}
    assert folders <= {home, *BELOW[home]}
