"""The GRECO slab as a slice in 3D between two planes of symmetry: friction 1, SI units, T07.

Plane strain by the symmetry planes: the reference is that of the plane problem, and the solution on
hexahedra does not depend on the coordinate across the slice. Axes: x along the contact, y across
the slice, z up.
"""

from dataclasses import dataclass

import numpy as np
import pytest
from netgen.meshing import Mesh as NetgenMesh
from ngsolve import (
    CF,
    BilinearForm,
    Grad,
    GridFunction,
    InnerProduct,
    Mesh,
    Parameter,
    Sym,
    VectorH1,
    ds,
    dx,
)

from ngslac import BubbleVectorH1, ContactSolver, LACContact, LACSpace, LoadStepper, SplitSlaveFaces
from ngslac.materials import Stress
from ngslac.meshes.boxes import AddBody, StructuredBox
from ngslac.reference import GRECO_SLAB

OPEN, STICK, SLIP = 0, 1, 2
SLICE = 0.002  # thickness
# shape of the cells, order, stabilisation
CASES = [
    ("hex", 2, "none"),
    ("tet", 2, "none"),
    ("prism", 2, "none"),
    ("hex", 1, "bubble"),
    ("prism_side", 1, "split"),
]


@dataclass(frozen=True)
class Outcome:
    displacement: np.ndarray  # along x, at the abscissae of the reference, in metres
    table: dict
    force: np.ndarray
    along: np.ndarray  # the same displacements on the other side of the slice


def Graded(first, length, n):
    """n spacings from 0 to `length` that grow in a geometric series, the first one given."""
    low, high = 1.0, 10.0
    while high - low > 1e-14:
        q = (low + high) / 2
        low, high = (q, high) if first * np.sum(q ** np.arange(n)) < length else (low, q)
    return np.concatenate([[0.0], np.cumsum(first * low ** np.arange(n))]) * (
        length / (first * np.sum(low ** np.arange(n)))
    )


def SlabMesh(kind, order, length):
    n = (12, 6) if order == 2 else (28, 14)
    grid = [
        Graded(0.02 / n[0], GRECO_SLAB.width, n[0]),
        np.array([0.0, SLICE]),
        Graded(0.02 / n[1], GRECO_SLAB.height, n[1]),
    ]
    mesh = NetgenMesh(dim=3)
    AddBody(mesh, "slab", StructuredBox(*(length * g for g in grid), kind))
    mesh.Compress()
    return Mesh(mesh)


def Solve(kind, order, stabilize, *, steps=1, length=1.0, stress=1.0):
    """One metre is `length`, one pascal `stress` units of the computation."""
    mesh = SlabMesh(kind, order, length)
    flags = {"order": order, "dirichletx": "right", "dirichlety": "front|back"}
    if stabilize == "bubble":
        V = BubbleVectorH1(mesh, slave="bottom", **flags)
    else:
        V = VectorH1(SplitSlaveFaces(mesh, "bottom") if stabilize == "split" else mesh, **flags)
    X = V * LACSpace(V, slave="bottom")
    (u, lam), (v, _) = X.TnT()
    load, gf = Parameter(0.0), GridFunction(X)
    sigma = Stress(Sym(Grad(u)), stress * GRECO_SLAB.young, GRECO_SLAB.nu)
    a = BilinearForm(X)
    a += InnerProduct(sigma, Sym(Grad(v))) * dx
    a += load * stress * GRECO_SLAB.top_pressure * v[2] * ds("top")
    a += -load * stress * GRECO_SLAB.side_pressure * v[0] * ds("left")
    contact = LACContact(u, lam, obstacle=CF(0), friction=GRECO_SLAB.friction)
    LoadStepper(ContactSolver(a, gf, contact), load).Integrate(steps=steps, printing=False)
    ux = [
        np.array(
            [gf.components[0](V.mesh(p * length, y * length, 0))[0] for p in GRECO_SLAB.abscissae]
        )
        for y in (0, SLICE)
    ]
    return Outcome(ux[0] / length, contact.Table(), np.array(contact.Force()), ux[1] / length)


@pytest.fixture(scope="module")
def outcomes():
    """The slab in one step, for each case."""
    return {case: Solve(*case) for case in CASES}


@pytest.mark.parametrize("case", CASES)
def test_displacements_agree_with_the_converged_values_in_3d(outcomes, case):
    errors = GRECO_SLAB.Errors(outcomes[case].displacement)
    assert np.abs(errors).max() <= 3e-3


@pytest.mark.parametrize("case", CASES)
def test_displacements_agree_with_the_published_values_in_3d(outcomes, case):
    errors = GRECO_SLAB.Errors(outcomes[case].displacement, reference="published")
    assert np.abs(errors).max() <= 5e-2


@pytest.mark.parametrize("case", CASES)
def test_the_slice_is_plane(outcomes, case):
    """Exactly so on cells that do not change across it; else to the error of the method."""
    size = np.abs(outcomes[case].displacement).max()
    tolerance = 1e-12 if case[0] == "hex" else 1e-3
    difference = outcomes[case].along - outcomes[case].displacement
    assert np.abs(difference).max() <= tolerance * size


@pytest.mark.parametrize("case", CASES)
def test_zones_are_open_slip_stick_in_3d(outcomes, case):
    """In this order along x, with ends within one macro-element."""
    table = outcomes[case].table
    along = np.argsort(table["x"][:, 0], kind="stable")
    status, x = table["status"][along], table["x"][along, 0]
    rank = np.array([[OPEN, SLIP, STICK].index(s) for s in status])
    assert np.all(np.diff(rank) >= 0)
    assert set(status) == {OPEN, STICK, SLIP}
    for before, after, end in (
        (OPEN, SLIP, GRECO_SLAB.open_end),
        (SLIP, STICK, GRECO_SLAB.slip_end),
    ):
        last, first = x[status == before].max(), x[status == after].min()
        assert last - (first - last) / 2 <= end <= first + (first - last) / 2


@pytest.mark.parametrize("case", CASES)
def test_contact_carries_the_top_pressure_within_the_disc(outcomes, case):
    table = outcomes[case].table
    top = GRECO_SLAB.top_pressure * GRECO_SLAB.width * SLICE
    assert outcomes[case].force[2] == pytest.approx(top, rel=1e-9)
    small = 1e-9 * GRECO_SLAB.top_pressure
    assert table["pressure"].min() >= -small
    size = np.linalg.norm(table["traction"][:, :2], axis=1)
    slips, sticks = table["status"] == SLIP, table["status"] == STICK
    bound = GRECO_SLAB.friction * table["pressure"]
    np.testing.assert_allclose(size[slips], bound[slips], atol=small)
    assert np.all(size[sticks] <= bound[sticks] + small)
    # The side pressure drives the slab along +x, friction acts along -x.
    assert np.all(table["slip"][slips, 0] > 0)
    assert np.all(table["traction"][slips, 0] < 0)
    assert np.all(table["gap"][table["status"] == OPEN] > 0)


def test_one_step_and_three_give_the_same_in_3d(outcomes):
    """Without an initial gap the solution is proportional to the load."""
    case = CASES[3]
    three = Solve(*case, steps=3)
    np.testing.assert_allclose(three.displacement, outcomes[case].displacement, rtol=1e-8)
    np.testing.assert_array_equal(three.table["status"], outcomes[case].table["status"])


def test_millimetres_and_megapascals_in_3d(outcomes):
    case = CASES[3]
    si, mm = outcomes[case], Solve(*case, length=1e3, stress=1e-6)
    np.testing.assert_allclose(mm.displacement, si.displacement, rtol=1e-9)
    np.testing.assert_allclose(
        mm.table["pressure"] * 1e6, si.table["pressure"], atol=1e-9 * GRECO_SLAB.top_pressure
    )
