"""The GRECO slab on a rigid plane: friction 1, SI units, three zones along the contact line.

The mesh has 32 x 32 cells; refinement to 64 x 64 moves the displacements by less than 0.1 %.
"""

from dataclasses import dataclass

import numpy as np
import pytest
from ngsolve import (
    CF,
    BilinearForm,
    Grad,
    GridFunction,
    InnerProduct,
    Parameter,
    Sym,
    TaskManager,
    VectorH1,
    ds,
    dx,
)
from ngsolve.meshes import MakeStructured2DMesh

from ngslac import (
    BubbleVectorH1,
    ContactSolver,
    LACContact,
    LACSpace,
    LoadStepper,
    SplitSlaveFaces,
)
from ngslac.materials import Stress
from ngslac.reference import GRECO_SLAB

CELLS = 32
OPEN, STICK, SLIP = 0, 1, 2

# (order, stabilisation); order 1 without any has macro-elements of two faces.
SPACES = [(1, "none"), (1, "split"), (1, "bubble"), (2, "none")]


@dataclass(frozen=True)
class Outcome:
    displacement: np.ndarray  # along x, at the abscissae of the reference, in metres
    table: dict  # of the contact, macro-elements ordered by x
    force: np.ndarray
    steps: list


def Space(order, stabilize, length):
    """Displacements on the slab; `length` is one metre in the unit of the computation."""
    size = GRECO_SLAB.width * length, GRECO_SLAB.height * length
    mesh = MakeStructured2DMesh(
        quads=False, nx=CELLS, ny=CELLS, mapping=lambda x, y: (size[0] * x, size[1] * y)
    )
    if stabilize == "split":
        mesh = SplitSlaveFaces(mesh, "bottom")
    if stabilize == "bubble":
        return BubbleVectorH1(mesh, order=order, slave="bottom", dirichletx="right")
    return VectorH1(mesh, order=order, dirichletx="right")


def Bulk(X, load, stress):
    """Elasticity with both pressures; `stress` is one pascal in the unit of the computation."""
    (u, _), (v, _) = X.TnT()
    sigma = Stress(Sym(Grad(u)), stress * GRECO_SLAB.young, GRECO_SLAB.nu)
    a = BilinearForm(X)
    a += InnerProduct(sigma, Sym(Grad(v))) * dx
    a += load * stress * GRECO_SLAB.top_pressure * v[1] * ds("top")
    a += -load * stress * GRECO_SLAB.side_pressure * v[0] * ds("left")
    return a


def Solve(order, stabilize, *, steps=1, length=1.0, stress=1.0):
    V = Space(order, stabilize, length)
    X = V * LACSpace(V, slave="bottom")
    (u, lam), _ = X.TnT()
    load = Parameter(0.0)
    gf = GridFunction(X)
    contact = LACContact(u, lam, obstacle=CF(0), friction=GRECO_SLAB.friction)
    with TaskManager():
        solver = ContactSolver(Bulk(X, load, stress), gf, contact)
        done = LoadStepper(solver, load).Integrate(steps=steps, printing=False)
    points = [V.mesh(x * length, 0.0) for x in GRECO_SLAB.abscissae]
    along = np.array([gf.components[0](point)[0] for point in points]) / length
    table = contact.Table()
    along_x = np.argsort(table["x"][:, 0])
    table = {name: values[along_x] for name, values in table.items()}
    return Outcome(along, table, np.asarray(contact.Force()), done)


@pytest.fixture(scope="module")
def outcomes():
    """The slab in one step, for each space."""
    return {case: Solve(*case) for case in SPACES}


def Ends(table):
    """Start and end x of each macro-element; they cover the bottom without holes."""
    ends = np.concatenate([[0.0], np.cumsum(table["fullarea"])])
    return ends[:-1], ends[1:]


@pytest.mark.parametrize("case", SPACES)
def test_displacements_agree_with_the_converged_values(outcomes, case):
    errors = GRECO_SLAB.Errors(outcomes[case].displacement)
    assert np.abs(errors).max() <= 5e-3


@pytest.mark.parametrize("case", SPACES)
def test_displacements_agree_with_the_published_values(outcomes, case):
    errors = GRECO_SLAB.Errors(outcomes[case].displacement, reference="published")
    assert np.abs(errors).max() <= 5e-2


@pytest.mark.parametrize("case", SPACES)
def test_zones_are_open_slip_stick_with_ends_within_one_macro_element(outcomes, case):
    table = outcomes[case].table
    status = table["status"]
    zones = [OPEN, SLIP, STICK]
    rank = np.array([zones.index(s) for s in status])
    assert np.all(np.diff(rank) >= 0)
    assert set(status) == set(zones)
    start, end = Ends(table)
    size = table["fullarea"].max()
    assert end[status == OPEN][-1] == pytest.approx(GRECO_SLAB.open_end, abs=size)
    assert start[status == STICK][0] == pytest.approx(GRECO_SLAB.slip_end, abs=size)


@pytest.mark.parametrize("case", SPACES)
def test_contact_carries_the_top_pressure_within_the_friction_bound(outcomes, case):
    outcome, table = outcomes[case], outcomes[case].table
    top = GRECO_SLAB.top_pressure * GRECO_SLAB.width
    assert outcome.force[1] == pytest.approx(top, rel=1e-10)
    pressure, tangential = table["pressure"], table["traction"][:, 0]
    small = 1e-10 * GRECO_SLAB.top_pressure
    assert pressure.min() >= -small
    slips, sticks = table["status"] == SLIP, table["status"] == STICK
    # The side pressure drives the slab along +x, friction acts along -x.
    np.testing.assert_allclose(
        tangential[slips], -GRECO_SLAB.friction * pressure[slips], atol=small
    )
    assert np.all(table["slip"][slips, 0] > 0)
    assert np.all(np.abs(tangential[sticks]) <= GRECO_SLAB.friction * pressure[sticks] + small)
    assert np.all(table["gap"][table["status"] == OPEN] > 0)


def test_proportional_loads_give_the_same_in_one_step_and_in_five(outcomes):
    # Without an initial gap the solution is proportional to the load.
    one, five = outcomes[2, "none"], Solve(2, "none", steps=5)
    assert [step.cuts for step in five.steps] == [0] * 5
    np.testing.assert_allclose(five.displacement, one.displacement, rtol=1e-8)
    np.testing.assert_array_equal(five.table["status"], one.table["status"])


@pytest.mark.parametrize("case", SPACES[2:])
def test_millimetres_and_megapascals_give_the_same_as_si_units(outcomes, case):
    # Also iteration by iteration: nothing in the method has an absolute size.
    si, mm = outcomes[case], Solve(*case, length=1e3, stress=1e-6)
    np.testing.assert_allclose(mm.displacement, si.displacement, rtol=1e-10)
    np.testing.assert_allclose(
        mm.table["pressure"] * 1e6, si.table["pressure"], atol=1e-10 * GRECO_SLAB.top_pressure
    )
    assert [s.iterations for s in mm.steps] == [s.iterations for s in si.steps]
