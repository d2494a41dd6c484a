"""What every example promises for its command line."""

import pytest


def Refused(capsys, main, *arguments):
    """The one line with which `main` refuses its arguments."""
    with pytest.raises(SystemExit) as end:
        main([*arguments])
    assert end.value.code == 2
    usage, _, error = capsys.readouterr().err.rstrip().rpartition("\n")
    assert usage.startswith("usage:")
    assert "Traceback" not in usage
    return error


def Help(capsys, main):
    """The text of ``--help``."""
    with pytest.raises(SystemExit) as end:
        main(["--help"])
    assert end.value.code == 0
    return capsys.readouterr().out
