"""What flows through a contact: derivatives, closed forms, balances, histories, bad input."""

import warnings

import numpy as np
import pytest
from blocks import C, block_mesh, residual
from form import Form, on_a_sphere
from netgen.meshing import NgException
from netgen.occ import Box, Compound, OCCGeometry, Rectangle, Y, Z
from ngsolve import (
    CF,
    H1,
    BilinearForm,
    Discontinuous,
    Grad,
    GridFunction,
    Id,
    InnerProduct,
    Integrate,
    Mesh,
    Norm,
    Parameter,
    Sym,
    VectorH1,
    cos,
    ds,
    dx,
    exp,
    grad,
    pi,
    sin,
    x,
    y,
    z,
)

from ngslac import (
    AugmentedLagrangianSolver,
    ContactConvergenceError,
    ContactSolver,
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
from ngslac.materials import AxisymmetricGrad, Stress

# --- derivatives -----------------------------------------------------------------------------


def warm_form(dim, finite, tied=False, friction=True, order=2, **law):
    """A contact form with a temperature of its own, on the blocks of the other tests."""
    mesh = block_mesh(dim) if dim == 2 else block_mesh(dim, "hex", "tet", 2, 1)
    V, W = VectorH1(mesh, order=2), H1(mesh, order=order)
    *_, u, lam = (X := W * V * LACSpace(V, slave="slave")).TrialFunction()
    T = X.TrialFunction()[0]

    def Conducted(f):
        return (1 + f.pressure + 0.3 * f.pressure**2) * (f.Slave(T) - f.Master(T)) * exp(-f.gap)

    if tied:
        flux = Flux(T, lambda f: (2 + f.Slave(T) ** 2) * (f.Slave(T) - f.Master(T)))
    else:
        flux = Flux(T, Conducted, heat=lambda f: f.power * exp(f.Master(T) / 5), share=0.3)
        if friction:
            law |= {"friction": lambda f: 0.3 * exp(-(f.Slave(T) + 2 * f.Master(T)) / 9)}
    contact = LACContact(u, lam, master="master", finite=finite, tied=tied, flux=flux, **law)
    contact.Update()
    contact.form.SetConstant(C)
    form = Form(contact)
    form.gf.components[0].Set(0.5 + sin(3 * x + 2 * y))
    return form


@pytest.mark.parametrize("kind", ["friction", "no friction", "tied", "other order", "bilateral"])
@pytest.mark.parametrize("finite", [False, True])
@pytest.mark.parametrize("dim", [2, 3])
def test_derivative(dim, finite, kind):
    """Against differences, in a state with slip, of all rows and columns."""
    options = {
        "friction": {},
        "no friction": {"friction": False},
        "tied": {"tied": True},
        "other order": {"order": 1},
        "bilateral": {"bilateral": True},
    }
    form = warm_form(dim, finite, **options[kind])
    form.bend(0.02, 0.0, degrees=20, noise=0.01, seed=1)
    form.commit()
    form.bend(0.04, 0.05, degrees=30, noise=0.01, seed=2)
    form.gf.components[0].Set(0.5 + sin(3 * x + 2 * y))
    form.follow()
    form.contact.form.SetConstant(C)
    if kind != "tied":
        form.impose(0.3)
    assert form.derivative_error(60 if dim == 2 else 8) <= 1e-7


@pytest.mark.parametrize("dim", [2, 3])
def test_derivative_on_a_tool(dim):
    """The tool has no temperature; the slave loses heat to it."""
    seen = {}

    def Lost(f):
        return f.pressure * (f.Slave(seen["T"]) - 0.2) * exp(-f.gap)

    form = on_a_sphere(dim, friction=0.2)
    V = form.contact.form.component
    X = H1(V.mesh, order=2) * V * LACSpace(V, slave="bottom")
    seen["T"], u, lam = X.TrialFunction()
    flux = Flux(seen["T"], Lost, heat=lambda f: f.power)
    tool = tools.Sphere((0.4, 0.45, -0.68)[3 - dim :], 0.7)
    contact = LACContact(u, lam, obstacle=tool, finite=True, friction=0.2, flux=flux)
    contact.Update()
    contact.form.SetConstant(C)
    form = Form(contact)
    form.commit()
    form.u.Set(CF((0.03 * sin(3 * x), 0.05 * x * x - 0.02, 0.04 * x * y)[:dim]))
    form.gf.components[0].Set(1 + x)
    form.follow()
    form.values[form.multipliers] = -0.5
    form.impose(0.3)
    assert form.derivative_error(40 if dim == 2 else 6) <= 1e-7


@pytest.mark.parametrize("finite", [False, True])
def test_a_flux_leaves_forces_alone(finite):
    """The rows of displacements and multipliers are those without it."""
    form = warm_form(2, finite, friction=False)
    form.bend(0.04, 0.05, degrees=30, noise=0.01, seed=2)
    form.follow()
    form.impose(0.0)
    with_flux = residual(form.contact, form.values)
    T, u, lam = form.contact.form.fes.TrialFunction()
    plain = Form(LACContact(u, lam, master="master", finite=finite))
    plain.contact.Update()
    plain.contact.form.SetConstant(C)
    plain.values[:] = form.values
    plain.follow()
    without, n = residual(plain.contact, plain.values), T.space.components[0].ndof
    assert with_flux[n:] == pytest.approx(without[n:], abs=1e-14)
    assert not np.any(without[:n])
    assert np.any(with_flux[:n])


# --- bodies --------------------------------------------------------------------------------------


def two_bodies(dim=2, *, size=0.3, gap=0.0, width=1.0, wide=1.0, height=0.5):
    """A block on a plate; their meshes differ."""
    apart = 0.5
    if dim == 2:
        low = Rectangle(wide, 1).Face().Move((-(wide - width) / 2, -1, 0))
        up = Rectangle(width, height).Face().Move((0, apart, 0))
        for face, name in ((low, "lower"), (up, "upper")):
            face.faces.name, face.edges.name = name, "side"
        low.edges.Max(Y).name, low.edges.Min(Y).name = "master", "bottom"
        up.edges.Min(Y).name, up.edges.Max(Y).name = "slave", "top"
        low.edges["master"].maxh, up.edges["slave"].maxh = 0.7 * size, 0.5 * size
    else:
        edge = (wide - width) / 2
        low, up = Box((-edge, -edge, -1), (wide - edge, wide - edge, 0)), None
        up = Box((0, 0, apart), (width, width, apart + height))
        for box, name in ((low, "lower"), (up, "upper")):
            box.solids.name, box.faces.name = name, "side"
        low.faces.Max(Z).name, low.faces.Min(Z).name = "master", "bottom"
        up.faces.Min(Z).name, up.faces.Max(Z).name = "slave", "top"
        up.faces["slave"].maxh = 0.6 * size
    ngmesh = OCCGeometry(Compound([low, up]), dim=dim).GenerateMesh(maxh=size)
    for vertex in ngmesh.Points():
        vertex[dim - 1] -= (apart - gap) * (vertex[dim - 1] > apart / 2)
    return Mesh(ngmesh)


class Warm:
    """Two elastic bodies with temperatures: hot on top, cold at the bottom."""

    def __init__(
        self,
        flow,
        *,
        mesh=None,
        hot=1.0,
        cold=0.0,
        conductivity=(2.0, 2.0),
        expansion=0.0,
        young=100.0,
        nu=0.0,
        capacity=None,
        axisymmetric=False,
        heat=None,
        share=0.5,
        order=2,
        condense=False,
        dirichlet=None,
        pressure=0.0,
        **law,
    ):
        self.mesh = mesh = two_bodies() if mesh is None else mesh
        d = mesh.dim
        V = VectorH1(mesh, order=order, **(dirichlet or {"dirichlet": "bottom|top"}))
        W = H1(mesh, order=order, dirichlet="bottom|top")
        self.fes = fes = V * W * LACSpace(V, slave="slave", axisymmetric=axisymmetric)
        (u, T, lam), (v, S, _) = fes.TnT()
        self.a = BilinearForm(fes, condense=condense)
        weight = 2 * pi * x if axisymmetric else 1
        gradient = AxisymmetricGrad if axisymmetric else Grad
        strain, virtual = Sym(gradient(u)), Sym(gradient(v))
        strain = strain - expansion * T * Id(3 if axisymmetric else d)
        self.a += weight * InnerProduct(Stress(strain, young, nu), virtual) * dx
        k = mesh.MaterialCF({"upper": conductivity[0], "lower": conductivity[1]})
        self.a += weight * k * grad(T) * grad(S) * dx
        self.a += weight * pressure * v[d - 1] * ds("top")
        self.gf, self.before, self.last = GridFunction(fes), GridFunction(W), GridFunction(W)
        self.temperature = self.gf.components[1]
        given = mesh.BoundaryCF({"top": hot, "bottom": cold})
        self.temperature.Set(given, definedon=mesh.Boundaries("top|bottom"))
        released = None if heat is None else (lambda f: heat(f, T))
        self.flux = Flux(T, lambda f: flow(f, T), heat=released, share=share)
        law = {name: self.Of(value, T) for name, value in law.items()}
        self.contact = LACContact(u, lam, master="master", flux=self.flux, **law)
        if capacity:
            self.a += weight * capacity * (T - self.before) / self.contact.dt * S * dx

    @staticmethod
    def Of(value, T):
        return (lambda f: value(f, T)) if callable(value) else value

    def Solve(self, make=ContactSolver, **options):
        last = make(self.a, self.gf, self.contact, **options).Solve(printing=False)
        return last.number

    def Drag(self, steps=4, way=0.2, down=0.02, goal=1.0):
        """Press down, and pull aside."""
        load, rest = Parameter(0), [0] * (self.mesh.dim - 2)
        held = {"top": CF((way * load, *rest, -down)), "bottom": CF((0, *rest, 0))}
        stepper = LoadStepper(ContactSolver(self.a, self.gf, self.contact), load, prescribe=held)

        def Remember(_):
            self.last.vec.data = self.before.vec
            self.before.vec.data = self.temperature.vec

        self.steps = stepper.Integrate(goal, steps=steps, printing=False, callback=Remember)
        return stepper


def by_pressure(scale):
    return lambda f, T: scale * f.pressure * (f.Slave(T) - f.Master(T))


@pytest.mark.parametrize("finite", [False, True])
@pytest.mark.parametrize(("dim", "axisymmetric"), [(2, True), (3, False)])
@pytest.mark.parametrize(
    ("pressure", "hardness", "flow", "upper", "lower"),
    [(1.0, 1.0, 5514.589, 459.5933, 276.2599), (100.0, 26.875, 7292.0183, 349.8754, 284.7239)],
)
def test_two_bars_whose_conductance_grows_with_pressure(
    pressure, hardness, flow, upper, lower, dim, axisymmetric, finite
):
    """q = (T1 - T2)/(L/k1 + 1/h + L/k2), h = k p/H with the harmonic mean k; FIELD.md A1."""
    k1, k2 = 16.2, 210.0
    scale = 2 * k1 * k2 / (k1 + k2) / hardness
    mesh = two_bodies(dim, height=1.0, size=0.3 if dim == 2 else 0.6)
    sides = "dirichletx" if dim == 2 else "dirichletx dirichlety"
    held = dict.fromkeys(sides.split(), ".*") | {f"dirichlet{'yz'[dim - 2]}": "bottom"}
    warm = Warm(
        by_pressure(scale),
        mesh=mesh,
        hot=800.0,
        cold=250.0,
        conductivity=(k1, k2),
        young=1e7,
        pressure=pressure,
        axisymmetric=axisymmetric,
        finite=finite,
        dirichlet=held,
    )
    assert warm.Solve() <= 4
    table = warm.contact.Table()
    assert table["flux_out"] == pytest.approx(flow, rel=1e-6)
    assert table["flux_in"] == pytest.approx(table["flux_out"], rel=1e-12)
    tops = warm.temperature.vec.FV().NumPy()
    assert np.any(np.abs(tops - upper) < 2e-4)
    assert np.any(np.abs(tops - lower) < 2e-4)


@pytest.mark.parametrize("finite", [False, True])
@pytest.mark.parametrize("dim", [2, 3])
def test_a_linear_temperature_passes(dim, finite):
    """The patch test: on any pair of meshes, with a jump that drives the flux."""
    conductance = 3.0
    warm = Warm(
        lambda f, T: conductance * (f.Slave(T) - f.Master(T)),
        mesh=two_bodies(dim, size=0.3 if dim == 2 else 0.5),
        tied=True,
        finite=finite,
    )
    warm.Solve()
    flow = 1 / (0.5 / 2 + 1 / conductance + 1 / 2)
    table, height = warm.contact.Table(), (x, y, z)[dim - 1]
    assert table["flux_out"] == pytest.approx(flow, rel=1e-12)
    exact = GridFunction(warm.fes.components[1])
    upper, lower = 1 - flow / 2 * (0.5 - height), flow / 2 * (1 + height)
    exact.Set(warm.mesh.MaterialCF({"upper": upper, "lower": lower}))
    difference = warm.temperature.vec.FV().NumPy() - exact.vec.FV().NumPy()
    assert np.abs(difference).max() < 1e-12


@pytest.mark.filterwarnings("ignore:the slave has slid")
@pytest.mark.parametrize("finite", [False, True])
@pytest.mark.parametrize("dim", [2, 3])
def test_heat_is_the_power_of_friction(dim, finite):
    """What comes out is what goes in, whatever is conducted; quickly."""
    warm = Warm(
        lambda f, T: (1 + 5 * f.pressure) * (f.Slave(T) - f.Master(T)),
        mesh=two_bodies(dim, wide=1.6),
        heat=lambda f, T: f.power,
        share=0.4,
        expansion=1e-3,
        nu=0.3,
        capacity=1.0,
        friction=lambda f, T: 0.2 * exp(-f.Slave(T)),
        finite=finite,
    )
    warm.Drag(steps=4)
    table = warm.contact.Table()
    power = -np.sum(table["traction"] * table["slip"], axis=1) / 0.25
    power -= table["pressure"] * np.sum(table["normal"] * table["slip"], axis=1) / 0.25
    assert table["flux_in"] - table["flux_out"] == pytest.approx(power, rel=1e-12, abs=1e-15)
    out, into = warm.contact.Flow()
    assert into - out == pytest.approx(table["area"] @ power, rel=1e-12)
    assert into - out > 0.03
    assert max(step.iterations for step in warm.steps) <= 7
    closed = table["status"] > 0
    assert np.ptp(table["friction"][closed]) > 1e-4


@pytest.mark.filterwarnings("ignore:the slave has slid")
def test_heat_balances_in_time():
    """What is stored and what leaves at both ends is what friction has set free."""
    warm = Warm(
        by_pressure(5.0),
        mesh=two_bodies(wide=1.6),
        hot=0.0,
        heat=lambda f, T: f.power,
        capacity=1.3,
        friction=0.3,
    )
    warm.Drag(steps=3)
    warm.before.vec.data = warm.last.vec
    out, into = warm.contact.Flow()
    rows = warm.gf.vec.CreateVector()
    warm.a.Apply(warm.gf.vec, rows)
    V, W, _ = warm.fes.components
    heat = rows.FV().NumPy()[V.ndof : V.ndof + W.ndof][: warm.mesh.nv]  # of hat functions
    stored = Integrate(1.3 * (warm.temperature - warm.before) * 3, warm.mesh)
    fixed = ~np.array(list(W.FreeDofs()))[: warm.mesh.nv]
    assert into - out > 0.03
    assert stored - heat[fixed].sum() == pytest.approx(into - out, rel=1e-9)
    warm.contact.Apply(warm.gf.vec, rows)  # where slip counts anew
    assert warm.contact.Flow() == (out, into)


# --- uses ----------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("solver", "options", "more"),
    [
        (ContactSolver, {"solver": "direct"}, {}),
        (ContactSolver, {"solver": "iterative"}, {}),
        (ContactSolver, {}, {"condense": True}),
        (AugmentedLagrangianSolver, {}, {}),
    ],
)
def test_all_solvers_agree(solver, options, more):
    flows = []
    for way, opts, extra in ((ContactSolver, {}, {}), (solver, options, more)):
        warm = Warm(
            by_pressure(5.0), order=3, expansion=0.02, nu=0.3, hot=3.0, friction=0.2, **extra
        )
        warm.Solve(way, **opts)
        flows.append((*warm.contact.Flow(), *warm.contact.Force()))
    assert flows[0][0] > 0.1
    assert flows[1] == pytest.approx(flows[0], rel=1e-8, abs=1e-9)


@pytest.mark.parametrize("finite", [False, True])
def test_units_of_heat_do_not_matter(finite):
    """Nor does heat that is large beside the work of forces: pressures are as exact as before."""
    pressures = []
    for unit in (1.0, 1e9):
        warm = Warm(
            lambda f, T, k=unit: k * f.pressure * (f.Slave(T) - f.Master(T)),
            hot=100.0,
            conductivity=(2 * unit, 2 * unit),
            expansion=1e-4,
            nu=0.3,
            friction=0.2,
            finite=finite,
        )
        warm.Solve()
        pressures.append(warm.contact.Table()["pressure"])
        assert warm.contact.Flow()[0] / unit > 0.1
    assert pressures[1] == pytest.approx(pressures[0], rel=1e-9)


def test_a_layer_of_a_law_conducts():
    layer = Law(lambda f: -CF(1000.0) * (f.jump - 0 * f.slip))
    warm = Warm(by_pressure(5.0), expansion=0.02, hot=3.0, law=layer)
    warm.Solve()
    assert warm.contact.Flow()[0] > 0.1


def test_nothing_flows_where_contact_is_switched_off():
    warm = Warm(lambda f, T: f.Slave(T) - f.Master(T), tied=True)
    warm.Solve()
    assert warm.contact.Flow()[0] > 0.1
    warm.contact.Deactivate()
    assert warm.contact.Flow() == (0, 0)
    warm.Solve()
    assert warm.contact.Flow() == (0, 0)


@pytest.mark.sample(1)
@pytest.mark.parametrize("finite", [False, True])
def test_a_temperature_that_nothing_holds_is_named(finite):
    """As contact opens, the upper block gets rid of its heat no more."""
    mesh = two_bodies()
    V, W = VectorH1(mesh, order=2, dirichlet="bottom|top"), H1(mesh, order=2, dirichlet="bottom")
    fes = V * W * LACSpace(V, slave="slave")
    (u, T, lam), (v, S, _) = fes.TnT()
    a = BilinearForm(fes)
    a += InnerProduct(Stress(Sym(Grad(u)), 100.0, 0.3), Sym(Grad(v))) * dx
    a += grad(T) * grad(S) * dx - S * dx("upper")
    film = Flux(T, lambda f: f.pressure * (f.Slave(T) - f.Master(T)))
    contact = LACContact(u, lam, master="master", finite=finite, flux=film)
    lift = Parameter(0)
    held = {"top": CF((0, 0.03 * lift - 0.02)), "bottom": CF((0, 0))}
    stepper = LoadStepper(ContactSolver(a, GridFunction(fes), contact), lift, prescribe=held)
    stepper.Integrate(0.5, steps=1, printing=False)
    assert contact.Flow()[0] == pytest.approx(0.5, rel=1e-9)
    words = "no step beyond load 0.6" if finite else "held by nothing in upper: where"
    with pytest.raises(ContactConvergenceError, match=words):
        stepper.Integrate(1, steps=1, printing=False)
    assert contact.Flow()[0] == pytest.approx(0.5, rel=1e-9)


def test_two_fluxes():
    """A current that heats what it flows through, through the contact as well."""
    mesh = two_bodies()
    V, W = (make(mesh, order=2, dirichlet="bottom|top") for make in (VectorH1, H1))
    fes = V * W * W * LACSpace(V, slave="slave")
    (u, T, phi, lam), (v, S, psi, _) = fes.TnT()
    a = BilinearForm(fes)
    a += InnerProduct(Grad(u), Grad(v)) * dx + grad(T) * grad(S) * dx + grad(phi) * grad(psi) * dx
    a += -grad(phi) * grad(phi) * S * dx  # Joule
    drop = lambda f: f.Slave(phi) - f.Master(phi)  # noqa: E731
    current = Flux(phi, lambda f: 2 * drop(f))
    heat = Flux(T, lambda f: 4 * (f.Slave(T) - f.Master(T)), heat=lambda f: 2 * drop(f) ** 2)
    contact = LACContact(u, lam, master="master", tied=True, flux=[current, heat])
    gf = GridFunction(fes)
    gf.components[2].Set(1, definedon=mesh.Boundaries("top"))
    ContactSolver(a, gf, contact).Solve(printing=False)
    amps = 1 / (0.5 + 1 / 2 + 1)
    assert contact.Flow(flux=current) == pytest.approx((amps, amps), rel=1e-10)
    out, into = contact.Flow(flux=heat)
    assert into - out == pytest.approx(amps**2 / 2, rel=1e-10)
    assert {"flux_out", "flux2_in"} <= set(contact.Table())


@pytest.mark.filterwarnings("ignore:the slave has slid")
def test_a_flux_may_remember(tmp_path):
    """A film that rubs off, in saved states."""

    def Film(f, T):
        way = f.History("way", lambda w: w + Norm(f.slip))
        return f.pressure * exp(-10 * way) * (f.Slave(T) - f.Master(T))

    warm = Warm(Film, mesh=two_bodies(wide=1.6), friction=0.1)
    stepper = warm.Drag(goal=0.5)
    SaveState(tmp_path / "state", stepper)
    stepper.Integrate(1, steps=1, printing=False)
    other = Warm(Film, mesh=two_bodies(wide=1.6), friction=0.1)
    again = other.Drag(goal=0.1, steps=1)
    LoadState(tmp_path / "state", again)
    again.Integrate(1, steps=1, printing=False)
    assert other.contact.Flow() == pytest.approx(warm.contact.Flow(), rel=1e-9)
    assert warm.contact.Table()["way"].min() > 0.1


def test_dynamics():
    """In time steps a rate is one of time; temperatures without capacity follow at once."""
    warm = Warm(
        by_pressure(5.0), mesh=two_bodies(wide=1.6), heat=lambda f, T: f.power, friction=0.3
    )
    time = Parameter(0)
    held = {"top": CF((time, -0.02)), "bottom": CF((0, 0))}
    solver = ContactSolver(warm.a, warm.gf, warm.contact)
    stepper = TimeStepper(solver, 1e-3, time=time, dt=0.02, prescribe=held)
    stepper.Integrate(0.1, printing=False)
    table, (out, into) = warm.contact.Table(), warm.contact.Flow()
    aside = table["traction"] + table["pressure"][:, None] * table["normal"]
    power = -table["area"] @ np.sum(aside * table["slip"], axis=1) / 0.02
    assert into - out == pytest.approx(power, rel=1e-12)
    assert power == pytest.approx(-warm.contact.Force()[0], rel=0.05)  # the speed is 1
    assert np.all(table["status"] == 2)


@pytest.mark.parametrize("rho_inf", [0.0, 0.5, 1.0])
def test_heat_in_time_steps_is_that_of_load_steps(rho_inf):
    """Where nothing moves, the same implicit Euler method."""
    found = []
    for kind in (LoadStepper, TimeStepper):
        warm = Warm(lambda f, T: 3 * (f.Slave(T) - f.Master(T)), hot=0.0, capacity=1.3)
        values = warm.temperature.vec.FV().NumPy()
        warm.temperature.Set(sin(3 * x) * cos(2 * y))
        values[~np.array(list(warm.temperature.space.FreeDofs()))] = 0
        warm.before.vec.data = warm.temperature.vec

        def Remember(_, warm=warm):
            warm.before.vec.data = warm.temperature.vec

        time = Parameter(0)
        held = {"top": CF((0, 0)), "bottom": CF((0, 0))}
        solver = ContactSolver(warm.a, warm.gf, warm.contact)
        options = {"callback": Remember, "printing": False}
        if kind is LoadStepper:
            LoadStepper(solver, time, prescribe=held).Integrate(0.08, steps=4, **options)
        else:
            more = {"dt": 0.02, "rho_inf": rho_inf, "maxcuts": 0}
            TimeStepper(solver, 1e-9, time=time, prescribe=held, **more).Integrate(0.08, **options)
        found.append(np.append(values, warm.contact.Flow()))
    assert np.abs(found[1] - found[0]).max() < 1e-6 * np.abs(found[0]).max()
    assert abs(found[0][-1]) > 1e-3


@pytest.mark.parametrize("finite", [False, True])
def test_a_field_of_one_body(finite):
    """What flows from it goes out of the problem; nothing may look at the other side."""
    mesh = two_bodies()
    V, W = VectorH1(mesh, order=2, dirichlet="bottom|top"), H1(mesh, definedon="upper", order=2)
    fes = V * W * LACSpace(V, slave="slave")
    (u, T, lam), (v, S, _) = fes.TnT()
    a = BilinearForm(fes)
    a += InnerProduct(Stress(Sym(Grad(u)), 100.0, 0.0), Sym(Grad(v))) * dx
    a += 2 * grad(T) * grad(S) * dx("upper") + 10 * (T - 1) * S * ds("top")
    law = {"tied": True, "finite": finite, "master": "master"}
    contact = LACContact(u, lam, flux=Flux(T, lambda f: 3 * (f.Slave(T) - 0.2)), **law)
    ContactSolver(a, GridFunction(fes), contact).Solve(printing=False)
    assert contact.Flow()[0] == pytest.approx(0.8 / (1 / 3 + 0.5 / 2 + 1 / 10), rel=1e-10)
    contact = LACContact(u, lam, flux=Flux(T, lambda f: f.Master(T)), **law)
    with pytest.raises(ContactConvergenceError, match="on the master, where that is not defined"):
        ContactSolver(a, GridFunction(fes), contact).Solve(printing=False)


# --- bad input -----------------------------------------------------------------------------------


def test_bad_input():
    mesh = two_bodies()
    V, W = VectorH1(mesh, order=2), H1(mesh, order=2)
    fes = V * W * LACSpace(V, slave="slave")
    (u, T, lam), (_, S, _) = fes.TnT()
    conducted = lambda f: f.Slave(T) - f.Master(T)  # noqa: E731

    def make(flux, **law):
        return LACContact(u, lam, **({"master": "master", "flux": flux} | law))

    for field in (None, 3, GridFunction(W), u, grad(T)):
        with pytest.raises(TypeError, match="scalar trial function"):
            Flux(field, conducted)
    for flow in (None, 3, CF(1), T):
        with pytest.raises(TypeError, match="a function"):
            Flux(T, flow)
    for share in (-0.1, 1.1, "half", np.nan):
        with pytest.raises((TypeError, ValueError), match="share"):
            Flux(T, conducted, share=share)
    with pytest.raises(TypeError, match="flux"):
        make(conducted)
    with pytest.raises(ValueError, match="components"):
        make(Flux(T, lambda f: CF((1, 2))))
    with pytest.raises(TypeError, match="return it"):
        make(Flux(T, lambda f: None))
    with pytest.raises((ValueError, NgException), match="trial function"):
        make(Flux(S, lambda f: f.Slave(T)))
    torn = V * Discontinuous(H1(mesh, order=2)) * LACSpace(V, slave="slave")
    w, theta, mu = torn.TrialFunction()
    with pytest.raises(ValueError, match="no degrees of freedom of its own"):
        LACContact(w, mu, master="master", flux=Flux(theta, lambda f: f.Slave(theta)))
    other = V * W * LACSpace(V, slave="slave")
    with pytest.raises(ValueError, match="another space"):
        make(Flux(other.TrialFunction()[1], lambda f: CF(1)))
    with pytest.raises(ValueError, match="no master"):
        make(Flux(T, conducted), master=None, obstacle=0.0)
    with pytest.raises(AttributeError, match=r"Slave\(T\)"):
        make(Flux(T, lambda f: f.pressure * conducted(f)), tied=True)
    with pytest.raises(ValueError, match="edges"):
        make(Flux(T, conducted), edges=True)
    with pytest.raises(ValueError, match="Law sees no"):
        make(None, law=Law(lambda f: f.Slave(T) * f.normal))
    with pytest.raises(ValueError, match="none of this contact"):
        make(None).Flow()
    with pytest.raises(ValueError, match="none of this contact"):
        make(Flux(T, conducted)).Flow(flux=Flux(T, conducted))


@pytest.mark.parametrize("sign", [1, -1])
def test_a_flow_from_the_colder_side_is_told(sign):
    warm = Warm(lambda f, T: sign * 0.3 * (f.Slave(T) - f.Master(T)))
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        warm.Solve()
    assert len(caught) == (sign < 0)
    assert all("is its sign right?" in str(warning.message) for warning in caught)


def test_what_is_remembered_is_shown_as_of_now():
    """In a loop of solves; the next step begins where the last one was accepted."""

    def Film(f, T):
        way = f.History("way", lambda w: w + 0.1 * f.pressure)
        return (1 + 0 * way) * (f.Slave(T) - f.Master(T))

    warm = Warm(Film, pressure=2.0, dirichlet={"dirichlety": "bottom", "dirichletx": ".*"})
    ways = []
    for accepts in (False, True, True):
        warm.Solve()
        ways.append(warm.contact.Table()["way"].mean())
        if accepts:
            warm.contact.Commit(warm.gf)
            assert warm.contact.Table()["way"].mean() == ways[-1]
    assert ways == pytest.approx([0.2, 0.2, 0.4], rel=1e-6)
