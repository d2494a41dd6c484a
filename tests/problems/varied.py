"""Problems that are solved again beside a design, and the differences of what they give."""

import numpy as np
from ngsolve import CF, IfPos, InnerProduct, Parameter, Sym, ds, dx, x, y, z
from press import Grad, neo_hooke, press, stress

from ngslac import LoadStepper

TOL = 1e-12
MU, YOUNG, SPRING = 0.3, 1.0, 400.0
FIELDS = {2: (0.1 * x + 0.05 * y, 0.3 * y + 0.2 * x), 3: (0.1 * x, 0.1 * z, 0.3 * z + 0.2 * x)}


def velocity(dim):
    """Of points of the mesh: no rotation, no similarity, and other normals on both sides."""
    return CF(FIELDS[dim])


def differences(variable, look, step):
    """Central differences of an array: look() solves anew and returns it."""
    found, start = [], variable.Get()
    try:
        for sign in (1, -1):
            variable.Set(start + sign * step)
            found.append(np.asarray(look()))
    finally:
        variable.Set(start)
    return (found[0] - found[1]) / (2 * step)


class Moved:
    """How far a Shape has moved, as a Parameter; the contacts pair anew."""

    def __init__(self, shape, contact):
        self.shape, self.contact, self.start = shape, contact, shape.Points().copy()

    def Get(self):
        return 0.0

    def Set(self, way):
        self.shape.Points()[:] = self.start + way * self.shape.velocity
        self.contact.Update()


def solve(problem):
    """From zero, by a new solver."""
    problem.gf.vec[:] = 0
    solver = problem.solver()
    solver.Solve(printing=False, tol=TOL)
    return solver


def close(found, expected, tol=1e-6):
    found, expected = np.asarray(found), np.asarray(expected)
    assert found.shape == expected.shape
    assert np.abs(found - expected).max() < tol * np.abs(expected).max()


class Slide:
    """A block pushed down first, then aside, in steps: what stuck begins to slip."""

    def __init__(self, dim=2, *, nonlinear=False, steps=4, **law):
        self.mu, self.young, self.spring = map(Parameter, (MU, YOUNG, SPRING))
        self.steps = steps

        def bulk(u, v, load):
            linear = self.young * InnerProduct(stress(u), Sym(Grad(v))) * dx
            aside = (0.1 * load, 0.04 * load)[: dim - 1]
            held = self.spring * InnerProduct(u - load * CF((*aside, -0.05)), v) * ds("top")
            return [neo_hooke(u) if nonlinear else linear, held]

        law = {"friction": IfPos(x - 0.3, 0.2, 2.0) * self.mu} | law
        self.problem = press(dim=dim, bulk=bulk, spring=0, **law)
        self.load, self.contact = self.problem.load, self.problem.contact
        self.load.Set(0)
        self.solver = self.problem.solver()
        self.stepper = LoadStepper(self.solver, self.load)

    def Run(self, callback=None):
        """Forces and statuses after each step."""
        forces, status = [], []

        def Note(step):
            if callback:
                callback(step)
            forces.append(self.contact.Force())
            status.append(self.contact.Table()["status"])

        self.stepper.Integrate(steps=self.steps, callback=Note, printing=False, tol=TOL)
        return np.array(forces), np.array(status)
