"""Linear elasticity against the textbook's formulas, the neo-Hooke energy by differences."""

import math

import numpy as np
import pytest
from netgen.occ import unit_cube, unit_square
from ngsolve import CF, Grad, GridFunction, Id, Integrate, Mesh, Parameter, Sym, VectorH1, x, y, z

from ngslac.materials import NeoHooke, Stress

YOUNG, NU = 210.0, 0.3
MU, LAME = YOUNG / (2 * (1 + NU)), YOUNG * NU / ((1 + NU) * (1 - 2 * NU))
STRAIN = {
    2: np.array([[0.3, -0.1], [-0.1, 0.7]]),
    3: np.array([[0.3, -0.1, 0.2], [-0.1, 0.7, 0.4], [0.2, 0.4, -0.5]]),
}


@pytest.fixture(params=[2, 3])
def dim(request):
    return request.param


@pytest.fixture(scope="module")
def meshes():
    return {2: Mesh(unit_square.GenerateMesh(maxh=1)), 3: Mesh(unit_cube.GenerateMesh(maxh=1))}


def tensor(array):
    return CF(tuple(np.ravel(array)), dims=np.shape(array))


def value(function, mesh):
    return np.array(function(mesh(*(0.3, 0.2, 0.1)[: mesh.dim]))).reshape(tuple(function.dims))


def test_hooke(meshes, dim):
    strain = STRAIN[dim]
    wanted = 2 * MU * strain + LAME * np.trace(strain) * np.eye(dim)
    assert value(Stress(tensor(strain), YOUNG, NU), meshes[dim]) == pytest.approx(wanted, rel=1e-14)


def test_plane_strain_is_a_solid_held_across(meshes):
    held = np.zeros((3, 3))
    held[:2, :2] = STRAIN[2]
    solid = value(Stress(tensor(held), YOUNG, NU), meshes[3])
    plane = value(Stress(tensor(STRAIN[2]), YOUNG, NU), meshes[2])
    assert plane == pytest.approx(solid[:2, :2], rel=1e-14)


def test_plane_stress_is_a_solid_free_across(meshes):
    free = np.zeros((3, 3))
    free[:2, :2] = STRAIN[2]
    free[2, 2] = -NU / (1 - NU) * np.trace(STRAIN[2])
    solid = value(Stress(tensor(free), YOUNG, NU), meshes[3])
    plane = value(Stress(tensor(STRAIN[2]), YOUNG, NU, plane="stress"), meshes[2])
    assert solid[2] == pytest.approx([0, 0, 0], abs=1e-13)
    assert plane == pytest.approx(solid[:2, :2], rel=1e-14)


def test_a_bar_in_tension_has_youngs_modulus(meshes):
    bar = np.diag([1, -NU, -NU])
    solid = value(Stress(tensor(bar), YOUNG, NU), meshes[3])
    plane = value(Stress(tensor(bar[:2, :2]), YOUNG, NU, plane="stress"), meshes[2])
    assert solid == pytest.approx(np.diag([YOUNG, 0, 0]), abs=1e-12)
    assert plane == pytest.approx(np.diag([YOUNG, 0]), abs=1e-12)


@pytest.mark.parametrize("plane", ["strain", "stress"])
def test_constants_that_vary(meshes, plane):
    nu = Parameter(0.1)
    strain = tensor(STRAIN[2])
    stress = Stress(strain, YOUNG * (1 + x), nu, plane=plane)
    nu.Set(NU)
    wanted = 1.3 * value(Stress(strain, YOUNG, NU, plane=plane), meshes[2])
    assert value(stress, meshes[2]) == pytest.approx(wanted, rel=1e-14)


def test_neo_hooke_by_hand(meshes, dim):
    F = np.eye(dim) + 0.5 * STRAIN[dim]
    J, bulk = np.linalg.det(F), YOUNG / (3 * (1 - 2 * NU))
    squares = np.sum(F * F) + 3 - dim
    shape = MU / 2 * (J ** (-2 / 3) * squares - 3)
    wanted = shape + bulk / 4 * (J * J - 1 - 2 * math.log(J))
    energy = NeoHooke(tensor(F), YOUNG, NU)
    assert value(energy, meshes[dim]) == pytest.approx(wanted, rel=1e-13)


def test_neo_hooke_turned_or_at_rest(meshes):
    turn = np.array([[0.6, -0.8], [0.8, 0.6]])
    assert value(NeoHooke(tensor(turn), YOUNG, NU), meshes[2]) == pytest.approx(0, abs=1e-12)
    stretch = np.array([[1.2, 0.1], [0.1, 0.8]])
    ahead, turned = (NeoHooke(tensor(F), YOUNG, NU) for F in (stretch, turn @ stretch))
    assert value(turned, meshes[2]) == pytest.approx(value(ahead, meshes[2]), rel=1e-12)


def test_neo_hooke_at_small_strains_is_hooke(meshes, dim):
    strain, step = STRAIN[dim], 1e-4
    at = [
        value(NeoHooke(tensor(np.eye(dim) + s * step * strain), YOUNG, NU), meshes[dim])
        for s in (1, -1)
    ]
    stress = value(Stress(tensor(strain), YOUNG, NU), meshes[dim])
    assert sum(at) / step**2 == pytest.approx(np.sum(stress * strain), rel=1e-5)


def test_the_derivative_of_neo_hooke(meshes, dim):
    mesh, step = meshes[dim], 1e-5
    u, direction = (GridFunction(VectorH1(mesh, order=2)) for _ in range(2))
    u.Set((0.1 * x * y, 0.05 * x - 0.1 * y, 0.1 * x * z)[:dim])
    direction.Set((y * y, x, x - z)[:dim])
    energy = NeoHooke(Id(dim) + Grad(u), YOUNG, NU)
    along = Integrate(energy.Diff(u, direction), mesh)
    u.vec.data += step * direction.vec
    ahead = Integrate(energy, mesh)
    u.vec.data -= 2 * step * direction.vec
    behind = Integrate(energy, mesh)
    assert along == pytest.approx((ahead - behind) / (2 * step), rel=1e-6)


def test_of_a_space(meshes):
    u = GridFunction(VectorH1(meshes[2], order=1))
    u.Set((0.01 * x, 0))
    assert value(Stress(Sym(Grad(u)), YOUNG, NU), meshes[2])[1, 1] == pytest.approx(0.01 * LAME)


@pytest.mark.parametrize("law", [Stress, NeoHooke])
@pytest.mark.parametrize(
    ("young", "nu", "error", "words"),
    [
        (0, 0.3, ValueError, "young = 0 must be a finite number > 0"),
        (-1.0, 0.3, ValueError, "young = -1.0"),
        (math.inf, 0.3, ValueError, "young = inf"),
        ("steel", 0.3, TypeError, "young = 'steel'"),
        (CF((1, 2)), 0.3, ValueError, "young has 2 components"),
        (1.0, 0.5, ValueError, "nu = 0.5 must be a number between -1 and 1/2"),
        (1.0, -1, ValueError, "nu = -1"),
        (1.0, math.nan, ValueError, "nu = nan"),
        (1.0, None, TypeError, "nu = None"),
        (1.0, CF((0, 0, 0)), ValueError, "nu has 3 components"),
    ],
)
def test_refused_constants(law, young, nu, error, words):
    with pytest.raises(error) as caught:
        law(tensor(STRAIN[2]), young, nu)
    assert words in str(caught.value)


@pytest.mark.parametrize(("law", "name"), [(Stress, "strain"), (NeoHooke, "F")])
def test_refused_tensors(law, name):
    with pytest.raises(TypeError, match=f"{name} = array.* must be a coefficient function"):
        law(STRAIN[2], 1.0, 0.3)
    for shape in ((), (3,), (2, 3)):
        with pytest.raises(ValueError, match=rf"{name} must be .*\(2, 2\) or \(3, 3\), got shape"):
            law(tensor(np.ones(shape)), 1.0, 0.3)


def test_refused_planes():
    with pytest.raises(ValueError, match="plane = 'strains' must be one of 'strain', 'stress'"):
        Stress(tensor(STRAIN[2]), 1.0, 0.3, plane="strains")
    with pytest.raises(ValueError, match=r"plane = 'stress' needs a strain of shape \(2, 2\)"):
        Stress(tensor(STRAIN[3]), 1.0, 0.3, plane="stress")
