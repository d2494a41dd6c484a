"""Patch tests in 3D where one side is wider than the other, and faces that overlap in part."""

import math

import numpy as np
import pytest
from elasticity import Displacements
from elasticity3d import Pair3D, Solid
from ngsolve import CF, GridFunction, x, y, z
from patch3d_problem import HELD, LAWS, OBLIQUE, Blocks, Linear, Patch, Stress, TractionError

from ngslac import ContactSolver
from ngslac.meshes.blocks3d import TwoBlocks3D
from ngslac.meshes.geometry3d import RotationMatrix

TOL = 1e-11
SHAPES = ["tet", "hex", "prism", "prism_side", "pyramid"]
CASES = [(space, "frictionless") for space in ("P1", "P1split", "P2", "P2split")]
CASES += [("P1bubble", "slip"), ("P2", "stick")]
WIDER = {"wide master": 0.3, "wide slave": -0.3}
# The interface of a unit square, inclined by 20 degrees.
AREA = 1 / math.cos(math.radians(20))


@pytest.mark.pairwise
@pytest.mark.parametrize(("space", "law"), CASES)
@pytest.mark.parametrize("shape", SHAPES)
@pytest.mark.parametrize("wider", WIDER)
def test_aligned_ends(wider, shape, space, law):
    """The wider side has faces that end where the other one ends; its rim carries the load."""
    flags, shear, slip = LAWS[law]
    options = OBLIQUE | {"overhang": WIDER[wider], "n_slave": (3, 2), "n_master": (2, 3)}
    pair = Pair3D(Blocks((shape,), space, **options), Solid(), **flags)
    assert max(Patch(pair, options, Stress(options, shear=shear), slip=slip)) <= TOL
    table = pair.contact.Table()
    assert table["area"] == pytest.approx(table["fullarea"], rel=1e-12)
    assert table["area"].sum() == pytest.approx(AREA, rel=1e-12)


@pytest.mark.pairwise
@pytest.mark.parametrize("law", ["frictionless", "stick"])
@pytest.mark.parametrize("space", ["P1bubble", "P1split", "P2"])
@pytest.mark.parametrize("shape", SHAPES)
def test_slave_region_reaches_beyond_the_master(shape, space, law):
    """Macro-elements without partner stay open while their faces carry the load."""
    flags, shear, _ = LAWS[law]
    options = OBLIQUE | {"overhang": -0.4, "n_slave": (3, 2), "n_master": (2, 3)}
    region = "slave|slave_rim"
    pair = Pair3D(Blocks((shape,), space, slave=region, **options), Solid(), slave=region, **flags)
    assert max(Patch(pair, options, Stress(options, shear=shear))) <= TOL
    table = pair.contact.Table()
    assert np.any(table["area"] == 0)
    assert np.all(table["status"][table["area"] == 0] == 0)
    assert table["area"].sum() == pytest.approx(AREA, rel=1e-12)


# ---------------------------------------------------------------- faces that overlap in part


def Uneven(shape, space, overhang, **flags):
    """The wider side is divided evenly: its faces cross the ends of the other side."""
    options = OBLIQUE | {"overhang": overhang, "aligned": False, "n_slave": (4, 3)}
    V = Blocks((shape,), space, **options | {"n_master": (3, 4)})
    return Pair3D(V, Solid(), **flags), options


def SolvePart(pair, options, stress):
    """Load and solve; the narrower side is loaded exactly, the wider by the pairing's operator.

    On the wider side the free part of the contact faces carries the constant stress: all their
    load less that of the segments. What the other operator gives has to be exact.
    """
    wide_slave = options["overhang"] < 0
    pair.LoadStressInside(stress, "master" if wide_slave else "slave")
    pair.Hold(Linear(options, Solid().Strain(stress)), HELD)
    pair.load.Assemble()
    D, M = pair.contact.Mortar()
    operator = D if wide_slave else M
    table = pair.contact.Table()
    lam = D.CreateColVector()
    lam.FV().NumPy()[:] = (table["normal"] @ stress).ravel()
    vector = pair.load.vec.CreateVector(copy=True)
    paired = (operator.T * lam).Evaluate().FV().NumPy()
    vector.FV().NumPy()[: len(paired)] -= paired if wide_slave else -paired
    ContactSolver(pair.a, pair.gf, pair.contact, rhs=vector).Solve(tol=1e-13, printing=False)


@pytest.mark.pairwise
@pytest.mark.parametrize(("space", "law"), CASES[:3] + CASES[4:])
@pytest.mark.parametrize("shape", SHAPES)
@pytest.mark.parametrize("overhang", [-0.17, 0.17])
def test_constant_stress_where_faces_overlap_in_part(overhang, shape, space, law):
    flags, shear, _ = LAWS[law]
    pair, options = Uneven(shape, space, overhang, **flags)
    stress = Stress(options, shear=shear)
    SolvePart(pair, options, stress)
    table = pair.contact.Table()
    share = table["area"] / table["fullarea"]
    if overhang < 0:
        assert np.any((share > 0.01) & (share < 0.99))
    assert table["area"].sum() == pytest.approx(AREA, rel=1e-12)
    assert pair.StressError(stress) <= TOL
    # A thousandth of a macro-element may be paired: its force is as exact as all the others, and
    # that force divided by a small area has a larger relative error.
    assert TractionError(pair, stress, share) <= TOL
    assert TractionError(pair, stress, share > 0.05) <= TOL


@pytest.mark.pairwise
@pytest.mark.parametrize("space", ["P1bubble", "P1split", "P2"])
@pytest.mark.parametrize("shape", SHAPES)
@pytest.mark.parametrize("overhang", [-0.17, 0.17])
def test_operators_integrate_over_the_overlap_only(overhang, shape, space):
    """Constants and linear fields: area and first moments of the overlap."""
    pair, options = Uneven(shape, space, overhang)
    middle = RotationMatrix(options["rotation"])[:, :2].mean(axis=1)
    field = GridFunction(pair.displacement.space)
    for value, exact in [((1.0, -2.0, 3.0), np.array([1.0, -2.0, 3.0])), ((x, y, z), middle)]:
        field.Set(CF(value))
        for operator in pair.contact.Mortar():
            means = (operator * field.vec).Evaluate().FV().NumPy().reshape(-1, 3)
            assert means.sum(axis=0) == pytest.approx(AREA * exact, abs=1e-12)


# ---------------------------------------------------------------- sliding off an edge


def Slid(shape, space, offset):
    """The upper block pressed down at an offset in x, solved."""
    mesh = TwoBlocks3D(shape, None, (3, 2), (4, 3))
    V = Displacements(mesh, space, dirichlet="bottom|top")
    pair = Pair3D(V, Solid())
    shift = {"upper": (offset, offset / 3, -1e-3), "lower": (0.0, 0.0, 0.0)}
    pair.displacement.Set(V.mesh.MaterialCF(shift))
    pair.contact.Update(pair.gf)
    pair.Solve(tol=1e-10)
    return pair.contact


@pytest.mark.parametrize("space", ["P1", "P1bubble", "P1split", "P2"])
@pytest.mark.parametrize("shape", ["tet", "hex", "prism"])
def test_sliding_off_the_edge(shape, space):
    """The force decreases with the overlap to that on a sliver; nothing pulls (T22)."""
    forces = []
    for offset in [0.0, 0.13, 0.5, 0.77, 0.99]:
        contact = Slid(shape, space, offset)
        table = contact.Table()
        left = (1 - offset) * (1 - offset / 3)
        assert table["area"].sum() == pytest.approx(left, abs=1e-12)
        assert table["pressure"].min() >= -1e-12 * table["pressure"].max()
        assert np.all(table["pressure"][table["area"] == 0] == 0)
        assert np.abs(contact.Force()[:2]).max() < 1e-12
        forces.append(contact.Force()[2])
    assert np.all(np.diff(forces) < 0)
    assert 0 <= forces[-1] < 0.5 * forces[0]
