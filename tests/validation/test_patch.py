"""Patch tests (T01): a constant stress passes a non-matching interface without error.

The exact solution is in the discrete spaces, hence the only errors are those of rounding. The two
blocks are loaded by the tractions of the constant stress wherever they do not touch and are not
held; the displacements where they are held are exact.
"""

import math

import numpy as np
import pytest
from elasticity import Displacements, Material, Pair
from ngsolve import CF, H1, FESpace, TaskManager, VectorH1, VectorValued, x, y

from ngslac.meshes import TwoBlocks

TOL = 1e-12
HELD = "bottom|left_upper"
FREE = "top|right_upper|left_lower|right_lower|(master|slave)_(left|right)"
PRESSURE, SHEAR, FRICTION = 25.0, 4.0, 0.3
KINDS = ["P1", "P1split", "P1bubble", "P2", "P3"]
MESHES = {
    "flat": {},
    "coarse slave": {"h_slave": 0.34, "h_master": 0.1},
    "fine slave": {"h_slave": 0.1, "h_master": 0.34},
    "oblique": {"shape": "oblique"},
    "rotated": {"angle": 37.0},
    "structured": {"structured": True},
    "structured oblique": {"structured": True, "shape": "oblique", "slope": -31.0},
    "quads": {"quads": True},
    "quad grid": {"quads": True, "structured": True, "shape": "oblique"},
    "wide master": {"overhang": 0.3},
    "wide slave": {"overhang": -0.3, "shape": "oblique"},
}
CURVED = {
    "curved": {"curved": True},
    "curved oblique": {"curved": True, "shape": "oblique", "h_slave": 0.34, "h_master": 0.2},
    "curved quads": {"curved": True, "quads": True},
    "curved cubic": {"curved": True, "order": 3},
}
# Traction of the contact, and slip of the slave, that fit each law.
LAWS = {
    "frictionless": ({}, 0.0, 0.0),
    "stick": ({"friction": FRICTION}, SHEAR, 0.0),
    "slip": ({"friction": FRICTION}, FRICTION * PRESSURE, -2e-3),
    "slip back": ({"friction": FRICTION}, -FRICTION * PRESSURE, 1e-3),
    "tresca": ({"tresca": SHEAR}, SHEAR, -1e-3),
    "tied": ({"tied": True}, SHEAR, 0.0),
}


def Frame(slope=20.0, shape="flat", angle=0.0, **_):
    """Tangent, and normal out of the upper block."""
    a = math.radians(angle + (slope if shape == "oblique" else 0.0))
    return np.array([math.cos(a), math.sin(a)]), np.array([math.sin(a), -math.cos(a)])


def Stress(options, *, shear=0.0, pressure=PRESSURE, along=-7.0):
    """A constant stress with the given traction on the interface."""
    t, n = Frame(**options)
    across = np.outer(n, t) + np.outer(t, n)
    return -pressure * np.outer(n, n) + shear * across + along * np.outer(t, t)


def Linear(gradient, shift=(0.0, 0.0), middle=(0.5, 0.0)):
    """A linear displacement without rotation about the middle of the interface."""
    r = [x - middle[0], y - middle[1]]
    return CF(tuple(gradient[i, 0] * r[0] + gradient[i, 1] * r[1] + shift[i] for i in range(2)))


def Middle(options):
    a = math.radians(options.get("angle", 0.0))
    return 0.5 * math.cos(a), 0.5 * math.sin(a)


def Tractions(mesh, stress, options):
    """Of a constant stress on all outer boundaries."""
    n = Frame(**options)[1]
    right, up = Frame(angle=options.get("angle", 0.0))
    normals = {"top": -up, "bottom": up, "left_": -right, "right_": right, "master": -n, "slave": n}
    names = mesh.GetBoundaries()
    where = {name: v for name in names for key, v in normals.items() if name.startswith(key)}
    return mesh.BoundaryCF({name: tuple(stress @ v) for name, v in where.items()})


def Patch(pair, options, stress, *, slip=0.0, lower=None):
    """Load, hold and solve; returns the largest errors of stress and traction."""
    mesh, size = pair.mesh, np.abs(stress).max()
    upper = pair.material if isinstance(pair.material.young, float) else Material()
    fields = {
        "left_upper": Linear(upper.Strain(stress), slip * Frame(**options)[0], Middle(options)),
        "bottom": Linear((lower or upper).Strain(stress), middle=Middle(options)),
    }
    pair.Hold(mesh.BoundaryCF(fields), HELD)
    pair.Load(Tractions(mesh, stress, options), FREE)
    pair.Solve(tol=1e-13)
    table = pair.contact.Table()
    exact = np.where(table["area"][:, None] > 0, table["normal"] @ stress, 0.0)
    return pair.StressError(stress), np.abs(table["traction"] - exact).max() / size


def CheckLaw(options, kind, law, *, slave="slave", master="master"):
    flags, shear, slip = LAWS[law]
    mesh = TwoBlocks(**{"h_slave": 0.25, **options})
    V = Displacements(mesh, kind, slave=slave, dirichlet=HELD)
    pair = Pair(V, Material(), slave=slave, master=master, **flags)
    stress = Stress(options, shear=shear)
    errors = Patch(pair, options, stress, slip=slip)
    assert max(errors) <= TOL
    table = pair.contact.Table()
    size = np.abs(stress).max() / 2000.0
    closed = table["area"] > 0
    assert np.abs(table["gap"][closed]).max() <= TOL * size
    assert set(table["status"][closed]) == {2 if slip or law == "frictionless" else 1}
    if slip:
        side = 1 if slave == "slave" else -1
        assert table["slip"] == pytest.approx(
            np.tile(side * slip * Frame(**options)[0], (len(closed), 1)), rel=1e-10, abs=1e-13
        )


@pytest.mark.pairwise
@pytest.mark.parametrize("law", ["frictionless", "stick", "slip"])
@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("mesh", MESHES)
def test_constant_stress(mesh, kind, law):
    CheckLaw(MESHES[mesh], kind, law)


@pytest.mark.pairwise
@pytest.mark.parametrize("law", ["frictionless", "stick", "slip back"])
@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("mesh", ["oblique", "quad grid", "wide master", "wide slave"])
def test_slave_and_master_swapped(mesh, kind, law):
    CheckLaw(MESHES[mesh], kind, law, slave="master", master="slave")


@pytest.mark.parametrize("law", ["frictionless", "stick", "slip"])
@pytest.mark.parametrize(
    ("mesh", "kind"),
    [(m, k) for m in CURVED for k in ("P2", "P3") if (m, k) != ("curved cubic", "P2")],
)
def test_curved_interior_edges(mesh, kind, law):
    """A space has the linear functions of x and y if its order is at least that of the elements."""
    CheckLaw(CURVED[mesh], kind, law)


@pytest.mark.parametrize("law", ["slip back", "tresca"])
@pytest.mark.parametrize("kind", KINDS)
def test_other_laws(kind, law):
    CheckLaw(MESHES["oblique"], kind, law)


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("mesh", ["oblique", "quads", "wide slave", "wide master"])
def test_tied(mesh, kind):
    CheckLaw(MESHES[mesh], kind, "tied")


@pytest.mark.parametrize("kind", KINDS)
def test_tied_takes_tension(kind):
    options = MESHES["structured oblique"]
    V = Displacements(TwoBlocks(**options), kind, dirichlet=HELD)
    pair = Pair(V, Material(), tied=True)
    stress = Stress(options, pressure=-PRESSURE, shear=3 * PRESSURE, along=11.0)
    assert max(Patch(pair, options, stress)) <= TOL


@pytest.mark.parametrize("kind", KINDS)
def test_slave_region_reaches_beyond_the_master(kind):
    """Macro-elements without partner stay open while their faces carry the load."""
    options = {"overhang": -0.3, "h_slave": 0.2, "shape": "oblique"}
    mesh, region = TwoBlocks(**options), "slave|slave_left|slave_right"
    V = Displacements(mesh, kind, slave=region, dirichlet=HELD)
    pair = Pair(V, Material(), slave=region, friction=FRICTION)
    stress = Stress(options, shear=SHEAR)
    assert max(Patch(pair, options, stress)) <= TOL
    table = pair.contact.Table()
    assert np.any(table["area"] == 0)
    assert table["area"].sum() == pytest.approx(1 / math.cos(math.radians(20)), rel=1e-13)


@pytest.mark.parametrize("kind", KINDS)
def test_two_materials(kind):
    """Without friction the blocks may extend differently along the interface."""
    options = MESHES["oblique"]
    mesh = TwoBlocks(**options)
    soft = Material(young=60.0)
    young = mesh.MaterialCF({"upper": Material().young, "lower": soft.young})
    V = Displacements(mesh, kind, dirichlet=HELD)
    pair = Pair(V, Material(young=young))
    assert max(Patch(pair, options, Stress(options), lower=soft)) <= TOL


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("young", [2e-6, 2000.0, 2e11])
def test_as_published(kind, young):
    """The case of code_aster SSNP170: pressure on top, one symmetry and one support per block."""
    mesh = TwoBlocks(0.25, quads=kind == "P2")
    V = Displacements(mesh, kind, dirichletx="left.*", dirichlety="bottom")
    pair = Pair(V, Material(young=young))
    pressure = 0.0125 * young
    stress = np.diag([0.0, -pressure])
    pair.Load(CF((0.0, -pressure)), "top")
    pair.Solve(tol=1e-13)
    table = pair.contact.Table()
    assert pair.StressError(stress) <= TOL
    assert np.abs(table["pressure"] / pressure - 1).max() <= TOL
    assert np.all(table["status"] != 0)
    assert np.abs(table["area"] / table["fullarea"] - 1).max() <= TOL


def Scalar(V):
    return H1(V.mesh, order=1)


SPACES = {
    "VectorH1": (VectorH1, lambda V, Q: V * Q),
    "VectorValued": (lambda mesh, **f: VectorValued(H1(mesh, **f)), lambda V, Q: V * Q),
    "blocks": (lambda mesh, **f: H1(mesh, dim=2, **f), lambda V, Q: V * Q),
    "power": (lambda mesh, **f: H1(mesh, **f) ** 2, lambda V, Q: V * Q),
    "three fields": (VectorH1, lambda V, Q: V * Scalar(V) * Q),
    "four fields": (VectorH1, lambda V, Q: V * Scalar(V) * Scalar(V) * Q),
    "nested": (VectorH1, lambda V, Q: FESpace([FESpace([V, Scalar(V)]), Q])),
}


@pytest.mark.pairwise
@pytest.mark.parametrize("law", ["frictionless", "stick", "slip"])
@pytest.mark.parametrize("order", [1, 2])
@pytest.mark.parametrize("space", SPACES)
def test_displacement_spaces(space, order, law):
    flags, shear, slip = LAWS[law]
    options = MESHES["oblique"]
    make, product = SPACES[space]
    V = make(TwoBlocks(**options), order=order, dirichlet=HELD)
    pair = Pair(V, Material(), product=product, **flags)
    assert max(Patch(pair, options, Stress(options, shear=shear), slip=slip)) <= TOL


def test_threads_change_nothing():
    """The same figures with and without a TaskManager around everything."""
    options = MESHES["oblique"]
    CheckLaw(options, "P1bubble", "slip")
    with TaskManager():
        CheckLaw(options, "P1bubble", "slip")
