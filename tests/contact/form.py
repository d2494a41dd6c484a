"""A contact form in a state, far from the reference with finite sliding: its derivative."""

import numpy as np
import scipy.sparse
from blocks import C, macro_dofs, residual
from bricks import brick
from ngsolve import CF, GridFunction, VectorH1, cos, sin, x, y, z

from ngslac import LACContact, LACSpace, tools
from ngslac.meshes.geometry import RotationMatrix

POSITIONS = (x, y, z)


def rotation(dim, degrees, axis=(1.0, -2.0, 0.5)):
    """Matrix (dim, dim) of a rotation; in 3D about `axis`."""
    return RotationMatrix(("z" if dim == 2 else axis, degrees))[:dim, :dim]


class Form:
    """A paired contact with a fixed scale, and the state in which it is looked at."""

    def __init__(self, contact):
        self.contact = contact
        self.dim = contact.mesh.dim
        self.gf = GridFunction(contact.form.fes)
        self.u = self.gf.components[-2]
        self.values = self.gf.vec.FV().NumPy()
        self.multipliers = macro_dofs(contact)

    def table(self):
        self.contact.Evaluate(self.gf)
        return self.contact.Table()

    def body(self, upper, lower):
        return self.contact.mesh.MaterialCF({"upper": upper, "lower": lower})

    def place(self, places, degrees=0.0):
        """Every body at its `places`, then both turned; returns the rotation."""
        turn = rotation(self.dim, degrees)
        turned = CF(tuple(turn.ravel()), dims=turn.shape) * CF(tuple(places))
        self.u.Set(turned - CF(POSITIONS[: self.dim]))
        return turn

    def lead(self, way, degrees=0.0, shares=(1.0, 0.0)):
        """Bodies without strain, moved by their shares of the way, and paired there."""
        turn = self.place(CF(POSITIONS[: self.dim]) + self.body(*shares) * CF(tuple(way)), degrees)
        self.follow()
        return turn

    def bend(self, size, shift=0.0, degrees=0.0, noise=0.0, seed=0):
        """Both blocks bent by `size`, the upper one shifted along the interface, all rotated.

        `noise` is added to every scalar dof, those of higher order too.
        """
        r, upper = POSITIONS[: self.dim], self.body(1.0, 0.0)
        waves = [size * sin(2 * r[(i + 1) % self.dim] + 0.7 * i + upper) for i in range(self.dim)]
        waves[0] += shift * upper + 0.2 * size * cos(3 * r[-1])
        self.place([a + b for a, b in zip(r, waves, strict=True)], degrees)
        self.values[:] += noise * np.random.default_rng(seed).normal(size=len(self.values))

    def follow(self):
        self.contact.Follow(self.gf)

    def commit(self):
        """Slip counts from here."""
        self.follow()
        self.contact.Commit(self.gf)

    def impose(self, bound, seed=0):
        """Tractions that make the macro-elements open, stick and slip in turn.

        `bound` of the tangential traction over the normal one, which is about 1.
        """
        random = np.random.default_rng(seed)
        self.values[self.multipliers] = 0.0
        table = self.table()
        normal, turn = table["normal"], 0
        for m, dofs in enumerate(self.multipliers):
            n = normal[m]
            if table["area"][m] == 0:  # is open whatever its traction
                self.values[dofs] = random.normal(size=self.dim)
                continue
            tangent = random.normal(size=self.dim)
            tangent -= n * (n @ tangent)
            tangent /= np.linalg.norm(tangent)
            part = [0.0, 0.4, 2.5][turn % 3]
            trial = 0.6 * n + tangent if turn % 3 == 0 else -n + part * bound * tangent
            self.values[dofs] = trial + C * (table["slip"][m] - table["gap"][m] * n)
            turn += 1

    def repaired_residual(self, state, area):
        """With the points of this state; the multipliers' rows divided by its areas, times `area`.

        These rows vanish at a solution: the Newton matrix leaves their area as it is.
        """
        kept = self.values.copy()
        self.values[:] = state
        self.follow()
        rows, now = residual(self.contact, state), self.contact.Table()["area"]
        rows[self.multipliers[now > 0]] *= (area / np.where(now > 0, now, 1))[now > 0, None]
        self.values[:] = kept
        return rows

    def matrix(self, of_newton=False):
        """Derivative with fixed points, or that of the solver, which sees the rim move."""
        if of_newton:
            self.contact.form.BeginSolve()
            self.contact.form.AssembleStep(self.gf.vec, self.gf.vec.CreateVector())
        else:
            self.contact.AssembleLinearization(self.gf.vec)
        rows, columns, values = (np.array(a) for a in self.contact.mat.COO())
        return scipy.sparse.csc_matrix((values, (rows, columns)), shape=2 * (len(self.values),))

    def derivative_error(self, columns, *, repaired=False, eps=1e-6):
        """Largest deviation of the matrix from central differences, over its largest entry.

        Of the columns that are not empty `columns` are looked at, and some empty ones, and the
        whole along two random directions. `repaired`: points of each state, matrix of the solver.
        """
        exact, state, contact = self.matrix(repaired), self.values.copy(), self.contact
        area = contact.Table()["area"].copy()

        def R(state):
            return self.repaired_residual(state, area) if repaired else residual(contact, state)

        random = np.random.default_rng(0)
        used = np.flatnonzero(np.diff(exact.indptr))
        empty = np.setdiff1d(np.arange(len(state)), used)
        chosen = [random.permutation(used)[:columns], random.permutation(empty)[: columns // 10]]
        directions = [np.eye(1, len(state), k)[0] for k in np.concatenate(chosen)]
        directions += [random.normal(size=len(state)) / 3 for _ in range(2)]
        differences = [(R(state + eps * d) - R(state - eps * d)) / (2 * eps) for d in directions]
        deviations = [found - exact @ d for found, d in zip(differences, directions, strict=True)]
        return np.abs(deviations).max() / np.abs(exact).max()


def on_a_sphere(dim, **law):
    """A brick that has bent since its last step, on a rigid sphere; `law` is of LACContact."""
    V = VectorH1(brick("trig" if dim == 2 else "tet", 5 - dim), order=2)
    u, lam = (V * LACSpace(V, slave="bottom")).TrialFunction()
    tool = tools.Sphere((0.4, 0.45, -0.68)[3 - dim :], 0.7)
    contact = LACContact(u, lam, obstacle=tool, finite=True, **law)
    contact.Update()
    contact.form.SetConstant(C)
    form = Form(contact)
    form.commit()
    form.u.Set(CF((0.03 * sin(3 * x), 0.05 * x * x - 0.02, 0.04 * x * y)[:dim]))
    form.follow()
    return form
