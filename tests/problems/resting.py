"""A block without friction on a flat base, in any frame and units."""

from dataclasses import dataclass

import numpy as np
from ngsolve import (
    CF,
    BilinearForm,
    GridFunction,
    InnerProduct,
    Integrate,
    Mesh,
    Parameter,
    VectorH1,
    ds,
)
from press import linear, two_blocks
from scipy.spatial.transform import Rotation

from ngslac import ContactSolver, LACContact, LACSpace


def any_rotation(dim, seed):
    """An orthogonal matrix without reflection, from a number; None is none."""
    if seed is None:
        return np.eye(dim)
    if dim == 3:
        return Rotation.random(random_state=seed).as_matrix()
    angle = np.random.default_rng(seed).uniform(-np.pi, np.pi)
    return np.array([(np.cos(angle), -np.sin(angle)), (np.sin(angle), np.cos(angle))])


@dataclass
class Resting:
    """Its parts; forces and lengths are told in the frame and in the units of the block."""

    mesh: object
    gf: object
    contact: object
    solver: object
    rotation: np.ndarray
    length: float

    def solve(self):
        """The displacement coefficients over the unit of length."""
        self.solver.Solve(printing=False)
        return self.gf.components[0].vec.FV().NumPy() / self.length

    def mean(self, body="upper"):
        """The mean displacement of a body, in the frame of the block."""
        u, region = self.gf.components[0], self.mesh.Materials(body)
        parts = np.array([Integrate(u[k], region) for k in range(self.mesh.dim)])
        return self.rotation.T @ parts / Integrate(1.0, region) / self.length

    def force(self):
        """Of the contact, in the frame of the block."""
        d = self.mesh.dim
        return self.rotation.T @ np.array(self.contact.Force()) / self.length ** (d - 1)


def resting(
    dim=2, *, load=None, seed=None, length=1.0, gap=0.0, solver=None, h=0.25, friction=None, **law
):
    """The traction `load` on its top, -1 along the normal if none is told; MU and LAME are of
    `press`."""
    rotation = any_rotation(dim, seed)
    ngmesh = two_blocks(dim, h=h).ngmesh
    elements = Mesh(ngmesh).Materials("upper").Elements()
    upper = {v.nr for el in elements for v in el.vertices}
    for number, point in enumerate(ngmesh.Points()):
        place = np.array(point.p[:dim])
        place[-1] += gap * (number in upper)
        for k, value in enumerate(length * rotation @ place):
            point[k] = value
    mesh = Mesh(ngmesh)
    V = VectorH1(mesh, order=2, dirichlet="bottom")
    X = V * LACSpace(V, slave="slave")
    (u, lam), (v, _) = X.TnT()
    down = np.array((0.0,) * (dim - 1) + (-1.0,)) if load is None else np.array(load)
    a = BilinearForm(X)
    a += linear(u, v)
    a += -Parameter(1.0) * InnerProduct(CF(tuple(rotation @ down)), v) * ds("top")
    contact = LACContact(u, lam, master="master", friction=friction, **law)
    gf = GridFunction(X)
    made = ContactSolver(a, gf, contact, **({"solver": solver} if solver else {}))
    return Resting(mesh, gf, contact, made, rotation, length)
