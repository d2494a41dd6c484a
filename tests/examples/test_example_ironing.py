"""Shallow ironing: forces against the published ones, convergence, command line."""

import json

import ironing
import numpy as np
import pytest
from commandline import Help, Refused
from ngsolve import BND, Integrate

from ngslac.reference.ironing import DECK, DECK_SMOOTH, PUBLISHED, TIMES

COARSE = {"h": 0.4, "steps": 36, "stroke": 5.0}


@pytest.fixture(scope="module")
def model():
    model = ironing.Ironing(h=COARSE["h"])
    model.Iron(COARSE["steps"], COARSE["stroke"])
    return model


@pytest.fixture(scope="module")
def figures(model):
    return model.Figures()


def At(figures, key, time):
    return np.interp(time, figures["time"], figures[key])


def test_every_step_converges_in_one_piece(figures):
    assert figures["converged_steps"] == 36 == len(figures["time"])
    assert sum(figures["cuts"]) == 0
    assert figures["time"][-1] == pytest.approx(1.5, abs=1e-12)
    assert max(figures["iterations"]) <= 12


def test_newton_converges_quadratically(figures):
    assert figures["quadratic"]


def test_no_force_before_the_contact(figures):
    assert figures["time"][0] < ironing.CLEARANCE
    assert figures["vertical_force"][0] == 0
    assert figures["horizontal_force"][0] == 0


@pytest.mark.parametrize(
    ("key", "time", "tolerance"),
    [
        ("vertical_force", 0.6, 0.03),
        ("vertical_force", 1.0, 0.03),
        ("vertical_force", 1.5, 0.03),
        ("horizontal_force", 1.0, 0.05),
        ("horizontal_force", 1.5, 0.12),
    ],
)
def test_forces_are_those_of_the_curves_of_code_aster(figures, key, time, tolerance):
    curve = PUBLISHED["code_aster 2020"][key == "horizontal_force"]
    published = curve[TIMES.index(time)]
    assert At(figures, key, time) == pytest.approx(published, rel=tolerance)


@pytest.mark.parametrize("time", DECK)
def test_forces_are_those_of_the_deck_of_code_aster(figures, time):
    vertical, horizontal = DECK[time]
    assert At(figures, "vertical_force", time) == pytest.approx(vertical, rel=0.012)
    assert At(figures, "horizontal_force", time) == pytest.approx(horizontal, rel=0.025)


def test_ratio_of_the_forces_is_in_the_published_range(figures):
    """The die also ploughs: the ratio is above the coefficient of friction."""
    ratio = At(figures, "horizontal_force", 1.5) / At(figures, "vertical_force", 1.5)
    published = [h[TIMES.index(1.5)] / v[TIMES.index(1.5)] for v, h in PUBLISHED.values()]
    assert min(published) <= ratio <= max(published)


def test_reaction_at_the_top_is_the_contact_force(model, figures):
    """The residual of the bulk on the dofs of the top, and all reactions in balance."""
    solver, V = model.stepper.solver, model.displacement.space
    bulk = solver.gf.vec.CreateVector()
    solver.a.Apply(solver.gf.vec, bulk)
    values = bulk.FV().NumPy()
    for k, sign, key in ((0, 1, "horizontal_force"), (1, -1, "vertical_force")):
        for region, side in (("top", 1), ("bottom", -1)):
            elements = model.mesh.Boundaries(region).Elements()
            # The vertex functions add up to 1: the others have no share in the resultant.
            vertices = sorted({v.nr for el in elements for v in el.vertices})
            total = values[V.Range(k).start + np.array(vertices)].sum()
            assert side * sign * total == pytest.approx(figures[key][-1], rel=1e-7, abs=1e-6)


def test_without_friction_nothing_holds_the_die_in_the_middle():
    figures = ironing.Run(**COARSE, friction=0.0)
    assert figures["converged_steps"] == figures["steps"] == 36
    assert figures["failure"] is None
    assert figures["quadratic"]
    vertical = At(figures, "vertical_force", 1.5)
    for time, published in DECK_SMOOTH.items():
        assert At(figures, "vertical_force", time) == pytest.approx(published, rel=0.02)
    assert vertical == pytest.approx(421, rel=0.01)  # h = 0.4 and 0.3 agree
    assert abs(At(figures, "horizontal_force", 1.5)) < 0.01 * vertical


def test_ironing_mesh():
    mesh = ironing.IroningMesh(0.3)
    assert set(mesh.GetMaterials()) == {"die", "slab"}
    assert Integrate(1, mesh) == pytest.approx(48 + 1.2 * 0.9 + 0.2516, abs=1e-4)
    foot, master = (
        np.array(
            [
                mesh.vertices[v.nr].point[0]
                for el in mesh.Boundaries(name).Elements()
                for v in el.vertices
            ]
        )
        for name in ("foot", "master")
    )
    assert np.abs(foot[:, None] - master).min() > 1e-3
    sizes = np.array(Integrate(1, mesh, BND, element_wise=True))
    names = [el.mat for el in mesh.Elements(BND)]
    assert sizes[[name == "master" for name in names]] == pytest.approx(0.3, abs=1e-6)


@pytest.mark.parametrize(
    ("residuals", "quadratic"),
    [
        ((1e-1, 1e-2, 1e-4, 1e-8, 1e-14), True),
        ((1e-1, 3e-2, 3e-3, 2e-6, 3e-11), True),
        ((1e-1, 2e-8, 8e-12), True),
        ((1e-1, 9e-5, 2e-10, 3e-13), True),
        ((0.5, 1e-12), True),
        ((), True),
        ((1e-2, 1e-4, 1e-6, 1e-8, 9e-11), False),
        ((1e-6, 1e-8, 1e-10, 1e-12), False),
        ((1e-1, 1e-2, 5e-8, 2e-9, 9e-11), False),
        ((1e-3, 2.7e-4, 7e-5, 2e-5, 5e-6), False),
    ],
)
def test_order_of_convergence(residuals, quadratic):
    assert ironing.Quadratic(residuals) is quadratic


def test_ironing_command(tmp_path, capsys):
    pytest.importorskip("matplotlib")
    file = tmp_path / "new" / "figures.json"
    options = ["--h", "0.6", "--steps", "8", "--stroke", "0.4", "--friction", "0.1"]
    ironing.main([*options, "--out", str(tmp_path), "--json", str(file)])
    figures = json.loads(file.read_text())
    assert figures["steps"] == figures["converged_steps"] == 8
    assert isinstance(figures["quadratic"], bool)
    assert len(figures["vertical_force"]) == len(figures["time"]) == len(figures["iterations"])
    assert f"t = 1.040: down {figures['vertical_force'][-1]:.1f}, right" in capsys.readouterr().out
    for name in ("ironing.png", "ironing.vtu"):
        assert (tmp_path / name).stat().st_size > 3000


@pytest.mark.parametrize(
    ("option", "value", "message"),
    [
        ("--steps", "1", "steps = 1"),
        ("--order", "1", "--order"),
        ("--h", "-1.0", "--h"),
        ("--stroke", "11.0", "stroke = 11"),
    ],
)
def test_ironing_refuses(option, value, message, capsys):
    assert message in Refused(capsys, ironing.main, option, value)


def test_ironing_help(capsys):
    assert "at least 2 (default: 80)" in Help(capsys, ironing.main)
