"""A frictional problem in 3D does not depend on the frame nor on the units."""

from dataclasses import dataclass

import numpy as np
import pytest
from ngsolve import (
    CF,
    BilinearForm,
    Grad,
    GridFunction,
    Id,
    IfPos,
    InnerProduct,
    Parameter,
    Sym,
    Trace,
    VectorH1,
    ds,
    dx,
    x,
    y,
    z,
)
from scipy.spatial.transform import Rotation

from ngslac import BubbleVectorH1, ContactSolver, LACContact, LACSpace, LoadStepper
from ngslac.meshes.blocks3d import TwoBlocks3D

TOL = 1e-9


@dataclass
class Outcome:
    displacement: np.ndarray  # at some points, in the first frame and in metres
    table: dict
    force: np.ndarray
    steps: list


def Run(*, rotation=None, length=1.0, stress=1.0, space="P2", kinds=("hex", "tet")):
    """Pressed and pushed aside in two steps, with stick, slip and open in the end.

    One metre is `length` units of the computation, one pascal `stress` units; springs and clamp
    act in all directions, so that nothing but the loads refers to the frame.
    """
    R = np.eye(3) if rotation is None else rotation
    mesh = TwoBlocks3D(*kinds, 3, 2, overhang=0.2, aligned=False, scale=length, rotation=R)
    if space == "P2":
        V = VectorH1(mesh, order=2, dirichlet="bottom")
    else:
        V = BubbleVectorH1(mesh, order=1, slave="slave", dirichlet="bottom")
    X = V * LACSpace(V, slave="slave")
    (u, lam), (v, _) = X.TnT()
    local = [sum(R[j, i] * c for j, c in enumerate((x, y, z))) / length for i in range(3)]
    push = (0.005, 0.003, -0.02 + 0.02 * local[0] + 0.01 * local[1])
    push = [length * sum(R[i, j] * push[j] for j in range(3)) for i in range(3)]
    load, strain = Parameter(0.0), Sym(Grad(u))
    sigma = stress * (80 * strain + 60 * Trace(strain) * Id(3))
    a = BilinearForm(X)
    a += InnerProduct(sigma, Sym(Grad(v))) * dx
    a += 1000 * stress / length * InnerProduct(u - load * CF(tuple(push)), v) * ds("top")
    contact = LACContact(u, lam, master="master", friction=IfPos(local[0] - 0.3, 0.1, 2.0))
    gf = GridFunction(X)
    steps = LoadStepper(ContactSolver(a, gf, contact), load).Integrate(steps=2, printing=False)
    points = length * np.array([(0.2, 0.3, 0.4), (0.7, 0.6, -0.3), (0.55, 0.1, 0.9)]) @ R.T
    values = np.array([gf.components[0](mesh(*p)) for p in points]) @ R / length
    return Outcome(values, contact.Table(), contact.Force() @ R / stress / length**2, steps)


@pytest.fixture(scope="module", params=[("P2", ("hex", "tet")), ("bubble", ("tet", "prism_side"))])
def reference(request):
    space, kinds = request.param
    return {"space": space, "kinds": kinds}, Run(space=space, kinds=kinds)


def check_equal(found, expected, R=None, length=1.0, stress=1.0):
    R = np.eye(3) if R is None else R
    size = np.abs(expected.displacement).max()
    assert found.displacement == pytest.approx(expected.displacement, abs=TOL * size)
    peak = expected.table["pressure"].max()
    assert found.table["pressure"] / stress == pytest.approx(
        expected.table["pressure"], abs=TOL * peak
    )
    for name, unit in (("traction", stress * peak), ("slip", length * size), ("normal", 1.0)):
        turned = found.table[name] @ R / unit
        scale = {"traction": peak, "slip": size, "normal": 1.0}[name]
        assert turned == pytest.approx(expected.table[name] / scale, abs=TOL), name
    assert np.array_equal(found.table["status"], expected.table["status"])
    assert found.force == pytest.approx(expected.force, abs=TOL * np.abs(expected.force).max())


def test_the_reference_has_every_status(reference):
    assert set(reference[1].table["status"]) == {0, 1, 2}
    assert [step.cuts for step in reference[1].steps] == [0, 0]


@pytest.mark.parametrize("seed", [0, 1])
def test_rotation(reference, seed):
    flags, expected = reference
    R = Rotation.random(random_state=seed).as_matrix()
    check_equal(Run(rotation=R, **flags), expected, R=R)


@pytest.mark.parametrize(("length", "stress"), [(1e3, 1e-6), (1e-3, 1e9)])
def test_units(reference, length, stress):
    """Metres and pascals, millimetres and megapascals, kilometres and nanopascals."""
    flags, expected = reference
    check_equal(Run(length=length, stress=stress, **flags), expected, length=length, stress=stress)


def test_rotation_and_units_at_once(reference):
    flags, expected = reference
    R = Rotation.random(random_state=2).as_matrix()
    found = Run(rotation=R, length=1e3, stress=1e-6, **flags)
    check_equal(found, expected, R=R, length=1e3, stress=1e-6)
