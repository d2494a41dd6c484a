"""Finite sliding: forces on both sides balance exactly, moments up to errors of discretisation.

What is left of the moments is that of  lam x (x - y)  from the gap that remains between points of
the slave and of the master although its mean vanishes.
"""

import numpy as np
import pytest
from blocks import macro_dofs
from finitepress import Led, blocks2d, blocks3d
from form import POSITIONS
from ngsolve import CF, sin, x


def imbalance(problem):
    """Sum of forces over their size, and of moments over the size of the forces."""
    gf, d = problem.gf, problem.dim
    _, residual = problem.residuals(gf)
    forces = residual[: problem.reference.size].reshape(d, -1)
    table = problem.table(gf)
    size = table["area"] @ np.linalg.norm(table["traction"], axis=1)
    places = problem.reference + gf.components[0].vec.FV().NumPy().reshape(d, -1)
    moment = places @ forces.T
    assert size > 0
    total = forces @ problem.nodal(CF((1,) * d))[0]
    return np.abs(total).max() / size, np.abs(moment - moment.T).max() / size


def wavy(mesh, order):
    """Surfaces bent together, the upper one slid along."""
    problem = Led(mesh, order=order, friction=0.3)
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
    d, table, found = problem.dim, problem.table(), []
    along = np.eye(d)[0] - table["normal"][:, :1] * table["normal"]
    for phase in range(5):
        wave = np.sin(3 * table["x"][:, :1] + 2 * table["x"][:, -1:] + 1.3 * phase)
        tractions = -(1 + 0.4 * wave) * table["normal"] + 0.3 * wave * along
        problem.gf.vec.FV().NumPy()[macro_dofs(problem.contact)] = tractions
        found.append(imbalance(problem))
    return np.max(found, axis=0)


def solids(*kinds):
    """Twice the layers, and more than twice the faces."""
    return [lambda: blocks3d(*kinds, n=(3, 2), layers=(1, 1)),
            lambda: blocks3d(*kinds, n=(7, 5), layers=(2, 2))]  # fmt: skip


def planes(quads):
    return [lambda: blocks2d(0.1, quads=quads), lambda: blocks2d(0.05, quads=quads)]


MOMENTS = [(planes(quads), order, 1e-5, order + 0.8) for quads in (False, True) for order in (1, 2)]
MOMENTS += [(planes(True), 3, 1e-5, 3.8)]
MOMENTS += [(solids("hex", "hex"), 1, 1e-3, 2.5)]
MOMENTS += [(solids("tet", "prism"), order, 1e-3, 2.5) for order in (1, 2)]


@pytest.mark.parametrize(("meshes", "order", "bound", "rate"), MOMENTS)
def test_moments_of_wavy_surfaces(meshes, order, bound, rate):
    coarse, fine = (worst(wavy(make(), order)) for make in meshes)
    assert max(coarse[0], fine[0]) <= 1e-13
    assert 0 < coarse[1] <= bound
    assert np.log2(coarse[1] / fine[1]) >= rate


SOLVED = {
    "in place": (lambda: blocks2d(0.2), 0.1, 0.3),
    "beyond the rim": (lambda: blocks2d(0.2, overhang=-0.2), 0.1, 0.3),
    "frictionless": (lambda: blocks2d(0.2), 0.1, None),
    "3D": (lambda: blocks3d("prism", "tet", n=(4, 3)), 0.05, 0.3),
}


@pytest.mark.parametrize(("make", "slide", "friction"), SOLVED.values(), ids=SOLVED)
def test_forces_of_a_solution_balance(make, slide, friction):
    """Exact, whatever lies between the surfaces; moments by the concentrated stress at edges."""
    mesh = make()

    def lead(load):
        return (slide * load, 0.0, load * (-0.05 + 0.08 * x))[:: 1 if mesh.dim == 3 else 2]

    problem = Led(mesh, lead, order=1 if mesh.dim == 3 else 2, friction=friction)
    problem.run(1.0, steps=2)
    linear, angular = imbalance(problem)
    assert linear <= 1e-13
    assert angular <= 2e-3
    assert set(problem.table()["status"]) > {0}
