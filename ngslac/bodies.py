"""Bodies and the rigid motions that nothing prevents."""

import numpy as np
from ngsolve import VOL, CoefficientFunction, GridFunction, x, y, z
from scipy.linalg import qr
from scipy.sparse import bsr_matrix, csr_matrix, vstack
from scipy.sparse.csgraph import connected_components

from ngslac._ngslac import Side
from ngslac.linear import AsBits

__all__ = ["Bodies", "CloseNearest", "FloatingMessage"]

TOLERANCE = 1e-8


class Bodies:
    """The connected parts of the bulk matrix with their free rigid motions.

    Parameters
    ----------
    mat : BaseMatrix
        Assembled bulk matrix on the product space.
    contact : LACContact
        Any contact on the space: tells the displacement.
    free : (n,) bool
        Free scalar dofs.
    """

    def __init__(self, mat, contact, free):
        form = contact.form
        space, block = form.component, form.fes.dim
        first, count = form.offset * block, space.ndof * block
        bulk = ToCSR(mat)[first : first + count, first : first + count]
        self.first, self.ntotal = first, len(free)
        self.motions, self.names = self._RigidMotions(space)
        used = bulk.diagonal() != 0
        _, part = connected_components(bulk, directed=False)
        self.modes = []  # (material, displacement of all scalar dofs, description)
        for index in np.unique(part[used]):
            dofs = np.flatnonzero(part == index)
            for combination in self._FreeMotions(bulk, dofs, free[first : first + count]):
                mode = np.zeros(self.ntotal)
                mode[first + dofs] = self.motions[dofs] @ combination
                self.modes.append((self._Material(space, dofs, block), mode, combination))

    def _RigidMotions(self, space):
        mesh = space.mesh
        vertices = np.array([v.point for v in mesh.vertices])
        center, size = vertices.mean(axis=0), np.ptp(vertices, axis=0).max()
        r = [(c - c0) / size for c, c0 in zip((x, y, z), center, strict=False)]
        if mesh.dim == 2:
            fields = [(1, 0), (0, 1), (-r[1], r[0])]
            names = ["translation in x", "translation in y", "rotation"]
        else:
            fields = [(1, 0, 0), (0, 1, 0), (0, 0, 1)]
            fields += [(0, -r[2], r[1]), (r[2], 0, -r[0]), (-r[1], r[0], 0)]
            names = [f"translation in {c}" for c in "xyz"] + [f"rotation about {c}" for c in "xyz"]
        gf = GridFunction(space)
        columns = []
        for field in fields:
            gf.Set(CoefficientFunction(field), VOL)
            columns.append(gf.vec.FV().NumPy().copy())
        return np.stack(columns, axis=1), names

    def _FreeMotions(self, bulk, dofs, free):
        motions = self.motions[dofs]
        allowed = NullSpace(motions[~free[dofs]])
        if not allowed.shape[1]:
            return []
        block = bulk[dofs][:, dofs]
        moved = block @ (motions @ allowed)
        scale = np.abs(block.diagonal()).max() * np.linalg.norm(motions, 2)
        return (allowed @ NullSpace(moved / scale)).T

    @staticmethod
    def _Material(space, dofs, block):
        mesh = space.mesh
        inside = np.zeros(space.ndof, dtype=bool)
        inside[np.unique(dofs // block)] = True
        for name in dict.fromkeys(mesh.GetMaterials()):
            bits = np.fromiter(space.GetDofs(mesh.Materials(name)), dtype=bool, count=space.ndof)
            if np.any(inside & bits):
                return name
        return "?"

    def Floating(self, contacts):
        """Descriptions of the free rigid motions that the active contacts do not prevent."""
        if not self.modes:
            return []
        modes = np.stack([mode for _, mode, _ in self.modes], axis=1)
        rows = [ActiveRows(contact) @ modes for contact in contacts]
        left = NullSpace(np.concatenate(rows))
        # Any basis is as good as another: name the motions that a pivoted elimination finds.
        bodies = list(dict.fromkeys(body for body, _, _ in self.modes))
        coordinates = np.zeros((len(bodies), len(self.names), len(self.modes)))
        for i, (body, _, motion) in enumerate(self.modes):
            coordinates[bodies.index(body), :, i] = motion
        *_, pivots = qr((coordinates.reshape(-1, len(self.modes)) @ left).T, pivoting=True)
        return [
            f"body '{bodies[k // len(self.names)]}' floats ({self.names[k % len(self.names)]})"
            for k in sorted(pivots[: left.shape[1]])
        ]


def CloseNearest(contacts, gf, floating):
    """Close macro-elements, the nearest first, until no body floats; False if that does not help.

    Farther contacts are left alone where the nearest ones hold all bodies.
    """
    for count in range(len(contacts)):
        for distance in (0.05, 0.1, 0.2, 0.4, 0.8):
            for contact in sorted(contacts, key=SmallestGap)[: count + 1]:
                # Without friction the tilted normals of distant macro-elements would only hide a
                # motion that is free.
                reach = distance if contact.holds_tangentially else 0.05
                contact.form.Close(NearestMacros(contact, reach), gf.vec)
                contact.Evaluate(gf)
            if not floating():
                return True
    return False


def SmallestGap(contact):
    """Relative to the mean size of the macro-elements."""
    table = contact.Table()
    size = (table["fullarea"] ** (1 / (contact.mesh.dim - 1))).mean()
    return abs(table["gap"][table["area"] > 0]).min(initial=np.inf) / size


def NearestMacros(contact, distance):
    """Macro-elements whose gap exceeds the smallest one by at most `distance` times their size."""
    table = contact.Table()
    paired = table["area"] > 0
    size = table["fullarea"] ** (1 / (contact.mesh.dim - 1))
    nearest = table["gap"][paired].min(initial=np.inf)
    return AsBits(paired & (table["gap"] <= nearest + distance * size))


def FloatingMessage(floating):
    return (
        "; ".join(floating)
        + ": no Dirichlet condition and no active contact holds it. Constrain it, start in "
        "contact, or prescribe a displacement in place of a force"
    )


def ToCSR(mat):
    """A sparse NGSolve matrix with scalar or square block entries as scipy matrix."""
    block = mat.entrysizes[0]
    # CSR() shows memory of the matrix: copy, the matrix may be a temporary.
    values, columns, starts = (np.array(a) for a in mat.CSR())
    if block == 1:
        return csr_matrix((values, columns, starts), shape=mat.shape)
    return bsr_matrix((values.reshape(-1, block, block), columns, starts)).tocsr()


def ActiveRows(contact):
    """The constraints at work, as a scipy matrix on all scalar dofs, scaled by the areas."""
    table, form = contact.Table(), contact.form
    d = contact.mesh.dim
    jump = ToCSR(form.JumpMatrix(Side.both))
    stick = jump[np.repeat(table["status"] == 1, d)]  # holds every direction
    slip = np.flatnonzero(table["status"] == 2)
    normals = csr_matrix(
        (
            table["normal"][slip].ravel(),
            (np.arange(len(slip)).repeat(d), (d * slip[:, None] + np.arange(d)).ravel()),
        ),
        shape=(len(slip), jump.shape[0]),
    )
    rows = vstack([stick, normals @ jump]).tocsr()
    columns = rows.indices + form.offset * form.fes.dim
    shape = rows.shape[0], contact.nscalars
    return csr_matrix((rows.data / table["fullarea"].mean(), columns, rows.indptr), shape=shape)


def NullSpace(matrix):
    """Orthonormal basis of the null space, relative to the size of the matrix."""
    if not matrix.shape[0]:
        return np.eye(matrix.shape[1])
    wide = matrix.shape[0] < matrix.shape[1]
    _, singular, vectors = np.linalg.svd(matrix, full_matrices=wide)
    rank = int(np.sum(singular > TOLERANCE * max(1.0, singular.max(initial=0.0))))
    return vectors[rank:].T
