"""A block that slides off the edge of another one in 3D, paired anew in each step (T22), and the
balance of forces on both sides of the contact (T21)."""

import numpy as np
import pytest
from netgen.occ import Box, Compound, OCCGeometry, Pnt, Sphere, X, Y, Z
from ngsolve import (
    CF,
    BilinearForm,
    GridFunction,
    InnerProduct,
    Integrate,
    Mesh,
    VectorH1,
    ds,
    x,
    y,
    z,
)
from press import linear, numpy, press3d

from ngslac import ContactSolver, LACContact, LACSpace

OFFSETS = [0.0, 0.13, 0.5, 0.77, 0.96, 0.9999]
ASIDE = 0.3  # the block also moves along y, by this part of its way along x
DOWN = 0.02


class Sliding:
    """The upper block, held at its top, moves along x and y and is pressed down."""

    def __init__(self, kinds, **law):
        self.problem = press3d(
            kinds=kinds, n=(3, 2), spring=0, flags={"dirichlet": "bottom|top"},
            mesh_flags={"overhang": 0.0}, **law,
        )  # fmt: skip
        self.contact, self.gf = self.problem.contact, self.problem.gf
        V, mesh = self.problem.X.components[0], self.problem.mesh
        self.rigid, self.down = GridFunction(V), GridFunction(V)
        self.rigid.Set(mesh.MaterialCF({"upper": CF((1, ASIDE, 0))}, default=CF((0, 0, 0))))
        self.down.Set(CF((0, 0, -DOWN)), definedon=mesh.Boundaries("top"))
        self.solver, self.offset, self.pressed = self.problem.solver(), 0.0, False

    def MoveRigidly(self, offset):
        """Undeformed at an offset, paired there."""
        self.gf.vec[:] = 0
        self.gf.components[0].vec.data = offset * self.rigid.vec
        self.contact.Update(self.gf)

    def Press(self):
        self.gf.components[0].vec.data += self.down.vec
        return self.solver.Solve(printing=False)

    def MoveOn(self, offset):
        """From the deformed state on, paired in the state that is predicted, and solved."""
        change = offset - self.offset
        self.offset = offset
        start = numpy(self.gf)
        self.gf.components[0].vec.data += change * self.rigid.vec
        predicted = numpy(self.gf)
        self.contact.Update(self.gf)
        # Slip counts from the last step, not from the predicted state.
        self.gf.vec.FV().NumPy()[:] = start
        self.contact.Commit(self.gf)
        self.gf.vec.FV().NumPy()[:] = predicted
        return self.solver.Solve(printing=False)


def check_sides(contact):
    """T21 from the operators: D and M give both bodies equal and opposite forces."""
    traction = contact.Table()["traction"].ravel()
    sums = []
    for operator in contact.Mortar():
        dense = operator.ToDense().NumPy()
        nodal, unit, work = traction @ dense, GridFunction(contact.space.displacement), []
        for field in [(1, 0, 0), (0, 1, 0), (0, 0, 1)]:
            unit.Set(CF(field))
            work.append(nodal @ unit.vec.FV().NumPy())
        sums.append(np.array(work))
    assert sums[0] == pytest.approx(contact.Force(), rel=1e-12, abs=1e-13)
    assert sums[1] == pytest.approx(sums[0], rel=1e-12, abs=1e-13)


@pytest.mark.parametrize("kinds", [("hex", "hex"), ("tet", "prism")])
def test_sliding_off_the_edges_in_3d(kinds):
    """The force sinks to nothing, no macro-element pulls, none carries more than its share."""
    sliding = Sliding(kinds)
    forces, shares = [], []
    for offset in OFFSETS:
        sliding.MoveRigidly(offset)
        last = sliding.Press()
        assert last.number <= 4
        table = sliding.contact.Table()
        assert table["area"].sum() == pytest.approx((1 - offset) * (1 - ASIDE * offset), abs=1e-13)
        assert np.all(table["pressure"] >= -1e-12)
        assert np.all(table["pressure"][table["area"] == 0] == 0)
        forces.append(sliding.contact.Force()[2])
        shares.append((table["area"] * table["pressure"]).max() / table["fullarea"].max())
        assert np.abs(sliding.contact.Force()[:2]).max() < 1e-12
        check_sides(sliding.contact)
    assert np.all(np.diff(forces) < 0)
    assert forces[0] > 1.05
    # What is left stands for the singularity at the master's edge; it goes like the mesh size.
    assert forces[-1] < 0.16 * forces[0]
    assert max(shares) < 2 * shares[0]


@pytest.mark.parametrize("left", [1e-7, 1e-12])
def test_nothing_left_to_touch_in_3d(left):
    """A sliver below the resolution counts as nothing; the block hangs freely."""
    sliding = Sliding(("hex", "hex"))
    sliding.MoveRigidly(1 - left)
    sliding.Press()
    table = sliding.contact.Table()
    if left < 1e-10:
        assert np.all(table["area"] == 0)
        assert np.all(sliding.contact.Force() == 0)
        assert "without partner" in str(sliding.contact.Check())
    assert np.abs(sliding.contact.Force()[2]) < 0.12


def test_beyond_the_edge_they_never_meet():
    sliding = Sliding(("hex", "hex"))
    with pytest.raises(Exception, match="slave and master never meet"):
        sliding.MoveRigidly(1.1)


@pytest.mark.parametrize("kinds", [("hex", "hex"), ("prism_side", "tet")])
def test_sliding_with_friction_step_by_step(kinds):
    """Paired anew in each deformed state; friction acts against the way of the slave."""
    sliding = Sliding(kinds, friction=0.2)
    sliding.MoveRigidly(0.0)
    sliding.Press()
    sliding.contact.Commit(sliding.gf)
    direction = np.array([1, ASIDE]) / np.hypot(1, ASIDE)
    forces, slid = [], 0
    for offset in OFFSETS[1:]:
        sliding.MoveOn(offset)
        force, table = sliding.contact.Force(), sliding.contact.Table()
        forces.append(force[2])
        shear = table["traction"] + table["pressure"][:, None] * table["normal"]
        assert np.all(np.linalg.norm(shear, axis=1) <= 0.2 * table["pressure"] + 1e-9)
        slips = table["status"] == 2
        assert np.all(shear[slips][:, :2] @ direction < 0)
        if np.all(slips | (table["status"] == 0)):
            resultant = table["area"] @ shear
            bound = 0.2 * table["area"] @ table["pressure"]
            assert resultant[:2] @ direction == pytest.approx(-bound, rel=0.02)
            slid += 1
        check_sides(sliding.contact)
    assert np.all(np.diff(forces) < 0)
    assert forces[-1] < 0.2 * forces[0]
    assert slid >= 3


# --- resultants ------------------------------------------------------------------------------


@pytest.mark.parametrize("overhang", [0.0, -0.17, 0.17])
@pytest.mark.parametrize("kinds", [("hex", "tet"), ("prism", "pyramid")])
def test_resultants_balance_the_load_in_3d(kinds, overhang):
    """Force and moment of the contact hold the upper block under an uneven load."""
    problem = press3d(
        kinds=kinds, n=(3, 2), spring=0, friction=0.4, mesh_flags={"overhang": overhang}
    )
    load = CF((0.05, 0.02 * x, -(1 + x * x + 0.3 * y)))
    problem.a += -InnerProduct(load, problem.X.TestFunction()[0]) * ds("top")
    problem.solver().Solve(printing=False, tol=1e-12)
    mesh, contact = problem.mesh, problem.contact
    top = mesh.Boundaries("top")
    force = np.array(Integrate(load, top))
    assert contact.Force() == pytest.approx(-force, abs=1e-10)
    for point in [(0.0, 0.0, 0.0), (0.4, -3.0, 1.0)]:
        r = [c - p for c, p in zip((x, y, z), point, strict=True)]
        moment = CF((
            r[1] * load[2] - r[2] * load[1],
            r[2] * load[0] - r[0] * load[2],
            r[0] * load[1] - r[1] * load[0],
        ))  # fmt: skip
        expected = -np.array(Integrate(moment, top))
        assert contact.Moment(point) == pytest.approx(expected, abs=1e-9)
    check_sides(contact)


def test_both_sides_balance_on_curved_surfaces():
    """A ball in a socket that does not fit: forces cancel, moments to the gap times the force."""
    ball = Sphere(Pnt(0, 0, 0), 1) * Box(Pnt(-2, -2, -2), Pnt(2, 2, -0.4))
    ball.faces.name, ball.faces.Max(Z).name = "slave", "top"
    socket = Box(Pnt(-1, -1, -1.6), Pnt(1, 1, -0.7)) - Sphere(Pnt(0, 0, 0.1), 1.12)
    socket.faces.name = "master"
    for far in (socket.faces.Min(Z), socket.faces.Min(X), socket.faces.Min(Y)):
        far.name = "bottom"
    mesh = Mesh(OCCGeometry(Compound([ball, socket])).GenerateMesh(maxh=0.6)).Curve(2)
    V = VectorH1(mesh, order=2, dirichlet="bottom|top")
    fes = V * LACSpace(V, slave="slave")
    (u, lam), (v, _) = fes.TnT()
    a, gf = BilinearForm(fes), GridFunction(fes)
    a += linear(u, v)
    contact = LACContact(u, lam, master="master", friction=0.3)
    gf.components[0].Set(CF((0.03, 0.02, -0.05)), definedon=mesh.Boundaries("top"))
    ContactSolver(a, gf, contact).Solve(printing=False)
    force = contact.Force()
    assert force[2] > 1
    check_sides(contact)
    # Moments of both sides from the operators, in the paired (undeformed) configuration.
    traction, turns = contact.Table()["traction"].ravel(), [(0, -z, y), (z, 0, -x), (-y, x, 0)]
    sides, unit = [], GridFunction(V)
    for operator in contact.Mortar():
        nodal, work = traction @ operator.ToDense().NumPy(), []
        for turn in turns:
            unit.Set(CF(turn))
            work.append(nodal @ unit.vec.FV().NumPy())
        sides.append(np.array(work))
    table = contact.Table()
    closed = table["status"] > 0
    gap = np.abs(initial_gaps(contact)[closed]).max()
    assert np.linalg.norm(sides[0] - sides[1]) <= gap * np.linalg.norm(force)
    assert np.linalg.norm(sides[0]) > 0


def initial_gaps(contact):
    """Mean gaps of the undeformed bodies."""
    contact.Evaluate(GridFunction(contact.form.fes))
    return contact.Table()["gap"]
