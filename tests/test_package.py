"""The package as installed: versions, public names, and the example of the README."""

import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

import ngslac
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


@pytest.mark.parametrize("name", [n for n in ngslac.__all__ if not n.startswith("_")])
def test_public_names_are_documented(name):
    text = getattr(ngslac, name).__doc__
    assert text
    assert len(text) > 80 or issubclass(getattr(ngslac, name), Exception)


def test_example_of_the_readme(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    code = re.search(r"```python\n(.*?)```", (ROOT / "README.md").read_text(), re.S).group(1)
    names = {}
    exec(compile(code, "README.md", "exec"), names)
    # The traction on the top edge of length 1 is carried by contact alone.
    assert names["contact"].Force() == pytest.approx([20, 100], rel=1e-10)
    assert (tmp_path / "blocks.vtu").exists()
