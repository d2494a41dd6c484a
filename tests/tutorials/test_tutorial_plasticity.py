"""Tutorial 07, plasticity under contact, runs, and what it computes is right."""

import numpy as np
import pytest
from indentation import PRANDTL, OnsetPressure
from notebooks import Tutorial

# The first exercise is done here: the cylinder is pressed in again.
plasticity = Tutorial("07_plasticity", """
end = dict(rows[-1], gap=np.nanmin(contact.gap.vec.FV().NumPy()))
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
""", pictures=3)  # fmt: skip


def test_elastic_contact_is_that_of_hertz(plasticity):
    hertz, lengths = plasticity.hertz, np.diff(plasticity.nodes)
    pressure = np.array(plasticity.elastic["pressure"])
    assert pressure.max() == pytest.approx(hertz["peak"], rel=0.01)
    assert plasticity.elastic["width"] == pytest.approx(hertz["width"], rel=0.06)
    error = pressure - plasticity.mean
    assert lengths @ error**2 < 0.06**2 * (lengths @ plasticity.mean**2)
    assert plasticity.onset == pytest.approx(OnsetPressure(0.3), rel=0.03)


def test_steps_of_the_indentation(plasticity):
    assert plasticity.cuts <= 1
    assert max(plasticity.solves) <= 25
    forces, loading = plasticity.forces, plasticity.loading
    assert np.all(np.diff(forces[: loading + 1]) > 0)
    assert np.all(np.diff(forces[loading:]) < 0)
    assert plasticity.slope == pytest.approx(plasticity.punch, rel=0.02)  # of unloading


def test_mean_pressure_from_hertz_to_prandtl(plasticity):
    scaled, means = plasticity.scaled, plasticity.means
    assert 3.6 < scaled[0] < 5
    assert 60 < scaled[-1] < 75
    assert means[0] == pytest.approx(np.pi / 8 * scaled[0], rel=0.1)
    assert np.all(np.diff(means) > -0.03)
    assert 0.88 * PRANDTL < means[-1] < PRANDTL


def test_pressure_gets_flat(plasticity):
    pressure = np.array(plasticity.last["pressure"]) / plasticity.Y
    inner = pressure[plasticity.nodes[1:] < 0.9 * plasticity.last["width"]]
    assert len(inner) > 20
    assert inner.std() < 0.08 * inner.mean()
    assert inner.mean() == pytest.approx(2.73, rel=0.03)
    # An ellipse would end with less than half of its peak.
    assert inner[-3:].mean() > 0.9 * inner[:3].mean()


def test_imprint(plasticity):
    along, loaded, free = plasticity.along, plasticity.loaded, plasticity.free
    depth, end, width = plasticity.depths.max(), plasticity.end, plasticity.last["width"]
    assert abs(end["force"]) < 1e-9
    assert -free[0] == pytest.approx(end["depth"] + end["gap"], rel=0.02)
    assert -free[0] / depth == pytest.approx(0.74, abs=0.02)
    assert 0.006 < free.max() < 0.013  # piles up, outside of the contact
    assert along[free.argmax()] > width
    assert loaded.max() < 0
    inner = along < 0.8 * width
    cylinder = plasticity.R - np.sqrt(plasticity.R**2 - along**2) - depth
    np.testing.assert_allclose(loaded[inner], cylinder[inner], atol=0.01 * depth)


def test_work(plasticity):
    spent, plastic = plasticity.spent, plasticity.dissipated
    assert plasticity.stored + plastic == pytest.approx(spent, rel=0.005)
    assert plastic == pytest.approx(0.9 * spent, rel=0.03)


def test_loading_again_is_elastic(plasticity):
    again = plasticity.again["force"]
    assert again == pytest.approx(plasticity.last["force"], rel=2e-3)
    before, after = plasticity.accumulated
    assert after == pytest.approx(before, rel=2e-3)
    assert plasticity.reaction == pytest.approx(again, rel=1e-8)
