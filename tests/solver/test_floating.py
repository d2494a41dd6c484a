"""Bodies held by contact alone: what holds them, what no contact can balance, what is said."""

import re

import numpy as np
import pytest
from loaded import loaded
from ngsolve import CF, Grad, Integrate, Sym, Trace, dx, x, y
from press import LAME, MU, linear, neo_hooke, numpy, press

from ngslac import ContactConvergenceError, FloatingBodyError, LoadStepper
from ngslac.arrays import AsNumPy, ScalarDofs
from ngslac.bodies.bodies import Bodies
from ngslac.bodies.rigidbalance import RigidBalance
from ngslac.errors import Reason


def stepper(problem, **flags):
    return LoadStepper(problem.solver(), problem.load, **flags)


# --- what contact holds --------------------------------------------------------------------------

COARSE = {"mesh_flags": {"h_master": 0.2}}
GUIDED = {"dirichletx": "left_upper", "dirichlet": "bottom"}
PLANE = {"h": 0.35, "master": None, "obstacle": CF(0.05)}
# Three or four macro-elements are few, a single step from a gap is long.
HELD = [
    *({"gap": gap, "h": h, "friction": F, **COARSE} for gap in (0.0, 0.02, 0.2)
      for h, F in ((0.26, 0.2), (0.35, 1.5))),
    *({"friction": F, **PLANE} for F in (0.2, 1.5)),
    {"gap": 0.01, "friction": 0.5},
]  # fmt: skip


@pytest.mark.parametrize("flags", HELD)
def test_friction_holds_a_body(flags):
    problem = loaded(0, -1, side=0.1, **flags)
    if "h" in flags:
        assert 3 <= problem.contact.space.nmacros <= 4
    steps = stepper(problem).Integrate(steps=1, printing=False)
    assert sum(step.cuts for step in steps) == 0
    assert problem.contact.Force() == pytest.approx([-0.1, 1], abs=1e-10)
    assert np.all(problem.contact.Table()["gap"] > -1e-9)


@pytest.mark.parametrize(
    ("problem", "force"),
    [
        (lambda: loaded(0, -1, flags=GUIDED), 1.0),
        # The master floats; 1.4 is its length with its overhang.
        (lambda: loaded(0, 1, on="bottom", spring=1e3, friction=0.5, flags={"dirichlet": ""}), 1.4),
    ],
)
def test_contact_holds_what_is_guided_and_what_lies_below(problem, force):
    problem = problem()
    problem.solver().Solve(printing=False)
    assert problem.contact.Force() == pytest.approx([0, force], abs=1e-10)


# --- what no contact traction balances -----------------------------------------------------------

FLIES = "body 'upper' is pulled away (translation in y, towards +y): contact can only push"


def test_a_pulled_body_flies_away():
    problem = loaded(0, 1, friction=0.5)
    with pytest.raises(ContactConvergenceError, match=re.escape(FLIES)):
        problem.solver().Solve(printing=False)
    assert not np.any(numpy(problem.gf))


def told(*traction, **flags):
    """What is said of a traction on top of a block held by contact alone."""
    problem = loaded(*traction, **flags)
    a, gf, contact = problem.a, problem.gf, problem.contact
    a.AssembleLinearization(gf.vec)
    contact.Prepare(a.mat)
    contact.Evaluate(gf)
    residual = gf.vec.CreateVector()
    a.Apply(gf.vec, residual)
    bodies = Bodies(a.mat, contact, AsNumPy(ScalarDofs(gf.space.FreeDofs(), gf.space)))
    forces = residual.FV().NumPy()[bodies.first :][: bodies.count]
    return RigidBalance(bodies, [contact]).Find(forces)


LIMIT = "friction is at its limit"
SLIDES, TURNS = "body 'upper' slides away", f"body 'upper' turns (rotation about z): {LIMIT}"


def aside(size, angle):
    return size * np.cos(angle), size * np.sin(angle), -1


def couple(size):
    return size * (0.5 - y), size * (x - 0.5), -1


@pytest.mark.parametrize(
    ("law", "balanced", "beyond", "words"),
    [
        *(
            (law, (0.1999 * side, -1), (0.2001 * side, -1),
             f"{SLIDES} (translation in x, towards {sign}x): {LIMIT}")
            for law in ({"friction": 0.2}, {"tresca": 0.2})
            for side, sign in ((-1, "-"), (1, "+"))
        ),
        # The cone is replaced by a polygon around it, half a per cent wider at most.
        *(
            (law, aside(0.199, angle), aside(0.202, angle), SLIDES)
            for law in ({"friction": 0.2}, {"tresca": 0.2})
            for angle in (0.0, 0.3, 2.5)
        ),
        # Pressures are constant on macro-elements: the outermost one has its middle within.
        ({"friction": 2.0}, (0.999 * 0.375, -1), (1.001 * 0.375, -1), "tips over (rotation)"),
        ({"friction": 0.1}, couple(0.2), couple(1), TURNS),
        ({"friction": None}, (0, 0), (0, 0.1), FLIES),
        ({"friction": 0.3}, (0, 0), (0, 0.1), FLIES),
        ({"tied": True}, (0.3, 1), None, ""),
        # Guides hold what pulls; with friction they may jam under any load.
        ({"bilateral": True}, (0, 1), (0.1, 1), SLIDES),
        ({"bilateral": True, "friction": 0.2}, (5.0, 1), None, ""),
        ({"bilateral": True, "tresca": 0.2}, (-0.1999, 0), (-0.2001, 0), SLIDES),
    ],
)  # fmt: skip
def test_loads_are_balanced_up_to_the_limit(law, balanced, beyond, words):
    assert told(*balanced, dim=len(balanced), **law) == ""
    if beyond:
        assert words in told(*beyond, dim=len(beyond), **law)


def test_bodies_that_are_held_are_balanced_whatever_pulls():
    assert told(0, 5, spring=1000.0) == ""


def test_a_body_is_lost_when_it_goes_far_as_a_rigid_one():
    problem = loaded(0, -1)
    problem.a.AssembleLinearization(problem.gf.vec)
    free = AsNumPy(ScalarDofs(problem.gf.space.FreeDofs(), problem.gf.space))
    bodies, values = Bodies(problem.a.mat, problem.contact, free), np.zeros(len(free))
    [(part, _)] = bodies.floating
    own = bodies.first + np.flatnonzero(bodies.part == part)
    values[own] = 3 * bodies.size * bodies.motions[bodies.part == part, 0]
    assert bodies.Lost(values) == ["body 'upper' moves off (translation in x)"]
    assert not bodies.Lost(0.1 * values)


# --- steps to the limit --------------------------------------------------------------------------


def counted(solver):
    """The numbers of linear systems of its further solves, one for each attempt."""
    solve, systems = solver.Solve, []

    def Solve(**flags):
        try:
            return solve(**flags)
        finally:
            systems.append(len(solver.history) - 1)

    solver.Solve = Solve
    return systems


@pytest.mark.parametrize(
    ("steps", "said"),
    [
        (1, r"the step from load 0 to 1 fails: .*; up to a load of 0\.5 there is one$"),
        (3, r"fails: .*; up to a load of 0\.5 there is one$"),
        (10, r"the step from load 0\.5 to 0\.6 fails"),
    ],
)
def test_steps_end_at_the_limit_of_friction_and_say_where(steps, said):
    """Friction carries half of the load; what fails is the load at the end of a long step."""
    problem = loaded(0, -1, side=0.2, friction=0.1)
    tool = stepper(problem)
    systems = counted(tool.solver)
    with pytest.raises(ContactConvergenceError, match=said) as error:
        tool.Integrate(steps=steps, printing=False)
    assert f"no equilibrium: {SLIDES} (translation in x, towards +x): {LIMIT}" in str(error.value)
    assert len(systems) < 25
    if steps == 10:
        assert 0.5 - 0.1 / 2**8 <= problem.load.Get() <= 0.5 + 1e-9
    else:
        tool.Integrate(0.49, steps=1, printing=False)
    expected = -0.2 * problem.load.Get()
    assert problem.contact.Force()[0] == pytest.approx(expected, rel=1e-8)


@pytest.mark.parametrize("finite", [False, True])
def test_a_load_beyond_friction_ends_after_few_systems(finite):
    problem = loaded(0, -1, side=0.15, friction=0.1, finite=finite, nonlinear=finite)
    tool = stepper(problem)
    systems = counted(tool.solver)
    with pytest.raises(FloatingBodyError, match="'upper' slides away") as error:
        tool.Integrate(steps=2, printing=False)
    assert Reason.EXHAUSTED in error.value.reason
    assert (Reason.CERTAIN in error.value.reason) != finite
    with pytest.warns(DeprecationWarning, match="Reason.CERTAIN"):
        assert error.value.certain != finite
    assert sum(systems) < (150 if finite else 30)


# --- loads that are in balance -------------------------------------------------------------------


def stretched(dim, nonlinear, *, sign=1, **law):
    """A loose block stretched, or squeezed, by stresses that are the same everywhere."""

    def bulk(u, v, load):
        rest = [neo_hooke(u) if nonlinear else linear(u, v)]
        return [*rest, -0.5 * sign * load * Trace(Grad(v)) * dx("upper")]

    return press(dim=dim, spring=0, bulk=bulk, **law)


@pytest.mark.pairwise
@pytest.mark.parametrize("offset", [None, 0.01])
@pytest.mark.parametrize("sign", [1, -1])
@pytest.mark.parametrize("finite", [False, True])
@pytest.mark.parametrize("friction", [None, 0.3])
@pytest.mark.parametrize("nonlinear", [False, True])
@pytest.mark.parametrize("dim", [2, 3])
def test_a_loose_block_under_loads_in_balance(dim, nonlinear, sign, friction, finite, offset):
    """Nothing pushes it: it keeps its shape under the stress, wherever it stays, in each step."""
    law = {"friction": friction, "finite": finite, "offset": offset}
    problem = stretched(dim, nonlinear, sign=sign, **law)
    problem.load.Set(0)
    steps = stepper(problem).Integrate(steps=3, printing=False)
    assert sum(step.cuts for step in steps) == 0
    strain = Sym(Grad(problem.gf.components[0]))
    if nonlinear:
        strain += 0.5 * Grad(problem.gf.components[0]).trans * Grad(problem.gf.components[0])
    upper = problem.mesh.Materials("upper")
    mean = Integrate(Trace(strain), upper) / Integrate(1, upper)
    expected = 0.5 * dim * sign / (2 * MU + dim * LAME)
    assert mean == pytest.approx(expected, rel=0.05 if nonlinear else 1e-6)
    assert np.abs(problem.contact.Force()).max() < 1e-6
