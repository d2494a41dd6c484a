"""Test processes that run side by side share the cores instead of each taking all of them."""

import os

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
if "PYTEST_XDIST_WORKER" in os.environ:
    os.environ.setdefault("NGS_NUM_THREADS", "1")
