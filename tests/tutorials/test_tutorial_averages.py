"""Tutorial 04, why averages, runs, and its three methods do what the text says of them."""

import numpy as np
import pytest
from notebooks import Tutorial

NODES, FACES, LAC = METHODS = ["node-to-segment", "one per face", "LAC"]
averages = Tutorial("04_why_averages", """
def Result(name, result):
    x, w, p, V, u = result
    C = Methods(V.mesh, V)[name][0] if V.ndof == 2 * V.mesh.nv else Averages(V)[0]
    gap = w * ((x - 0.5) ** 2 + (0 if name == "node-to-segment" else w**2 / 12)) / (2 * R)
    return dict(x=x, w=w, p=p, gap=gap - C @ u)


mesh = patch["LAC", 0.2][0].space.mesh
VALUES = dict(
    patch={f"{name} {h}": error for (name, h), error in errors.items()},
    moved={n: abs(C @ np.repeat([0, 1], mesh.nv)).max()
           for n, (C, *_) in Methods(mesh, patch["LAC", 0.2][0].space).items()},
    masterforces={n: patch[n, 0.2][2][mesh.nv :][master] / lengths for n in cases["fine master"]},
    reference=Result("LAC", reference),
    cases={case: {name: Result(name, r) for name, r in results.items()}
           for case, results in cases.items()},
    divisions=divisions, infsup={n: [c[n] for c in constants] for n in constants[0]},
    clamped=clamped,
)
""", pictures=3)  # fmt: skip


@pytest.mark.parametrize("h", [0.2, 0.1, 0.05])
def test_patch(averages, h):
    """Node-to-segment fails it by half of the stress, however fine the mesh; averages pass."""
    pressure, stress = averages.patch[f"{NODES} {h}"]
    assert pressure > 0.07
    assert 0.5 < stress < 0.65
    for name in FACES, LAC:
        assert max(averages.patch[f"{name} {h}"]) < 1e-9


def test_what_the_methods_measure_and_hand_on(averages):
    assert max(averages.moved[name] for name in METHODS) < 1e-14  # no gap where all move together
    forces = averages.masterforces
    assert forces[NODES].min() < 1e-12  # some nodes of the master get nothing
    assert forces[NODES].max() > 1.9
    for name in FACES, LAC:
        np.testing.assert_allclose(forces[name], 1, rtol=0, atol=1e-10)
    assert "no macro-element can be made of 1 face(s)" in averages.text


CASES = ["coarse master", "fine master"]


@pytest.mark.parametrize("case", CASES)
@pytest.mark.parametrize("name", METHODS)
def test_contact_conditions(averages, case, name):
    state = averages.cases[case][name]
    p, gap, w = state["p"], state["gap"], state["w"]
    assert w @ p == pytest.approx(1, rel=1e-9)  # the load
    assert p.min() >= 0
    assert gap.min() > -1e-14
    assert abs(p * gap).max() < 1e-14
    assert (p == 0).any()  # the ends stay open
    assert (p > 0).sum() > len(p) / 2


def Turns(values):
    """How often rising changes to falling, and back."""
    rising = np.sign(np.diff(values))
    return np.count_nonzero(np.diff(rising[rising != 0]))


@pytest.mark.parametrize("case", CASES)
def test_lac_follows_the_reference(averages, case):
    x = (np.arange(4000) + 0.5) / 4000

    def Steps(state):
        number = np.searchsorted(state["w"].cumsum(), x)
        return state["p"][number.clip(max=len(state["p"]) - 1)]

    exact, lac = Steps(averages.reference), Steps(averages.cases[case][LAC])
    assert np.linalg.norm(lac - exact) < 0.15 * np.linalg.norm(exact)
    assert lac.max() == pytest.approx(exact.max(), rel=0.025)
    assert Turns(averages.cases[case][LAC]["p"]) == 1  # up, then down: no oscillation


def test_the_others_oscillate(averages):
    coarse, fine = (averages.cases[case] for case in CASES)
    peak, p = averages.reference["p"].max(), coarse[FACES]["p"]
    assert p.max() > 1.5 * peak
    assert p[6:14].min() < 0.3
    assert Turns(p[3:17]) > 8  # up and down from face to face
    assert fine[FACES]["p"].max() == pytest.approx(peak, rel=0.01)
    assert 1.08 < fine[NODES]["p"].max() / peak < 1.15
    assert Turns(fine[NODES]["p"]) > 6


def test_inf_sup_constants(averages):
    constants = dict(averages.infsup)
    assert averages.divisions.tolist() == [4, 8, 16, 32]
    unstable = constants.pop("order 1, one per face")
    np.testing.assert_allclose(unstable[:-1] / unstable[1:], 1.95, atol=0.06)  # like h
    assert unstable[-1] == pytest.approx(0.057, rel=0.01)
    limits = {"order 1, LAC: two faces": 0.736, "order 1 + bubbles, LAC: one face": 0.821}
    limits |= {"order 2, LAC: one face": 0.852, "node-to-segment": 1}
    assert {name: c[-1] for name, c in constants.items()} == pytest.approx(limits, rel=0.01)
    assert all(c[-1] > 0.97 * c[-2] for c in constants.values())
    clamped = dict(averages.clamped)  # beside a clamped end
    assert clamped.pop("order 1, one per face") < 1e-6
    assert len(clamped) == 3
    assert min(clamped.values()) > 0.7
