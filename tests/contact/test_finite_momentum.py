"""Finite sliding: forces on both sides balance exactly, moments up to errors of discretisation.

What is left of the moments is that of  lam x (x - y)  from the gap that remains between points of
the slave and of the master although its mean vanishes.
"""

import numpy as np
import pytest
from finiteform import POSITIONS
from finitepress import Led, blocks2d, blocks3d
from ngsolve import CF, GridFunction, sin, x


def imbalance(problem, gf=None):
    """Sum of forces over their size, and of moments over the size of the forces."""
    gf, d = gf or problem.gf, problem.dim
    _, residual = problem.residuals(gf)
    forces = residual[: problem.reference.size].reshape(d, -1)
    ones = GridFunction(gf.components[0].space)
    ones.Set(CF((1,) * d))
    ones = ones.vec.FV().NumPy().reshape(d, -1)[0]
    table = problem.table(gf)
    size = table["area"] @ np.linalg.norm(table["traction"], axis=1)
    places = problem.reference + gf.components[0].vec.FV().NumPy().reshape(d, -1)
    moment = places @ forces.T
    assert size > 0
    return np.abs(forces @ ones).max() / size, np.abs(moment - moment.T).max() / size


def wavy(mesh, order):
    """Surfaces bent together, the upper one slid along."""
    problem = Led(mesh, None, order=order, friction=0.3)
    d = mesh.dim
    problem.contact.Update()
    problem.contact.form.SetConstant(1.0)
    slid = POSITIONS[0] + mesh.MaterialCF({"upper": 0.1, "lower": 0.0})
    bent = (slid, POSITIONS[1], POSITIONS[2])[:d]
    bent = [r + 0.1 * sin(2 * bent[i - 1] + i) for i, r in enumerate(bent)]
    problem.gf.components[0].Set(CF(tuple(bent)) - CF(POSITIONS[:d]))
    problem.contact.Follow(problem.gf)
    return problem


def worst(problem):
    """The largest imbalances of forces and moments under some smooth tractions."""
    contact, d = problem.contact, problem.dim
    table = problem.table()
    along = np.eye(d)[0] - table["normal"][:, :1] * table["normal"]
    found = []
    for phase in range(5):
        wave = np.sin(3 * table["x"][:, :1] + 2 * table["x"][:, -1:] + 1.3 * phase)
        tractions = -(1 + 0.4 * wave) * table["normal"] + 0.3 * wave * along
        problem.gf.vec.FV().NumPy()[contact.form.MultiplierDofs().reshape(-1, d)] = tractions
        found.append(imbalance(problem))
    return np.max(found, axis=0)


@pytest.mark.parametrize("quads", [False, True])
@pytest.mark.parametrize("order", [1, 2, 3])
def test_moments_in_two_dimensions(order, quads):
    coarse, fine = (worst(wavy(blocks2d(h, quads=quads), order)) for h in (0.1, 0.05))
    assert max(coarse[0], fine[0]) <= 1e-13
    assert 0 < coarse[1] <= 1e-5
    assert np.log2(coarse[1] / fine[1]) >= order + 0.8


@pytest.mark.parametrize(
    ("kinds", "order"), [(("hex", "hex"), 1), (("tet", "prism"), 1), (("tet", "prism"), 2)]
)
def test_moments_in_three_dimensions(kinds, order):
    """Twice the layers, and more than twice the faces."""
    coarse, fine = (
        worst(wavy(blocks3d(*kinds, n=n, layers=(layers, layers)), order))
        for n, layers in [((3, 2), 1), ((7, 5), 2)]
    )
    assert max(coarse[0], fine[0]) <= 1e-13
    assert 0 < coarse[1] <= 1e-3
    assert np.log2(coarse[1] / fine[1]) >= 2.5


CASES = {
    "in place": (lambda: blocks2d(0.2), 0.1, 0.3),
    "beyond the rim": (lambda: blocks2d(0.2, overhang=-0.2), 0.1, 0.3),
    "frictionless": (lambda: blocks2d(0.2), 0.1, None),
    "3D": (lambda: blocks3d("prism", "tet", n=(4, 3)), 0.05, 0.3),
}


@pytest.mark.parametrize("case", CASES)
def test_forces_of_a_solution_balance(case):
    """Exact, whatever lies between the surfaces; moments by the concentrated stress at edges."""
    make, slide, friction = CASES[case]
    mesh = make()

    def lead(load):
        down = load * (-0.05 + 0.08 * x)
        return (slide * load, down) if mesh.dim == 2 else (slide * load, 0.0, down)

    problem = Led(mesh, lead, order=1 if mesh.dim == 3 else 2, friction=friction)
    problem.run(1.0, steps=2)
    linear, angular = imbalance(problem)
    assert linear <= 1e-13
    assert angular <= 2e-3
    assert set(problem.table()["status"]) > {0}
