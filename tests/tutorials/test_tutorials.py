"""The first two tutorials run, and what they compute is right; all of them are tested."""

from pathlib import Path

import nbformat
import numpy as np
import pytest
from exact_spence import SpenceLine
from notebooks import CONTACT, FOLDER, HERTZ, Tutorial

from ngslac.reference import HertzLine

NAMES = sorted(path.stem for path in FOLDER.glob("*.ipynb"))


def test_every_tutorial_is_tested():
    tests = "".join(path.read_text() for path in Path(__file__).parent.glob("*.py"))
    assert [name for name in NAMES if f'"{name}"' not in tests] == []
    assert [name[:2] for name in NAMES] == [f"{k + 1:02}" for k in range(len(NAMES))]


@pytest.mark.parametrize("name", NAMES)
def test_stored_without_outputs(name):
    notebook = nbformat.read(FOLDER / f"{name}.ipynb", as_version=4)
    nbformat.validate(notebook)
    assert notebook.metadata.kernelspec.name == "python3"
    code = [cell for cell in notebook.cells if cell.cell_type == "code"]
    assert [cell.outputs for cell in code] == [[]] * len(code)
    assert [cell.execution_count for cell in code] == [None] * len(code)


# ---------------------------------------------------------------- 01

contact = Tutorial(CONTACT, """
reaction = GridFunction(V)
reaction.Set((1, 0), definedon=mesh.Boundaries("bottom"))
sideways = reaction.vec.FV().NumPy() @ K @ u1
reaction.Set((0, 1), definedon=mesh.Boundaries("bottom"))
upwards = reaction.vec.FV().NumPy() @ K @ u1


def State(u, lam, status):
    return dict(
        x=table["x"][:, 0], status=status, resultant=A @ lam,
        pressure=-N @ lam.ravel(), friction=T @ lam.ravel(),
        gap=g - N @ B @ u / A, slip=T @ B @ u / A,
    )


VALUES = dict(
    free=State(u0, lam0, status0), rough=State(u1, lam1, status1), F=F,
    reaction=[sideways, upwards], lengths=abs((D @ shift.vec.FV().NumPy())[::2] - A).max(),
    translation=abs(B @ shift.vec.FV().NumPy()).max(), differences=[difference_u, difference_lam],
    other_c=abs(ActiveSet(F, top, c=1)[1] - lam1).max() / abs(lam1).max(),
)
""", pictures=2)  # fmt: skip


@pytest.mark.parametrize("case", ["free", "rough"])
def test_contact_conditions(contact, case):
    state, F = getattr(contact, case), contact.F if case == "rough" else 0
    p, q, slip, status = (state[name] for name in ("pressure", "friction", "slip", "status"))
    size, length = p.max(), abs(state["gap"]).max()
    assert p.min() > -1e-12 * size
    assert state["gap"].min() > -1e-12 * length
    assert abs(p * state["gap"]).max() < 1e-12 * size * length
    assert abs(p[status == 0]).max() < 1e-12 * size
    assert abs(slip[status == 1]).max(initial=0) < 1e-12 * length
    np.testing.assert_array_less(abs(q), F * p + 1e-12 * size)
    slips = status == 2
    np.testing.assert_allclose(q[slips], -F * p[slips] * np.sign(slip[slips]), atol=1e-12 * size)


def test_contact_states(contact):
    free, rough = contact.free, contact.rough
    assert np.bincount(free["status"], minlength=3).tolist() == [6, 0, 14]
    assert np.bincount(rough["status"], minlength=3).min() > 3
    changes = np.flatnonzero(np.diff(rough["status"][rough["x"].argsort()]))
    assert len(changes) == 4  # open, slip, stick, slip, open
    p = free["pressure"][free["x"].argsort()]
    np.testing.assert_allclose(p, p[::-1], atol=0.01 * p.max())  # the mesh is not symmetric
    assert p.max() == pytest.approx(3.71, rel=0.01)


def test_contact_balance(contact):
    assert max(contact.lengths, contact.translation) < 1e-14
    # The support hands on to its bottom what it gets from the block.
    resultant = contact.rough["resultant"]
    np.testing.assert_allclose(contact.reaction, resultant, rtol=1e-10)
    assert resultant[0] < 0 < resultant[1]
    assert max(*contact.differences, contact.other_c) < 1e-10  # by hand and by the solver


# ---------------------------------------------------------------- 02

HERTZ_VALUES = """
VALUES = dict(
    rows=rows, frictionless=row0, resultant=resultant, inclined=inclined, force=force, F=F,
    halfwidth=hertz.halfwidth, peak=hertz.peak, ends=ends, status=status,
    pressure=table["pressure"], hertz=hertz.MeanPressure(ends[:-1], ends[1:]),
    friction=-table["tangential"], x=x, spence=Spence(x),
)
"""
hertz = Tutorial(HERTZ, HERTZ_VALUES, pictures=1)
SMALL = {
    "35e3": "350",
    "zone, h = 0.3, 0.25": "zone, h = 0.03, 0.025",
    "stepper.Integrate(steps=10": "stepper.Integrate(steps=20",
}
small = Tutorial(HERTZ, HERTZ_VALUES, pictures=1, replace=SMALL, keep=False)


def test_hertz_steps(hertz):
    assert hertz.halfwidth == pytest.approx(6.2146, abs=1e-4)
    assert hertz.peak == pytest.approx(3585.36, abs=0.01)
    rows, frictionless = hertz.rows, hertz.frictionless
    np.testing.assert_allclose(rows[:, 0], np.arange(1, 11) / 10)
    assert rows[0, 1] <= 8
    assert rows[1:, 1].max() <= 5
    np.testing.assert_allclose(rows[:, 2], 1.0165, atol=0.002)
    assert rows[-1, 2] == pytest.approx(1.016, abs=1e-3)
    assert frictionless[2] == pytest.approx(0.998, abs=1e-3)
    assert 6.1 < min(rows[-1, 3], frictionless[3]) <= max(rows[-1, 3], frictionless[3]) < 6.4
    assert hertz.resultant[1] == pytest.approx(hertz.force / 2, rel=1e-10)
    assert hertz.resultant[0] < hertz.inclined[0] < 0  # friction pulls to the middle


def test_hertz_pressure_and_friction(hertz):
    p, q, status, lengths = hertz.pressure, hertz.friction, hertz.status, np.diff(hertz.ends)
    assert np.sqrt(lengths @ (p - hertz.hertz) ** 2) < 0.03 * np.sqrt(lengths @ hertz.hertz**2)
    closed = np.flatnonzero(status)
    assert closed.tolist() == list(range(len(closed)))
    assert np.all(np.diff(status[closed]) >= 0)  # sticks inside, slips outside
    assert set(status[closed]) == {1, 2}
    np.testing.assert_allclose(q[status == 2], hertz.F * p[status == 2], rtol=1e-8)
    assert np.all(q[status == 1] < hertz.F * p[status == 1])


@pytest.mark.full
def test_hertz_small_contact_has_the_friction_of_spence(small):
    """Exercise 2: with a hundredth of the load the bodies are half-planes."""
    x = small.ends / small.halfwidth
    middle, lengths = (x[:-1] + x[1:]) / 2, np.diff(x)
    line = HertzLine(force=small.force, radius1=50, young1=210e3, nu1=0.3, young2=70e3, nu2=0.3)
    spence = SpenceLine(hertz=line, friction=small.F)
    exact = -spence.MeanTraction(small.ends[:-1], small.ends[1:])
    np.testing.assert_allclose(small.spence, spence.Traction(small.x), atol=1e-9 * small.peak)
    assert lengths @ small.friction == pytest.approx(lengths @ exact, rel=0.03)
    # Macro by macro the load steps show, more so in the middle, which few of them have seen.
    outer = (middle > 0.3) & (middle < 0.9)
    np.testing.assert_allclose(small.friction[outer], exact[outer], rtol=0.1)
    assert middle[small.status == 2].min() == pytest.approx(0.9063, abs=1.5 * lengths.max())
