"""The examples cattaneo3d and twist on the coarsest meshes: numbers, command line, files."""

import json

import cattaneo3d
import pytest
import twist
from commandline import Help, Refused

COARSE = ["--elements", "2", "--steps", "2"]


@pytest.mark.parametrize(
    ("example", "curve", "options"),
    [(cattaneo3d, "shear", ["--reverse", "1"]), (twist, "moment_ratio", ["--smooth", "--quiet"])],
)
def test_friction3d_command(example, curve, options, tmp_path, capsys):
    pytest.importorskip("matplotlib")
    file = tmp_path / "new" / "figures.json"
    example.main([*COARSE, *options, "--out", str(tmp_path), "--json", str(file)])
    figures = json.loads(file.read_text())
    text = capsys.readouterr().out
    lines = 0 if "--quiet" in options else len(figures["newton_iterations"])
    assert text.count("Newton iterations") == lines
    assert ("stick_ratio_exact" in text) == (lines > 0)
    for end in (".png", ".vtu", "_contact.vtu"):
        assert (tmp_path / f"{example.__name__}{end}").stat().st_size > 5000
    values = [row[curve] for row in figures["steps"][:2]]
    assert 0.3 < values[0] < values[1] < 1
    assert figures["stiffness_ratio"] == pytest.approx(1, abs=0.35)
    assert figures["newton_max"] <= 10
    for row in figures["steps"]:
        assert row["open"] + row["stick"] + row["slip"] == figures["macros"]


@pytest.mark.parametrize(
    ("example", "arguments", "message"),
    [
        (cattaneo3d, ["--model", "quarter"], "'half', 'full'"),
        (cattaneo3d, ["--shear", "1"], "would slide"),
        (cattaneo3d, ["--reverse", "-1"], "reverse = -1"),
        (cattaneo3d, ["--elements", "0"], "--elements"),
        (twist, ["--model", "half"], "'quarter', 'full'"),
        (twist, ["--stabilize", "split"], "'none', 'bubble'"),
        (twist, ["--angle", "-1"], "--angle"),
        (twist, ["--friction", "0"], "--friction"),
    ],
)
def test_friction3d_refusals(example, arguments, message, capsys):
    assert message in Refused(capsys, example.main, *arguments)


@pytest.mark.parametrize("example", [cattaneo3d, twist])
def test_friction3d_help(example, capsys):
    text = Help(capsys, example.main)
    assert f"python tutorials/examples/{example.__name__}.py --out results" in text
    assert "(default: 0.3)" in text
