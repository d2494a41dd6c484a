"""Finite sliding: what two mirrored bodies do while they approach each other is no slip."""

from itertools import pairwise

import numpy as np
import pytest
from blocks import contact_form
from finiteform import FiniteForm
from netgen.occ import ArcOfCircle, Box, Compound, Face, OCCGeometry, Pnt, Segment, Sphere, Wire
from ngsolve import Mesh

RADIUS = 2.0


def segments(h=0.1):
    """Two cylinder segments, mirror images of each other with different meshes, apart by 0.02."""

    def segment(up):
        def at(s):
            return Pnt(s, up * (0.01 + RADIUS - np.sqrt(RADIUS**2 - s**2)), 0)

        corners = [at(1), Pnt(1, up, 0), Pnt(0, up, 0), at(0)]
        lines = [Segment(p, q) for p, q in pairwise(corners)]
        face = Face(Wire([ArcOfCircle(at(0), at(0.5), at(1)), *lines]))
        face.faces.name = "upper" if up > 0 else "lower"
        face.edges.name = "side"
        for edge in face.edges:
            if abs(edge.center.y) < 0.5 and 0.1 < edge.center.x < 0.9:
                edge.name, edge.maxh = ("slave", h) if up > 0 else ("master", 1.37 * h)
        return face

    shape = Compound([segment(1), segment(-1)])
    return Mesh(OCCGeometry(shape, dim=2).GenerateMesh(maxh=0.5)).Curve(2)


def balls():
    """Two half balls one above the other, with different meshes, apart by 0.02."""
    parts = []
    for up, name, h in ((1, "upper", 0.35), (-1, "lower", 0.45)):
        height = up * (RADIUS + 0.01)
        cut = Box(Pnt(-0.8, -0.8, min(0, up)), Pnt(0.8, 0.8, max(0, up)))
        part = Sphere(Pnt(0, 0, height), RADIUS) * cut
        part.solids.name, part.faces.name = name, "side"
        face = min(part.faces, key=lambda f: abs(f.center.z))
        face.name, face.maxh = ("slave" if up > 0 else "master"), h
        parts.append(part)
    return Mesh(OCCGeometry(Compound(parts)).GenerateMesh(maxh=0.8)).Curve(2)


class Pair(FiniteForm):
    """Each body moves by half of the way."""

    def __init__(self, mesh):
        super().__init__(contact_form(mesh, finite=True, friction=0.3))

    def approach(self, way, degrees=0.0):
        self.lead(way, degrees, shares=(0.5, -0.5))
        table = self.table()
        whole = table["area"] > 0.99 * table["fullarea"]
        return table["slip"][whole], table["gap"][whole]


@pytest.mark.parametrize(("make", "degrees"), [(segments, 0.0), (segments, 70.0), (balls, 70.0)])
def test_mirror_images_do_not_slip(make, degrees):
    """Whatever the angle between their surfaces and the way: up to a quarter radian here.

    Normals lead across a gap g to a point that is level with another one: g sin(a) / R off.
    """
    pair = Pair(make())
    slip, gap = pair.approach(-0.02 * np.eye(pair.dim)[-1], degrees)
    near = gap < 0.15
    assert near.sum() >= 4
    size = np.linalg.norm(slip[near], axis=1)
    assert size.max() <= 0.15 / (2 * RADIUS) * 0.4 * 0.02  # along the slave's normals: 0.3 * 0.02


def test_nothing_has_slipped_after_a_commit():
    """The bodies move away from each other: what still approaches is given some slip in advance."""
    pair = Pair(segments())
    for way in ((0.02, 0.03), (0.04, 0.06)):
        assert np.abs(pair.approach(way)[0]).max() > 0.015
        pair.contact.Commit(pair.gf)
        size = np.linalg.norm(pair.approach(way)[0], axis=1)
        assert size[:5].max() <= 1e-12
        assert size.max() <= 5e-3  # so far apart that a normal leads beyond the next face


def test_sliding_is_slip():
    """In the middle, where both surfaces are level, all of the way along them."""
    slip, _ = Pair(segments()).approach((0.05, -0.02))
    assert slip[0] == pytest.approx([0.05, 0.0], abs=2e-3)
    assert np.linalg.norm(slip, axis=1).max() <= 0.055


def test_slip_in_advance_does_not_feed_on_itself():
    """It is that of the whole last step: what was given before is no part of it."""
    pair = Pair(segments())
    for k in range(1, 7):
        pair.approach((0.004 * k, -0.003 * k))
        pair.contact.Commit(pair.gf)
        reference = pair.contact.form.Vectors("reference")
        assert np.abs(reference).max() <= 1.2 * 0.004  # never more than a step
