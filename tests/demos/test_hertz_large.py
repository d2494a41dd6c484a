"""The flattened cylinder: against Hertz, energy, an independent penalty solution, command line."""

import json

import numpy as np
import pytest
from ngsolve import (
    BND,
    CF,
    BilinearForm,
    Grad,
    GridFunction,
    Id,
    IfPos,
    InnerProduct,
    Integrate,
    Variation,
    VectorH1,
    ds,
    dx,
    y,
)

from ngslac.demos import hertz_large
from ngslac.demos._hertz_large_figures import EnergyError, HertzForce
from ngslac.demos._hertz_large_model import Approach, CylinderMesh
from ngslac.materials import NeoHooke

CONVERGED = 0.6282  # N/mm at the approach 0.3: 0.62828 for h = 0.025, 0.62817 for h = 0.0125


@pytest.fixture(scope="module")
def results():
    return hertz_large.Run(h=0.1, steps=15)


@pytest.fixture(scope="module")
def figures(results):
    return results.figures


def test_every_step_converges_in_one_piece(figures):
    assert figures["failure"] is None
    assert figures["converged_steps"] == 15
    assert figures["cuts"] == 0


def test_work_is_the_strain_energy(figures):
    assert abs(figures["energy_error"]) < 2e-3


def test_final_force(figures):
    assert figures["force"][-1] == pytest.approx(CONVERGED, rel=3e-3)
    assert figures["force"][-1] > 1.2 * figures["hertz"][-1]


def test_no_sideways_force_without_friction(results):
    """The plate is flat, its normal vertical; that of the faces is as good as the mesh."""
    last = results.states[-1]
    assert last.sideways < 0.02 * last.force


def test_small_loads_are_those_of_hertz():
    figures = hertz_large.Run(h=0.02, depth=0.02, steps=2).figures
    assert figures["force"] == pytest.approx(figures["hertz"], rel=0.01)
    halfwidth = 2 * np.sqrt(figures["force"][-1] * (1 - 0.49**2) / np.pi)
    assert figures["halfwidth"][-1] == pytest.approx(halfwidth, abs=0.02)


def Penalty(h, depth, steps, factor):
    """Force by a penalty on the rigid plane y = 0, by NGSolve alone."""
    mesh = CylinderMesh(h)
    V = VectorH1(
        mesh, order=2, dirichletx="sym", dirichlety="middle", definedon=mesh.Materials("cylinder")
    )
    u, gf, down = V.TrialFunction(), GridFunction(V), GridFunction(V)
    below = -(y + u[1])
    a = BilinearForm(V)
    a += Variation(NeoHooke(Id(2) + Grad(u), 1.0, 0.49).Compile() * dx("cylinder"))
    a += Variation(factor / 2 * IfPos(below, below, 0) ** 2 * ds("slave", bonus_intorder=10))
    down.Set(CF((0, -depth / steps)))
    residual, step = gf.vec.CreateVector(), gf.vec.CreateVector()
    for _ in range(steps):
        gf.vec.data += down.vec
        for _ in range(40):
            a.Apply(gf.vec, residual)
            a.AssembleLinearization(gf.vec)
            step.data = a.mat.Inverse(V.FreeDofs()) * residual
            gf.vec.data -= step
            if abs(InnerProduct(step, residual)) < 1e-22:
                break
        else:
            raise RuntimeError("the penalty solution does not converge")
    below = -(y + gf[1])
    pressure = factor * IfPos(below, below, 0)
    return 2 * Integrate(pressure, mesh, BND, definedon=mesh.Boundaries("slave"), order=20)


def test_against_an_independent_solution(figures):
    """The error of the penalty is in proportion to its inverse: extrapolated."""
    soft, stiff = (Penalty(0.1, 0.3, 10, factor) for factor in (200, 800))
    assert stiff + (stiff - soft) / 3 == pytest.approx(figures["force"][-1], rel=4e-3)


def test_friction_stiffens(figures):
    rough = hertz_large.Run(h=0.2, steps=6, friction=0.5)
    smooth = hertz_large.Run(h=0.2, steps=6)
    assert rough.figures["force"][-1] > 1.01 * smooth.figures["force"][-1]
    assert smooth.figures["force"][-1] == pytest.approx(CONVERGED, rel=0.03)


def test_hertz_force_inverts_the_approach():
    for force in (1e-4, 1e-2, 0.3):
        assert HertzForce(Approach(force, 2.0, 0.3), 2.0, 0.3) == pytest.approx(force, rel=1e-10)


def test_energy_error_of_a_cubic():
    d = np.linspace(0.1, 1, 10)
    assert EnergyError(d, d**3, d**4 / 4) == pytest.approx(0, abs=1e-12)
    assert EnergyError(d, 1.1 * d**3, d**4 / 4) == pytest.approx(0.1, abs=1e-12)


def test_mesh():
    mesh = CylinderMesh(0.1)
    area = Integrate(CF(1), mesh, definedon=mesh.Materials("cylinder"))
    assert area == pytest.approx(np.pi / 4, rel=1e-6)
    assert set(mesh.GetMaterials()) == {"cylinder", "plate"}
    xs = {
        name: np.array(
            sorted(
                {
                    mesh.vertices[v.nr].point[0]
                    for el in mesh.Boundaries(name).Elements()
                    for v in el.vertices
                }
            )
        )
        for name in ("slave", "master")
    }
    distance = np.abs(xs["slave"][:, None] - xs["master"][None, :])
    distance[0, 0] = np.inf  # both at x = 0
    assert distance.min() > 1e-5


def test_command_line(tmp_path, capsys):
    pytest.importorskip("matplotlib")
    file, picture = tmp_path / "new" / "figures.json", tmp_path / "picture.png"
    options = ["--h", "0.2", "--steps", "2", "--depth", "0.1", "--order", "3"]
    files = ["--out", str(tmp_path), "--picture", str(picture), "--json", str(file)]
    hertz_large.main([*options, *files])
    figures = json.loads(file.read_text())
    assert figures["converged_steps"] == 2
    assert "Hertz" in capsys.readouterr().out
    for name in ("hertz_large.png", "hertz_large.vtu", "picture.png"):
        assert (tmp_path / name).stat().st_size > 5000


def test_table():
    rows = hertz_large.Table([0.4, 0.2], depth=0.1, steps=2)
    assert [row["h"] for row in rows] == [0.4, 0.2]
    assert rows[0]["ndof"] < rows[1]["ndof"]


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"steps": 0}, "steps"),
        ({"order": 1}, "order"),
        ({"nu": 0.5}, "nu"),
        ({"depth": 0.8}, "depth"),
        ({"h": 0.0}, "h must be positive"),
    ],
)
def test_bad_options(options, message):
    with pytest.raises(ValueError, match=message):
        hertz_large.Run(**options)
