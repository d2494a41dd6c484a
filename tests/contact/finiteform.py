"""Contact forms of finite sliding between two small blocks, far from the reference."""

import numpy as np
import scipy.sparse
from ngsolve import CF, GridFunction, cos, sin, x, y, z

C = 3.0  # the scale of the complementarity functions
POSITIONS = (x, y, z)


class FiniteForm:
    """A paired contact with a fixed scale, and the state in which it is looked at.

    Parameters
    ----------
    contact : LACContact
        With ``finite=True``.
    displacement : int
        Number of the displacement in the product space, from the end.
    """

    def __init__(self, contact, displacement=-2):
        self.contact = contact
        self.dim = contact.mesh.dim
        self.gf = GridFunction(contact.form.fes)
        self.u = self.gf.components[displacement]
        self.x, self.y = self.gf.vec.CreateVector(), self.gf.vec.CreateVector()
        contact.Update()
        contact.form.SetConstant(C)
        self.multipliers = contact.form.MultiplierDofs().reshape(-1, self.dim)

    @property
    def values(self):
        return self.gf.vec.FV().NumPy()

    def table(self):
        self.contact.Evaluate(self.gf)
        return self.contact.Table()

    def bend(self, size, shift=0.0, degrees=0.0, noise=0.0, seed=0):
        """Both blocks bent by `size`, the upper one shifted along the interface, all rotated.

        `noise` is added to every scalar dof, those of higher order too.
        """
        r = POSITIONS[: self.dim]
        upper = CF(self.contact.mesh.MaterialCF({"upper": 1.0, "lower": 0.0}))
        waves = [size * sin(2 * r[(i + 1) % self.dim] + 0.7 * i + upper) for i in range(self.dim)]
        waves[0] += shift * upper + 0.2 * size * cos(3 * r[-1])
        displaced = CF(tuple(r[i] + waves[i] for i in range(self.dim)))
        turn = rotation(self.dim, degrees)
        turned = CF(tuple(turn.ravel()), dims=(self.dim, self.dim)) * displaced
        self.u.Set(turned - CF(tuple(r)))
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

    def residual(self, state):
        self.x.FV().NumPy()[:] = state
        self.contact.Apply(self.x, self.y)
        return self.y.FV().NumPy().copy()

    def repaired_residual(self, state, area):
        """With the points of this state; the multipliers' rows divided by its areas, times `area`.

        These rows vanish at a solution: the Newton matrix leaves their area as it is.
        """
        kept = self.values.copy()
        self.values[:] = state
        self.follow()
        residual, now = self.residual(state), self.contact.Table()["area"]
        residual[self.multipliers[now > 0]] *= (area / np.where(now > 0, now, 1))[now > 0, None]
        self.values[:] = kept
        return residual

    def matrix(self, of_newton=False):
        """Derivative with fixed points, or that of the solver, which sees the rim move."""
        self.x.FV().NumPy()[:] = self.values
        if of_newton:
            self.contact.form.BeginSolve()
            self.contact.form.AssembleStep(self.x, self.y)
        else:
            self.contact.AssembleLinearization(self.x)
        rows, columns, values = (np.array(a) for a in self.contact.mat.COO())
        n = len(self.values)
        return scipy.sparse.csc_matrix((values, (rows, columns)), shape=(n, n))

    def derivative_error(self, columns=80, *, repaired=False, seed=0, eps=1e-6):
        """Largest deviation of the matrix from central differences, over its largest entry.

        Of the columns that are not empty `columns` are looked at, and some empty ones, and the
        whole along two random directions. `repaired`: points of each state, matrix of the solver.
        """
        exact, state = self.matrix(repaired), self.values.copy()
        area = self.contact.Table()["area"].copy()
        R = (lambda s: self.repaired_residual(s, area)) if repaired else self.residual
        random = np.random.default_rng(seed)
        used = np.flatnonzero(np.diff(exact.indptr))
        empty = np.setdiff1d(np.arange(len(state)), used)
        chosen = [random.permutation(used)[:columns], random.permutation(empty)[: columns // 10]]
        directions = [np.eye(1, len(state), k)[0] for k in np.concatenate(chosen)]
        directions += [random.normal(size=len(state)) / 3 for _ in range(2)]
        worst = 0.0
        for d in directions:
            found = (R(state + eps * d) - R(state - eps * d)) / (2 * eps)
            worst = max(worst, np.abs(found - exact @ d).max())
        return worst / np.abs(exact).max()


def rotation(dim, degrees, axis=(1.0, -2.0, 0.5)):
    """Matrix (dim, dim) of a rotation; in 3D about `axis`."""
    a = np.radians(degrees)
    if dim == 2:
        return np.array([[np.cos(a), -np.sin(a)], [np.sin(a), np.cos(a)]])
    k = np.array(axis) / np.linalg.norm(axis)
    cross = np.array([[0, -k[2], k[1]], [k[2], 0, -k[0]], [-k[1], k[0], 0]])
    return np.eye(3) + np.sin(a) * cross + (1 - np.cos(a)) * cross @ cross
