"""Test processes that run side by side share the cores instead of each taking all of them."""

import os

import pytest
from pairwise import MarkFull, MarkSlow

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
if "PYTEST_XDIST_WORKER" in os.environ:
    os.environ.setdefault("NGS_NUM_THREADS", "1")

# The site shows the notebooks as they ran in the tests of the tutorials, all of which have ended
# when that of the site begins: what others still run it would run once more.
FIRST = ("tutorials", "validation", "test_site.py", "examples", "solver")


def ByOneThread(generate):
    """Netgen's `GenerateMesh` that makes the same mesh with one thread."""

    def Generate(self, *args, parallel_meshing=False, **options):
        return generate(self, *args, parallel_meshing=parallel_meshing, **options)

    return Generate


def pytest_configure(config):
    """On busy cores the threads of netgen take many times longer than one alone."""
    from netgen.csg import CSGeometry  # after the numbers of threads above
    from netgen.occ import OCCGeometry

    config.option.loadscopereorder = False  # of pytest-xdist: keep the order below
    for geometry in (CSGeometry, OCCGeometry):
        geometry.GenerateMesh = ByOneThread(geometry.GenerateMesh)


def pytest_collection_modifyitems(items):
    """The long files first, so that no process ends alone with one of them; pairs of options."""

    def Rank(item):
        names = (item.path.parent.name, item.path.name)
        return next((k for k, name in enumerate(FIRST) if name in names), len(FIRST))

    if changing := [item.nodeid for item in items if " at 0x" in item.nodeid]:
        raise pytest.UsageError(f"{changing[0]} has another name in each process: give it an id")
    items.sort(key=Rank)
    MarkFull(items)
    MarkSlow(items)


@pytest.fixture
def whole_systems(monkeypatch):
    """Contact conditions are not solved on the surfaces alone, which leaves more to be seen."""
    monkeypatch.setattr("ngslac.solve.system.System.ContactCorrection", lambda *_: None)
