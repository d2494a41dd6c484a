"""A contact law in NumPy through the door of the compiled one: a spring with a limit, and a drag.

The pressure grows with the overlap up to a limit, the tangential traction against the slip.
"""

import math
from typing import ClassVar

import numpy as np
import pytest
from blocks import C, block_mesh, contact_form
from form import Form
from netgen.meshing import NgException
from ngsolve import (
    CF,
    GridFunction,
    Parameter,
    VectorH1,
    ds,
    y,
)
from posed import elastic, posed
from press import press

from ngslac import (
    ContactConvergenceError,
    FloatingBodyError,
    Law,
    LoadState,
    SaveState,
    TimeStepper,
)
from ngslac.meshes import TwoBlocks
from ngslac.meshes.blocks3d import TwoBlocks3D
from ngslac.solve.system import PullsAside


class LimitedSpring:
    """Pressure ``min(k (start - gap), limit)``, and traction ``-drag slip`` with it."""

    def __init__(self, k=20.0, limit=np.inf, drag=3.0, start=0.0):
        self.k, self.limit, self.drag, self.start = k, limit, drag, start

    def __call__(self, places):
        normal, gap, slip = (places[name] for name in ("normal", "gap", "slip"))
        closed, eye = gap < self.start, np.eye(normal.shape[1])
        pressure = np.where(closed, np.minimum(self.k * (self.start - gap), self.limit), 0)
        grows = closed & (pressure < self.limit)
        across = self.drag * closed
        return {
            "traction": -pressure[:, None] * normal - across[:, None] * slip,
            "by_gap": self.k * grows[:, None] * normal,
            "by_slip": -np.multiply.outer(across, eye),
        }


class Coulomb:
    """The compiled law through the places that laws which stick take: trial pressures."""

    friction = 0.3

    def __call__(self, places):
        normal, trial = places["normal"], places["trial"]
        pressure = -np.sum(trial * normal, axis=1)[:, None]
        across = trial + pressure * normal
        size, bound = np.linalg.norm(across, axis=1)[:, None], self.friction * pressure
        sticks, closed = (size <= bound)[:, :, None], (pressure > 0)[:, :, None]
        way = across / np.where(size > 0, size, 1)
        eye, nn = np.eye(normal.shape[1]), outer(normal, normal)
        turns = (bound / np.where(size > 0, size, 1))[:, :, None] * (eye - nn - outer(way, way))
        slides = nn + turns - self.friction * outer(way, normal)
        return {
            "traction": closed[:, 0]
            * np.where(sticks[:, 0], trial, bound * way - pressure * normal),
            "by_trial": closed * np.where(sticks, eye, slides),
            "status": np.where(closed, np.where(sticks, 1, 2), 0).ravel(),
        }


def outer(a, b):
    return a[:, :, None] * b[:, None]


def stiff_jump(places):
    """Glue that gives way, by the jump alone, and by the trial."""
    jump, trial = places["jump"], places["trial"]
    eye = np.broadcast_to(np.eye(jump.shape[1]), (*jump.shape, jump.shape[1]))
    size = np.sum(jump**2, axis=1)[:, None]
    return {
        "traction": 0.3 * trial - (5 + size) * jump,
        "by_jump": -(5 + size)[:, :, None] * eye - 2 * outer(jump, jump),
        "by_trial": 0.3 * eye,
    }


def rough_in_x(places):
    """Drag in the direction x of space: the law does not turn with the bodies."""
    normal, slip, gap = (places[name] for name in ("normal", "slip", "gap"))
    rough = np.diag([4.0] + [0.0] * (normal.shape[1] - 1))
    eye = np.broadcast_to(np.eye(len(rough)), (len(gap), *rough.shape))
    return {
        "traction": gap[:, None] * normal - slip @ rough,
        "by_gap": normal,
        "by_slip": -0 * eye - rough,
        "by_normal": gap[:, None, None] * eye,
    }


def soft_along(places):
    """Glue that is softer along the surface than across it."""
    jump, normal = places["jump"], places["normal"]
    stiffness = 2 * np.eye(jump.shape[1]) + 5 * outer(normal, normal)
    return {"traction": -np.einsum("nij,nj->ni", stiffness, jump), "by_jump": -stiffness}


class Damaged:
    """Glue, of which the part that is torn in a step has gone in the next one."""

    stiffness, strength = 20.0, 1.8e-3
    kept: ClassVar = {"damage": 0.0}

    def __call__(self, places):
        k = (self.stiffness * (1 - places["damage"]))[:, None]
        traction = -k * places["jump"]
        torn = np.clip(np.linalg.norm(traction, axis=1) / self.strength - 1, 0, 1)
        return {
            "traction": traction,
            "by_jump": -k[:, :, None] * np.eye(traction.shape[1]),
            "damage": np.maximum(torn, places["damage"]),
        }


class Wearing:
    """A spring whose gap grows by pressure times slip."""

    k, rate = 3.0, 0.5

    def __init__(self, dim=2):
        self.kept = {"wear": 0.0, "last": np.zeros(dim)}

    def __call__(self, places):
        pressure = np.maximum(-self.k * (places["gap"] + places["wear"]), 0)
        rubbed = self.rate * pressure * np.linalg.norm(places["slip"], axis=1)
        return {
            "traction": -pressure[:, None] * places["normal"],
            "by_gap": self.k * (pressure > 0)[:, None] * places["normal"],
            "wear": places["wear"] + rubbed,
            "last": places["slip"],
        }


def with_law(dim, finite, law):
    mesh = block_mesh(dim) if dim == 2 else block_mesh(dim, "hex", "tet", 2, 1)
    return contact_form(mesh, finite=finite, law=law)


@pytest.mark.parametrize("finite", [False, True])
@pytest.mark.parametrize("dim", [2, 3])
def test_derivative(dim, finite):
    """Of every branch, where normals turn and slip counts from another configuration."""
    law = LimitedSpring()
    form = Form(with_law(dim, finite, law))
    form.bend(0.02, 0.0, degrees=20, noise=0.01, seed=1)
    form.commit()
    form.bend(0.04, 0.05, degrees=30, noise=0.01, seed=2)
    form.follow()
    form.values[form.multipliers] = np.random.default_rng(4).normal(size=form.multipliers.shape)
    gaps = np.unique(form.table()["gap"][form.table()["area"] > 0])
    law.start = gaps[-2:].mean()  # the last one is open, and the first one is at the limit
    law.limit = law.k * (law.start - gaps[:2].mean())
    assert set(form.table()["status"]) == {0, 1}
    assert form.derivative_error(40 if dim == 2 else 6) <= 1e-7


def quiet(law):
    """A law without its status."""
    return lambda places: {n: a for n, a in law(places).items() if n != "status"}


@pytest.mark.parametrize("finite", [False, True])
@pytest.mark.parametrize("dim", [2, 3])
def test_the_status_of_coulomb_is_known_without_it(dim, finite):
    """Friction that slides turns with the slip, but does not grow with it."""
    tables = []
    for law in (Coulomb(), quiet(Coulomb())):
        form = Form(with_law(dim, finite, law))
        form.bend(0.04, 0.05, degrees=30, noise=0.01, seed=2)
        form.follow()
        form.contact.form.SetConstant(C)
        form.impose(0.3)
        tables.append(form.table()["status"])
    assert set(tables[0]) == {0, 1, 2}
    assert np.array_equal(*tables)


def saturated(scale):
    """Friction of 0.3 times a pressure that grows with the overlap, full where slip is far."""

    def law(places):
        normal, slip = places["normal"], places["slip"]
        pressure = 20 * np.maximum(1 - places["gap"], 0)[:, None]
        size = np.maximum(np.linalg.norm(slip, axis=1), 1e-300)[:, None]
        way, part = slip / size, np.tanh(size / scale)
        ww, eye = outer(way, way), np.eye(normal.shape[1])
        rate = (1 - part**2)[:, :, None] / scale * ww + (part / size)[:, :, None] * (eye - ww)
        friction = 0.3 * part * way
        return {
            "traction": -pressure * (normal + friction),
            "by_gap": 20 * (pressure > 0) * (normal + friction),
            "by_slip": -0.3 * pressure[:, :, None] * rate,
        }

    return law


@pytest.mark.parametrize(("scale", "status"), [(1e-4, 2), (1.0, 1)])
@pytest.mark.parametrize("dim", [2, 3])
def test_full_friction_slips(dim, scale, status):
    form = Form(with_law(dim, False, saturated(scale)))
    form.bend(0.02, 0.0)
    form.commit()
    form.bend(0.02, 0.05)
    form.follow()
    table = form.table()
    assert set(table["status"][table["area"] > 0]) == {status}


@pytest.mark.parametrize("limit", [np.inf, 4e-4])
@pytest.mark.parametrize("finite", [False, True])
@pytest.mark.parametrize("make", [lambda: TwoBlocks(0.3), lambda: TwoBlocks3D("hex", "tet", 3, 2)],
                         ids=["2D", "3D"])  # fmt: skip
def test_solve(make, finite, limit):
    """Columns in series: the pressure of two bodies of length 1 and a spring, up to its limit."""
    mesh, k, down = make(), 2.0, 1e-3
    V = VectorH1(mesh, order=2, dirichlet="bottom|top")
    problem = posed(V, elastic(2), finite=finite, law=LimitedSpring(k, limit, drag=0.0))
    way = CF((0,) * (mesh.dim - 1) + (-down,))
    problem.gf.components[0].Set(way, definedon=mesh.Boundaries("top"))
    problem.solver().Solve(printing=False)
    expected, rel = min(down / (0.5 + 0.5 + 1 / k), limit), 5e-3 if finite else 1e-8
    assert problem.contact.Table()["pressure"] == pytest.approx(expected, rel=rel)


def pressed(law, *, finite=False, tied=False, down=1e-2, load=None):
    """A block pressed on another one, and dragged along by the load if there is one."""
    V = VectorH1(TwoBlocks(0.3), order=2, dirichlet="bottom|top")
    problem = posed(V, elastic(2), load=load, finite=finite, tied=tied, law=law)
    if load is not None:
        held = {"top": CF((0.01 * load, -down)), "bottom": CF((0, 0))}
        return problem.stepper(prescribe=held)
    problem.gf.components[0].Set(CF((0, -down)), definedon=V.mesh.Boundaries("top"))
    return problem.solver()


def dragging(places):
    """Glue that pulls back along the surface, and a spring across it."""
    found, slip = Wearing()(places), places["slip"]
    drag = np.broadcast_to(-np.eye(2), (len(slip), 2, 2))
    return found | {"traction": found["traction"] - slip, "by_slip": drag}


dragging.kept = Wearing().kept


@pytest.mark.parametrize(("law", "status"), [(Wearing(), 2), (dragging, 1)])
def test_force_without_a_status(law, status):
    contact = (solver := pressed(law)).contacts[0]
    solver.Solve(printing=False)
    assert set(contact.Table()["status"]) == {status}
    assert contact.Force()[1] == pytest.approx(1e-2 / (1 + 1 / Wearing.k), rel=1e-8)


@pytest.mark.parametrize("finite", [False, True])
def test_a_body_that_nothing_else_holds(finite):
    """It has to overlap at the start; loads aside are found where the law resists no slip."""
    for aside in (0.0, 0.01):
        V = VectorH1(TwoBlocks(0.3), order=2, dirichlet="bottom")
        law = {"finite": finite, "law": Wearing(), "offset": -1e-6}
        solver = posed(
            V, elastic(2), lambda u, v, load, k=aside: (0.01 * v[1] - k * v[0]) * ds("top"), **law
        ).solver()
        if aside:
            with pytest.raises(FloatingBodyError, match=r"'upper' floats \(translation in x\)"):
                solver.Solve(printing=False)
        else:
            solver.Solve(printing=False)
            assert solver.contacts[0].Force() == pytest.approx([0, 0.01], abs=1e-10)


def pushed_by_a_limited_force(places):
    """Without friction: the traction leaps where contact begins."""
    closed = (places["gap"] < 0)[:, None]
    return {"traction": -0.01 * closed * places["normal"], "by_gap": 0 * places["normal"]}


def pulled_the_wrong_way(places):
    """The derivative has the wrong sign."""
    found = Wearing()(places)
    return found | {"by_gap": -found["by_gap"]}


pulled_the_wrong_way.kept = Wearing().kept


@pytest.mark.parametrize("law", [pushed_by_a_limited_force, pulled_the_wrong_way])
def test_what_to_look_at_where_newtons_method_fails(law):
    """Not at friction, of which there is none."""
    stepper = pressed(law, load=Parameter(0), down=5e-3 * y)
    stepper.maxcuts = 1
    words = (
        r"A law of your own needs a traction without jumps, and right derivatives .* several faces"
    )
    with pytest.raises(ContactConvergenceError, match=words) as found:
        stepper.Integrate(1, steps=1, printing=False)
    assert "friction" not in str(found.value)
    with pytest.raises(ContactConvergenceError, match="take smaller steps. " + words):
        pressed(law, down=2.5e-3).Solve(maxit=20, printing=False)


@pytest.mark.parametrize("finite", [False, True])
def test_wear_grows_by_pressure_and_slip(finite):
    stepper = pressed(Wearing(), finite=finite, load=Parameter(0))
    contact = stepper.solver.contacts[0]
    stepper.Integrate(1, steps=2, printing=False)
    wear, forces = contact.Table()["wear"], stepper.Table()["force"][:, 0, 1]
    slip = 0.01 * Wearing.rate * forces[-1]
    assert np.all(np.abs(wear / slip - 1.1) < 0.9)
    assert np.all(np.diff(forces) < 0)
    assert contact.Table()["last"].shape == (len(wear), 2)


class Counting(Wearing):
    """Counts the steps."""

    def __init__(self):
        super().__init__()
        self.kept |= {"steps": 0}

    def __call__(self, places):
        return super().__call__(places) | {"steps": places["steps"] + 1}


def test_steps_that_fail_leave_nothing(monkeypatch):
    stepper = pressed(Counting(), load=Parameter(0))
    contact, solve, fails = stepper.solver.contacts[0], stepper.solver.Solve, [True]

    def hard(**options):
        last = solve(**options)
        if fails:
            raise ContactConvergenceError(f"hard {fails.pop()}")
        return last

    def interrupted():
        raise KeyboardInterrupt

    monkeypatch.setattr(stepper.solver, "Solve", hard)
    steps = stepper.Integrate(1, steps=1, printing=False)
    assert steps[0].cuts == 1
    assert set(contact.Table()["steps"]) == {len(steps)}
    monkeypatch.setattr(stepper, "_Forces", interrupted)  # after the commit
    with pytest.raises(KeyboardInterrupt):
        stepper.Integrate(2, steps=1, printing=False)
    assert set(contact.Table()["steps"]) == {len(steps)}


@pytest.mark.parametrize("tied", [False, True])
def test_dynamics_refuse_it(tied):
    with pytest.raises(ValueError, match=r"law=, which TimeStepper does not know: .* LoadStepper"):
        TimeStepper(pressed(soft_along if tied else LimitedSpring(), tied=tied), 1.0, dt=0.05)


@pytest.mark.parametrize("finite", [False, True])
def test_glue_is_torn(finite):
    """Two bodies pulled apart: springs in series, until a step has torn the glue."""
    solver = pressed(law := Damaged(), finite=finite, tied=True, down=-2e-3)
    contact, damage = solver.contacts[0], 0.0
    for _ in range(3):
        solver.Solve(printing=False)
        force = 2e-3 / (1 + 1 / (law.stiffness * (1 - damage)))
        assert contact.Force()[1] == pytest.approx(-force, rel=1e-4 if finite else 1e-8)
        contact.Commit(solver.gf)
        damage = max(damage, force / law.strength - 1)
        assert contact.Table()["damage"] == pytest.approx(damage, rel=1e-2 if finite else 1e-8)
    assert damage > 0.05


@pytest.mark.parametrize("left", [0, 1])
def test_nothing_is_kept_of_a_commit_that_fails(left):
    class Failing(Wearing):
        left = math.inf

        def __call__(self, places):
            self.left -= 1
            if self.left < 0:
                raise KeyboardInterrupt
            return super().__call__(places)

    law = Failing()
    contact = (solver := pressed(law)).contacts[0]
    solver.Solve(printing=False)
    contact.Commit(solver.gf)
    before = contact.State()
    law.left = left
    with pytest.raises(KeyboardInterrupt):
        contact.Commit(solver.gf)
    assert law.left < 0
    after = contact.State()
    assert "law: wear" in before
    assert before.keys() == after.keys()
    for name in before:
        assert np.array_equal(before[name], after[name]), name


def test_refused():
    with pytest.raises(ValueError, match="a law of your own says all: drop law, or"):
        contact_form(block_mesh(2), law=LimitedSpring(), friction=0.3)
    with pytest.raises(TypeError, match="law = 3 must be a function from places"):
        contact_form(block_mesh(2), law=3)
    with pytest.raises(TypeError, match=r"law = .*LimitedSpring.*, not a class: give an object"):
        contact_form(block_mesh(2), law=LimitedSpring)


@pytest.mark.parametrize(("kept", "words"), [
    (3, r"law.kept = 3 must be a dict of numbers or vectors"),
    ({"gap": 0.0}, "law.kept has 'gap', which means something else: rename it"),
    ({"by_worn": 0.0}, "law.kept has 'by_worn', which means something else"),
    ({"worn": 1j}, r"law.kept\['worn'\] = 1j must be a number, or a vector \(k\)"),
    ({"worn": []}, r"law.kept\['worn'\] = \[\] must be a number"),
    ({"worn": "much"}, r"law.kept\['worn'\] = 'much' must be a number"),
    ({"worn": np.nan}, r"law.kept\['worn'\] = nan must be finite"),
    ({"worn": np.eye(2)}, r"law.kept\['worn'\] = .* must be a number"),
    ({3: 0.0}, "law.kept has 3, which"),
])  # fmt: skip
def test_refused_memories(kept, words):
    law = LimitedSpring()
    law.kept = kept
    with pytest.raises((TypeError, ValueError), match=words):
        contact_form(block_mesh(2), law=law)


@pytest.mark.parametrize("dim", [2, 3])
def test_no_column_of_a_table_is_kept(dim):
    contact = with_law(dim, False, LimitedSpring())
    contact.Update()
    for name in contact.Table():
        law = LimitedSpring()
        law.kept = {name: 0.0}
        with pytest.raises(ValueError, match=f"law.kept has '{name}', which means something"):
            with_law(dim, False, law)


def answers(**columns):
    """A law that returns these, functions of normals (n, d)."""
    return lambda places: {name: column(places["normal"]) for name, column in columns.items()}


def itself(values):
    return values


WRONG = {
    r"law must return a dict of arrays of numbers, not None": lambda places: None,
    r"law must return a dict with 'traction', \(n, 2\) numbers": answers(by_gap=itself),
    r"law has given 'by_trail', which is none of by_gap, ": answers(
        traction=itself, by_trail=itself
    ),
    r"law has given 'traction' with the shape \(2, (\d+)\), which must begin with \1, ": answers(
        traction=np.transpose
    ),
    r"law has given \d+ numbers as 'by_slip' of \d+ macro-elements, of which each needs 4": answers(
        traction=itself, by_slip=itself
    ),
    r"law has given nan as 'traction' where the jump is ": answers(
        traction=lambda n: np.nan * n, by_gap=itself
    ),
    r"law has given no derivative of the traction .* 'by_gap'": answers(traction=itself),
    r"law has given 'traction' in single precision; it must be double": answers(
        traction=lambda n: n.astype(np.float32), by_gap=itself
    ),
    r"law has given 'by_gap' as a masked array; fill it": answers(
        traction=itself, by_gap=lambda n: np.ma.masked_less(n, 0)
    ),
    r"law has given 'traction' with complex numbers; it must be real": answers(
        traction=lambda n: n + 0j
    ),
    r"law has given 'traction' = 'a', which must be an array of numbers": answers(
        traction=lambda n: "a"
    ),
    r"7 is no status": answers(traction=itself, by_gap=itself, status=lambda n: 7 + 0 * n[:, 0]),
}


@pytest.mark.parametrize("words", WRONG)
def test_wrong_answers(words):
    """By errors that say what was given, also in the middle of a solution."""
    contact = with_law(2, False, WRONG[words])
    kinds = ValueError, TypeError, NgException
    with pytest.raises(kinds, match=words):
        contact.Evaluate(GridFunction(contact.form.fes))
    with pytest.raises((*kinds, ContactConvergenceError), match=words):
        pressed(WRONG[words]).Solve(printing=False)


@pytest.mark.parametrize("name", ["by_gap", "by_slip"])
def test_tied_surfaces_have_no_gap_and_no_slip(name):
    contact = contact_form(block_mesh(2), tied=True, law=answers(**{name: itself}, traction=itself))
    with pytest.raises(ValueError, match=f"law has given '{name}', which is none of by_jump"):
        contact.Evaluate(GridFunction(contact.form.fes))


class Softening:
    """A pressure, and a force against the slip that falls as that grows."""

    stiffness, first, loss = 3.0, 0.5, 10.0

    def __call__(self, places):
        gap, slip, normal = places["gap"], places["slip"], places["normal"]
        pressure = np.maximum(-self.stiffness * gap, 0)[:, None]
        size = np.maximum(np.linalg.norm(slip, axis=1), 1e-99)[:, None]
        rubs, way = self.first * np.exp(-self.loss * size), slip / size
        turn = np.eye(normal.shape[1]) - normal[:, :, None] * normal[:, None]
        along = way[:, :, None] * way[:, None]
        turns, falls = (rubs / size)[:, :, None], (self.loss * rubs)[:, :, None]
        by_slip = turns * (turn - along) - falls * along
        return {
            "traction": -pressure * (normal + rubs * way),
            "by_gap": self.stiffness * (pressure > 0) * (normal + rubs * way),
            "by_slip": -pressure[:, :, None] * by_slip,
        }


@pytest.mark.parametrize("dim", [2, 3])
def test_what_softens_slips(dim):
    contact = with_law(dim, False, Softening())
    gf = GridFunction(contact.form.fes)
    upper = gf.space.mesh.Materials("upper")
    gf.components[0].Set(CF((0.02, *(dim - 2) * [0], -0.05)), definedon=upper)
    contact.Evaluate(gf)
    status = contact.Table()["status"]
    assert set(status[status > 0]) == {2}


class Keeps(Wearing):
    """Gives other names and values of what it keeps."""

    def __init__(self, answer):
        super().__init__()
        self.answer = answer

    def __call__(self, places):
        told = super().__call__(places)
        for name in self.kept:
            del told[name]
        return told | self.answer(places)


@pytest.mark.parametrize(("answer", "words"), [
    ({}, "law has not given 'last', which law.kept has: return it each time"),
    ({"wear": 1j * np.zeros(9)}, "law has given 'wear' with complex numbers; it must be real"),
    ({"wear": "slip"}, r"law has given \d+ numbers as 'wear' of .*, of which each needs 1"),
    ({"last": "area", "wear": "area"}, r"law has given .* as 'last' of .*, of which each needs 2"),
    ({"last": "normal", "wear": "area", "way": "area"}, "law has given 'way', which is none of"),
    ({"last": "normal", "wear": "none"}, "law has given nan as 'wear' where the jump is"),
])  # fmt: skip
def test_wrong_answers_to_keep(answer, words):
    def given(places):
        places = places | {"none": np.nan * places["area"]}
        told = {"last": places["slip"]} if answer else {}
        return told | {
            name: places[value] if isinstance(value, str) else value
            for name, value in answer.items()
        }

    contact = with_law(2, False, Keeps(given))
    with pytest.raises((ValueError, TypeError, NgException), match=words):
        contact.Evaluate(GridFunction(contact.form.fes))


@pytest.mark.parametrize("left", [0, -1])
def test_a_saved_array_that_is_cut(left):
    solver = pressed(Wearing())
    solver.Solve(printing=False)
    contact = solver.contacts[0]
    contact.Commit(solver.gf)
    state = contact.State()
    with pytest.raises(NgException, match=r"does not fit: 'law: last' needs \d+ numbers"):
        contact.SetState(state | {"law: last": state["law: last"][:left]})
    after = contact.State()
    assert all(np.array_equal(state[name], after[name]) for name in state)


def test_the_law_is_named_and_its_state_is_no_other_laws(tmp_path):
    solvers = []
    for options in ({"law": LimitedSpring()}, {"friction": 0.3}):
        V = VectorH1(TwoBlocks(0.3), order=2, dirichlet="bottom|top")
        solvers.append(posed(V, elastic(1), **options).solver())
        solvers[-1].Solve(printing=False)
    assert "a law of its own" in repr(solvers[0].contacts[0])
    SaveState(tmp_path / "state", solvers[0])
    LoadState(tmp_path / "state", solvers[0])
    with pytest.raises(ValueError, match=r"another .*: .*a law of its own there"):
        LoadState(tmp_path / "state", solvers[1])


def test_what_is_tied_pulls_nothing_aside():
    assert not PullsAside(press(tied=True).contact)


def test_a_function_of_fields_is_told_how_it_is_given():
    """As a Law: a law in NumPy gets arrays by name."""
    contact = contact_form(block_mesh(2), law=lambda f: -f.gap * f.normal)
    with pytest.raises((AttributeError, NgException), match=r"law=Law\(function\)"):
        contact.Evaluate(GridFunction(contact.form.fes))
    with pytest.raises(ValueError, match="give it as law="):
        contact_form(block_mesh(2), friction=Law(lambda f: -f.gap * f.normal))
