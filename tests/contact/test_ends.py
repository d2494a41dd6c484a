"""Contact that ends inside of macro-elements: where a beam rests with its end on another one."""

import numpy as np
import pytest
from beams import LENGTH, beams
from blocks import residual
from ngsolve import CF, GridFunction, x, y, z

from ngslac import AugmentedLagrangianSolver
from ngslac.meshes import TwoBlocks

# Deflection of the upper beam's end by its overlap with the lower one, times 1000: order 3, 32 x 4
# cells in each beam, halved 10 times towards the ends, where even pressures of macro-elements of
# 3e-5 tell no other number.
TIPS = {0.2: -4.51367, 0.25: -3.96449, 0.3: -3.42331, 0.5: -1.52906}
# In 3D of order 2, 12 x 2 x 1 cells, halved 6 times.
TIPS_3D = {0.2: -4.861, 0.25: -4.263}
SLAVES = ["under", "over"]


def solved(**flags):
    problem = beams(**{"edges": True} | flags)
    problem.solver.Solve(printing=False)
    return problem


def tip(**flags):
    return 1e3 * solved(**flags).Tip()


@pytest.mark.parametrize("slave", SLAVES)
@pytest.mark.parametrize("overlap", TIPS)
def test_eight_elements(overlap, slave):
    """Within 5 %, whichever beam is the slave; even pressures are off by 11 to 47 %."""
    assert tip(overlap=overlap, slave=slave) == pytest.approx(TIPS[overlap], rel=0.05)


@pytest.mark.parametrize(("overlap", "slave"), [(0.2, "over"), (0.25, "under")])
def test_eight_elements_3d(overlap, slave):
    assert tip(dim=3, overlap=overlap, slave=slave) == pytest.approx(TIPS_3D[overlap], rel=0.05)


@pytest.mark.full
@pytest.mark.parametrize("slave", ["under", pytest.param("over", marks=pytest.mark.full)])
def test_a_corner_passes_over_macro_elements(slave):
    """The shorter the overlap is, the farther the beam bends: without a jump, nowhere back."""
    tips = np.array([tip(overlap=overlap, slave=slave) for overlap in np.linspace(0.24, 0.4, 33)])
    steps = np.diff(tips)
    assert np.all(steps > 0)
    assert np.max(steps) < 2 * np.median(steps)


@pytest.mark.parametrize("flags", [{}, {"friction": 0.3}])
def test_other_solvers(flags):
    """The same solution by multipliers outside, after condensation, and by an interior point."""
    expected = tip(overlap=0.2, slave="over", **flags)
    other = tip(overlap=0.2, slave="over", solver=AugmentedLagrangianSolver, **flags)
    assert other == pytest.approx(expected, rel=1e-8)


def rigid(problem, motion):
    """Coefficients of a motion of both bodies."""
    gf = GridFunction(problem.gf.space)
    gf.components[0].Set(motion)
    return gf.vec.FV().NumPy()


@pytest.mark.parametrize("slave", SLAVES)
@pytest.mark.parametrize("dim", [2, 3])
def test_action_and_reaction(dim, slave):
    """Forces and moments on both beams are opposite, those on the slave are the resultants."""
    problem = solved(dim=dim, overlap=0.2, slave=slave, friction=0.4)
    contact, force = problem.contact, problem.contact.Force()
    rows = -residual(contact, problem.gf.vec.FV().NumPy())
    size, own = np.linalg.norm(force), {"under": "upper", "over": "lower"}[slave]
    slave_only = problem.mesh.MaterialCF({own: 1.0}, default=0.0)
    for k in range(dim):
        along = np.eye(dim)[k]
        assert abs(rows @ rigid(problem, CF(tuple(along)))) <= 1e-12 * size
        parts = CF(tuple(along)) * slave_only
        assert rows @ rigid(problem, parts) == pytest.approx(force[k], abs=1e-10 * size)
    turn = CF((-y, x)) if dim == 2 else CF((z, 0, -x))
    moment = contact.Moment() if dim == 2 else contact.Moment()[1]
    assert abs(rows @ rigid(problem, turn)) <= 1e-10 * size
    assert rows @ rigid(problem, turn * slave_only) == pytest.approx(moment, abs=1e-10 * size)


def test_the_force_is_at_the_end():
    """Even pressures of the last macro-element have their resultant in its middle."""
    problem = solved(overlap=0.2, slave="over")
    arm = problem.contact.Moment() / problem.contact.Force()[1]
    assert LENGTH - 0.01 < arm < LENGTH


@pytest.mark.parametrize("overhang", [0.0, 0.3, -0.3])
def test_matching_ends_are_none(overhang):
    """Where both bodies end at the same place the pressure does not go to the end."""
    mesh = TwoBlocks(0.25, overhang=overhang, structured=True, aligned=False)
    problem = beams(mesh=mesh, slave="slave", master="master", edges=True)
    problem.contact.Update()
    ends = problem.contact.form.Table()["ends"]
    assert np.all(ends == 0) == (overhang == 0)


def test_state_of_a_contact():
    """Resultants are those of the saved state before anything is evaluated."""
    problem = solved(overlap=0.2, slave="over")
    state, moment = problem.contact.State(), problem.contact.Moment()
    other = beams(overlap=0.2, slave="over", edges=True)
    other.contact.SetState(state)
    assert other.contact.Moment() == pytest.approx(moment, rel=1e-14)


def test_switched_off():
    """No forces, and the same ones after it was switched on again."""
    problem = solved(overlap=0.2, slave="over")
    before = problem.Tip()
    problem.contact.Deactivate()
    problem.solver.Solve(printing=False)
    assert np.all(problem.contact.Force() == 0)
    problem.contact.Activate()
    problem.solver.Solve(printing=False)
    assert problem.Tip() == pytest.approx(before, rel=1e-8)


def test_even_pressures_by_default():
    """Twice a mesh that is eight times finer would be needed."""
    assert abs(tip(overlap=0.2, slave="under", edges=False) / TIPS[0.2] - 1) > 0.1


@pytest.mark.parametrize("law", [{"finite": True}, {"tied": True}, {"bilateral": True}])
def test_what_has_even_pressures_refuses_edges(law):
    with pytest.raises(ValueError, match="edges need small sliding on a master"):
        beams(edges=True, **law)


@pytest.mark.parametrize("dim", [2, 3])
def test_condensation_does_not_change_it(dim):
    one, other = (
        tip(dim=dim, order=3, overlap=0.2, slave="over", condense=c) for c in (False, True)
    )
    assert one == pytest.approx(other, rel=1e-8)
