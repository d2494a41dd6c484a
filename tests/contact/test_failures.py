"""What fails leaves a contact as it was, and nothing is used that is not there."""

import numpy as np
import pytest
from blocks import C, block_mesh, contact_form, moved
from blocks3d import block_mesh as block_mesh3d
from netgen.meshing import NgException
from ngsolve import CF, GridFunction, Parameter, VectorH1, sqrt, x

from ngslac import LACContact, LACSpace


@pytest.fixture(scope="module")
def mesh():
    return block_mesh(h=0.25)


def fresh(mesh, autoupdate=True, **flags):
    """A contact that is not paired, and a GridFunction on its space."""
    V = VectorH1(mesh, order=2, autoupdate=autoupdate)
    X = V * LACSpace(V, slave="slave")
    contact = LACContact(*X.TrialFunction(), **({"master": "master"} | flags))
    return contact, GridFunction(X)


def everything(contact, state):
    """All that a contact says about a state, as bytes."""
    gf = GridFunction(contact.form.fes)
    gf.vec.FV().NumPy()[:] = state
    residual = gf.vec.CreateVector()
    contact.AssembleLinearization(gf.vec)
    contact.Apply(gf.vec, residual)
    arrays = [contact.mat.AsVector().FV().NumPy(), residual.FV().NumPy(), contact.Force()]
    arrays += [np.asarray(contact.Moment()), contact.Segments().area, contact.Segments().gap]
    arrays += contact.Table().values()
    arrays += [values for values in contact.State().values() if isinstance(values, np.ndarray)]
    return [np.asarray(array).tobytes() for array in arrays]


def shifted(contact, upper):
    gf = GridFunction(contact.form.fes)
    shift = {"upper": CF(tuple(upper)), "lower": CF((0,) * len(upper))}
    gf.components[0].Set(contact.mesh.MaterialCF(shift))
    return gf


def apart(contact):
    return moved(contact, upper=(0, 5))


def broken(contact):
    gf = moved(contact)
    gf.vec.FV().NumPy()[0] = np.nan
    return gf


@pytest.mark.parametrize("finite", [False, True])
@pytest.mark.parametrize("wrong", [apart, broken])
def test_an_update_that_fails_changes_nothing(mesh, finite, wrong):
    contact = contact_form(mesh, finite=finite, friction=0.3, maxdist=0.3)
    gf = moved(contact, upper=(0.02, -0.01))
    contact.Commit(gf)
    state = gf.vec.FV().NumPy().copy()
    state[contact.form.MultiplierDofs()] = 0.1
    before = everything(contact, state)
    with pytest.raises(NgException, match=r"never meet|NaN"):
        contact.Update(wrong(contact))
    assert everything(contact, state) == before


@pytest.mark.parametrize("finite", [False, True])
@pytest.mark.parametrize("value", [-1.0, np.nan])
def test_an_update_with_wrong_friction_changes_nothing(mesh, finite, value):
    friction = Parameter(0.3)
    contact = contact_form(mesh, finite=finite, friction=friction)
    state = moved(contact).vec.FV().NumPy().copy()
    state[contact.form.MultiplierDofs()] = 0.1
    before = everything(contact, state)
    friction.Set(value)
    with pytest.raises(NgException, match="friction is"):
        contact.Update()
    friction.Set(0.3)
    assert everything(contact, state) == before


@pytest.mark.parametrize("finite", [False, True])
def test_a_first_update_that_fails_leaves_an_unpaired_contact(mesh, finite):
    contact, gf = fresh(mesh, finite=finite, friction=CF(-1.0))
    with pytest.raises(NgException, match="friction is -1"):
        contact.Update()
    assert not contact.form.paired
    for use in (contact.Force, contact.Table, lambda: contact.Evaluate(gf)):
        with pytest.raises(NgException, match="no pairing yet; call Update"):
            use()


def uses(contact, gf):
    """Every method that works on a pairing, by its name."""
    vec, other = gf.vec, gf.vec.CreateVector()
    return {
        "Force": contact.Force,
        "Moment": contact.Moment,
        "Table": contact.Table,
        "Evaluate": lambda: contact.Evaluate(gf),
        "Commit": lambda: contact.Commit(gf),
        "Restore": contact.Restore,
        "Follow": lambda: contact.Follow(gf),
        "Segments": contact.Segments,
        "Check": lambda: str(contact.Check()),
        "Mortar": contact.Mortar,
        "Apply": lambda: contact.Apply(vec, other),
        "AssembleLinearization": lambda: contact.AssembleLinearization(vec),
        "AssembleStep": lambda: contact.form.AssembleStep(vec, other),
        "UpdateMultipliers": lambda: contact.form.UpdateMultipliers(vec),
        "State": contact.State,
        "SetState": lambda: contact.SetState({"paired": None, "scaled": False}),
        "Plot": contact.Plot,
        "Draw": lambda: contact.Draw(show=False),
        "SetConstant": lambda: contact.form.SetConstant(C),
        "BeginSolve": contact.form.BeginSolve,
        "States": contact.form.States,
    }


NAMES = list(uses(*fresh(block_mesh(h=0.5))))


@pytest.mark.parametrize("finite", [False, True])
@pytest.mark.parametrize("name", NAMES)
def test_nothing_crashes_before_the_first_update(mesh, finite, name):
    contact, gf = fresh(mesh, finite=finite)
    try:
        uses(contact, gf)[name]()
    except NgException as error:
        assert "no pairing yet; call Update() first" in str(error)  # noqa: PT017


@pytest.mark.pairwise
@pytest.mark.parametrize("finite", [False, True])
@pytest.mark.parametrize("updated", [False, True])
@pytest.mark.parametrize("name", NAMES)
def test_nothing_crashes_after_a_refinement(finite, updated, name):
    contact, gf = fresh(block_mesh(h=0.5), autoupdate=updated, finite=finite)
    contact.Update()
    contact.form.SetConstant(C)
    contact.mesh.Refine()
    try:
        uses(contact, gf)[name]()
    except (NgException, ValueError) as error:
        assert "refinement" in str(error) or "entries" in str(error)  # noqa: PT017


def test_an_update_on_a_refined_mesh_wants_an_updated_space():
    contact, gf = fresh(block_mesh(h=0.5), autoupdate=False)
    contact.mesh.Refine()
    with pytest.raises(NgException, match="the mesh was refined, but not its spaces"):
        contact.Update()
    gf.space.Update()
    contact.Update(gf)
    assert contact.Check().unpaired.size < contact.space.nmacros


@pytest.mark.parametrize("make", [block_mesh, block_mesh3d])
def test_restore_takes_back_a_finite_pairing(make):
    contact = contact_form(make(), finite=True, friction=0.3)
    shift = (0.02, 0.0, -0.01)[: contact.mesh.dim]
    gf = shifted(contact, shift)
    gf.vec.FV().NumPy()[contact.form.MultiplierDofs()] = 0.1
    contact.Evaluate(gf)
    contact.Commit(gf)
    contact.Restore()
    before = [contact.Force(), contact.Moment(), contact.Segments().area, contact.Segments().gap]
    table = contact.Table()
    trial = shifted(contact, [4 * s for s in shift])
    trial.vec.FV().NumPy()[contact.form.MultiplierDofs()] = 0.2
    contact.Follow(trial)
    contact.Evaluate(trial)
    assert abs(contact.Force() - before[0]).max() > 1e-3
    contact.Restore()
    after = [contact.Force(), contact.Moment(), contact.Segments().area, contact.Segments().gap]
    assert all(np.array_equal(a, b) for a, b in zip(before, after, strict=True))
    assert all(np.array_equal(values, table[name]) for name, values in contact.Table().items())


@pytest.mark.parametrize(
    ("name", "value", "words"),
    [
        ("friction", CF((1, 2)), "friction has 2 components: it must be one number at each point"),
        ("tresca", CF((1, 2, 3)), "tresca has 3 components"),
        ("obstacle", CF((0, 0.1)), "obstacle has 2 components"),
        ("friction", CF(1j), "friction is complex: it must be one real number"),
        ("obstacle", CF(0.1j), "obstacle is complex"),
        ("obstacle", np.inf, "obstacle = inf must be a finite number"),
        ("tresca", -1, "tresca = -1 must be a finite number >= 0"),
    ],
)
def test_functions_must_be_real_and_scalar(mesh, name, value, words):
    master = {"master": None} if name == "obstacle" else {}
    with pytest.raises(ValueError, match=words):
        fresh(mesh, **{name: value}, **master)


@pytest.mark.parametrize("name", ["friction", "tresca"])
@pytest.mark.parametrize("value", [sqrt(x - 0.3), 0.1 / (x - x), x - 0.3])
def test_functions_that_are_wrong_in_parts_are_named_with_a_place(mesh, name, value):
    contact, _ = fresh(mesh, **{name: value})
    with pytest.raises(
        NgException, match=rf"{name} is -?[\d.einaf-]+ at \(.*must be a number >= 0"
    ):
        contact.Update()
