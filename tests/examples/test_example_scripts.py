"""Every example as a command: its numbers and files, its help, what it refuses."""

import json
from importlib import import_module

import hertz_large
import patch3d
import pytest
from patch3d import Case
from test_example_command import Refused

approx = pytest.approx
FEW = [Case("tet", 1, "split", True), Case("pyramid", 1, "agglomerated"), Case("hex", 2)]


@pytest.fixture(autouse=True)
def few(monkeypatch):
    monkeypatch.setattr(patch3d, "Cases", lambda friction: FEW)


def Order1(stabilize, ratio):
    options = f"--h 1 --steps 2 --power 1 --order 1 --stabilize {stabilize} --full --quiet"
    return "hertz", options, {"force_ratio": approx(1, abs=1e-10), "p0_ratio": ratio}, "", ""


def Hertz3D(options, steps=1):
    near = approx(1, abs=0.1)
    figures = {"force_ratio": approx(1, abs=1e-9), "p0_ratio": near, "contact_radius_ratio": near}
    figures |= {"newton_iterations": lambda found: len(found) == steps}
    files = "hertz3d.png hertz3d.vtu hertz3d_slave.vtu"
    return "hertz3d", options, figures, "p0_ratio ", files


def Friction3D(name, options, curve, printed):
    def Counted(steps, macros):
        values = [row[curve] for row in steps[:2]]
        counts = {row["open"] + row["stick"] + row["slip"] for row in steps}
        return 0.3 < values[0] < values[1] < 1 and counts == {macros}

    figures = {"steps macros": Counted, "stiffness_ratio": approx(1, abs=0.35)}
    figures |= {"newton_max": lambda newton: newton <= 10}
    files = f"{name}.png {name}.vtu {name}_contact.vtu"
    return name, f"--elements 2 --steps 2 {options}", figures, printed, files


def Patches(worst, rows):
    errors = [max(row["stress_error"], row["multiplier_error"]) for row in rows]
    right = [row["name"] for row in rows] == [case.name for case in FEW]
    return right and worst == max(errors) < 1e-11 and all(row["macros"] > 1 for row in rows)


# Script, options, numbers or what holds for them, something that is printed, files.
RUNS = [
    ("hertz", "--h 1 --steps 2", {
        "p0_ratio": approx(1.017, abs=3e-3), "force_ratio": approx(1, abs=1e-10),
        "newton_iterations": lambda each: len(each) == 2,
        "contact_edge seconds": lambda *values: min(values) > 0,
    }, "contact force 1.0000", "hertz.png hertz.vtu hertz_slave.vtu"),
    Order1("none", approx(1.0493, abs=1e-3)),
    Order1("split", approx(1.0294, abs=1e-3)),
    Order1("bubble", approx(1.0295, abs=1e-3)),
    Hertz3D("--shape sphere --h 0.9"),
    Hertz3D("--shape cylinder --h 0.9 --stabilize bubble --friction 0.1 --steps 2", 2),
    Friction3D("cattaneo3d", "--reverse 1", "shear", "stick_ratio_exact"),
    Friction3D("twist", "--smooth --quiet", "moment_ratio", ""),
    ("patch3d", "", {"max_error cases": Patches}, "in 3 cases",
     "patch3d.png patch3d_slave.vtu"),
    ("ironing", "--h 0.6 --steps 8 --stroke 0.4 --friction 0.1", {
        "quadratic": lambda value: isinstance(value, bool),
        "vertical_force time": lambda force, time: len(force) == len(time) == 8,
    }, "t = 1.040: down", "ironing.png ironing_foot.vtu"),
    ("hertz_large", "--h 0.2 --steps 2 --depth 0.02 --order 3", {
        "approach": approx([0.01, 0.02]),
        "force": lambda force: force[-1] == approx(hertz_large.HertzForce(0.02, 0.49), rel=0.1),
    }, "by Hertz", "hertz_large.png hertz_large_arc.vtu"),
    ("twistblocks", "--n 2 --steps 1 --angle 10 --friction 0 --rigid", {
        "angle": approx([0, 0, 10]),
        "torque force": lambda torque, force: abs(torque[-1]) < 1e-3 * force[-1],
    }, "10.0 degrees", "twistblocks.png twistblocks_face.vtu"),
    ("flatring", "--travel 0.2 --steps 2", {
        "converged_steps": 2, "travel": approx([0.1, 0.2]),
    }, "force on the plate", "flatring.png flatring_inside.vtu flatring_outside.vtu"),
    ("indentation", "--h 0.4 --steps 5 --depth 0.02", {
        "curve": lambda curve: len(curve) > 5,
        "prandtl": approx(2.9685, abs=1e-4), "onset_pressure": approx(1.79, rel=0.03),
    }, "mean pressure", "indentation.png indentation_top.vtu"),
    ("hertz_large", "--nu 0.4999 --mixed --h 0.08 --depth 0.05 --steps 1 --quiet", {
        "force hertz": lambda force, hertz: force == approx(hertz, rel=0.05),
    }, "", ""),
    ("heateddisc", "", {
        "pressure lame": lambda pressure, lame: pressure == approx(lame, rel=2e-3),
    }, "Lame", "heateddisc.png heateddisc_rim.vtu"),
    ("bouncing", "--h 0.4 --dt 0.04 --end 0.2 --velocity 2 -1", {
        "steps": lambda steps: steps >= 5, "contact_end": approx(0.2),
    }, "friction_ratio", "bouncing.png bouncing_outside.vtu"),
    ("belt", "--wrap 90 --thickness 0.02 --h 0.05", {
        "ratio ratio_exact": lambda ratio, exact: ratio == approx(exact, rel=0.02),
        "ratio_exact": approx(1.60198, abs=1e-5),
    }, "T2/T1", "belt.png belt_drum.vtu"),
    ("carter", "--h 0.4 --way 2", {
        "share share_exact": lambda *shares: shares[0] == approx(shares[1], abs=0.06),
        "stick": lambda found: found == sorted(found, reverse=True),
        "halfwidth": approx(1, abs=0.05),
    }, "Q/(mu P)", "carter.png carter_upper.vtu"),
    ("flatpunch", "--h 0.125 --friction 1", {
        "prandtl": approx(2.9685, abs=1e-4), "pressure": approx(2.9685, rel=0.04),
        "growth": approx(0, abs=1e-3), "curve": lambda curve: curve == sorted(curve),
    }, "Prandtl 2.9685", "flatpunch.png flatpunch_top.vtu"),
    ("upsetting", "--n 2 --friction 0 --depth 4 --steps 4", {
        "force_ratio": lambda found: found == approx([1, 1, 1, 1], abs=1e-6),
        "bulge": approx(0, abs=1e-9), "volume": approx(1, abs=3e-3),
    }, "without friction", "upsetting.png upsetting_die.vtu"),
    ("upsetting", "--n 2 --depth 1 --steps 2 --quiet", {
        "force_ratio": lambda found: 1.005 < min(found) < max(found) < 1.05,
        "bulge": lambda bulge: bulge > 0.1,
    }, "", ""),
    ("rolling", "--h 0.25 --steps 6", {
        "thickness": lambda found: found == approx([0.75, 0.5], abs=0.02),
        "volume": approx(1, abs=5e-3), "length": lambda length: length > 4.5,
    }, "thickness after both passes", "rolling.png rolling_top.vtu"),
    ("pyramid", "--h 0.5", {
        "cone_ratio outer_cone_ratio": lambda *ratios: ratios == approx((1, 1), abs=0.06),
        "pyramid_ratio": lambda ratio: 1.1 < ratio < 1.25,
    }, "over Sneddon's", "pyramid.png pyramid_top.vtu"),
    ("cup", "--h 0.2 --depth 0.01 --steps 2", {
        "holder_force": approx(3, rel=1e-6), "balance": approx(0, abs=1e-6),
        "volume": approx(1, abs=1e-3), "draw_in punch_force": lambda *values: min(values) > 0,
    }, "draw-in", "cup.png cup_die.vtu"),
]  # fmt: skip


# The others run each week; by default they are imported, print their help and refuse bad arguments.
CHEAP = "hertz", "patch3d", "belt", "twistblocks", "hertz_large"
RUNS = [run if run[0] in CHEAP else pytest.param(*run, marks=pytest.mark.full) for run in RUNS]


@pytest.mark.parametrize(("name", "options", "figures", "printed", "files"), RUNS)
def test_numbers_and_files(name, options, figures, printed, files, tmp_path, capsys):
    pytest.importorskip("matplotlib")
    file, out = tmp_path / "new" / "figures.json", tmp_path / "out"
    arguments = [*options.split(), "--json", str(file), *(["--out", str(out)] if files else [])]
    import_module(name).main(arguments)
    found = json.loads(file.read_text())
    for keys, expected in figures.items():
        values = [found[key] for key in keys.split()]
        assert expected(*values) if callable(expected) else values == [expected], (keys, values)
    text = capsys.readouterr().out
    assert printed in text if printed else text == ""
    sizes = {path.name: path.stat().st_size for path in out.glob("*")}
    assert {*files.split()} == sizes.keys()
    assert all(size > 1000 for size in sizes.values())


# Script, an option with its default, arguments that are refused: with what, if not with their name.
HELP = [
    ("hertz", 0.2, "--h 0; --friction -1; --steps 0; --stabilize some"),
    ("hertz3d", 0.3125, "--h 0; --shape cube; --friction -1"),
    ("cattaneo3d", 0.3, "--model quarter: 'half', 'full'; --shear 1: would slide; "
     "--reverse -1: reverse = -1; --elements 0"),
    ("twist", 0.3, "--model half: 'quarter', 'full'; --angle -1; --friction 0"),
    ("patch3d", 0.0, "--friction -1"),
    ("ironing", 80, "--steps 1: steps = 1; --order 1; --h -1.0; --stroke 11.0: stroke = 11"),
    ("hertz_large", 0.3, "--steps 0; --order 4; --nu 0.5: nu; --depth 0.8: depth = 0.8; --h 0"),
    ("twistblocks", 180.0, "--steps 0; --order 1; --friction -0.1; --n 1: n = 1"),
    ("flatring", 0.12, "--h 0; --steps few; --thickness 2: thickness = 2"),
    ("indentation", 0.08, "--steps 0; --depth -1; --yield-stress 0"),
    ("heateddisc", 0.001, "--heating -1"),
    ("bouncing", 0.17, "--h 0; --thickness 1.5: must be less than the radius; "
     "--velocity 1 0.5: downwards; --end 0.02 --h 0.5 --quiet: in the air until the time 0.02"),
    ("belt", 180.0, "--wrap 0; --friction -1; --thickness none; --h 0"),
    ("carter", 0.125, "--h 0; --way -1; --shares 0.5 0.7 1: would slide; --start 0"),
    ("flatpunch", 0.0625, "--h 0; --friction -1; --depth 0; --steps 0"),
    ("upsetting", 3.0, "--n 0; --friction -1; --depth 0; --steps 0; --depth 7: less than 6"),
    ("rolling", 0.167, "--h 0; --steps 0; --friction -1"),
    ("pyramid", 0.25, "--h 0"),
    ("cup", 0.25, "--h 0; --depth 0; --steps 0; --friction -1; --force 0"),
]  # fmt: skip


@pytest.mark.parametrize(("name", "default", "refused"), HELP)
def test_help_and_what_is_refused(name, default, refused, capsys):
    main = import_module(name).main
    with pytest.raises(SystemExit) as end:
        main(["--help"])
    assert end.value.code == 0
    text = capsys.readouterr().out
    assert f"python tutorials/examples/{name}.py" in text
    assert f"(default: {default})" in text
    for case in refused.split("; "):
        options, _, message = case.partition(": ")
        error = Refused(capsys, main, *options.split())
        assert (message or f"argument {options.split()[0]}: ") in error, case
