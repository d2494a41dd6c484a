"""The discrete inf-sup constant of displacement and contact traction in three dimensions.

As in `infsup`, for a scalar displacement and the lower side of a box as slave boundary: beta^2 is
the smallest eigenvalue of S x = beta^2 T x with S = B A^-1 B^T from the macro-elements under test,
and T the same with a displacement of higher order on the same mesh. Everything but the
macro-elements is plain NGSolve: one body needs no contact.

The order of the reference is 3, where nothing else is said. The dual norm of the traces depends on
it: with order 4 the constants of elements of order 2 are smaller by up to a tenth, those of order 1
by less, and an element of order 3 has something to be compared with. The published constants come
with one order or the other.
"""

import numpy as np
from infsup import FaceRows, Smallest, Sparse
from netgen.meshing import Mesh as NetgenMesh
from netgen.occ import Box, OCCGeometry, Pnt
from ngsolve import H1, BilinearForm, Grad, Mesh, VectorH1, ds, dx
from scipy.linalg import eigh

from ngslac import BubbleVectorH1, LACSpace
from ngslac.meshes.boxes import AddBody, StructuredBox

__all__ = ["RIM", "Body3D", "Cube", "Parents", "Slab", "Space3D"]

RIM = "left|right|front|back"


def Cube(n, kind, perturb=0.0):
    """The unit cube in n x n x n/2 bricks, twice as high as wide, cut into cells of one kind."""
    mesh = NetgenMesh(dim=3)
    lateral, height = np.linspace(0, 1, n + 1), np.linspace(0, 1, n // 2 + 1)
    AddBody(mesh, "body", StructuredBox(lateral, lateral, height, kind, perturb=perturb, seed=1))
    mesh.Compress()
    return Mesh(mesh)


def Slab(h):
    """A box of height 1/2 on the unit square in unstructured tetrahedra of size h."""
    box = Box(Pnt(0, 0, 0), Pnt(1, 1, 0.5))
    for face in box.faces:
        x, y, z = (face.center.x, face.center.y, face.center.z)
        distance = {"left": x, "right": 1 - x, "front": y, "back": 1 - y, "bottom": z}
        face.name = min(distance, key=distance.get) if z < 0.49 else "top"
    return Mesh(OCCGeometry(box).GenerateMesh(maxh=h))


def Parents(coarse, fine):
    """The slave faces of a mesh split by cones, as a partition: each has one new vertex inside."""
    new = [max(v.nr for v in el.vertices) for el in fine.Boundaries("bottom").Elements()]
    assert min(new) >= coarse.nv
    return np.unique(new, return_inverse=True)[1].tolist()


def Space3D(mesh, element, **dirichlet):
    """By its name: "P1", "P1bubble", "P2", ... (whatever the shape of the cells)."""
    order = int(element[1])
    if element.endswith("bubble"):
        return BubbleVectorH1(mesh, order=order, slave="bottom", **dirichlet)
    return VectorH1(mesh, order=order, **dirichlet)


def MacroRows(H, Q):
    """Mean values on the macro-elements times their areas: one row per macro-element of `Q`."""
    numbers = Q.WithComponents(1)
    B = BilinearForm(trialspace=H, testspace=numbers)
    B += H.TrialFunction() * numbers.TestFunction() * ds("bottom")
    return Sparse(B.Assemble().mat)


def Schur(H, rows):
    """B A^-1 B^T for a scalar space and the H1 inner product, without the element's inner dofs."""
    u, v = H.TnT()
    A = BilinearForm((Grad(u) * Grad(v) + u * v) * dx, condense=True, symmetric=True).Assemble()
    inverse = A.mat.Inverse(H.FreeDofs(True), inverse="sparsecholesky")
    load, moved = A.mat.CreateColVector(), A.mat.CreateColVector()
    result = np.zeros((rows.shape[0], rows.shape[0]))
    for k in range(rows.shape[0]):
        load.FV().NumPy()[:] = rows[k].toarray()[0]
        moved.data = inverse * load
        result[:, k] = rows @ moved.FV().NumPy()
    return result


class Body3D:
    """A mesh with its facewise reference Schur complement, which all elements share."""

    def __init__(self, mesh, reference=3, **dirichlet):
        self.mesh, self.dirichlet = mesh, dirichlet
        exact = H1(mesh, order=reference, **dirichlet)
        rows, self.faces = FaceRows(exact)
        self.reference = Schur(exact, rows)

    def InfSup(self, element, macros=None):
        """The constant of a displacement space with its own macro-elements, or with those given."""
        V = Space3D(self.mesh, element, **self.dirichlet)
        Q = LACSpace(V, slave="bottom", macros=macros)
        sums = np.zeros((Q.nmacros, len(self.faces)))
        sums[[Q.macros[nr] for nr in self.faces], range(len(self.faces))] = 1
        H = V.components[2]
        return Smallest(Schur(H, MacroRows(H, Q)), sums @ self.reference @ sums.T)

    def InfSupPerFace(self, order):
        """The same with one constant per face, whether stable or not."""
        return self.PerFace(order)[0]

    def PerFace(self, order):
        """All singular values that belong to one constant per face, the smallest first."""
        H = H1(self.mesh, order=order, **self.dirichlet)
        squares = eigh(Schur(H, FaceRows(H)[0]), self.reference, eigvals_only=True)
        return np.sqrt(np.maximum(squares, 0))
