"""Pairing in 3D in the configuration of a GridFunction; what cannot be paired is an error."""

import numpy as np
import pytest
from curved3d import spheres
from ngsolve import CF, GridFunction, VectorH1, x, y, z
from surfaces3d import (
    Sheet,
    areas_by_face,
    areas_by_pair,
    contact_on,
    face_vector,
    faces_of,
    in_plane,
    projected_overlaps,
    rigid,
    sheet_mesh,
    surface,
)

SHIFTED = ((-0.15, -0.1), (0.9, 0.8))


def two_sheets(seed=2, gap=0.05, **flags):
    rng = np.random.default_rng(seed)
    slave, master = surface(rng, "mixed", 3), surface(rng, "mixed", 4, SHIFTED)
    return sheet_mesh(
        Sheet("upper", in_plane(slave[0], gap), slave[1], (0, 0, 0.5), "slave", renumbered=rng),
        Sheet("lower", in_plane(master[0]), master[1], (0, 0, -0.5), "master", renumbered=rng),
        **flags,
    )


def displaced(contact, **fields):
    """A GridFunction on the contact's space with given displacements of the materials."""
    gf = GridFunction(contact.form.fes)
    cfs = {name: CF(field) for name, field in fields.items()}
    gf.components[0].Set(contact.mesh.MaterialCF(cfs, default=CF((0, 0, 0))))
    return gf


def linear(matrix, shift=(0.0, 0.0, 0.0)):
    """The displacement that maps points X to matrix X + shift, in Python and as a function."""
    matrix, shift = np.asarray(matrix, dtype=float), np.asarray(shift, dtype=float)
    cf = tuple(
        float(a - (i == 0)) * x + float(b - (i == 1)) * y + float(c - (i == 2)) * z + float(s)
        for i, ((a, b, c), s) in enumerate(zip(matrix, shift, strict=True))
    )
    return (lambda points: points @ matrix.T + shift), cf


def overlaps(mesh, upper=None, lower=None):
    """Overlaps of the moved faces by shapely, and areas of the moved slave faces."""
    moved = []
    for region, motion in (("slave", upper), ("master", lower)):
        corners = faces_of(mesh, region)[1]
        moved.append([motion(c) if motion else c for c in corners])
    return projected_overlaps(*moved), [0.5 * np.linalg.norm(face_vector(c)) for c in moved[0]]


MOTIONS = {
    "shift": linear(np.eye(3), (0.3, -0.2, 0.1)),
    "turn about the normal": linear([[0.8, -0.6, 0], [0.6, 0.8, 0], [0, 0, 1]]),
    "stretch": linear(np.diag([1.7, 0.6, 1.0]), (-0.3, 0.1, 0)),
    "shear": linear([[1, 0.5, 0], [0, 1, 0], [0.2, -0.1, 1]]),
}


@pytest.mark.pairwise
@pytest.mark.parametrize("order", [1, 2])
@pytest.mark.parametrize("motion", MOTIONS)
@pytest.mark.parametrize("body", ["upper", "lower"])
def test_linear_motions_of_one_body(order, motion, body):
    contact = contact_on(two_sheets(), order=order)
    mapping, field = MOTIONS[motion]
    contact.Update(displaced(contact, **{body: field}))
    exact, size = overlaps(contact.mesh, **{body: mapping})
    assert areas_by_face(contact) == pytest.approx(exact.sum(axis=1), abs=1e-12)
    assert contact.Table()["fullarea"] == pytest.approx(size, rel=1e-12)


@pytest.mark.parametrize("seed", [1, 2])
def test_rigid_motion_of_everything_changes_nothing(seed):
    contact = contact_on(two_sheets())
    reference = contact.Segments()
    motion = rigid(seed, 1.0, (0.3, 7.0, -2.0))
    matrix = motion(np.eye(3)).T - motion(np.zeros((3, 3))).T
    field = linear(matrix, (0.3, 7.0, -2.0))[1]
    contact.Update(displaced(contact, upper=field, lower=field))
    there = contact.Segments()
    assert there.master.tolist() == reference.master.tolist()
    assert there.area == pytest.approx(reference.area, abs=1e-12)
    assert there.gap == pytest.approx(reference.gap, abs=1e-12)
    assert contact.Table()["normal"] == pytest.approx(
        np.tile(matrix @ [0, 0, -1.0], (contact.space.nmacros, 1)), abs=1e-12
    )


def test_moved_mesh_and_displaced_mesh_pair_alike():
    """Moved by SetDeformation, by Update, and made there: three ways to the same segments."""
    mapping, field = MOTIONS["shear"]
    reference = sheet_mesh_of(mapping)
    mesh = two_sheets()
    contact = contact_on(mesh)
    contact.Update(displaced(contact, upper=field))
    by_update = areas_by_pair(contact)
    deformation = GridFunction(VectorH1(mesh, order=1))
    deformation.Set(mesh.MaterialCF({"upper": CF(field)}, default=CF((0, 0, 0))))
    mesh.SetDeformation(deformation)
    by_deformation = areas_by_pair(contact_on(mesh))
    expected = areas_by_pair(contact_on(reference))
    for found in (by_update, by_deformation):
        for pair in expected.keys() | found.keys():
            assert found.get(pair, 0) == pytest.approx(expected.get(pair, 0), abs=1e-13)


def sheet_mesh_of(mapping):
    """The mesh of `two_sheets` with its upper body moved."""
    rng = np.random.default_rng(2)
    slave, master = surface(rng, "mixed", 3), surface(rng, "mixed", 4, SHIFTED)
    near, far = mapping(in_plane(slave[0], 0.05)), mapping(in_plane(slave[0], 0.55))
    return sheet_mesh(
        Sheet("upper", near, slave[1], far - near, "slave", renumbered=rng),
        Sheet("lower", in_plane(master[0]), master[1], (0, 0, -0.5), "master", renumbered=rng),
    )


def test_gaps_count_from_the_configuration():
    """Linear in the displacement from the paired configuration on, and back to the reference."""
    contact = contact_on(two_sheets())
    reference = areas_by_face(contact)
    gf = displaced(contact, upper=(0.1, 0.05, -0.02))
    contact.Update(gf)
    contact.form.SetConstant(1.0)
    contact.Evaluate(gf)
    paired = contact.Table()["area"] > 0
    assert contact.Table()["gap"][paired] == pytest.approx(0.03, abs=1e-13)
    assert contact.Table()["slip"] == pytest.approx(0, abs=1e-15)
    contact.Evaluate(displaced(contact, upper=(0.13, 0.05, -0.06)))
    assert contact.Table()["gap"][paired] == pytest.approx(-0.01, abs=1e-13)
    slip = np.tile([0.03, 0, 0], (paired.sum(), 1))
    assert contact.Table()["slip"][paired] == pytest.approx(slip, abs=1e-13)
    contact.Update()
    assert areas_by_face(contact) == pytest.approx(reference, abs=1e-15)


@pytest.mark.parametrize("order", [2, 3])
def test_inflated_ball(order):
    """A displacement on top of a curved geometry."""
    mesh = spheres(2, 2, order, 0.1, ("all", "all"))
    contact = contact_on(mesh, slave="ball", master="shell", order=order)
    before = contact.Table()
    contact.Update(displaced(contact, **{"in": (0.05 * x, 0.05 * y, 0.05 * z)}))
    after = contact.Table()
    assert after["area"] == pytest.approx(1.05**2 * before["area"], rel=1e-9)
    assert after["fullarea"] == pytest.approx(1.05**2 * before["fullarea"], rel=1e-9)
    assert after["normal"] == pytest.approx(before["normal"], abs=1e-9)
    segments = contact.Segments()
    mean = segments.area @ segments.gap / segments.area.sum()
    assert mean == pytest.approx(0.05, abs=6e-3)  # of the geometry, with 48 faces


# ---------------------------------------------------------------- what cannot be paired


@pytest.mark.parametrize("value", [np.nan, np.inf, -np.inf])
@pytest.mark.parametrize("boundary", ["slave", "master"])
def test_values_that_are_not_finite(boundary, value):
    """An error that says where; the pairing stays as it was."""
    contact = contact_on(two_sheets())
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
FOLDED = {
    "collinear triangle": ([[0, 0], [0.5, 0.25], [1, 0.5]], (0, 1, 2)),
    "bow tie": ([[0, 0], [1, 1], [1, 0], [0, 1]], (0, 1, 2, 3)),
    "arrow": ([[0, 0], [1, 0], [0.2, 0.2], [0, 1]], (0, 1, 2, 3)),
    "arrow, numbered on": ([[0, 0], [1, 0], [0.2, 0.2], [0, 1]], (1, 2, 3, 0)),
    "point": ([[0.5, 0.5]] * 4, (0, 1, 2, 3)),
}


def update_to(shape, numbers, region, seed):
    """Deforms a good face of a slave or master surface into a bad one."""
    n = len(numbers)
    good = in_plane([[0, 0], [1, 0], [1, 1], [0, 1]][:n])
    bad = in_plane(np.array(shape)[list(numbers)])
    other = Sheet("other", PLANE if region == "slave" else -PLANE, [(0, 1, 2, 3)],
                  (0, 0, -1 if region == "slave" else 1),
                  "master" if region == "slave" else "slave")  # fmt: skip
    depth = (0, 0, 0.5 if region == "slave" else -0.5)
    body = Sheet("body", good, [tuple(range(n))], depth, region)
    mesh = sheet_mesh(body, other, motion=rigid(seed))
    contact = contact_on(mesh)
    gf = GridFunction(contact.form.fes)
    values = gf.components[0].vec.FV().NumPy().reshape(3, -1)
    moved = rigid(seed)(bad) - rigid(seed)(good)
    for v in mesh.vertices:
        near = np.linalg.norm(rigid(seed)(good) - v.point, axis=1)
        if near.min() < 1e-12:
            dofs = contact.form.component.components[0].GetDofNrs(v)
            values[:, dofs[0]] = moved[near.argmin()]
    contact.Update(gf)
    return contact


@pytest.mark.parametrize("seed", [None, 1, 2, 3])
@pytest.mark.parametrize("face", FOLDED)
def test_degenerate_slave_faces_are_an_error(face, seed):
    with pytest.raises(Exception, match="slave surface is degenerate"):
        update_to(*FOLDED[face], "slave", seed)


@pytest.mark.parametrize("seed", [None, 1])
@pytest.mark.parametrize("face", FOLDED)
def test_degenerate_master_faces_are_no_partners(face, seed):
    """An error, or no more area than there is."""
    contact = outcome(lambda: update_to(*FOLDED[face], "master", seed))
    if isinstance(contact, str):
        assert "never meet" in contact or "degenerate" in contact
    else:
        segments = contact.Segments()
        assert np.all(segments.area > 0)
        assert segments.gap == pytest.approx(0.1, abs=1e-9)
        assert segments.area.sum() < (0.5 if face == "bow tie" else 0.2 + 1e-9)


@pytest.mark.parametrize("seed", range(16))
def test_wild_displacements_do_no_harm(seed):
    """Random displacements of all sizes: segments with positive finite areas, or an error."""
    rng = np.random.default_rng(seed)
    mesh = two_sheets(seed, motion=rigid(seed, 10.0 ** rng.integers(-6, 7)))
    contact = contact_on(mesh, order=1 + seed % 3)
    size = np.ptp([v.point for v in mesh.vertices], axis=0).max()
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
