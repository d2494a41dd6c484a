"""Units and the place of the bodies do not show in a pairing in 3D."""

import numpy as np
import pytest
from ngsolve import VectorH1
from surfaces3d import Sheet, quad_grid, rigid, sheet_mesh

from ngslac import LACContact, LACSpace


def paired(divisions, scale=1.0, at=0.0, finite=False):
    """Segments and areas of a square of 6 x 6 faces on another; positions are rounded twice."""
    (slave, faces), (master, others) = (quad_grid(n, n) for n in (6, divisions))
    slave, master = (np.pad(points[:, :2], ((0, 0), (0, 1))) for points in (slave, master))
    last_digit = at * np.finfo(float).eps / 2
    slave += last_digit * np.random.default_rng(0).choice([-1, 0, 1], slave.shape)
    mesh = sheet_mesh(
        Sheet("upper", slave, faces, (0, 0, 0.3), "slave"),
        Sheet("lower", master, others, (0, 0, -0.3), "master"),
        motion=rigid(5, scale, scale * at * np.array((1, -0.7, 0.3))),
    )
    V = VectorH1(mesh, order=2)
    X = V * LACSpace(V, slave="slave")
    contact = LACContact(*X.TrialFunction(), master="master", finite=finite)
    contact.Update()
    return len(contact.Segments().area), contact.Table()["area"] / scale**2


@pytest.mark.parametrize("finite", [False, True])
@pytest.mark.parametrize("divisions", [6, 12, 7])  # matching, nested, neither
def test_pairing_is_that_of_the_unit_square(divisions, finite):
    segments, areas = paired(divisions, finite=finite)
    assert areas.sum() == pytest.approx(1, abs=1e-13)
    for scale, at in ((1e-6, 0), (1e6, 0), (1, 1e2), (1, 1e4), (1e-6, 1e4), (1e6, 1e4)):
        found, others = paired(divisions, scale, at, finite)
        assert found == segments
        assert others == pytest.approx(areas, abs=1e-13 + 1e-15 * at)
