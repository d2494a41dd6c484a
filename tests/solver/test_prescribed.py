"""Dirichlet values that depend on the load."""

import numpy as np
import pytest
from ngsolve import CF, H1, GridFunction, VectorH1, cos, sin, x, y
from press import numpy, press

from ngslac import LoadStepper

PUSH = CF((0.01, -0.02))
FAR = CF((0.3, -0.2))


def driven(prescribe=None, **flags):
    """A press, its stepper, and what the middle of the top has moved; `prescribe(load)`."""
    problem = press(**{"friction": 0.4, "spring": 0, "flags": {"dirichlet": "bottom|top"}} | flags)
    problem.load.Set(0)
    given = prescribe(problem.load) if prescribe else None
    stepper = LoadStepper(problem.solver(), problem.load, prescribe=given)
    return problem, stepper, lambda: problem.gf.components[0](problem.mesh(0.5, 1))


def blocks(mesh, **flags):
    return H1(mesh, dim=2, **flags)


@pytest.mark.parametrize("space", [VectorH1, blocks])
def test_a_displacement_for_a_region(space):
    problem, stepper, top = driven(lambda t: {"top": t * PUSH}, space=space)
    seen = []
    stepper.Integrate(steps=4, printing=False, callback=lambda step: seen.append(top()))
    expected = np.outer([0.25, 0.5, 0.75, 1], [0.01, -0.02])
    assert np.array(seen) == pytest.approx(expected, rel=1e-12)
    assert problem.contact.Force()[1] > 0.5


@pytest.mark.parametrize("clears", [False, True])
def test_dict_and_callable_give_the_same(clears):
    """GridFunction.Set with definedon sets all other dofs to zero: what is free is put back."""
    problem, stepper, _ = driven(lambda t: {"top": t * CF((0.01 * x, -0.02))})
    other, called, _ = driven()
    V, top = other.X.components[0], other.mesh.Boundaries("top")
    field, dofs = GridFunction(V), np.array([bool(b) for b in V.GetDofs(top)])

    def prescribe(gf):
        target = gf.components[0] if clears else field
        target.Set(other.load * CF((0.01 * x, -0.02)), definedon=top)
        gf.components[0].vec.FV().NumPy()[dofs] = numpy(target)[dofs]

    called.prescribe = prescribe
    ways = [tool.Integrate(steps=3, printing=False) for tool in (stepper, called)]
    assert numpy(problem.gf) == pytest.approx(numpy(other.gf), abs=1e-13)
    assert [s.iterations for s in ways[0]] == [s.iterations for s in ways[1]]


def test_only_constrained_components_are_set():
    """The sliding guide at the top holds x; what the user says of y does not count."""
    guide = {"dirichletx": "top", "dirichlet": "bottom"}
    flags = {"flags": guide, "spring": 10.0, "nonlinear": True}
    _, stepper, top = driven(lambda t: {"top": CF((0.01 * t, 99))}, **flags)
    stepper.Integrate(steps=1, printing=False)
    ux, uy = top()
    assert ux == pytest.approx(0.01, rel=1e-12)
    assert abs(uy) < 0.1


@pytest.mark.sample(1)
@pytest.mark.parametrize("condense", [False, True])
def test_a_motion_beyond_the_size_of_the_elements(condense):
    """The top moves by several elements in one step: set at once, it turns them inside out."""
    flags = {"nonlinear": True, "h": 0.1, "condense": condense, "friction": None}
    ends = []
    for n in (1, 4):
        problem, stepper, top = driven(lambda t: {"top": t * FAR}, **flags)
        steps = stepper.Integrate(steps=n, printing=False)
        assert [s.cuts for s in steps] == [0] * n
        assert top() == pytest.approx((0.3, -0.2), rel=1e-12)
        ends.append(numpy(problem.gf))
    assert ends[0] == pytest.approx(ends[1], abs=1e-8)


@pytest.mark.parametrize("space", ["whole", "by components"])
@pytest.mark.parametrize("turned", [False, True])
def test_a_corner_takes_of_each_side_what_that_constrains(turned, space):
    """The sides are held in y, the top in x, too: no matter in which order they come."""
    if space == "whole":
        flags = {"dirichlet": "bottom|top", "dirichlety": "left_upper|right_upper"}
    else:
        sides = "bottom|top|left_upper|right_upper"
        flags = {"dirichletx": "bottom|top", "dirichlety": sides}

    def sides_and_top(t):
        given = {"top": t * PUSH, "left_upper|right_upper": t * CF((7, -0.02 * y))}
        return dict(reversed(given.items())) if turned else given

    problem, stepper, _ = driven(sides_and_top, flags=flags)
    assert set(flags["dirichlety"].split("|")) & set(problem.mesh.GetBoundaries())
    stepper.Integrate(steps=1, printing=False)
    u, mesh = problem.gf.components[0], problem.mesh
    for corner in (1e-9, 1 - 1e-9):
        assert u(mesh(corner, 1 - 1e-9)) == pytest.approx((0.01, -0.02), abs=1e-8)


def test_a_large_rotation():
    """Both bodies turn by a right angle in two steps: the Newton steps carry it."""

    def turned(t):
        a = np.pi / 2 * t
        spin = CF((cos(a) * x - sin(a) * y - x, sin(a) * x + cos(a) * y - y))
        return {"top": spin, "bottom": spin}

    problem, stepper, top = driven(turned, nonlinear=True, friction=None, finite=True)
    stepper.Integrate(steps=2, printing=False)
    assert top() == pytest.approx(np.array([-1, 0.5]) - [0.5, 1], abs=1e-12)
    assert problem.contact.Table()["pressure"] == pytest.approx(0, abs=1e-8)


def test_solve_with_a_motion_ends_where_it_should():
    problem, _, _ = driven(nonlinear=True)
    fixed = np.array([not b for b in problem.X.FreeDofs()])
    motion = np.where(fixed, 0.0, 7.0)  # what is free does not count
    top = problem.X.components[0].GetDofs(problem.mesh.Boundaries("top"))
    dofs = np.flatnonzero([bool(b) for b in top])
    motion[dofs[dofs < problem.mesh.nv]] = 0.03
    solver = problem.solver()
    assert solver.Merit() is None
    solver.Solve(printing=False, motion=motion)
    assert numpy(problem.gf)[fixed] == pytest.approx(motion[fixed], abs=1e-15)
    assert solver.Merit() < 1e-8
