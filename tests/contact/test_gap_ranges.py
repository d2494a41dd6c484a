"""Between what limits the gap varies over the points of macro-elements."""

import numpy as np
import pytest
from blocks import block_mesh, contact_form, moved
from ngsolve import CF, x, y

from ngslac import tools
from ngslac.contact.certificate import PointGaps
from ngslac.recovery.surface import SlaveSurface


def flat(dim):
    return block_mesh(dim, **({"angle": 0.0} if dim == 2 else {"shape": "flat", "rotation": None}))


def height(dim):
    """Of the upper block in the plane of contact, after it has been moved and inclined."""
    return 0.01 + 0.03 * x - 0.02 * (y if dim == 3 else 0)


def inclined(contact):
    return moved(contact, (0,) * (contact.mesh.dim - 1) + (height(contact.mesh.dim),))


def at(mesh, places):
    """The values of a linear function at places on the slave."""
    slope = [0.03, -0.02][: mesh.dim - 1]
    return 0.01 + places[:, : mesh.dim - 1] @ np.array(slope)


@pytest.mark.parametrize("dim", [2, 3])
@pytest.mark.parametrize("finite", [False, True])
def test_linear_gaps_are_exact(dim, finite):
    contact = contact_form(flat(dim), finite=finite)
    gf = inclined(contact)
    contact.Follow(gf)
    contact.Evaluate(gf)
    table = contact.Table()
    gaps = PointGaps(contact, gf.vec.FV().NumPy())
    least, greatest, places = gaps.least, gaps.greatest, gaps.places
    paired = table["area"] > 0
    start = contact_form(flat(dim)).Table()["gap"][paired].min()  # the blocks may be apart
    rel = 2e-3 if finite else 1e-10  # along normals that are inclined
    assert least[paired] - start == pytest.approx(at(contact.mesh, places[paired]), rel=rel)
    assert np.all(least[paired] <= table["gap"][paired] + 1e-12)
    assert np.all(greatest[paired] >= table["gap"][paired] - 1e-12)
    assert np.all(np.isinf(least[~paired]))


@pytest.mark.parametrize("space", ["order 1", "order 3", "H1(dim)", "bubble"])
@pytest.mark.parametrize("dim", [2, 3])
def test_all_points_are_within(dim, space):
    """At quadrature points gaps are those of the two surfaces, and means are those of the table."""
    contact = contact_form(block_mesh(dim), space, offset=0.02 * x + 0.1)
    random = np.random.default_rng(1)
    gf = moved(contact)
    gf.vec.FV().NumPy()[:] = 0.01 * random.normal(size=contact.nscalars)
    contact.Evaluate(gf)
    surface, table = SlaveSurface(contact), contact.Table()
    normal = table["normal"][surface.macro]
    gaps = surface.gap * np.einsum("qk,qk->q", surface.normal, normal)
    gaps -= np.einsum("qk,qk->q", surface.Jump(gf.components[-2]), normal)
    gaps += contact.form.Table()["offset"][surface.macro]
    paired = table["area"] > 0
    sums = np.bincount(surface.macro, surface.weight * gaps, surface.nmacros)
    assert (sums / np.where(paired, table["area"], 1))[paired] == pytest.approx(
        table["gap"][paired], abs=1e-12
    )
    found = PointGaps(contact, gf.vec.FV().NumPy())
    assert np.all(gaps >= found.least[surface.macro] - 1e-12)
    assert np.all(gaps <= found.greatest[surface.macro] + 1e-12)
    assert np.all(found.slope[paired] > 0)


def test_counted_from_the_configuration_of_the_pairing():
    contact = contact_form(flat(2))
    before = PointGaps(contact, np.zeros(contact.nscalars)).least
    contact.Update(moved(contact, (0, 0.05)))
    gf = moved(contact, (0, 0.08))
    found = PointGaps(contact, gf.vec.FV().NumPy()).least
    paired = np.isfinite(before)
    assert found[paired] == pytest.approx(before[paired] + 0.08, abs=1e-12)


@pytest.mark.parametrize("tool", ["obstacle", "plane"])
def test_of_obstacles(tool):
    mesh = flat(2)
    if tool == "obstacle":
        contact = contact_form(mesh, obstacle=CF(0.1))
        expected = 0.1
    else:
        contact = contact_form(mesh, obstacle=tools.Plane((0, -0.1), (0, 1)), finite=True)
        expected = 0.1 + contact.Table()["x"][:, 1].min()
    gf = moved(contact, (0, height(2)))
    contact.Follow(gf)
    contact.Evaluate(gf)
    gaps = PointGaps(contact, gf.vec.FV().NumPy())
    assert gaps.least - expected == pytest.approx(at(mesh, gaps.places), rel=1e-9)
