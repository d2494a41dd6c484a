"""Derivatives through load steps, with all that contacts and bulk remember."""

import numpy as np
import pytest
from bricks import brick
from netgen.occ import MoveTo, OCCGeometry, Y
from ngsolve import (
    CF,
    Grad,
    GridFunction,
    InnerProduct,
    Mesh,
    Norm,
    Parameter,
    Sym,
    VectorH1,
    ds,
    dx,
    x,
)
from posed import elastic, posed
from press import press, solved, stress
from scipy.optimize import least_squares
from varied import TOL, Slide, close, differences, velocity

from ngslac import LoadStepper, tools
from ngslac.analysis import Record, Sensitivity, Shape

STEPS = {"mu": 1e-5, "young": 1e-4, "spring": 1e-2}


def recorded(slide):
    record = Record(slide.stepper)
    slide.Run(record)
    return record


@pytest.mark.sample(2)
@pytest.mark.parametrize("dim", [2, 3])
@pytest.mark.parametrize("finite", [False, True])
def test_of_friction_through_steps(dim, finite):
    def Make():
        return Slide(dim, finite=finite, nonlinear=finite)

    slide = Make()
    record = Record(slide.stepper)
    forces, status = slide.Run(record)
    assert len({tuple(row) for row in status}) > 1
    s = Sensitivity(record, slide.contact.Force)
    assert np.allclose(s.value, forces, rtol=1e-9)
    for name, step in STEPS.items():
        if finite and name != "mu":
            continue
        other = Make()

        def Look(other=other, name=name):
            fresh = Make()
            getattr(fresh, name).Set(getattr(other, name).Get())
            return fresh.Run()[0]

        close(s.By(getattr(slide, name)), differences(getattr(other, name), Look, step))
    shape = Shape(slide.problem.mesh, velocity(dim))
    moved = []
    for sign in (1, -1):
        other = Make()
        Shape(other.problem.mesh, velocity(dim)).Move(sign * 1e-5)
        moved.append(other.Run()[0])
    close(s.By(shape), (moved[0] - moved[1]) / 2e-5)


@pytest.mark.parametrize("finite", [False, True])
def test_what_was_before_the_record_is_fixed(finite):
    def Half(mu):
        slide = Slide(finite=finite, nonlinear=finite)
        slide.stepper.Integrate(0.5, steps=2, printing=False, tol=TOL)
        slide.mu.Set(mu)
        record, forces = Record(slide.stepper), []

        def Note(step):
            record(step)
            forces.append(slide.contact.Force())

        slide.stepper.Integrate(steps=2, callback=Note, printing=False, tol=TOL)
        return slide, record, np.array(forces)

    slide, record, forces = Half(0.3)
    s = Sensitivity(record, slide.contact.Force)
    assert np.allclose(s.value, forces, rtol=1e-9)
    expected = (Half(0.3 + 1e-5)[2] - Half(0.3 - 1e-5)[2]) / 2e-5
    close(s.By(slide.mu), expected)


def inside(u, v, load):
    return InnerProduct(stress(u), Sym(Grad(v))) * dx


def test_of_an_obstacle_that_touches_on_the_way():
    mu = Parameter(0.3)

    def Make():
        load, mesh = Parameter(0), brick("trig", 6, 3)
        V = VectorH1(mesh, order=2, dirichlet="top")
        gap = 0.06 * mu * (x - 0.3) ** 2 + 0.005 - 0.02 * load
        problem = posed(V, inside, slave="bottom", load=load, obstacle=gap, friction=mu)
        return problem.contact, problem.stepper(prescribe={"top": CF((0.01 * load**2, 0))})

    def Run():
        contact, stepper = Make()
        record, forces, closed = Record(stepper), [], []

        def Note(step):
            record(step)
            forces.append(contact.Force())
            closed.append(np.count_nonzero(contact.Table()["status"]))

        stepper.Integrate(steps=5, callback=Note, printing=False, tol=TOL)
        return contact, record, np.array(forces), closed

    contact, record, _, closed = Run()
    assert closed[0] < closed[1] < closed[-1]
    found = Sensitivity(record, contact.Force).By(mu)
    close(found, differences(mu, lambda: Run()[2], 1e-5))


def test_of_a_tool_that_touches_on_the_way():
    depth, mesh = Parameter(0.06), brick("trig", 6, 3)

    def Make():
        load = Parameter(0)
        V = VectorH1(mesh, order=2, dirichlet="top")
        tool = tools.Plane((0.5, -0.08), (0.1, 1)).Moved(shift=(-0.05 * load, depth * load))
        law = {"obstacle": tool, "friction": 0.25, "finite": True}
        problem = posed(V, inside, slave="bottom", load=load, **law)
        return problem.contact, problem.stepper()

    def Run():
        contact, stepper = Make()
        record, forces = Record(stepper), []

        def Note(step):
            record(step)
            forces.append(contact.Force())

        stepper.Integrate(steps=4, callback=Note, printing=False, tol=TOL)
        return contact, record, np.array(forces)

    contact, record, forces = Run()
    assert not np.any(forces[0])
    assert np.all(forces[-1])
    s = Sensitivity(record, contact.Force)
    close(s.value, forces, 1e-9)
    close(s.By(depth), differences(depth, lambda: Run()[2], 1e-6))


def test_adjoint_where_no_step_depends_on_another():
    slide = Slide(friction=None)
    record = recorded(slide)
    lam = slide.problem.X.TrialFunction()[1]
    s = Sensitivity(record, lam[1] * ds("slave"))
    direct = Sensitivity(record, lambda: slide.contact.Force()[1])
    assert "adjoint" in repr(s)
    assert "direct" in repr(direct)
    close(s.By(slide.young), direct.By(slide.young), 1e-8)
    gradient = s.Gradient([slide.young, slide.spring])
    assert gradient.shape == (slide.steps, 2)
    frictional = recorded(Slide())
    lam = frictional.solver.gf.space.TrialFunction()[1]
    assert "direct" in repr(Sensitivity(frictional, lam[1] * ds("slave")))


def worn_rod(rate):
    """C1: a rod between fixed ends that wears at one of them; s is the way of sliding."""
    mesh = Mesh(OCCGeometry(Rod(), dim=2).GenerateMesh(maxh=0.5))
    V = VectorH1(mesh, order=2, dirichlety="top", dirichletx="side")

    def Worn(z):
        return z.History("worn", lambda worn: worn + rate * z.pressure * z.dt)

    problem = posed(V, elastic(100.0), load=Parameter(0), obstacle=CF(0), offset=Worn)
    problem.gf.components[0].Set((0, -1.0 * 10 / 100), definedon=mesh.Boundaries("top"))
    return problem.contact, LoadStepper(solved(problem), problem.load)


def Rod():
    rod = MoveTo(0, 0).Rectangle(1, 10).Face()
    rod.edges.name = "side"
    rod.edges.Min(Y).name, rod.edges.Max(Y).name = "slave", "top"
    return rod


def test_wear_by_hand():
    """dp/dk of p = p0 exp(-E k s / L), here by backward Euler steps, of which it is known, too."""
    rate = Parameter(1e-4)
    contact, stepper = worn_rod(rate)
    record = Record(stepper)
    stepper.Integrate(1000, steps=20, callback=record, printing=False, tol=TOL)
    s = Sensitivity(record, lambda: contact.Table()["pressure"].mean())
    step = 100 * rate.Get() * 50 / 10  # E k ds / L
    pressures = (1 + step) ** -np.arange(1.0, 21)
    close(s.value, pressures, 1e-8)
    by_rate = -np.arange(1, 21) * pressures / (1 + step) * step / rate.Get()
    close(s.By(rate), by_rate, 1e-7)
    assert abs(s.By(rate)[-1] / (-1e4 * np.exp(-1)) - 1) < 0.03  # the closed form


def test_memory_of_the_bulk():
    """A viscous bulk, whose strain of the last step is a field that a callback sets."""
    viscosity = Parameter(0.5)

    def Make():
        old = []

        def bulk(u, v, load):
            old.append(GridFunction(VectorH1(u.space.mesh, order=2)))
            rate = Sym(Grad(u)) - Sym(Grad(old[0]))
            flow = 100 * viscosity * InnerProduct(rate, Sym(Grad(v))) * dx
            return [InnerProduct(stress(u), Sym(Grad(v))) * dx, flow]

        problem = press(bulk=bulk, friction=0.3)
        problem.load.Set(0)
        stepper = LoadStepper(problem.solver(), problem.load)

        def Commit(step):
            old[0].vec.data = problem.gf.components[0].vec

        return problem, stepper, Commit, old

    problem, stepper, commit, old = Make()
    record = Record(stepper, commit=commit, memory=old)
    stepper.Integrate(steps=3, callback=record, printing=False, tol=TOL)
    s, kept = Sensitivity(record, problem.contact.Force), old[0].vec.FV().NumPy().copy()
    found = s.By(viscosity)
    assert np.array_equal(kept, old[0].vec.FV().NumPy())

    def Look():
        problem, stepper, commit, _ = Make()
        forces = []

        def Callback(step):
            commit(step)
            forces.append(problem.contact.Force())

        stepper.Integrate(steps=3, callback=Callback, printing=False, tol=TOL)
        return forces

    close(found, differences(viscosity, Look, 1e-5))


def test_prescribed_motions_and_rates():
    depth = Parameter(0.02)

    def Make():
        problem = press(
            friction=lambda z: 0.1 + 0.2 / (1 + Norm(z.rate)),
            spring=0,
            flags={"dirichlet": "bottom|top"},
        )
        problem.load.Set(0)
        path = {"top": problem.load * CF((0.02 * problem.load, -depth))}
        return problem, LoadStepper(problem.solver(), problem.load, prescribe=path)

    _, stepper = Make()
    record = Record(stepper)
    stepper.Integrate(steps=3, callback=record, printing=False, tol=TOL)
    s = Sensitivity(record, lambda: stepper.solver.Reaction("top"))

    def Look():
        _, stepper = Make()
        forces = []
        note = lambda step: forces.append(stepper.solver.Reaction("top"))  # noqa: E731
        stepper.Integrate(steps=3, callback=note, printing=False, tol=TOL)
        return forces

    close(s.By(depth), differences(depth, Look, 1e-6))


def test_nothing_changes():
    slide = Slide()
    record = recorded(slide)
    gf, contact = slide.problem.gf, slide.contact

    def State():
        state = contact.State()
        numbers = {name: np.asarray(state[name], dtype=float) for name in sorted(state)}
        return [gf.vec.FV().NumPy().copy(), *numbers.values(), *contact.Table().values()]

    before, steps, form = State(), len(slide.stepper.steps), contact.form
    s = Sensitivity(record, contact.Force)
    s.By(slide.mu)
    s.By(Shape(slide.problem.mesh, velocity(2)))
    assert all(np.array_equal(*pair, equal_nan=True) for pair in zip(before, State(), strict=True))
    assert (slide.load.Get(), slide.mu.Get(), len(slide.stepper.steps)) == (1.0, 0.3, steps)
    assert contact.form is form
    # The steps go on as if nothing had been.
    slide.stepper.Integrate(1.25, steps=1, printing=False, tol=TOL)
    other = Slide()
    other.Run()
    other.stepper.Integrate(1.25, steps=1, printing=False, tol=TOL)
    assert np.allclose(contact.Force(), other.contact.Force(), rtol=1e-12)


def test_a_friction_coefficient_from_a_force_curve():
    measured = Slide().Run()[0]

    def Error(mu):
        slide = Slide()
        slide.mu.Set(mu[0])
        record = recorded(slide)
        s = Sensitivity(record, slide.contact.Force)
        Error.slope = s.By(slide.mu).ravel()[:, None]
        return (s.value - measured).ravel()

    found = least_squares(Error, [0.2], lambda _: Error.slope, xtol=1e-12, gtol=1e-14, ftol=1e-14)
    assert abs(found.x[0] - 0.3) < 1e-7
    assert found.nfev < 12


def test_bad_input_is_refused():
    slide = Slide()
    with pytest.raises(TypeError, match="stepper"):
        Record(slide.solver)
    with pytest.raises(TypeError, match="memory"):
        Record(slide.stepper, memory=[3])
    record = Record(slide.stepper)
    with pytest.raises(ValueError, match="not solved anything"):
        Sensitivity(record, slide.contact.Force)
    slide.Run(record)
    with pytest.raises(ValueError, match="is that of the stepper"):
        Sensitivity(record, slide.contact.Force, prescribe={})
    with pytest.raises(ValueError, match="load of the stepper"):
        Sensitivity(record, slide.contact.Force).By(slide.load)
    with pytest.raises(ValueError, match="accepted this solution"):
        Sensitivity(slide.solver, slide.contact.Force)
    with pytest.raises(ValueError, match="empty"):
        Sensitivity(Record(slide.stepper), slide.contact.Force)
    with pytest.raises(TypeError, match="Record"):
        Sensitivity(slide.stepper, slide.contact.Force)
    late = Record(slide.stepper)
    slide.stepper.Integrate(1.1, steps=1, printing=False)
    with pytest.raises(ValueError, match="does not follow"):
        slide.stepper.Integrate(1.2, steps=1, callback=late, printing=False)
    later = Record(slide.stepper)
    slide.stepper.Integrate(1.3, steps=1, callback=later, printing=False)
    shape = Shape(slide.problem.mesh, velocity(2))
    with pytest.raises(ValueError, match="before the first step"):
        Sensitivity(later, slide.contact.Force).By(shape)
