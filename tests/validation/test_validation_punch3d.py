"""NAFEMS contact benchmark 2: a punch with a rounded edge on an elastic foundation (T15).

A sector of five degrees between two planes of symmetry stands for the body of revolution. Data in
mm and MPa: punch of steel, radius 50, height 100, fillet 10; foundation of aluminium, radius 100,
height 200, fixed at its bottom; pressure 100 on top of the punch. Displacements are a thousandth of
the size: small strain.

Published is the displacement of the middle, from axisymmetric elements: -0.130734 mm (linear) and
-0.132941 mm (quadratic) without friction, -0.128580 and -0.130794 with friction 0.1. The two kinds
of elements differ by 1.7 %. The mesh here has elements of 0.4 mm at the edge of the contact; with
0.2 mm the displacement changes by 0.02 %. The published stress (-91 and -94 MPa), extrapolated from
coarse elements, is not compared: on the axis the pressure is 87.5 MPa on both meshes, it equals
the stress in both bodies, and an axisymmetric computation agrees with it.
"""

from dataclasses import dataclass

import numpy as np
import pytest
from elasticity3d import Solid
from netgen.occ import Compound, OCCGeometry, WorkPlane
from ngsolve import (
    CF,
    BilinearForm,
    Grad,
    GridFunction,
    InnerProduct,
    Integrate,
    Mesh,
    Parameter,
    Sym,
    VectorH1,
    ds,
    dx,
)
from sector3d import SectorMesh

from ngslac import ContactSolver, LACContact, LACSpace

PUBLISHED = {0.0: -0.132941, 0.1: -0.130794}  # quadratic elements, mm
LOAD = 100.0
ANGLE = np.radians(5.0)
EDGE = 40.0  # where the fillet begins
STEEL, ALUMINIUM = Solid(210e3, 0.3), Solid(70e3, 0.3)


def HalfSection(h):
    """Punch and foundation in the (r, z) plane, elements of size h at the edge of the contact."""
    punch = WorkPlane().MoveTo(0, 0).Line(EDGE).Arc(10, 90).Line(90).Rotate(90).Line(50).Close()
    base = WorkPlane().MoveTo(0, -200).Line(100).Rotate(90).Line(200).Rotate(90)
    base = base.Line(98 - EDGE).Line(EDGE + 2).Close()
    bodies = {"punch": punch.Face(), "foundation": base.Face()}
    for name, body in bodies.items():
        body.faces.name = name
        for edge in body.edges:
            r, z = edge.center.x, edge.center.y
            if name == "punch":
                edge.name = "slave" if z < 9 else "top" if z > 99 else "side"
                edge.maxh = 3 if edge.name == "slave" and r > 1 else 25
            else:
                edge.name = "master" if abs(z) < 1e-9 else "bottom" if z < -199 else "side"
                edge.maxh = 25 if edge.name != "master" or r < 1 else 4 if r < EDGE else 8
        for vertex in body.vertices:
            if abs(vertex.p[1]) < 1e-9 and EDGE <= vertex.p[0] < EDGE + 3:
                vertex.maxh = h if name == "punch" else 1.3 * h
    geometry = OCCGeometry(Compound(list(bodies.values())), dim=2)
    return Mesh(geometry.GenerateMesh(maxh=25, grading=0.3))


@dataclass(frozen=True)
class Outcome:
    foundation: float  # displacement along z at the axis
    punch: float
    table: dict  # macro-elements ordered by their distance from the axis
    radius: np.ndarray
    force: np.ndarray
    load: float

    @classmethod
    def Of(cls, mesh, friction):
        V = VectorH1(mesh, order=2, dirichlety="front", dirichlet="bottom")
        X = V * LACSpace(V, slave="slave")
        (u, lam), (v, _) = X.TnT()
        strain = Sym(Grad(u))
        stress = mesh.MaterialCF(
            {"punch": STEEL.Stress(strain), "foundation": ALUMINIUM.Stress(strain)}
        )
        across = CF((-np.sin(ANGLE), np.cos(ANGLE), 0))
        a, gf = BilinearForm(X), GridFunction(X)
        a += InnerProduct(stress, Sym(Grad(v))) * dx + LOAD * v[2] * ds("top")
        # The oblique plane of symmetry by stiff springs; their effect is below 1e-6.
        a += 1e5 * STEEL.young * (u * across) * (v * across) * ds("oblique")
        contact = LACContact(u, lam, master="master", friction=friction)
        ContactSolver(a, gf, contact).Solve(printing=False)
        table = contact.Table()
        radius = np.hypot(*table["x"][:, :2].T)
        order = np.argsort(radius)
        axis = [gf.components[0](mesh(1e-9, 0, z))[2] for z in (-1e-9, 1e-9)]
        load = LOAD * Integrate(CF(1), mesh.Boundaries("top"))
        table = {name: values[order] for name, values in table.items()}
        return cls(*axis, table, radius[order], contact.Force(), load)


@pytest.fixture(scope="module")
def outcomes():
    mesh = SectorMesh(HalfSection(0.4), ANGLE)
    return {friction: Outcome.Of(mesh, Parameter(friction)) for friction in PUBLISHED}


@pytest.mark.parametrize("friction", PUBLISHED)
def test_displacement_on_the_axis(outcomes, friction):
    outcome = outcomes[friction]
    assert outcome.foundation == pytest.approx(PUBLISHED[friction], rel=0.01)
    assert outcome.punch == pytest.approx(outcome.foundation, abs=1e-5)


def test_friction_stiffens_as_published(outcomes):
    change = outcomes[0.1].foundation - outcomes[0.0].foundation
    assert change == pytest.approx(PUBLISHED[0.1] - PUBLISHED[0.0], rel=0.02)
    assert outcomes[0.1].table["pressure"][0] > outcomes[0.0].table["pressure"][0]


@pytest.mark.parametrize("friction", PUBLISHED)
def test_the_punch_is_in_equilibrium(outcomes, friction):
    outcome = outcomes[friction]
    assert outcome.force[2] == pytest.approx(outcome.load, rel=1e-9)
    assert outcome.load == pytest.approx(LOAD * 50**2 / 2 * np.sin(ANGLE), rel=1e-6)


@pytest.mark.parametrize("friction", PUBLISHED)
def test_pressure_rises_to_the_edge(outcomes, friction):
    """Like that of a flat punch, from 87 % of the load in the middle; it ends on the fillet."""
    outcome = outcomes[friction]
    pressure, closed = outcome.table["pressure"], outcome.table["status"] > 0
    assert outcome.radius[closed].max() == pytest.approx(EDGE, abs=1)
    assert np.all(np.diff(closed.astype(int)) <= 0)
    assert np.all(np.diff(pressure[closed]) > 0)
    assert pressure[0] == pytest.approx(87.5 if friction == 0 else 88.9, rel=0.01)


def test_the_middle_sticks_and_the_outside_slips(outcomes):
    table, radius = outcomes[0.1].table, outcomes[0.1].radius
    slips, sticks = table["status"] == 2, table["status"] == 1
    assert radius[sticks].max() < radius[slips].min()
    shear = table["traction"] + table["pressure"][:, None] * table["normal"]
    size = np.linalg.norm(shear, axis=1)
    np.testing.assert_allclose(size[slips], 0.1 * table["pressure"][slips], rtol=1e-9)
    # The foundation moves inwards under the stiffer punch, and pulls it along.
    assert np.all(shear[slips, 0] < 0)
    # Nothing acts across the sector, but for its flat faces.
    middle = np.array([-np.sin(ANGLE / 2), np.cos(ANGLE / 2), 0])
    assert np.abs(shear @ middle).max() <= 1e-3 * size.max()
