"""What the sanitizer command reads from the output of a process."""

import subprocess
import sys
from pathlib import Path

from sanitizer_check import BAD, IsGood
from sanitizer_findings import Findings
from sanitizer_tests import RunCommand, RunTests

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
    #1 0x7efc0b49d539 in std::_Sp_counted_base::_M_release() (libTKernel.so.7.8.1+0x8b539)
    #2 0x7efbfade4f7c in {}(value_and_holder&) (/some/libngcomp.so+0xad6f02)
"""
DEALLOC = "pybind11::class_<ngfem::FiniteElement, int>::dealloc_without_manipulating_gil"


def test_address():
    (finding,) = Findings(ADDRESS)
    assert finding.what == "AddressSanitizer: heap-buffer-overflow"
    assert finding.ours
    assert finding.where.endswith("/cpp/contact/jump.cpp:15")
    assert len(finding.frames) == 3


def test_undefined_after_dots():
    first, second = Findings(UNDEFINED.format(255) + UNDEFINED.format(7))
    assert first.ours
    assert first.place == "/some/cpp/pairing/facets.hpp:7"
    assert first.key == second.key


def test_what_does_not_pass_through_ngslac():
    ours, other = Findings(ADDRESS + ELSEWHERE)
    assert ours.ours
    assert not other.ours
    assert "libngcomp.so" in other.where


def test_what_is_known_of_the_wheel():
    """There only: the same mismatch in a class of ngslac is a finding."""
    known, other = Findings(MISMATCH.format(DEALLOC) + MISMATCH.format("ngslac::Surface::~Surface"))
    assert known.known
    assert not other.known
    assert not any(finding.known for finding in Findings(ADDRESS + ELSEWHERE))


def test_nothing():
    assert Findings("....\n4 passed in 0.50s\n") == []


def test_a_test_that_aborts_is_no_success(tmp_path):
    """Nor one that fails, or that runs too long: none of them is left out of the table."""
    ends = {"abort": "import os; os.abort()", "fail": "assert False", "loop": "while True: pass"}
    files = []
    for name, code in ends.items():
        files.append(tmp_path / f"test_{name}.py")
        files[-1].write_text(f"def test_it():\n    {code}\n")
    aborted, failed = RunTests(files[:2], None, 2, limit=60)
    (stopped,) = RunTests(files[2:], None, 1, limit=1)
    assert "-6" in aborted.ended
    assert failed.counts == {"failed": 1}
    assert not failed.ended
    assert "1 s" in stopped.ended
    good = dict.fromkeys(BAD, 0)
    assert IsGood(good)
    assert not any(IsGood(good | {name: 1}) for name in BAD)


def test_findings_of_processes_count(tmp_path):
    script = tmp_path / "script.py"
    script.write_text(f"import os\nos.write(2, {ADDRESS.encode()!r})\nprint('3 passed in 1.0s')\n")
    outcome = RunCommand([script], None, 60)
    assert [finding.ours for finding in outcome.findings] == [True]
    assert outcome.counts == {"passed": 3}


def test_help_needs_no_compiler():
    command = [sys.executable, Path(__file__).with_name("run.py"), "--help"]
    assert b"--kind" in subprocess.run(command, check=True, capture_output=True).stdout
