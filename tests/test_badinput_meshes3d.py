"""Faulty meshes and configurations in 3D: errors that say what is wrong, and never a crash."""

import math

import numpy as np
import pytest
from netgen.meshing import Element2D, FaceDescriptor, MeshPoint, Pnt
from netgen.meshing import Mesh as NetgenMesh
from ngsolve import GridFunction, Mesh, VectorH1
from test_badinput3d import contact, contact_on, raises

from ngslac import LACSpace
from ngslac.meshes.blocks3d import TwoBlocks3D
from ngslac.meshes.boxes import AddBody, Cells, StructuredBox


def turned_mesh(body, turned):
    """Two cubes on each other; some surface elements of a body are written the wrong way round."""
    mesh = NetgenMesh(dim=3)
    for name, low, n in (("upper", 0.0, 3), ("lower", -1.0, 2)):
        side = {"upper": "bottom", "lower": "top"}[name]
        label = {"upper": "slave", "lower": "master"}[name]
        box = StructuredBox(
            np.linspace(0, 1, n + 1), np.linspace(0, 1, n + 1), [low, low + 1], "hex",
            names=lambda s, c, side=side, label=label, name=name: (
                label if s == side else f"{s}_{name}"
            ),
        )  # fmt: skip
        if name == body:
            faces = [
                (lab, face[::-1]) if lab == label and turned(i) else (lab, face)
                for i, (lab, face) in enumerate(box.faces)
            ]
            box = Cells(box.points, box.cells, faces)
        AddBody(mesh, name, box)
    mesh.Compress()
    return Mesh(mesh)


@pytest.mark.parametrize("body", ["upper", "lower"])
@pytest.mark.parametrize("turned", [lambda i: True, lambda i: i % 2 == 0], ids=["all", "some"])
def test_reversed_surface_elements_do_no_harm(body, turned):
    """Which way a surface element is written does not matter: the body tells what is outside."""
    c = contact_on(turned_mesh(body, turned))
    c.Update()
    table = c.Table()
    assert table["normal"] == pytest.approx(np.tile([0.0, 0.0, -1.0], (9, 1)), abs=1e-14)
    assert table["area"] == pytest.approx(1 / 9, rel=1e-12)
    assert table["gap"] == pytest.approx(0, abs=1e-14)


def flat_mesh(where):
    """A block whose lower face has elements of no area, or a NaN, above another block."""
    mesh = NetgenMesh(dim=3)
    for name, low, n in (("upper", 0.0, 4), ("lower", -1.0, 3)):
        lateral = np.linspace(0, 1, n + 1)
        box = StructuredBox(lateral, lateral, [low, low + 1], "hex")
        points = box.points.copy()
        if name == where[0]:
            height = low if name == "upper" else low + 1
            at = (points[:, 0] == lateral[1]) & (points[:, 2] == height)
            points[at, 0] = where[1]
        label = {"upper": "slave", "lower": "master"}[name]
        side = {"upper": "bottom", "lower": "top"}[name]
        faces = [(label if s == side else f"{s}_{name}", face) for s, face in box.faces]
        AddBody(mesh, name, Cells(points, box.cells, faces))
    mesh.Compress()
    return Mesh(mesh)


def test_slave_faces_without_area():
    """No crash and no wrong remedy: the fault and the boundary are named."""
    with raises("'slave'.*(area|degenerate)|(area|degenerate).*'slave'"):
        contact_on(flat_mesh(("upper", 0.0))).Update()


def test_master_faces_without_area():
    """They carry nothing; what is beside them covers the slave."""
    c = contact_on(flat_mesh(("lower", 0.0)))
    c.Update()
    assert c.Table()["area"] == pytest.approx(1 / 16, rel=1e-12)


@pytest.mark.parametrize("body", ["upper", "lower"])
def test_points_that_are_not_finite(body):
    with raises("NaN|finite|area|degenerate"):
        contact_on(flat_mesh((body, math.nan))).Update()


def test_a_surface_without_body():
    """Faces that belong to no volume element have no displacement and no outside."""
    mesh = NetgenMesh(dim=3)
    cells = StructuredBox([0, 0.5, 1], [0, 0.5, 1], [0, 1], "hex")
    AddBody(mesh, "body", cells)
    sheet = mesh.Add(FaceDescriptor(surfnr=9, domin=0, bc=9))
    mesh.SetBCName(8, "sheet")
    corners = [(0, 0, -0.1), (0, 1, -0.1), (1, 1, -0.1), (1, 0, -0.1)]
    points = [mesh.Add(MeshPoint(Pnt(*p))) for p in corners]
    mesh.Add(Element2D(sheet, points))
    mesh.Compress()
    with raises("sheet"):
        contact_on(Mesh(mesh), slave="bottom", master="sheet").Update()


def test_tangled_configurations_do_not_crash():
    """Elements turned inside out: a pairing or an error, but nothing that is not finite."""
    mesh, paired = TwoBlocks3D("hex", "tet", 3, 2), 0
    V = VectorH1(mesh, order=2)
    X = V * LACSpace(V, slave="slave")
    for k in range(6):
        gf = GridFunction(X)
        shape = gf.components[0].vec.FV().NumPy()
        shape[:] = np.random.default_rng(k).normal(scale=0.1 * 2**k, size=len(shape))
        c = contact(X)
        error = error_of(lambda c=c, gf=gf: c.Update(gf))
        if error:
            assert "LACContact" in error
            continue
        paired += 1
        table = c.Table()
        assert np.all(np.isfinite(table["gap"]))
        assert np.all((table["area"] >= 0) & np.isfinite(table["area"]))
        assert np.linalg.norm(table["normal"], axis=1) == pytest.approx(1)
    assert paired > 0


def error_of(call):
    """The text of the exception, or nothing."""
    try:
        call()
    except Exception as error:
        return str(error)
    return ""
