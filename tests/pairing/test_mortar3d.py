"""The operators D and M in 3D: integrals of basis functions of both sides over macro-elements."""

from itertools import pairwise

import numpy as np
import pytest
import shapely
from ngsolve import CF, GridFunction, VectorH1, x, y, z
from surfaces3d import Sheet, faces_of, in_plane, rigid, sheet_mesh, surface

from ngslac import BubbleVectorH1, LACContact, LACSpace

WIDER = ((-0.3, -0.2), (1.2, 1.3))
SHIFTED = ((-0.2, -0.1), (0.8, 1.1))


def contact_of(V, **flags):
    u, lam = (V * LACSpace(V, slave="slave")).TrialFunction()
    contact = LACContact(u, lam, master="master", **flags)
    contact.Update()
    return contact


def two_sheets(kinds, seed=1, box=WIDER, gap=0.0, motion=None, n=(3, 3)):
    rng = np.random.default_rng(seed)
    slave, master = surface(rng, kinds[0], n[0]), surface(rng, kinds[1], n[1], box)
    return sheet_mesh(
        Sheet("upper", in_plane(slave[0]), slave[1], (0, 0, 0.5), "slave", renumbered=rng),
        Sheet("lower", in_plane(master[0], -gap), master[1], (0, 0, -0.5), "master",
              renumbered=rng),
        motion=motion or rigid(),
    )  # fmt: skip


def product(operator, gf):
    """Rows of an operator times a displacement, (n, 3)."""
    return (operator * gf.vec).Evaluate().FV().NumPy().reshape(-1, 3).copy()


def monomials(order, frame=None):
    """All products of powers of x and y of total degree `order` in a rotated frame."""
    frame = np.eye(3) if frame is None else frame
    a, b = (sum(float(c) * v for c, v in zip(row, (x, y, z), strict=True)) for row in frame[:2])
    return [a**i * b ** (order - i) for i in range(order + 1)]


KINDS = [("trig", "quad"), ("quad", "mixed"), ("mixed", "trig")]


@pytest.mark.parametrize("kinds", KINDS, ids="-".join)
@pytest.mark.parametrize("order", [1, 2, 3])
def test_polynomials_do_not_jump(kinds, order):
    """A polynomial of the order of the space is the same on both sides: D u = M u, mean by mean."""
    motion = rigid(3)
    mesh = two_sheets(kinds, motion=motion)
    V = BubbleVectorH1(mesh, order=order, slave="slave")
    contact = contact_of(V)
    D, M = contact.Mortar()
    gf = GridFunction(V)
    frame = motion(np.eye(3))
    for k, p in enumerate(monomials(order, frame)):
        gf.Set(CF((p, (k + 1) * p, 1 - p)))
        jump = product(D, gf) - product(M, gf)
        assert jump == pytest.approx(0, abs=2e-13 * (k + 2))


@pytest.mark.parametrize("order", [1, 2, 3, 4])
@pytest.mark.parametrize("kinds", [("trig", "trig"), ("trig", "quad"), ("quad", "trig")])
def test_exact_for_polynomials(kinds, order):
    """Different polynomials on both sides against integrals over the exact overlaps."""
    mesh = two_sheets(kinds, box=SHIFTED, gap=0.01, n=(2, 2))
    V = BubbleVectorH1(mesh, order=order, slave="slave")
    contact = contact_of(V)
    fields = {"upper": monomials(order)[0] + x, "lower": monomials(order)[-1] - 2 * y}
    gf = GridFunction(V)
    gf.Set(mesh.MaterialCF({name: CF((f, 0, 1)) for name, f in fields.items()}))
    overlap = shapely.box(*SHIFTED[0], *SHIFTED[1])
    macros = np.array(contact.space.macros)
    numbers, corners = faces_of(mesh, "slave")
    exact = np.zeros((contact.space.nmacros, 2))
    for number, face in zip(numbers, corners, strict=True):
        common = shapely.Polygon(face[:, :2]).intersection(overlap)
        exact[macros[number], 0] += integral(common, lambda p: upper(p, order))
        exact[macros[number], 1] += integral(common, lambda p: lower(p, order))
    D, M = contact.Mortar()
    assert product(D, gf)[:, 0] == pytest.approx(exact[:, 0], abs=1e-13)
    assert product(M, gf)[:, 0] == pytest.approx(exact[:, 1], abs=1e-13)
    area = contact.Table()["area"]
    for operator in (D, M):
        assert product(operator, gf)[:, 1] == pytest.approx(0, abs=1e-13)
        assert product(operator, gf)[:, 2] == pytest.approx(area, abs=1e-13)


def upper(points, order):
    return points[:, 1] ** order + points[:, 0]


def lower(points, order):
    return points[:, 0] ** order - 2 * points[:, 1]


def integral(polygon, function):
    """Of a polynomial of degree up to 7 over a convex polygon, by a fan of triangles."""
    if polygon.is_empty or polygon.area == 0:
        return 0.0
    corners = np.array(polygon.exterior.coords)[:-1]
    s, w = np.polynomial.legendre.leggauss(5)
    s, w = (s + 1) / 2, w / 2
    total = 0.0
    for b, c in pairwise(corners[1:]):
        e, f = b - corners[0], c - b
        twice = abs(e[0] * f[1] - e[1] * f[0])
        for r, weight in zip(s, w, strict=True):  # collapsed square
            points = corners[0] + r * (e + np.outer(s, f))
            total += weight * r * twice * float(w @ function(points))
    return total


@pytest.mark.parametrize("space", ["bubble", "plain"])
def test_partition_of_unity(space):
    """Constants: D c = M c = paired areas times c, row by row; no other column is used."""
    mesh = two_sheets(("mixed", "mixed"), box=SHIFTED, motion=rigid(2))
    V = (
        BubbleVectorH1(mesh, order=1, slave="slave")
        if space == "bubble"
        else VectorH1(mesh, order=3)
    )
    contact = contact_of(V)
    gf = GridFunction(V)
    gf.Set(CF((2.0, -3.0, 0.5)))
    expected = np.outer(contact.Table()["area"], [2.0, -3.0, 0.5])
    for operator, face in zip(contact.Mortar(), ("slave", "master"), strict=True):
        assert operator.shape == (3 * contact.space.nmacros, V.ndof)
        assert product(operator, gf) == pytest.approx(expected, abs=1e-13)
        used = np.any(operator.ToDense().NumPy() != 0, axis=0)
        allowed = np.array([bool(b) for b in V.GetDofs(mesh.Boundaries(face))])
        assert np.any(used)
        assert not np.any(used & ~allowed)


def test_overhanging_faces_have_empty_rows():
    mesh = two_sheets(("mixed", "quad"), box=((0.3, 0.3), (0.6, 0.5)))
    contact = contact_of(BubbleVectorH1(mesh, order=1, slave="slave"))
    area = np.repeat(contact.Table()["area"], 3)
    assert np.any(area == 0)
    assert np.any(area > 0)
    for operator in contact.Mortar():
        rows = np.abs(operator.ToDense().NumPy()).sum(axis=1)
        assert not np.any(rows[area == 0])
        assert np.all(rows[area > 0] > 0)


def test_rotation_and_scaling():
    """D and M act componentwise: the same numbers in every frame and unit."""

    def entries(motion):
        mesh = two_sheets(("trig", "mixed"), box=SHIFTED, gap=0.01, motion=motion)
        contact = contact_of(BubbleVectorH1(mesh, order=2, slave="slave"))
        return [op.ToDense().NumPy().copy() for op in contact.Mortar()]

    reference = entries(rigid())
    there = entries(rigid(6, 1e3, (5.0, 0, 0)))
    for a, b in zip(reference, there, strict=True):
        assert b / 1e6 == pytest.approx(a, abs=1e-13)
