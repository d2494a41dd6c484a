"""Pairing of curved surfaces: concentric circles, for which everything is known."""

import numpy as np
import pytest
from circles import disc_in_ring
from ngsolve import BND, CF, GridFunction, Integrate
from strips import contact_on

ORDERS = (1, 2, 3, 4)
SIDES = (("disc", "ring"), ("ring", "disc"))
# Error of the piecewise polynomial circles with 16 and 22 faces, relative to the radius: what an
# exact pairing of the inexact geometry may differ by.
ERROR = {1: 1e-2, 2: 1e-4, 3: 1e-4, 4: 1e-6}


def pair(order, slave="disc", master="ring", n=16, **sizes):
    mesh = disc_in_ring(order=order, n_inner=n, n_outer=round(1.4 * n), **sizes)
    return mesh, contact_on(mesh, slave=slave, master=master)


@pytest.mark.parametrize("order", ORDERS)
@pytest.mark.parametrize(("slave", "master"), SIDES)
def test_the_whole_slave_surface_pairs(order, slave, master):
    """Area against the mesh's own surface measure, by a quadrature of higher order."""
    mesh, contact = pair(order, slave, master)
    length = Integrate(CF(1), mesh.Boundaries(slave), BND, order=20)
    table = contact.Table()
    assert len(table["area"]) == {"disc": 16, "ring": 22}[slave]
    assert table["area"].sum() == pytest.approx(length, rel=1e-10)
    assert table["fullarea"].sum() == pytest.approx(length, rel=1e-7)
    radius = {"disc": 1.0, "ring": 1.1}[slave]
    assert length == pytest.approx(2 * np.pi * radius, rel=ERROR[order])


@pytest.mark.pairwise
@pytest.mark.parametrize("order", ORDERS)
@pytest.mark.parametrize(("slave", "master"), SIDES)
@pytest.mark.parametrize("opening", [0.0, 1e-3, 0.1])
def test_gap_is_the_distance_of_the_circles(order, slave, master, opening):
    _, contact = pair(order, slave, master, outer=1 + opening)
    segments = contact.Segments()
    assert segments.gap == pytest.approx(opening, abs=ERROR[order])
    mean = segments.area @ segments.gap / segments.area.sum()
    assert mean == pytest.approx(opening, abs=ERROR[order])


@pytest.mark.parametrize("order", ORDERS)
@pytest.mark.parametrize(("slave", "master"), SIDES)
def test_normals_point_out_of_the_slave_body(order, slave, master):
    _, contact = pair(order, slave, master)
    table = contact.Table()
    radial = table["x"] / np.linalg.norm(table["x"], axis=1)[:, None]
    # By symmetry the mean normal of a face of a circle is the direction of its centroid.
    sign = {"disc": 1, "ring": -1}[slave]
    assert table["normal"] == pytest.approx(sign * radial, abs=1e-13)


@pytest.mark.parametrize("order", ORDERS)
def test_segments_lie_on_both_surfaces(order):
    mesh, contact = pair(order, center=(0.3, -0.2))
    segments = contact.Segments()
    slave, master = (
        np.hypot(p[..., 0] - 0.3, p[..., 1] + 0.2)
        for p in (segments.slave_points, segments.master_points)
    )
    # The vertices are on the circles, so that chords are the farthest from them.
    sagitta = 1.1 * (1 - np.cos(np.pi / 16)) if order == 1 else ERROR[order]
    assert slave == pytest.approx(1.0, abs=sagitta)
    assert master == pytest.approx(1.1, abs=sagitta)
    # A segment ends at a vertex of the slave or, seen along the normal, of the master.
    points = np.array([v.point for v in mesh.vertices])
    for pair_of_points in zip(
        segments.slave_points.reshape(-1, 2), segments.master_points.reshape(-1, 2), strict=True
    ):
        assert min(np.linalg.norm(points - p, axis=1).min() for p in pair_of_points) < 1e-12


@pytest.mark.parametrize("order", ORDERS)
@pytest.mark.parametrize(("slave", "master"), SIDES)
def test_segments_tile_the_circle(order, slave, master):
    _, contact = pair(order, slave, master)
    points = contact.Segments().slave_points
    angle = np.sort(np.unwrap(np.arctan2(points[..., 1], points[..., 0]), axis=1), axis=1)
    angle = angle[np.argsort(angle[:, 0])]
    assert angle[1:, 0] == pytest.approx(angle[:-1, 1], abs=1e-11)
    assert angle[-1, 1] - angle[0, 0] == pytest.approx(2 * np.pi, abs=1e-11)


@pytest.mark.parametrize(("order", "rate"), [(1, 2), (2, 4), (3, 4), (4, 6)])
def test_refinement_converges_to_the_circle(order, rate):
    """Area and mean gap converge as fast as the geometry (even orders by one order more)."""
    errors = []
    for n in (8, 16, 32):
        _, contact = pair(order, n=n)
        segments = contact.Segments()
        gap = segments.area @ segments.gap / segments.area.sum()
        errors.append((abs(segments.area.sum() / (2 * np.pi) - 1), abs(gap - 0.1)))
    rates = np.log2(np.array(errors[0]) / np.array(errors[2])) / 2
    assert np.all(rates > rate - 0.35), (errors, rates)


def test_gap_of_eccentric_circles_is_measured_along_the_normal():
    """A ray of the shifted disc against the ring's circle: not the shortest distance."""
    mesh, contact = pair(4, n=40)
    shift = np.array([0.04, 0.02])
    gf = GridFunction(contact.form.fes)
    gf.components[0].Set(mesh.MaterialCF({"disc": CF(tuple(shift))}, default=CF((0, 0))))
    contact.Update(gf)
    segments = contact.Segments()
    start, end = segments.slave_points.reshape(-1, 2), segments.master_points.reshape(-1, 2)
    normal = start - shift
    b, c = np.sum(start * normal, axis=1), np.sum(start**2, axis=1) - 1.1**2
    distance = -b + np.sqrt(b * b - c)
    assert np.linalg.norm(end - start, axis=1) == pytest.approx(distance, abs=2e-8)
    assert np.linalg.norm(end - start, axis=1).min() < 0.1 - 0.99 * np.linalg.norm(shift)
