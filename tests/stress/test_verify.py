"""The checks that know nothing of the solver find wrong answers."""

import numpy as np
import pytest
from ngsolve import CF, GridFunction
from run import PROBLEMS  # all of them are registered there
from stress_check import WrongAnswerError
from verify import Verifier


def Scale(factor):
    def spoil(problem, _):
        values, dofs = problem.gf.vec.FV().NumPy(), problem.contacts[0].form.MultiplierDofs()
        values[dofs] *= factor

    return spoil


def Rub(problem, _):
    dofs = problem.contacts[0].form.MultiplierDofs().reshape(-1, problem.mesh.dim)
    values = problem.gf.vec.FV().NumPy()
    normal = problem.contacts[0].Table()["normal"]
    along = np.zeros_like(normal)
    along[:, 0], along[:, 1] = normal[:, 1], -normal[:, 0]
    along[np.linalg.norm(along, axis=1) < 0.5, 0] = 1
    values[dofs] += 2 * np.linalg.norm(values[dofs], axis=1)[:, None] * along


def Sink(problem, _):
    moved = GridFunction(problem.X.components[0])
    moved.Set(problem.mesh.MaterialCF({"upper": CF((0, -0.02))}, default=CF((0, 0))))
    problem.gf.components[0].vec.data += moved.vec


def SlideBack(_, verify):
    verify.sides[0].last.jump[:] += [0.3, 0]  # as if it had slid the other way


def Load(problem, _):
    problem.Weight("b", CF((0, -0.2)))


EVERYWHERE = ["cyclic-0.3", "largeslide-0.3", "random-007"]


@pytest.mark.parametrize(
    ("names", "spoil", "what"),
    [
        (EVERYWHERE, Scale(-1.0), "tension"),
        (EVERYWHERE, Scale(1.1), "work of the contact"),
        (EVERYWHERE, Scale(0.0), "work"),
        (EVERYWHERE, Rub, "too much friction"),
        (EVERYWHERE[:2], Sink, "penetration"),
        (["fullslip-0.2"], SlideBack, "slip within friction"),
        (["stack"], Load, "equilibrium within|work of the contact"),
    ],
)
def test_wrong_answers_are_found(names, spoil, what):
    for name in names:
        problem = PROBLEMS[name]()
        verify = Verifier(problem)
        problem.Run(callback=lambda _, verify=verify: verify())
        spoil(problem, verify)
        with pytest.raises(WrongAnswerError, match=what):
            verify()


def test_elements_turned_inside_out_are_found():
    problem = PROBLEMS["neo-0.4"]()
    verify = Verifier(problem)
    verify._Orientation()
    values = problem.gf.components[0].vec.FV().NumPy()
    values[:] = np.random.default_rng(1).normal(size=len(values))
    with pytest.raises(WrongAnswerError, match="inside out"):
        verify._Orientation()
