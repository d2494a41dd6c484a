"""The meshes of the comparison: the same nodes and elements for every peer.

    python tests/benchmarks/peers/meshes.py sphere 0.6 sphere.npz

writes `sphere.npz`, which `Load` reads with nothing but NumPy, and beside it `sphere.vol` for
NGSolve. Second-order meshes have one more node per edge, on the curved surface where there is one:
the nodes of NGSolve's own isoparametric elements. Problems, in mm and MPa:

hertz
    Half a cylinder of radius 50 on a block, 2D, plane strain. A force at node `load`.
sphere
    A quarter of half a sphere of radius 50 on a block, a pressure on `top`.
patch
    Two unit cubes on each other, the upper one meshed finer, a pressure on `top`.
"""

from __future__ import annotations

import argparse
from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np

__all__ = ["HELD", "PROBLEMS", "Load", "Make", "NodalValues", "PeerMesh"]

# Corners of an edge; the order of the mid nodes, as in VTK, Abaqus and CalculiX.
EDGES = {2: ((0, 1), (1, 2), (2, 0)), 3: ((0, 1), (1, 2), (2, 0), (0, 3), (1, 3), (2, 3))}
FACE_EDGES = {2: ((0, 1),), 3: ((0, 1), (1, 2), (2, 0))}

# Boundaries on which a component of the displacement is zero.
_HELD3D = {"sym_x": 0, "sym_y": 1, "bottom": 2}
HELD = {"hertz": {"sym": 0, "bottom": 1}, "sphere": _HELD3D, "patch": _HELD3D}


@dataclass(frozen=True)
class PeerMesh:
    """Nodes, elements and boundary faces.

    Parameters
    ----------
    problem : {"hertz", "sphere", "patch"}
    h : float
        Size of the slave faces.
    nvertices : int
        The first `nvertices` nodes are corners, all others mid nodes.
    points : (n, dim) array
    elements : (m, 6 or 10) int array
        Triangles or tetrahedra of positive orientation: corners, then mid nodes in the order of
        `EDGES`.
    materials : (m,) array of str
        "cylinder" or "sphere" and "block"; "upper" and "lower".
    faces : (k, 3 or 6) int array
        Boundary edges or triangles that are oriented outwards (2D: the body on the left).
    names : (k,) array of str
        "slave" and "master"; "bottom"; "top" where the load is; "sym" (hertz) or "sym_x" and
        "sym_y", the symmetry planes; others are free.
    owners : (k,) int array
        The element of each boundary face.
    """

    problem: str
    h: float
    nvertices: int
    points: np.ndarray
    elements: np.ndarray
    materials: np.ndarray
    faces: np.ndarray
    names: np.ndarray
    owners: np.ndarray

    @property
    def dim(self):
        """2 or 3."""
        return self.points.shape[1]

    def Points(self, order):
        """Coordinates of the nodes: of the corners for order 1."""
        return self.points if order > 1 else self.points[: self.nvertices]

    def Elements(self, order, material=None):
        """Nodes of the elements, of one material if it is given."""
        chosen = slice(None) if material is None else self.materials == material
        return self.elements[chosen, : None if order > 1 else self.dim + 1]

    def Faces(self, order, name):
        """Nodes of the faces of a boundary."""
        return self.faces[self.names == name, : None if order > 1 else self.dim]

    def Nodes(self, order, name):
        """Numbers of the nodes on a boundary, sorted."""
        return np.unique(self.Faces(order, name))

    def MaterialNodes(self, order, material):
        """Numbers of the nodes of a body, sorted."""
        return np.unique(self.Elements(order, material))

    @property
    def load(self):
        """The corner that is highest up: where the force of "hertz" acts."""
        corners = self.points[: self.nvertices]
        return int(np.argmin(corners[:, 0] - corners[:, -1]))

    def Save(self, file):
        """Write all to an .npz file."""
        np.savez_compressed(file, **asdict(self))


def Load(file):
    """Read a `PeerMesh`."""
    with np.load(file) as data:
        arrays = {name: data[name] for name in data.files}
    return PeerMesh(**{k: v.item() if v.ndim == 0 else v for k, v in arrays.items()})


# ---------------------------------------------------------------- the three meshes


def Hertz(h):
    """The LAC paper's problem: a cylinder on a block, half model; NGSolve mesh."""
    from ngslac.meshes import HertzMesh

    return HertzMesh(h)


def Sphere(h):
    """Quarter of half a sphere on a block, graded; NGSolve mesh."""
    from ngslac.meshes import SphereOnBlock

    sizes = {"zone": 8.0, "width": 60.0, "height": 60.0, "ratio": 1.13}
    return SphereOnBlock(h, **sizes, grading=0.2, maxh=12.0)


def Patch(h):
    """Two cubes whose tetrahedra do not match, the lower ones larger by 1.31; NGSolve mesh."""
    from ngslac.meshes import TwoBlocks3D

    n = max(2, round(1 / h))
    mesh = TwoBlocks3D("tet", n_slave=n, n_master=max(1, round(n / 1.31)), unstructured=True)
    planes = {"left": "sym_x", "front": "sym_y", "right": "free", "back": "free"}
    for i, name in enumerate(mesh.GetBoundaries()):
        mesh.ngmesh.SetBCName(i, planes.get(name.split("_")[0], name))
    return mesh


PROBLEMS = {"hertz": Hertz, "sphere": Sphere, "patch": Patch}


def Make(problem, h, file=None):
    """Generate a mesh.

    Parameters
    ----------
    problem : {"hertz", "sphere", "patch"}
    h : float
        Size of the slave faces.
    file : str or Path, optional
        Where to write the .npz file; the NGSolve mesh comes beside it with the ending .vol.

    Returns
    -------
    PeerMesh
    """
    mesh = PROBLEMS[problem](h)
    mesh.Curve(2)
    made = PeerMesh(problem, h, mesh.nv, *Topology(mesh))
    if file is not None:
        made.Save(file)
        mesh.ngmesh.Save(str(Path(file).with_suffix(".vol")))
    return made


def Topology(mesh):
    """Points, elements, materials, faces, names and owners of an NGSolve mesh of order 2."""
    from ngsolve import BND, VOL, x, y, z

    points = NodalValues(mesh, (x, y, z)[: mesh.dim])
    elements = np.array([[v.nr for v in el.vertices] for el in mesh.Elements(VOL)])
    faces = np.array([[v.nr for v in el.vertices] for el in mesh.Elements(BND)])
    materials = np.array([el.mat for el in mesh.Elements(VOL)])
    names = np.array([el.mat for el in mesh.Elements(BND)])
    Orient(points, elements)
    owners = OrientFaces(points, elements, faces)
    numbers = EdgeNumbers(mesh)
    elements = np.hstack([elements, MidNodes(elements, numbers, EDGES[mesh.dim])])
    faces = np.hstack([faces, MidNodes(faces, numbers, FACE_EDGES[mesh.dim])])
    return points, elements, materials, faces, names, owners


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
    edges = np.array(EDGES[dim])
    nodes = np.vstack([reference, 0.5 * (reference[edges[:, 0]] + reference[edges[:, 1]])])
    rule = IntegrationRule([tuple(node) for node in nodes], [1.0] * len(nodes))
    at = mesh.MapToAllElements({ET.TRIG if dim == 2 else ET.TET: rule}, VOL)
    elements = np.array([[v.nr for v in el.vertices] for el in mesh.Elements(VOL)])
    numbers = np.hstack([elements, MidNodes(elements, EdgeNumbers(mesh), EDGES[dim])]).ravel()
    values = np.empty((mesh.nv + mesh.nedge, len(components)))
    for column, component in zip(values.T, components, strict=True):
        column[numbers] = component(at).ravel()
    return values


def EdgeNumbers(mesh):
    """The mid node between two corners (in ascending order)."""
    pairs = (sorted(v.nr for v in edge.vertices) for edge in mesh.edges)
    return {(a, b): mesh.nv + nr for nr, (a, b) in enumerate(pairs)}


def Orient(points, elements):
    """Exchange two corners of the elements of negative volume."""
    sides = points[elements[:, 1:]] - points[elements[:, :1]]
    wrong = np.linalg.det(sides) < 0
    elements[wrong, 1], elements[wrong, 2] = elements[wrong, 2], elements[wrong, 1]


def OrientFaces(points, elements, faces):
    """Turn the faces outwards; returns the element of each."""
    dim = points.shape[1]
    owner = {}
    for opposite in range(dim + 1):
        for i, side in enumerate(np.sort(np.delete(elements, opposite, axis=1)).tolist()):
            owner[tuple(side)] = i, opposite
    found = np.array([owner[tuple(face)] for face in np.sort(faces).tolist()])
    inside = points[elements[found[:, 0], found[:, 1]]] - points[faces[:, 0]]
    sides = points[faces[:, 1:]] - points[faces[:, :1]]
    volume = np.linalg.det(np.concatenate([sides, inside[:, None]], axis=1))
    inwards = volume < 0 if dim == 2 else volume > 0
    faces[inwards] = faces[inwards][:, ::-1]
    return found[:, 0]


def main(argv=None):
    """Run from the command line."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("problem", choices=PROBLEMS)
    parser.add_argument("h", type=float, help="size of the slave faces")
    parser.add_argument("file", help="name of the .npz file")
    options = parser.parse_args(argv)
    mesh = Make(options.problem, options.h, options.file)
    names, counts = np.unique(mesh.names, return_counts=True)
    print(f"{len(mesh.elements)} elements, {mesh.nvertices} corners, {len(mesh.points)} nodes")
    print(", ".join(f"{count} {name}" for name, count in zip(names, counts, strict=True)))


if __name__ == "__main__":
    main()
