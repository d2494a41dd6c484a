"""The package as installed: versions, public names, and the example of the README."""

import importlib
import inspect
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


def test_public_names():
    assert dir(ngslac) == sorted(ngslac.__all__)
    assert not hasattr(ngslac, "nothing")


def test_signatures_are_known():
    wanted = "(V, *, slave, macros=None, components=None, autoupdate=False, axisymmetric=False)"
    assert str(inspect.signature(ngslac.LACSpace)) == wanted
    assert "friction" in inspect.signature(ngslac.LACContact).parameters


LATER = "scipy.sparse", "scipy.spatial", "scipy.linalg", "scipy.optimize", "pyamg", "netgen.csg"


def test_tracers_and_profiles_tell_calls_apart():
    contact = ngslac.LACContact
    assert [f.__code__.co_name for f in (contact.Update, contact.Commit)] == ["Update", "Commit"]


def test_the_import_leaves_alone_what_only_some_calls_need():
    code = f"import sys, ngslac; print(sorted({{*{LATER}}} & {{*sys.modules}}))"
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert run.stdout == "[]\n"


def test_the_package_depends_on_the_release_it_was_built_with():
    assert _version.RequiredNGSolve() == _version.version("ngsolve")


@pytest.fixture
def backend(monkeypatch):
    monkeypatch.syspath_prepend(str(ROOT / "cpp"))
    pytest.importorskip("scikit_build_core", reason="it is there while the package is built")
    return importlib.import_module("backend")


def test_the_build_asks_for_ngsolve_where_there_is_none(backend, monkeypatch):
    monkeypatch.setattr(backend, "Installed", lambda: None)
    assert backend.Missing() == [f"ngsolve=={backend.PIN}"]


@pytest.mark.parametrize("installed", ["6.2.2606", "6.2.2606.post3", "6.2.2612", "6.3.1"])
def test_the_build_takes_the_release_that_is_installed(backend, monkeypatch, installed):
    monkeypatch.setattr(backend, "Installed", lambda: installed)
    assert backend.Missing() == []
    depends = backend.dynamic_metadata("dependencies", {"others": ["numpy"]}, {"urls": {}})
    assert depends == [f"ngsolve=={installed}", "numpy"]


def test_a_release_that_is_too_old_is_refused(backend, monkeypatch):
    monkeypatch.setattr(backend, "Installed", lambda: "6.2.2401")
    with pytest.raises(RuntimeError, match=r"ngsolve 6\.2\.2401 is installed.*pip install"):
        backend.Missing()
