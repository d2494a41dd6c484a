"""Tutorial 08, tying non-matching meshes, runs, and what it computes is right."""

import numpy as np
import pytest
from notebooks import Errors, Execute, Pictures

pytestmark = pytest.mark.slow

VALUES = """
VALUES = dict(
    patch=patch, heat_patch=heat_patch, top=top, radial=[lam_r, exact_r], hoop=[lam_t, exact_t],
    errors={f"{name} {order}": values for (name, order), values in errors.items()},
    pipe=[[R, *row] for R, row in pipe.items()], same=same, heated=heated(mesh(0.0545, 0)),
)
"""


@pytest.fixture(scope="module")
def tying():
    return Execute("08_tying", VALUES)


def Rates(values, name):
    errors = values["errors"][name]
    return np.log2(errors[:-1] / errors[1:])


def test_no_errors_and_pictures(tying):
    _, outputs = tying
    assert not Errors(outputs)
    assert Pictures(outputs) == 3


def test_patch(tying):
    """Linear displacement, constant traction: exact for each order."""
    values, _ = tying
    assert values["patch"].shape == (3, 2)
    assert values["patch"].max() < 1e-12


def test_patch_of_heat(tying):
    assert tying[0]["heat_patch"].max() < 1e-12


@pytest.mark.parametrize(("component", "tol"), [("radial", 0.004), ("hoop", 0.004)])
def test_tractions_are_those_of_kirsch(tying, component, tol):
    """Of a tension of 1; each macro-element against the value in its middle."""
    computed, exact = tying[0][component]
    assert len(computed) == 25
    np.testing.assert_allclose(computed, exact, atol=tol)


def test_stress_concentration(tying):
    assert tying[0]["top"] == pytest.approx(3, rel=0.03)


@pytest.mark.parametrize("order", [1, 2])
def test_tied_is_as_good_as_conforming(tying, order):
    errors = tying[0]["errors"]
    ratio = errors[f"tied {order}"] / errors[f"conforming {order}"]
    assert ratio[0].max() < 1.2  # four edges on the arc
    assert ratio[1:].max() < 1.1
    assert ratio.min() > 0.8


def test_rates(tying):
    """Displacement in L2 and stress; order 2 has more than 3 here, see the notebook."""
    values, _ = tying
    np.testing.assert_allclose(Rates(values, "tied 1")[-1], [2, 1], atol=0.1)
    displacement, stress = Rates(values, "tied 2")[-1]
    assert displacement > 2.9
    assert stress == pytest.approx(2, abs=0.15)


def test_rates_with_multipliers_on_the_coarse_side(tying):
    """Half an order less, as in theory."""
    displacement, stress = Rates(tying[0], "tied, coarse slave 2")[-1]
    assert displacement == pytest.approx(2.5, abs=0.25)
    assert stress == pytest.approx(1.5, abs=0.25)


def test_pipe(tying):
    """Temperature in pipe and insulation, flux of each macro-element, and their sum."""
    resistances, *errors = tying[0]["pipe"].T
    np.testing.assert_allclose(resistances, [0, 0.05])
    pipe, insulation, flux, total = errors
    assert pipe.max() < 1e-5
    assert insulation.max() < 2e-4
    assert flux.max() < 5e-3
    np.testing.assert_allclose(total, -1, rtol=1e-4)


def test_both_ways_to_tie_a_scalar(tying):
    assert tying[0]["same"] < 1e-9


def test_heated_from_within(tying):
    """T = a - s r^2 / (4 k1) + b ln r in the pipe, T = c ln(r / r2) outside, above 10 degrees."""
    (r1, ri, r2), (k1, k2), s = (0.05, 0.06, 0.1), (15.0, 0.5), 2e6
    system = [
        [1, np.log(r1), 0],
        [1, np.log(ri), -np.log(ri / r2)],
        [0, k1 / ri, -k2 / ri],
    ]
    a, b, _ = np.linalg.solve(system, [s * r1**2 / (4 * k1), s * ri**2 / (4 * k1), s * ri / 2])
    r = 0.0545
    expected = 10 + a - s * r**2 / (4 * k1) + b * np.log(r)
    assert tying[0]["heated"] == pytest.approx(expected, rel=1e-3)
