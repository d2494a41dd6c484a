"""One contract over all ways to write a law: compiled, in NumPy, as expressions, by functions."""

import numpy as np
import pytest
from blocks import C, block_mesh, contact_form
from form import Form, on_a_sphere
from ngsolve import CF, Parameter, x
from test_fields import LAWS, falling, remembering, sheared, worn
from test_law_expression import by_the_trial, coulomb, pulled, soft, torn
from test_law_of_ones_own import (
    Coulomb,
    LimitedSpring,
    Wearing,
    pressed,
    rough_in_x,
    soft_along,
    stiff_jump,
)

from ngslac import Law, LoadState, SaveState

# Options of the contact, and the statuses that occur in the state below.
ALL, CLOSED = {0, 1, 2}, {1}
SLIDING = {f"function: {name}": (law, ALL) for name, law in LAWS.items()} | {
    "NumPy: trial": ({"law": Coulomb()}, ALL),
    "NumPy: jump": ({"law": stiff_jump}, CLOSED),
    "NumPy: not turning": ({"law": rough_in_x}, CLOSED),
    "expression: trial": ({"law": Law(coulomb)}, ALL),
    "expression: jump": ({"law": Law(by_the_trial)}, None),
    "expression: gap and rate": ({"law": Law(soft)}, None),
}
GLUED = {"NumPy": soft_along, "NumPy, finite": stiff_jump, "expression": Law(torn)}
TOOLS = {
    "function": {"friction": falling, "offset": worn},
    "NumPy": {"law": LimitedSpring(start=0.1)},
    "expression": {"law": Law(soft)},
}


def blocks_form(dim, **options):
    mesh = block_mesh(dim) if dim == 2 else block_mesh(dim, "hex", "tet", 2, 1)
    form = Form(contact_form(mesh, **options))
    form.bend(0.02, 0.03 * ("tied" in options), degrees=20, noise=0.01, seed=1)
    form.commit()
    return form


def statuses(form):
    table = form.table()
    return set(table["status"][table["area"] > 0])


@pytest.mark.parametrize("name", SLIDING)
@pytest.mark.parametrize("finite", [False, True])
@pytest.mark.parametrize("dim", [2, 3])
def test_derivative(dim, finite, name):
    """Against differences, in a state with slip and pressure of a step before."""
    law, expected = SLIDING[name]
    form = blocks_form(dim, finite=finite, **law)
    form.bend(0.04, 0.05, degrees=30, noise=0.01, seed=2)
    form.follow()
    form.contact.form.SetConstant(C)
    form.impose(0.3 if expected is ALL else 1.0)
    found = statuses(form)
    if name.startswith("function"):
        assert 2 in found
    else:
        assert found == expected if expected else max(found) > 0
    assert form.derivative_error(40 if dim == 2 else 6) <= 1e-7


@pytest.mark.parametrize("name", GLUED)
@pytest.mark.parametrize("dim", [2, 3])
def test_derivative_of_glue(dim, name):
    """A tied contact has a jump that counts from the reference, and neither gap nor slip."""
    for finite in (False, True) if name == "expression" else (name.endswith("finite"),):
        form = blocks_form(dim, finite=finite, tied=True, law=GLUED[name])
        if name == "expression":
            assert form.table()["farthest"].max() > 0.01
            form.bend(0.03, 0.04, degrees=20, noise=0.01, seed=1)
        form.contact.form.SetConstant(C)
        random = np.random.default_rng(4)
        form.values[form.multipliers] = random.normal(size=form.multipliers.shape)
        assert statuses(form) == {1}
        assert form.derivative_error(40 if dim == 2 else 6) <= 1e-7


@pytest.mark.parametrize("name", TOOLS)
@pytest.mark.parametrize("dim", [2, 3])
def test_derivative_on_a_tool(dim, name):
    form = on_a_sphere(dim, **TOOLS[name])
    if name == "function":
        form.values[form.multipliers] = -0.5
        form.impose(0.3)
    elif name == "NumPy":
        random = np.random.default_rng(4)
        form.values[form.multipliers] = random.normal(size=form.multipliers.shape)
    assert (2 if name == "function" else 1) in form.table()["status"]
    assert form.derivative_error(40 if dim == 2 else 6) <= 1e-7


@pytest.mark.parametrize(
    ("written", "compiled"),
    [
        ({"law": Coulomb()}, {"friction": 0.3}),
        ({"law": Law(coulomb)}, {"friction": 0.3}),
        (
            {"friction": lambda _: CF(0.3), "offset": lambda _: 0.01 + 0 * x},
            {"friction": 0.3, "offset": 0.01},
        ),
    ],
    ids=["NumPy", "expression", "functions"],
)
@pytest.mark.parametrize("finite", [False, True])
def test_coulomb_is_the_compiled_law(finite, written, compiled):
    forces, found = [], []
    for options in (compiled, written):
        form = Form(contact_form(block_mesh(2), finite=finite, **options))
        form.bend(0.04, 0.05, degrees=30, noise=0.01, seed=2)
        form.follow()
        form.contact.form.SetConstant(C)
        form.impose(0.3)
        forces.append(form.gf.vec.CreateVector())
        form.contact.Apply(form.gf.vec, forces[-1])
        found.append(form.table()["status"])
    assert forces[0].FV().NumPy() == pytest.approx(forces[1].FV().NumPy(), rel=1e-12, abs=1e-14)
    if "friction" in written:  # the status of others is that of their derivatives
        assert np.array_equal(*found)


REMEMBERING = {  # and the columns of its memory
    "NumPy": (lambda: pressed(Wearing(), load=Parameter(0)), ["wear", "last"]),
    "NumPy, finite": (lambda: pressed(Wearing(), finite=True, load=Parameter(0)), ["wear"]),
    "functions": (lambda: sheared(offset=worn, friction=remembering), ["worn", "way"]),
    "expression": (lambda: pulled(torn, down=-0.08), ["farthest"]),
}


@pytest.mark.filterwarnings("ignore:the slave has slid")
@pytest.mark.parametrize("name", REMEMBERING)
def test_a_memory_is_part_of_the_state(name, tmp_path):
    """Of saved files, and of an Update; forgotten by an Update of the reference."""
    make, columns = REMEMBERING[name]
    stepper, other = make(), make()
    contact, again = (s.solver.contacts[0] for s in (stepper, other))
    contact.Update()
    start = contact.Table()
    stepper.Integrate(0.5, steps=2, printing=False)
    middle = contact.Table()
    SaveState(tmp_path / "state", stepper)
    stepper.Integrate(1, steps=2, printing=False)
    last = contact.Table()
    LoadState(tmp_path / "state", other)
    assert all(np.array_equal(again.Table()[column], middle[column]) for column in columns)
    other.Integrate(1, steps=2, printing=False)
    for column in (*columns, "pressure"):
        assert again.Table()[column] == pytest.approx(last[column], rel=1e-9, abs=1e-15)
    kept = columns[0]
    assert start[kept].max() < middle[kept].max() < last[kept].max()
    again.Update(other.solver.gf)
    assert again.Table()[kept] == pytest.approx(last[kept], rel=1e-9)
    again.Update()
    assert np.array_equal(again.Table()[kept], start[kept])
