"""Tests of a single process under mpiexec, on meshes that all processes share."""

import os
import subprocess
import sys
from pathlib import Path

import pytest
from parallel_start import ENVIRONMENT, OPTIONS, missing

TESTS = Path(__file__).parents[1]
PATHS = os.pathsep.join(str(TESTS / name) for name in ("parallel", "problems"))
PLUGINS = ["-p", "serial_plugin", "-p", "no:cacheprovider"]
FILES = ["contact/test_failures.py"]

pytestmark = pytest.mark.skipif(missing() is not None, reason=f"distributed runs: {missing()}")


@pytest.mark.parametrize("name", FILES)
def test_they_pass_under_mpiexec(name, tmp_path):
    """The exit code is 0 only where some tests ran and all of them passed, on each process."""
    start = ["mpiexec", *OPTIONS, "-n", "3", sys.executable, "-m", "mpi4py", "-m", "pytest"]
    config = ["-c", str(TESTS.parent / "pyproject.toml"), "--rootdir", str(TESTS.parent)]
    pictures = ["-k", "not Plot"]  # which need matplotlib
    run = subprocess.run(
        [*start, *config, *PLUGINS, *pictures, str(TESTS / name)],
        env=os.environ | ENVIRONMENT | {"PYTHONPATH": PATHS},
        cwd=tmp_path,
        capture_output=True,
        text=True,
        timeout=200,
    )
    assert run.returncode == 0, run.stdout[-4000:] + run.stderr[-4000:]
