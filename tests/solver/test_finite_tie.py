"""Ties of parts that rotate and deform."""

import numpy as np
import pytest
from finitepress import Led, blocks2d, blocks3d, soft
from form import POSITIONS, rotation
from halves import halves_mesh
from ngsolve import (
    CF,
    BilinearForm,
    Grad,
    GridFunction,
    Id,
    InnerProduct,
    Integrate,
    Mesh,
    Parameter,
    Variation,
    VectorH1,
    dx,
)
from posed import elastic, posed
from press import neo_hooke, press
from rings import rings_mesh

from ngslac import ContactSolver, LACContact, LACSpace, LoadStepper
from ngslac.bodies.constraints import ActiveRows


class Tied:
    """Parts of rubber, of which `where` is led by `place(load)`, the position from that before."""

    def __init__(self, mesh, where, place, *, order=2, **law):
        self.mesh, self.dim = mesh, mesh.dim
        V = VectorH1(mesh, order=order, dirichlet=where)
        X = V * LACSpace(V, slave="slave")
        u, lam = X.TrialFunction()
        a = BilinearForm(X)
        a += Variation(soft(Id(self.dim) + Grad(u)).Compile() * dx)
        self.gf, self.load, self.r = GridFunction(X), Parameter(0.0), CF(POSITIONS[: self.dim])
        self.contact = LACContact(u, lam, master="master", tied=True, finite=True, **law)
        self.solver = ContactSolver(a, self.gf, self.contact)

        led = np.array(list(V.GetDofs(mesh.Boundaries(where))))

        def prescribe(gf):
            gf.components[0].vec.FV().NumPy()[led] = self.coefficients(place(self.load.Get()))[led]

        self.stepper = LoadStepper(self.solver, self.load, prescribe=prescribe)

    def run(self, steps):
        self.stepper.Integrate(steps=steps, printing=False, tol=1e-12)

    def error(self, place):
        """Root mean square of the distance from a place."""
        off = GridFunction(self.gf.components[0].space)
        found = self.gf.components[0].vec.FV().NumPy()
        off.vec.FV().NumPy()[:] = self.coefficients(place) - found
        square = Integrate(InnerProduct(off, off), self.mesh) / Integrate(1, self.mesh)
        return np.sqrt(square)

    def coefficients(self, place):
        """Of the displacement to a place; a matrix is a linear map, whose values are exact."""
        gf = GridFunction(self.gf.components[0].space)
        if isinstance(place, np.ndarray):
            points = np.array([v.point for v in self.mesh.vertices]).T
            gf.vec.FV().NumPy().reshape(self.dim, -1)[:, : self.mesh.nv] = place @ points - points
        else:
            gf.Set(place - self.r)
        return gf.vec.FV().NumPy()


def raised(mesh, gap):
    """The upper body is moved up."""
    points = mesh.ngmesh.Points()
    for nr in {v.nr for el in mesh.Materials("upper").Elements() for v in el.vertices}:
        points[nr + 1][2] += gap
    return Mesh(mesh.ngmesh)


def turned(dim, degrees):
    R = rotation(dim, degrees)
    return CF(tuple(R.ravel()), dims=R.shape) * CF(POSITIONS[:dim])


RIGID = {
    "halves": (lambda: halves_mesh(), "rim_lower", 2),
    "halves apart": (lambda: halves_mesh(0.3), "rim_lower", 2),
    "rings of polygons": (lambda: rings_mesh(6, 1), "rim", 1),
    "solids apart": (lambda: raised(blocks3d("hex", "tet"), 0.1), "bottom", 2),
}


@pytest.mark.parametrize(
    "case", [pytest.param(c, marks=pytest.mark.full if c == "halves apart" else ()) for c in RIGID]
)
def test_turned_by_a_right_angle_it_stays_free_of_stress(case):
    """One part is turned, the other follows by the tie alone."""
    make, where, order = RIGID[case]
    mesh = make()
    problem = Tied(mesh, where, lambda load: turned(mesh.dim, 90 * load), order=order)
    problem.run(3)
    size = np.ptp(np.asarray(mesh.ngmesh.Coordinates()), axis=0).max()
    assert problem.error(turned(mesh.dim, 90)) <= 1e-10 * size
    stiffness = 104
    assert np.abs(problem.contact.Table()["traction"]).max() <= 1e-10 * stiffness


SIDES = {
    2: (lambda: blocks2d(0.2, overhang=0.0, angle=15.0), "top|bottom|left_.*|right_.*"),
    3: (
        lambda: blocks3d("hex", "tet", overhang=0.0),
        "top|bottom|left_.*|right_.*|front_.*|back_.*|side.*",
    ),
}


@pytest.mark.parametrize("order", [1, 2])
@pytest.mark.parametrize("dim", SIDES)
def test_patch(dim, order):
    """A homogeneous deformation with large strains and rotations is exact."""
    make, where = SIDES[dim]
    F = rotation(dim, 40) @ (np.eye(dim) + 0.3 * np.triu(np.ones((dim, dim))))

    def place(load):
        return np.eye(dim) + load * (F - np.eye(dim))

    problem = Tied(make(), where, place, order=order)
    problem.run(4)
    assert problem.error(place(1.0)) <= 1e-12
    traction = problem.contact.Table()["traction"]
    assert np.abs(traction - traction[0]).max() <= 1e-12 * np.abs(traction).max()


def bent(**flags):
    """Blocks that are pulled, sheared and turned."""
    lead = lambda t: (0.3 * t, 0.2 * t)  # noqa: E731
    return Led(blocks2d(0.2), lead, turn=lambda t: 60 * t, tied=True, **flags)


def test_newtons_method_is_quadratic():
    problem = bent()
    problem.run(0.5, steps=2)
    problem.solve(0.6, tol=1e-13)
    sizes = [max(e.equilibrium, e.constraint) for e in problem.solver.history]
    assert len(sizes) < 9
    assert sizes[-1] < 100 * sizes[-2] ** 2 + 1e-13


def test_forces_and_moments_of_a_solution_balance():
    """To rounding, although the meshes do not match."""
    problem = bent()
    problem.run(1.0, steps=4, tol=1e-13)
    _, residual = problem.residuals(problem.gf)
    n = problem.reference.size
    forces = residual[:n].reshape(2, -1)
    places = problem.reference + problem.gf.components[0].vec.FV().NumPy().reshape(2, -1)
    size = np.abs(problem.contact.Force()).max()
    assert size > 1
    assert np.sum(forces * problem.nodal(CF((1, 1))), axis=1) == pytest.approx(0, abs=1e-12 * size)
    moment = places @ forces.T
    assert moment[0, 1] == pytest.approx(moment[1, 0], abs=1e-11 * size)


def test_small_loads_are_those_of_small_sliding():
    law = {"tied": True, "push": (1e-4, -1e-4)}
    one, two = press(finite=True, bulk=lambda u, v, t: [neo_hooke(u)], **law), press(**law)
    for problem in (one, two):
        problem.solver().Solve(printing=False)
    found, expected = (p.contact.Force() for p in (one, two))
    assert found == pytest.approx(expected, rel=5e-3)


def test_steps_restarted_and_failed():
    """The partners are those of the beginning."""
    whole, half = bent(), bent()
    whole.run(1.0, steps=4)
    half.run(0.5, steps=2)
    state = half.stepper.State()
    other = bent()
    other.stepper.SetState(state)
    other.run(1.0, steps=2)
    found, expected = (p.gf.vec.FV().NumPy() for p in (other, whole))
    assert found == pytest.approx(expected, abs=1e-9 * np.abs(expected).max())


def test_tied_where_it_has_got_to():
    """Switched on while the bodies are deformed: there is no traction, and then they hold."""
    problem = Led(blocks2d(0.2), lambda t: (0.1 * t, 0.05), turn=lambda t: 30 * t, tied=True)
    problem.contact.Deactivate()
    problem.run(1.0)
    problem.contact.Activate(problem.gf)
    before = problem.gf.vec.FV().NumPy().copy()
    problem.solve(1.0)
    assert problem.contact.Table()["traction"] == pytest.approx(0, abs=1e-9)
    assert problem.gf.vec.FV().NumPy() == pytest.approx(before, abs=1e-9)
    problem.solve(1.5)
    assert np.abs(problem.contact.Force()).max() > 0.1


@pytest.mark.parametrize("finite", [False, True])
def test_a_common_rotation_is_not_held(finite):
    """Of bodies that are apart from each other, which small sliding does not know."""
    V = VectorH1(halves_mesh(0.3), order=2)
    problem = posed(V, elastic(1), tied=True, finite=finite)
    system, X = problem.solver().system, problem.X
    system.PairOnce()
    system.Assemble()
    system.Evaluate()
    motions = np.zeros((X.ndof, 3))
    motions[: V.ndof] = system.bodies.motions
    moved = np.abs(ActiveRows(problem.contact) @ motions).max(axis=0)
    assert moved[:2] == pytest.approx(0, abs=1e-12)
    assert moved[2] < 1e-12 if finite else moved[2] > 1e-2
    assert len(system.WhatFloats()) == 3
