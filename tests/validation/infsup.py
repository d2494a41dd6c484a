"""The discrete inf-sup constant of displacement and contact traction.

For a scalar displacement (the normal component), a body on the unit square and its lower edge as
slave boundary, beta^2 is the smallest eigenvalue of S x = beta^2 T x. Here S = B A^-1 B^T with B
from the form under test and the H1 inner product A, and T is the same with a displacement of order
5 on the same mesh, which measures tractions in the dual norm of the traces.
"""

import numpy as np
from netgen.occ import OCCGeometry, Rectangle
from ngsolve import (
    BND,
    CF,
    H1,
    BilinearForm,
    ElementId,
    Grad,
    Mesh,
    SurfaceL2,
    VectorH1,
    ds,
    dx,
)
from ngsolve.meshes import MakeStructured2DMesh
from scipy.linalg import eigh
from scipy.sparse import csr_matrix
from scipy.sparse.linalg import splu

from ngslac import BubbleVectorH1, LACContact, LACSpace

__all__ = ["Body", "Space", "Square"]

REFERENCE_ORDER = 5


def Square(n, kind="unstructured"):
    """The unit square with edges of length 1/n: unstructured, or a grid of "trigs" or "quads"."""
    if kind != "unstructured":
        return MakeStructured2DMesh(quads=kind == "quads", nx=n, ny=n)
    face = Rectangle(1, 1).Face()
    for edge in face.edges:
        middle = edge.center
        names = {"bottom": middle.y, "top": 1 - middle.y, "left": middle.x, "right": 1 - middle.x}
        edge.name = min(names, key=names.get)
    return Mesh(OCCGeometry(face, dim=2).GenerateMesh(maxh=1 / n))


def Space(mesh, kind, **dirichlet):
    """As in the table: "P1", "P1bubble", "P2", "P3" (Q on quadrilaterals)."""
    order = int(kind[1])
    if kind.endswith("bubble"):
        return BubbleVectorH1(mesh, order=order, slave="bottom", **dirichlet)
    return VectorH1(mesh, order=order, **dirichlet)


def Sparse(mat):
    values, columns, starts = (np.array(a) for a in mat.CSR())
    return csr_matrix((values, columns, starts), shape=mat.shape)


def NormalMortar(V, Q):
    """Rows of the normal component of D; the wall takes no part in it."""
    X = V * Q
    (u, lam), _ = X.TnT()
    D, _ = LACContact(u, lam, obstacle=CF(0)).Mortar()
    second = V.Range(1)
    return Sparse(D)[1::2, second.start : second.stop]


def FaceRows(H):
    """For a scalar space, one row per slave face, from plain NGSolve forms; also their numbers."""
    faces = SurfaceL2(H.mesh, order=0, definedon=H.mesh.Boundaries("bottom"))
    B = BilinearForm(trialspace=H, testspace=faces)
    B += H.TrialFunction() * faces.TestFunction() * ds("bottom")
    rows = Sparse(B.Assemble().mat)
    numbers = [el.nr for el in faces.Elements(BND) if el.mat == "bottom"]
    return rows[[faces.GetDofNrs(ElementId(BND, nr))[0] for nr in numbers]], numbers


def Schur(H, rows):
    """B A^-1 B^T for a scalar space and the H1 inner product, without the element's inner dofs."""
    u, v = H.TnT()
    A = BilinearForm((Grad(u) * Grad(v) + u * v) * dx, condense=True).Assemble()
    free = np.flatnonzero(list(H.FreeDofs(True)))
    B = rows[:, free].toarray()
    return B @ splu(Sparse(A.mat)[free][:, free].tocsc()).solve(np.ascontiguousarray(B.T))


class Body:
    """A mesh with its facewise reference Schur complement, which all partitions share."""

    def __init__(self, mesh, **dirichlet):
        self.mesh, self.dirichlet = mesh, dirichlet
        exact = H1(mesh, order=REFERENCE_ORDER, **dirichlet)
        rows, self.faces = FaceRows(exact)
        self.reference = Schur(exact, rows)

    def InfSup(self, kind):
        """The constant of a displacement space with its own macro-elements."""
        V = Space(self.mesh, kind, **self.dirichlet)
        Q = LACSpace(V, slave="bottom")
        sums = np.zeros((Q.nmacros, len(self.faces)))
        sums[[Q.macros[nr] for nr in self.faces], range(len(self.faces))] = 1
        return Smallest(Schur(V.components[1], NormalMortar(V, Q)), sums @ self.reference @ sums.T)

    def InfSupPerFace(self, order):
        """The same with one constant per face, whether stable or not."""
        H = H1(self.mesh, order=order, **self.dirichlet)
        return Smallest(Schur(H, FaceRows(H)[0]), self.reference)


def Smallest(S, T):
    """Root of the smallest eigenvalue of S x = beta^2 T x."""
    return float(np.sqrt(max(0.0, eigh(S, T, eigvals_only=True, subset_by_index=[0, 0])[0])))
