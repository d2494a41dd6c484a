"""Recovered pressures of solved problems against closed forms."""

import sys
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from carrying import at_points, keeps_resultants, never_pulls
from netgen.occ import Circle, Compound, OCCGeometry
from ngsolve import (
    InnerProduct,
    Mesh,
    VectorH1,
    dx,
)
from posed import elastic, posed

sys.path.insert(0, str(Path(__file__).parents[2] / "tutorials" / "examples"))

import hertz3d


@cache
def sphere(h, order):
    return hertz3d.Run("sphere", h=h, order=order)["solution"][1]


def error(contact, function):
    """Relative error in L2 at the points where contact acts."""
    place, weight, found = at_points(contact, function)
    exact = hertz3d.Hertz("sphere").Pressure(np.linalg.norm(place[:, :2], axis=1))
    return np.sqrt(weight @ (found.ravel() - exact) ** 2 / (weight @ exact**2))


@pytest.mark.parametrize(
    ("order", "h", "bound"), [(2, 0.4, 0.03), pytest.param(1, 0.2, 0.05, marks=pytest.mark.full)]
)
def test_sphere(order, h, bound):
    """Hertz' pressure, with 6 and 12 faces along the contact radius."""
    contact = sphere(h, order)
    assert error(contact, contact.Recovered().pressure) < bound
    never_pulls(contact)
    keeps_resultants(contact)


def test_sphere_finer():
    errors = [error(sphere(h, 2), sphere(h, 2).Recovered().pressure) for h in (0.4, 0.25)]
    assert errors[1] < 0.85 * errors[0]
    raw = error(sphere(0.4, 2), sphere(0.4, 2).pressure)
    assert raw > 5 * errors[0]


# --- curved macro-elements -----------------------------------------------------------------------

INNER, MIDDLE, OUTER, EXCESS, YOUNG = 10.0, 20.0, 30.0, 0.002, 210e3


def rings(n, finite):
    """An outer ring that is too tight for an inner one; n faces around the contact."""

    def ring(a, b, contact):
        face = Circle((0, 0), b).Face() - Circle((0, 0), a).Face()
        for edge in face.edges:
            near = np.hypot(edge.start.x, edge.start.y) - MIDDLE
            edge.name, edge.maxh = (contact if abs(near) < 1 else "free"), 2 * np.pi * MIDDLE / n
        return face

    parts = ring(INNER, MIDDLE, "slave"), ring(MIDDLE - EXCESS, OUTER, "master")
    parts[1].edges.maxh = 2.5
    geometry = OCCGeometry(Compound(list(parts)), dim=2)
    mesh = Mesh(geometry.GenerateMesh(maxh=2 * np.pi * MIDDLE / n)).Curve(3)
    V = VectorH1(mesh, order=3)
    problem = posed(
        V, elastic(YOUNG), lambda u, v, load: 1e-9 * YOUNG * InnerProduct(u, v) * dx, finite=finite
    )  # nothing else holds the rings
    problem.solver().Solve(printing=False)
    return problem.contact


@pytest.mark.parametrize("finite", [False, True])
def test_press_fit_of_coarse_faces(finite):
    """Closed form of two rings in plane stress; nu = 0, so that plane strain is the same."""
    b2 = MIDDLE**2
    exact = YOUNG * EXCESS * (b2 - INNER**2) * (OUTER**2 - b2)
    exact /= 2 * MIDDLE**3 * (OUTER**2 - INNER**2)
    contact = rings(16, finite)
    found = at_points(contact, contact.Recovered().pressure)[2]
    np.testing.assert_allclose(found, exact, rtol=6e-4)
    assert found.mean() / exact - 1 == pytest.approx(0, abs=3e-4)
    keeps_resultants(contact)
    if not finite:  # the multipliers have their directions constant, and are larger
        assert contact.Table()["pressure"].mean() / exact - 1 > 6e-4
