"""Segments for ParaView and for pictures in notebooks."""

import json
import xml.etree.ElementTree as ET

import numpy as np
import pytest
from ngsolve import CF, VectorH1
from ngsolve.webgui import Draw
from strips import Strip, contact_on, on_line, strip_mesh

from ngslac import LACContact, LACSpace


@pytest.fixture
def contact():
    upper = Strip("upper", on_line(np.linspace(0, 1, 6), 0.05), (0, 0.5), "slave")
    lower = Strip("lower", on_line(np.linspace(-0.2, 0.93, 8)), (0, -0.5), "master")
    return contact_on(strip_mesh(upper, lower, angle=0.3))


def arrays_of(path):
    """All DataArrays of a VTU file by name."""
    piece = ET.parse(path).getroot().find("UnstructuredGrid/Piece")
    values = {}
    for array in piece.iter("DataArray"):
        kind = {"Int64": int, "Float64": float}[array.get("type")]
        numbers = np.array([kind(t) for t in array.text.split()])
        values[array.get("Name")] = numbers.reshape(-1, int(array.get("NumberOfComponents")))
    return piece, values


@pytest.mark.parametrize("name", ["segments.vtu", "segments", "gap_0.25"])
def test_vtu_holds_the_segments(contact, tmp_path, name):
    segments = contact.Segments()
    path = segments.WriteVTU(tmp_path / name)
    assert path == tmp_path / (name if name.endswith(".vtu") else f"{name}.vtu")
    piece, arrays = arrays_of(path)
    n = len(segments)
    assert n >= 10
    assert int(piece.get("NumberOfCells")) == n
    assert int(piece.get("NumberOfPoints")) == len(arrays["points"]) == 4 * n
    for field in ("slave", "master", "area", "gap"):
        assert np.array_equal(arrays[field].ravel(), getattr(segments, field)), field
    assert np.all(arrays["types"] == 9)
    assert np.array_equal(arrays["offsets"].ravel(), 4 * np.arange(1, n + 1))
    corners = arrays["points"][arrays["connectivity"].reshape(-1, 4)]
    assert np.array_equal(corners[:, :2, :2], segments.slave_points)
    assert np.array_equal(corners[:, :1:-1, :2], segments.master_points)
    assert not np.any(corners[:, :, 2])


def test_vtu_quadrilaterals_are_the_gap(contact, tmp_path):
    """The polygon from slave to master and back has the area of the gap's integral."""
    segments = contact.Segments()
    _, arrays = arrays_of(segments.WriteVTU(str(tmp_path / "a.vtu")))
    p = arrays["points"].reshape(-1, 4, 3)
    q = np.roll(p, -1, axis=1)
    polygon = 0.5 * np.abs(np.sum(p[..., 0] * q[..., 1] - p[..., 1] * q[..., 0], axis=1))
    assert polygon == pytest.approx(segments.area * segments.gap, rel=1e-12)


def test_webgui_data_are_lines_along_the_normals(contact):
    data = contact._GetWebguiData()
    json.dumps(data)  # has to travel to a browser
    assert data["type"] == "lines"
    segments = contact.Segments()
    position = np.array(data["position"]).reshape(-1, 2, 3)
    assert len(position) == 2 * len(segments)
    across = position[:, 1] - position[:, 0]
    normal = np.append(contact.Table()["normal"][0], 0)
    assert across == pytest.approx(np.tile(0.05 * normal, (len(across), 1)), abs=1e-13)


def test_draw_takes_the_contact_as_an_object(contact, tmp_path):
    path = tmp_path / "contact.html"
    Draw(contact.mesh, objects=[contact], filename=str(path))
    text = path.read_text()
    assert "contact segments" in text
    assert len(text) > 1000


def test_draw_fields_on_the_slave_side(contact, tmp_path):
    path = tmp_path / "normal.html"
    contact.form.SetConstant(1.0)
    Draw(contact.pressure, contact.mesh.Boundaries("slave"), filename=str(path))
    assert path.stat().st_size > 1000


def test_vtk_corner_points_of_an_obstacle(tmp_path):
    """An obstacle has no master surface: its points lie one gap along the normal."""
    upper = Strip("upper", on_line(np.linspace(0, 1, 6)), (0, 0.5), "slave")
    mesh = strip_mesh(upper)
    V = VectorH1(mesh, order=2)
    u, lam = (V * LACSpace(V, slave="slave")).TrialFunction()
    segments = LACContact(u, lam, obstacle=CF(0.25)).Segments()
    assert np.all(segments.master == -1)
    assert segments.gap == pytest.approx(0.25, rel=1e-14)
    assert segments.area == pytest.approx(0.2, rel=1e-13)
    _, arrays = arrays_of(segments.WriteVTU(tmp_path / "obstacle"))
    assert len(arrays["area"]) == 5
