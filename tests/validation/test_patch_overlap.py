"""Partial overlap, conservation, and bodies that contact alone holds, in 2D and 3D."""

import math

import numpy as np
import pytest
from case_patch import HELD, LAWS, OBLIQUE_3D, Blocks, Errors, Linear, Stress, TractionError
from elasticity import NAMES, Displacements, Material, Pair
from ngsolve import CF, GridFunction, InnerProduct, Integrate, ds, x, y, z

from ngslac.meshes import TwoBlocks
from ngslac.meshes.geometry import RotationMatrix

TOL = {2: 1e-12, 3: 1e-11}
SHAPES = ["tet", "hex", "prism", "prism_side", "pyramid"]
# The interface of a unit square, inclined by 20 degrees.
AREA = 1 / math.cos(math.radians(20))
OBLIQUE = {2: {"shape": "oblique"}, 3: OBLIQUE_3D}
LAWS_3D = [(space, "frictionless") for space in ("P1", "P1split", "P2", "P2split")]
LAWS_3D += [("P1bubble", "slip"), ("P2", "stick")]


def Problems(spaces_3d, *, shapes=SHAPES):
    """Cells and space of all problems: those of 2D have no cells."""
    return [(None, s) for s in NAMES] + [((c,), s) for c in shapes for s in spaces_3d]


@pytest.mark.pairwise
@pytest.mark.parametrize(("space", "law"), LAWS_3D)
@pytest.mark.parametrize("shape", SHAPES)
@pytest.mark.parametrize("overhang", [0.3, -0.3])
def test_aligned_ends_3d(overhang, shape, space, law):
    """The wider side has faces that end where the other one ends; its rim carries the load."""
    flags, shear, slip = LAWS[law]
    options = OBLIQUE_3D | {"overhang": overhang, "n_slave": (3, 2), "n_master": (2, 3)}
    pair = Pair(Blocks(space, (shape,), **options), Material(), **flags)
    assert max(Errors(pair, options, Stress(3, options, shear=shear), slip=slip)) <= TOL[3]
    table = pair.contact.Table()
    assert table["area"] == pytest.approx(table["fullarea"], rel=1e-12)
    assert table["area"].sum() == pytest.approx(AREA, rel=1e-12)


@pytest.mark.sample(20)
@pytest.mark.parametrize("law", ["frictionless", "stick"])
@pytest.mark.parametrize("problem", Problems(["P1bubble", "P1split", "P2"]))
def test_slave_region_reaches_beyond_the_master(problem, law):
    """Macro-elements without partner stay open while their faces carry the load."""
    (cells, space), (flags, shear, _) = problem, LAWS[law]
    dim, region = (3, "slave|slave_rim") if cells else (2, "slave|slave_left|slave_right")
    sizes = {"n_slave": (3, 2), "n_master": (2, 3)} if cells else {"h_slave": 0.2}
    options = OBLIQUE[dim] | sizes | {"overhang": -0.4 if cells else -0.3}
    pair = Pair(Blocks(space, cells, slave=region, **options), Material(), slave=region, **flags)
    assert max(Errors(pair, options, Stress(dim, options, shear=shear))) <= TOL[dim]
    table = pair.contact.Table()
    assert np.any(table["area"] == 0)
    assert np.all(table["status"][table["area"] == 0] == 0)
    assert table["area"].sum() == pytest.approx(AREA, rel=1e-12)


# ---------------------------------------------------------------- faces that overlap in part


def Uneven(cells, space, overhang, **flags):
    """The wider side is divided evenly: its faces cross the ends of the other side; flat in 2D."""
    sizes = {"h_slave": 0.23, "h_master": 0.11}
    sizes = {"n_slave": (4, 3), "n_master": (3, 4)} if cells else sizes
    options = {"overhang": overhang, "aligned": False} | sizes | (OBLIQUE_3D if cells else {})
    return Pair(Blocks(space, cells, **options), Material(), **flags), options


def SolvePart(pair, options, stress):
    """Load and solve; the narrower side is loaded exactly, the wider by the pairing's operator.

    On the wider side the free part of the contact faces carries the constant stress: all their
    load less that of the segments. What the other operator gives has to be exact.
    """
    wide_slave = options["overhang"] < 0
    pair.LoadStressInside(stress, "master" if wide_slave else "slave")
    pair.Hold(Linear(pair.mesh.dim, options, Material().Strain(stress)), HELD)
    pair.load.Assemble()
    D, M = pair.contact.Mortar()
    lam = D.CreateColVector()
    lam.FV().NumPy()[:] = (pair.contact.Table()["normal"] @ stress).ravel()
    vector = pair.load.vec.CreateVector(copy=True)
    paired = ((D if wide_slave else M).T * lam).Evaluate().FV().NumPy()
    vector.FV().NumPy()[: len(paired)] -= paired if wide_slave else -paired
    pair.Solve(tol=1e-13, load=vector)


PARTLY = [law for law in LAWS_3D if law != ("P2split", "frictionless")]
IN_TURN = [  # by default each shape has every other law
    pytest.param((shape,), *law, marks=() if (i + k) % 2 == 0 else pytest.mark.full)
    for i, shape in enumerate(SHAPES)
    for k, law in enumerate(PARTLY)
]


@pytest.mark.pairwise
@pytest.mark.parametrize(
    ("cells", "space", "law"), [*((None, kind, "frictionless") for kind in NAMES), *IN_TURN]
)
@pytest.mark.parametrize("overhang", [-0.17, 0.17])
def test_constant_stress_where_faces_overlap_in_part(overhang, cells, space, law):
    flags, shear, _ = LAWS[law]
    pair, options = Uneven(cells, space, overhang, **flags)
    dim = pair.mesh.dim
    stress = Stress(dim, options, shear=shear)
    SolvePart(pair, options, stress)
    table = pair.contact.Table()
    share = table["area"] / table["fullarea"]
    if overhang < 0:
        assert np.any((share > 0.01) & (share < 0.99))
    assert table["area"].sum() == pytest.approx(AREA if cells else 1, rel=1e-12)
    assert np.all(table["traction"][share == 0] == 0)
    assert pair.StressError(stress) <= TOL[dim]
    # A thousandth of a macro-element may be paired: its force is as exact as all the others, and
    # that force divided by a small area has a larger relative error.
    assert TractionError(pair, stress, share) <= TOL[dim]
    assert TractionError(pair, stress, share > 0.05) <= TOL[dim]


@pytest.mark.sample(20)
@pytest.mark.parametrize(("cells", "space"), Problems(["P1bubble", "P1split", "P2"]))
@pytest.mark.parametrize("overhang", [-0.17, 0.17])
def test_operators_integrate_over_the_overlap_only(overhang, cells, space):
    """Constants and linear fields: area and first moments of the overlap."""
    pair, options = Uneven(cells, space, overhang)
    dim, field = pair.mesh.dim, GridFunction(pair.displacement.space)
    middle = RotationMatrix(options["rotation"])[:, :2].mean(axis=1) if cells else [0.5, 0.0]
    area = AREA if cells else 1
    for value, exact in [((1.0, -2.0, 3.0), (1.0, -2.0, 3.0)), ((x, y, z), middle)]:
        field.Set(CF(value[:dim]))
        for operator in pair.contact.Mortar():
            means = (operator * field.vec).Evaluate().FV().NumPy().reshape(-1, dim)
            assert means.sum(axis=0) == pytest.approx(area * np.array(exact[:dim]), abs=1e-12)


# ---------------------------------------------------------------- sliding off an edge


def Moved(pair, shift):
    """The upper block displaced as a rigid body."""
    lower = (0.0,) * len(shift)
    pair.displacement.Set(pair.mesh.MaterialCF({"upper": shift, "lower": lower}))


def Slid(space, offset, slave="slave"):
    """The upper block pressed down at an offset, solved; in 3D: tests/solver/test_sliding3d.py."""
    V = Displacements(TwoBlocks(0.25), space, slave=slave, dirichlet="bottom|top")
    master = "master" if slave == "slave" else "slave"
    pair = Pair(V, Material(), slave=slave, master=master)
    Moved(pair, (offset, -1e-3))
    pair.contact.Update(pair.gf)
    pair.Solve(tol=1e-10)
    return pair.contact


@pytest.mark.sample(4)
@pytest.mark.parametrize("space", NAMES)
@pytest.mark.parametrize("slave", ["slave", "master"])
def test_sliding_off_the_edge_2d(space, slave):
    """The force decreases with the overlap to that on a sliver; nothing pulls."""
    forces = []
    for offset in (0.0, 0.13, 0.25, 0.5, 0.77, 0.96, 0.9999):
        contact = Slid(space, offset, slave)
        table = contact.Table()
        assert table["area"].sum() == pytest.approx(1 - offset, abs=1e-13)
        assert np.all(table["pressure"] >= 0)
        assert np.all(table["pressure"][table["area"] == 0] == 0)
        assert abs(contact.Force()[0]) < 1e-13
        forces.append(abs(contact.Force()[1]))
    assert np.all(np.diff(forces) < 0)
    assert forces[-1] < 0.25 < 1.1 < forces[0]


@pytest.mark.parametrize("space", ["P1", "P2"])
def test_nothing_left_to_touch_2d(space):
    """A sliver below the resolution counts as nothing; the block hangs freely, without stress."""
    for left in (1e-7, 1e-12):
        contact = Slid(space, 1 - left)
        table = contact.Table()
        assert np.count_nonzero(table["area"]) == np.count_nonzero(table["status"]) == 0
        assert np.all(contact.Force() == 0)
        assert "without partner" in str(contact.Check())
    with pytest.raises(Exception, match="slave and master never meet"):
        Slid(space, 1.1)


# ---------------------------------------------------------------- held by contact alone


def Unsupported(kind, *, overhang=0.0, load=(0.0, -25.0), **law):
    """A block held by contact alone under a load, not solved."""
    mesh = TwoBlocks(0.2, 0.11, overhang=overhang, aligned=False)
    pair = Pair(Displacements(mesh, kind, dirichlet="bottom"), Material(), **law)
    pair.Load(CF(load), "top")
    return pair


@pytest.mark.sample(6)
@pytest.mark.parametrize("kind", NAMES)
@pytest.mark.parametrize("overhang", [0.0, -0.17, 0.17])
def test_resultants_balance_the_load(kind, overhang):
    """Force and moment of the contact hold the upper block; the lower one gets the opposite."""
    load = (0.05, -(1 + x * x))
    pair = Unsupported(kind, overhang=overhang, load=load, friction=0.4)
    pair.Solve(tol=1e-13)
    mesh, contact, tol = pair.mesh, pair.contact, TOL[2]
    force = [Integrate(CF(f) * ds("top"), mesh) for f in load]
    assert np.asarray(contact.Force()) == pytest.approx(-np.array(force), rel=tol, abs=tol)
    for px, py in [(0.0, 0.0), (0.4, -3.0)]:
        moment = Integrate(((x - px) * load[1] - (y - py) * load[0]) * ds("top"), mesh)
        assert contact.Moment((px, py)) == pytest.approx(-moment, rel=tol)
    unit, work = GridFunction(pair.displacement.space), []
    for operator in contact.Mortar():
        lam = operator.CreateColVector()
        lam.FV().NumPy()[:] = contact.Table()["traction"].ravel()
        nodal = (operator.T * lam).Evaluate()
        for field in [(1.0, 0.0), (0.0, 1.0), (-y, x)]:
            unit.Set(CF(field))
            work.append(InnerProduct(nodal, unit.vec))
    assert work[:3] == pytest.approx(work[3:], rel=tol, abs=tol)


@pytest.mark.sample(4)
@pytest.mark.parametrize("kind", NAMES)
@pytest.mark.parametrize("law", [{"friction": 0.3}, {"tied": True}])
def test_start_without_support(kind, law):
    """Contact alone holds the upper block under a pressure."""
    pair = Unsupported(kind, **law)
    assert pair.Solve(tol=1e-13).number <= 8
    # The lower block is clamped at its foot, which lets its stress vary: look at the resultant.
    assert pair.contact.Force() == pytest.approx([0.0, 25.0], rel=TOL[2], abs=25 * TOL[2])


@pytest.mark.parametrize(
    ("kind", "above"), [*((kind, 0.0) for kind in NAMES), ("P1bubble", 0.05), ("P2", 0.05)]
)
def test_block_that_has_to_fall_first(kind, above):
    """A symmetry condition stops sliding; the nearest macro-elements close and stop the rest."""
    V = Displacements(TwoBlocks(0.25), kind, dirichletx="left.*", dirichlety="bottom")
    pair = Pair(V, Material())
    Moved(pair, (0.0, above))
    pair.Load(CF((0.0, -25.0)), "top")
    pair.Solve(tol=1e-13)
    assert pair.StressError(np.diag([0.0, -25.0])) <= TOL[2]
