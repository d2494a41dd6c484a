"""Loads that no contact traction balances: how exact the limit is, and what is said."""

import numpy as np
import pytest
from ngsolve import CF, GridFunction, InnerProduct, VectorH1, ds, x, y
from press import press, press3d

from ngslac import ContactConvergenceError, FloatingBodyError, LoadStepper
from ngslac.arrays import AsNumPy, ScalarDofs
from ngslac.bodies.bodies import Bodies
from ngslac.bodies.rigidbalance import RigidBalance
from ngslac.bodies.rigidmotions import RigidMotions, Turned


def told(traction, make=press, **flags):
    """What is said of a traction on top of a block held by contact alone."""
    problem = make(spring=0, **flags)
    a, gf, contact = problem.a, problem.gf, problem.contact
    a += -InnerProduct(CF(traction), problem.X.TestFunction()[0]) * ds("top")
    a.AssembleLinearization(gf.vec)
    contact.Prepare(a.mat)
    contact.Evaluate(gf)
    residual = gf.vec.CreateVector()
    a.Apply(gf.vec, residual)
    bodies = Bodies(a.mat, contact, AsNumPy(ScalarDofs(gf.space.FreeDofs(), gf.space)))
    forces = residual.FV().NumPy()[bodies.first :][: bodies.count]
    return RigidBalance(bodies, [contact]).Find(forces)


@pytest.mark.parametrize("side", [-1, 1])
@pytest.mark.parametrize("law", [{"friction": 0.2}, {"tresca": 0.2}])
def test_a_block_slides_from_the_limit_on(side, law):
    assert told((0.1999 * side, -1.0), **law) == ""
    said = told((0.2001 * side, -1.0), **law)
    assert f"body 'upper' slides away (translation in x, towards {'-+'[side > 0]}x)" in said
    assert "friction is at its limit" in said


def test_a_block_tips_over_from_the_limit_on():
    """Pressures are constant on macro-elements: the outermost one has its middle within."""
    length = 1 / press(friction=2.0).contact.space.nmacros
    limit = (1 - length) / 2  # the block is 1 wide and 1 high
    assert told((0.999 * limit, -1.0), friction=2.0) == ""
    assert "'upper' tips over (rotation)" in told((1.001 * limit, -1.0), friction=2.0)


@pytest.mark.parametrize("friction", [None, 0.3])
def test_a_block_is_pulled_away(friction):
    said = told((0.0, 0.1), friction=friction)
    assert "'upper' is pulled away (translation in y, towards +y): contact can only push" in said


def test_loads_that_pull_on_tied_surfaces_are_balanced():
    assert told((0.3, 1.0), tied=True) == ""
    assert told((0.0, 0.0), friction=0.3) == ""  # nothing pushes


@pytest.mark.parametrize("law", [{"friction": 0.2}, {"tresca": 0.2}])
@pytest.mark.parametrize("angle", [0.0, 0.3, 2.5])
def test_a_block_slides_in_any_direction(angle, law):
    """The cone is replaced by a polygon around it, half a per cent wider at most."""
    way = np.array([np.cos(angle), np.sin(angle)])
    assert told((*(0.199 * way), -1.0), press3d, **law) == ""
    assert "'upper' slides away" in told((*(0.202 * way), -1.0), press3d, **law)


def test_a_couple_turns_a_block():
    couple = CF((-(y - 0.5), x - 0.5, -1.0))
    assert told(couple, press3d, friction=0.5) == ""
    said = told(couple, press3d, friction=0.1)
    assert "body 'upper' turns (rotation about z): friction is at its limit" in said


@pytest.mark.parametrize("make", [press, press3d])
def test_rotations_of_a_deformed_mesh(make):
    mesh = make(friction=0.1).mesh
    space, d = VectorH1(mesh, order=2), mesh.dim
    motions, _, size = RigidMotions(space)
    points = np.asarray(mesh.ngmesh.Coordinates())[: mesh.nv, :d]
    center = points.mean(axis=0)
    u = GridFunction(space)
    u.Set(CF((0.3 * x - y, x**2, 0.2 * x * y)[:d]))
    expected = GridFunction(space)
    arms = [
        (c + u[k] - center[k]) / size for k, c in enumerate((x, y))
    ]  # of a rotation about z, or in the plane
    expected.Set(CF((-arms[1], arms[0], 0.0)[:d]))
    found = (motions + Turned(space, u.vec.FV().NumPy(), size))[:, -1]
    assert found == pytest.approx(expected.vec.FV().NumPy(), abs=1e-9)


@pytest.mark.parametrize("finite", [False, True])
def test_a_load_beyond_friction_ends_after_few_systems(finite):
    problem = press(spring=0, friction=0.1, finite=finite, nonlinear=finite)
    pull = problem.load * CF((0.15, -1.0))
    problem.a += -InnerProduct(pull, problem.X.TestFunction()[0]) * ds("top")
    problem.load.Set(0.0)
    solver, systems = problem.solver(), []
    stepper = LoadStepper(solver, problem.load)
    solver.Solve = counted(solver.Solve, solver, systems)
    with pytest.raises(ContactConvergenceError, match="'upper' slides away") as error:
        stepper.Integrate(steps=2, printing=False)
    assert isinstance(error.value, FloatingBodyError)
    assert error.value.exhausted
    assert error.value.certain != finite
    assert sum(systems) < (150 if finite else 30)


def counted(solve, solver, systems):
    def Solve(**flags):
        try:
            return solve(**flags)
        finally:
            systems.append(len(solver.history) - 1)

    return Solve
