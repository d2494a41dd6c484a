"""Pairing of curved surfaces in 3D: concentric spheres and cylinders, and others that cover."""

from functools import cache

import numpy as np
import pytest
from curved3d import bend, cylinders, spheres
from ngsolve import BND, CF, GridFunction, Integrate, cos, exp, sin, x, y
from surfaces3d import Sheet, contact_on, in_plane, rigid, sheet_mesh, surface

CASES = [
    ("trig", 2, "ball"),
    ("trig", 2, "shell"),
    ("trig", 3, "ball"),
    ("mixed", 2, "shell"),
    ("quad", 2, "ball"),
]
CUTS = {"trig": ("all", "all"), "quad": ((), ()), "mixed": (range(0, 24, 2), range(1, 54, 3))}
WIDER = ((-0.5, -0.5), (1.5, 1.5))


@cache
def ball_in_shell(kind, order, slave, n=2, opening=0.1):
    """Mesh and contact."""
    mesh = spheres(n, round(1.5 * n), order, opening, CUTS[kind])
    master = "shell" if slave == "ball" else "ball"
    return mesh, contact_on(mesh, slave=slave, master=master)


def check_cover(contact, mesh, slave="slave", rel=1e-11, full=1e-11):
    """All faces pair completely: against the mesh's own surface measure."""
    table = contact.Table()
    exact = Integrate(CF(1), mesh.Boundaries(slave), BND, element_wise=True, order=20).NumPy()
    macros = np.array(contact.space.macros)
    assert table["area"][macros[macros >= 0]] == pytest.approx(exact[macros >= 0], rel=rel)
    assert table["fullarea"][macros[macros >= 0]] == pytest.approx(exact[macros >= 0], rel=full)
    report = contact.Check()
    assert len(report.unpaired) == len(report.partial) == 0


@pytest.mark.parametrize(
    ("kind", "order", "slave"), [("trig", 1, "ball"), ("trig", 1, "shell"), *CASES]
)
def test_spheres_pair_completely(kind, order, slave):
    mesh, contact = ball_in_shell(kind, order, slave)
    check_cover(contact, mesh, slave)


@pytest.mark.parametrize(("kind", "order", "slave"), CASES)
def test_gap_of_spheres_is_the_difference_of_the_radii(kind, order, slave):
    _, contact = ball_in_shell(kind, order, slave)
    segments, table = contact.Segments(), contact.Table()
    start, end = (
        np.linalg.norm(p, axis=1) for p in (segments.slave_points, segments.master_points)
    )
    inner, outer = (start, end) if slave == "ball" else (end, start)
    assert inner == pytest.approx(1.0, abs=1.5e-2)  # of the geometry, with 48 faces
    assert outer == pytest.approx(1.1, abs=1.5e-2)
    assert segments.gap == pytest.approx(0.1, abs=1.5e-2)
    assert segments.area @ segments.gap / segments.area.sum() == pytest.approx(0.1, abs=6e-3)
    sign = {"ball": 1, "shell": -1}[slave]
    radial = sign * table["x"] / np.linalg.norm(table["x"], axis=1)[:, None]
    assert np.sum(radial * table["normal"], axis=1).min() > 0.999


@pytest.mark.slow
@pytest.mark.parametrize(("order", "rate", "finest"), [(1, 1.5, 4), (2, 3.3, 4), (3, 3.5, 3)])
def test_refinement_converges_to_spheres(order, rate, finest):
    """Area, mean and largest error of the gap."""
    errors = []
    for n in (2, finest):
        _, contact = ball_in_shell("trig", order, "ball", n=n)
        s = contact.Segments()
        area = s.area.sum()
        errors.append(
            [area / (4 * np.pi) - 1, s.area @ s.gap / area - 0.1, np.abs(s.gap - 0.1).max()]
        )
    rates = np.log(np.abs(errors[0]) / np.abs(errors[1])) / np.log(finest / 2)
    assert np.all(rates > rate), (errors, rates)


@pytest.mark.parametrize("opening", [0.0, 0.5, -0.01])
def test_opening_of_spheres(opening):
    mesh, contact = ball_in_shell("trig", 2, "ball", opening=opening)
    check_cover(contact, mesh, "ball")
    segments = contact.Segments()
    mean = segments.area @ segments.gap / segments.area.sum()
    assert mean == pytest.approx(opening, abs=1e-2)


def test_six_faces_make_a_sphere():
    """Faces that are bent by a right angle: coarser than any mesh should be."""
    mesh = spheres(1, 2, 3, 0.1)
    contact = contact_on(mesh, slave="ball", master="shell")
    check_cover(contact, mesh, "ball", rel=1e-7, full=1e-7)
    segments = contact.Segments()
    assert segments.gap == pytest.approx(0.1, abs=0.08)


@pytest.mark.parametrize("kind", ["trig", "quad"])
def test_partition_of_unity_on_spheres(kind):
    """Constants: D c = M c = paired areas times c."""
    _, contact = ball_in_shell(kind, 2, "ball")
    gf = GridFunction(contact.form.component)
    gf.Set(CF((1.0, -2.0, 3.0)))
    expected = np.outer(contact.Table()["area"], [1, -2, 3]).ravel()
    for operator in contact.Mortar():
        values = (operator * gf.vec).Evaluate().FV().NumPy()
        assert values == pytest.approx(expected, abs=1e-12)


# ---------------------------------------------------------------- cylinders


@pytest.mark.parametrize("kinds", [("trig", "quad"), ("quad", "trig")])
@pytest.mark.parametrize(("order", "error"), [(2, 4e-3), (3, 1e-4)])
def test_cylinders(kinds, order, error):
    mesh = cylinders(order, kinds, (-0.8, 0.9))
    contact = contact_on(mesh)
    check_cover(contact, mesh)
    segments = contact.Segments()
    assert segments.area.sum() == pytest.approx(1.2, rel=error)
    assert segments.gap == pytest.approx(0.05, abs=max(2e-3, error))


@pytest.mark.parametrize("kinds", [("trig", "quad"), ("quad", "trig")])
def test_the_rim_of_a_curved_master_ends_the_pairing(kinds):
    """Rays that pass the rim miss; the slave area up to there counts."""
    mesh = cylinders(3, kinds, (-0.25, 0.9))
    segments = contact_on(mesh).Segments()
    assert segments.area.sum() == pytest.approx(0.85, rel=2e-3)
    angle = np.arctan2(segments.slave_points[:, 0], segments.slave_points[:, 2])
    assert angle.min() == pytest.approx(-0.25, abs=2e-3)


# ---------------------------------------------------------------- curved edges, warped faces


def sheets(kinds, gap, seed, n=(4, 5), box=WIDER):
    rng = np.random.default_rng(seed)
    slave, master = surface(rng, kinds[0], n[0]), surface(rng, kinds[1], n[1], box)
    return [
        Sheet("upper", in_plane(slave[0]), slave[1], (0, 0, 0.5), "slave", renumbered=rng),
        Sheet("lower", in_plane(master[0], -gap), master[1], (0, 0, -0.5), "master",
              renumbered=rng),
    ]  # fmt: skip


@pytest.mark.parametrize(
    ("kinds", "order"), [(("trig", "quad"), 2), (("quad", "trig"), 3), (("mixed", "mixed"), 2)]
)
@pytest.mark.parametrize("which", ["slave", "master"])
def test_flat_faces_with_curved_edges(kinds, order, which):
    """In the plane every edge is bent, some more than others: nothing is lost between faces."""
    mesh = sheet_mesh(*sheets(kinds, 0.02, 3))
    shape = CF((0.06 * sin(4 * y) * x * (1 - x), 0.05 * sin(5 * x) * y * (1 - y), 0))
    bend(mesh, order, shape, which)
    contact = contact_on(mesh)
    segments = contact.Segments()
    assert segments.gap == pytest.approx(0.02, rel=1e-10)
    check_cover(contact, mesh)


FIELDS = {
    "cubic": lambda size: size * x**3,
    "bump": lambda size: size * exp(-((x - 0.5) ** 2 + (y - 0.5) ** 2) / 0.1),
    "waves": lambda size: size * sin(5 * x) * cos(4 * y) * x,
}


@pytest.mark.parametrize(
    ("field", "kinds"),
    [
        ("cubic", ("quad", "trig")),
        ("bump", ("trig", "mixed")),
        ("waves", ("trig", "quad")),
        ("waves", ("mixed", "trig")),
    ],
)
@pytest.mark.parametrize(("order", "size"), [(2, 0.02), (3, 0.15)])
def test_unevenly_curved_surfaces_pair_completely(kinds, field, order, size):
    """Some faces are nearly flat, others are not: nothing is lost between them.

    Facets of the master leave slits, for which weights make up as if faces were plane.
    """
    height = CF((0, 0, FIELDS[field](size)))
    mesh = sheet_mesh(*sheets(kinds, 0.0, 5))
    bend(mesh, order, height, "slave|master")
    contact = contact_on(mesh)
    check_cover(contact, mesh, rel=1e-6)
    assert contact.Segments().gap == pytest.approx(0, abs=0.5 * size)


@pytest.mark.parametrize("kinds", [("quad", "quad"), ("quad", "trig"), ("mixed", "quad")])
@pytest.mark.parametrize("seed", [None, 2])
def test_warped_quadrilaterals(kinds, seed):
    """Bilinear faces that are not plane, on both sides of a saddle."""
    both = []
    for s in sheets(kinds, 0.0, 4):
        p = s.points.copy()
        p[:, 2] = 0.2 * p[:, 0] * p[:, 1] + 0.1 * p[:, 0] ** 2 - (0.01 if s.face == "master" else 0)
        both.append(Sheet(s.name, p, s.faces, s.depth, s.face))
    mesh = sheet_mesh(*both, motion=rigid(seed))
    contact = contact_on(mesh)
    check_cover(contact, mesh)
    assert contact.Segments().gap == pytest.approx(0.01, abs=0.02)
