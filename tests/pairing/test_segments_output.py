"""Segments for ParaView and for pictures in notebooks."""

import json
import xml.etree.ElementTree as ET

import numpy as np
import pytest
from ngsolve import CF
from ngsolve.webgui import Draw
from sheets import SHIFTED, grid, outlines, paired, two_sheets, upper

QUAD, POLYGON = 9, 7  # VTK's numbers
KINDS = [("edge", "edge"), ("mixed", "mixed")]


@pytest.fixture(params=KINDS)
def contact(request):
    sheets = two_sheets(np.random.default_rng(1), request.param, SHIFTED, 0.05)
    return paired(sheets, 3)


def arrays_of(path):
    """All DataArrays of a VTU file by name, and the number of cells and points."""
    piece = ET.parse(path).getroot().find("UnstructuredGrid/Piece")
    values = {}
    for array in piece.iter("DataArray"):
        kind = {"Int64": int, "Float64": float}[array.get("type")]
        numbers = np.array([kind(t) for t in array.text.split()])
        values[array.get("Name")] = numbers.reshape(-1, int(array.get("NumberOfComponents")))
    return values, int(piece.get("NumberOfCells")), int(piece.get("NumberOfPoints"))


def polygon_area(corners):
    """Area of a plane polygon in space."""
    p = corners - corners[0]
    return 0.5 * np.linalg.norm(np.cross(p[:-1], p[1:]).sum(axis=0))


@pytest.mark.parametrize("name", ["segments.vtu", "segments", "gap_0.25"])
def test_vtu_holds_the_segments(contact, tmp_path, name):
    """Between both sides in the plane, and the polygons of one after the other in space."""
    segments, sides = contact.Segments(), contact.mesh.dim - 1
    path = segments.WriteVTU(tmp_path / name)
    assert path == tmp_path / (name if name.endswith(".vtu") else f"{name}.vtu")
    arrays, cells, points = arrays_of(path)
    n = len(segments)
    assert n >= 10
    assert cells == sides * n == len(arrays["offsets"])
    assert points == len(arrays["points"])
    for field in ("slave", "master", "area", "gap"):
        expected = np.tile(getattr(segments, field), sides)
        assert np.array_equal(arrays[field].ravel(), expected), field
    ends = [p.reshape(-1, sides + 1) for p in (segments.slave_points, segments.master_points)]
    if sides == 1:
        assert np.all(arrays["types"] == QUAD)
        assert np.array_equal(arrays["offsets"].ravel(), 4 * np.arange(1, n + 1))
        corners = arrays["points"][arrays["connectivity"].reshape(-1, 4)]
        assert np.array_equal(corners[:, :2, :2].reshape(-1, 2), ends[0])
        assert np.array_equal(corners[:, :1:-1, :2].reshape(-1, 2), ends[1])
        assert not np.any(corners[:, :, 2])
        areas, expected = [polygon_area(c) for c in corners], segments.area * segments.gap
    else:
        assert np.all(arrays["types"] == POLYGON)
        assert np.array_equal(np.append(0, arrays["offsets"][:n]), segments.first)
        assert np.array_equal(arrays["side"].ravel(), np.repeat([1, 2], n))
        assert np.array_equal(arrays["connectivity"].ravel(), np.arange(points))
        assert np.array_equal(arrays["points"], np.concatenate(ends))
        corners = np.split(arrays["points"], arrays["offsets"].ravel()[:-1])
        areas, expected = [polygon_area(c) for c in corners], np.tile(segments.area, 2)
    assert areas == pytest.approx(expected, abs=1e-13)  # parallel planes


def test_webgui_data_are_outlines_and_normals(contact):
    data, segments = contact._GetWebguiData(), contact.Segments()
    json.dumps(data)  # has to travel to a browser
    assert data["type"] == "lines"
    position = np.array(data["position"]).reshape(-1, 2, 3)
    sides, across = np.split(position, [len(position) - len(segments)])
    normal = np.append(contact.Table()["normal"][0], 0)[:3]
    if contact.mesh.dim == 2:
        across = position  # all of them
        assert len(sides) == len(segments)
    else:
        corners = outlines(segments)
        starts = np.concatenate(corners)
        ends = np.concatenate([np.roll(c, -1, axis=0) for c in corners])
        assert np.array_equal(sides, np.stack([starts, ends], axis=1))
        middles = np.array([c.mean(axis=0) for c in corners])
        assert across[:, 0] == pytest.approx(middles, abs=1e-14)
    expected = np.tile(0.05 * normal, (len(across), 1))
    assert across[:, 1] - across[:, 0] == pytest.approx(expected, abs=1e-13)


def test_draw_takes_the_contact_and_its_fields(contact, tmp_path):
    path = tmp_path / "contact.html"
    Draw(contact.mesh, objects=[contact], filename=str(path))
    assert "contact segments" in path.read_text()
    contact.form.SetConstant(1.0)
    for field in (contact.pressure, contact.gap, contact.traction):
        field_path = tmp_path / f"{field.name}.html"
        Draw(field, contact.mesh.Boundaries("slave"), filename=str(field_path))
        assert field_path.stat().st_size > 1000


@pytest.mark.parametrize("kind", ["edge", "trig", "quad"])
def test_obstacle_takes_whole_faces(kind, tmp_path):
    """An obstacle has no master surface: its points lie one gap along the normal."""
    body = upper(grid(kind, 2))
    dim, n = body.points.shape[1], len(body.faces)
    segments = paired([body], 2, obstacle=CF(0.25)).Segments()
    assert len(segments) == n
    assert np.all(segments.master == -1)
    assert segments.gap == pytest.approx(0.25, rel=1e-14)
    assert segments.area == pytest.approx(1 / n, rel=1e-13)
    assert [len(corners) for corners in outlines(segments)] == n * [len(body.faces[0])]
    across = np.linalg.norm(segments.master_points - segments.slave_points, axis=-1)
    assert across == pytest.approx(0.25, rel=1e-13)
    arrays, *_ = arrays_of(segments.WriteVTU(tmp_path / "obstacle"))
    assert len(arrays["area"]) == (dim - 1) * n
