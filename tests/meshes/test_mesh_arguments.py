"""What the mesh builders refuse: the argument and what is wrong with it; examples in docstrings."""

import doctest
import importlib
import math

import numpy as np
import pytest
from refused import calls, check_refused

from ngslac import meshes
from ngslac.meshes import geometry

SIZED = {
    "HertzMesh": ["h", "radius", "width", "height", "ratio", "zone", "scale"],
    "SphereOnBlock": ["h", "radius", "width", "height", "ratio", "zone", "scale"],
    "TwoSpheres": ["h", "radius", "radius_lower", "ratio", "zone", "scale"],
    "CylinderOnBlock": ["h", "radius", "width", "ratio", "zone", "scale"],
    "TwoBlocks": ["h_slave", "h_master", "width", "height", "scale"],
    "TwoBlocks3D": ["width", "height", "scale"],
}
BALLS = ("SphereOnBlock", "TwoSpheres")
SHAPE = 'shape must be "flat" or "oblique"'
UNIT = "[0, 1], [0, 1], [0, 1]"
REFUSED = [
    ("HertzMesh(1, zone=95)", "zone is too long"),
    ("CylinderOnBlock(1, zone=46)", "zone is too wide"),
    ("CylinderOnBlock(1, width=2)", "zone is too wide"),
    ("CylinderOnBlock(1, model='half')", 'model must be "quarter" or "full"'),
    *(
        (f"{ball}(2, model='eighth')", 'model must be "quarter", "half" or "full"')
        for ball in BALLS
    ),
    *((f"{ball}(2, zone=49.0)", "zone is too wide for the sphere") for ball in BALLS),
    ("SphereOnBlock(2, width=5)", "zone is too wide for the block"),
    ("TwoSpheres(2, radius_lower=7)", "zone is too wide for the lower sphere"),
    ("TwoBlocks(shape='round')", SHAPE),
    ("TwoBlocks(structured=True, curved=True)", "structured or curved, not both"),
    ("TwoBlocks(shape='oblique', slope=70)", "leaves the blocks"),
    ("TwoBlocks3D(shape='round')", SHAPE),
    ("TwoBlocks3D(shape='oblique', slope=60)", "leaves the blocks"),
    ("TwoBlocks3D(n_slave=0)", "divisions must be"),
    ("TwoBlocks3D(n_master=(1, 2, 3))", "divisions must be"),
    ("TwoBlocks3D('wedge')", "kind must be one of"),
    ("TwoBlocks3D(unstructured=True, perturb=0.1)", "has no perturb"),
    ("TwoBlocks3D(unstructured=True, overhang=0.1)", "aligned=False with an overhang"),
    ("TwoBlocks3D(n_slave=2, n_master=2)", "coincides with a master face"),
    ("TwoBlocks3D(n_slave=2, n_master=4)", r"slave vertex \(0.5, 0.5, 0\) faces"),
    (f"StructuredBox({UNIT}, 'brick')", "kind must be one of tet, hex"),
    ("StructuredBox([0, 1], [0, 0], [0, 1])", "y must be at least two increasing"),
    ("StructuredBox([0], [0, 1], [0, 1])", "x must be at least two increasing"),
    ("StructuredBox([0, 1], [0, 1], [[0, 1]])", "z must be at least two increasing"),
    (f"StructuredBox({UNIT}, perturb=-0.1)", "perturb must be at least 0"),
    (f"StructuredBox({UNIT}, perturb=0.3)", "perturb must be at least 0"),
    (f"StructuredBox({UNIT}, perturb=NAN)", "perturb must be at least 0"),
    ("RotationMatrix(np.diag([1, 1, -1]))", "reflection"),
    ("RotationMatrix(2 * np.eye(3))", "orthogonal"),
    ("RotationMatrix(np.eye(4))", "orthogonal"),
    ("RotationMatrix(([0, 0, 0], 30))", "axis of three numbers"),
    ("RotationMatrix(('z', INF))", "axis of three numbers"),
    ("RotationMatrix(('w', 30))", "axis of three numbers"),
    ("CheckNonMatching(TwoBlocks(), master='slave|left_upper')", r"slave node \(.* faces a master"),
    ("CheckNonMatching(TwoBlocks(), master='nothing')", "no boundary 'nothing'"),
    ("CheckNonMatching(TwoBlocks3D(), master='slave')", "the contact meshes match"),
    ("CheckNonMatching(TwoBlocks3D(), master='nothing')", "no boundary 'nothing'"),
]


@calls([(*row, ValueError) for row in REFUSED])
def test_refused(row):
    check_refused(row, **vars(meshes) | vars(geometry))


@pytest.mark.parametrize("value", [0.0, -1.0, math.nan, math.inf])
@pytest.mark.parametrize(
    ("make", "name"), [(make, name) for make, names in SIZED.items() for name in names]
)
def test_bad_sizes(make, name, value):
    sizes = ({} if "Blocks" in make else {"h": 2.0}) | {name: value}
    with pytest.raises(ValueError, match=f"{name} must be positive"):
        getattr(meshes, make)(**sizes)


USUAL = {
    "TwoBlocks": {},
    "TwoBlocks3D": {},
}
FINITE = {
    "TwoBlocks": ["overhang", "angle", "slope"],
    "TwoBlocks3D": ["overhang", "azimuth", "slope"],
    "HertzMesh": ["angle"],
}
SIZES = {
    "HertzMesh": ["h", "grading", "order", "ratio"],
    "SphereOnBlock": ["h", "grading", "order", "maxh", "ratio"],
    "TwoSpheres": ["h", "grading", "order", "maxh", "ratio"],
    "CylinderOnBlock": ["h", "grading", "ratio"],
    "TwoBlocks": ["h_slave", "h_master", "order"],
    "TwoBlocks3D": ["n_slave", "n_master", "layers", "seed", "perturb"],
}


def made(name, **given):
    return getattr(meshes, name)(**(USUAL.get(name, {"h": 3.0}) | given))


@pytest.mark.parametrize("value", [math.nan, math.inf, -math.inf])
@pytest.mark.parametrize(("name", "argument"), [(n, a) for n in FINITE for a in FINITE[n]])
def test_a_number_that_is_none(name, argument, value):
    """A mesher may work on it for ever."""
    with pytest.raises(ValueError, match=f"{argument} = .* must be a finite number"):
        made(name, **{argument: value, **({"shape": "oblique"} if "Blocks" in name else {})})


@pytest.mark.parametrize("value", [math.nan, math.inf, -1, 1e-9, 1e-300])
@pytest.mark.parametrize(("name", "argument"), [(n, a) for n in SIZES for a in SIZES[n]])
def test_sizes_that_nobody_can_mesh(name, argument, value):
    if (name, argument, value) in {("TwoBlocks3D", "perturb", v) for v in (1e-9, 1e-300)}:
        return  # is as good as none
    with pytest.raises((ValueError, TypeError), match=argument):
        made(name, **{argument: value})


@pytest.mark.parametrize(
    ("name", "given"),
    [
        ("TwoBlocks", {"h_slave": 1e-9}),
        ("TwoBlocks", {"h_slave": 1e-4, "structured": True}),
        ("TwoBlocks", {"overhang": 1e5}),
        ("TwoBlocks3D", {"n_slave": 10_000}),
        ("TwoBlocks3D", {"layers": (1, 10**9)}),
        ("TwoBlocks3D", {"unstructured": True, "n_master": 10_000}),
        ("HertzMesh", {"h": 1e-9}),
        ("SphereOnBlock", {"h": 1e-9}),
        ("TwoSpheres", {"maxh": 1e-3}),
        ("CylinderOnBlock", {"h": 1e-9}),
    ],
)
def test_the_number_of_elements_is_told(name, given):
    with pytest.raises(ValueError, match=r"would make about \d.\de\+\d+ elements"):
        made(name, **given)


@pytest.mark.parametrize(("name", "given"), [("HertzMesh", {}), ("SphereOnBlock", {"h": 2.0})])
def test_the_number_of_elements_is_about_right(name, given, monkeypatch):
    told = []
    module = importlib.import_module(getattr(meshes, name).__module__)
    monkeypatch.setattr(module, "CheckElements", lambda number, **_: told.append(number))
    mesh = made(name, **given)
    assert 0.2 < told[0] / mesh.ne < 5


@pytest.mark.parametrize("axis", [(1e308, 1e308, 0), (1e-320, 1e-320, 0), (3e-200, 3e-200, 0)])
def test_an_axis_of_any_length(axis):
    turn = geometry.RotationMatrix((axis, 30.0))
    assert turn == pytest.approx(geometry.RotationMatrix(((1, 1, 0), 30.0)), abs=1e-3)
    assert turn @ turn.T == pytest.approx(np.eye(3), abs=1e-12)


def test_many_turns():
    mesh = meshes.TwoBlocks(0.5, angle=1e308)
    assert mesh.ne == meshes.TwoBlocks(0.5).ne


@pytest.mark.parametrize("name", ["blocks3d", "boxes", "cylinders", "spheres"])
def test_examples_in_docstrings(name):
    result = doctest.testmod(importlib.import_module(f"ngslac.meshes.{name}"))
    assert result.attempted > 0
    assert result.failed == 0
