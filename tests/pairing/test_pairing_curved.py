"""Pairing of curved surfaces: circles, spheres and cylinders, and others that cover."""

from functools import cache

import numpy as np
import pytest
from curved import ball, bend, spheres
from ngsolve import BND, CF, Integrate, Timers, cos, exp, sin, sqrt, x, y, z
from sheets import (
    WIDER,
    Motion,
    Sheet,
    contact_on,
    displaced,
    grid,
    lower,
    mean_gap,
    sheet_mesh,
    two_sheets,
    upper,
    with_slave_normals,
)

BOTH = "slave|master"
PAIRS = [("trig", "quad"), ("quad", "trig"), ("mixed", "mixed")]
# Errors of circles with 16 and 22 edges, and of spheres with 48 to 324 faces.
ERROR = {1: 1e-2, 2: 1e-4, 3: 1e-4, 4: 1e-6}
CASES = [("edge", order, slave) for order in ERROR for slave in ("ball", "shell")]
CASES += [("trig", 2, "ball"), ("trig", 2, "shell"), ("trig", 3, "ball"), ("mixed", 2, "shell")]
CASES += [("quad", 2, "ball")]
ROUGH = [("trig", 1, "ball"), ("trig", 1, "shell")]  # whose gaps are far from those of spheres


@cache
def ball_in_shell(kind, order, slave="ball", n=2, opening=0.1):
    """Mesh and contact."""
    m = 1.4 * n if kind == "edge" else round(1.5 * n)
    mesh = spheres(kind, n, m, order, opening, Motion(3, 1))
    master = "shell" if slave == "ball" else "ball"
    return mesh, contact_on(mesh, slave=slave, master=master)


def check_cover(contact, mesh, slave="slave", rel=1e-11):
    """All faces pair completely: against the mesh's own surface measure."""
    table, report = contact.Table(), contact.Check()
    exact = Integrate(CF(1), mesh.Boundaries(slave), BND, element_wise=True, order=20).NumPy()
    macros = np.array(contact.space.macros)
    full = max(rel, 1e-7 if mesh.dim == 2 else rel)
    rel = max(rel, 1e-10 if mesh.dim == 2 else rel)
    assert table["area"][macros[macros >= 0]] == pytest.approx(exact[macros >= 0], rel=rel)
    assert table["fullarea"][macros[macros >= 0]] == pytest.approx(exact[macros >= 0], rel=full)
    assert len(report.unpaired) == len(report.partial) == 0


@pytest.mark.parametrize(("kind", "order", "slave"), ROUGH + CASES)
def test_spheres_pair_completely(kind, order, slave):
    """Gaps are the difference of the radii; normals by symmetry those of edges in the plane."""
    mesh, contact = ball_in_shell(kind, order, slave)
    check_cover(contact, mesh, slave)
    if (kind, order, slave) in ROUGH:
        return
    segments, table = contact.Segments(), with_slave_normals(contact).Table()
    error = 1.1 * (1 - np.cos(np.pi / 16)) if order == 1 else ERROR[order]  # from chords
    error = 1.5e-2 if mesh.dim == 3 else error
    start, end = (
        np.linalg.norm(p, axis=-1) for p in (segments.slave_points, segments.master_points)
    )
    inner, outer = (start, end) if slave == "ball" else (end, start)
    assert inner == pytest.approx(1.0, abs=error)
    assert outer == pytest.approx(1.1, abs=error)
    assert segments.gap == pytest.approx(0.1, abs=error)
    assert mean_gap(contact) == pytest.approx(0.1, abs=6e-3 if mesh.dim == 3 else ERROR[order])
    sign = {"ball": 1, "shell": -1}[slave]
    radial = sign * table["x"] / np.linalg.norm(table["x"], axis=1)[:, None]
    assert np.abs(table["normal"] - radial).max() < (1e-13 if mesh.dim == 2 else 0.045)


@pytest.mark.parametrize("order", ERROR)
def test_segments_end_at_vertices_and_tile_the_circle(order):
    """A segment ends at a vertex of the slave or, seen along the normal, of the master."""
    mesh, contact = ball_in_shell("edge", order)
    segments, points = contact.Segments(), np.array([v.point for v in mesh.vertices])
    ends = [p.reshape(-1, 2) for p in (segments.slave_points, segments.master_points)]
    for pair in zip(*ends, strict=True):
        assert min(np.linalg.norm(points - p, axis=1).min() for p in pair) < 1e-12
    p = segments.slave_points
    angle = np.sort(np.unwrap(np.arctan2(p[..., 1], p[..., 0]), axis=1), axis=1)
    angle = angle[np.argsort(angle[:, 0])]
    assert angle[1:, 0] == pytest.approx(angle[:-1, 1], abs=1e-11)
    assert angle[-1, 1] - angle[0, 0] == pytest.approx(2 * np.pi, abs=1e-11)


@pytest.mark.parametrize(
    ("kind", "order", "rate", "sizes"),
    [
        ("edge", 1, 1.65, (1, 4)),
        ("edge", 2, 3.65, (1, 4)),
        ("edge", 3, 3.65, (1, 4)),
        ("edge", 4, 5.65, (1, 4)),
        ("trig", 1, 1.5, (2, 4)),
        ("trig", 2, 3.3, (2, 4)),
        ("trig", 3, 3.5, (2, 3)),
    ],
)
def test_refinement_converges_to_spheres(kind, order, rate, sizes):
    """Area, mean and largest error of the gap (in the plane even orders by one order more)."""
    errors = []
    for n in sizes:
        mesh, contact = ball_in_shell(kind, order, n=n)
        s, exact = contact.Segments(), {2: 2 * np.pi, 3: 4 * np.pi}[mesh.dim]
        errors.append([s.area.sum() / exact - 1, mean_gap(contact) - 0.1])
        errors[-1] += [np.abs(s.gap - 0.1).max()] if mesh.dim == 3 else []
    rates = np.log(np.abs(errors[0]) / np.abs(errors[1])) / np.log(sizes[1] / sizes[0])
    assert np.all(rates > rate), (errors, rates)


@pytest.mark.parametrize("kind", ["edge", "trig"])
@pytest.mark.parametrize("opening", [0.0, 1e-3, 0.5, -0.01])
def test_opening_of_spheres(kind, opening):
    mesh, contact = ball_in_shell(kind, 2, opening=opening)
    check_cover(contact, mesh, "ball")
    assert mean_gap(contact) == pytest.approx(opening, abs=1e-2 if kind == "trig" else 2e-4)


def test_six_faces_make_a_sphere():
    """Faces that are bent by a right angle: coarser than any mesh should be."""
    mesh = spheres("quad", 1, 2, 3, 0.1)
    contact = contact_on(mesh, slave="ball", master="shell")
    check_cover(contact, mesh, "ball", rel=1e-7)
    assert contact.Segments().gap == pytest.approx(0.1, abs=0.08)


def test_gap_of_eccentric_circles_is_measured_along_the_normal():
    """A ray of the shifted disc against the ring's circle: not the shortest distance."""
    _, contact = ball_in_shell("edge", 4, n=5)
    shift = np.array([0.04, 0.02])
    contact.Update(displaced(contact, **{"in": shift}))
    segments = contact.Segments()
    start, end = segments.slave_points.reshape(-1, 2), segments.master_points.reshape(-1, 2)
    normal = start - shift
    b, c = np.sum(start * normal, axis=1), np.sum(start**2, axis=1) - 1.1**2
    distance = -b + np.sqrt(b * b - c)
    assert np.linalg.norm(end - start, axis=1) == pytest.approx(distance, abs=2e-8)
    assert np.linalg.norm(end - start, axis=1).min() < 0.1 - 0.99 * np.linalg.norm(shift)


@pytest.mark.parametrize(("kind", "order"), [("edge", 2), ("edge", 3), ("trig", 2), ("trig", 3)])
def test_inflated_ball(kind, order):
    """A displacement on top of a curved geometry."""
    mesh = spheres(kind, 2, 3, order, 0.1)
    contact = contact_on(mesh, slave="ball", master="shell", order=order)
    before, d = with_slave_normals(contact).Table(), mesh.dim
    contact.Update(displaced(contact, **{"in": [0.05 * c for c in (x, y, z)[:d]]}))
    after = with_slave_normals(contact).Table()
    for name in ("area", "fullarea"):
        tol = 1e-6 if d == 2 else 1e-9
        assert after[name] == pytest.approx(1.05 ** (d - 1) * before[name], rel=tol)
    assert after["normal"] == pytest.approx(before["normal"], abs=1e-9)
    assert mean_gap(contact) == pytest.approx(0.05, abs=2e-4 if d == 2 else 6e-3)


@pytest.mark.parametrize("kinds", PAIRS[:2])
def test_the_rim_of_a_curved_master_ends_the_pairing(kinds):
    """Cylinders about the same axis: rays that pass the rim miss; the area up to there counts."""
    ends = 1.05 * np.sin((-0.25, 0.9))
    slave = upper(grid(kinds[0], 3, np.transpose([np.sin((-0.6, 0.6)), (0, 1)])))
    mesh = sheet_mesh(slave, lower(grid(kinds[1], 4, np.transpose([ends, (-0.2, 1.1)]))))
    square = mesh.BoundaryCF({"slave": 1, "master": 1.05**2}, default=4)
    bend(mesh, 3, CF((0, 0, 1 - sqrt(square - x * x))), BOTH)
    segments = contact_on(mesh).Segments()
    assert segments.area.sum() == pytest.approx(0.85, rel=2e-3)
    assert segments.gap == pytest.approx(0.05, abs=2e-3)
    angle = np.arctan2(segments.slave_points[:, 0], 1 - segments.slave_points[:, 2])
    assert angle.min() == pytest.approx(-0.25, abs=2e-3)


EDGES = 0.06 * sin(4 * y) * x * (1 - x), 0.05 * sin(5 * x) * y * (1 - y), 0
CUBIC, WAVES = (0, 0, x**3), (0, 0, sin(5 * x) * cos(4 * y) * x)
BUMP = 0, 0, exp(-((x - 0.5) ** 2 + (y - 0.5) ** 2) / 0.1)
# Field, its factor, where, order, kinds of faces, opening, tolerances of areas and gaps.
BENT = [
    (EDGES, 1, side, order, kinds, 0.02, 1e-11, 1e-11)
    for side, order, kinds in [("slave", 2, PAIRS[0]), ("master", 2, PAIRS[2]),
                               ("slave", 3, PAIRS[1]), ("master", 3, PAIRS[0])]
]  # fmt: skip
BENT += [
    (field, size, BOTH, order, kinds, 0.0, 1e-6, 0.5 * size)
    for field, kinds in [(CUBIC, PAIRS[1]), (BUMP, PAIRS[2]), (WAVES, PAIRS[0])]
    for order, size in [(2, 0.02), (3, 0.15)]
]
SADDLE = 0, 0, 0.2 * x * y + 0.1 * x * x
BENT += [
    (SADDLE, 1, BOTH, 1, kinds, 0.01, 1e-11, 0.02)
    for kinds in [("quad", "quad"), ("quad", "trig"), ("mixed", "quad")]
]


@pytest.mark.parametrize(("field", "size", "side", "order", "kinds", "gap", "rel", "tol"), BENT)
def test_bent_sheets_pair_completely(field, size, side, order, kinds, gap, rel, tol):
    """In the plane with curved edges, unevenly curved, of warped faces: nothing is lost between.

    Facets of the master leave slits, for which weights make up as if faces were plane.
    """
    mesh = sheet_mesh(*two_sheets(np.random.default_rng(3), kinds, WIDER, gap, n=(4, 5)))
    bend(mesh, order, size * CF(field), side)
    contact = contact_on(mesh)
    check_cover(contact, mesh, rel=rel)
    assert contact.Segments().gap == pytest.approx(gap, abs=tol)


def seconds():
    return {timer["name"].removeprefix("ngslac::"): timer["time"] for timer in Timers()}


def test_faces_that_are_far_away_do_not_search_everywhere():
    """A coarse ball of radius 1 far above a fine plate: the search is narrow, however long."""
    points, faces = ball("trig", 1)
    points = Motion(3, 3)(points)
    plate = lower(grid("quad", 80, ((-30, -30), (30, 30))), -20)
    mesh = sheet_mesh(Sheet("in", points, faces, -0.3 * points, "ball"), plate)
    bend(mesh, 3, (1 / sqrt(x * x + y * y + z * z) - 1) * CF((x, y, z)), "ball")
    before = seconds()
    contact = contact_on(mesh, slave="ball", order=3)
    spent = {name: now - before.get(name, 0) for name, now in seconds().items()}
    search = spent["Pair"] - spent["Facets"] - spent["Pair - tree"]
    assert contact.Table()["area"].sum() > 0
    assert search < 4 * spent["Surface"]  # to read the faces once
