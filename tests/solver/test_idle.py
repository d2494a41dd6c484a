"""Motions that nothing resists and nothing drives: they stay as they are, and are named."""

import re
import warnings

import numpy as np
import pytest
from ngsolve import CF
from resting import resting

from ngslac import FloatingBodyError
from ngslac.errors import ContactWarning

SOLVERS = ["interface", "direct", "iterative"]
LENGTHS = [1e-6, 1e-3, 1.0, 1e3, 1e6]


def quietly(problem):
    """The displacements, and what was said on the way."""
    with warnings.catch_warnings(record=True) as told:
        warnings.simplefilter("always")
        u = problem.solve().copy()
    return u, [str(t.message) for t in told if issubclass(t.category, ContactWarning)]


@pytest.mark.parametrize("seed", [None, 1, 2])
@pytest.mark.parametrize("gap", [0.0, 1e-9, 1e-3])
@pytest.mark.parametrize("dim", [2, 3])
def test_a_block_at_rest_stays_in_any_frame(dim, gap, seed):
    """It sinks onto the base, and does not drift along it."""
    problem = resting(dim, gap=gap, seed=seed)
    _, told = quietly(problem)
    assert np.abs(problem.mean()[:-1]).max() < 1e-9
    expected = (0.0,) * (dim - 1) + (1.0,)
    assert problem.force() == pytest.approx(expected, abs=1e-8)
    assert any("'upper' is free (" in text for text in told)


@pytest.mark.parametrize("length", LENGTHS)
@pytest.mark.parametrize("dim", [2, 3])
def test_units_do_not_show(dim, length):
    """The same strains, and the same words."""
    seed = 3
    first, problem = (
        resting(dim, gap=1e-3, seed=seed),
        resting(dim, gap=1e-3, seed=seed, length=length),
    )
    u, told = quietly(problem)
    expected, said = quietly(first)
    assert u == pytest.approx(expected, abs=1e-9)
    assert told == said


@pytest.mark.parametrize("gap", [0.0, 1e-3])
@pytest.mark.parametrize("dim", [2, 3])
def test_all_linear_solvers_leave_the_same_state(dim, gap):
    states = [quietly(resting(dim, gap=gap, seed=5, solver=way)) for way in SOLVERS]
    for way, (u, told) in zip(SOLVERS, states, strict=True):
        assert u == pytest.approx(states[0][0], abs=1e-8), way
        assert told == states[0][1], way


@pytest.mark.parametrize("dim", [2, 3])
def test_the_warning_names_each_motion(dim):
    """Flat contact leaves all motions along the plane: one in 2D, three in 3D."""
    _, told = quietly(resting(dim))
    (text,) = [text for text in told if "is free" in text]
    assert len(re.findall(r"'upper' is free", text)) == {2: 1, 3: 3}[dim]
    assert "'lower'" not in text


@pytest.mark.parametrize("dim", [2, 3])
def test_nothing_is_said_of_what_friction_holds(dim):
    _, told = quietly(resting(dim, friction=0.3))
    assert not any("is free" in text for text in told)


@pytest.mark.parametrize("length", [1e-6, 1.0, 1e6])
@pytest.mark.parametrize("share", [1.0, 1e-2, 1e-4, 1e-6])
@pytest.mark.parametrize("dim", [2, 3])
def test_a_load_that_drives_is_an_error_however_small(dim, share, length):
    """A part of the load along the plane does work on a motion that nothing resists."""
    load = (share,) + (0.0,) * (dim - 2) + (-1.0,)
    problem = resting(dim, load=load, seed=7, length=length)
    with pytest.raises(FloatingBodyError, match="'upper'"):
        quietly(problem)


@pytest.mark.parametrize("dim", [2, 3])
def test_it_stays_where_the_step_began(dim):
    """A drift that is there at the start is kept, and is not carried back to zero."""
    problem = resting(dim, seed=9)
    gf, along = problem.gf.components[0], problem.rotation[:, 0] * 1e-3
    gf.Set(problem.mesh.MaterialCF({"upper": CF(tuple(along))}, default=CF((0,) * dim)))
    quietly(problem)
    assert problem.mean()[0] == pytest.approx(1e-3, abs=1e-9)
