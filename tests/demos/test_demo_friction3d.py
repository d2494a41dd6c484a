"""The demos cattaneo3d and twist on the coarsest meshes: command line, files, refusals."""

import json

import pytest

from ngslac.demos import cattaneo3d, twist

COARSE = ["--elements", "2", "--steps", "2"]


@pytest.mark.parametrize(
    ("demo", "name", "curve", "options"),
    [
        (cattaneo3d, "cattaneo3d", "shear", ["--reverse", "1"]),
        (twist, "twist", "moment_ratio", ["--smooth", "--quiet"]),
    ],
)
def test_command_line_writes_everything(demo, name, curve, options, tmp_path, capsys):
    pytest.importorskip("matplotlib")
    file = tmp_path / "new" / "figures.json"
    demo.main([*COARSE, *options, "--out", str(tmp_path), "--json", str(file)])
    figures = json.loads(file.read_text())
    text = capsys.readouterr().out
    lines = 0 if "--quiet" in options else len(figures["newton_iterations"])
    assert text.count("Newton iterations") == lines
    assert ("stick radius" in text) == (lines > 0)
    ends = ["_curve.png", "_traction.png", "_status.html", "_traction.html", ".vtu", "_contact.vtu"]
    for end in ends:
        assert (tmp_path / f"{name}{end}").stat().st_size > 5000
    values = [row[curve] for row in figures["steps"][:2]]
    assert 0.3 < values[0] < values[1] < 1
    assert figures["stiffness_ratio"] == pytest.approx(1, abs=0.35)
    assert figures["newton_max"] <= 10
    for row in figures["steps"]:
        assert row["open"] + row["stick"] + row["slip"] == figures["macros"]


@pytest.mark.parametrize(
    ("demo", "options", "message"),
    [
        (cattaneo3d, {"model": "quarter"}, "one plane of symmetry"),
        (cattaneo3d, {"shear": 1.0}, "would slide"),
        (cattaneo3d, {"elements": 0}, "elements"),
        (twist, {"model": "half"}, "no plane of symmetry"),
        (twist, {"model": "third"}, "quarter, half, full"),
        (twist, {"stabilize": "split"}, "none or bubble"),
        (twist, {"angle": -1.0}, "angle"),
        (twist, {"friction": 0.0}, "friction"),
    ],
)
def test_bad_options(demo, options, message):
    with pytest.raises(ValueError, match=message):
        demo.Run(**options)
