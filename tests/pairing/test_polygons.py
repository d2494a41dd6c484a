"""Plane polygons, by which faces are cut: against shapely, and rational numbers as the umpire.

Where edges nearly coincide shapely (GEOS) can lose the whole intersection, so that what it says
there is checked by exact arithmetic.
"""

import numpy as np
import pytest
import shapely
from polygons import (
    FAMILIES,
    area,
    convex,
    diameter,
    distances,
    exact_intersection,
    pairs,
    turns,
    unit,
)
from scipy.spatial import Delaunay

from ngslac._ngslac import PolygonDifference, PolygonIntersection, PolygonOverlap

families = pytest.mark.parametrize("family", FAMILIES, ids=lambda f: f.__name__)


def intersection(p, q):
    """As the pairing does it: q is cut by the sides of p."""
    return np.array(PolygonIntersection(q, p, 1e-14 * diameter(p))).reshape(-1, 2)


@families
def test_areas_of_a_thousand_pairs(family):
    cases = list(pairs(family, 1000))
    mine = np.array([area(intersection(p, q)) for p, q in cases])
    units = np.array([unit(p, q) for p, q in cases])
    p, q = ([shapely.Polygon(case[k]) for case in cases] for k in (0, 1))
    theirs = shapely.area(shapely.intersection(p, q))
    for k in np.flatnonzero(np.abs(mine - theirs) > 1e-13 * units):
        theirs[k] = exact_intersection(*cases[k])
    assert np.max(np.abs(mine - theirs) / units) < 1e-13
    turned = np.array([area(intersection(q, p)) for p, q in cases])
    assert np.max(np.abs(mine - turned) / units) < 1e-13


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
def test_intersection_and_difference_make_up_the_whole(family):
    for p, q in pairs(family, 100):
        parts = PolygonDifference(p, q, 1e-14 * diameter(p))
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


@pytest.mark.parametrize("seed", range(8))
def test_tiles_partition_a_polygon(seed):
    rng = np.random.default_rng(seed)
    ring = 4 * np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]])
    points = np.concatenate([rng.uniform(-1.5, 1.5, (40, 2)), ring])
    tiles = [points[t] for t in Delaunay(points).simplices]
    scale, shift = 10.0 ** rng.integers(-6, 7), rng.normal(size=2)
    for _ in range(10):
        p = convex(rng)
        p = (p - p.mean(axis=0)) / (1.01 * np.abs(p - p.mean(axis=0)).max())
        if rng.random() < 0.5:  # on the corners of tiles
            p = rng.permutation(points[:-4])[:3]
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


def test_identical_polygons_keep_their_corners():
    rng = np.random.default_rng(1)
    for _ in range(100):
        p = convex(rng)
        assert np.array_equal(intersection(p, p), p)
        assert PolygonDifference(p, p, 1e-14 * diameter(p)) == []


SQUARE = np.array([(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)])


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
    assert area(PolygonIntersection(bad, SQUARE, 1e-14)) == pytest.approx(0, abs=1e-15)
    assert PolygonDifference(bad, SQUARE, 1e-14) == []


def test_repeated_corners_and_corners_on_sides_change_nothing():
    decorated = np.insert(np.repeat(SQUARE, 2, axis=0), 4, [1, 0.4], axis=0)
    rng = np.random.default_rng(3)
    for _ in range(50):
        p = convex(rng, 4)
        expected = area(intersection(SQUARE, p))
        assert area(intersection(decorated, p)) == pytest.approx(expected, abs=1e-15)
        assert area(intersection(p, decorated)) == pytest.approx(expected, abs=1e-14)


def test_too_many_corners_are_an_error():
    angle = np.linspace(0, 2 * np.pi, 70, endpoint=False)
    p = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    with pytest.raises(Exception, match="too many corners"):
        intersection(p, p)
