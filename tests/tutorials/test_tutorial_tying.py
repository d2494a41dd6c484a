"""Tutorial 08, tying non-matching meshes, runs, and what it computes is right."""

import numpy as np
import pytest
from notebooks import Tutorial

tying = Tutorial("08_tying", """
VALUES = dict(
    patch=patch, heat_patch=heat_patch, top=top, radial=[lam_r, exact_r], hoop=[lam_t, exact_t],
    errors={f"{name} {order}": values for (name, order), values in errors.items()},
    pipe=[[R, *row] for R, row in pipe.items()], heated=heated(mesh(0.0545, 0)),
    share=tie.Flow()[0] / made,
)
""", pictures=3)  # fmt: skip


def test_patches(tying):
    """Linear displacement, constant traction, linear temperature: exact for each order."""
    assert tying.patch.shape == (3, 2)
    assert tying.patch.max() < 1e-12
    assert tying.heat_patch.max() < 1e-12


def test_tractions_are_those_of_kirsch(tying):
    """Of a tension of 1; each macro-element against the value in its middle."""
    for computed, exact in (tying.radial, tying.hoop):
        assert len(computed) == 25
        np.testing.assert_allclose(computed, exact, atol=0.004)
    assert tying.top == pytest.approx(3, rel=0.03)


@pytest.mark.parametrize("order", [1, 2])
def test_tied_is_as_good_as_conforming(tying, order):
    ratio = tying.errors[f"tied {order}"] / tying.errors[f"conforming {order}"]
    assert ratio[0].max() < 1.2  # four edges on the arc
    assert ratio[1:].max() < 1.1
    assert ratio.min() > 0.8


def test_rates(tying):
    """Displacement in L2 and stress; order 2 has more than 3 here, see the notebook."""

    def Rate(name):
        errors = tying.errors[name]
        return np.log2(errors[-2] / errors[-1])

    np.testing.assert_allclose(Rate("tied 1"), [2, 1], atol=0.1)
    displacement, stress = Rate("tied 2")
    assert displacement > 2.9
    assert stress == pytest.approx(2, abs=0.15)
    # With the multipliers on the coarse side it is half an order less, as in theory.
    np.testing.assert_allclose(Rate("tied, coarse slave 2"), [2.5, 1.5], atol=0.25)


def test_pipe(tying):
    """Temperature in pipe and insulation, flux of each macro-element, and their sum."""
    resistances, pipe, insulation, flux, total = tying.pipe.T
    np.testing.assert_allclose(resistances, [0, 0.05])
    assert pipe.max() < 1e-5
    assert insulation.max() < 2e-4
    assert flux.max() < 5e-3
    np.testing.assert_allclose(total, 1, rtol=1e-4)


def test_heated_from_within(tying):
    """T = a - s r^2 / (4 k1) + b ln r in the pipe, T = c ln(r / r2) outside, above 10 degrees."""
    (r1, ri, r2), (k1, k2), s, r = (0.05, 0.06, 0.1), (15.0, 0.5), 2e6, 0.0545
    system = [[1, np.log(r1), 0], [1, np.log(ri), -np.log(ri / r2)], [0, k1 / ri, -k2 / ri]]
    a, b, c = np.linalg.solve(system, [s * r1**2 / (4 * k1), s * ri**2 / (4 * k1), s * ri / 2])
    expected = 10 + a - s * r**2 / (4 * k1) + b * np.log(r)
    assert tying.heated == pytest.approx(expected, rel=1e-3)
    assert tying.share == pytest.approx(-k2 * c / (s * (ri**2 - r1**2) / 2), rel=1e-3)
