"""Elements turned inside out are no solution, whatever the residual says."""

import pytest
from ngsolve import (
    CF,
    H1,
    Grad,
    Id,
    IfPos,
    InnerProduct,
    Variation,
    VectorH1,
    cos,
    dx,
    sin,
    x,
    y,
)
from press import linear, neo_hooke, press

from ngslac import ContactConvergenceError, LoadStepper, TimeStepper
from ngslac.solve.inverted import InvertedMessage, TurningMaterials

FOLDED = CF((-2 * x, 0))


def message(problem, *turning):
    return InvertedMessage(problem.contact.form, problem.gf, *turning)


@pytest.mark.parametrize("space", [VectorH1, lambda mesh, **flags: H1(mesh, dim=2, **flags)])
def test_which_elements_are_inside_out(space):
    problem = press(h=0.5, space=space, finite=True)
    displacement = problem.gf.components[0]
    displacement.Set((cos(2) * x - sin(2) * y - x, sin(2) * x + cos(2) * y - y))
    assert message(problem) == ""
    displacement.Set(FOLDED)
    assert message(problem).startswith(f"{problem.mesh.ne} elements turn inside out")


def test_a_converged_step_with_such_elements_is_refused(monkeypatch):
    """Load and solution stay at the last step that is possible."""
    flags = {"dirichlet": "bottom|top"}
    problem = press(h=0.5, nonlinear=True, finite=True, spring=0, flags=flags)
    load = problem.load
    load.Set(0)
    monkeypatch.setattr(
        "ngslac.solve.system.InvertedMessage", lambda *_: "folded" if load.Get() > 0.6 else ""
    )
    push = {"top": CF((0, -0.01)) * load}
    stepper = LoadStepper(problem.solver(), load, prescribe=push, maxcuts=1)
    with pytest.raises(ContactConvergenceError, match="folded; take smaller steps"):
        stepper.Integrate(steps=2, printing=False)
    assert load.Get() == 0.5
    assert [step.time for step in stepper.steps] == [0.5]


@pytest.mark.parametrize("condense", [False, True])
@pytest.mark.parametrize("nonlinear", [False, True])
def test_which_materials_know_finite_rotations(condense, nonlinear):
    """Whatever the loads and springs are that the form holds, too."""
    problem = press(nonlinear=nonlinear, condense=condense)
    problem.a += -InnerProduct(CF((x, -1.0)), problem.X.TestFunction()[0]) * dx
    turning = TurningMaterials(problem.a, problem.contact.form, problem.gf)
    assert list(turning) == [nonlinear, nonlinear]


def test_the_determinant_is_looked_at_where_rotations_are_finite():
    bulk = lambda u, v, _: (linear(u, v, dx("lower")), neo_hooke(u, dx("upper")))  # noqa: E731
    problem = press(h=0.5, spring=0, finite=True, bulk=bulk)
    mesh, displacement = problem.mesh, problem.gf.components[0]
    turning = TurningMaterials(problem.a, problem.contact.form, problem.gf)
    assert [turning[mesh.GetMaterials().index(name)] for name in ("lower", "upper")] == [0, 1]
    displacement.Set(mesh.MaterialCF({"lower": FOLDED}, default=CF((0, 0))))
    lower = sum(element.mat == "lower" for element in mesh.Elements())
    assert message(problem).startswith(f"{lower} elements turn inside out")
    assert message(problem, turning) == ""
    displacement.Set(mesh.MaterialCF({"upper": FOLDED}, default=CF((0, 0))))
    assert "in 'upper'" in message(problem, turning)
    assert message(problem, 1 - turning) == ""


def saint_venant_kirchhoff(u, v, _):
    """A material that has a state of no stress inside out, too."""
    deformation = Id(2) + Grad(u)
    strain = (deformation.trans * deformation - Id(2)) / 2
    return [Variation(InnerProduct(strain, strain) * dx)]


def static(solver):
    solver.Solve(printing=False)


def dynamic(solver):
    TimeStepper(solver, 1.0, dt=0.05, maxcuts=1).Integrate(0.1, printing=False)


@pytest.mark.parametrize("solve", [static, dynamic])
def test_a_material_turned_inside_out_is_refused(solve):
    """Inertia does not hide which materials know finite rotations."""
    options = {"spring": 0, "order": 1, "h": 0.5, "flags": {"dirichlet": "bottom|top"}}
    apart = {"finite": True, "offset": 5, "maxdist": 9}
    problem = press(bulk=saint_venant_kirchhoff, **options, **apart)
    problem.gf.components[0].Set(CF((0, IfPos(y, -2 * y, 0))))
    with pytest.raises(ContactConvergenceError, match="turn inside out"):
        solve(problem.solver())
