"""Files are there as a whole or not at all, and every writer says why it cannot."""

import os
import resource
import signal
from contextlib import contextmanager

import continued
import pytest

from ngslac import LACContact, SaveState
from ngslac.files import Replacing
from ngslac.output.vtkfile import IsComplete


@pytest.fixture(scope="module")
def stepper():
    return continued.half(continued.loading(nonlinear=False))


@pytest.fixture(params=["fields", "segments", "state"])
def writer(request, stepper):
    """A function that writes, and the suffix that it adds."""
    (contact,) = stepper.solver.contacts
    return {
        "fields": (contact.WriteVTU, ".vtu"),
        "segments": (contact.Segments().WriteVTU, ".vtu"),
        "state": (lambda file: SaveState(file, stepper), ""),
    }[request.param]


@pytest.mark.parametrize(
    ("name", "error", "match"),
    [
        (3, TypeError, "file(name)? = 3 must be the name of a file"),
        ("", ValueError, "file(name)? = '' must be the name of a file"),
        ("missing/a", FileNotFoundError, r"the folder .*missing is missing; make it first"),
        ("folder", IsADirectoryError, "is a folder"),
        ("pipe", OSError, "no regular file"),
    ],
)
def test_places_where_no_file_can_be(name, error, match, writer, tmp_path):
    write, suffix = writer
    (tmp_path / f"folder{suffix}").mkdir()
    os.mkfifo(tmp_path / f"pipe{suffix}")
    with pytest.raises(error, match=match):
        write(tmp_path / name if name and name != 3 else name)
    assert (tmp_path / f"pipe{suffix}").is_fifo()


@contextmanager
def full_disk():
    before = signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
    limits = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (1000, limits[1]))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, limits)
        signal.signal(signal.SIGXFSZ, before)


def test_the_older_file_stays_on_a_full_disk(writer, tmp_path):
    write, suffix = writer
    older = tmp_path / f"a.b{suffix}"
    older.write_text("older")
    with pytest.raises(OSError, match=r"could not be written|too large"), full_disk():
        write(tmp_path / "a.b")
    assert os.listdir(tmp_path) == [older.name]
    assert older.read_text() == "older"
    assert not IsComplete(tmp_path / "nothing")
    write(str(tmp_path / "a.b"))
    assert os.listdir(tmp_path) == [older.name]
    assert older.stat().st_size > 1000


def test_a_link_stays_a_link(writer, tmp_path):
    write, suffix = writer
    link, target = (tmp_path / f"{name}{suffix}" for name in ("link", "target"))
    link.symlink_to(target)
    write(tmp_path / "link")
    assert link.is_symlink()
    assert target.is_file()


def test_an_interrupt_and_what_cannot_be_saved_leave_nothing(tmp_path, stepper, monkeypatch):
    with pytest.raises(KeyboardInterrupt), Replacing(tmp_path / "text") as part:  # noqa: PT012
        part.write_text("half")
        raise KeyboardInterrupt
    monkeypatch.setattr(LACContact, "State", lambda self: os.listdir)
    with pytest.raises(TypeError, match=r"a \w*function\w* cannot be saved"):
        SaveState(tmp_path / "state", stepper)
    assert not os.listdir(tmp_path)
