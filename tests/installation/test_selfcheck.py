"""`python -m ngslac` says what is installed, and its check tells right from wrong."""

import platform
import subprocess
import sys

import ngsolve
import numpy as np
import pytest

import ngslac
from ngslac import __main__ as command
from ngslac.installation import inventory
from ngslac.installation.selfcheck import CASES, Differs, Errors


@pytest.mark.parametrize("name", CASES)
def test_the_cases_are_exact_to_rounding(name):
    assert np.all(Errors(*CASES[name]) < 1e-12)


@pytest.mark.parametrize("case", [(2, 1.0, -0.01), (3, 1.5, 0.0)], ids=["turned", "much"])
def test_what_friction_cannot_carry_is_noticed(case):
    text = Differs(*case)
    assert "stress off by" in text
    assert "contact force off by" in text


def test_an_error_is_a_result():
    assert Differs(2, 1.0, float("nan")).startswith("ValueError: ")


def test_versions_and_solvers():
    found = inventory.Inventory()
    assert found["ngslac"] == ngslac.__version__
    assert ngsolve.__version__.startswith(found["ngsolve"])
    assert found["Python"].startswith(platform.python_version())
    assert {"sparsecholesky", "umfpack"} <= set(found["direct solvers"].split(", "))
    assert not inventory.Serves("no such solver")


def test_missing_packages_are_said(monkeypatch):
    def Missing(_=None):
        raise ImportError

    monkeypatch.setattr(inventory, "LoadPETSc", Missing)
    monkeypatch.setattr(inventory.importlib.util, "find_spec", lambda name: None)
    found = inventory.Inventory()
    assert found["PETSc"] == "not found (needs petsc4py)"
    assert found["MPI"] == "not found (needs mpi4py)"
    assert inventory.Version("no-such-package") == "not found"


def test_the_command_tells_how_to_check(capsys):
    assert command.main([]) == 0
    assert capsys.readouterr().out.endswith("python -m ngslac --check\n")


def test_a_failure_is_the_exit_status(monkeypatch, capsys):
    monkeypatch.setattr(command, "CASES", {"good": (2, 0.5, 0.0), "bad": (2, 1.0, -0.01)})
    assert command.main(["--check"]) == 1
    assert capsys.readouterr().out.endswith("1 of 2 checks failed\n")


def test_the_command_passes():
    run = subprocess.run(
        [sys.executable, "-m", "ngslac", "--check"], capture_output=True, text=True
    )
    assert run.returncode == 0, run.stderr
    assert run.stdout.splitlines()[-1] == "pass"
    assert [line.split(":")[0] for line in run.stdout.splitlines()[-5:-1]] == list(CASES)
