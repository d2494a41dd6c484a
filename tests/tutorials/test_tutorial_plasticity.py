"""Tutorial 07, plasticity under contact, runs, and what it computes is right."""

import numpy as np
import pytest
from indentation import PRANDTL, OnsetPressure
from notebooks import Errors, Execute, Pictures

pytestmark = pytest.mark.slow

# The first exercise is done here: the cylinder is pressed in again.
VALUES = """
end = dict(rows[-1], gap=contact.gap.vec.FV().NumPy().min())
accumulated = Integrate(alpha * dx(intrules=rules), mesh)
stepper.Integrate(deepest, steps=4, callback=Record, printing=False)
residual, lifted = gf.vec.CreateVector(), GridFunction(V)
a.Apply(gf.vec, residual)
lifted.Set((0, 1), definedon=mesh.Boundaries("bottom"))
VALUES = dict(
    hertz=dict(peak=hertz.peak, width=hertz.halfwidth), nodes=nodes, elastic=elastic,
    mean=hertz.MeanPressure(nodes[:-1], nodes[1:]), onset=1 / computed.max(),
    depths=depths, forces=forces, loading=loading, last=last, end=end, again=rows[-1],
    accumulated=[accumulated, Integrate(alpha * dx(intrules=rules), mesh)],
    reaction=2 * InnerProduct(residual[: V.ndof], lifted.vec),
    solves=[row["iterations"] for row in rows], cuts=sum(row["cuts"] for row in rows),
    scaled=scaled, means=means, along=along, loaded=loaded, free=free, Y=Y.Get(), R=R,
    slope=slope, punch=punch, spent=spent, stored=stored, dissipated=dissipated,
)
"""
NAME = "07_plasticity"


@pytest.fixture(scope="module")
def plasticity():
    return Execute(NAME, VALUES)


def test_no_errors_in_plasticity(plasticity):
    _, outputs = plasticity
    assert not Errors(outputs)
    assert Pictures(outputs) == 3


def test_elastic_contact_is_that_of_hertz(plasticity):
    values = plasticity[0]
    hertz, lengths = values["hertz"], np.diff(values["nodes"])
    pressure = np.array(values["elastic"]["pressure"])
    assert pressure.max() == pytest.approx(hertz["peak"], rel=0.01)
    assert values["elastic"]["width"] == pytest.approx(hertz["width"], rel=0.06)
    error = pressure - values["mean"]
    assert lengths @ error**2 < 0.06**2 * (lengths @ values["mean"] ** 2)


def test_first_yield(plasticity):
    assert OnsetPressure(0.3) == pytest.approx(1.79, abs=0.005)
    assert plasticity[0]["onset"] == pytest.approx(OnsetPressure(0.3), rel=0.03)


def test_steps_of_the_indentation(plasticity):
    values = plasticity[0]
    assert values["cuts"] <= 1
    assert max(values["solves"]) <= 25
    loading = values["loading"]
    assert np.all(np.diff(values["forces"][: loading + 1]) > 0)
    assert np.all(np.diff(values["forces"][loading:]) < 0)


def test_mean_pressure_from_hertz_to_prandtl(plasticity):
    values = plasticity[0]
    scaled, means = values["scaled"], values["means"]
    assert 3.6 < scaled[0] < 5
    assert 60 < scaled[-1] < 75
    assert means[0] == pytest.approx(np.pi / 8 * scaled[0], rel=0.1)
    assert np.all(np.diff(means) > -0.03)
    assert 0.88 * PRANDTL < means[-1] < PRANDTL


def test_pressure_gets_flat(plasticity):
    values = plasticity[0]
    pressure = np.array(values["last"]["pressure"]) / values["Y"]
    inner = pressure[values["nodes"][1:] < 0.9 * values["last"]["width"]]
    assert len(inner) > 20
    assert inner.std() < 0.08 * inner.mean()
    assert inner.mean() == pytest.approx(2.73, rel=0.03)
    # An ellipse would end with less than half of its peak.
    assert inner[-3:].mean() > 0.9 * inner[:3].mean()


def test_imprint(plasticity):
    values = plasticity[0]
    along, loaded, free = (values[name] for name in ("along", "loaded", "free"))
    depth, end = values["depths"].max(), values["end"]
    assert abs(end["force"]) < 1e-9
    assert -free[0] == pytest.approx(end["depth"] + end["gap"], rel=0.02)
    assert -free[0] / depth == pytest.approx(0.74, abs=0.02)
    assert 0.006 < free.max() < 0.013  # piles up, outside of the contact
    assert along[free.argmax()] > values["last"]["width"]
    assert loaded.max() < 0
    inner = along < 0.8 * values["last"]["width"]
    cylinder = values["R"] - np.sqrt(values["R"] ** 2 - along**2) - depth
    np.testing.assert_allclose(loaded[inner], cylinder[inner], atol=0.01 * depth)
    radius = 0.5 / np.polyfit(along[inner], free[inner], 2)[0]
    assert 1.02 * values["R"] < radius < 1.2 * values["R"]


def test_unloading_begins_like_a_punch(plasticity):
    values = plasticity[0]
    assert values["slope"] == pytest.approx(values["punch"], rel=0.02)


def test_work(plasticity):
    values = plasticity[0]
    spent, stored, plastic = (values[name] for name in ("spent", "stored", "dissipated"))
    assert stored + plastic == pytest.approx(spent, rel=0.005)
    assert plastic == pytest.approx(0.9 * spent, rel=0.03)


def test_loading_again_is_elastic(plasticity):
    values = plasticity[0]
    assert values["again"]["force"] == pytest.approx(values["last"]["force"], rel=2e-3)
    before, after = values["accumulated"]
    assert after == pytest.approx(before, rel=2e-3)


def test_forces_balance(plasticity):
    values = plasticity[0]
    assert values["reaction"] == pytest.approx(values["again"]["force"], rel=1e-8)
