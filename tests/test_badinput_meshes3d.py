"""Faulty meshes and configurations in 3D: errors that say what is wrong, and never a crash."""

import math

import numpy as np
import pytest
from netgen.meshing import Element2D, FaceDescriptor, MeshPoint, Pnt
from netgen.meshing import Mesh as NetgenMesh
from ngsolve import GridFunction, Mesh, VectorH1

from ngslac import LACContact, LACSpace
from ngslac.meshes import TwoBlocks3D
from ngslac.meshes.boxes import Cells, StructuredBox


def paired(mesh, slave="slave", master="master", at=lambda _: None):
    V = VectorH1(mesh, order=2)
    X = V * LACSpace(V, slave=slave)
    contact = LACContact(*X.TrialFunction(), master=master)
    contact.Update(at(X))
    return contact.Table()


def two_cubes(body, line):
    """Two cubes on each other; the first line of inner nodes of a contact face is moved to x."""
    mesh, contact = NetgenMesh(dim=3), {"upper": ("bottom", "slave"), "lower": ("top", "master")}
    for (name, (side, label)), low, k in zip(contact.items(), (0.0, -1.0), (4, 3), strict=True):
        lateral = np.linspace(0, 1, k + 1)
        box = StructuredBox(lateral, lateral, [low, low + 1], "hex")
        points = box.points.copy()
        if name == body:
            points[(points[:, 0] == lateral[1]) & (points[:, 2] == 0), 0] = line
        faces = [(label if s == side else f"{s}_{name}", face) for s, face in box.faces]
        Cells(points, box.cells, faces).AddTo(mesh, name)
    mesh.Compress()
    return Mesh(mesh)


@pytest.mark.parametrize(
    ("body", "line", "message"),
    [
        ("upper", 0.0, "'slave'.*(area|degenerate)|(area|degenerate).*'slave'"),
        ("upper", math.nan, "NaN|finite|area|degenerate"),
        ("lower", math.nan, "NaN|finite|area|degenerate"),
    ],
)
def test_faces_without_area(body, line, message):
    """No crash and no wrong remedy: the fault and the boundary are named."""
    with pytest.raises(Exception, match=message):
        paired(two_cubes(body, line))


def test_master_faces_without_area():
    """They carry nothing; what is beside them covers the slave."""
    table = paired(two_cubes("lower", 0.0))
    assert table["area"] == pytest.approx(1 / 16, rel=1e-12)


def test_a_surface_without_body():
    """Faces that belong to no volume element have no displacement and no outside."""
    mesh = NetgenMesh(dim=3)
    StructuredBox([0, 0.5, 1], [0, 0.5, 1], [0, 1], "hex").AddTo(mesh, "body")
    sheet = mesh.Add(FaceDescriptor(surfnr=9, domin=0, bc=9))
    mesh.SetBCName(8, "sheet")
    corners = [(0, 0, -0.1), (0, 1, -0.1), (1, 1, -0.1), (1, 0, -0.1)]
    mesh.Add(Element2D(sheet, [mesh.Add(MeshPoint(Pnt(*p))) for p in corners]))
    mesh.Compress()
    with pytest.raises(Exception, match="sheet"):
        paired(Mesh(mesh), slave="bottom", master="sheet")


def test_tangled_configurations_do_not_crash():
    """Elements turned inside out: a pairing or an error, but nothing that is not finite."""
    mesh, tables, errors = TwoBlocks3D("hex", "tet", 3, 2), [], []
    for k in range(6):

        def tangled(X, k=k):
            gf = GridFunction(X)
            shape = gf.components[0].vec.FV().NumPy()
            shape[:] = np.random.default_rng(k).normal(scale=0.1 * 2**k, size=len(shape))
            return gf

        try:
            tables.append(paired(mesh, at=tangled))
        except Exception as error:
            errors.append(str(error))
    assert tables
    assert all("LACContact" in error for error in errors)
    for table in tables:
        assert np.all(np.isfinite(table["gap"]))
        assert np.all((table["area"] >= 0) & np.isfinite(table["area"]))
        assert np.linalg.norm(table["normal"], axis=1) == pytest.approx(1)
