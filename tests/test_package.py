"""The package as installed: versions, public names, and the example of the README."""

import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from ngslac import _version

ROOT = Path(__file__).parents[1]


def test_versions_that_do_not_fit_are_both_named(monkeypatch):
    monkeypatch.setattr(_version, "RequiredNGSolve", lambda: "6.2.1234")
    with pytest.raises(ImportError, match=r"built for ngsolve 6\.2\.1234, but ngsolve 6\.2\.2"):
        _version.CheckNGSolve()


def test_a_missing_ngsolve_is_named(monkeypatch):
    def Missing(name):
        raise _version.PackageNotFoundError(name)

    monkeypatch.setattr(_version, "version", Missing)
    monkeypatch.setattr(_version, "RequiredNGSolve", lambda: "6.2.1234")
    with pytest.raises(ImportError, match=r"no ngsolve is installed.*pip install ngsolve=="):
        _version.CheckNGSolve()


def test_sources_without_the_plugin_say_so(tmp_path):
    ignore = shutil.ignore_patterns("*.so", "__pycache__")
    shutil.copytree(ROOT / "ngslac", tmp_path / "ngslac", ignore=ignore)
    code = (
        f"import sys; sys.meta_path[:] = sys.meta_path[-3:]; sys.path.insert(0, {str(tmp_path)!r})"
    )
    run = subprocess.run(
        [sys.executable, "-c", f"{code}; import ngslac"], capture_output=True, text=True
    )
    assert run.returncode
    assert "holds the sources of ngslac, not the compiled plugin" in run.stderr


def test_build_and_run_time_pins_agree():
    pins = re.findall(r"ngsolve==([\d.]+)", (ROOT / "pyproject.toml").read_text())
    assert len(pins) == 2
    assert len(set(pins)) == 1
