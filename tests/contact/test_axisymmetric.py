"""Bodies of revolution: patch tests, closed forms, the limit of a plane, mass, and bad input."""

import warnings

import numpy as np
import pytest
from netgen.occ import Compound, Glue, MoveTo, OCCGeometry, X, Y, unit_cube
from ngsolve import (
    CF,
    H1,
    BilinearForm,
    Grad,
    GridFunction,
    Id,
    IfPos,
    InnerProduct,
    Integrate,
    Mesh,
    Parameter,
    Sym,
    TaskManager,
    Variation,
    VectorH1,
    ds,
    dx,
    pi,
    x,
    y,
)
from posed import elastic, posed, revolved

from ngslac import (
    BubbleVectorH1,
    ContactSolver,
    ContactWarning,
    Flux,
    LACContact,
    LACSpace,
    LoadStepper,
    TimeStepper,
    tools,
)
from ngslac.materials import AxisymmetricGrad, NeoHooke, Stress

YOUNG, NU = 100.0, 0.3
APART = 0.5  # as long as they are meshed: what touches would get the same nodes


def section(inner=1.0, outer=2.7, gap=0.0, quad=False):
    """Half a section: an upper ring on a lower one, with meshes that differ."""
    low = MoveTo(inner, -1).Rectangle(outer - inner, 1).Face()
    up = MoveTo(inner, APART).Rectangle(outer - inner, 1).Face()
    for face, name, side in ((low, "lower", "master"), (up, "upper", "slave")):
        face.faces.name, face.edges.name = name, f"side_{name}"
        face.edges.Min(X).name = f"inner_{name}"
        (face.edges.Max(Y) if side == "master" else face.edges.Min(Y)).name = side
    low.edges.Min(Y).name, up.edges.Max(Y).name = "bottom", "top"
    up.edges["slave"].maxh, low.edges["master"].maxh = 0.21, 0.34
    geometry = OCCGeometry(Compound([low, up]), dim=2)
    mesh = Mesh(geometry.GenerateMesh(maxh=0.4, quad_dominated=quad))
    for vertex in mesh.ngmesh.Points():
        vertex[1] -= (APART - gap) * (vertex[1] > APART / 2)
    mesh = Mesh(mesh.ngmesh)
    counts = [sum(1 for _ in mesh.Boundaries(name).Elements()) for name in ("slave", "master")]
    assert counts[0] != counts[1]
    return mesh


class Rings:
    """Two bodies of revolution, elastic or neo-Hooke, loaded on top."""

    def __init__(self, mesh, *, order=2, finite=False, dirichlet=None, bubbles=False, **law):
        self.mesh = mesh
        flags = dirichlet or {"dirichlety": "bottom", "dirichletx": "inner_.*"}
        if bubbles:
            V = BubbleVectorH1(mesh, order=order, slave="slave", **flags)
        else:
            V = VectorH1(mesh, order=order, **flags)
        self.space = LACSpace(V, slave="slave", axisymmetric=True)
        fes = V * self.space
        (u, lam), (v, _) = fes.TnT()
        self.u, self.load, self.gf = u, Parameter(1), GridFunction(fes)
        strain, virtual = AxisymmetricGrad(u), AxisymmetricGrad(v)
        self.a = BilinearForm(fes)
        if finite:
            self.a += Variation(2 * pi * x * NeoHooke(Id(3) + strain, YOUNG, NU) * dx)
        else:
            stress = Stress(Sym(strain), YOUNG, NU)
            self.a += 2 * pi * x * InnerProduct(stress, Sym(virtual)) * dx
        self.a += 2 * pi * x * self.load * v[1] * ds("top")
        partner = {"master": "master"} | law
        self.contact = LACContact(u, lam, finite=finite, **partner)
        self.solver = ContactSolver(self.a, self.gf, self.contact)


@pytest.mark.parametrize("inner", [0.0, 1.3])
@pytest.mark.parametrize(("finite", "friction"), [(False, None), (False, 0.4), (True, None)])
@pytest.mark.parametrize(("order", "bubbles"), [(1, True), (2, False), (3, False)])
def test_patch(inner, finite, friction, order, bubbles):
    """A uniform pressure is transmitted exactly, also next to the axis.

    Sides are free: both bodies have the same radii, and the axis alone is held.
    """
    mesh = section(inner)
    flags = {"dirichlety": "bottom"} | ({} if inner else {"dirichletx": "inner_.*"})
    rings = Rings(
        mesh, order=order, finite=finite, bubbles=bubbles, friction=friction, dirichlet=flags
    )
    rings.solver.Solve(printing=False, tol=1e-13)
    table = rings.contact.Table()
    assert table["pressure"] == pytest.approx(1, abs=1e-11 if finite else 1e-12)
    area = np.pi * (2.7**2 - inner**2)
    assert rings.contact.Force() == pytest.approx([0, area], abs=1e-10 * area)
    assert table["area"].sum() == pytest.approx(area, rel=1e-12)
    assert rings.contact.Moment() == 0


def test_patch_of_quadrilaterals():
    rings = Rings(section(0.0, quad=True))
    rings.solver.Solve(printing=False)
    assert rings.contact.Table()["pressure"] == pytest.approx(1, abs=1e-12)


@pytest.mark.parametrize("finite", [False, True])
@pytest.mark.parametrize("friction", [None, 0.2])
def test_far_from_the_axis_it_is_a_plane(finite, friction):
    """Per circumference, with errors of the thickness over the radius."""
    far = 1e4

    def plane(mesh, weight, axisymmetric):
        V = VectorH1(mesh, order=2, dirichlet="bottom|top")
        grad = AxisymmetricGrad if axisymmetric else Grad

        def bulk(u, v, load):
            if finite:
                F = Id(3 if axisymmetric else 2) + grad(u)
                return Variation(weight * NeoHooke(F, YOUNG, NU) * dx)
            return weight * InnerProduct(Stress(Sym(grad(u)), YOUNG, NU), Sym(grad(v))) * dx

        law = {"axisymmetric": axisymmetric, "finite": finite, "friction": friction}
        problem = posed(V, bulk, **law)
        problem.gf.components[0].Set((0.03, -0.05), definedon=mesh.Boundaries("top"))
        problem.solver().Solve(printing=False)
        return problem.contact

    mesh = section(1.0)
    near = plane(mesh, CF(1), False)
    for vertex in mesh.ngmesh.Points():
        vertex[0] += far
    turned = plane(Mesh(mesh.ngmesh), 2 * pi * x, True)
    scale = np.abs(near.Table()["traction"]).max()
    off = turned.Table()["traction"] - near.Table()["traction"]
    assert np.abs(off).max() < 1e-3 * scale
    per_length = turned.Force() / (2 * np.pi * far)
    assert per_length == pytest.approx(near.Force(), abs=1e-3 * np.abs(near.Force()).max())


@pytest.mark.parametrize("unit", [1.0, 1000.0])
def test_no_unit_and_no_height_matters(unit):
    found = []
    for shift, size in ((0.0, 1.0), (7.0, unit)):
        mesh = section(0.0)
        for vertex in mesh.ngmesh.Points():
            vertex[0], vertex[1] = size * vertex[0], size * (vertex[1] + shift)
        rings = Rings(Mesh(mesh.ngmesh), friction=0.3)
        rings.load.Set(1.0)
        rings.solver.Solve(printing=False)
        found.append(rings.contact.Table()["traction"])
    assert found[0] == pytest.approx(found[1], abs=1e-10)


@pytest.mark.parametrize("obstacle", ["gap", "tool"])
def test_hertz(obstacle):
    """A rigid sphere on a large block: the radius and peak that belong to the force found."""
    size, depth, sphere = 0.0447, 0.002, 1.0
    block = MoveTo(0, -3).Rectangle(3, 3).Face()
    fine = MoveTo(0, -0.08).Rectangle(0.08, 0.08).Face()
    fine.edges.Max(Y).name, fine.edges.Max(Y).maxh = "slave", size / 12
    rest = block - fine
    rest.edges.Min(Y).name = "bottom"
    shape = Glue([fine, rest])
    for edge in shape.edges:
        if abs(edge.center.x) < 1e-9:
            edge.name = "axis"
    mesh = Mesh(OCCGeometry(shape, dim=2).GenerateMesh(maxh=0.3, grading=0.2))
    V = VectorH1(mesh, order=2, dirichlet="bottom", dirichletx="axis")
    if obstacle == "gap":
        law = {"obstacle": x * x / (2 * sphere) - depth}
    else:
        law = {"obstacle": tools.Sphere((0, sphere - depth), sphere), "finite": True}
    problem = posed(V, revolved(1.0, 0.3), axisymmetric=True, **law)
    problem.solver().Solve(printing=False)
    contact = problem.contact
    force = -contact.Force()[1]
    modulus = 1 / (1 - 0.3**2)
    radius = (3 * force * sphere / (4 * modulus)) ** (1 / 3)
    peak = 3 * force / (2 * np.pi * radius**2)
    assert force == pytest.approx(4 / 3 * modulus * np.sqrt(sphere) * depth**1.5, rel=0.02)
    table = contact.Table()
    order = np.argsort(table["x"][:, 0])
    inside = [m for m in order if table["x"][m, 0] < 0.7 * radius]
    area = np.cumsum(table["fullarea"][order])
    ends = np.sqrt(np.concatenate([[0], area]) / np.pi).clip(max=radius) / radius
    total = 2 / 3 * np.pi * peak * radius**2 * (1 - (1 - ends**2) ** 1.5)
    exact = np.diff(total)[: len(inside)] / table["fullarea"][inside]
    tolerance = 0.006 if obstacle == "gap" else 0.015  # a sphere is no paraboloid
    assert table["pressure"][inside] == pytest.approx(exact, rel=tolerance)
    # The macro-element on the axis is as good as the others.
    off = np.abs(table["pressure"][inside] / exact - 1)
    assert off[0] <= max(off[1:].max(), 1e-3)


@pytest.mark.parametrize("friction", [None, 0.3])
def test_derivative_of_large_sliding(friction):
    """Forces against differences, at a state with pressure and slip."""
    rings = Rings(section(0.6, gap=0.02), finite=True, friction=friction)
    contact, gf = rings.contact, rings.gf
    contact.Update(gf)
    contact.form.SetConstant(50.0)
    rng = np.random.default_rng(3)
    vec = gf.vec.FV().NumPy()
    gf.components[0].Set(
        (0.02 * x * y, -0.04 * (1 + 0.2 * x)), definedon=gf.space.mesh.Materials("upper")
    )
    vec[gf.space.components[0].ndof :] = -rng.uniform(0.5, 1, gf.space.components[1].ndof)
    contact.Follow(gf)
    contact.Evaluate(gf)
    assert np.any(contact.Table()["status"] > 0)
    contact.AssembleLinearization(gf.vec)
    way, h = rng.standard_normal(len(vec)), 1e-6
    direction, product = gf.vec.CreateVector(), gf.vec.CreateVector()
    direction.FV().NumPy()[:] = way
    product.data = contact.form.mat * direction
    sides = []
    for sign in (1, -1):
        moved, force = gf.vec.CreateVector(), gf.vec.CreateVector()
        moved.data = gf.vec + sign * h * direction
        contact.Apply(moved, force)
        sides.append(force.FV().NumPy().copy())
    difference = (sides[0] - sides[1]) / (2 * h)
    found = product.FV().NumPy()
    assert np.abs(difference - found).max() < 1e-5 * np.abs(found).max()


def test_mass_and_momentum():
    """A disc that falls: its mass is that of the whole, and the impulse stops it."""
    rings = Rings(section(0.0, gap=0.05), finite=False)
    rings.load.Set(0.0)
    stepper = TimeStepper(rings.solver, 2.0, dt=0.01)
    upper = np.pi * 2.7**2
    assert sum(stepper.mass._masses) == pytest.approx(2 * 2.0 * upper, rel=1e-10)
    velocity = stepper.velocity.components[0]
    velocity.Set((0, -1), definedon=rings.mesh.Materials("upper"))
    falling = 0.5 * 2.0 * upper
    stepper.Integrate(0.2, printing=False)
    balance = stepper.balance
    total = balance.kinetic + balance.internal + balance.impact
    assert total == pytest.approx(falling, rel=1e-3)  # as the start is interpolated
    assert balance.internal > 0.1 * falling
    assert abs(balance.algorithmic) < 1e-9 * falling


def test_steps_with_friction():
    """A press that is sheared outwards slips where friction is at its limit."""
    rings = Rings(section(1.0), friction=0.01, dirichlet={"dirichlet": "bottom"})
    rings.load.Set(0)
    steps = LoadStepper(rings.solver, rings.load).Integrate(1, steps=3, printing=False)
    assert len(steps) == 3
    table = rings.contact.Table()
    along = np.abs(table["traction"][:, 0])
    assert np.all(along <= 0.01 * table["pressure"] * (1 + 1e-8))
    assert {2} <= set(table["status"])


# --- what does not fit ---------------------------------------------------------------------------


def test_refused():
    mesh = section(0.0)
    for wrong in (3, "yes", None):
        with pytest.raises(TypeError, match="axisymmetric"):
            LACSpace(VectorH1(mesh, order=2), slave="slave", axisymmetric=wrong)
    cube = Mesh(unit_cube.GenerateMesh(maxh=1))
    with pytest.raises(ValueError, match="axisymmetric=True needs a mesh in 2D"):
        LACSpace(VectorH1(cube, order=2), slave="left", axisymmetric=True)
    for vertex in mesh.ngmesh.Points():
        vertex[0] -= 1
    with pytest.raises(ValueError, match="reaches to x = -1: the axis is x = 0"):
        LACSpace(VectorH1(Mesh(mesh.ngmesh), order=2), slave="slave", axisymmetric=True)


def bulk(mesh, axisymmetric, hoop, spring=0.0):
    V = VectorH1(mesh, order=2, dirichlet="bottom")
    stiff, weight = (revolved, 2 * pi * x) if hoop else (elastic, CF(1))
    problem = posed(
        V,
        stiff(YOUNG, NU),
        lambda u, v, load: weight * v[1] * ds("top") + spring * u[0] * v[0] * dx,
        axisymmetric=axisymmetric,
        friction=0.5,
    )
    return problem.solver()


def test_a_bulk_without_hoop_strain_is_refused():
    with pytest.raises(ValueError, match="no hoop strain in 'lower', 'upper', but contact is axi"):
        bulk(section(1.0), True, False).Solve(printing=False)


def test_an_axis_that_is_free_is_told():
    with pytest.warns(ContactWarning, match="the axis x = 0 of axisymmetric bodies is free to mov"):
        bulk(section(0.0), True, True).Solve(printing=False)


def test_the_flag_that_is_forgotten_is_told():
    with pytest.warns(ContactWarning, match="resists a shift along x as that of an axisymmetric"):
        bulk(section(1.0), False, True).Solve(printing=False)


@pytest.mark.filterwarnings("error::ngslac.ContactWarning")
@pytest.mark.parametrize("inner", [0.0, 1.0])
def test_a_plane_is_none(inner):
    """Without a word for a plane problem with springs along x, and for an axisymmetric one."""
    bulk(section(inner), False, False, spring=0.1).Solve(printing=False)
    bulk(section(1.0 + inner), True, True).Solve(printing=False)


def test_contacts_have_to_agree():
    mesh = section(1.0)
    V = VectorH1(mesh, order=2, dirichlet="bottom")
    fes = V * LACSpace(V, slave="slave", axisymmetric=True) * LACSpace(V, slave="side_upper")
    (u, lam, other), (v, *_) = fes.TnT()
    a = BilinearForm(fes)
    a += (
        2
        * pi
        * x
        * InnerProduct(Stress(Sym(AxisymmetricGrad(u)), 1, 0.3), Sym(AxisymmetricGrad(v)))
        * dx
    )
    contacts = [LACContact(u, lam, master="master"), LACContact(u, other, obstacle=CF(1.0))]
    with pytest.raises(ValueError, match="contact number 0 is axisymmetric and number 1 is not"):
        ContactSolver(a, GridFunction(fes), contacts).Solve(printing=False)


def test_gradient():
    """Of a field with known derivatives; on the axis u_r/r is its limit."""
    mesh = section(0.0)
    u = GridFunction(VectorH1(mesh, order=3))
    u.Set((x * (2 + y), x * x - y))
    grad = AxisymmetricGrad(u)
    exact = CF((2 + y, x, 0, 2 * x, -1, 0, 0, 0, 2 + y), dims=(3, 3))
    with TaskManager():
        error = Integrate(InnerProduct(grad - exact, grad - exact), mesh)
    assert error == pytest.approx(0, abs=1e-20)
    assert grad(mesh(0.0, 0.5))[8] == pytest.approx(2.5)
    with pytest.raises(TypeError, match="u = 3 must be a displacement with 2 components"):
        AxisymmetricGrad(3)
    with pytest.raises(ValueError, match="u must have 2 components"):
        AxisymmetricGrad(x)


def test_gradient_of_a_twist():
    """A rotation has no strain, a uniform twist of a cylinder that of Saint-Venant."""
    mesh = section(0.0)
    still, w = GridFunction(VectorH1(mesh, order=2)), GridFunction(H1(mesh, order=2))
    strain = Sym(AxisymmetricGrad(still, twist=w))
    w.Set(0.3 * x)
    assert Integrate(InnerProduct(strain, strain), mesh) <= 1e-25
    w.Set(0.3 * x * y)
    exact = CF((0, 0, 0, 0, 0, 0.15 * x, 0, 0.15 * x, 0), dims=(3, 3))
    assert Integrate(InnerProduct(strain - exact, strain - exact), mesh) <= 1e-25
    with pytest.raises(TypeError, match="twist = 3 must be a scalar displacement"):
        AxisymmetricGrad(still, twist=3)
    with pytest.raises(ValueError, match="twist must be a scalar"):
        AxisymmetricGrad(still, twist=still)


class Fit:
    """A shaft in a hub, too large by .01; its end turns, and friction carries the torque."""

    radius, friction = 10.0, 0.2

    def __init__(self, k=1e6):
        shaft = MoveTo(0, 0).Rectangle(10, 30).Face()
        hub = MoveTo(10, 50).Rectangle(10, 20).Face()
        shaft.edges.name = hub.edges.name = "free"
        shaft.edges.Min(X).name, shaft.edges.Max(X).name = "axis", "master"
        shaft.edges.Min(Y).name, shaft.edges.Max(Y).name = "low", "end"
        hub.edges.Min(X).name, hub.edges.Max(X).name = "slave", "rim"
        hub.edges["slave"].maxh, shaft.edges["master"].maxh = 1.0, 1.3
        ngmesh = OCCGeometry(Compound([shaft, hub]), dim=2).GenerateMesh(maxh=2.5)
        for vertex in ngmesh.Points():
            vertex[1] -= 50 * (vertex[1] > 45)
        self.mesh, self.k = Mesh(ngmesh), k
        V = VectorH1(self.mesh, order=2, dirichletx="axis", dirichlety="low|rim")
        W = H1(self.mesh, order=2, dirichlet="axis|rim|end")
        fes = V * W * LACSpace(V, slave="slave", axisymmetric=True)
        (u, self.w, lam), (v, o, _) = fes.TnT()
        stress = Stress(Sym(AxisymmetricGrad(u, twist=self.w)), 210e3, NU)
        a = BilinearForm(fes)
        a += 2 * pi * x * InnerProduct(stress, Sym(AxisymmetricGrad(v, twist=o))) * dx
        around = Flux(self.w, self.around)
        self.contact = LACContact(u, lam, master="master", offset=-0.01, flux=around)
        self.gf, self.angle = GridFunction(fes), Parameter(0)
        self.solver = ContactSolver(a, self.gf, self.contact)

    def around(self, f):
        jump, most = f.Slave(self.w) - f.Master(self.w), self.friction * f.pressure

        def bounded(slipped):
            trial = self.k * (jump - slipped)
            return IfPos(trial - most, most, IfPos(trial + most, trial, -most))

        slipped = f.History("way", lambda before: jump - bounded(before) / self.k)
        return self.k * (jump - slipped)

    def turn(self, angle):
        """Torque on the shaft by the hub, and of the end."""
        turned = GridFunction(self.gf.components[1].space)
        turned.Set(angle * x, definedon=self.mesh.Boundaries("end"))
        end = list(turned.space.GetDofs(self.mesh.Boundaries("end")))
        self.gf.components[1].vec.FV().NumPy()[end] = turned.vec.FV().NumPy()[end]
        self.solver.Solve(printing=False)
        self.contact.Commit(self.gf)
        table = self.contact.Table()
        return self.radius * table["flux_out"] @ table["area"], self.of_end()

    def of_end(self):
        forces, arm = self.gf.vec.CreateVector(), GridFunction(self.gf.space)
        self.solver.a.Apply(self.gf.vec, forces)
        arm.components[1].Set(x, definedon=self.mesh.Boundaries("end"))
        return InnerProduct(arm.vec, forces)


def test_torque_of_a_press_fit():
    """It grows as front after front slips, up to what friction bears, and falls elastically."""
    fit = Fit()
    torques = np.array([fit.turn(angle) for angle in (2e-4, 1e-3, 2e-3, 4e-3, 8e-3)])
    assert abs(torques.sum(axis=1)).max() <= 1e-8 * abs(torques).max()
    torque, table = torques[:, 1], fit.contact.Table()
    bound = fit.radius * fit.friction * table["pressure"] @ table["area"]
    assert torque[-2:] == pytest.approx(bound, rel=1e-8)
    elastic = torque[0] / 2e-4
    assert all(torque[1:3] < 0.999 * elastic * np.array([1e-3, 2e-3]))
    back = fit.turn(7.9e-3)[1]
    assert (torque[-1] - back) / 1e-4 == pytest.approx(elastic, rel=1e-6)
    assert abs(table["way"]).max() > 0


def test_stick_of_a_twist_is_that_of_a_tie():
    """As the elastic part grows stiffer, at the rate of its compliance."""
    torques = [Fit(k=k).turn(1e-4)[1] for k in (1e6, 1e7, 1e8)]
    steps = np.diff(torques)
    assert 0 < steps[1] < 0.15 * steps[0] < 0.02 * torques[0]


@pytest.mark.parametrize("factor", [True, False])
def test_a_bulk_without_the_factor_of_the_circumference_is_told(factor):
    mesh = section(0.5)
    V = VectorH1(mesh, order=2, dirichlet="bottom|top")

    def bulk(u, v, load):
        whole = revolved(YOUNG, NU)(u, v, load)
        stress = Stress(Sym(AxisymmetricGrad(u)), YOUNG, NU)
        return whole if factor else InnerProduct(stress, Sym(AxisymmetricGrad(v))) * dx

    problem = posed(V, bulk, axisymmetric=True)
    problem.gf.components[0].Set((0, -0.01), definedon=mesh.Boundaries("top"))
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        problem.solver().Solve(printing=False)
    assert ["no factor 2*pi*x" in str(one.message) for one in caught] == [True] * (not factor)
