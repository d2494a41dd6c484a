"""Functions without values, iterables without an end, spaces that were refined."""

from itertools import count, repeat

import pytest
from ngsolve import BilinearForm, Grad, GridFunction, InnerProduct, VectorH1, dx, x

from ngslac import ContactSolver, LACContact, LACSpace, TimeStepper
from ngslac.meshes import TwoBlocks


class Problem:
    def __init__(self):
        self.mesh = TwoBlocks(0.5, overhang=0.2, aligned=False, structured=True)
        self.V = VectorH1(self.mesh, order=2, dirichlet="top|bottom")
        self.Q = LACSpace(self.V, slave="slave")
        self.X = self.V * self.Q
        (self.u, self.lam), (self.v, _) = self.X.TnT()
        self.a = BilinearForm(InnerProduct(Grad(self.u), Grad(self.v)) * dx)
        self.gf = GridFunction(self.X)
        self.contact = self.with_law()

    def with_law(self, **law):
        return LACContact(self.u, self.lam, **({"master": "master"} | law))

    def solver(self):
        return ContactSolver(self.a, self.gf, self.contact)


@pytest.fixture
def problem():
    return Problem()


USES = {
    "friction": lambda p: p.with_law(friction=0.1 + p.u[1] * x),
    "tresca": lambda p: p.with_law(tresca=p.lam[0]),
    "obstacle": lambda p: p.with_law(master=None, obstacle=p.v[1]),
    "background": lambda p: p.contact.Draw(background=p.u, show=False),
    "deformation": lambda p: p.contact.Draw(deformation=2 * p.v, show=False),
    "displacement": lambda p: p.contact.WriteVTU("none", displacement=p.u),
    "density": lambda p: TimeStepper(p.solver(), 1 + p.u[1], dt=0.1),
    "prescribe": lambda p: TimeStepper(p.solver(), 1, dt=0.1, prescribe={"top": p.u}),
}


@pytest.mark.parametrize("name", USES)
def test_trial_functions_have_no_values(problem, name):
    with pytest.raises(ValueError, match=f"^{name}.* holds a trial or test function"):
        USES[name](problem)


def test_endless_iterables(problem):
    with pytest.raises(ValueError, match=r"macros = repeat\(0\) has more entries"):
        LACSpace(problem.V, slave="slave", macros=repeat(0))
    with pytest.raises(ValueError, match="contacts: two contacts share one lam"):
        ContactSolver(problem.a, problem.gf, repeat(problem.contact))
    with pytest.raises(TypeError, match="contacts = 0 must be a LACContact"):
        ContactSolver(problem.a, problem.gf, count())


def test_what_breaks_off_while_it_is_read(problem):
    with pytest.raises(TypeError, match=r"macros = .*Mesh.* must be a list of integers"):
        LACSpace(problem.V, slave="slave", macros=problem.mesh)


def test_a_refined_space_needs_a_new_solver(problem):
    solver = problem.solver()
    problem.mesh.Refine()
    for space in (problem.V, problem.Q, problem.X):
        space.Update()
    problem.gf.Update()
    with pytest.raises(ValueError, match="the space was refined: make a new ContactSolver"):
        TimeStepper(solver, 1.0, dt=0.1)
