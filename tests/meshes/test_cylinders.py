"""The mesh of a slice of a cylinder on a block."""

import math

import numpy as np
import pytest
from ngsolve import CF, ET, VOL, Integrate, specialcf

from ngslac.meshes import CheckNonMatching3D, CylinderOnBlock
from ngslac.meshes.cylinders import THICKNESS


@pytest.fixture(scope="module", params=["quarter", "full"])
def cylinder(request):
    return request.param, CylinderOnBlock(1.0, zone=3.3, model=request.param)


def test_slice_of_a_cylinder(cylinder):
    model, mesh = cylinder
    halves = 1 if model == "quarter" else 2
    exact = {"cylinder": math.pi / 4 * 50**2, "block": 100.0**2}
    for body, area in exact.items():
        volume = Integrate(CF(1), mesh, definedon=mesh.Materials(body))
        assert volume == pytest.approx(halves * THICKNESS * area, rel=0.03)
    faces = {"slave": 50 * math.asin(3.3 / 50), "master": 3.3 * 16 / 15, "top": 50, "bottom": 100}
    for name, length in faces.items():
        area = Integrate(CF(1), mesh.Boundaries(name))
        assert area == pytest.approx(halves * THICKNESS * length, rel=1e-3)
    has_middle = "sym_x" in mesh.GetBoundaries()
    assert has_middle == (model == "quarter")
    assert {el.type for el in mesh.Elements(VOL)} == {ET.PRISM}
    assert {el.type for el in mesh.Boundaries("slave|master").Elements()} == {ET.QUAD}
    assert CheckNonMatching3D(mesh) > 1e-3


def test_normals_of_the_cylinder_point_outwards(cylinder):
    normal = specialcf.normal(3)
    _, mesh = cylinder
    down, up = (
        Integrate(normal[2], mesh.Boundaries(name)) / Integrate(CF(1), mesh.Boundaries(name))
        for name in ("slave|bottom", "master|top")
    )
    assert down == pytest.approx(-1, abs=1e-3)
    assert up == pytest.approx(1, abs=1e-3)


def test_units_do_not_change_the_cylinder():
    mesh, metres = CylinderOnBlock(1.0), CylinderOnBlock(1.0, scale=1e-3)
    points, scaled = (np.array([v.point for v in m.vertices]) for m in (mesh, metres))
    np.testing.assert_allclose(scaled, 1e-3 * points, rtol=1e-12)


@pytest.mark.parametrize(
    "bad", [{"h": 0}, {"zone": 46}, {"width": 2}, {"model": "half"}, {"scale": -1}, {"ratio": 0}]
)
def test_refused_cylinders(bad):
    with pytest.raises(ValueError, match=next(iter(bad)) + "|zone"):
        CylinderOnBlock(**{"h": 1.0} | bad)
