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
    "tool": ["mesh", "surface", "pairing"],
    "contact": ["linear", "mesh", "surface", "pairing", "space", "tool"],
    "contact/finite": ["linear", "mesh", "surface", "pairing", "space", "contact"],
    "contact/tool": ["pairing", "tool", "contact", "contact/finite"],
}
SOURCES = {str(p.relative_to(CPP)): p for p in sorted(CPP.rglob("*.[ch]pp"))}
ROOT = {name for name in SOURCES if "/" not in name}
INCLUDE = re.compile(r'^#include "(.+)"$', re.MULTILINE)


def folder(name):
    return name.rpartition("/")[0]


def included(name):
    """What a source includes of ours, from its own folder or from the root."""
    home = folder(name)
    for target in INCLUDE.findall(SOURCES[name].read_text()):
        yield f"{home}/{target}" if "/" not in target and target not in ROOT else target


def test_every_folder_has_a_floor():
    assert {*map(folder, SOURCES)} == {"", *BELOW}


@pytest.mark.parametrize("name", SOURCES)
def test_includes_run_downwards(name):
    if name in ROOT:
        assert [*included(name)] == []
        return
    targets = [*included(name)]
    assert set(targets) <= set(SOURCES)
    home = folder(name)
    assert {*map(folder, targets)} <= {"", home, *BELOW[home]}
