"""Scripts end on all processes, whatever some of them leave out."""

import os
import subprocess
import sys
from pathlib import Path
from tempfile import TemporaryDirectory

import pytest
from parallel_start import ENVIRONMENT, OPTIONS, missing

SCRIPT = Path(__file__).with_name("parallel_ends.py")
LIMIT = 120.0  # seconds

pytestmark = pytest.mark.skipif(missing() is not None, reason=f"distributed runs: {missing()}")


def ended(how):
    """The exit status of a script on three processes, and what it said.

    Each process has a file for that: of what is printed at the end, mpiexec may lose a part.
    """
    with TemporaryDirectory() as folder:
        ranked = ["sh", "-c", f'exec "$@" 2> {folder}/$OMPI_COMM_WORLD_RANK', "sh"]
        start = ["mpiexec", *OPTIONS, "-n", "3", *ranked, sys.executable, str(SCRIPT), how]
        environment = os.environ | ENVIRONMENT
        done = subprocess.run(start, capture_output=True, text=True, env=environment, timeout=LIMIT)
        said = [file.read_text() for file in Path(folder).iterdir()]
    return done.returncode, "".join([*said, done.stderr])


@pytest.mark.parametrize(
    ("how", "said"),
    [
        ("first", "process 0 calls LACContact.Evaluate while process 1 has ended"),
        pytest.param(
            "last",
            "process 2 calls LACContact.Evaluate while process 0 has ended",
            marks=pytest.mark.full,
        ),
        ("error", "process 0 calls LACContact.Evaluate while process 2 has ended"),
    ],
)
def test_what_is_called_on_some_processes_is_an_error_at_the_end(how, said):
    status, words = ended(how)
    assert status != 0
    assert f"OutOfStepError: {said}" in words


def test_an_error_on_one_process_ends_the_run():
    """The others wait for it in a call of MPI, of which nobody can know."""
    status, words = ended("alone")
    assert status != 0
    assert "KeyError: 'of the user'" in words
    assert "process 2 has ended by an error, and others still run after 2 s" in words


def test_an_argument_that_differs_is_refused():
    status, words = ended("differs")
    assert status != 0
    assert (
        words.count("ValueError: ContactSolver.Reaction: region = 'top' on process 0 and 'bottom'")
        == 3
    )


def test_a_long_wait_is_said():
    status, words = ended("slow")
    assert status == 0, words
    assert "for others to call LACContact.Evaluate, too: what belongs to a distributed" in words
