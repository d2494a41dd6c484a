"""The table of faces says to which body each of them belongs."""

import numpy as np
import pytest
from netgen.occ import Box, Compound, Glue, MoveTo, OCCGeometry, Rectangle

from ngslac.meshes import FaceTable


def boxes():
    left, right = Box((0, 0, 0), (1, 1, 1)), Box((1, 0, 0), (3, 1, 1))
    left.name, right.name = "steel", "rubber"
    return left, right


def faces_of(shape, table, body):
    """Centres of the faces that the table gives to a body, sorted."""
    return np.sort(table["center"][table["body"] == body], axis=0)


@pytest.mark.parametrize("join", [Compound, Glue])
def test_faces_of_each_solid(join):
    shape = join(boxes())
    table = FaceTable(shape)
    for body, solid in enumerate(shape.solids):
        centers = np.sort([[*face.center] for face in solid.faces], axis=0)
        np.testing.assert_allclose(faces_of(shape, table, body), centers, atol=1e-12)
    assert list(table["material"]) == ["steel"] * 6 + ["rubber"] * 6


def test_names_and_bodies_of_a_step_file(tmp_path):
    path = str(tmp_path / "assembly.step")
    Compound(boxes()).WriteStep(path)
    table = FaceTable(OCCGeometry(path).shape)
    assert sorted(table["material"]) == ["rubber"] * 6 + ["steel"] * 6
    upper = table["material"] == "rubber"
    np.testing.assert_allclose(table["center"][upper, 0].max(), 3)


def test_edges_in_2d():
    shape = Glue([Rectangle(1, 1).Face(), MoveTo(1, 0).Rectangle(1, 1).Face()])
    assert list(FaceTable(shape)["body"]) == [0] * 4 + [1] * 4


def test_a_face_without_solid_has_no_body():
    table = FaceTable(Compound([*boxes(), Rectangle(1, 1).Face()]))
    assert table["body"][-1] == -1
    assert table["material"][-1] == ""
