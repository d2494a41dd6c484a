"""The look at a converged state finds each class of wrong states, however it came to be."""

import re
import warnings

import numpy as np
import pytest
from netgen.occ import Axis, Circle, Compound, MoveTo, OCCGeometry, Pnt, X, Y, Z
from ngsolve import (
    CF,
    BilinearForm,
    Det,
    Grad,
    GridFunction,
    Id,
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
    log,
    x,
    y,
)
from posed import posed

from ngslac import (
    ContactConvergenceError,
    ContactSolver,
    ContactWarning,
    FloatingBodyError,
    LACContact,
    LACSpace,
    LoadStepper,
)
from ngslac.materials import NeoHooke
from ngslac.solve.look import Look


def blocks(*, overlap=0.0, tilt=0.0, turn=0.0, scale=1.0):
    """An "upper" block ("slave" below, "top") on a "lower" one ("master", "bottom"), turned."""
    low = MoveTo(-0.5, -1).Rectangle(2, 1).Face()
    up = MoveTo(0, -overlap).LineTo(1, -overlap - tilt).LineTo(1, 1).LineTo(0, 1).Close().Face()
    for face, name, h in (low, "lower", 0.3), (up, "upper", 0.2):
        face.faces.name, face.edges.name, face.faces.maxh = name, "free", h * scale
    low.edges.Min(Y).name, low.edges.Max(Y).name = "bottom", "master"
    up.edges.Nearest(Pnt(0.5, -overlap - tilt / 2, 0)).name, up.edges.Max(Y).name = "slave", "top"
    shape = Compound([low, up]).Rotate(Axis(Pnt(0, 0, 0), Z), turn)
    shape = shape.Scale(Pnt(0, 0, 0), scale)
    return Mesh(OCCGeometry(shape, dim=2).GenerateMesh())


def hooke(u, v, modulus=1.0):
    strain = Sym(Grad(u))
    return modulus * InnerProduct(strain + Id(u.dim) * (strain[0, 0] + strain[1, 1]), Sym(Grad(v)))


class Pressed:
    """Blocks whose top is led, with a contact of these options."""

    def __init__(self, mesh, *, dirichlet="bottom|top", energy=False, **options):
        space = VectorH1(mesh, order=2, dirichlet=dirichlet)
        fes = space * LACSpace(space, slave="slave")
        (u, lam), (v, _) = fes.TnT()
        self.mesh, self.load, self.v = mesh, Parameter(1.0), v
        self.a, self.gf = BilinearForm(fes), GridFunction(fes)
        if energy:
            F = Id(2) + Grad(u)
            self.a += Variation((InnerProduct(F, F) / 2 - log(Det(F)) + log(Det(F)) ** 2) * dx)
        else:
            self.a += hooke(u, v) * dx
        self.contact = LACContact(u, lam, master="master", **options)
        self.solver = ContactSolver(self.a, self.gf, self.contact)

    def lead(self, motion):
        self.gf.components[0].Set(CF(motion), definedon=self.mesh.Boundaries("top"))
        return self

    def solve(self):
        with TaskManager():
            return self.solver.Solve(printing=False)

    def plant(self, motion):
        """Move the upper block, with all that is known of it, and look at that state."""
        system = self.solver.system
        moved = GridFunction(self.gf.space)
        moved.components[0].Set(CF(motion), definedon=self.mesh.Materials("upper"))
        self.gf.vec.data += moved.vec
        system.Measure()
        system.Evaluate()
        Look(system)()
        system.Tell()


def warned(run):
    with warnings.catch_warnings(record=True) as seen:
        warnings.simplefilter("always")
        run()
    return [str(one.message) for one in seen if one.category is ContactWarning]


@pytest.mark.parametrize("turn", [0, 37])
def test_a_slave_that_slid_over_the_faces_it_was_paired_with(turn):
    p = Pressed(blocks(turn=turn), friction=0.2)
    c, s = np.cos(np.radians(turn)), np.sin(np.radians(turn))
    p.lead((0.01 * s, -0.01 * c))
    assert warned(p.solve) == []
    (message,) = warned(lambda: p.plant((0.3 * c, 0.3 * s)))
    assert "slid by" in message
    assert "finite=True" in message


@pytest.mark.parametrize("scale", [1e-3, 1, 1e3])
def test_a_body_that_passed_through_the_surface_of_another_one(scale):
    p = Pressed(blocks(scale=scale), finite=True)
    p.lead((0, -0.01 * scale)).solve()
    with pytest.raises(ContactConvergenceError, match="inside of the master"):
        p.plant((0, -0.5 * x))


@pytest.mark.parametrize("overlap", [0.0, 0.05])
def test_the_half_of_a_slave_that_is_too_deep_to_be_seen(overlap):
    p = Pressed(blocks(overlap=overlap, tilt=0.2))
    message, *_ = warned(p.solve)
    assert "inside of the master" in message
    assert "penetration = " in message
    depth = float(message.split("penetration = ")[1].split(",")[0])
    seen = Pressed(blocks(overlap=overlap, tilt=0.2), penetration=depth)
    assert not any("inside of the master" in message for message in warned(seen.solve))
    assert seen.contact.Force()[1] > 2 * p.contact.Force()[1]


def test_rotations_that_a_linear_bulk_does_not_know():
    p = Pressed(blocks()).lead((0, -0.01))
    assert warned(p.solve) == []
    told = warned(lambda: p.plant((-0.6 * y, 0.6 * x)))
    assert any("small strains and rotations only" in message for message in told)


def test_elements_inside_out_are_an_error_where_the_material_knows_rotations():
    p = Pressed(blocks(), energy=True, finite=True).lead((0, -0.01))
    p.solve()
    with pytest.raises(ContactConvergenceError, match="inside out"):
        p.plant((-2 * x, 0))


@pytest.mark.parametrize("where", ["tpo", None])
def test_a_load_without_effect(where):
    p = Pressed(blocks(), friction=0.5)
    if where:
        p.a += p.load * CF((0.001, 0.01)) * p.v * ds(where)
    p.load.Set(0)
    stepper = LoadStepper(p.solver, p.load)
    (message,) = warned(lambda: stepper.Integrate(steps=3, printing=False))
    assert "nothing changes while the load goes from 0 to 1" in message


def test_a_load_with_effect_is_not_spoken_of():
    p = Pressed(blocks(), friction=0.5)
    p.load.Set(0)
    stepper = LoadStepper(p.solver, p.load, prescribe={"top": CF((0, -0.01)) * p.load})
    assert warned(lambda: stepper.Integrate(steps=3, printing=False)) == []


class Disc:
    """A "disc" in the "hole" of a plate, without friction, under its weight."""

    def __init__(self, *, turn=0.0, curve=3, swap=False):
        plate = Circle((0, 0), 2).Face() - Circle((0, 0), 1).Face()
        disc = Circle((0, -0.02), 0.98).Face()
        plate.faces.name, plate.edges.name = "plate", "outside"
        disc.faces.name, disc.edges.name = "disc", "disc"
        plate.edges.Nearest(Pnt(1, 0, 0)).name = "hole"
        plate.faces.maxh, disc.faces.maxh = 0.33, 0.25
        shape = Compound([plate, disc]).Rotate(Axis(Pnt(0, 0, 0), Z), turn)
        self.mesh = Mesh(OCCGeometry(shape, dim=2).GenerateMesh()).Curve(curve)
        space = VectorH1(self.mesh, order=2, dirichlet="outside")
        slave, master = ("hole", "disc") if swap else ("disc", "hole")
        down = np.sin(np.radians(turn)), -np.cos(np.radians(turn))

        def bulk(u, v, torque):
            loads = (torque * (x * v[1] - y * v[0]) - CF(down) * v) * dx("disc")
            return hooke(u, v, 100.0) * dx + loads

        problem = posed(space, bulk, slave=slave, master=master, load=Parameter(0.0))
        self.torque, self.gf, self.contact = problem.load, problem.gf, problem.contact
        self.solver = problem.solver()

    def solve(self):
        return self.solver.Solve(printing=False)


@pytest.mark.parametrize("turn", [0, 100])
@pytest.mark.parametrize("curve", [1, 2, 3])
@pytest.mark.parametrize("swap", [False, True])
def test_a_disc_in_a_hole_is_free_to_turn_and_stays(turn, curve, swap):
    p = Disc(turn=turn, curve=curve, swap=swap)
    (message,) = warned(p.solve)
    assert "body 'disc' is free (rotation)" in message
    u, inside = p.gf.components[0], p.mesh.Materials("disc")
    turned = np.mean([Grad(u)(p.mesh(0.3 * a, 0.3 * b))[2] for a, b in ((0, 1), (0, -1), (1, 0))])
    assert abs(turned) < 0.05
    assert np.linalg.norm(p.contact.Force()) == pytest.approx(np.pi * 0.98**2, rel=2e-2)
    assert inside


@pytest.mark.parametrize("torque", [1e-2, 1e-3])
def test_a_mechanism_under_a_load_is_no_state(torque):
    p = Disc()
    warned(p.solve)
    p.torque.Set(torque)
    system = p.solver.system
    system.residual.Measure(system.scale, exact=True)
    with pytest.raises(FloatingBodyError, match="'disc' floats \\(rotation\\) under the loads"):
        Look(system)()
    with pytest.raises(FloatingBodyError, match="'disc' floats \\(rotation\\)"):
        p.solve()


def test_right_angles_are_no_curved_surface():
    """A flat wedge with a small slope holds what pulls along it."""
    slope = 0.01
    low = MoveTo(0, -1).LineTo(2, -1).LineTo(2, 2 * slope).LineTo(0, 0).Close().Face()
    up = MoveTo(0.5, 0.5 * slope).LineTo(1.5, 1.5 * slope).LineTo(1.5, 1).LineTo(0.5, 1).Close()
    up = up.Face()
    for face, name in (low, "lower"), (up, "upper"):
        face.faces.name, face.edges.name, face.faces.maxh = name, "free", 0.2
    low.edges.Min(Y).name, low.edges.Nearest(Pnt(1, slope, 0)).name = "bottom", "master"
    up.edges.Nearest(Pnt(1, slope, 0)).name = "slave"
    up.edges.Max(X).name = "side"
    mesh = Mesh(OCCGeometry(Compound([low, up]), dim=2).GenerateMesh())
    space = VectorH1(mesh, order=2, dirichlet="bottom", dirichletx="side")
    problem = posed(space, lambda u, v, load: hooke(u, v) * dx + 0.01 * v[1] * dx("upper"))
    assert warned(lambda: problem.solver().Solve(printing=False)) == []
    force = problem.contact.Force()
    assert force[0] / force[1] == pytest.approx(-slope, rel=1e-6)


class Resting:
    """Discs above a floor, of one contact for all, on springs that hold next to nothing."""

    def __init__(
        self, *, centers=((0, 1.001),), spring=1e-3, weight=1.0, friction=0.3, bulk="hooke"
    ):
        discs = [Circle(center, 1).Face() for center in centers]
        for disc in discs:
            disc.faces.name, disc.edges.name, disc.faces.maxh = "disc", "round", 0.4
        floor = MoveTo(-4, -1).Rectangle(8, 1).Face()
        floor.faces.name, floor.edges.name, floor.faces.maxh = "floor", "wall", 0.7
        shape = OCCGeometry(Compound([*discs, floor]), dim=2)
        mesh = Mesh(shape.GenerateMesh()).Curve(2)
        V = VectorH1(mesh, order=2, definedon="disc")

        def inside(u, v, load):
            if bulk == "hooke":
                return hooke(u, v, 1e3) * dx("disc")
            return Variation(NeoHooke(Id(2) + Grad(u), 2.6e3, 0.3) * dx("disc"))

        def loads(u, v, load):
            return (load * weight * v[1] + spring * u * v) * dx("disc")

        law = {"slave": "round", "master": "round|wall", "finite": True, "friction": friction}
        problem = posed(V, inside, loads, load=Parameter(0), **law)
        self.load, self.contact, self.gf = problem.load, problem.contact, problem.gf
        self.solver = problem.solver()
        self.weight = weight * Integrate(1.0, mesh, definedon=mesh.Materials("disc"))


# Newton's method, the interior point method and the relaxation threw these through the floor. By
# default those run that take three seconds at most.
LONG = [
    {"spring": 1e-3, "friction": None},
    {"centers": ((-1.001, 1.001), (1.001, 1.001)), "weight": 10.0, "friction": None},
]


@pytest.mark.sample(3)
@pytest.mark.parametrize(
    "case",
    [
        {"spring": 1e-6, "weight": 0.01},
        {"spring": 1e-6},
        {"spring": 1e-3},
        {"spring": 1e-3, "bulk": "neo-hooke"},
        *(pytest.param(case, marks=pytest.mark.full) for case in LONG),
    ],
)
def test_no_step_throws_what_weak_springs_hold_through_the_floor(case):
    p = Resting(**case)
    try:
        LoadStepper(p.solver, p.load).Integrate(1, steps=1, printing=False)
    except ContactConvergenceError:
        return
    assert abs(p.contact.Force(on="wall")[1]) == pytest.approx(p.weight, rel=0.01)


@pytest.mark.sample(3)
@pytest.mark.parametrize("bulk", ["hooke", "neo-hooke"])
@pytest.mark.parametrize(("gap", "weight"), [(0.001, 0.01), (0.01, 1.0), (0.01, 10.0)])
def test_a_disc_that_nothing_but_a_floor_holds_lands_at_once(bulk, gap, weight):
    """Where no spring and no friction holds it, it neither turns nor slides."""
    p = Resting(centers=((0, 1 + gap),), spring=0, weight=weight, friction=None, bulk=bulk)
    p.load.Set(1)
    with pytest.warns(ContactWarning, match="body 'disc' is free"):
        last = p.solver.Solve(printing=False)
    assert last.number <= 8
    assert p.contact.Force(on="wall")[1] == pytest.approx(-p.weight, rel=1e-3)
    moved = p.gf.components[0]
    center = moved(p.gf.space.mesh(0, 1 + gap))
    assert abs(center[0]) < 1e-3  # of a disc of radius 1
    assert -0.1 < center[1] + gap < 0.01


@pytest.mark.parametrize("bulk", ["hooke", "neo-hooke"])
def test_forces_that_only_facets_make_are_named(bulk):
    """From farther away the disc lands on a facet that leans by some percent."""
    p = Resting(centers=((0, 1.1),), spring=0, friction=None, bulk=bulk)
    p.load.Set(1)
    said = warned(lambda: p.solver.Solve(printing=False))
    force = p.contact.Force(on="wall")
    assert force[1] == pytest.approx(-p.weight, rel=2e-3)
    share = abs(force[0] / force[1])
    assert 0.01 < share < 0.05
    (text,) = [text for text in said if "refine the slave" in text]
    assert share <= float(re.search(r"up to (\S+)%", text)[1]) / 100 <= 3 * share


def test_what_held_a_body_in_one_solve_holds_none_at_the_start_of_the_next():
    p = Resting(centers=((0, 1.01),), spring=0, friction=None)
    p.load.Set(1)
    assert warned(lambda: p.solver.Solve(printing=False))
    system = p.solver.system
    assert system.ground
    system.Begin(None, None)
    assert system.ground is None
    assert system.residual.ground is None


@pytest.mark.parametrize("depth", [0.6, 20])
def test_a_disc_within_or_below_the_floor_that_it_shares_a_contact_with(depth):
    p = Resting()
    p.solver.Solve(printing=False)
    p.gf.components[0].Set(CF((0, -depth)), definedon=p.gf.space.mesh.Materials("disc"))
    p.contact.Evaluate(p.gf)
    p.solver.system.residual.Follow()
    p.solver.system.Measure()
    with pytest.raises(ContactConvergenceError, match=r"(inside of|through) the master"):
        Look(p.solver.system)()
