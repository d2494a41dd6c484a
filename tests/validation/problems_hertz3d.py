"""The example hertz3d in any frame and units, with all that tests and report want to know."""

from dataclasses import dataclass

import hertz3d
import numpy as np
from hertzmeans import Radius
from macros3d import Comparison
from slavefaces import SlaveFaces

from ngslac.meshes import RotationMatrix
from ngslac.meshes.cylinders import THICKNESS

__all__ = ["Problem", "Results", "Run", "State"]


@dataclass(frozen=True, kw_only=True)
class Problem:
    """The options of the example, and `maxh`, a part `force` of its load, units and a rotation.

    `length` and `stress` are a millimetre and a MPa in the units of the computation. Results are
    in mm and MPa, in the frame that is not rotated.
    """

    shape: str = "sphere"
    model: str = "quarter"
    order: int = 2
    h: float = 0.3125
    maxh: float | None = None
    force: float = 1.0
    friction: float = 0.0
    steps: int = 1
    stabilize: str = "none"
    length: float = 1.0
    stress: float = 1.0
    rotation: object = None

    def Hertz(self, t=1.0):
        """Hertz' solution at the load factor t, in mm and MPa."""
        return hertz3d.Hertz(self.shape, self.force * t)

    @property
    def load(self):
        """Force on the model, in the units of the computation."""
        force = self.force * hertz3d.FORCE[self.shape] * self.stress * self.length**2
        thickness = THICKNESS if self.shape == "cylinder" else 1.0
        return force * thickness * hertz3d.PART.get((self.shape, self.model), 1.0)

    @property
    def frame(self):
        """Unit vectors of the x, y and z direction of the problem, as rows."""
        return RotationMatrix(self.rotation).T

    def Mesh(self):
        options = {"model": self.model, "order": self.order, "stabilize": self.stabilize}
        if self.shape == "sphere":
            options |= {"maxh": self.maxh, "rotation": self.rotation}
        return hertz3d.Mesh(self.shape, self.h, force=self.force, scale=self.length, **options)


@dataclass(frozen=True)
class State:
    """A converged load step; macro-elements in the order of the space, in mm and MPa."""

    time: float
    iterations: int
    pressure: np.ndarray
    status: np.ndarray
    force: float  # contact force over the load of this step


@dataclass(frozen=True)
class Results:
    problem: Problem
    contact: object
    faces: SlaveFaces
    states: list
    ndof: int

    @property
    def radius(self):
        return Radius(self.problem.Hertz())

    @property
    def figures(self):
        last, iterations = self.states[-1], [state.iterations for state in self.states]
        hertz = self.problem.Hertz(last.time)
        return Comparison(self.faces, hertz, last.pressure, last.status) | {
            "force_ratio": last.force,
            "newton_iterations": iterations,
        }


def Run(**options):
    """Compute a `Problem`."""
    problem = Problem(**options)
    names = ("order", "stabilize", "friction", "steps", "length", "stress")
    options = {name: getattr(problem, name) for name in names}
    up = problem.frame[2]
    pressed = hertz3d.Press(problem.Mesh(), problem.load, up=up, **options)
    states = [
        State(
            time,
            iterations,
            table["pressure"] / problem.stress,
            table["status"],
            float(up @ force / (problem.load * time)),
        )
        for time, iterations, force, table in pressed.steps
    ]
    contact, axes = pressed.contact, problem.frame[:2] / problem.length
    line = problem.shape == "cylinder"
    faces = SlaveFaces(contact.mesh, contact.space.macros, line, axes)
    return Results(problem, contact, faces, states, len(pressed.solution.vec))
