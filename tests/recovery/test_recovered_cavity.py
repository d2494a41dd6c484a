"""A sphere in a spherical cavity that is too small: its exact pressure is constant.

Curved meshes of order 2 leave the sphere by more than the interference: what they overlap by must
not count. Closed form: Timoshenko and Goodier, Theory of Elasticity (1970), article 136, nu = 0.
"""

import numpy as np
import pytest
from carrying import at_points, keeps_resultants
from netgen.occ import Box, Compound, OCCGeometry, Pnt, Sphere
from ngsolve import Mesh, VectorH1
from posed import elastic, posed

INNER, MIDDLE, OUTER, EXCESS, YOUNG = 10.0, 20.0, 30.0, 0.002, 1000.0
A3, B3, C3 = INNER**3, MIDDLE**3, OUTER**3
PRESSURE = YOUNG * EXCESS / MIDDLE / ((B3 + C3 / 2) / (C3 - B3) + (B3 + A3 / 2) / (B3 - A3))


def shell(inner, outer, contact, h):
    """An eighth of it; the face about the middle radius gets the name."""
    solid = Sphere(Pnt(0, 0, 0), outer) - Sphere(Pnt(0, 0, 0), inner)
    solid *= Box(Pnt(0, 0, 0), Pnt(50, 50, 50))
    for face in solid.faces:
        flat = [axis for axis in "xyz" if abs(getattr(face.center, axis)) < 1e-6]
        near = abs(face.bounding_box[1].x - MIDDLE) < 1
        face.name = "sym_" + flat[0] if flat else contact if near else "free"
        face.maxh = h if face.name == contact else 6.0
    return solid


def pressed(finite):
    parts = shell(INNER, MIDDLE, "slave", 5.0), shell(MIDDLE - EXCESS, OUTER, "master", 6.0)
    mesh = Mesh(OCCGeometry(Compound(list(parts))).GenerateMesh(maxh=6.0)).Curve(2)
    V = VectorH1(mesh, order=2, dirichletx="sym_x", dirichlety="sym_y", dirichletz="sym_z")
    problem = posed(V, elastic(YOUNG), adjust=0.05, offset=-EXCESS, finite=finite)
    problem.solver().Solve(printing=False)
    return problem.contact


# With small sliding each macro-element acts in one direction, on faces that bend by 25 degrees.
@pytest.mark.parametrize(("finite", "single", "smooth"), [(True, 0.02, 0.01), (False, 0.06, 0.03)])
def test_coarse_sphere_in_a_cavity(finite, single, smooth):
    contact = pressed(finite)
    found = at_points(contact, contact.Recovered().pressure)[2]
    np.testing.assert_allclose(contact.Table()["pressure"], PRESSURE, rtol=single)
    np.testing.assert_allclose(found, PRESSURE, rtol=smooth)
    keeps_resultants(contact)
