"""Multipliers against means of Hertz' pressure: no error for these, others are seen."""

import numpy as np
import pytest
from hertzmeans import Means, Shape
from macros3d import Bends, Comparison, Neighbours, Outlines
from ngsolve import BND
from slavefaces import SlaveFaces

from ngslac.meshes import CylinderOnBlock
from ngslac.meshes.cylinders import THICKNESS
from ngslac.reference import HertzLine, HertzPoint

SOLID = dict(young1=210e3, nu1=0.3, young2=70e3, nu2=0.3)


def Grid(line):
    """Macro-elements of the slave side of a mesh, each a single face, with exact pressures."""
    mesh = CylinderOnBlock(0.5, zone=3.3)
    slave = [el.mat == "slave" for el in mesh.Elements(BND)]
    numbers = np.where(slave, np.cumsum(slave) - 1, -1)
    force = {"force": 5.7e3 if line else 24e3}
    hertz = (HertzLine if line else HertzPoint)(radius1=50, **force, **SOLID)
    faces = SlaveFaces(mesh, numbers, line)
    return faces, hertz, Means(faces, hertz)


@pytest.mark.parametrize("line", [True, False])
def test_exact_pressures_have_no_error(line):
    figures = Comparison(*Grid(line))
    for name in ("p0_ratio", "p0_ratio_fit", "contact_radius_ratio"):
        assert figures[name] == pytest.approx(1, abs=1e-5)
    assert max(figures["profile_error"], figures["oscillation"]) < 1e-12
    assert figures["second_difference"] == figures["second_difference_exact"] > 0


def test_errors_are_seen():
    faces, hertz, exact = Grid(True)
    middle = faces.corners.mean(axis=1)
    scaled = Comparison(faces, hertz, 1.03 * exact)
    assert scaled["p0_ratio"] == pytest.approx(1.03, abs=1e-9)
    assert scaled["profile_error"] == pytest.approx(0.03, abs=1e-9)
    wide = Comparison(faces, hertz, hertz.peak * Shape(faces, hertz, 1.1 * hertz.halfwidth))
    assert wide["contact_radius_ratio"] == pytest.approx(1.1, abs=1e-4)
    odd = np.rint(middle[:, 0] / 0.55).astype(int) + (middle[:, 1] > THICKNESS / 2)
    checkered = exact + 0.1 * hertz.peak * (-1.0) ** odd * (exact > 0)
    assert Comparison(faces, hertz, checkered)["oscillation"] > 0.15


def test_neighbours_and_outlines():
    faces, _, _ = Grid(True)
    number = len(faces.area)  # two rows
    assert len(Neighbours(faces)) == 2 * (number // 2 + 2 * (number // 2 - 1))
    assert len(Outlines(faces)) == len(Neighbours(faces)) // 2
    inner = (faces.extent[:, 0] > 0.1) & (faces.extent[:, 1] < 3.2)
    linear = Bends(faces, faces.corners[..., 0].mean(axis=1))[0]
    assert np.abs(Bends(faces, np.ones(number))).max() < 1e-12
    assert np.abs(linear[inner]).max() < 0.02
