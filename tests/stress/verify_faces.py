"""Boundary faces as polynomials through nodes: what independent checks know of the geometry."""

import ngsolve as ngs
import numpy as np
from ngsolve.fem import QUAD, SEGM, TRIG

POSITION = {2: (ngs.x, ngs.y), 3: (ngs.x, ngs.y, ngs.z)}


def Powers(kind, degree):
    """Exponents of the monomials that span the polynomials of a face."""
    if kind == SEGM:
        return np.arange(degree + 1)[:, None]
    pairs = np.array([*np.ndindex(degree + 1, degree + 1)])
    return pairs[pairs.sum(axis=1) <= degree] if kind == TRIG else pairs


def Cells(kind, n):
    """Corners (cells, corners, dim) of n, or n * n, cells of the reference face."""
    k = np.arange(n) / n
    if kind == SEGM:
        return np.stack([k, k + 1 / n], axis=1)[..., None]
    a = np.array([*np.ndindex(n, n)])[:, None] / n
    if kind == QUAD:
        return a + np.array([(0, 0), (1, 0), (1, 1), (0, 1)]) / n
    lower = a[a.sum(axis=(1, 2)) < 1 - 0.5 / n] + np.array([(0, 0), (1, 0), (0, 1)]) / n
    upper = a[a.sum(axis=(1, 2)) < 1 - 1.5 / n] + np.array([(1, 0), (1, 1), (0, 1)]) / n
    return np.concatenate([lower, upper])


def Rule(kind, n):
    """Points and weights of a composite rule, exact for linear functions on each cell."""
    cells = Cells(kind, n)
    if kind == TRIG:
        return cells.mean(axis=1), np.full(len(cells), 0.5 / len(cells))
    low, dim = cells.min(axis=1), cells.shape[-1]
    gauss = 0.5 + np.array([-0.5, 0.5]) / np.sqrt(3)
    inner = np.stack(np.meshgrid(*[gauss] * dim), axis=-1).reshape(-1, dim)
    points = (low[:, None] + inner / n).reshape(-1, dim)
    return points, np.full(len(points), 1 / len(points))


class Faces:
    """The faces of a boundary region, all of one kind; fields are arrays of values at nodes.

    Geometry and displacement have the polynomial `degree` on a face.
    """

    def __init__(self, mesh, region, degree):
        self.dim, boundary = mesh.dim, mesh.Boundaries(region)
        (self.kind,) = {element.type for element in boundary.Elements()}
        self.powers = Powers(self.kind, degree)
        nodes = self.powers / degree
        rule = ngs.IntegrationRule([tuple(node) for node in nodes], [1.0] * len(nodes))
        self.points = mesh.MapToAllElements({self.kind: rule}, boundary)
        self.inverse = np.linalg.inv(Monomials(nodes, self.powers))
        self.position = self.Values(ngs.CF(POSITION[self.dim]))
        self.sign = self._Outwards(mesh)

    def Values(self, function):
        """Nodal values (faces, nodes, components) of a CoefficientFunction."""
        values = np.asarray(function(self.points), dtype=float)
        return values.reshape(-1, len(self.powers), max(1, function.dim))

    def Corners(self):
        """Reference points of the corners."""
        return np.unique(Cells(self.kind, 1).reshape(-1, self.powers.shape[1]), axis=0)

    def Shapes(self, points):
        """Matrix (points, nodes) that interpolates."""
        return Monomials(points, self.powers) @ self.inverse

    def Slopes(self, points):
        """The same for the derivatives: (points, reference directions, nodes)."""
        columns = []
        for direction in range(self.powers.shape[1]):
            lowered = self.powers.copy()
            lowered[:, direction] = np.maximum(lowered[:, direction] - 1, 0)
            columns.append(Monomials(points, lowered) * self.powers[:, direction])
        return np.stack(columns, axis=1) @ self.inverse

    def Normals(self, tangents, faces=slice(None)):
        """Outward normals, as long as the area stretch, of tangents (face, ..., direction, dim)."""
        sign = self.sign[faces].reshape(-1, *[1] * (tangents.ndim - 2))
        if self.dim == 2:
            along = tangents[..., 0, :]
            return sign * np.stack([along[..., 1], -along[..., 0]], axis=-1)
        return sign * np.cross(tangents[..., 0, :], tangents[..., 1, :])

    def _Outwards(self, mesh):
        """Which sign turns the normals of the faces out of their body.

        Integrals of the gradients of hat functions are means of the outward normals.
        """
        space = ngs.VectorH1(mesh, order=1)
        outwards = ngs.GridFunction(space)
        divergence = ngs.Trace(ngs.Grad(space.TestFunction()))
        outwards.vec.data = ngs.LinearForm(divergence * ngs.dx).Assemble().vec
        self.sign = np.ones(len(self.position))
        middle = np.full((1, self.powers.shape[1]), 1 / 3)
        normal = self.Normals(np.einsum("qrn,fnd->fqrd", self.Slopes(middle), self.position))
        mean = np.einsum("qn,fnd->fqd", self.Shapes(middle), self.Values(outwards))
        return np.where(np.sum(normal * mean, axis=(1, 2)) > 0, 1.0, -1.0)


def Monomials(points, powers):
    points = np.asarray(points, dtype=float)
    return np.prod(points[..., None, :] ** powers, axis=-1)
