"""Pairs of convex polygons of every sort, and their intersection in rational numbers."""

from fractions import Fraction

import numpy as np
import shapely


def area(corners):
    """Signed area, positive counterclockwise; 0 with fewer than three corners."""
    if len(corners) < 3:
        return 0.0
    p = np.asarray(corners, dtype=float)
    p = p - p[0]
    return 0.5 * float(np.sum(p[:-1, 0] * p[1:, 1] - p[:-1, 1] * p[1:, 0]))


def diameter(corners):
    """Length of the diagonal of the bounding box."""
    return float(np.linalg.norm(np.ptp(corners, axis=0)))


def unit(p, q):
    """What errors of an area of intersection are measured by: a strip of the smaller's length."""
    far = max(np.abs(p).max(), np.abs(q).max())
    return min(diameter(p), diameter(q)) * max(diameter(p), diameter(q), far)


def inner_radius(corners):
    """Of the largest circle inside about the mean of the corners."""
    side = np.roll(corners, -1, axis=0) - corners
    length = np.linalg.norm(side, axis=1)
    away, e = np.mean(corners, axis=0) - corners[length > 0], side[length > 0]
    return np.min((e[:, 0] * away[:, 1] - e[:, 1] * away[:, 0]) / length[length > 0])


def exact_intersection(p, q):
    """Area of the intersection in rational numbers (Sutherland and Hodgman 1974)."""
    result = [(Fraction(float(x)), Fraction(float(y))) for x, y in p]
    window = [(Fraction(float(x)), Fraction(float(y))) for x, y in q]
    for a, b in zip(window, window[1:] + window[:1], strict=True):
        d = [(b[0] - a[0]) * (y - a[1]) - (b[1] - a[1]) * (x - a[0]) for x, y in result]
        clipped = []
        for i, corner in enumerate(result):
            if d[i - 1] * d[i] < 0:
                t, before = d[i - 1] / (d[i - 1] - d[i]), result[i - 1]
                clipped.append(tuple(u + t * (v - u) for u, v in zip(before, corner, strict=True)))
            if d[i] >= 0:
                clipped.append(corner)
        result = clipped
    sides = ((result[i - 1], result[i]) for i in range(len(result)))
    return float(sum((a[0] * b[1] - a[1] * b[0] for a, b in sides), Fraction(0)) / 2)


def convex(rng, corners=None):
    """A random convex polygon around a random place: corners on an ellipse."""
    n = corners or int(rng.integers(3, 7))
    angle = np.sort(rng.uniform(0, 2 * np.pi, n))
    stretch = rng.normal(size=(2, 2))
    if np.linalg.det(stretch) < 0:
        stretch[0] *= -1
    circle = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    return circle @ stretch.T + 0.7 * rng.normal(size=2)


def power(rng, least, most):
    """10 to a random power."""
    return 10.0 ** rng.uniform(least, most)


def across(e):
    return np.array([-e[1], e[0]])


def anything(rng):
    return convex(rng), convex(rng)


def sliver(rng):
    """A thin quadrilateral, sometimes a needle, across a polygon."""
    p, e = convex(rng), rng.normal(size=2)
    thin, c = power(rng, -14, -1) * across(e), p.mean(axis=0)
    return p, np.array([c - e, c + e, c + e + thin, c - e + rng.uniform(0, 1) * thin])


def nearly_identical(rng):
    """A polygon and its copy, turned about a corner by a tiny angle, then moved by as little."""
    p, angle = convex(rng), power(rng, -17, -2)
    c, s = np.cos(angle), np.sin(angle)
    move = rng.choice([0, 1]) * power(rng, -17, -2) * rng.normal(size=2)
    return p, (p - p[0]) @ np.array([[c, s], [-s, c]]) + p[0] + move


def common_edge(rng):
    """A triangle on a part, the whole or an extension of a side, inside or outside."""
    p = convex(rng)
    e = p[1] - p[0]
    start, end = rng.choice([0, 0, -0.3, 0.3]), rng.choice([1, 1, 0.8, 1.2])
    tip = p[0] + rng.uniform(0, 1) * e + rng.choice([-1, 1]) * power(rng, -6, 0) * across(e)
    q = np.array([p[0] + start * e, p[0] + end * e, tip])
    return p, q if area(q) > 0 else q[::-1]


def corner_on_edge(rng):
    """A polygon of any size with a corner at a corner or on a side of the other."""
    p, q = convex(rng), power(rng, -6, 0) * convex(rng)
    return p, q - q[0] + p[0] + rng.choice([0, rng.uniform()]) * (p[1] - p[0])


def similar(rng):
    """Contained in each other, or identical up to rounding; numbered from another corner."""
    p = convex(rng)
    factor = rng.choice([0.5, 2.0, 1.0, 1 + 2**-52, 1 - 1e-12, 1e-6])
    return p, np.roll(p.mean(axis=0) + factor * (p - p.mean(axis=0)), 1, axis=0)


def apart(rng):
    """A polygon and its mirror image behind a side: they share a side or nothing."""
    p = convex(rng)
    normal = across((p[1] - p[0]) / np.linalg.norm(p[1] - p[0]))
    shift = rng.choice([0, 0, power(rng, -16, 0)])
    return p, (p - 2 * np.outer((p - p[0]) @ normal, normal) - shift * normal)[::-1]


def grid_points(rng):
    """Corners on a small grid: every coincidence there is."""
    found = []
    while len(found) < 2:
        hull = shapely.convex_hull(shapely.MultiPoint(rng.integers(-3, 4, (6, 2))))
        if hull.area > 0:
            found.append(np.array(shapely.orient_polygons(hull).exterior.coords)[:-1])
    return found


FAMILIES = [anything, sliver, nearly_identical, common_edge, corner_on_edge]
FAMILIES += [similar, apart, grid_points]


def pairs(family, count):
    """Pairs of a family in units from 1e-6 to 1e6, every other one far from the origin."""
    rng = np.random.default_rng(FAMILIES.index(family))
    for k in range(count):
        p, q = family(rng)
        scale, shift = 10.0 ** rng.integers(-6, 7), (k % 2) * 10 * rng.normal(size=2)
        yield scale * (p + shift), scale * (q + shift)
