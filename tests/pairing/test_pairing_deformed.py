"""Pairing in the configuration of a GridFunction."""

import numpy as np
import pytest
from circles import disc_in_ring
from ngsolve import CF, GridFunction, VectorH1, x, y
from strips import Strip, areas_by_face, contact_on, moved, on_line, overlap, strip_mesh

SLAVE, MASTER = np.linspace(0, 1, 6), np.linspace(-0.15, 0.9, 9)


def two_strips():
    upper = Strip("upper", on_line(SLAVE, 0.05), (0, 0.5), "slave")
    lower = Strip("lower", on_line(MASTER), (0, -0.5), "master")
    return strip_mesh(upper, lower)


def displaced(contact, **fields):
    """A GridFunction on the contact's space with given displacements of the materials."""
    gf = GridFunction(contact.form.fes)
    cfs = {name: CF(field) for name, field in fields.items()}
    gf.components[0].Set(contact.mesh.MaterialCF(cfs, default=CF((0, 0))))
    return gf


def rigid(angle, shift=(0.0, 0.0)):
    c, s = np.cos(angle), np.sin(angle)
    return (c * x - s * y - x + shift[0], s * x + c * y - y + shift[1])


@pytest.mark.parametrize("order", [1, 2, 3])
@pytest.mark.parametrize("shift", [0.0, 0.3, -0.57, 0.85])
def test_translation_of_the_slave(order, shift):
    contact = contact_on(two_strips(), order=order)
    contact.Update(displaced(contact, upper=(shift, 0.1)))
    exact = overlap(SLAVE + shift, MASTER).sum(axis=1)
    assert areas_by_face(contact) == pytest.approx(exact, abs=1e-12)
    assert contact.Segments().gap == pytest.approx(0.15, abs=1e-13)


@pytest.mark.parametrize("angle", [0.1, np.pi / 2, 3.0])
def test_rigid_motion_of_everything_changes_nothing(angle):
    contact = contact_on(two_strips())
    reference = contact.Segments()
    motion = rigid(angle, (0.3, 7.0))
    contact.Update(displaced(contact, upper=motion, lower=motion))
    there = contact.Segments()
    assert there.master.tolist() == reference.master.tolist()
    assert there.area == pytest.approx(reference.area, rel=1e-12)
    assert there.gap == pytest.approx(reference.gap, abs=1e-13)
    points = moved(reference.slave_points.reshape(-1, 2), angle, 1, (0.3, 7.0))
    assert there.slave_points.reshape(-1, 2) == pytest.approx(points, abs=1e-12)
    normal = moved([[0.0, -1.0]], angle)[0]
    assert contact.Table()["normal"] == pytest.approx(np.tile(normal, (5, 1)), abs=1e-12)


@pytest.mark.parametrize("stretch", [-0.4, 0.5, 3.0])
def test_stretch_of_the_slave(stretch):
    contact = contact_on(two_strips())
    contact.Update(displaced(contact, upper=(stretch * x, 0.2 * (y - 0.05))))
    exact = overlap((1 + stretch) * SLAVE, MASTER).sum(axis=1)
    assert areas_by_face(contact) == pytest.approx(exact, abs=1e-12)
    assert contact.Table()["fullarea"] == pytest.approx(0.2 * (1 + stretch) * np.ones(5), rel=1e-12)


@pytest.mark.parametrize("stretch", [-0.3, 0.5])
def test_stretch_of_the_master(stretch):
    contact = contact_on(two_strips())
    contact.Update(displaced(contact, lower=(stretch * x, -0.1)))
    exact = overlap(SLAVE, (1 + stretch) * MASTER).sum(axis=1)
    assert areas_by_face(contact) == pytest.approx(exact, abs=1e-12)
    assert contact.Segments().gap == pytest.approx(0.15, abs=1e-13)


def test_shear_opens_the_gap_linearly():
    """The slave is turned by a shear y += 0.3 x: gap along the turned normal, not vertical."""
    contact = contact_on(two_strips())
    contact.Update(displaced(contact, upper=(0, 0.3 * x)))
    table, segments = contact.Table(), contact.Segments()
    normal = np.array([0.3, -1.0]) / np.hypot(0.3, 1)
    assert table["normal"] == pytest.approx(np.tile(normal, (5, 1)), abs=1e-13)
    middle = segments.slave_points.mean(axis=1)
    assert segments.gap == pytest.approx(middle[:, 1] / -normal[1], rel=1e-12)
    # What is paired is where the rays end on the master.
    ends = segments.master_points[:, :, 0]
    assert ends.min() == pytest.approx(0.05 * 0.3, abs=1e-12)
    assert ends.max() == pytest.approx(MASTER[-1], abs=1e-12)


def test_update_without_gf_returns_to_the_reference():
    contact = contact_on(two_strips())
    reference = areas_by_face(contact)
    contact.Update(displaced(contact, upper=(0.4, 0)))
    assert areas_by_face(contact) != pytest.approx(reference)
    contact.Update()
    assert areas_by_face(contact) == pytest.approx(reference, abs=1e-15)


def test_the_gap_in_the_table_is_that_of_the_configuration():
    """Gaps are linear in the displacement from the paired configuration on, not the reference."""
    contact = contact_on(two_strips())
    gf = displaced(contact, upper=(0.1, -0.02))
    contact.Update(gf)
    contact.form.SetConstant(1.0)
    contact.Evaluate(gf)
    assert contact.Table()["gap"][:4] == pytest.approx(0.03, abs=1e-13)
    assert contact.Table()["slip"] == pytest.approx(0, abs=1e-15)
    contact.Evaluate(displaced(contact, upper=(0.13, -0.06)))
    assert contact.Table()["gap"][:4] == pytest.approx(-0.01, abs=1e-13)
    assert contact.Table()["slip"][:4] == pytest.approx(np.tile([0.03, 0], (4, 1)), abs=1e-13)


@pytest.mark.parametrize("order", [2, 3])
def test_inflated_disc_on_curved_elements(order):
    """A straight mesh bent by the displacement, and a curved one that is stretched."""
    mesh = disc_in_ring(order=order, n_inner=16, n_outer=22)
    contact = contact_on(mesh, slave="disc", master="ring", order=order)
    before = contact.Table()
    contact.Update(displaced(contact, disc=(0.05 * x, 0.05 * y)))
    after = contact.Table()
    assert after["area"] == pytest.approx(1.05 * before["area"], rel=1e-6)
    assert contact.Segments().gap == pytest.approx(0.05, abs=2e-4)
    assert after["normal"] == pytest.approx(before["normal"], abs=1e-12)


def test_mesh_deformation_is_part_of_the_reference():
    """With mesh.SetDeformation the deformed mesh is paired."""
    mesh = two_strips()
    deformation = GridFunction(VectorH1(mesh, order=1))
    deformation.Set(mesh.MaterialCF({"upper": CF((0.3, 0.1))}, default=CF((0, 0))))
    mesh.SetDeformation(deformation)
    contact = contact_on(mesh)
    exact = overlap(SLAVE + 0.3, MASTER).sum(axis=1)
    assert areas_by_face(contact) == pytest.approx(exact, abs=1e-12)
    assert contact.Segments().gap == pytest.approx(0.15, abs=1e-13)
