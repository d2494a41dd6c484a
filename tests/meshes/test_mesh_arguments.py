"""What the mesh builders refuse: the argument and what is wrong with it; examples in docstrings."""

import doctest
import importlib
import math

import pytest
from refused import calls, check_refused

from ngslac import meshes

SIZED = {
    "HertzMesh": ["h", "radius", "width", "height", "ratio", "zone", "scale"],
    "SphereOnBlock": ["h", "radius", "width", "height", "ratio", "zone", "scale"],
    "TwoSpheres": ["h", "radius", "radius_lower", "ratio", "zone", "scale"],
    "CylinderOnBlock": ["h", "radius", "width", "ratio", "zone", "scale"],
    "IndentationMesh": ["h", "radius", "zone", "size"],
    "CordMesh": ["h", "zone"],
    "TwoBlocks": ["h_slave", "h_master", "width", "height", "scale"],
    "TwoBlocks3D": ["width", "height", "scale"],
}
BALLS = ("SphereOnBlock", "TwoSpheres")
SHAPE = 'shape must be "flat" or "oblique"'
UNIT = "[0, 1], [0, 1], [0, 1]"
REFUSED = [
    ("HertzMesh(1, zone=95)", "zone is too long"),
    ("IndentationMesh(1, zone=35)", "zone = 35 is too long"),
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
    ("CheckNonMatching3D(TwoBlocks3D(), master='slave')", "the contact meshes match"),
    ("CheckNonMatching3D(TwoBlocks3D(), master='nothing')", "no boundary 'nothing'"),
    ("PointForce(VectorH1(TwoBlocks()), (0, 1))", "no vertex named 'load'"),
]


@calls([(*row, ValueError) for row in REFUSED])
def test_refused(row):
    check_refused(row, **vars(meshes))


@pytest.mark.parametrize("value", [0.0, -1.0, math.nan, math.inf])
@pytest.mark.parametrize(
    ("make", "name"), [(make, name) for make, names in SIZED.items() for name in names]
)
def test_bad_sizes(make, name, value):
    sizes = ({} if "Blocks" in make else {"h": 2.0}) | {name: value}
    with pytest.raises(ValueError, match=f"{name} must be positive"):
        getattr(meshes, make)(**sizes)


@pytest.mark.parametrize(
    "name", ["blocks3d", "boxes", "cylinders", "geometry", "geometry3d", "spheres"]
)
def test_examples_in_docstrings(name):
    result = doctest.testmod(importlib.import_module(f"ngslac.meshes.{name}"))
    assert result.attempted > 0
    assert result.failed == 0
