"""What the command line of every example does with numbers, errors and Ctrl-C."""

import json
from argparse import ArgumentTypeError

import command
import numpy as np
import pytest
from command import Count, NotNegative, Options, Positive, Start

from ngslac import ContactConvergenceError


def Refused(capsys, main, *arguments):
    """The one line with which `main` refuses its arguments."""
    with pytest.raises(SystemExit) as end:
        main([*arguments])
    assert end.value.code == 2
    usage, _, error = capsys.readouterr().err.rstrip().rpartition("\n")
    assert usage.startswith("usage:")
    assert "Traceback" not in usage
    return error


def Command(run):
    """A ``main`` with one option."""

    def Main(arguments):
        parser = Options("text")
        parser.add_argument("--h", type=Positive, default=0.5, help="size")
        return Start(run, parser, arguments)

    return Main


def test_numbers_are_written_to_a_new_folder(tmp_path):
    def Run(h, out, quiet):
        assert (out, quiet) == (tmp_path, True)
        return {"double": np.float64(2 * h), "all": [1, None, True]}

    file = tmp_path / "new" / "numbers.json"
    Command(Run)(["--h", "3", "--out", str(tmp_path), "--quiet", "--json", str(file)])
    found = json.loads(file.read_text())
    assert found.pop("seconds") >= 0
    assert found == {"double": 6.0, "all": [1, None, True]}


@pytest.mark.parametrize(
    ("error", "message"),
    [(KeyboardInterrupt(), "interrupted"), (ContactConvergenceError("too far"), "too far")],
)
def test_the_end_is_one_line(error, message, tmp_path):
    def Run(**options):
        raise error

    file = tmp_path / "numbers.json"
    with pytest.raises(SystemExit, match=message) as end:
        Command(Run)(["--json", str(file)])
    assert end.value.code == message
    assert end.value.__suppress_context__
    assert not file.exists()


def test_a_failure_on_the_way_ends_the_script_after_its_numbers(tmp_path):
    file = tmp_path / "numbers.json"
    with pytest.raises(SystemExit, match="too far") as end:
        Command(lambda **options: {"steps": 3, "failure": "too far"})(["--json", str(file)])
    assert end.value.code == "too far"
    assert json.loads(file.read_text())["steps"] == 3


def test_bad_input_is_refused(capsys):
    def Run(**options):
        raise ValueError("h = 0.5 is too coarse")

    assert Refused(capsys, Command(Run)).endswith("error: h = 0.5 is too coarse")
    assert "--h: inf is no finite number > 0" in Refused(capsys, Command(Run), "--h", "inf")


def test_pictures_without_matplotlib_are_refused_before_the_work(capsys, monkeypatch):
    monkeypatch.setattr(command, "find_spec", lambda name: None)
    assert "pip install matplotlib" in Refused(capsys, Command(None), "--out", "here")


@pytest.mark.parametrize(
    ("kind", "good", "bad"),
    [
        (Positive, "0.5", "0"),
        (NotNegative, "0", "-1"),
        (NotNegative, "1", "nan"),
        (Count, "1", "0"),
    ],
)
def test_kinds_of_numbers(kind, good, bad):
    assert kind(good) == float(good)
    with pytest.raises(ArgumentTypeError, match=bad):
        kind(bad)
