"""Elements turned inside out are no solution, whatever the residual says."""

import pytest
from ngsolve import CF, H1, BilinearForm, GridFunction, Parameter, VectorH1, cos, sin, x, y
from press import linear

from ngslac import ContactConvergenceError, ContactSolver, LACContact, LACSpace, LoadStepper
from ngslac.demos import TwoBlocks
from ngslac.inverted import InvertedMessage


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
        "ngslac.solver.InvertedMessage", lambda *_: "folded" if load.Get() > 0.6 else ""
    )
    push = {"top": CF((0, -0.01)) * load}
    stepper = LoadStepper(ContactSolver(a, gf, contact), load, prescribe=push, maxcuts=1)
    with pytest.raises(ContactConvergenceError, match="folded; take smaller steps"):
        stepper.Integrate(steps=2, printing=False)
    assert load.Get() == 0.5
    assert [step.time for step in stepper.steps] == [0.5]
