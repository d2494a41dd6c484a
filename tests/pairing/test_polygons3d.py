"""Plane polygons, by which faces are cut: against shapely, and rational numbers as the umpire.

Where edges nearly coincide shapely (GEOS) can lose the whole intersection, so that what it says
there is checked by exact arithmetic.
"""

import numpy as np
import pytest
import shapely
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from polygons3d import (
    FAMILIES,
    area,
    convex,
    diameter,
    distances,
    exact_intersection,
    hull,
    pairs,
    turns,
    unit,
)
from scipy.spatial import Delaunay, Voronoi

from ngslac._ngslac import PolygonDifference, PolygonIntersection, PolygonOverlap

fast = settings(derandomize=True, deadline=None, max_examples=120, database=None)
families = pytest.mark.parametrize("family", FAMILIES, ids=lambda f: f.__name__)
COUNT = 1000  # pairs of each family


def intersection(p, q):
    """As the pairing does it: q is cut by the sides of p."""
    return np.array(PolygonIntersection(q, p, 1e-14 * diameter(p))).reshape(-1, 2)


@families
def test_areas_of_ten_thousand_pairs(family):
    cases = list(pairs(family, COUNT))
    mine = np.array([area(intersection(p, q)) for p, q in cases])
    units = np.array([unit(p, q) for p, q in cases])
    p, q = ([shapely.Polygon(case[k]) for case in cases] for k in (0, 1))
    theirs = shapely.area(shapely.intersection(p, q))
    for k in np.flatnonzero(np.abs(mine - theirs) > 1e-13 * units):
        theirs[k] = exact_intersection(*cases[k])
    assert np.max(np.abs(mine - theirs) / units) < 1e-13


@families
def test_against_rational_numbers(family):
    for p, q in pairs(family, 40):
        assert area(intersection(p, q)) == pytest.approx(
            exact_intersection(p, q), abs=1e-13 * unit(p, q)
        )


@families
def test_intersections_are_convex_and_inside_of_both(family):
    for p, q in pairs(family, 100):
        common = intersection(p, q)
        tolerance = 1e-13 * max(diameter(p), diameter(q), np.abs(p).max())
        assert len(common) <= len(p) + len(q)
        assert turns(common).min(initial=0) >= -1e-14 * unit(p, q)
        for point in common:
            assert distances(point, p).min() > -tolerance
            assert distances(point, q).min() > -tolerance


@families
def test_both_orders_give_the_same_area(family):
    for p, q in pairs(family, 100):
        assert area(intersection(p, q)) == pytest.approx(
            area(intersection(q, p)), abs=1e-13 * unit(p, q)
        )


@families
def test_intersection_and_difference_make_up_the_whole(family):
    for p, q in pairs(family, 100):
        tolerance = 1e-14 * diameter(p)
        parts = PolygonDifference(p, q, tolerance)
        areas = [area(part) for part in parts]
        assert min(areas, default=1) > 0
        total = sum(areas) + area(intersection(p, q))
        assert total == pytest.approx(area(p), abs=2e-13 * unit(p, p))
        for i, part in enumerate(parts):
            assert area(intersection(q, part)) <= 1e-13 * unit(p, q)
            for other in parts[:i]:
                assert area(intersection(part, other)) <= 1e-13 * unit(p, p)


@families
def test_overlap_is_an_intersection_of_some_width(family):
    for p, q in pairs(family, 100):
        tolerance = 1e-9 * min(diameter(p), diameter(q))
        common, far = intersection(p, q), max(np.abs(p).max(), np.abs(q).max())
        if not PolygonOverlap(p, q, tolerance):
            width = tolerance + 1e-15 * far
            assert area(common) <= 2 * width * min(diameter(p), diameter(q))
        # No narrower than the largest circle inside.
        elif len(common) < 3 or area(common) <= 1e-10 * tolerance * diameter(common):
            # A false alarm is harmless (the difference is empty), but only where they touch.
            assert shapely.Polygon(p).distance(shapely.Polygon(q)) <= 2 * tolerance
        if len(common) > 2:
            radius = distances(common.mean(axis=0), common).min()
            assert PolygonOverlap(p, q, tolerance) or radius <= tolerance


# ---------------------------------------------------------------- many polygons at once


def tilings(rng, kind, n):
    """Convex cells that tile at least the square from -1 to 1."""
    points = rng.uniform(-1.5, 1.5, (n, 2))
    if kind == "delaunay":
        ring = 4 * np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]])
        points = np.concatenate([points, ring])
        return [points[t] for t in Delaunay(points).simplices]
    mirrored = [points]  # cells of points mirrored at the sides of a square end there
    for axis in (0, 1):
        for side in (-2, 2):
            mirrored.append(points * (1 - 2 * np.eye(2)[axis]) + 2 * side * np.eye(2)[axis])
    voronoi = Voronoi(np.concatenate(mirrored))
    cells = [voronoi.vertices[voronoi.regions[r]] for r in voronoi.point_region[:n]]
    return [c if area(c) > 0 else c[::-1] for c in cells]


@pytest.mark.parametrize("kind", ["delaunay", "voronoi"])
@pytest.mark.parametrize("seed", range(8))
def test_tiles_partition_a_polygon(kind, seed):
    rng = np.random.default_rng(seed)
    tiles = tilings(rng, kind, 40)
    scale, shift = 10.0 ** rng.integers(-6, 7), rng.normal(size=2)
    for _ in range(10):
        p = convex(rng)
        p = (p - p.mean(axis=0)) / (1.01 * np.abs(p - p.mean(axis=0)).max())
        if rng.random() < 0.5:  # on the corners of tiles
            corners = np.concatenate(tiles)
            inside = np.unique(corners[np.abs(corners).max(axis=1) < 1], axis=0)
            p = inside[np.argsort(np.arctan2(*(inside[:3] - inside[:3].mean(axis=0)).T))]
            p = p if area(p) > 0 else p[::-1]
        p = scale * (p + shift)
        parts = [area(intersection(p, scale * (tile + shift))) for tile in tiles]
        assert sum(parts) == pytest.approx(area(p), abs=1e-13 * unit(p, p))


@pytest.mark.parametrize("seed", range(10))
def test_differences_of_differences(seed):
    """As hidden pieces are cut away: from a polygon all that a row of others covers."""
    rng = np.random.default_rng(seed)
    p = convex(rng)
    left, others = [p], [convex(rng) for _ in range(6)]
    for q in others:
        left = [part for piece in left for part in PolygonDifference(piece, q, 1e-9 * diameter(p))]
    exact = shapely.Polygon(p).difference(shapely.union_all([shapely.Polygon(q) for q in others]))
    assert sum(map(area, left)) == pytest.approx(exact.area, abs=1e-8 * unit(p, p))
    for piece in left:
        for q in others:
            assert not PolygonOverlap(piece, q, 2e-9 * diameter(p))


# ---------------------------------------------------------------- coincidences and bad input

corners_on_grid = st.lists(
    st.tuples(st.integers(-3, 3), st.integers(-3, 3)), min_size=3, max_size=8
)


@fast
@given(corners_on_grid, corners_on_grid, st.integers(0, 7), st.sampled_from([1.0, 0.1, 1 / 3]))
def test_corners_on_a_grid(first, second, turn, scale):
    """Corners on corners, on sides, sides on sides; exact up to rounding."""
    p, q = hull(first), hull(second)
    assume(len(p) > 2 and len(q) > 2)
    exact = exact_intersection(p, q)
    q = np.roll(q, turn, axis=0)
    p, q = scale * np.array(p, dtype=float), scale * np.array(q, dtype=float)
    common = intersection(p, q)
    assert area(common) == pytest.approx(scale**2 * exact, abs=1e-13 * scale**2)
    assert PolygonOverlap(p, q, 1e-9 * scale) == (exact > 0)
    rest = sum(map(area, PolygonDifference(p, q, 1e-14 * scale)))
    assert rest == pytest.approx(area(p) - area(common), abs=1e-12 * scale**2)


def test_identical_polygons_keep_their_corners():
    rng = np.random.default_rng(1)
    for _ in range(100):
        p = convex(rng)
        assert np.array_equal(intersection(p, p), p)
        assert PolygonDifference(p, p, 1e-14 * diameter(p)) == []


@pytest.mark.parametrize(
    "bad",
    [
        [],
        [(0.3, 0.3)],
        [(0.1, 0.1), (0.9, 0.5)],
        [(0.5, 0.5)] * 4,
        [(0.1, 0.1), (0.5, 0.5), (0.9, 0.9)],
        [(0.0, 0.0), (1.0, 0.0), (0.5, 0.0)],
    ],
)
def test_polygons_without_area(bad):
    square = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)]
    assert area(PolygonIntersection(bad, square, 1e-14)) == pytest.approx(0, abs=1e-15)
    assert PolygonDifference(bad, square, 1e-14) == []


def test_repeated_corners_and_corners_on_sides_change_nothing():
    square = np.array([(0, 0), (1, 0), (1, 1), (0, 1)], dtype=float)
    decorated = np.insert(np.repeat(square, 2, axis=0), 4, [1, 0.4], axis=0)
    rng = np.random.default_rng(3)
    for _ in range(50):
        p = convex(rng, 4)
        expected = area(intersection(square, p))
        assert area(intersection(decorated, p)) == pytest.approx(expected, abs=1e-15)
        assert area(intersection(p, decorated)) == pytest.approx(expected, abs=1e-14)


def test_too_many_corners_are_an_error():
    angle = np.linspace(0, 2 * np.pi, 70, endpoint=False)
    p = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    with pytest.raises(Exception, match="too many corners"):
        intersection(p, p)
