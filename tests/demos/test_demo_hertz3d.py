"""The demo of Hertz contacts in 3D: its mesh, its figures, its files.

Whether it agrees with Hertz is a matter of tests/validation/test_validation_hertz3d.py.
"""

import json
import math

import numpy as np
import pytest
from ngsolve import BND, CF, ET, VOL, Integrate, Mesh, VectorH1
from scipy.integrate import dblquad

from ngslac.demos._hertz3d_figures import Comparison
from ngslac.demos._hertz3d_macros import Macros, StripMean
from ngslac.demos._hertz3d_mesh import THICKNESS, CylinderOnBlock
from ngslac.demos.hertz3d import Problem, Run, main
from ngslac.meshes.geometry3d import CheckNonMatching3D
from ngslac.reference import HertzLine, HertzPoint

SOLID = dict(young1=210e3, nu1=0.3, young2=70e3, nu2=0.3)
COARSE = {"h": 1.25}


# ---------------------------------------------------------------- the mesh of the cylinder


@pytest.fixture(scope="module", params=["quarter", "full"])
def cylinder(request):
    return request.param, CylinderOnBlock(1.0, zone=3.3, model=request.param)


def test_slice_of_a_cylinder(cylinder):
    model, mesh = cylinder
    halves = 1 if model == "quarter" else 2
    exact = {"cylinder": math.pi / 4 * 50**2, "block": 100.0**2}
    for body, area in exact.items():
        volume = Integrate(CF(1), mesh, definedon=mesh.Materials(body))
        assert volume == pytest.approx(halves * THICKNESS * area, rel=0.03)
    faces = {"slave": 50 * math.asin(3.3 / 50), "master": 3.3 * 16 / 15, "top": 50, "bottom": 100}
    for name, length in faces.items():
        area = Integrate(CF(1), mesh.Boundaries(name))
        assert area == pytest.approx(halves * THICKNESS * length, rel=1e-3)
    has_middle = "sym_x" in mesh.GetBoundaries()
    assert has_middle == (model == "quarter")
    assert {el.type for el in mesh.Elements(VOL)} == {ET.PRISM}
    assert {el.type for el in mesh.Boundaries("slave|master").Elements()} == {ET.QUAD}
    assert CheckNonMatching3D(mesh) > 1e-3


def test_normals_of_the_cylinder_point_outwards(cylinder):
    from ngsolve import specialcf

    normal = specialcf.normal(3)
    _, mesh = cylinder
    down, up = (
        Integrate(normal[2], mesh.Boundaries(name)) / Integrate(CF(1), mesh.Boundaries(name))
        for name in ("slave|bottom", "master|top")
    )
    assert down == pytest.approx(-1, abs=1e-3)
    assert up == pytest.approx(1, abs=1e-3)


def test_units_do_not_change_the_cylinder():
    mesh, metres = CylinderOnBlock(1.0), CylinderOnBlock(1.0, scale=1e-3)
    points, scaled = (np.array([v.point for v in m.vertices]) for m in (mesh, metres))
    np.testing.assert_allclose(scaled, 1e-3 * points, rtol=1e-12)


@pytest.mark.parametrize(
    "bad", [{"h": 0}, {"zone": 46}, {"width": 2}, {"model": "half"}, {"scale": -1}, {"ratio": 0}]
)
def test_refused_cylinders(bad):
    with pytest.raises(ValueError, match=next(iter(bad)) + "|zone"):
        CylinderOnBlock(**{"h": 1.0} | bad)


# ---------------------------------------------------------------- figures


@pytest.mark.parametrize(
    "corners",
    [
        [(0.1, 0), (0.7, 0.2), (0.3, 0.9)],
        [(-0.2, 0), (1.4, -0.3), (0.8, 0.5)],
        [(0.5, 0), (0.5, 1), (-0.5, 1), (-0.5, 0)],
        [(1.1, 0), (1.2, 0), (1.2, 1)],
    ],
)
def test_mean_of_a_line_contact_over_polygons(corners):
    corners = np.array(corners)
    total = area = 0.0
    for a, b, c in zip([corners[0]] * (len(corners) - 2), corners[1:-1], corners[2:], strict=True):

        def Value(t, s, a=a, b=b, c=c):
            x = a[0] + s * (1 - t) * (b[0] - a[0]) + s * t * (c[0] - a[0])
            return s * math.sqrt(max(0.0, 1 - x * x))

        cross = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
        total += cross * dblquad(Value, 0, 1, 0, 1, epsabs=1e-9)[0]
        area += cross / 2
    assert StripMean(2.5 * corners, 2.5) == pytest.approx(total / area, abs=1e-6)
    assert StripMean(2.5 * corners[::-1], 2.5) == pytest.approx(total / area, abs=1e-6)


def Grid(line):
    """Macro-elements of the slave side of a mesh, each a single face, with exact pressures."""
    mesh = CylinderOnBlock(0.5, zone=3.3)
    names = mesh.GetBoundaries()
    slave = [names[el.index] == "slave" for el in mesh.Elements(BND)]
    numbers = np.where(slave, np.cumsum(slave) - 1, -1)
    force = {"force": 5.7e3 if line else 24e3}
    hertz = (HertzLine if line else HertzPoint)(radius1=50, **force, **SOLID)
    return Macros(mesh, numbers, line), hertz


@pytest.mark.parametrize("line", [True, False])
def test_exact_pressures_have_no_error(line):
    macros, hertz = Grid(line)
    radius = hertz.halfwidth if line else hertz.contact_radius
    pressure = hertz.peak * macros.Shape(radius)
    figures = Comparison(macros, hertz, pressure, pressure > 0)
    for name in ("p0_ratio", "p0_ratio_fit", "contact_radius_ratio"):
        assert figures[name] == pytest.approx(1, abs=1e-5)
    assert figures["profile_error"] < 1e-12
    assert figures["oscillation"] < 1e-12
    assert figures["second_difference"] == figures["second_difference_exact"] > 0
    assert 0.8 < figures["contact_edge_interval"][0] <= figures["contact_edge_interval"][1]


def test_errors_are_seen():
    macros, hertz = Grid(True)
    exact = hertz.peak * macros.Shape(hertz.halfwidth)
    closed = exact > 0
    scaled = Comparison(macros, hertz, 1.03 * exact, closed)
    assert scaled["p0_ratio"] == pytest.approx(1.03, abs=1e-9)
    assert scaled["profile_error"] == pytest.approx(0.03, abs=1e-9)
    wide = Comparison(macros, hertz, hertz.peak * macros.Shape(1.1 * hertz.halfwidth), closed)
    assert wide["contact_radius_ratio"] == pytest.approx(1.1, abs=1e-4)
    column = np.rint(macros.corners[:, :, 0].mean(axis=1) / 0.55).astype(int)
    row = (macros.corners[:, :, 1].mean(axis=1) > THICKNESS / 2).astype(int)
    checkered = exact + 0.1 * hertz.peak * (-1.0) ** (column + row) * closed
    assert Comparison(macros, hertz, checkered, closed)["oscillation"] > 0.15


def test_neighbours_and_outlines():
    macros, _ = Grid(True)
    number = len(macros.area)  # two rows
    assert len(macros.neighbours) == 2 * (number // 2 + 2 * (number // 2 - 1))
    assert len(macros.Outlines()) == len(macros.neighbours) // 2
    assert macros.area.sum() == pytest.approx(3.3 * THICKNESS, rel=1e-6)
    values = macros.corners[..., 0].mean(axis=1)
    inner = (macros.extent[:, 0] > 0.1) & (macros.extent[:, 1] < 3.2)
    assert np.abs(macros.Bends(np.ones(number))).max() < 1e-12
    assert np.abs(macros.Bends(values)[inner]).max() < 0.02


# ---------------------------------------------------------------- problem and runs


@pytest.mark.parametrize(
    "bad",
    [
        {"shape": "cube"},
        {"model": "half"},
        {"stabilize": "bubbles"},
        {"rotation": ("x", 10)},
        {"rotation": ("x", 10), "model": "full", "shape": "cylinder"},
    ],
)
def test_refused_problems(bad):
    with pytest.raises(ValueError, match=r"shape|model|stabilize|rotated"):
        Problem(**bad)


def test_pictures_need_mm():
    with pytest.raises(ValueError, match="mm and MPa"):
        Run(out="nowhere", length=1e-3)


FIGURES = {
    "p0_ratio",
    "force_ratio",
    "contact_radius_ratio",
    "profile_error",
    "oscillation",
    "newton_iterations",
    "ndof",
    "seconds",
    "seconds_per_phase",
}
FILES = {
    "hertz3d_pressure.png",
    "hertz3d_stress.png",
    "hertz3d_pressure.html",
    "hertz3d_stress.html",
    "hertz3d.vtu",
    "hertz3d_contact.vtu",
    "hertz3d_segments.vtu",
}


@pytest.mark.parametrize("shape", ["sphere", "cylinder"])
def test_command_line_writes_figures_and_pictures(shape, tmp_path, capsys):
    file = tmp_path / "new" / "figures.json"
    main(["--shape", shape, "--h", "0.9", "--json", str(file), "--out", str(tmp_path / "out")])
    figures = json.loads(file.read_text())
    assert figures.keys() >= FIGURES
    assert figures["force_ratio"] == pytest.approx(1, abs=1e-9)
    assert figures["p0_ratio"] == pytest.approx(1, abs=0.1)
    assert {path.name for path in (tmp_path / "out").iterdir()} == FILES
    assert all(path.stat().st_size > 1000 for path in (tmp_path / "out").iterdir())
    scene = (tmp_path / "out" / "hertz3d_pressure.html").read_text()
    assert "render_data" in scene
    assert "contact segments" in scene
    printed = capsys.readouterr().out
    assert f"{figures['p0_ratio']:.5f}" in printed
    assert f"{figures['ndof']} unknowns" in printed


def test_options_reach_the_problem():
    options = {"order": 1, "stabilize": "bubble", "friction": 0.1, "steps": 2, "shape": "cylinder"}
    results = Run(**COARSE, **options)
    assert [state.time for state in results.states] == [0.5, 1.0]
    assert {name: results.figures[name] for name in options} == options
    assert results.figures["ndof"] > VectorH1(results.mesh, order=1).ndof
    assert set(np.unique(results.states[-1].status)) <= {0, 1, 2}
    assert isinstance(results.mesh, Mesh)
    assert results.contact.Table()["friction"] == pytest.approx(0.1)
