"""Where normals of one surface meet another one: brute force, every ray with every face."""

from dataclasses import dataclass

import numpy as np
from ngsolve.fem import QUAD
from verify_faces import Cells

LOOKS_BACK = -0.17  # largest cosine between the normals of partners
CHUNK = 2_000_000  # pairs of ray and simplex at a time
ROUNDING = 1e-9


@dataclass
class Hits:
    """For each ray the face it meets (-1: none), the place on that face and the distance."""

    face: np.ndarray
    place: np.ndarray
    gap: np.ndarray


def MeetFaces(origin, normal, faces, position, *, ahead, behind, cells=1):
    """The nearest point of the faces, at nodal positions, on each ray along a unit normal (n, d).

    A face that bends is divided into `cells` in each direction.
    """
    places = Simplices(faces.kind, cells)
    shapes = faces.Shapes(places.reshape(-1, places.shape[-1]))
    corners = np.einsum("qn,fnd->fqd", shapes, position)
    simplices = Flat(corners.reshape(-1, faces.dim, faces.dim), faces.sign.repeat(len(places)))
    n = len(origin)
    hits = Hits(np.full(n, -1), np.zeros((n, faces.dim - 1)), np.zeros(n))
    step = max(1, CHUNK // len(places) // len(position))
    for first in range(0, n, step):
        part = slice(first, first + step)
        best, gap, weights = simplices.Meet(origin[part], normal[part], ahead, behind)
        hits.face[part] = np.where(np.isfinite(gap), best // len(places), -1)
        hits.gap[part] = np.where(np.isfinite(gap), gap, 0)
        hits.place[part] = np.einsum("rc,rck->rk", weights, places[best % len(places)])
    if cells > 1:
        Polish(hits, origin, normal, faces, position)
    return hits


def Simplices(kind, cells):
    """Corners (simplices, corners, dim) of segments or triangles that fill the reference face."""
    corners = Cells(kind, cells)
    if kind == QUAD:
        corners = np.concatenate([corners[:, [0, 1, 2]], corners[:, [0, 2, 3]]])
    return corners


class Flat:
    """Segments or triangles (n, d, d) in space, with the signs of their outward normals."""

    def __init__(self, corners, sign):
        self.first = corners[:, 0]
        edges = corners[:, 1:] - corners[:, :1]
        if corners.shape[-1] == 2:
            outward = np.stack([edges[:, 0, 1], -edges[:, 0, 0]], axis=1)
        else:
            outward = np.cross(edges[:, 0], edges[:, 1])
        self.outward = sign[:, None] * outward / np.linalg.norm(outward, axis=1)[:, None]
        # The dual vectors turn a point into its weights of the other corners.
        self.dual = np.linalg.pinv(edges).transpose(0, 2, 1)

    def Meet(self, origin, normal, ahead, behind):
        """Number, distance (inf if none) and weights of the nearest one on each ray."""
        facing = normal @ self.outward.T
        depth = np.sum(self.first * self.outward, axis=1) - origin @ self.outward.T
        with np.errstate(divide="ignore", invalid="ignore"):
            gap = depth / facing
        gap = np.where((facing <= LOOKS_BACK) & (gap <= ahead) & (gap >= -behind), gap, np.inf)
        rest = np.ones(gap.shape)
        for k in range(self.dual.shape[1]):
            dual = self.dual[:, k]
            start = origin @ dual.T - np.sum(self.first * dual, axis=1)
            weight = start + np.where(np.isfinite(gap), gap, 0) * (normal @ dual.T)
            rest -= weight
            gap[weight < -ROUNDING] = np.inf
        gap[rest < -ROUNDING] = np.inf
        best, rows = np.argmin(np.abs(gap), axis=1), np.arange(len(gap))
        gap = gap[rows, best]
        point = origin + np.where(np.isfinite(gap), gap, 0)[:, None] * normal - self.first[best]
        weights = np.einsum("rkd,rd->rk", self.dual[best], point)
        return best, gap, np.concatenate([1 - weights.sum(axis=1)[:, None], weights], axis=1)


def Polish(hits, origin, normal, faces, position):
    """Newton's method for the point of the bent face on the ray."""
    met = hits.face >= 0
    nodes, x, n = position[hits.face[met]], origin[met], normal[met]
    place, gap = hits.place[met], hits.gap[met]
    for _ in range(4):
        y = np.einsum("pn,pnd->pd", faces.Shapes(place), nodes)
        slopes = np.einsum("prn,pnd->prd", faces.Slopes(place), nodes)
        matrix = np.concatenate([slopes, -n[:, None]], axis=1).transpose(0, 2, 1)
        miss = x + gap[:, None] * n - y
        move = np.linalg.solve(matrix, miss[..., None])[..., 0]
        place = np.clip(place + move[:, :-1], 0, 1)
        gap = gap + move[:, -1]
    hits.place[met], hits.gap[met] = place, gap
