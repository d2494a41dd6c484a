"""Patch tests in 3D (T02): a constant stress passes a non-matching interface without error.

All element shapes and orders with all macro partitions. The exact solution is in the discrete
spaces, hence the only errors are those of rounding. NGSolve's pyramids alone violate Gauss' theorem
by 1e-10: with them the load is the volume integral of the constant stress (and another test shows
what happens otherwise).
"""

import numpy as np
import pytest
from elasticity import Displacements
from elasticity3d import Pair3D, Solid
from ngsolve import CF, TaskManager
from patch3d_problem import (
    FREE,
    HELD,
    LAWS,
    OBLIQUE,
    PRESSURE,
    TURN,
    Blocks,
    BulkError,
    Frame,
    HasPyramids,
    Linear,
    Patch,
    Stress,
    TractionError,
)

from ngslac.meshes.blocks3d import TwoBlocks3D

TOL = 1e-11
SHAPES = ["tet", "hex", "prism", "prism_side", "pyramid"]
ELEMENTS = [(shape, order) for shape in SHAPES for order in (1, 2)] + [("tet", 3)]
PARTITIONS = ["", "bubble", "split"]  # agglomerated, one bubble per face, split faces
BELOW = dict(zip(SHAPES, [*SHAPES[1:], SHAPES[0]], strict=True))  # another shape as master
MESHES = {"flat": {}, "oblique": OBLIQUE}


def CheckLaw(kinds, space, law, options, *, swapped=False):
    flags, shear, slip = LAWS[law]
    slave, master = ("master", "slave") if swapped else ("slave", "master")
    V = Blocks(kinds, space, slave=slave, **options)
    pair = Pair3D(V, Solid(), slave=slave, master=master, **flags)
    stress = Stress(options, shear=shear)
    assert max(Patch(pair, options, stress, slip=slip)) <= TOL
    table = pair.contact.Table()
    assert len(table["area"]) > 1
    assert table["area"] == pytest.approx(table["fullarea"], rel=1e-12)
    assert np.abs(table["gap"]).max() <= TOL * np.abs(stress).max() / 2000.0
    assert set(table["status"]) == {2 if slip or law == "frictionless" else 1}
    if slip:
        exact = (-slip if swapped else slip) * Frame(**options)[:, 0]
        assert table["slip"] == pytest.approx(np.tile(exact, (len(table["slip"]), 1)), abs=1e-12)


@pytest.mark.pairwise
@pytest.mark.parametrize("partition", PARTITIONS)
@pytest.mark.parametrize(("shape", "order"), ELEMENTS)
@pytest.mark.parametrize("mesh", MESHES)
def test_constant_stress(mesh, shape, order, partition):
    """Flat with the same shape on both sides, oblique with another one as master."""
    below = shape if mesh == "flat" else BELOW[shape]
    CheckLaw((shape, below), f"P{order}{partition}", "frictionless", MESHES[mesh])


@pytest.mark.pairwise
@pytest.mark.parametrize("law", ["stick", "slip", "tied"])
@pytest.mark.parametrize("partition", PARTITIONS)
@pytest.mark.parametrize(("shape", "order"), ELEMENTS[:-1])
def test_constant_shear(shape, order, partition, law):
    """Friction in a direction that is none of the mesh; the frame is turned at random."""
    CheckLaw((shape, BELOW[shape]), f"P{order}{partition}", law, OBLIQUE)


@pytest.mark.parametrize("partition", PARTITIONS)
def test_constant_shear_of_order_three(partition):
    CheckLaw(("tet", "hex"), f"P3{partition}", "slip", OBLIQUE)


@pytest.mark.pairwise
@pytest.mark.parametrize("law", ["tresca", "slip"])
@pytest.mark.parametrize("space", ["P1bubble", "P2"])
@pytest.mark.parametrize("shape", SHAPES)
def test_slave_and_master_swapped(shape, space, law):
    CheckLaw((shape, BELOW[shape]), space, law, OBLIQUE, swapped=True)


@pytest.mark.parametrize(
    ("space", "law"),
    [("P1", "frictionless"), ("P1bubble", "slip"), ("P1split", "stick"), ("P2", "slip")],
)
def test_unstructured_tetrahedra(space, law):
    options = {"n_slave": 3, "n_master": 2, "unstructured": True}
    options |= {"shape": "oblique", "rotation": TURN}
    CheckLaw((), space, law, options)


@pytest.mark.parametrize("space", ["P1bubble", "P2"])
@pytest.mark.parametrize("shape", SHAPES)
def test_tied_takes_tension(shape, space):
    pair = Pair3D(Blocks((shape,), space, **OBLIQUE), Solid(), tied=True)
    stress = Stress(OBLIQUE, pressure=-PRESSURE, shear=3 * PRESSURE)
    assert max(Patch(pair, OBLIQUE, stress)) <= TOL


@pytest.mark.parametrize("space", ["P1bubble", "P2"])
@pytest.mark.parametrize("shape", SHAPES)
def test_two_materials(shape, space):
    """Without friction the blocks may extend differently along the interface."""
    V, soft = Blocks((shape,), space, **OBLIQUE), Solid(young=60.0)
    young = V.mesh.MaterialCF({"upper": Solid().young, "lower": soft.young})
    assert max(Patch(Pair3D(V, Solid(young=young)), OBLIQUE, Stress(OBLIQUE), lower=soft)) <= TOL


@pytest.mark.pairwise
@pytest.mark.parametrize("young", [2e-6, 2e11])
@pytest.mark.parametrize("shape", ["tet", "hex", "prism"])
@pytest.mark.parametrize("space", ["P1", "P1bubble", "P2"])
def test_as_published(shape, space, young):
    """The cases of code_aster SSNP170: pressure on top, symmetry planes, one support."""
    fixed = {"dirichletx": "left.*", "dirichlety": "front.*", "dirichletz": "bottom"}
    mesh = TwoBlocks3D(shape, None, (3, 2), (2, 3))
    V = Displacements(mesh, space, **fixed)
    pair = Pair3D(V, Solid(young=young))
    pressure = 0.0125 * young
    pair.Load(CF((0.0, 0.0, -pressure)), "top")
    pair.Solve(tol=1e-13)
    table = pair.contact.Table()
    assert pair.StressError(np.diag([0.0, 0.0, -pressure])) <= TOL
    assert np.abs(table["pressure"] / pressure - 1).max() <= TOL
    assert np.all(table["status"] != 0)
    assert np.abs(table["area"] / table["fullarea"] - 1).max() <= TOL


@pytest.mark.parametrize("scale", [1e-3, 1e3])
def test_units_of_length(scale):
    CheckLaw(("tet", "hex"), "P2", "stick", OBLIQUE | {"scale": scale})


@pytest.mark.parametrize("order", [1, 2])
def test_surface_loads_on_pyramids(order):
    """With the tractions on the surface the bulk is wrong by 1e-10, with contact and without."""
    V = Blocks(("pyramid",), f"P{order}", **OBLIQUE)
    assert HasPyramids(V.mesh)
    pair, stress = Pair3D(V, Solid()), Stress(OBLIQUE)
    pair.Hold(Linear(OBLIQUE, Solid().Strain(stress)), HELD)
    pair.LoadStress(stress, FREE)
    pair.Solve(tol=1e-13)
    bulk = BulkError(
        Displacements(V.mesh, f"P{order}", dirichlet=f"{HELD}|slave|master"), OBLIQUE, stress
    )
    assert TOL < bulk < 1e-9
    assert max(pair.StressError(stress), TractionError(pair, stress)) < 5 * bulk


def test_in_threads():
    with TaskManager():
        CheckLaw(("tet", "hex"), "P1bubble", "slip", OBLIQUE)
