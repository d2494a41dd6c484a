"""The meshes of the comparison: the same nodes and elements for every peer.

    python tests/benchmarks/peers/meshes.py sphere 0.6 sphere.npz

writes `sphere.npz`, which `Load` reads with nothing but NumPy, and beside it `sphere.vol` for
NGSolve. Second-order meshes have one more node per edge, on the curved surface where there is one.
The README beside it has the problems; "hertz" has its force at the node `load`, the others have a
pressure on the boundary "top".
"""

from __future__ import annotations

import argparse
from dataclasses import dataclass
from pathlib import Path

import numpy as np

__all__ = ["BODIES", "HELD", "SHIFT", "Load", "Make", "NodalValues", "PeerMesh"]

# Corners of an edge; the order of the mid nodes, as in VTK, Abaqus and CalculiX.
EDGES = {2: ((0, 1), (1, 2), (2, 0)), 3: ((0, 1), (1, 2), (2, 0), (0, 3), (1, 3), (2, 3))}
FACE_EDGES = {2: ((0, 1),), 3: ((0, 1), (1, 2), (2, 0))}

# Boundaries on which a component of the displacement is zero.
HELD = {"hertz": {"sym": 0, "bottom": 1}, "sphere": {"sym_x": 0, "sym_y": 1, "bottom": 2}}
HELD["patch"] = HELD["sphere"]
# The body of the slave, above, and that of the master.
BODIES = {"hertz": ("cylinder", "block"), "sphere": ("sphere", "block")}
BODIES["patch"] = ("upper", "lower")
# The upper body starts lower by this: contact is all that holds it.
SHIFT = {"hertz": 0.05, "sphere": 0.1, "patch": 1e-5}


@dataclass(frozen=True)
class PeerMesh:
    """Nodes, elements and boundary faces; order 1 is that of the corners alone."""

    problem: str  # of `HELD`
    h: float  # size of the slave faces
    nvertices: int  # the first nodes are corners, all others mid nodes
    points: np.ndarray  # (n, dim)
    # Triangles or tetrahedra of positive orientation: corners, mid nodes in the order of `EDGES`.
    elements: np.ndarray
    materials: np.ndarray  # of each element: a name of `BODIES`
    faces: (
        np.ndarray
    )  # edges or triangles, oriented outwards as netgen's (2D: the body on the left)
    # Of each face: "slave" and "master"; "bottom"; "top" where the load is; the symmetry planes
    # "sym" (hertz) or "sym_x" and "sym_y"; others are free.
    names: np.ndarray
    owners: np.ndarray  # the element of each face

    @property
    def dim(self):
        return self.points.shape[1]

    def Points(self, order):
        return self.points if order > 1 else self.points[: self.nvertices]

    def Elements(self, order, material=None):
        """Nodes of the elements, of one material if it is given."""
        chosen = slice(None) if material is None else self.materials == material
        return self.elements[chosen, : None if order > 1 else self.dim + 1]

    def Faces(self, order, name):
        return self.faces[self.names == name, : None if order > 1 else self.dim]

    def Nodes(self, order, name):
        return np.unique(self.Faces(order, name))

    def MaterialNodes(self, order, material):
        return np.unique(self.Elements(order, material))

    @property
    def load(self):
        """The corner that is highest up: where the force of "hertz" acts."""
        corners = self.points[: self.nvertices]
        return int(np.argmin(corners[:, 0] - corners[:, -1]))

    def Lowered(self, order):
        """Coordinates (n, dim) of the nodes with the upper body moved down by `SHIFT`."""
        points, (upper, _) = self.Points(order).copy(), BODIES[self.problem]
        points[self.MaterialNodes(order, upper), -1] -= SHIFT[self.problem]
        return points

    def Opposite(self, name):
        """The elements behind the faces of a boundary, and which of their corners lies opposite."""
        elements = self.owners[self.names == name]
        corners, faces = self.Elements(1)[elements], self.Faces(1, name)
        on_face = (corners[:, :, None] == faces[:, None, :]).any(axis=2)
        if not np.all(on_face.sum(axis=1) == self.dim):
            raise ValueError(f"faces of {name!r} do not belong to their elements")
        return elements, np.argmin(on_face, axis=1)


def Load(file):
    with np.load(file) as data:
        arrays = {name: data[name] for name in data.files}
    return PeerMesh(**{k: v.item() if v.ndim == 0 else v for k, v in arrays.items()})


def NetgenMesh(problem, h):
    """The NGSolve mesh: the LAC paper's half model; graded; tetrahedra that do not match."""
    from ngslac.meshes import HertzMesh, SphereOnBlock, TwoBlocks3D

    if problem == "hertz":
        return HertzMesh(h)
    if problem == "sphere":
        sizes = {"zone": 8.0, "width": 60.0, "height": 60.0, "ratio": 1.13}
        return SphereOnBlock(h, **sizes, grading=0.2, maxh=12.0)
    n = max(2, round(1 / h))
    mesh = TwoBlocks3D("tet", n_slave=n, n_master=max(1, round(n / 1.31)), unstructured=True)
    planes = {"left": "sym_x", "front": "sym_y", "right": "free", "back": "free"}
    for i, name in enumerate(mesh.GetBoundaries()):
        mesh.ngmesh.SetBCName(i, planes.get(name.split("_")[0], name))
    return mesh


def Make(problem, h, file):
    """A `PeerMesh` with slave faces of size h; the NGSolve mesh comes beside the .npz file."""
    mesh = NetgenMesh(problem, h)
    mesh.Curve(2)
    made = PeerMesh(problem, h, mesh.nv, **Topology(mesh))
    np.savez_compressed(file, **vars(made))
    mesh.ngmesh.Save(str(Path(file).with_suffix(".vol")))
    return made


def Topology(mesh):
    """All arrays of an NGSolve mesh of order 2."""
    from ngsolve import BND, VOL, x, y, z

    points, numbers = NodalValues(mesh, (x, y, z)[: mesh.dim]), EdgeNumbers(mesh)
    elements, faces = Vertices(mesh, VOL), Vertices(mesh, BND)
    wrong = np.linalg.det(points[elements[:, 1:]] - points[elements[:, :1]]) < 0
    elements[wrong, 1:3] = elements[wrong, 2:0:-1]
    return {
        "points": points,
        "elements": np.hstack([elements, MidNodes(elements, numbers, EDGES[mesh.dim])]),
        "materials": np.array([el.mat for el in mesh.Elements(VOL)]),
        "faces": np.hstack([faces, MidNodes(faces, numbers, FACE_EDGES[mesh.dim])]),
        "names": np.array([el.mat for el in mesh.Elements(BND)]),
        "owners": Owners(elements, faces),
    }


def Vertices(mesh, codimension):
    """Numbers of the corners of volume or boundary elements."""
    return np.array([[v.nr for v in el.vertices] for el in mesh.Elements(codimension)])


def EdgeNumbers(mesh):
    """The mid node between two corners (in ascending order)."""
    pairs = (sorted(v.nr for v in edge.vertices) for edge in mesh.edges)
    return {(a, b): mesh.nv + nr for nr, (a, b) in enumerate(pairs)}


def MidNodes(cells, numbers, edges):
    """Numbers of the mid nodes of `edges` (pairs of corners) of each cell."""
    pairs = np.sort(np.stack([cells[:, list(edge)] for edge in edges], axis=1), axis=-1)
    return np.array([[numbers[a, b] for a, b in cell] for cell in pairs.tolist()])


def NodalValues(mesh, components):
    """Values (n, k) of coefficient functions at the nodes of a curved NGSolve mesh: all corners,
    then the middle of each edge in the order of the mesh's edges.
    """
    from ngsolve import ET, VOL, IntegrationRule

    dim = mesh.dim
    reference = np.vstack([np.eye(dim), np.zeros(dim)])  # NGSolve's corners
    nodes = np.vstack([reference, reference[np.array(EDGES[dim])].mean(axis=1)])
    rule = IntegrationRule([tuple(node) for node in nodes], [1.0] * len(nodes))
    at = mesh.MapToAllElements({ET.TRIG if dim == 2 else ET.TET: rule}, VOL)
    elements = Vertices(mesh, VOL)
    numbers = np.hstack([elements, MidNodes(elements, EdgeNumbers(mesh), EDGES[dim])]).ravel()
    values = np.empty((mesh.nv + mesh.nedge, len(components)))
    for column, component in zip(values.T, components, strict=True):
        column[numbers] = component(at).ravel()
    return values


def Owners(elements, faces):
    """The element of each face."""
    owner = {}
    for opposite in range(elements.shape[1]):
        sides = np.sort(np.delete(elements, opposite, axis=1)).tolist()
        owner |= {tuple(side): i for i, side in enumerate(sides)}
    return np.array([owner[tuple(face)] for face in np.sort(faces).tolist()])


def main(argv=None):
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("problem", choices=HELD)
    parser.add_argument("h", type=float, help="size of the slave faces")
    parser.add_argument("file", help="name of the .npz file")
    options = parser.parse_args(argv)
    mesh = Make(options.problem, options.h, options.file)
    names, counts = np.unique(mesh.names, return_counts=True)
    print(f"{len(mesh.elements)} elements, {mesh.nvertices} corners, {len(mesh.points)} nodes")
    print(", ".join(f"{count} {name}" for name, count in zip(names, counts, strict=True)))


if __name__ == "__main__":
    main()
