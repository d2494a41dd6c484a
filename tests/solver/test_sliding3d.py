"""A block that slides off the edge of another one in 3D, paired anew in each step (T22), and the
balance of forces on both sides of the contact (T21)."""

import numpy as np
import pytest
from law import shear
from netgen.occ import Box, Compound, OCCGeometry, Pnt, Sphere, X, Y, Z
from ngsolve import (
    CF,
    Cross,
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
from posed import posed
from press import linear, numpy, press

OFFSETS = [0.0, 0.13, 0.5, 0.77, 0.96, 0.9999]
ASIDE = 0.3  # the block also moves along y, by this part of its way along x
DOWN = 0.02
TRANSLATIONS = [(1, 0, 0), (0, 1, 0), (0, 0, 1)]
ROTATIONS = [(0, -z, y), (z, 0, -x), (-y, x, 0)]


class Sliding:
    """The upper block, held at its top, moves along x and y and is pressed down."""

    def __init__(self, kinds, **law):
        held = {"spring": 0, "flags": {"dirichlet": "bottom|top"}, "mesh_flags": {"overhang": 0.0}}
        self.problem = press(dim=3, kinds=kinds, **held, **law)
        self.contact, self.gf = self.problem.contact, self.problem.gf
        V, mesh = self.problem.X.components[0], self.problem.mesh
        self.rigid, self.down = GridFunction(V), GridFunction(V)
        self.rigid.Set(mesh.MaterialCF({"upper": CF((1, ASIDE, 0))}, default=CF((0, 0, 0))))
        self.down.Set(CF((0, 0, -DOWN)), definedon=mesh.Boundaries("top"))
        self.solver, self.offset = self.problem.solver(), 0.0

    def MoveRigidly(self, offset):
        """Undeformed at an offset, paired there, and pressed."""
        self.gf.vec[:] = 0
        self.gf.components[0].vec.data = offset * self.rigid.vec
        self.contact.Update(self.gf)
        self.gf.components[0].vec.data += self.down.vec
        return self.solver.Solve(printing=False)

    def MoveOn(self, offset):
        """From the deformed state on, paired in the state that is predicted, and solved."""
        change, self.offset = offset - self.offset, offset
        start = numpy(self.gf)
        self.gf.components[0].vec.data += change * self.rigid.vec
        predicted = numpy(self.gf)
        self.contact.Update(self.gf)
        # Slip counts from the last step, not from the predicted state.
        self.gf.vec.FV().NumPy()[:] = start
        self.contact.Commit(self.gf)
        self.gf.vec.FV().NumPy()[:] = predicted
        return self.solver.Solve(printing=False)


def works(contact, fields):
    """Work of the tractions on both sides, from the operators D and M, for some displacements."""
    traction, unit = contact.Table()["traction"].ravel(), GridFunction(contact.space.displacement)
    sides = []
    for operator in contact.Mortar():
        nodal, work = traction @ operator.ToDense().NumPy(), []
        for field in fields:
            unit.Set(CF(field))
            work.append(nodal @ unit.vec.FV().NumPy())
        sides.append(np.array(work))
    return sides


def check_sides(contact):
    """T21: both bodies get equal and opposite forces."""
    slave, master = works(contact, TRANSLATIONS)
    assert slave == pytest.approx(contact.Force(), rel=1e-12, abs=1e-13)
    assert master == pytest.approx(slave, rel=1e-12, abs=1e-13)


@pytest.mark.parametrize("kinds", [("hex", "hex"), ("tet", "prism")])
def test_sliding_off_the_edges(kinds):
    """The force sinks to nothing, no macro-element pulls, none carries more than its share."""
    sliding = Sliding(kinds)
    forces, shares = [], []
    for offset in OFFSETS:
        assert sliding.MoveRigidly(offset).number <= 4
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


def test_nothing_left_to_touch():
    """A sliver below the resolution counts as nothing; the block hangs freely."""
    sliding = Sliding(("hex", "hex"))
    for left in (1e-7, 1e-12):
        sliding.MoveRigidly(1 - left)
        assert np.abs(sliding.contact.Force()[2]) < 0.12
    assert np.all(sliding.contact.Table()["area"] == 0)
    assert np.all(sliding.contact.Force() == 0)
    assert "without partner" in str(sliding.contact.Check())
    with pytest.raises(Exception, match="slave and master never meet"):
        sliding.MoveRigidly(1.1)


@pytest.mark.parametrize("kinds", [("hex", "hex"), ("prism_side", "tet")])
def test_sliding_with_friction_step_by_step(kinds):
    """Paired anew in each deformed state; friction acts against the way of the slave."""
    sliding = Sliding(kinds, friction=0.2)
    sliding.MoveRigidly(0.0)
    sliding.contact.Commit(sliding.gf)
    direction = np.array([1, ASIDE]) / np.hypot(1, ASIDE)
    forces, slid = [], 0
    for offset in OFFSETS[1:]:
        sliding.MoveOn(offset)
        table = sliding.contact.Table()
        forces.append(sliding.contact.Force()[2])
        along = shear(table)
        assert np.all(np.linalg.norm(along, axis=1) <= 0.2 * table["pressure"] + 1e-9)
        slips = table["status"] == 2
        assert np.all(along[slips][:, :2] @ direction < 0)
        if np.all(slips | (table["status"] == 0)):
            resultant = (table["area"] @ along)[:2] @ direction
            bound = 0.2 * table["area"] @ table["pressure"]
            assert resultant == pytest.approx(-bound, rel=0.02)
            slid += 1
        check_sides(sliding.contact)
    assert np.all(np.diff(forces) < 0)
    assert forces[-1] < 0.2 * forces[0]
    assert slid >= 3


# --- resultants ------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("kinds", "overhang"),
    [(("hex", "tet"), 0.0), (("prism", "pyramid"), -0.17), (("hex", "tet"), 0.17)],
)
def test_resultants_balance_the_load(kinds, overhang):
    """Force and moment of the contact hold the upper block under an uneven load."""
    problem = press(dim=3, kinds=kinds, spring=0, friction=0.4, mesh_flags={"overhang": overhang})
    load = CF((0.05, 0.02 * x, -(1 + x * x + 0.3 * y)))
    problem.a += -InnerProduct(load, problem.X.TestFunction()[0]) * ds("top")
    problem.solver().Solve(printing=False, tol=1e-12)
    contact, top = problem.contact, problem.mesh.Boundaries("top")
    assert contact.Force() == pytest.approx(-np.array(Integrate(load, top)), abs=1e-10)
    for point in [(0.0, 0.0, 0.0), (0.4, -3.0, 1.0)]:
        moment = np.array(Integrate(Cross(CF((x, y, z)) - CF(point), load), top))
        assert contact.Moment(point) == pytest.approx(-moment, abs=1e-9)
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
    problem = posed(V, lambda u, v, load: linear(u, v), friction=0.3)
    way, contact = CF((0.03, 0.02, -0.05)), problem.contact
    problem.gf.components[0].Set(way, definedon=mesh.Boundaries("top"))
    problem.solver().Solve(printing=False)
    force, closed = contact.Force(), contact.Table()["status"] > 0
    assert force[2] > 1
    check_sides(contact)
    # Moments in the paired (undeformed) configuration.
    slave, master = works(contact, ROTATIONS)
    contact.Evaluate(GridFunction(problem.X))
    gap = np.abs(contact.Table()["gap"][closed]).max()
    assert np.linalg.norm(slave - master) <= gap * np.linalg.norm(force)
    assert np.linalg.norm(slave) > 0
