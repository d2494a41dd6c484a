"""Bodies far from the origin: positions lose digits there, motions do not."""

import numpy as np
import pytest
from blocks import C
from netgen.occ import Compound, MoveTo, OCCGeometry, Y
from ngsolve import GridFunction, Mesh, VectorH1

from ngslac import LACContact, LACSpace


def state(at, finite):
    """Two blocks, their meshes translated by `at`, in a smooth motion; contact and its residual."""
    lower, upper = (MoveTo(0, y).Rectangle(1, 1).Face() for y in (-1, 0))
    lower.faces.name, upper.faces.name = "lower", "upper"
    lower.edges.Max(Y).name, upper.edges.Min(Y).name = "master", "slave"
    lower.edges.Max(Y).maxh, upper.edges.Min(Y).maxh = 0.3, 0.25
    mesh = Mesh(OCCGeometry(Compound([lower, upper]), dim=2).GenerateMesh(maxh=0.5))
    for vertex in mesh.ngmesh.Points():
        vertex[0] += at
    V = VectorH1(mesh, order=2)
    X = V * LACSpace(V, slave="slave")
    contact = LACContact(*X.TrialFunction(), master="master", finite=finite, friction=0.3)
    contact.Update()
    contact.form.SetConstant(C)
    gf = GridFunction(X)
    gf.vec.FV().NumPy()[:] = 1e-6 * np.random.default_rng(0).normal(size=gf.vec.size)
    residual = gf.vec.CreateVector()
    contact.Evaluate(gf)
    contact.Apply(gf.vec, residual)
    return contact, residual.FV().NumPy()


@pytest.mark.parametrize("finite", [False, True])
def test_gaps_and_residuals_are_those_at_the_origin(finite):
    """A power of two leaves coordinates their digits to 1e-9: gaps of 1e-6 must not feel it."""
    (near, expected), (far, found) = (state(at, finite) for at in (0.0, 2.0**23))
    assert found == pytest.approx(expected, abs=1e-8 * np.abs(expected).max() + 1e-14)
    tables = near.Table(), far.Table()
    assert tables[1]["gap"] == pytest.approx(tables[0]["gap"], abs=1e-13)
    assert tables[1]["x"][:, 0] - 2.0**23 == pytest.approx(tables[0]["x"][:, 0], abs=1e-8)
    points = [contact.Segments().slave_points for contact in (near, far)]
    assert points[1][..., 0] - 2.0**23 == pytest.approx(points[0][..., 0], abs=1e-8)
