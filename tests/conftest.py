"""Test processes that run side by side share the cores instead of each taking all of them."""

import os

import pytest
from pairwise import MarkFull

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
if "PYTEST_XDIST_WORKER" in os.environ:
    os.environ.setdefault("NGS_NUM_THREADS", "1")


def pytest_configure(config):
    config.option.loadscopereorder = False  # of pytest-xdist: keep the order below


def pytest_collection_modifyitems(items):
    """The notebooks first, then the site, which shows them as they ran there; pairs of options."""

    def Rank(item):
        return 0 if item.path.parent.name == "tutorials" else 1 + (item.path.name != "test_site.py")

    if changing := [item.nodeid for item in items if " at 0x" in item.nodeid]:
        raise pytest.UsageError(f"{changing[0]} has another name in each process: give it an id")
    items.sort(key=Rank)
    MarkFull(items)
