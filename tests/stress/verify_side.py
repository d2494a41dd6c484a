"""The two sides of one contact as sums over many points, by brute force."""

from dataclasses import dataclass

import numpy as np
from ngsolve import CF, GridFunction
from stress_problem import Twin
from verify_faces import Faces, Rule
from verify_rays import MeetFaces

CELLS = {2: 24, 3: 6}  # of the sums, along a slave face
BENT = {2: 6, 3: 3}  # along a master face that is curved or deformed


@dataclass
class State:
    """Arrays over the macro-elements, and what the points of the slave faces meet."""

    traction: np.ndarray
    normal: np.ndarray
    gap: np.ndarray
    slip: np.ndarray  # since the state before
    covered: np.ndarray  # part of the area that has a partner
    whole: np.ndarray  # do the corners of all faces have one, too?
    even: np.ndarray  # do all points meet the same normal?
    jump: np.ndarray
    directions: np.ndarray  # in which the pressure acts there
    hits: object
    friction: np.ndarray  # coefficient
    memory: np.ndarray  # of the law: its offset, or what it remembers
    expected: np.ndarray | None  # traction of a law that gives all of it

    @property
    def pressure(self):
        return -np.sum(self.traction * self.normal, axis=1)

    @property
    def shear(self):
        return self.traction + self.pressure[:, None] * self.normal


class Side:
    """Slave faces of a contact of a problem, cut into points, and what they meet."""

    def __init__(self, problem, number):
        slave, other = problem.pairs[number]
        self.law, mesh, space = problem.laws[number], problem.mesh, problem.X.components[0]
        self.dim = mesh.dim
        self.name = f"{slave} on {other if isinstance(other, str) else 'an obstacle'}"
        self.finite = bool(self.law.get("finite"))
        degree = max(space.globalorder, mesh.GetCurveOrder(), 3)
        self.faces = Faces(mesh, slave, degree)
        self.master = Faces(mesh, other, degree) if isinstance(other, str) else None
        self.u, self.lam = problem.gf.components[0], problem.gf.components[1 + number]
        points, weights = Rule(self.faces.kind, CELLS[self.dim])
        self.shapes, self.slopes = self.faces.Shapes(points), self.faces.Slopes(points)
        self.macro = Macros(self.faces, problem.X.components[1 + number])
        self.unbent = self.dim == 2 and not self.finite and mesh.GetCurveOrder() < 2
        normals = self._Normals(self.faces.position)
        self.weights = weights * np.linalg.norm(normals, axis=-1)
        self.size = self._Sum(np.ones(self.weights.shape)) ** (1 / (self.dim - 1))
        if problem.axisymmetric:
            self.weights = self.weights * 2 * np.pi * self._At(self.faces.position)[..., 0]
        self.area = self._Sum(np.ones(self.weights.shape))
        self.obstacle = None if self.master else CF(other)
        self.twin, self.load, self.loaded = problem.twin or Twin(), problem.load, 0.0
        friction = 0 if self.twin.friction else self.law.get("friction") or 0
        friction = self.faces.Values(CF(friction))[..., 0]
        self.friction = self._Sum(self.shapes @ friction[..., None], scalar=True) / self.area
        self.contact, self.last = problem.contacts[number], None
        self.small = None if self.finite else self._Look(0 * self.faces.position)

    # --- sums over the points ------------------------------------------------------------------

    def _At(self, values):
        return np.einsum("qn,fnd->fqd", self.shapes, values)

    def _Normals(self, position):
        return self.faces.Normals(np.einsum("qrn,fnd->fqrd", self.slopes, position))

    def _Sum(self, values, scalar=False):
        """Integrals over the macro-elements of values at the points, (f, q) or (f, q, d)."""
        if values.ndim == 2 or scalar:
            sums = np.sum(self.weights * values.reshape(self.weights.shape), axis=1)
            return np.bincount(self.macro, sums)
        return np.stack([self._Sum(v) for v in np.moveaxis(values, -1, 0)], axis=-1)

    def _Look(self, displacement):
        """Normals at the points, what they meet, and which macro-elements have partners all over.

        The slave is displaced.
        """
        position = self.faces.position + displacement
        normals = Unit(self._Normals(position))
        if self.master is None:
            return normals, None, np.ones(len(self.area), dtype=bool)
        hits = self._Meet(position, self._At(position), normals)
        ends = self.faces.Corners()
        slopes = np.einsum("qrn,fnd->fqrd", self.faces.Slopes(ends), position)
        corners = np.einsum("qn,fnd->fqd", self.faces.Shapes(ends), position)
        met = self._Meet(position, corners, Unit(self.faces.Normals(slopes))).face >= 0
        misses = np.sum(~met.reshape(corners.shape[:2]), axis=1)
        return normals, hits, np.bincount(self.macro, misses) == 0

    def _Meet(self, position, points, normals):
        target = self.master.position + (self.master.Values(self.u) if self.finite else 0)
        slave, master = position.reshape(-1, self.dim), target.reshape(-1, self.dim)
        ahead = np.linalg.norm(np.ptp(np.concatenate([slave, master]), axis=0))
        behind = 0.1 * np.linalg.norm(np.ptp(slave, axis=0))
        return MeetFaces(
            points.reshape(-1, self.dim),
            normals.reshape(-1, self.dim),
            self.master,
            target,
            ahead=self.law.get("maxdist", ahead),
            behind=self.law.get("penetration", behind),
            cells=1 if self.unbent else BENT[self.dim],
        )

    def _Partner(self, values, hits):
        """Nodal values of the master at what the points meet, 0 without partner, and a mask."""
        met = hits.face >= 0
        result = np.zeros((len(met), self.dim))
        shapes = self.master.Shapes(hits.place[met])
        result[met] = np.einsum("pn,pnd->pd", shapes, values[hits.face[met]])
        return result.reshape(*self.weights.shape, self.dim), met.reshape(self.weights.shape)

    def _Jump(self, slave, master, hits):
        """Slave minus master at the points with a partner, and a mask of those."""
        if self.master is None:
            return self._At(slave), np.ones(self.weights.shape, dtype=bool)
        partner, met = self._Partner(master, hits)
        return (self._At(slave) - partner) * met[..., None], met

    # --- states --------------------------------------------------------------------------------

    def Now(self):
        """The present state."""
        u1 = self.faces.Values(self.u)
        u2 = self.master.Values(self.u) if self.master else None
        normals, hits, whole = self._Look(u1) if self.finite else self.small
        if self.master is None:
            distance = -self._At(self.faces.Values(self.obstacle)) * normals
        else:
            distance, _ = self._Jump(self.faces.position, self.master.position, hits)
        moved, met = self._Jump(u1, u2, hits)
        directions, even = normals, np.ones(len(self.area), dtype=bool)
        if self.master:  # turned by the same tilt all over a macro-element
            other = self._MasterNormals(u2 if self.finite else 0 * u2, hits)
            tilt = self.share * (normals + other) * met[..., None]
            tilt = self._Sum(tilt) / np.maximum(self._Sum(met.astype(float)), 1e-300)[:, None]
            directions = normals - tilt[self.macro][:, None]
            even = self._Spread(other, met) < 1e-9
        area = self._Sum(met.astype(float))
        mean = 1 / np.maximum(area, 1e-300)
        normal = self._Sum(directions * met[..., None])
        normal /= np.maximum(np.linalg.norm(normal, axis=1), 1e-300)[:, None]
        apart = mean[:, None] * self._Sum(distance + moved)
        gap = -np.sum(apart * normal, axis=1)
        if self.finite:
            gap = mean * self._Sum(hits.gap.reshape(met.shape) * met)
        jump = mean[:, None] * self._Sum(moved)
        slip = self._Slip(jump, u1, u2, normals)
        slip = slip - np.sum(slip * normal, axis=1)[:, None] * normal
        covered = area / self.area
        traction = self.faces.Values(self.lam)[np.unique(self.macro, return_index=True)[1], 0]
        way, step = np.linalg.norm(slip, axis=1), abs(self.load.Get() - self.loaded)
        before = np.zeros(len(way)) if self.last is None else self.last.memory
        pressure = -np.sum(traction * normal, axis=1)
        friction, memory, expected = self.friction, before, None
        if self.twin.friction:
            friction = self.twin.friction(pressure, way, step)
        if self.twin.offset:
            memory = self.twin.offset(pressure, way, before)
        if self.twin.traction:
            apart = jump if self.law.get("tied") else slip - gap[:, None] * normal
            expected, memory = self.twin.traction(normal, apart, before)
        self.loaded = self.load.Get()
        gap = gap + (memory if self.twin.offset else self.law.get("offset", 0.0))
        found = traction, normal, gap, slip, covered, whole, even, jump, directions, hits
        return State(*found, friction, memory, expected)

    def _Spread(self, values, met):
        """How far vectors at the points with a partner are from those at others."""
        far, near = (np.full((len(self.area), self.dim), sign * np.inf) for sign in (-1, 1))
        with_partner = met[..., None]
        np.maximum.at(far, self.macro, np.where(with_partner, values, -np.inf).max(axis=1))
        np.minimum.at(near, self.macro, np.where(with_partner, values, np.inf).min(axis=1))
        return np.max(far - near, axis=1)

    @property
    def share(self):
        """Of the other body in the stiffness of both."""
        return self.contact.form.History()["share"][0]

    def _MasterNormals(self, displacement, hits):
        """At what the points meet."""
        met = hits.face >= 0
        position = (self.master.position + displacement)[hits.face[met]]
        slopes = np.einsum("prn,pnd->prd", self.master.Slopes(hits.place[met]), position)
        result = np.zeros((len(met), self.dim))
        result[met] = Unit(self.master.Normals(slopes[:, None], hits.face[met]))[:, 0]
        return result.reshape(*self.weights.shape, self.dim)

    def _Slip(self, jump, u1, u2, normals):
        """How far apart the points have moved that faced each other in the last state."""
        if not self.finite:
            return jump - (0 if self.last is None else self.last.jump)
        if self.last is None:
            return 0 * jump
        apart, met = self._Jump(self.faces.position + u1, self.master.position + u2, self.last.hits)
        # The points that faced each other were not at one place.
        moved = apart + self.last.hits.gap.reshape(met.shape)[..., None] * normals
        other = self._MasterNormals(u2, self.last.hits)
        across = Unit((1 - self.share) * normals - self.share * other)
        moved -= np.sum(moved * across, axis=-1)[..., None] * across
        area = np.maximum(self._Sum(met.astype(float)), 1e-300)
        return self._Sum(moved * met[..., None]) / area[:, None]

    def Work(self, state, test):
        """Work of the tractions for a displacement."""
        slave = self.faces.Values(test)
        jump, _ = self._Jump(slave, self.master.Values(test) if self.master else None, state.hits)
        traction = state.traction[self.macro][:, None]
        if self.finite:  # pressure acts along the directions of the points
            pressure, shear = state.pressure[self.macro], state.shear[self.macro]
            traction = shear[:, None] - pressure[:, None, None] * state.directions
        return np.sum(self.weights * np.sum(traction * jump, axis=-1))

    def CutOff(self, state):
        """Force on the last cell of macro-elements that the other surface covers in part."""
        force = np.linalg.norm(state.traction, axis=1) * self.area
        return force[~state.whole].sum() / CELLS[self.dim]


def Unit(vectors):
    return vectors / np.linalg.norm(vectors, axis=-1)[..., None]


def Macros(faces, space):
    """The number of the macro-element of each face, as far as tractions tell."""
    marks = GridFunction(space)
    values = marks.vec.FV().NumPy()
    values[:] = np.arange(len(values))
    return np.unique(faces.Values(marks)[:, 0, 0], return_inverse=True)[1]
