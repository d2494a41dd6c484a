"""Saved and continued in a new process: the same as without interruption."""

import subprocess
import sys
import warnings
from pathlib import Path

import continued
import numpy as np
import pytest
from interrupts import same, seen
from motions import values
from ngsolve import GridFunction, IfPos, Parameter, x
from press import press
from refused import check_refused

from ngslac import ContactConvergenceError, ContactWarning, LoadState, LoadStepper, SaveState


@pytest.fixture(scope="module")
def ends(tmp_path_factory):
    """End values of each kind: without interruption, and continued in a new process."""
    folder, expected = tmp_path_factory.mktemp("states"), {}
    for kind, make in continued.MAKE.items():
        stepper = continued.half(make())
        SaveState(folder / kind, stepper)
        expected[kind] = continued.outcome(continued.half(stepper, 2))
    home = Path(continued.__file__).parent
    subprocess.run([sys.executable, "continued.py", folder], check=True, cwd=home)
    return {kind: (expected[kind], np.load(folder / f"{kind}.npz")) for kind in expected}


@pytest.mark.parametrize("kind", continued.MAKE)
def test_continued_in_a_new_process(kind, ends):
    expected, found = ends[kind]
    assert np.any(expected["status"] > 0)
    # The velocities come from dense products, whose last digit depends on where arrays lie; from
    # there the runs agree to the tolerance of the solver.
    rounding = 1e-10 if kind in ("bouncing", "flying") else 0
    for name, value in expected.items():
        assert found[name] == pytest.approx(value, rel=rounding, abs=rounding, nan_ok=True), name


def test_history_matters():
    """On the way back the surfaces stick where they have slid to: the solution alone is not all."""
    stepper, other = continued.loading(), continued.loading()
    stepper.Integrate(1.0, steps=4, printing=False)
    other.solver.gf.vec.data = stepper.solver.gf.vec
    other.load.Set(1.0)
    for tool in (stepper, other):
        tool.Integrate(0.9, steps=1, printing=False)
    assert np.abs(values(stepper.solver.gf) - values(other.solver.gf)).max() > 1e-3


def test_state_of_a_solver_and_of_what_belongs_to_it(tmp_path):
    solver = continued.half(continued.loading()).solver
    strain, speed = GridFunction(solver.gf.space), Parameter(3.5)
    strain.vec[:] = 0.25
    also = {"strain": strain, "speed": speed, "vector": strain.vec}
    before = values(solver.gf)
    SaveState(tmp_path / "state", solver, also=also)
    strain.vec[:] = solver.gf.vec[:] = 0
    speed.Set(0)
    LoadState(tmp_path / "state", solver, also=also)
    assert np.all(values(strain) == 0.25)
    assert speed.Get() == 3.5
    assert np.array_equal(values(solver.gf), before)
    assert values(solver.contacts[0].pressure).max() > 0


# --- what does not fit ---------------------------------------------------------------------------


def deformed(stepper):
    stepper.shape = GridFunction(stepper.solver.gf.space.components[0])  # keep it
    stepper.shape.vec[:] = 0.01
    stepper.solver.gf.space.mesh.SetDeformation(stepper.shape)
    return stepper


A, B = Parameter(1), Parameter(2)
REFUSED = [
    ("LoadState(file, tool.solver, also={'a': A, 'b': B})", "another tool"),
    ("LoadState(file, cubic, also={'a': A, 'b': B})", "another displacement and mesh"),
    ("LoadState(file, wide, also={'a': A, 'b': B})", "another displacement and mesh"),
    ("LoadState(file, tool, also={'c': A})", "names in also"),
    ("LoadState(file, tool, also={'a': A, 'b': tool.solver.gf})", "another kind or size of b"),
    ("LoadState(file, finite, also={'a': A, 'b': B})", "another kind of contact: small .* finite"),
    ("LoadState(file, deformed(tool), also={'a': A, 'b': B})", "another displacement and mesh"),
    ("SaveState(file, 'stepper')", "tool = 'stepper' is a str: give a LoadStepper", TypeError),
    ("SaveState(file, tool, also={'s': 1.0})", r"also\['s'\] = 1.0 is neither a Grid", TypeError),
    ("SaveState(file, tool, also=3)", "also = 3 must be a dict", TypeError),
]


def test_what_does_not_fit_is_refused_and_changes_nothing(tmp_path):
    tool = continued.half(continued.loading(nonlinear=False))
    finite = continued.half(continued.loading(nonlinear=False, finite=True))
    cubic = continued.loading(nonlinear=False, order=3)
    wide = continued.loading(nonlinear=False)
    wide.solver.gf.space.mesh.ngmesh.Scale(1.01)  # same elements
    SaveState(tmp_path / "state", tool, also={"a": A, "b": B})
    names = {"tool": tool, "finite": finite, "cubic": cubic, "file": tmp_path / "state"}
    names |= {"wide": wide, "deformed": deformed, "A": A, "B": B}
    before = seen(tool), seen(finite)
    for row in REFUSED:
        check_refused(row, **names)
        assert same(before[1], seen(finite)) == set(before[1])
    deformed(tool).solver.gf.space.mesh.UnsetDeformation()
    assert same(before[0], seen(tool)) == set(before[0])


# --- the next step -------------------------------------------------------------------------------


def test_steps_after_cuts(tmp_path):
    """Between 0.25 and 0.4 steps above 0.06 do not converge."""
    last = [0.0]

    def make():
        def prescribe(_):
            if 0.25 < stepper.load.Get() <= 0.4 and stepper.load.Get() - last[0] > 0.06:
                raise ContactConvergenceError("hard")

        stepper = continued.loading(nonlinear=False)
        stepper.prescribe = prescribe
        return stepper

    def callback(step):
        last[0] = step.time

    stepper, other = make(), make()
    done = stepper.Integrate(0.4, steps=2, printing=False, callback=callback)
    assert max(step.cuts for step in done) > 0
    SaveState(tmp_path / "state", stepper)
    LoadState(tmp_path / "state", other)
    ways = [s.Integrate(1.0, steps=1, printing=False) for s in (stepper, other)]
    assert len(ways[0]) > 1
    assert ways[0] == ways[1]
    assert same(seen(stepper), seen(other)) == set(seen(stepper))


def test_methods_that_were_given_up(tmp_path):
    """A linear solver that has learnt what does not work goes on without it."""
    used, fresh, other = (slid(solver="iterative") for _ in range(3))
    used.solver.linear.failures["iterative"] = 2  # in a row
    for stepper, method in ((used, "direct"), (fresh, "iterative")):
        SaveState(tmp_path / "state", stepper)
        LoadState(tmp_path / "state", other)
        assert other.solver.linear.method == method


# --- another law ---------------------------------------------------------------------------------


def slid(load=0.0, solver=None, **law):
    """A stepper for a block that is pressed down and aside."""
    problem = press(h=0.5, **({"friction": 0.5} | law))
    problem.load.Set(load)
    return LoadStepper(problem.solver(solver=solver), problem.load)


@pytest.fixture(scope="module")
def saved(tmp_path_factory):
    stepper, file = slid(), tmp_path_factory.mktemp("law") / "state"
    stepper.Integrate(1, steps=2, printing=False)
    SaveState(file, stepper)
    return file


@pytest.mark.parametrize(
    ("law", "words"),
    [
        ({"friction": 0.1}, "friction = 0.1 where the saved state has 0.5"),
        ({"friction": None}, "friction = None where the saved state has 0.5"),
        ({"friction": IfPos(x - 0.5, 0.5, 0.4)}, "friction = 0.4 where the saved state has 0.5"),
        ({"tresca": 2.0}, "tresca = 2 where the saved state has None"),
        ({"offset": 0.01}, "offset = 0.01 where the saved state has 0"),
        ({"maxdist": 0.5}, "maxdist = 0.5 where the saved state has None"),
        ({"penetration": 0.5}, "penetration = 0.5 where the saved state has None"),
    ],
)
def test_another_law_is_told(saved, law, words):
    with pytest.warns(ContactWarning, match=words):
        LoadState(saved, slid(**law))
    other = slid(**law)
    other.solver.contacts[0].Update()
    before = seen(other)
    with warnings.catch_warnings():
        warnings.simplefilter("error", ContactWarning)
        with pytest.raises(ContactWarning):
            LoadState(saved, other)
    assert same(before, seen(other)) == set(before)


@pytest.mark.parametrize(
    "law", [{"friction": None, "tied": True}, {"bilateral": True}, {"edges": True}]
)
def test_another_kind_of_contact_is_refused(saved, law):
    with pytest.raises(ValueError, match=r"has another kind of contact: .* on a master there"):
        LoadState(saved, slid(**law))


def test_a_law_that_depends_on_the_load_is_the_same(tmp_path):
    """Its Parameter has another value before the state is loaded."""
    share = Parameter(0.0)

    def made():
        problem = press(h=0.5, friction=0.2 + 0.3 * share, offset=-1e-3 * share)
        problem.load.Set(0)
        return LoadStepper(problem.solver(), problem.load)

    stepper = made()
    share.Set(0.7)
    stepper.Integrate(1, steps=1, printing=False)
    SaveState(tmp_path / "state", stepper, also={"share": share})
    share.Set(0.0)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        LoadState(tmp_path / "state", made(), also={"share": share})
        LoadState(tmp_path / "state", stepper, also={"share": share})
