"""A mass on springs and a soft foot that slides on a moving belt, in 2D and 3D.

Its modes are those of the model of Hoffmann et al. (2002): springs of stiffness (2/3)(2 -+ sqrt 3)
at 150 and 30 degrees, a contact spring of 4/3, and the square of the frequencies is
2 +- sqrt(1 - 4 mu / 3): above mu = 3/4 the vibration grows.
"""

from dataclasses import dataclass

import numpy as np
from ngsolve import (
    CF,
    BilinearForm,
    Grad,
    GridFunction,
    IfPos,
    InnerProduct,
    Parameter,
    VectorH1,
    dx,
    x,
    y,
    z,
)
from ngsolve.meshes import MakeStructured2DMesh, MakeStructured3DMesh

from ngslac import ContactSolver, LACContact, LACSpace, LoadStepper, TimeStepper, tools

STIFF, LIGHT = 1e5, 1e-7  # of the mass and of the foot, for those of the model
ACROSS = 2.5  # stiffness across the plane of the model, in 3D


def exact(mu):
    """Angular frequencies, complex where the vibration grows."""
    root = np.sqrt(complex(1 - 4 * mu / 3))
    return np.sqrt([2 - root, 2 + root])


@dataclass
class Slider:
    """A steadily sliding mass; `density` is that of its material."""

    mesh: object
    solver: ContactSolver
    stepper: LoadStepper
    density: object

    @property
    def contact(self):
        return self.solver.contacts[0]

    @property
    def pressing(self):
        return float(
            np.linalg.norm(self.contact.Table()["pressure"] * self.contact.Table()["area"])
        )


def slider(mu, *, dim=2, turn=None, units=(1.0, 1.0, 1.0), n=1, stiff=STIFF, light=LIGHT, way=0.4):
    """The belt has moved by a `way`; `turn` (d, d) is a rotation, units are of length, mass, time.

    Without strain across: the material is that of a vector Laplacian.
    """
    length, mass, time = units
    turn = np.eye(dim) if turn is None else turn
    along, up = turn[:, 0], turn[:, -1]
    mesh = _Mesh(dim, n, length * turn)
    V = VectorH1(mesh, order=2)
    X = V * LACSpace(V, slave="bottom")
    (u, lam), (v, _) = X.TnT()
    height = sum(float(c) * s for c, s in zip(up, (x, y, z)[:dim], strict=True))
    Of = lambda top, foot: IfPos(height, top, foot)  # noqa: E731
    force = mass / time**2 / length**dim  # per displacement and volume
    directions = [
        (2 / 3 * (2 + sign * 3**0.5), sign * 3**0.5 / 2 * along + up / 2) for sign in (-1, 1)
    ]
    if dim == 3:
        directions.append((ACROSS, turn[:, 1]))
    a = BilinearForm(X)
    a += force * length**2 * Of(stiff, 4 / 3) * InnerProduct(Grad(u), Grad(v)) * dx
    for stiffness, direction in directions:
        d = CF(tuple(direction.tolist()))
        a += force * Of(stiffness, 0) * (u * d) * (v * d) * dx
    a += 0.01 * length * force * Of(1, 0) * (v * CF(tuple(up.tolist()))) * dx
    moved = Parameter(0.0)
    shift = tuple(-length * float(c) * moved for c in along)
    belt = tools.Plane(tuple((-length * up).tolist()), tuple(up.tolist())).Moved(shift=shift)
    contact = LACContact(u, lam, obstacle=belt, finite=True, friction=mu)
    solver = ContactSolver(a, GridFunction(X), contact)
    stepper = LoadStepper(solver, moved)
    stepper.Integrate(way, steps=2, printing=False)
    return Slider(mesh, solver, stepper, mass / length**dim * Of(1, light))


def integrated(problem, modes, *, k=0, dt=0.05, kick=1e-6, wait=12, end=24):
    """The eigenvalue of a motion that begins with the velocities of a mode, by time integration.

    It is taken from the times between `wait` and `end`: others die away before.
    """
    belt, real = problem.stepper.load, modes.Shape(k)[0]
    stepper = TimeStepper(problem.solver, problem.density, dt=dt, time=belt)
    stepper.velocity.components[0].vec.data = kick * real.vec
    start, begin = problem.solver.gf.vec.FV().NumPy().copy(), belt.Get()
    shapes = np.array([modes.vectors[:, k].real, modes.vectors[:, k].imag])
    heavy, record = np.array([stepper.mass.Times(shape) for shape in shapes]), []

    def Record(step):
        moved = stepper.gf.vec.FV().NumPy() - start
        record.append((step.time - begin, *heavy @ moved))

    stepper.Integrate(begin + end, callback=Record, printing=False)
    times, *parts = np.array(record)[int(wait / dt) :].T
    # The motion is Re(amplitude x): the amplitude grows and turns as exp(lambda t).
    first, second = np.linalg.solve(heavy @ shapes.T, parts)
    logarithm = np.log(np.abs(first - 1j * second)), np.unwrap(np.angle(first - 1j * second))
    return complex(*(np.polyfit(times, part, 1)[0] for part in logarithm))


def _Mesh(dim, n, turn):
    """The foot is below the height 0, the mass above it."""

    def Place(*point):
        return tuple((turn @ [*(c - 0.5 for c in point[:-1]), 2 * point[-1] - 1]).tolist())

    if dim == 2:
        return MakeStructured2DMesh(nx=n, ny=2 * n, mapping=lambda s, t: Place(s, t))
    return MakeStructured3DMesh(nx=n, ny=n, nz=2 * n, mapping=lambda r, s, t: Place(r, s, t))
