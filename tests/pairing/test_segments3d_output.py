"""Segments in 3D for ParaView and for pictures in notebooks."""

import json
import xml.etree.ElementTree as ET

import numpy as np
import pytest
import shapely
from ngsolve import CF, VectorH1
from ngsolve.webgui import Draw
from surfaces3d import Sheet, contact_on, in_plane, quad_grid, rigid, sheet_mesh, surface

from ngslac import LACContact, LACSpace

POLYGON = 7  # VTK's number


def sheets(gap=0.05):
    rng = np.random.default_rng(1)
    slave = surface(rng, "mixed", 2)
    master = surface(rng, "mixed", 3, ((-0.2, -0.1), (0.8, 1.1)))
    return [
        Sheet("upper", in_plane(slave[0], gap), slave[1], (0, 0, 0.5), "slave"),
        Sheet("lower", in_plane(master[0]), master[1], (0, 0, -0.5), "master"),
    ]


@pytest.fixture
def contact():
    return contact_on(sheet_mesh(*sheets(), motion=rigid(3)))


def arrays_of(path):
    """All DataArrays of a VTU file by name."""
    piece = ET.parse(path).getroot().find("UnstructuredGrid/Piece")
    values = {}
    for array in piece.iter("DataArray"):
        kind = {"Int64": int, "Float64": float}[array.get("type")]
        numbers = np.array([kind(t) for t in array.text.split()])
        values[array.get("Name")] = numbers.reshape(-1, int(array.get("NumberOfComponents")))
    return piece, values


def polygon_area(corners):
    """Area of a plane polygon in space."""
    p = corners - corners[0]
    return 0.5 * np.linalg.norm(np.cross(p[:-1], p[1:]).sum(axis=0))


def test_corners_are_counted(contact):
    segments = contact.Segments()
    n = len(segments)
    assert segments.first.shape == (n + 1,)
    assert segments.first[0] == 0
    assert segments.first[-1] == len(segments.slave_points) == len(segments.master_points)
    assert np.diff(segments.first).min() >= 3
    assert np.diff(segments.first).max() <= 8
    areas = [polygon_area(p) for p in np.split(segments.slave_points, segments.first[1:-1])]
    assert areas == pytest.approx(segments.area, abs=1e-14)


@pytest.mark.parametrize("name", ["segments.vtu", "segments", "gap_0.25"])
def test_vtu_holds_the_polygons_of_both_sides(contact, tmp_path, name):
    segments = contact.Segments()
    path = segments.WriteVTU(tmp_path / name)
    assert path == tmp_path / (name if name.endswith(".vtu") else f"{name}.vtu")
    piece, arrays = arrays_of(path)
    n, corners = len(segments), len(segments.slave_points)
    assert n > 10
    assert int(piece.get("NumberOfCells")) == 2 * n
    assert int(piece.get("NumberOfPoints")) == len(arrays["points"]) == 2 * corners
    for field in ("slave", "master", "area", "gap"):
        expected = np.tile(getattr(segments, field), 2)
        assert np.array_equal(arrays[field].ravel(), expected), field
    assert np.array_equal(arrays["side"].ravel(), np.repeat([1, 2], n))
    assert np.all(arrays["types"] == POLYGON)
    assert np.array_equal(arrays["connectivity"].ravel(), np.arange(2 * corners))
    assert np.array_equal(arrays["points"][:corners], segments.slave_points)
    assert np.array_equal(arrays["points"][corners:], segments.master_points)
    cells = np.split(arrays["points"], arrays["offsets"].ravel()[:-1])
    assert len(cells) == 2 * n
    areas = np.array([polygon_area(cell) for cell in cells])
    assert areas == pytest.approx(arrays["area"].ravel(), abs=1e-13)  # parallel planes


def test_vtu_of_a_tilted_master(tmp_path):
    """Master polygons lie in the master's plane and project onto those of the slave."""
    upper, lower = sheets()
    tilted = lower.points + np.outer(lower.points[:, 0], [0, 0, -0.5])
    lower = Sheet("lower", tilted, lower.faces, lower.depth, "master")
    segments = contact_on(sheet_mesh(upper, lower)).Segments()
    _, arrays = arrays_of(segments.WriteVTU(tmp_path / "tilted"))
    slave, master = np.split(arrays["points"], 2)
    assert master[:, 2] == pytest.approx(-0.5 * master[:, 0], abs=1e-13)
    assert master[:, :2] == pytest.approx(slave[:, :2], abs=1e-13)
    cells = [shapely.Polygon(c) for c in np.split(slave[:, :2], segments.first[1:-1])]
    assert shapely.union_all(cells).area == pytest.approx(0.8, rel=1e-12)


def test_webgui_data_are_outlines_and_normals(contact):
    data = contact._GetWebguiData()
    json.dumps(data)  # has to travel to a browser
    assert data["type"] == "lines"
    segments = contact.Segments()
    position = np.array(data["position"]).reshape(-1, 2, 3)
    sides, normals = np.split(position, [len(segments.slave_points)])
    assert len(normals) == len(segments)
    for i, (start, end) in enumerate(zip(segments.first[:-1], segments.first[1:], strict=True)):
        corners = segments.slave_points[start:end]
        assert np.array_equal(sides[start:end, 0], corners)
        assert np.array_equal(sides[start:end, 1], np.roll(corners, -1, axis=0))
        assert normals[i, 0] == pytest.approx(corners.mean(axis=0), abs=1e-14)
    across = normals[:, 1] - normals[:, 0]
    normal = contact.Table()["normal"][0]
    assert across == pytest.approx(np.tile(0.05 * normal, (len(across), 1)), abs=1e-13)


def test_draw_takes_the_contact_and_its_fields(contact, tmp_path):
    path = tmp_path / "contact.html"
    Draw(contact.mesh, objects=[contact], filename=str(path))
    assert "contact segments" in path.read_text()
    contact.form.SetConstant(1.0)
    for field in (contact.pressure, contact.gap, contact.traction):
        field_path = tmp_path / f"{field.name}.html"
        Draw(field, contact.mesh.Boundaries("slave"), filename=str(field_path))
        assert field_path.stat().st_size > 1000


@pytest.mark.parametrize("kind", ["trig", "quad"])
def test_obstacle_takes_whole_faces(kind, tmp_path):
    """An obstacle has no master surface: its points lie one gap along the normal."""
    points, faces = quad_grid(2, 2, diagonals=range(4) if kind == "trig" else ())
    body = Sheet("upper", in_plane(points), faces, (0, 0, 0.5), "slave")
    V = VectorH1(sheet_mesh(body, motion=rigid(2)), order=3)
    u, lam = (V * LACSpace(V, slave="slave")).TrialFunction()
    segments = LACContact(u, lam, obstacle=CF(0.25)).Segments()
    assert len(segments) == len(faces)
    assert np.all(segments.master == -1)
    assert segments.gap == pytest.approx(0.25, rel=1e-14)
    assert segments.area == pytest.approx(1 / len(faces), rel=1e-13)
    assert np.all(np.diff(segments.first) == len(faces[0]))
    across = np.linalg.norm(segments.master_points - segments.slave_points, axis=1)
    assert across == pytest.approx(0.25, rel=1e-13)
    _, arrays = arrays_of(segments.WriteVTU(tmp_path / "obstacle"))
    assert len(arrays["area"]) == 2 * len(faces)
