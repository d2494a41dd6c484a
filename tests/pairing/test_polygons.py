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
    diameter,
    exact_intersection,
    inner_radius,
    pairs,
    unit,
)

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
    """No narrower than the largest circle inside.

    A false alarm is harmless (the difference is empty), but only where the polygons touch.
    """
    for p, q in pairs(family, 100):
        tolerance = 1e-9 * min(diameter(p), diameter(q))
        common, far = intersection(p, q), max(np.abs(p).max(), np.abs(q).max())
        found, size = PolygonOverlap(p, q, tolerance), area(common)
        if not found:
            assert size <= 2 * (tolerance + 1e-15 * far) * min(diameter(p), diameter(q))
        elif len(common) < 3 or size <= 1e-10 * tolerance * diameter(common):
            assert shapely.Polygon(p).distance(shapely.Polygon(q)) <= 2 * tolerance
        if len(common) > 2:
            assert found or inner_radius(common) <= tolerance


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


def test_too_many_corners_are_an_error():
    angle = np.linspace(0, 2 * np.pi, 70, endpoint=False)
    p = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    with pytest.raises(Exception, match="too many corners"):
        intersection(p, p)
