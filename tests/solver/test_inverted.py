"""Elements turned inside out are no solution, whatever the residual says."""

import pytest
from ngsolve import (
    CF,
    H1,
    BilinearForm,
    GridFunction,
    InnerProduct,
    Parameter,
    VectorH1,
    cos,
    dx,
    sin,
    x,
    y,
)
from press import linear, neo_hooke, press

from ngslac import ContactConvergenceError, ContactSolver, LACContact, LACSpace, LoadStepper
from ngslac.meshes import TwoBlocks
from ngslac.solve.inverted import InvertedMessage, TurningMaterials


def contact_of(space):
    fes = space * LACSpace(space, slave="slave")
    (u, lam), _ = fes.TnT()
    return fes, LACContact(u, lam, master="master", finite=True)


@pytest.mark.parametrize("kind", [VectorH1, lambda mesh, **flags: H1(mesh, dim=2, **flags)])
def test_which_elements_are_inside_out(kind):
    mesh = TwoBlocks(0.4, 0.5)
    fes, contact = contact_of(kind(mesh, order=2))
    gf = GridFunction(fes)
    displacement = gf.components[0]
    displacement.Set((cos(2) * x - sin(2) * y - x, sin(2) * x + cos(2) * y - y))
    assert InvertedMessage(contact.form, gf) == ""
    displacement.Set((-2 * x, 0))
    assert InvertedMessage(contact.form, gf).startswith(f"{mesh.ne} elements turn inside out")


def test_a_converged_step_with_such_elements_is_refused(monkeypatch):
    """Load and solution stay at the last step that is possible."""
    mesh = TwoBlocks(0.4, 0.5)
    fes, contact = contact_of(VectorH1(mesh, order=2, dirichlet="bottom|top"))
    (u, _), (v, _) = fes.TnT()
    a, load, gf = BilinearForm(fes), Parameter(0), GridFunction(fes)
    a += linear(u, v)
    monkeypatch.setattr(
        "ngslac.solve.solver.InvertedMessage", lambda *_: "folded" if load.Get() > 0.6 else ""
    )
    push = {"top": CF((0, -0.01)) * load}
    stepper = LoadStepper(ContactSolver(a, gf, contact), load, prescribe=push, maxcuts=1)
    with pytest.raises(ContactConvergenceError, match="folded; take smaller steps"):
        stepper.Integrate(steps=2, printing=False)
    assert load.Get() == 0.5
    assert [step.time for step in stepper.steps] == [0.5]


@pytest.mark.parametrize("condense", [False, True])
def test_which_materials_know_finite_rotations(condense):
    """Whatever the loads and springs are that the form holds, too."""
    for nonlinear in (False, True):
        problem = press(nonlinear=nonlinear, condense=condense)
        v = problem.X.TestFunction()[0]
        problem.a += -InnerProduct(CF((x, -1.0)), v) * dx
        form = problem.contact.form
        assert list(TurningMaterials(problem.a, form, problem.gf)) == [nonlinear, nonlinear]


def test_the_determinant_is_looked_at_where_rotations_are_finite():
    mesh = TwoBlocks(0.4, 0.5)
    fes, contact = contact_of(VectorH1(mesh, order=2))
    (u, _), (v, _) = fes.TnT()
    a, gf = BilinearForm(fes), GridFunction(fes)
    a += linear(u, v, dx("lower"))
    a += neo_hooke(u, dx("upper"))
    turning = TurningMaterials(a, contact.form, gf)
    assert [turning[mesh.GetMaterials().index(name)] for name in ("lower", "upper")] == [0, 1]
    gf.components[0].Set(mesh.MaterialCF({"lower": CF((-2 * x, 0))}, default=CF((0, 0))))
    lower = sum(element.mat == "lower" for element in mesh.Elements())
    assert InvertedMessage(contact.form, gf).startswith(f"{lower} elements turn inside out")
    assert InvertedMessage(contact.form, gf, turning) == ""
    gf.components[0].Set(mesh.MaterialCF({"upper": CF((-2 * x, 0))}, default=CF((0, 0))))
    assert "in 'upper'" in InvertedMessage(contact.form, gf, turning)
    assert InvertedMessage(contact.form, gf, 1 - turning) == ""
