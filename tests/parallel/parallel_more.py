"""Cases of what else a user may write: other spaces, functions, options and queries."""

import inspect
from typing import ClassVar

import numpy as np
from ngsolve import (
    CF,
    H1,
    BilinearForm,
    Grad,
    GridFunction,
    IfPos,
    InnerProduct,
    Integrate,
    Norm,
    Parameter,
    Sym,
    Trace,
    VectorH1,
    div,
    ds,
    dx,
    exp,
    grad,
    pi,
    x,
    y,
)
from parallel_problem import QUIET, Problem, linear, problem, results, rubber
from parallel_shapes import block_on_block, cube_on_block, disc_on_block
from parallel_small import press
from parallel_world import case

from ngslac import (
    Flux,
    LACContact,
    LACSpace,
    Law,
    LoadStepper,
    SplitSlaveFaces,
    TimeStepper,
)
from ngslac.materials import AxisymmetricGrad, Stress
from ngslac.meshes import Distributed, SphereOnBlock, TwoBlocks3D
from ngslac.parallel.together import Together


def on_space(mesh, V, *more, bulk=linear, **law):
    """A problem on another space of displacements, and on more components."""
    X = V
    for space in more:
        X = X * space
    X = X * LACSpace(V, slave=law.pop("slave", "slave"))
    u, *_, lam = X.TrialFunction()
    v, *_ = X.TestFunction()
    a = BilinearForm(X)
    a += bulk(u, v, CF(100.0))
    contact = LACContact(u, lam, **({"master": "master"} | law))
    return Problem(mesh, X, a, GridFunction(X), [contact], Parameter(0.0))


@case
def split(world):
    mesh = Distributed(lambda: SplitSlaveFaces(block_on_block(None), "slave"), world.comm)
    made = problem(mesh, order=1, friction=0.3)
    return press(made, (0.02, -0.03 + 0.05 * x))


@case
def mixed(world):
    """Nearly incompressible: with hydrostatic pressures."""

    def bulk(u, v, _):
        return 100 * InnerProduct(Sym(Grad(u)), Sym(Grad(v))) * dx

    mesh = block_on_block(world.comm)
    V = VectorH1(mesh, order=2, dirichlet="bottom|top")
    made = on_space(mesh, V, H1(mesh, order=1), bulk=bulk, friction=0.3)
    (u, p, _), (v, q, _) = made.X.TnT()
    made.a += (p * Trace(Grad(v)) + q * Trace(Grad(u)) - 1e-3 * p * q) * dx
    return press(made, (0.02, -0.03 + 0.05 * x))


@case
def part_of_a_space(world):
    """Displacements of one body only; the obstacle is a function."""
    mesh = block_on_block(world.comm)
    V = VectorH1(mesh, order=2, definedon="upper", dirichlet="top")
    made = on_space(mesh, V, master=None, obstacle=0.01 + 0.02 * x, friction=0.2)
    return press(made, (0.02, -0.04))


@case
def hexahedra(world):
    kinds = ("hex", "prism", 3, 2)
    mesh = Distributed(lambda: TwoBlocks3D(*kinds, overhang=0.2, aligned=False), world.comm)
    return press(problem(mesh, friction=0.3), (0.02, 0.01, -0.03 + 0.03 * x))


@case
def sphere(world):
    """Curved by the builder, with symmetry planes."""
    mesh = Distributed(lambda: SphereOnBlock(2.0, zone=6.5), world.comm)
    flags = {"dirichletx": "bottom|sym_x", "dirichlety": "bottom|sym_y", "dirichletz": "bottom|top"}
    return press(problem(mesh, flags=flags), (0.0, 0.0, -0.3))


@case
def regions(world):
    """Regions in place of names, and two names in one pattern."""
    mesh = block_on_block(world.comm)
    V = VectorH1(mesh, order=2, dirichlet="bottom|top")
    slave, master = mesh.Boundaries("slave|nothing"), mesh.Boundaries("master|side")
    made = on_space(mesh, V, slave=slave, master=master - mesh.Boundaries("side"), friction=0.3)
    return press(made, (0.02, -0.03 + 0.05 * x))


@case
def field_as_friction(world):
    """A coefficient that is a GridFunction on the distributed mesh, and one of materials."""
    mesh = block_on_block(world.comm)
    friction = GridFunction(H1(mesh, order=2))
    friction.Set(0.1 + 0.3 * x * x)
    made = problem(mesh, friction=friction, offset=CF(0.002) * (1 + y))
    return press(made, (0.05, -0.03 + 0.02 * x))


@case
def parameter_as_friction(world):
    """A coefficient that grows with the load, and a press fit that does."""
    mesh = block_on_block(world.comm)
    law = {"friction": lambda load: 0.1 + 0.2 * load, "offset": lambda load: -0.01 * load}
    return press(problem(mesh, **law), (0.05, -0.01))


class Wearing:
    """A stiff spring in place of contact, whose gap grows by pressure times slip."""

    kept: ClassVar = {"worn": 0.0}

    def __call__(self, places):
        pressure = 1000 * np.maximum(-places["gap"] - places["worn"], 0)
        slip = np.linalg.norm(places["slip"], axis=1)
        return {
            "traction": -pressure[:, None] * places["normal"],
            "by_gap": 1000 * (pressure > 0)[:, None] * places["normal"],
            "worn": places["worn"] + 0.05 * pressure * slip,
        }


@case
def own_law(world):
    """A law of the user's own, with a history."""
    made = problem(block_on_block(world.comm), law=Wearing())
    found = press(made, (0.1, -0.03), steps=3)
    worn = made.contacts[0].Table()["worn"]
    assert worn.max() > 1e-4
    return found | {"worn": (worn, None)}


def softening(fields):
    return 0.2 + 0.1 * exp(-fields.History("way", lambda way: way + Norm(fields.slip)) / 0.05)


def worn(fields):
    return fields.History("worn", lambda w: w + 0.01 * fields.pressure * Norm(fields.slip))


@case
def expressions(world):
    """Coefficients that are functions of the contact's fields, with histories."""
    law = {"friction": lambda load: softening, "offset": lambda load: worn}
    made = problem(block_on_block(world.comm), **law)
    found = press(made, (0.1, -0.03), steps=3)
    table = made.contacts[0].Table()
    assert table["worn"].max() > 1e-4
    return found | {"worn": (table["worn"], None), "way": (table["way"], None)}


@case
def heat_flow(world):
    """A temperature that flows through contact, and on which friction depends."""
    mesh = block_on_block(world.comm)
    V, W = (space(mesh, order=2, dirichlet="bottom|top") for space in (VectorH1, H1))
    X = V * W * LACSpace(V, slave="slave")
    (u, T, lam), (v, S, _) = X.TnT()
    a = BilinearForm(X)
    a += linear(u, v, 100.0) - 0.1 * T * div(v) * dx + grad(T) * grad(S) * dx
    film = Flux(T, lambda z: z.pressure * (z.Slave(T) - z.Master(T)), heat=lambda z: z.power)
    law = {"friction": lambda z: 0.3 * exp(-z.Slave(T)), "flux": film, "finite": True}
    contact = LACContact(u, lam, master="master", **law)
    made = Problem(mesh, X, a, GridFunction(X), [contact], Parameter(0.0))
    found = press(made, (0.1, -0.03))
    out, into = contact.Flow()
    assert into - out > 1e-3
    return found | {"flow": (np.array([out, into]), None)}


@case
def tied_temperature(world):
    """A scalar field that is continuous in the mean."""
    mesh = block_on_block(world.comm)
    S = H1(mesh, order=2, dirichlet="bottom|top")
    X = S * LACSpace(S, slave="slave")
    (T, q), (w, _) = X.TnT()
    made = Problem(mesh, X, BilinearForm(X), GridFunction(X), [], Parameter(0.0))
    made.a += (1 + T**2) * grad(T) * grad(w) * dx - made.load * (2 + y) * w * dx
    made.contacts.append(contact := LACContact(T, q, master="master", tied=True))
    done = LoadStepper(made.solver(), made.load).Integrate(steps=2, **QUIET)
    table, whole = contact.Table(), Integrate(made.u, mesh)
    assert abs(contact.Flow()[0]) > 0.01
    found = {"flux": table["flux"], "flow": contact.Flow(), "whole": whole}
    found |= {"force": contact.Force(), "steps": [step.iterations for step in done]}
    return {name: (np.array(values), None) for name, values in found.items()}


@case
def surfaces_alone(world):
    """No process knows more than its part and the surfaces; each knows what contact says."""
    made = problem(cube_on_block(world.comm, 0.3), friction=0.3)
    kept, rows = [], Together.Rows

    def counted(self, array, counts=None):
        found = rows(self, array, counts)
        kept.append(len(found))
        return found

    Together.Rows = counted
    try:
        solver = made.solver()
        made.u.Set(CF((0.02, 0.0, -0.03)), definedon=made.mesh.Boundaries("top"))
        solver.Solve(**QUIET)
    finally:
        Together.Rows = rows
    (contact,) = made.contacts
    if world.size > 1:
        skin, method = contact.form.trace.size, solver.linear._all[0].method
        numbering = method._taken.petsc.numbering
        assert max(kept) <= skin < 0.8 * made.X.ndofglobal
        own = len(made.gf.vec.FV()) + skin
        arrays = [part for part in vars(numbering).values() if isinstance(part, np.ndarray)]
        assert max(map(len, arrays)) <= own + numbering.width
    force = contact.Force() if world.rank == 0 else 0  # no call of others
    made.gf.vec.data = 0.5 * made.gf.vec
    contact.Evaluate(made.gf)
    half = contact.Force()
    assert np.linalg.norm(half) < 0.6 * np.linalg.norm(force) or world.rank
    return {"half": (half, None)}


@case
def law_as_expression(world):
    """A soft layer in place of contact."""
    layer = Law(lambda z: -IfPos(z.gap, 0, -1000 * z.gap) * (z.normal + z.slip))
    return press(problem(block_on_block(world.comm), law=layer), (0.1, -0.03), steps=2)


def turning(u, v, young):
    """The bulk form of bodies of revolution."""
    strain, virtual = Sym(AxisymmetricGrad(u)), Sym(AxisymmetricGrad(v))
    return 2 * pi * x * InnerProduct(Stress(strain, young, 0.3), virtual) * dx


@case
def axisymmetric(world):
    """Half a section through bodies of revolution."""
    made = problem(
        block_on_block(world.comm, shift=1.0), bulk=turning, axisymmetric=True, friction=0.2
    )
    return press(made, (0.02, -0.03))


@case
def field_as_load(world):
    """A temperature on the distributed mesh."""
    mesh = block_on_block(world.comm)
    made = problem(mesh, friction=0.3)
    heat = GridFunction(H1(mesh, order=2))
    heat.Set(1 + x * y)
    v = made.X.TestFunction()[0]
    made.a += -made.load * heat * Trace(Grad(v)) * dx
    done = LoadStepper(made.solver(), made.load).Integrate(steps=2, **QUIET)
    return results(made, iterations=[step.iterations for step in done])


@case
def switched(world):
    """Switched off and on between steps."""
    made = problem(block_on_block(world.comm), friction=0.3)
    (contact,) = made.contacts
    way = {"top": made.load * CF((0.02, -0.03))}
    stepper = LoadStepper(made.solver(), made.load, prescribe=way)
    stepper.Integrate(0.5, steps=1, **QUIET)
    contact.Deactivate()
    stepper.Integrate(0.75, steps=1, **QUIET)
    contact.Activate(made.gf)
    stepper.Integrate(1.0, steps=1, **QUIET)
    return results(made, active=contact.active)


@case
def ends(world):
    """Sharp ends, and a strain-free start."""
    made = problem(block_on_block(world.comm, gap=0.003), friction=0.3, edges=True, adjust=0.01)
    return press(made, (0.01, -0.02))


@case
def queries(world):
    """What can be asked of a contact."""
    made = problem(disc_on_block(world.comm), friction=0.3)
    found = press(made, (0.03, -0.1))
    (contact,) = made.contacts
    segments, report = contact.Segments(), contact.Check()
    more = {
        "unpaired": report.unpaired,
        "name": repr(contact),
        "gaps": np.sort(segments.gap),
        "areas": np.sort(segments.area),
        "macros": contact.space.nmacros,
        "moment about": contact.Moment((0.3, 0.2)),
        "master": Integrate(1, contact.master),
        "method": str(inspect.signature(contact.Force)) + contact.Force.__doc__,
        "to complete": sorted({"Table", "mesh", "pressure", "master"} & {*dir(contact)}),
    }
    return found | {name: (value, None) for name, value in more.items()}


@case
def fields(world):
    """Fields of the contact on the slave, integrated by NGSolve."""
    made = problem(disc_on_block(world.comm), friction=0.3)
    found = press(made, (0.03, -0.1))
    (contact,) = made.contacts
    slave = made.mesh.Boundaries("slave")
    for name in ("pressure", "gap", "status", "traction", "slip", "normal"):
        found[f"integral of {name}"] = Integrate(getattr(contact, name), slave), None
    found["lam"] = Integrate(made.gf.components[1], slave), None
    return found


@case
def dynamics3d(world):
    """A density that is a function, and the energy balance."""
    made = problem(cube_on_block(world.comm, 0.4), bulk=rubber, flags={"dirichlet": "bottom"})
    density = made.mesh.MaterialCF({"upper": 2.0}, default=1.0) * (1 + 0.1 * x)
    stepper = TimeStepper(made.solver(), density, dt=0.02, rho_inf=0.8)
    stepper.velocity.components[0].Set(CF((0.1, 0, -1)), definedon=made.mesh.Materials("upper"))
    stepper.Integrate(0.06, printing=False)
    total = stepper.balance.total
    return results(made, total=total)


@case
def by_iterations(world):
    """The iterative solver by name."""
    made = problem(cube_on_block(world.comm, 0.4), friction=0.3)
    found = press(made, (0.02, 0.0, -0.06 + 0.08 * x), solver=made.solver(solver="iterative"))
    del found["iterations"]
    return found


@case
def condensed_rubber(world):
    """Condensed, of third order, nonlinear."""
    made = problem(block_on_block(world.comm), order=3, bulk=rubber, condense=True, friction=0.3)
    return press(made, (0.05, -0.1 + 0.1 * x))


@case
def freedofs(world):
    made = problem(block_on_block(world.comm), friction=0.3)
    return press(made, (0.02, -0.03 + 0.05 * x), solver=made.solver(freedofs=made.X.FreeDofs()))


@case
def traction_in_3d(world):
    made = problem(cube_on_block(world.comm), flags={"dirichlet": "bottom"}, friction=0.5)
    v = made.X.TestFunction()[0]
    made.a += -made.load * InnerProduct(CF((0.1, 0.1 * y, -1.0)), v) * ds("top")
    made.load.Set(1.0)
    last = made.solver().Solve(**QUIET)
    return results(made, iterations=last.number)
