"""What the command line of every example does with numbers, errors and Ctrl-C."""

import json
from argparse import ArgumentTypeError
from pathlib import Path
from typing import Literal

import command
import numpy as np
import pytest
from command import Count, Main, NotNegative, Positive

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


def test_options_follow_from_the_signature(capsys):
    def Run(
        h=0.5,
        n=3,
        friction: NotNegative = 0.0,
        velocity: float = (2.0, -1.0),
        order: Literal[1, 2] = 2,
        kinds: Literal["a", "b"] = ("a",),
        full=False,
        hidden=1.0,
        out=None,
    ):
        """Return what is given.

        h : size
        n : number
        friction : coefficient
        velocity : of the start
        order : of the space
        kinds : some
        full : all of it
        """
        return {"given": (h, n, friction, velocity, order, kinds, full, hidden, out)}

    main = Main(Run)
    given = 0.5, 3, 0.0, (2.0, -1.0), 2, ("a",), False, 1.0, None
    assert main([])["given"] == given
    words = "--h 2 --n 4 --friction 0 --velocity -1 0 --order 1 --kinds b a --full --out here"
    given = 2.0, 4, 0.0, [-1.0, 0.0], 1, ["b", "a"], True, 1.0, Path("here")
    assert main(words.split())["given"] == given
    refused = "--h 0;--n 0;--n few;--friction -1;--velocity 1;--order 3;--kinds c;--hidden 2"
    for case in refused.split(";"):
        assert case.split()[0] in Refused(capsys, main, *case.split())


def test_numbers_are_written_to_a_new_folder(tmp_path, capsys):
    def Run(h=0.5, out=None):
        """h : size"""
        print("something")
        assert out == tmp_path
        return {"double": np.float64(2 * h), "all": [1, None, True], "solution": Run}

    file = tmp_path / "new" / "numbers.json"
    main, words = Main(Run), ["--out", str(tmp_path), "--json", str(file)]
    for quiet in ([], ["--quiet"]):
        main([*words, *quiet])
        assert capsys.readouterr().out == ("" if quiet else "something\n")
    found = json.loads(file.read_text())
    assert found.pop("seconds") >= 0
    assert found == {"double": 1.0, "all": [1, None, True]}


@pytest.mark.parametrize(
    ("error", "message"),
    [(KeyboardInterrupt(), "interrupted"), (ContactConvergenceError("too far"), "too far")],
)
def test_the_end_is_one_line(error, message, tmp_path):
    def Run(out=None):
        raise error

    file = tmp_path / "numbers.json"
    with pytest.raises(SystemExit, match=message) as end:
        Main(Run)(["--json", str(file)])
    assert end.value.code == message
    assert end.value.__suppress_context__
    assert not file.exists()


def test_a_failure_on_the_way_ends_the_script_after_its_numbers(tmp_path):
    file = tmp_path / "numbers.json"
    with pytest.raises(SystemExit, match="too far") as end:
        Main(lambda out: {"steps": 3, "failure": "too far"})(["--json", str(file)])
    assert end.value.code == "too far"
    assert json.loads(file.read_text())["steps"] == 3


def test_bad_input_is_refused(capsys):
    def Run(h=0.5, out=None):
        """h : size"""
        raise ValueError("h = 0.5 is too coarse")

    assert Refused(capsys, Main(Run)).endswith("error: h = 0.5 is too coarse")
    assert "--h: inf is no finite number > 0" in Refused(capsys, Main(Run), "--h", "inf")


def test_pictures_without_matplotlib_are_refused_before_the_work(capsys, monkeypatch):
    monkeypatch.setattr(command, "find_spec", lambda name: None)
    assert "pip install matplotlib" in Refused(capsys, Main(lambda out: {}), "--out", "here")


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
