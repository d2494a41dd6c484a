"""Linear elasticity against the textbook's formulas, the neo-Hooke energy by differences."""

import math
import re
import warnings

import numpy as np
import pytest
from netgen.occ import unit_cube, unit_square
from ngsolve import (
    CF,
    H1,
    BilinearForm,
    Grad,
    GridFunction,
    Id,
    Integrate,
    Mesh,
    Parameter,
    Variation,
    VectorH1,
    dx,
    x,
    y,
    z,
)
from refused import calls, check_refused
from scipy.optimize import brentq

from ngslac import ContactSolver, LACContact, LACSpace, LoadStepper
from ngslac.materials import NeoHooke, Stress

YOUNG, NU = 210.0, 0.3
MU, LAME = YOUNG / (2 * (1 + NU)), YOUNG * NU / ((1 + NU) * (1 - 2 * NU))
STRAIN3 = np.array([[0.3, -0.1, 0.2], [-0.1, 0.7, 0.4], [0.2, 0.4, -0.5]])
STRAIN = {2: STRAIN3[:2, :2], 3: STRAIN3}
MESHES = {2: Mesh(unit_square.GenerateMesh(maxh=1)), 3: Mesh(unit_cube.GenerateMesh(maxh=1))}


@pytest.fixture(params=[2, 3])
def dim(request):
    return request.param


def tensor(array):
    return CF(tuple(np.ravel(array)), dims=np.shape(array))


def value(law, array, **plane):
    """Of a law, of a tensor given by numbers; in a point."""
    function = law(tensor(array), YOUNG, NU, **plane)
    point = MESHES[len(array)](*(0.3, 0.2, 0.1)[: len(array)])
    return np.array(function(point)).reshape(tuple(function.dims))


def solid(across):
    """Stress of a solid in which the plane strain has this strain across it."""
    strain = np.zeros((3, 3))
    strain[:2, :2], strain[2, 2] = STRAIN[2], across
    return value(Stress, strain)


def test_hooke(dim):
    wanted = 2 * MU * STRAIN[dim] + LAME * np.trace(STRAIN[dim]) * np.eye(dim)
    assert value(Stress, STRAIN[dim]) == pytest.approx(wanted, rel=1e-14)


def test_planes_are_solids_held_or_free_across():
    assert value(Stress, STRAIN[2]) == pytest.approx(solid(0)[:2, :2], rel=1e-14)
    free = solid(-NU / (1 - NU) * np.trace(STRAIN[2]))
    assert free[2] == pytest.approx([0, 0, 0], abs=1e-13)
    assert value(Stress, STRAIN[2], plane="stress") == pytest.approx(free[:2, :2], rel=1e-14)


@pytest.mark.parametrize("plane", ["strain", "stress"])
def test_constants_that_vary(plane):
    nu = Parameter(0.1)
    stress = Stress(tensor(STRAIN[2]), YOUNG * (1 + x), nu, plane=plane)
    nu.Set(NU)
    wanted = 1.3 * value(Stress, STRAIN[2], plane=plane)
    assert stress(MESHES[2](0.3, 0.2)) == pytest.approx(np.ravel(wanted), rel=1e-14)


def test_neo_hooke_by_hand(dim):
    F = np.eye(dim) + 0.5 * STRAIN[dim]
    J, bulk = np.linalg.det(F), YOUNG / (3 * (1 - 2 * NU))
    squares = np.sum(F * F) + 3 - dim
    shape = MU / 2 * (J ** (-2 / 3) * squares - 3)
    wanted = shape + bulk / 4 * (J * J - 1 - 2 * math.log(J))
    assert value(NeoHooke, F) == pytest.approx(wanted, rel=1e-13)


def test_neo_hooke_turned_or_at_rest():
    turn = np.array([[0.6, -0.8], [0.8, 0.6]])
    assert value(NeoHooke, turn) == pytest.approx(0, abs=1e-12)
    stretch = np.array([[1.2, 0.1], [0.1, 0.8]])
    assert value(NeoHooke, turn @ stretch) == pytest.approx(value(NeoHooke, stretch), rel=1e-12)


def test_neo_hooke_at_small_strains_is_hooke(dim):
    strain, step = STRAIN[dim], 1e-4
    energy = sum(value(NeoHooke, np.eye(dim) + s * step * strain) for s in (1, -1))
    work = np.sum(value(Stress, strain) * strain)
    assert energy / step**2 == pytest.approx(work, rel=1e-5)


def test_the_derivative_of_neo_hooke(dim):
    mesh, step = MESHES[dim], 1e-5
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


def test_neo_hooke_with_a_pressure(dim):
    """At the pressure where the energy is stationary it is that of K/2 (J - 1)^2."""
    F = np.eye(dim) + 0.5 * STRAIN[dim]
    J, bulk = np.linalg.det(F), YOUNG / (3 * (1 - 2 * NU))
    shape = value(NeoHooke, F) - bulk / 4 * (J * J - 1 - 2 * math.log(J))
    stationary = -bulk * (J - 1)
    for off in (0.0, 5.0):
        found = value(NeoHooke, F, pressure=CF(stationary + off))
        wanted = shape + bulk / 2 * (J - 1) ** 2 - off**2 / (2 * bulk)
        assert found == pytest.approx(wanted, rel=1e-12)


@pytest.mark.parametrize("nu", [0.3, 0.4999, 0.5])
def test_rubber_on_a_rigid_floor(nu):
    """Evenly pressed by contact without friction: all of it in closed form."""
    mesh, young, depth = Mesh(unit_square.GenerateMesh(maxh=0.3)), 3.0, 0.15
    V = VectorH1(mesh, order=2, dirichletx="left", dirichlety="top")
    fes = V * H1(mesh, order=1) * LACSpace(V, slave="bottom")
    u, p, lam = fes.TrialFunction()
    a = BilinearForm(fes)
    a += Variation(NeoHooke(Id(2) + Grad(u), young, nu, pressure=p) * dx)
    contact, load = LACContact(u, lam, obstacle=y), Parameter(0)
    solver = ContactSolver(a, GridFunction(fes), contact)
    down = {"top": load * CF((0, -depth))}
    steps = LoadStepper(solver, load, prescribe=down).Integrate(1, steps=1, printing=False)
    assert steps[0].iterations <= 8
    along, mu, softness = 1 - depth, young / (2 * (1 + nu)), 3 * (1 - 2 * nu) / young

    def Pressed(across):
        """The pressure at which nothing pulls across, and the force, of this stretch."""
        J = across * along
        shear, squares = mu * J ** (-2 / 3), across**2 + along**2 + 1
        pressure = shear * (across**2 - squares / 3) / J
        return pressure, shear * (along - squares / 3 / along) - pressure * across

    wide = brentq(lambda across: Pressed(across)[0] * softness + across * along - 1, 0.9, 1.4)
    assert contact.Force()[1] == pytest.approx(-Pressed(wide)[1], rel=1e-8)


@pytest.mark.parametrize("nu", [0.3, 0.499])
def test_a_long_first_solve_of_rubber_names_the_pressure(nu):
    """A ContactWarning with the ratio of Poisson; none where the volume changes easily."""
    mesh = Mesh(unit_square.GenerateMesh(maxh=0.12))
    V = VectorH1(mesh, order=2, dirichlet="top")
    fes = V * LACSpace(V, slave="bottom")
    u, lam = fes.TrialFunction()
    a = BilinearForm(fes)
    a += Variation(NeoHooke(Id(2) + Grad(u), 3.0, nu) * dx)
    contact, load = LACContact(u, lam, obstacle=y), Parameter(0)
    solver = ContactSolver(a, GridFunction(fes), contact)
    stepper = LoadStepper(solver, load, prescribe={"top": load * CF((0, -0.12))})
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        steps = stepper.Integrate(1, steps=1, printing=False)
    said = " ".join(str(warning.message) for warning in caught)
    if nu == 0.3:
        assert "volume" not in said
    else:
        assert steps[0].iterations > 20
        found = re.search(r"taken (\d+) iter.* ratio about (\S+)\): .* pressure=p", said)
        assert int(found[1]) == steps[0].iterations
        assert float(found[2]) == pytest.approx(nu, abs=1e-3)


CONSTANTS = [
    ("0, NU", "young = 0 must be a finite number > 0", ValueError),
    ("-1.0, NU", "young = -1.0", ValueError),
    ("math.inf, NU", "young = inf", ValueError),
    ("'steel', NU", "young = 'steel'", TypeError),
    ("CF((1, 2)), NU", "young has 2 components", ValueError),
    ("YOUNG, 0.5", "nu = 0.5 must be a number between -1 and 1/2", ValueError),
    ("YOUNG, -1", "nu = -1", ValueError),
    ("YOUNG, math.nan", "nu = nan", ValueError),
    ("YOUNG, None", "nu = None", TypeError),
    ("YOUNG, CF((0, 0, 0))", "nu has 3 components", ValueError),
]
SHAPE = r"must be .*\(2, 2\) or \(3, 3\), got shape"
REFUSED = [
    *((f"{law}(PLANE, {c})", *error) for law in ("Stress", "NeoHooke") for c, *error in CONSTANTS),
    *(
        (f"{law}(tensor(np.ones({shape})), YOUNG, NU)", f"{name} {SHAPE}", ValueError)
        for law, name in (("Stress", "strain"), ("NeoHooke", "F"))
        for shape in ((), (3,), (2, 3))
    ),
    ("Stress(STRAIN[2], YOUNG, NU)", "strain = array.* must be a coefficient function", TypeError),
    ("NeoHooke(PLANE, YOUNG, 0.51, pressure=CF(0))", "nu = 0.51 must be .* 1/2 too", ValueError),
    (
        "NeoHooke(PLANE, YOUNG, 0.5, pressure=1.0)",
        "pressure = 1.0 must be a scalar trial",
        TypeError,
    ),
    ("NeoHooke(PLANE, YOUNG, 0.5, pressure=CF((1, 2)))", "pressure .* got 2 comp", ValueError),
    ("NeoHooke(STRAIN[2], YOUNG, NU)", "F = array.* must be a coefficient function", TypeError),
    (
        "Stress(PLANE, YOUNG, NU, plane='strains')",
        "plane = 'strains' must be one of 'strain', 'stress'",
        ValueError,
    ),
    (
        "Stress(tensor(STRAIN[3]), YOUNG, NU, plane='stress')",
        r"plane = 'stress' needs a strain of shape \(2, 2\)",
        ValueError,
    ),
]


@calls(REFUSED)
def test_refused(row):
    check_refused(row, **globals(), PLANE=tensor(STRAIN[2]))
