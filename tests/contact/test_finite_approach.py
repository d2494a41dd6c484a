"""Finite sliding: what two mirrored bodies do while they approach each other is no slip."""

import numpy as np
import pytest
from blocks import contact_form
from curved import bend
from form import Form
from ngsolve import CF, sqrt, x, y
from sheets import grid, lower, sheet_mesh, upper

RADIUS = 2.0


class Pair(Form):
    """Two round bodies, mirror images with different meshes, apart by 0.02, led to each other.

    They touch at the corner of parts of a cylinder (kind "edge"), in the middle of spheres.
    """

    def __init__(self, kind="edge"):
        box = ((0, 0), (1, 1)) if kind == "edge" else ((-0.8, -0.8), (0.8, 0.8))
        n = (10, 7) if kind == "edge" else (5, 4)
        slave, master = upper(grid(kind, n[0], box), 0.01), lower(grid(kind, n[1], box), -0.01)
        mesh = sheet_mesh(slave, master)
        off = x * x if kind == "edge" else x * x + y * y
        up = mesh.BoundaryCF({"slave": 1, "master": -1}, default=0)
        lift = up * (RADIUS - sqrt(RADIUS**2 - off))
        bend(mesh, 2, CF((0, 0, lift)[3 - mesh.dim :]), "slave|master")
        super().__init__(contact_form(mesh, finite=True, friction=0.3))

    def approach(self, way, degrees=0.0):
        """Each body moves by half of the way; slip and gap where all of it is paired."""
        self.lead(way, degrees, shares=(0.5, -0.5))
        table = self.table()
        whole = table["area"] > 0.99 * table["fullarea"]
        return table["slip"][whole], table["gap"][whole]


@pytest.mark.parametrize(("kind", "degrees"), [("edge", 0.0), ("edge", 70.0), ("trig", 70.0)])
def test_mirror_images_do_not_slip(kind, degrees):
    """Whatever the angle between their surfaces and the way: up to a quarter radian here.

    Normals lead across a gap g to a point that is level with another one: g sin(a) / R off.
    """
    pair = Pair(kind)
    slip, gap = pair.approach(-0.02 * np.eye(pair.dim)[-1], degrees)
    near = gap < 0.15
    assert near.sum() >= 4
    size = np.linalg.norm(slip[near], axis=1)
    assert size.max() <= 0.15 / (2 * RADIUS) * 0.4 * 0.02  # along the slave's normals: 0.3 * 0.02


def test_nothing_has_slipped_after_a_commit():
    """The bodies move away from each other: what still approaches is given some slip in advance."""
    pair = Pair()
    for way in ((0.02, 0.03), (0.04, 0.06)):
        assert np.abs(pair.approach(way)[0]).max() > 0.015
        pair.contact.Commit(pair.gf)
        size = np.linalg.norm(pair.approach(way)[0], axis=1)
        assert size[:5].max() <= 1e-12
        assert size.max() <= 5e-3  # so far apart that a normal leads beyond the next face


def test_sliding_is_slip():
    """In the middle, where both surfaces are level, all of the way along them."""
    slip, _ = Pair().approach((0.05, -0.02))
    assert slip[0] == pytest.approx([0.05, 0.0], abs=2e-3)
    assert np.linalg.norm(slip, axis=1).max() <= 0.055


def test_slip_in_advance_does_not_feed_on_itself():
    """It is that of the whole last step: what was given before is no part of it."""
    pair = Pair()
    for k in range(1, 7):
        pair.approach((0.004 * k, -0.003 * k))
        pair.contact.Commit(pair.gf)
        reference = pair.contact.form.Table()["reference"].ravel()
        assert np.abs(reference).max() <= 1.2 * 0.004  # never more than a step


@pytest.mark.parametrize("kind", ["edge", "trig"])
def test_slip_counts_from_where_the_path_meets_the_master(kind):
    """A plane slave comes down on a wide master: of the step in which it lands the end counts."""
    wide, box = ((-1, -1), (2, 2)), ((0, 0), (1, 1))
    mesh = sheet_mesh(upper(grid(kind, 4, box)), lower(grid(kind, 7, wide)))
    form, along, up = (
        Form(contact_form(mesh, finite=True, friction=0.3)),
        *np.eye(mesh.dim)[[0, -1]],
    )
    for part in (0.4, 0.7):  # of the way down
        form.lead(0.2 * part * along + 0.1 * (1 - part) * up)
        form.contact.Commit(form.gf)
    for beyond in (0.0, 0.05):
        form.lead((0.2 + beyond) * along)
        slip = form.table()["slip"]
        assert slip == pytest.approx(np.tile(beyond * along, (len(slip), 1)), abs=1e-12)
