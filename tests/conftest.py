"""Test processes that run side by side share the cores instead of each taking all of them."""

import os

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
if "PYTEST_XDIST_WORKER" in os.environ:
    os.environ.setdefault("NGS_NUM_THREADS", "1")


def pytest_collection_modifyitems(items):
    """The site last: it shows the notebooks that other tests have run by then."""
    items.sort(key=lambda item: item.path.name == "test_site.py")
