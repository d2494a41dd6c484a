"""What fails leaves a contact as it was, and nothing is used that is not there."""

import numpy as np
import pytest
from blocks import C, block_mesh, contact_form, moved, vector, with_traction
from finitepress import Led, blocks2d
from netgen.meshing import NgException
from ngsolve import CF, Det, GridFunction, Parameter, Trace, VectorH1, log, sqrt, x

from ngslac import LACContact, LACSpace

finite = pytest.mark.parametrize("finite", [False, True])
NONE = (np.nan, np.inf)


@pytest.fixture(scope="module")
def mesh():
    return block_mesh(2, 0.25)


def fresh(mesh, autoupdate=True, **flags):
    """A contact that is not paired, and a GridFunction on its space."""
    V = VectorH1(mesh, order=2, autoupdate=autoupdate)
    X = V * LACSpace(V, slave="slave")
    contact = LACContact(*X.TrialFunction(), **({"master": "master"} | flags))
    return contact, GridFunction(X)


def resultants(contact):
    segments = contact.Segments()
    return [contact.Force(), np.asarray(contact.Moment()), segments.area, segments.gap]


def everything(contact, gf):
    """All that a contact says about a state, as bytes."""
    out = vector(contact)
    contact.AssembleLinearization(gf.vec)
    contact.Apply(gf.vec, out)
    arrays = [contact.mat.AsVector().FV().NumPy(), out.FV().NumPy(), *resultants(contact)]
    arrays += contact.Table().values()
    arrays += [values for values in contact.State().values() if isinstance(values, np.ndarray)]
    return [np.asarray(array).tobytes() for array in arrays]


def wrong(contact, value):
    """Bodies far apart sideways, too deep in each other, or one value that is no number."""
    if value == "apart":
        return moved(contact, upper=(5,) + (0,) * (contact.mesh.dim - 1))
    if value == "sunk":
        return moved(contact, upper=0.4 * contact.Table()["normal"].mean(axis=0))
    gf = moved(contact)
    gf.vec.FV().NumPy()[0] = value
    return gf


@pytest.mark.parametrize(
    ("finite", "verb", "value"),
    [
        *((finite, "Update", value) for finite in (False, True) for value in ("apart", *NONE)),
        *((True, verb, value) for verb in ("Follow", "Commit") for value in ("sunk", *NONE)),
    ],
)
@pytest.mark.parametrize("dim", [2, 3])
def test_a_configuration_that_fails_changes_nothing(dim, finite, verb, value):
    contact = contact_form(block_mesh(dim), finite=finite, friction=0.3, maxdist=0.3)
    gf = moved(contact, upper=(0.02, -0.01, -0.01)[:dim])
    contact.Commit(gf)
    with_traction(contact, gf, 0.1)
    before = everything(contact, gf)
    words = r"never meet: .*(check the regions|give penetration)|NaN or inf|finite"
    with pytest.raises(NgException, match=words):
        getattr(contact, verb)(wrong(contact, value))
    assert everything(contact, gf) == before


@finite
@pytest.mark.parametrize("value", [-1.0, np.nan])
def test_an_update_with_wrong_friction_changes_nothing(mesh, finite, value):
    friction = Parameter(0.3)
    contact = contact_form(mesh, finite=finite, friction=friction)
    gf = with_traction(contact, moved(contact), 0.1)
    before = everything(contact, gf)
    friction.Set(value)
    with pytest.raises(NgException, match="friction is"):
        contact.Update()
    friction.Set(0.3)
    assert everything(contact, gf) == before


@finite
def test_a_first_update_that_fails_leaves_an_unpaired_contact(mesh, finite):
    contact, gf = fresh(mesh, finite=finite, friction=CF(-1.0))
    with pytest.raises(NgException, match="friction is -1"):
        contact.Update()
    assert not contact.form.paired
    for use in (contact.Force, contact.Table, lambda: contact.Evaluate(gf)):
        with pytest.raises(NgException, match="no pairing yet; call Update"):
            use()


PLAIN = ["Force", "Moment", "Table", "Restore", "Segments", "Check", "Mortar", "State", "Plot"]
NAMES = [*PLAIN, "Evaluate", "Commit", "Follow", "AssembleLinearization"]
NAMES += ["Apply", "AssembleStep", "SetState", "Draw", "SetConstant", "BeginSolve", "Table"]


def use(contact, gf, name):
    """Call a method that works on a pairing."""
    other = gf.vec.CreateVector()
    flags = {"Draw": {"show": False}}.get(name, {})
    arguments = {
        **dict.fromkeys(("Evaluate", "Commit", "Follow"), (gf,)),
        "AssembleLinearization": (gf.vec,),
        **dict.fromkeys(("Apply", "AssembleStep"), (gf.vec, other)),
        "SetState": ({"paired": None, "scaled": False},),
        "SetConstant": (C,),
    }
    owner = contact if hasattr(contact, name) else contact.form
    str(getattr(owner, name)(*arguments.get(name, ()), **flags))


@finite
@pytest.mark.parametrize("name", NAMES)
def test_nothing_crashes_before_the_first_update(mesh, finite, name):
    contact, gf = fresh(mesh, finite=finite)
    try:
        use(contact, gf, name)
    except NgException as error:
        assert "no pairing yet; call Update() first" in str(error)  # noqa: PT017


@pytest.mark.pairwise
@finite
@pytest.mark.parametrize("updated", [False, True])
@pytest.mark.parametrize("name", NAMES)
def test_nothing_crashes_after_a_refinement(finite, updated, name):
    contact, gf = fresh(block_mesh(2, 0.5), autoupdate=updated, finite=finite)
    contact.Update()
    contact.form.SetConstant(C)
    contact.mesh.Refine()
    try:
        use(contact, gf, name)
    except (NgException, ValueError) as error:
        assert "refinement" in str(error) or "entries" in str(error)  # noqa: PT017


def test_an_update_on_a_refined_mesh_wants_an_updated_space():
    contact, gf = fresh(block_mesh(2, 0.5), autoupdate=False)
    contact.mesh.Refine()
    with pytest.raises(NgException, match="the mesh was refined, but not its spaces"):
        contact.Update()
    gf.space.Update()
    contact.Update(gf)
    assert contact.Check().unpaired.size < contact.space.nmacros


@pytest.mark.parametrize("dim", [2, 3])
def test_restore_takes_back_a_finite_pairing(dim):
    contact = contact_form(block_mesh(dim), finite=True, friction=0.3)
    shift = np.array((0.02, 0.0, -0.01)[:dim])
    gf = with_traction(contact, moved(contact, upper=shift), 0.1)
    contact.Evaluate(gf)
    contact.Commit(gf)
    contact.Restore()
    before, table = resultants(contact), contact.Table()
    trial = with_traction(contact, moved(contact, upper=4 * shift), 0.2)
    contact.Follow(trial)
    contact.Evaluate(trial)
    assert abs(contact.Force() - before[0]).max() > 1e-3
    contact.Restore()
    after = resultants(contact)
    assert all(np.array_equal(a, b) for a, b in zip(before, after, strict=True))
    assert all(
        np.array_equal(values, table[name], equal_nan=True)
        for name, values in contact.Table().items()
    )


@pytest.mark.parametrize("dim", [2, 3])
def test_surfaces_farther_than_maxdist(dim):
    """With finite=True they may come back; beside each other they are wrong from the start."""
    small, contact = (contact_form(block_mesh(dim), finite=f, maxdist=0.21) for f in (False, True))
    out = -contact.Table()["normal"].mean(axis=0)
    words = r"never meet: .*within maxdist = 0\.21; check the regions"
    with pytest.raises(NgException, match=words):
        small.Update(moved(small, upper=0.22 * out))
    for verb in (contact.Follow, contact.Update):
        for way, meet in ((0.2, True), (0.22, False), (0.2, True)):
            verb(moved(contact, upper=way * out))
            assert np.any(contact.Table()["area"]) == meet
    with pytest.raises(NgException, match=words):
        contact.Update(wrong(contact, "apart"))


def test_a_step_that_tears_the_bodies_apart():
    """No partner far away: all is open, and without forces."""

    def energy(F):
        return 20 * Trace(F.trans * F) - 40 * log(Det(F)) + 30 * log(Det(F)) ** 2

    problem = Led(blocks2d(0.34), lambda t: (80 * t, -0.05 + 0 * t), order=1, friction=0.3,
                  energy=energy)  # fmt: skip
    problem.run(1e-3)
    assert np.any(problem.table()["pressure"] > 0)
    problem.run(1.0)
    table = problem.table()
    assert not np.any(table["area"])
    assert table["pressure"] == pytest.approx(0, abs=1e-12)
    assert problem.contact.Force() == pytest.approx(0, abs=1e-12)


@pytest.mark.parametrize("verb", ["Update", "Follow"])
def test_a_grid_function_of_another_space(mesh, verb):
    contact, gf = fresh(mesh, finite=True)
    other = GridFunction(gf.space.components[0] * gf.space.components[1] * gf.space.components[1])
    with pytest.raises(Exception, match="gf lives on another space"):
        getattr(contact, verb)(other)


@pytest.mark.parametrize(
    ("flags", "words"),
    [
        ({"friction": CF((1, 2))}, "friction has 2 components: it must be one number at each"),
        ({"tresca": CF((1, 2, 3))}, "tresca has 3 components"),
        ({"obstacle": CF((0, 0.1)), "master": None}, "obstacle has 2 components"),
        ({"friction": CF(1j)}, "friction is complex: it must be one real number"),
        ({"obstacle": CF(0.1j), "master": None}, "obstacle is complex"),
        ({"obstacle": np.inf, "master": None}, "obstacle = inf must be a finite number"),
        ({"tresca": -1}, "tresca = -1 must be a finite number >= 0"),
        ({"finite": True, "obstacle": 1 + 0 * x, "master": None}, "does not depend on"),
        (
            {"finite": True, "obstacle": "plane", "master": None},
            "obstacle = .plane. must be a",
        ),
        ({"master": "slave"}, "finite=True"),  # a surface on itself
    ],
)
def test_what_a_contact_cannot_be_made_of(mesh, flags, words):
    with pytest.raises((ValueError, TypeError, NgException), match=words):
        fresh(mesh, **flags)


@pytest.mark.parametrize("name", ["friction", "tresca"])
@pytest.mark.parametrize("value", [sqrt(x - 0.3), 0.1 / (x - x), x - 0.3])
def test_functions_that_are_wrong_in_parts_are_named_with_a_place(mesh, name, value):
    contact, _ = fresh(mesh, **{name: value})
    with pytest.raises(
        NgException, match=rf"{name} is -?[\d.einaf-]+ at \(.*must be a number >= 0"
    ):
        contact.Update()
