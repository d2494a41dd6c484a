"""Examples under mpiexec: the figures of a single process, written and printed once."""

import json
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from parallel_start import ENVIRONMENT, OPTIONS, missing

EXAMPLES = Path(__file__).parents[2] / "tutorials" / "examples"
RUNS = {"hertz3d": "--h 1.25 --friction 0.1 --steps 2", "ironing": "--h 0.6 --steps 4 --stroke 1"}

pytestmark = pytest.mark.skipif(missing() is not None, reason=f"distributed runs: {missing()}")


def figures(name, folder, *start):
    """The numbers of an example, and what it printed."""
    folder.mkdir()
    options = [*RUNS[name].split(), "--json", "figures.json"]
    run = subprocess.run(
        [*start, sys.executable, str(EXAMPLES / f"{name}.py"), *options],
        env=os.environ | ENVIRONMENT,
        cwd=folder,
        capture_output=True,
        text=True,
        timeout=200,
    )
    assert run.returncode == 0, run.stderr
    assert [path.name for path in folder.iterdir()] == ["figures.json"]
    return json.loads((folder / "figures.json").read_text()), run.stdout


def differ(one, two):
    """The largest difference, over the largest number; residuals are left out by the caller."""
    if one is None or isinstance(one, (str, bool)):
        return 0.0 if one == two else np.inf
    one, two = np.asarray(one, dtype=float), np.asarray(two, dtype=float)
    return np.abs(one - two).max() / (np.abs(one).max() or 1.0)


@pytest.mark.parametrize("name", [pytest.param("hertz3d", marks=pytest.mark.full), "ironing"])
def test_an_example_takes_mpiexec(name, tmp_path):
    serial, text = figures(name, tmp_path / "serial")
    found, words = figures(name, tmp_path / "ranks", "mpiexec", *OPTIONS, "-n", "3")
    assert found.keys() == serial.keys()
    # Residuals end in rounding, and seconds differ from run to run; processes take whole systems.
    names = [key for key in serial if key not in ("seconds", "iterations")]
    names = [key for key in names if "residuals" not in key]
    assert {key: differ(serial[key], found[key]) < 1e-9 for key in names} == dict.fromkeys(
        names, True
    )
    assert words == text
