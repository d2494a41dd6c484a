"""What the sanitizer command reads from the output of a process; which plugin it looks at."""

import shutil
import subprocess
import sys
from importlib.util import module_from_spec, spec_from_file_location
from pathlib import Path

import pytest
from sanitizer_build import Environment
from sanitizer_findings import Findings
from sanitizer_tests import RunCommand, RunTests

from ngslac import _ngslac

RUN = Path(__file__).with_name("run.py")
ADDRESS = """....=================================================================
==27==ERROR: AddressSanitizer: heap-buffer-overflow on address 0x7f82 at pc 0x7f81 bp 0x7f sp 0x7f
READ of size 8 at 0x7f82 thread T0
    #0 0x7f81fd in std::shared_ptr<int>::get() const /usr/include/c++/12/bits/shared_ptr_base.h:1666
    #1 0x7f81fe in ngslac::ProxyInfo::ProxyInfo(string const&) /some/cpp/contact/jump.cpp:15
    #2 0x7f821f in cfunction_vectorcall Objects/methodobject.c:443

0x7f82 is located 0 bytes to the right of 12-byte region
SUMMARY: AddressSanitizer: heap-buffer-overflow /usr/include/c++/12/bits/shared_ptr_base.h:1666
"""
UNDEFINED = """.../some/cpp/pairing/facets.hpp:7:8: runtime error: load of value {}, no bool
    #0 0x7ff218d3e3f9 in ngslac::Facet::operator=(ngslac::Facet&&) /some/cpp/pairing/facets.hpp:7
"""
ELSEWHERE = """==27==ERROR: AddressSanitizer: heap-use-after-free on address 0x7f82 at pc 0x7f81
    #0 0x7f81fd  (/some/libngcomp.so+0x2f98a)
    #1 0x7f821f in cfunction_vectorcall Objects/methodobject.c:443
"""
MISMATCH = """==27==ERROR: AddressSanitizer: alloc-dealloc-mismatch (operator new [] vs ...)
    #0 0x7efc14aba3c8 in operator delete(void*, unsigned long) asan_new_delete.cpp:164
    #1 0x7efbfade4f7c in {}(value_and_holder&) (/some/libngcomp.so+0xad6f02)
"""
DEALLOC = "pybind11::class_<ngfem::FiniteElement, int>::dealloc_without_manipulating_gil"


@pytest.mark.parametrize(
    ("text", "what", "where", "ours", "known"),
    [
        (ADDRESS, "AddressSanitizer: heap-buffer-overflow", "/contact/jump.cpp:15", True, False),
        (UNDEFINED.format(25), "load of value .., no bool", "/facets.hpp:7", True, False),
        (ELSEWHERE, "AddressSanitizer: heap-use-after-free", "libngcomp.so+0x2f98a)", False, False),
        (MISMATCH.format(DEALLOC), "AddressSanitizer: alloc-dealloc-mismatch", "", False, True),
        # There only: the same mismatch in a class of ngslac is a finding.
        (MISMATCH.format("ngslac::Surface::~Surface"), "alloc-dealloc-mismatch", "", False, False),
    ],
)
def test_finding(text, what, where, ours, known):
    (finding,) = Findings(text)
    assert finding.what.endswith(what)
    assert where in finding.where
    assert (finding.ours, finding.known) == (ours, known)
    assert finding.frames
    assert what in finding.Text()


def test_findings_are_told_apart():
    one, same, other = Findings(UNDEFINED.format(255) + UNDEFINED.format(7) + ADDRESS)
    assert one.key == same.key != other.key
    assert Findings("....\n4 passed in 0.50s\n") == []


@pytest.mark.full
def test_a_test_that_aborts_is_no_success(tmp_path):
    """Nor one that fails, or that runs too long: none of them is left out of the table."""
    ends = {"abort": "import os; os.abort()", "fail": "assert False", "loop": "while True: pass"}
    files = [tmp_path / f"test_{name}.py" for name in ends]
    for file, code in zip(files, ends.values(), strict=True):
        file.write_text(f"def test_it():\n    {code}\n")
    (_, aborted), (_, failed) = RunTests(files[:2], None, 2, limit=60)
    ((_, stopped),) = RunTests(files[2:], None, 1, limit=1)
    assert "-6" in aborted.ended
    assert (failed.counts, failed.ended) == ({"failed": 1}, "")
    assert "1 s" in stopped.ended


def test_command_needs_no_compiler_to_judge():
    spec = spec_from_file_location("sanitizers_run", RUN)
    run = module_from_spec(spec)
    spec.loader.exec_module(run)
    good = dict.fromkeys(run.BAD, 0)
    assert run.IsGood(good)
    assert not any(run.IsGood(good | {name: 1}) for name in run.BAD)
    command = [sys.executable, RUN, "--help"]
    assert b"--kind" in subprocess.run(command, check=True, capture_output=True).stdout


def test_findings_of_processes_count(tmp_path):
    script = tmp_path / "script.py"
    script.write_text(f"import os\nos.write(2, {ADDRESS.encode()!r})\nprint('3 passed in 1.0s')\n")
    outcome = RunCommand([script], None, 60)
    assert [finding.ours for finding in outcome.findings] == [True]
    assert outcome.counts == {"passed": 3}


def test_processes_import_the_plugin_that_was_built(tmp_path):
    plugin = Path(shutil.copy(_ngslac.__file__, tmp_path))
    code = "import ngsolve; from ngslac import _ngslac; print(_ngslac.__file__)"
    process = subprocess.run(
        [sys.executable, "-c", code], env=Environment("range", plugin), capture_output=True
    )
    assert process.stdout.decode().split() == [str(plugin)]
