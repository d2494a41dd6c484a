"""NAFEMS contact benchmark 1 as a slice in 3D: a steel cylinder on an aluminium block (T05).

Plane strain by two planes of symmetry, small strain, no friction, slave faces of 1 mm; half of the
model with 17.5 kN per mm. References: Hertz (pressure 3585.4 MPa, half width 6.2146 mm), and the
displacement -1.2734 mm of the block under the axis from an independent program with the same
multipliers. The cylinder consists of flat faces: their middles lie 0.0025 mm, or 0.2 % of the
displacement, inside of the circle.
"""

from dataclasses import dataclass

import numpy as np
import pytest
from elasticity3d import Solid
from ngsolve import BilinearForm, Grad, GridFunction, InnerProduct, Integrate, Sym, VectorH1, dx
from sector3d import SliceMesh

from ngslac import ContactSolver, LACContact, LACSpace
from ngslac.meshes import HertzMesh
from ngslac.reference import HertzLine

FORCE, SIZE, THICKNESS = 17.5e3, 1.0, 2.0
DISPLACEMENT = -1.2734
HERTZ = HertzLine(force=2 * FORCE, radius1=50.0, young1=210e3, nu1=0.3, young2=70e3, nu2=0.3)


@dataclass(frozen=True)
class Outcome:
    displacement: float
    table: dict  # macro-elements ordered by x
    force: np.ndarray


@pytest.fixture(scope="module")
def outcome():
    mesh = SliceMesh(HertzMesh(SIZE, order=1, zone=8.0, grading=0.5), THICKNESS)
    V = VectorH1(
        mesh, order=2, dirichletx="sym|bottom", dirichlety="front|back", dirichletz="bottom"
    )
    X = V * LACSpace(V, slave="slave")
    (u, lam), (v, _) = X.TnT()
    strain = Sym(Grad(u))
    stress = {"cylinder": Solid(210e3, 0.3), "block": Solid(70e3, 0.3)}
    stress = mesh.MaterialCF({name: solid.Stress(strain) for name, solid in stress.items()})
    weight = FORCE * THICKNESS / Integrate(1, mesh.Materials("cylinder"))
    a, gf = BilinearForm(X), GridFunction(X)
    a += InnerProduct(stress, Sym(Grad(v))) * dx + weight * v[2] * dx("cylinder")
    contact = LACContact(u, lam, master="master")
    ContactSolver(a, gf, contact).Solve(printing=False)
    table = contact.Table()
    order = np.argsort(table["x"][:, 0])
    table = {name: values[order] for name, values in table.items()}
    return Outcome(gf.components[0](mesh(1e-9, 0.5, -1e-9))[2], table, contact.Force())


def test_pressure_in_the_middle_of_the_slice(outcome):
    assert pytest.approx(3585.4, abs=0.1) == HERTZ.peak
    assert outcome.table["pressure"][0] == pytest.approx(HERTZ.peak, rel=5e-3)


def test_displacement_of_the_block_under_the_axis(outcome):
    assert outcome.displacement == pytest.approx(DISPLACEMENT, rel=2e-3)


def test_contact_ends_within_one_face_of_hertz(outcome):
    x, closed = outcome.table["x"][:, 0], outcome.table["status"] > 0
    end = x[closed].max() + SIZE / 2
    assert end == pytest.approx(HERTZ.halfwidth, abs=SIZE)
    assert np.all(closed[: closed.sum()])  # no holes


def test_pressure_profile_is_that_of_hertz(outcome):
    """In the mean over each face, in the L2 norm."""
    ends = 50 * np.sin(SIZE / 50 * np.arange(len(outcome.table["pressure"]) + 1))
    exact = HERTZ.MeanPressure(ends[:-1], ends[1:])
    error = np.linalg.norm(outcome.table["pressure"] - exact) / np.linalg.norm(exact)
    assert error <= 0.05


def test_resultant_of_the_slice(outcome):
    assert outcome.force == pytest.approx([outcome.force[0], 0, FORCE * THICKNESS], rel=1e-8, abs=1)
    # The planes of symmetry x = 0 carry the rest; nothing acts across the slice.
    assert abs(outcome.force[1]) <= 1e-8 * FORCE
