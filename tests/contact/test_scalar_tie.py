"""Scalar fields that are tied across meshes: patch tests, closed forms, steps, bad input."""

import warnings
from itertools import pairwise

import numpy as np
import pytest
import scipy
from blocks import ROTATION
from netgen.meshing import NgException
from netgen.occ import Circle, Compound, OCCGeometry, Pnt, Rectangle
from ngsolve import (
    H1,
    BilinearForm,
    Compress,
    Grad,
    GridFunction,
    InnerProduct,
    Integrate,
    Mesh,
    Parameter,
    VectorH1,
    dx,
    grad,
    pi,
    sqrt,
    x,
    y,
    z,
)

from ngslac import (
    AugmentedLagrangianSolver,
    ContactSolver,
    FloatingBodyError,
    Flux,
    LACContact,
    LACSpace,
    Law,
    LoadState,
    LoadStepper,
    SaveState,
    TimeStepper,
    tools,
)
from ngslac.meshes import TwoBlocks
from ngslac.meshes.blocks3d import TwoBlocks3D

QUIET = {"printing": False}
ENDS = "bottom|top"


class Heat:
    """Conduction in two bodies, with the law of the interface that is given."""

    def __init__(self, mesh, order=2, conductivity=None, ends=ENDS, axisymmetric=False, **law):
        self.mesh, self.ends = mesh, ends
        S = H1(mesh, order=order, dirichlet=ends)
        self.fes = S * LACSpace(S, slave="slave", axisymmetric=axisymmetric)
        (T, q), (v, _) = self.fes.TnT()
        self.v, self.a = v, BilinearForm(self.fes)
        k = (lambda _: 1) if conductivity is None else conductivity
        self.a += (2 * pi * x if axisymmetric else 1) * k(T) * grad(T) * grad(v) * dx
        self.contact = LACContact(T, q, **({"master": "master", "tied": True} | law))
        self.gf = GridFunction(self.fes)

    @property
    def T(self):
        return self.gf.components[0]

    def solve(self, given, cls=ContactSolver, **options):
        self.T.Set(given, definedon=self.mesh.Boundaries(self.ends))
        self.solver = cls(self.a, self.gf, self.contact, **options)
        return self.solver.Solve(tol=1e-13, **QUIET)


def blocks(dim, *cells, **flags):
    if dim == 2:
        return TwoBlocks(0.1, **({"aligned": False, "angle": 25} | flags))
    cells = cells or ("hex", "tet", 3, 2)
    return TwoBlocks3D(*cells, **({"aligned": False, "rotation": ROTATION} | flags))


CELLS = [(2,), (3,), (3, "prism", "hex", 2, 3), (3, "tet", "prism", 2, 3)]


@pytest.mark.sample(18)
@pytest.mark.parametrize("solver", [None, "iterative", "direct"])
@pytest.mark.parametrize("order", [1, 2, 3])
@pytest.mark.parametrize("cells", CELLS)
def test_patch(cells, order, solver):
    """A linear temperature is exact, and so is what flows, on meshes that do not match."""
    mesh = blocks(*cells)
    exact = 3 * x - 2 * y + (0 if mesh.dim == 2 else z)
    gradient = np.array([3.0, -2.0, 1.0])[: mesh.dim]
    rim = "|".join(set(mesh.GetBoundaries()) - {"slave", "master"})
    heat = Heat(mesh, order, ends=rim)
    heat.solve(exact, solver=solver)
    assert sqrt(Integrate((heat.T - exact) ** 2, mesh)) <= 1e-12
    table = heat.contact.Table()
    assert abs(table["flux"] + table["normal"] @ gradient).max() <= 1e-11
    if mesh.dim == 2:
        assert heat.contact.space.ndof == heat.contact.space.nmacros


RADII, CONDUCTIVITY = (1.0, 1.5, 2.5), {"inner": 15.0, "outer": 0.5}


def tubes(n):
    """A quarter of two tubes in each other, curved, with n edges on the inner one's outside."""
    faces = []
    for name, (small, big), ends in zip(
        CONDUCTIVITY, pairwise(RADII), (("hot", "slave"), ("master", "cold")), strict=True
    ):
        discs = [Circle((0, 0), radius).Face() for radius in (big, small)]
        face = (discs[0] - discs[1]) * Rectangle(5, 5).Face()
        face.faces.name, face.edges.name = name, "symmetry"
        face.edges.Nearest(Pnt(0.01, 0.01, 0)).name = ends[0]
        face.edges.Nearest(Pnt(4, 4, 0)).name = ends[1]
        faces.append(face)
    for face, name, parts in zip(faces, ("slave", "master"), (n, n // 2), strict=True):
        face.edges[name][0].partition = [k / parts for k in range(1, parts)]
    return Mesh(OCCGeometry(Compound(faces), dim=2).GenerateMesh(maxh=0.2)).Curve(3)


def through(places, resistance):
    """What flows into the slave, as a law in NumPy."""
    flow = -places["jump"] / resistance
    return {"traction": flow, "by_jump": np.full(len(flow), -1 / resistance)}


LAWS = {
    "perfect": (0, {}),
    "expression": (0.05, {"law": Law(lambda z: -z.jump / 0.05)}),
    "NumPy": (0.05, {"law": lambda places: through(places, 0.05)}),
}


@pytest.mark.parametrize("law", LAWS)
def test_tubes(law):
    """Thermal resistances add up (Carslaw, Jaeger 1959, section 7.2)."""
    resistance, options = LAWS[law]
    mesh = tubes(23)
    k = mesh.MaterialCF(CONDUCTIVITY)
    heat = Heat(mesh, 3, lambda _: k, ends="hot|cold", **options)
    heat.solve(mesh.BoundaryCF({"hot": 90, "cold": 10}))
    inner, outer = (np.log(b / a) for a, b in pairwise(RADII))
    parts = inner / CONDUCTIVITY["inner"], outer / CONDUCTIVITY["outer"]
    flow = 80 * np.pi / 2 / (sum(parts) + resistance / RADII[1])
    out, into = heat.contact.Flow()
    assert out == into
    assert abs(out / flow - 1) <= 1e-5
    table = heat.contact.Table()
    assert np.ptp(table["flux"]) <= 0.01 * abs(table["flux"]).max()
    assert abs(heat.solver.Reaction("hot")[0] - out) <= 1e-8 * out


def test_nonlinear_conductivity():
    """Kirchhoff's transform of a conductivity 1 + T^2 is linear in the height."""
    mesh = blocks(2, angle=0)
    heat = Heat(mesh, 3, lambda T: 1 + T**2)
    last = heat.solve(mesh.BoundaryCF({"top": 3, "bottom": 0}))
    assert last.number <= 8
    assert abs(heat.contact.Flow()[0] - 6) <= 1e-5  # (3 + 9) over the height of 2


@pytest.mark.parametrize("cls", [ContactSolver, AugmentedLagrangianSolver])
def test_steps_and_saved_states(cls, tmp_path):
    """Sources that grow with the load; a restart goes on as the run that was not interrupted."""
    mesh = blocks(2)

    def stepper():
        heat, load = Heat(mesh, 2, lambda T: 1 + T**2), Parameter(0)
        heat.a += -load * (1 + x) * heat.v * dx(definedon=mesh.Materials("upper"))
        return heat, LoadStepper(cls(heat.a, heat.gf, heat.contact), load)

    heat, steps = stepper()
    steps.Integrate(0.5, steps=2, **QUIET)
    SaveState(tmp_path / "state", steps)
    steps.Integrate(1, steps=2, **QUIET)
    assert steps.Table()["force"].shape == (4, 1, 1)
    again, others = stepper()
    LoadState(tmp_path / "state", others)
    assert again.contact.Flow()[0] != 0
    others.Integrate(1, steps=2, **QUIET)
    assert abs(again.contact.Flow()[0] - heat.contact.Flow()[0]) <= 1e-9


def test_heats_up_as_one_body():
    """Backward Euler in the bulk form: as a conforming mesh, to the order of the method."""
    flows = []
    for h in 0.1, 0.05:
        mesh = blocks(2, angle=0)
        mesh = TwoBlocks(h, aligned=False)
        heat = Heat(mesh)
        old = GridFunction(heat.T.space)
        heat.a += (heat.fes.TrialFunction()[0] - old) / 0.05 * heat.v * dx
        for _ in range(4):
            heat.solve(mesh.BoundaryCF({"top": 1, "bottom": 0}))
            old.vec.data = heat.T.vec
        flows.append(heat.contact.Flow()[0])
    # The same by finite differences in one dimension, of 4000 parts.
    parts, T = 4000, np.zeros(4001)
    size = 2 / parts
    main, side = np.full(parts - 1, 1 / 0.05 + 2 / size**2), np.full(parts - 2, -1 / size**2)
    matrix = scipy.sparse.diags([side, main, side], [-1, 0, 1]).tocsc()
    for _ in range(4):
        T[-1] = 1
        right = T[1:-1] / 0.05
        right[-1] += T[-1] / size**2
        T[1:-1] = scipy.sparse.linalg.spsolve(matrix, right)
    exact = (T[parts // 2 + 1] - T[parts // 2 - 1]) / (2 * size)
    errors = np.abs(np.array(flows) - exact)
    assert errors[1] <= min(errors[0] / 2, 1e-5 * exact)


def test_around_an_axis():
    mesh = TwoBlocks(0.1, aligned=False)
    heat = Heat(mesh, axisymmetric=True)
    heat.solve(y)
    assert abs(heat.contact.Flow()[0] - np.pi) <= 1e-12
    assert Integrate((heat.T - y) ** 2, mesh) <= 1e-24


@pytest.mark.parametrize(("bulk", "contact"), [(False, True), (True, False), (True, True)])
def test_the_factor_of_an_axis_is_on_both_sides(bulk, contact):
    """What is conducted as in a plane does not go with contact around an axis, nor the opposite."""
    heat = Heat(TwoBlocks(0.1, aligned=False), axisymmetric=contact)
    (T, _), (v, _) = heat.fes.TnT()
    heat.a = BilinearForm((2 * pi * x if bulk else 1) * 7 * grad(T) * grad(v) * dx)
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        heat.solve(y)
    assert [bool(caught)] == [bulk != contact], [str(one.message) for one in caught]
    assert all("factor 2*pi*x" in str(one.message) for one in caught)


def test_without_any_load_a_law_gives_nothing():
    heat = Heat(TwoBlocks(0.2, aligned=False), law=Law(lambda z: -3 * z.jump))
    assert heat.solve(0).number <= 1
    assert heat.contact.Flow() == (0, 0)


@pytest.mark.parametrize("sign", [1, -1])
@pytest.mark.parametrize("source", [0, 0.2])
def test_a_law_that_flows_uphill_is_told(sign, source):
    """Not what an interface gives by itself."""
    law = Law(lambda z: -sign * 0.3 * z.jump + source)
    heat = Heat(TwoBlocks(0.2, aligned=False), law=law)
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        heat.solve(y)
    told = ["is the sign of law right?" in str(warning.message) for warning in caught]
    assert told == [True] * (sign < 0)
    table = heat.contact.Table()
    assert table["flux"] == pytest.approx(sign * 0.3 * table["jump"] - source, rel=1e-9)


def test_values_prescribed_by_a_stepper():
    heat, load = Heat(TwoBlocks(0.2, aligned=False)), Parameter(0)
    solver = ContactSolver(heat.a, heat.gf, heat.contact)
    stepper = LoadStepper(solver, load, prescribe={"top": 3 * load, "bottom": load})
    stepper.Integrate(1, steps=2, **QUIET)
    assert heat.contact.Flow()[0] == pytest.approx(1, rel=1e-12)
    with pytest.raises(ValueError, match="'top' has 2 components, u has 1"):
        LoadStepper(solver, load, prescribe={"top": (0, load)})


def test_a_field_of_one_body_is_refused():
    mesh = TwoBlocks(0.5, aligned=False)
    S = H1(mesh, order=2, definedon="upper")
    T, q = (S * LACSpace(S, slave="slave")).TrialFunction()
    with pytest.raises(ValueError, match="master = 'master' has no degrees of freedom of u"):
        LACContact(T, q, master="master", tied=True)


def test_one_body_is_held_by_the_other():
    """Heat that is made in the upper body leaves through the interface."""
    mesh = TwoBlocks(0.1, aligned=False)
    heat = Heat(mesh, ends="bottom")
    heat.a += -heat.v * dx(definedon=mesh.Materials("upper"))
    heat.solve(0)
    assert abs(heat.contact.Flow()[0] - 1) <= 1e-12
    assert abs(heat.contact.Force()[0] + 1) <= 1e-12


def test_what_nothing_holds_is_named():
    heat = Heat(TwoBlocks(0.2, aligned=False), ends="")
    heat.a += -heat.v * dx
    with pytest.raises(FloatingBodyError, match="a constant"):
        heat.solve(0)


def test_follows_a_refined_mesh():
    mesh = Mesh(TwoBlocks(0.2, aligned=False).ngmesh.Copy())
    heat = Heat(mesh)
    mesh.Refine()
    heat.fes.Update(), heat.gf.Update(), heat.contact.Update()
    heat.solve(y)
    assert abs(heat.contact.Flow()[0] - 1) <= 1e-12
    assert len(heat.contact.flux.vec) == heat.contact.space.nmacros


@pytest.mark.parametrize(
    "make",
    [
        lambda mesh: H1(mesh, order=2, dim=1, dirichlet=ENDS),
        lambda mesh: Compress(H1(mesh, order=2, dirichlet=ENDS)),
        lambda mesh: H1(mesh, order=2, dirichlet=ENDS, wb_withoutedges=True),
    ],
)
def test_other_spaces(make):
    mesh = TwoBlocks(0.1, aligned=False)
    S = make(mesh)
    fes = S * S * LACSpace(S, slave="slave")  # another field beside the one that is tied
    (U, T, q), (w, v, _) = fes.TnT()
    a = BilinearForm(grad(T) * grad(v) * dx + grad(U) * grad(w) * dx - T * w * dx)
    contact = LACContact(T, q, master="master", tied=True)
    gf = GridFunction(fes)
    gf.components[1].Set(y, definedon=mesh.Boundaries(ENDS))
    ContactSolver(a, gf, contact).Solve(**QUIET)
    assert abs(contact.Flow()[0] - 1) <= 1e-12


def test_pictures(tmp_path):
    heat = Heat(TwoBlocks(0.2, aligned=False))
    heat.solve(y)
    for field in "flux", "status", "normal", "macros", "segments":
        heat.contact.Draw(field, show=False)
    for field in "flux", "status":
        heat.contact.Plot(field)
    assert heat.contact.WriteVTU(tmp_path / "interface").exists()
    assert "gap" in str(heat.contact.Check())
    D, M = heat.contact.Mortar()
    assert D.shape == M.shape == (heat.contact.space.nmacros, heat.T.space.ndof)


REFUSED = {
    "not tied": ({"tied": False}, "tied=True"),
    "large": ({"finite": True}, "drop finite"),
    "obstacle": ({"master": None, "obstacle": 0}, "obstacle"),
    "tool": ({"master": None, "obstacle": tools.Plane((0, 0), (0, 1))}, "obstacle"),
}


@pytest.mark.parametrize("kind", REFUSED)
def test_refused(kind):
    options, words = REFUSED[kind]
    with pytest.raises(ValueError, match=words):
        Heat(TwoBlocks(0.5, aligned=False), **options)


def test_refuses_what_a_scalar_has_not():
    heat = Heat(mesh := TwoBlocks(0.5, aligned=False))
    heat.solve(y)
    for query in heat.contact.Moment, heat.contact.Recovered:
        with pytest.raises(ValueError, match="scalar field"):
            query()
    with pytest.raises(ValueError, match="'flux'"):
        heat.contact.Draw()
    with pytest.raises(ValueError, match="no inertia"):
        TimeStepper(heat.solver, density=1, dt=0.1)
    T, q = heat.fes.TrialFunction()
    with pytest.raises(ValueError, match="drop finite, obstacle and flux"):
        LACContact(T, q, master="master", tied=True, flux=Flux(T, lambda z: z.Slave(T)))
    with pytest.raises(TypeError, match="must be a finite number"):
        LACContact(T, q, master="master", tied=True, law=Law(lambda z: mesh))
    V = VectorH1(mesh, order=2)
    fes = V * heat.T.space * LACSpace(V, slave="slave") * LACSpace(heat.T.space, slave="slave")
    (u, T, lam, q), (w, v, *_) = fes.TnT()
    a = BilinearForm(InnerProduct(Grad(u), Grad(w)) * dx + grad(T) * grad(v) * dx)
    both = [LACContact(u, lam, master="master"), LACContact(T, q, master="master", tied=True)]
    with pytest.raises(ValueError, match="different fields u"):
        ContactSolver(a, GridFunction(fes), both)
    with pytest.raises(NgException, match="another displacement space"):
        LACContact(T, lam, master="master", tied=True)
