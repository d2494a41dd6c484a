"""Patch tests beyond those of the cases: all that a constant stress has to pass, in 2D and 3D."""

import numpy as np
import pytest
from case_patch import (
    FREE,
    HELD,
    LAWS,
    MESHES,
    OBLIQUE_3D,
    PRESSURE,
    Axes,
    Blocks,
    Errors,
    Linear,
    Published,
    Solved,
    Stress,
    TractionError,
)
from elasticity import NAMES, Displacements, Field, Material, Pair, StressError
from ngsolve import (
    H1,
    BilinearForm,
    FESpace,
    GridFunction,
    InnerProduct,
    LinearForm,
    Sym,
    TaskManager,
    VectorH1,
    VectorValued,
    ds,
    dx,
    specialcf,
)
from ngsolve import Grad as Gradient

from ngslac.meshes import TwoBlocks

TOL = {2: 1e-12, 3: 1e-11}
SHAPES = ["tet", "hex", "prism", "prism_side", "pyramid"]
BELOW = dict(zip(SHAPES, [*SHAPES[1:], SHAPES[0]], strict=True))  # another shape as master
SPACES_3D = [f"P{order}{part}" for order in (1, 2) for part in ("", "bubble", "split")]
CURVED = {
    "curved": {"curved": True},
    "curved oblique": {"curved": True, "shape": "oblique", "h_slave": 0.34, "h_master": 0.2},
    "curved quads": {"curved": True, "quads": True},
    "curved cubic": {"curved": True, "order": 3},
}
UNSTRUCTURED = OBLIQUE_3D | {"n_slave": 3, "n_master": 2, "unstructured": True, "perturb": 0.0}
# The blocks of both dimensions in which the load has some other form.
OBLIQUE = [(None, kind, MESHES["oblique"]) for kind in NAMES]
OBLIQUE += [((shape,), space, OBLIQUE_3D) for shape in SHAPES for space in ("P1bubble", "P2")]
PUBLISHED = [(None, kind, young) for kind in NAMES for young in (2e-6, 2000.0, 2e11)]
PUBLISHED += [
    ((shape, None), space, (2e-6, 2e11)[(k + n) % 2])
    for k, shape in enumerate(SHAPES[:3])
    for n, space in enumerate(("P1", "P1bubble", "P2"))
]


def Check(space, law, cells=None, *, swapped=False, **options):
    sides = ("master", "slave") if swapped else ("slave", "master")
    pair, stress, errors = Solved(space, law, cells, slave=sides[0], master=sides[1], **options)
    dim, slip, table = pair.mesh.dim, LAWS[law][2], pair.contact.Table()
    assert max(errors) <= TOL[dim]
    assert dim == 2 or len(table["area"]) > 1
    assert table["area"] == pytest.approx(table["fullarea"], rel=1e-12)
    assert np.abs(table["gap"]).max() <= TOL[dim] * np.abs(stress).max() / Material().young
    assert set(table["status"]) == {2 if slip or law == "frictionless" else 1}
    if slip:
        exact = (-slip if swapped else slip) * Axes(dim, **options)[:, 0]
        assert np.abs(table["slip"] - exact).max() <= 1e-12


@pytest.mark.pairwise
@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize("kind", NAMES)
@pytest.mark.parametrize("mesh", MESHES)
def test_constant_stress_2d(mesh, kind, law):
    Check(kind, law, **MESHES[mesh])


@pytest.mark.pairwise
@pytest.mark.parametrize("law", ["frictionless", "stick", "slip back"])
@pytest.mark.parametrize("kind", NAMES)
@pytest.mark.parametrize("mesh", ["oblique", "quad grid", "wide master", "wide slave"])
def test_slave_and_master_swapped_2d(mesh, kind, law):
    Check(kind, law, swapped=True, **MESHES[mesh])


@pytest.mark.parametrize("law", ["frictionless", "stick", "slip"])
@pytest.mark.parametrize(
    ("mesh", "kind"),
    [(m, k) for m in CURVED for k in ("P2", "P3") if (m, k) != ("curved cubic", "P2")],
)
def test_curved_interior_edges(mesh, kind, law):
    """A space has the linear functions of x and y if its order is at least that of the elements."""
    Check(kind, law, **CURVED[mesh])


@pytest.mark.pairwise
@pytest.mark.parametrize("law", ["stick", "slip", "tied"])
@pytest.mark.parametrize("space", SPACES_3D)
@pytest.mark.parametrize("shape", SHAPES)
def test_constant_shear_3d(shape, space, law):
    """Friction in a direction that is none of the mesh; the frame is turned at random."""
    Check(space, law, (shape, BELOW[shape]), **OBLIQUE_3D)


@pytest.mark.pairwise
@pytest.mark.parametrize("law", ["tresca", "slip"])
@pytest.mark.parametrize("space", ["P1bubble", "P2"])
@pytest.mark.parametrize("shape", SHAPES)
def test_slave_and_master_swapped_3d(shape, space, law):
    Check(space, law, (shape, BELOW[shape]), swapped=True, **OBLIQUE_3D)


@pytest.mark.parametrize(
    ("cells", "space", "law", "options"),
    [
        *((("tet", "hex"), f"P3{part}", "slip", OBLIQUE_3D) for part in ("", "bubble", "split")),
        *((("tet", "hex"), "P2", "stick", OBLIQUE_3D | {"scale": s}) for s in (1e-3, 1e3)),
        ((), "P1", "frictionless", UNSTRUCTURED),
        ((), "P1bubble", "slip", UNSTRUCTURED),
        ((), "P1split", "stick", UNSTRUCTURED),
        ((), "P2", "slip", UNSTRUCTURED),
    ],
)
def test_order_three_units_of_length_and_unstructured_tetrahedra(cells, space, law, options):
    Check(space, law, cells, **options)


@pytest.mark.parametrize(("cells", "space", "options"), OBLIQUE)
def test_tied_takes_tension(cells, space, options):
    pair = Pair(Blocks(space, cells, **options), Material(), tied=True)
    stress = Stress(pair.mesh.dim, options, pressure=-PRESSURE, shear=3 * PRESSURE)
    assert max(Errors(pair, options, stress)) <= TOL[pair.mesh.dim]


@pytest.mark.parametrize(("cells", "space", "options"), OBLIQUE)
def test_two_materials(cells, space, options):
    """Without friction the blocks may extend differently along the interface."""
    V, soft = Blocks(space, cells, **options), Material(young=60.0)
    young = V.mesh.MaterialCF({"upper": Material().young, "lower": soft.young})
    stress = Stress(V.mesh.dim, options)
    errors = Errors(Pair(V, Material(young=young)), options, stress, lower=soft)
    assert max(errors) <= TOL[V.mesh.dim]


@pytest.mark.parametrize(("cells", "space", "young"), PUBLISHED)
def test_as_published(cells, space, young):
    pair, pressure = Published(space, cells, quads=space == "P2", young=young)
    dim, table = pair.mesh.dim, pair.contact.Table()
    assert pair.StressError(np.diag([0.0] * (dim - 1) + [-pressure])) <= TOL[dim]
    assert np.abs(table["pressure"] / pressure - 1).max() <= TOL[dim]
    assert np.all(table["status"] != 0)
    assert np.abs(table["area"] / table["fullarea"] - 1).max() <= TOL[dim]


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
    assert max(Errors(pair, options, Stress(2, options, shear=shear), slip=slip)) <= TOL[2]


@pytest.mark.parametrize(
    ("cells", "options"), [(None, MESHES["oblique"]), (("tet", "hex"), OBLIQUE_3D)]
)
def test_in_threads(cells, options):
    with TaskManager():
        Check("P1bubble", "slip", cells, **options)


@pytest.mark.parametrize("order", [1, 2])
def test_surface_loads_on_pyramids(order):
    """With the tractions on the surface the bulk is wrong by 1e-10, with contact and without."""
    V = Blocks(f"P{order}", ("pyramid",), **OBLIQUE_3D)
    pair, stress = Pair(V, Material()), Stress(3, OBLIQUE_3D)
    exact = Linear(3, OBLIQUE_3D, Material().Strain(stress))
    pair.Hold(exact, HELD)
    pair.LoadStress(stress, FREE)
    pair.Solve(tol=1e-13)
    held = f"{HELD}|slave|master"
    bulk = BulkError(Displacements(V.mesh, f"P{order}", dirichlet=held), held, exact, stress)
    assert TOL[3] < bulk < 1e-9
    assert max(pair.StressError(stress), TractionError(pair, stress)) < 5 * bulk


def BulkError(V, held, exact, stress):
    """Error of the stress in the solution with tractions on the surface and without contact."""
    u, v = V.TnT()
    a = BilinearForm(InnerProduct(Material().Stress(Sym(Gradient(u))), Sym(Gradient(v))) * dx)
    load = LinearForm(InnerProduct(Field(stress) * specialcf.normal(3), v) * ds(FREE))
    gf = GridFunction(V)
    gf.Set(exact, definedon=V.mesh.Boundaries(held))
    rest = (load.Assemble().vec - a.Assemble().mat * gf.vec).Evaluate()
    gf.vec.data += a.mat.Inverse(V.FreeDofs()) * rest
    return StressError(V.mesh, Material().Stress(Sym(Gradient(gf))), stress)
