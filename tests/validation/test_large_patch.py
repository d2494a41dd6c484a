"""Patch test with large strains: one deformation gradient in each block passes without error.

30 % of compression; surfaces that do not match and slide over each other, or stick while sheared.
"""

import numpy as np
import pytest
from largepatch_problem import LargePatch

from ngslac.meshes import TwoBlocks
from ngslac.meshes.blocks3d import TwoBlocks3D
from ngslac.meshes.geometry3d import RotationMatrix

TOL = 1e-10
# Without friction a block of width 1 becomes as wide as one of width 1.25 / 1.15.
FREE = (1.25, 1.15)
OVERHANG = (FREE[0] / FREE[1] - 1) / 2
STICK = (1.15, 1.15)
AXIS = ((1.0, 2.0, -0.5), 37.0)


def patch(law, kind, make, *, dim=2, rotation=None, **options):
    """Solved in four steps; `make` takes the options of TwoBlocks or TwoBlocks3D."""
    if law == "stick":
        flags = {"stretches": STICK, "stick": True, "friction": 0.8}
        total = (0.15, 1.4) if dim == 2 else (0.15, 0.1, 1.4)
    else:
        flags = {"stretches": FREE}
        total = (0,) * (dim - 1) + (1.4,)
        options |= {"overhang": OVERHANG, "aligned": False}
    problem = LargePatch(make(**options), kind, total=total, rotation=rotation, **flags)
    problem.Run(4)
    return problem


def check(problem, law):
    errors = problem.Errors()
    assert max(errors.values()) <= TOL, errors
    table, blocks = problem.contact.Table(), problem.blocks
    assert set(table["status"]) == {1 if law == "stick" else 2}
    assert blocks["upper"].F[-1, -1] + blocks["lower"].F[-1, -1] == pytest.approx(1.4)
    assert abs(blocks["upper"].F[-1, -1] - blocks["lower"].F[-1, -1]) > 0.01
    assert np.all(table["pressure"] > 10)


@pytest.mark.pairwise
@pytest.mark.parametrize("law", ["frictionless", "stick"])
@pytest.mark.parametrize("quads", [False, True])
@pytest.mark.parametrize("kind", ["P1", "P1split", "P1bubble", "P2", "P3"])
def test_large_strain(kind, quads, law):
    check(patch(law, kind, TwoBlocks, h_slave=0.25, quads=quads, structured=quads), law)


@pytest.mark.parametrize("law", ["frictionless", "stick"])
@pytest.mark.parametrize("kind", ["P1", "P2"])
def test_rotated(kind, law):
    a = np.radians(37)
    turn = np.array([[np.cos(a), -np.sin(a)], [np.sin(a), np.cos(a)]])
    check(patch(law, kind, TwoBlocks, rotation=turn, h_slave=0.25, angle=37), law)


CELLS = [
    ("hex", "hex", "P1"),
    ("tet", "hex", "P1"),
    ("prism", "tet", "P1"),
    ("tet", "prism", "P1bubble"),
    ("hex", "prism", "P2"),
    ("tet", "hex", "P2"),
]


@pytest.mark.parametrize("law", ["frictionless", "stick"])
@pytest.mark.parametrize("cells", CELLS, ids="-".join)
def test_large_strain_3d(cells, law):
    upper, lower, kind = cells
    n = (2, 1) if kind == "P2" else (4, 3)
    check(patch(law, kind, lambda **o: TwoBlocks3D(upper, lower, *n, **o), dim=3), law)


@pytest.mark.parametrize("law", ["frictionless", "stick"])
def test_rotated_3d(law):
    def make(**options):
        return TwoBlocks3D("hex", "tet", 4, 3, rotation=AXIS, **options)

    check(patch(law, "P1", make, dim=3, rotation=RotationMatrix(AXIS)), law)
