"""Pairing in the configuration of a GridFunction; what cannot be paired is an error."""

import numpy as np
import pytest
from ngsolve import GridFunction
from sheets import (
    Motion,
    Sheet,
    areas_by_face,
    contact_on,
    displaced,
    face_sizes,
    faces_of,
    in_plane,
    paired,
    projected_overlaps,
    sheet_mesh,
    two_sheets,
)

BOX = ((-0.15, -0.1), (0.9, 0.8))
KINDS = {2: ("edge", "edge"), 3: ("mixed", "mixed")}


@pytest.fixture(params=KINDS)
def dim(request):
    return request.param


def sheets(dim, seed=2):
    return two_sheets(np.random.default_rng(seed), KINDS[dim], BOX, 0.05)


def linear(dim, seed):
    """A random linear motion that neither flattens nor penetrates much."""
    rng, motion = np.random.default_rng(seed), Motion(dim, None, 1.0, (0.2, -0.1, 0.1))
    motion.R = np.eye(dim) + 0.3 * rng.uniform(-1, 1, (dim, dim))
    return motion


@pytest.mark.parametrize("seed", range(6))
@pytest.mark.parametrize("body", ["upper", "lower"])
def test_linear_motions_of_one_body(dim, seed, body):
    """Overlaps of the moved faces by shapely, and sizes of the moved slave faces."""
    motion = linear(dim, seed)
    contact = paired(sheets(dim), order=1 + seed % 2, penetration=1.0)
    faces = {name: faces_of(contact.mesh, name)[1] for name in ("slave", "master")}
    moving = "slave" if body == "upper" else "master"
    moved = faces | {moving: [motion(corners) for corners in faces[moving]]}
    for gf, now in ((displaced(contact, **{body: motion.field}), moved), (None, faces)):
        contact.Update(gf)
        exact = projected_overlaps(now["slave"], now["master"]).sum(axis=1)
        assert areas_by_face(contact) == pytest.approx(exact, abs=1e-12)
        assert contact.Table()["fullarea"] == pytest.approx(face_sizes(now["slave"]), rel=1e-12)


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_rigid_motion_of_everything_changes_nothing(dim, seed):
    contact = paired(sheets(dim))
    reference, motion = contact.Segments(), Motion(dim, seed, 1.0, (0.3, 7.0, -2.0))
    contact.Update(displaced(contact, upper=motion.field, lower=motion.field))
    there = contact.Segments()
    assert there.master.tolist() == reference.master.tolist()
    assert there.area == pytest.approx(reference.area, abs=1e-12)
    assert there.gap == pytest.approx(reference.gap, abs=1e-12)
    assert there.slave_points == pytest.approx(motion(reference.slave_points), abs=1e-12)
    normals = np.tile(-motion.R[:, -1], (contact.space.nmacros, 1))
    assert contact.Table()["normal"] == pytest.approx(normals, abs=1e-12)


def test_gaps_count_from_the_configuration(dim):
    """Linear in the displacement from the paired configuration on, and back to the reference."""
    contact = paired(sheets(dim))
    reference, pick = areas_by_face(contact), slice(None, None, 1 if dim == 3 else 2)
    gf = displaced(contact, upper=(0.1, 0.05, -0.02)[pick])
    contact.Update(gf)
    assert areas_by_face(contact) != pytest.approx(reference)
    contact.form.SetConstant(1.0)
    contact.Evaluate(gf)
    met = contact.Table()["area"] > 0
    assert contact.Table()["gap"][met] == pytest.approx(0.03, abs=1e-13)
    assert contact.Table()["slip"] == pytest.approx(0, abs=1e-15)
    contact.Evaluate(displaced(contact, upper=(0.13, 0.05, -0.06)[pick]))
    assert contact.Table()["gap"][met] == pytest.approx(-0.01, abs=1e-13)
    slip = np.tile([0.03, 0, 0][:dim], (met.sum(), 1))
    assert contact.Table()["slip"][met] == pytest.approx(slip, abs=1e-13)
    contact.Update()
    assert areas_by_face(contact) == pytest.approx(reference, abs=1e-15)


@pytest.mark.parametrize("value", [np.nan, np.inf, -np.inf])
@pytest.mark.parametrize("boundary", ["slave", "master"])
def test_values_that_are_not_finite(dim, boundary, value):
    """An error that says where; the pairing stays as it was."""
    contact = paired(sheets(dim))
    before = areas_by_face(contact)
    gf = displaced(contact)
    dofs = contact.form.component.GetDofs(contact.mesh.Boundaries(boundary))
    gf.components[0].vec.FV().NumPy()[np.flatnonzero([bool(b) for b in dofs])[3]] = value
    with pytest.raises(Exception, match=f"boundary '{boundary}'.*NaN or infinite"):
        contact.Update(gf)
    assert areas_by_face(contact) == pytest.approx(before, abs=0)


def outcome(call):
    """What a call returns, or the message of its error."""
    try:
        return call()
    except Exception as error:
        return str(error)


PLANE = in_plane([[-1, -1], [2, -1], [2, 2], [-1, 2]], -0.1)
ARROW = [[0, 0], [1, 0], [0.2, 0.2], [0, 1]]
FOLDED = {
    "collinear triangle": [[0, 0], [0.5, 0.25], [1, 0.5]],
    "bow tie": [[0, 0], [1, 1], [1, 0], [0, 1]],
    "arrow": ARROW,
    "arrow, numbered on": [*ARROW[1:], ARROW[0]],
    "point": [[0.5, 0.5]] * 4,
}


def update_to(shape, region, seed):
    """Deforms a good face of a slave or master surface into a bad one."""
    n, up, motion = len(shape), 1 if region == "slave" else -1, Motion(3, seed)
    good, bad = in_plane([[0, 0], [1, 0], [1, 1], [0, 1]][:n]), in_plane(shape)
    body = Sheet("body", good, [tuple(range(n))], (0, 0, 0.5 * up), region)
    other = Sheet("other", up * PLANE, [(0, 1, 2, 3)], (0, 0, -up),
                  "master" if up > 0 else "slave")  # fmt: skip
    mesh = sheet_mesh(body, other, motion=motion)
    contact = contact_on(mesh)
    gf = GridFunction(contact.form.fes)
    values = gf.components[0].vec.FV().NumPy().reshape(3, -1)
    for v in mesh.vertices:
        near = np.linalg.norm(motion(good) - v.point, axis=1)
        if near.min() < 1e-12:
            dofs = contact.form.component.components[0].GetDofNrs(v)
            values[:, dofs[0]] = (motion(bad) - motion(good))[near.argmin()]
    contact.Update(gf)
    return contact


@pytest.mark.parametrize("seed", [None, 1, 2])
@pytest.mark.parametrize("face", FOLDED)
@pytest.mark.parametrize("region", ["slave", "master"])
def test_degenerate_faces(face, region, seed):
    """An error on the slave; of the master one, too, or no more area than there is."""
    contact = outcome(lambda: update_to(FOLDED[face], region, seed))
    if isinstance(contact, str):
        words = ["slave surface is degenerate"] if region == "slave" else ["never meet", "degener"]
        assert any(word in contact for word in words)
        return
    segments = contact.Segments()
    assert region == "master"
    assert np.all(segments.area > 0)
    assert segments.gap == pytest.approx(0.1, abs=1e-9)
    assert segments.area.sum() < (0.5 if face == "bow tie" else 0.2 + 1e-9)


@pytest.mark.parametrize("seed", range(12))
def test_wild_displacements_do_no_harm(dim, seed):
    """Random displacements of all sizes: segments with positive finite areas, or an error."""
    rng = np.random.default_rng(seed)
    contact = paired(sheets(dim, seed), seed, 10.0 ** rng.integers(-6, 7), order=1 + seed % 3)
    size = np.ptp([v.point for v in contact.mesh.vertices], axis=0).max()
    gf = displaced(contact)
    values = gf.components[0].vec.FV().NumPy()
    values[:] = size * 10.0 ** rng.uniform(-12, 0) * rng.normal(size=len(values))
    error = outcome(lambda: contact.Update(gf))
    if error is not None:
        assert "never meet" in error or "degenerate" in error
        return
    segments, table = contact.Segments(), contact.Table()
    assert segments.area.min() > 0
    for array in (segments.area, segments.gap, segments.master_points, table["normal"]):
        assert np.all(np.isfinite(array))
    assert np.all(table["area"] <= (1 + 1e-3) * table["fullarea"])
