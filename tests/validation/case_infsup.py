"""The discrete inf-sup constant of displacement and contact traction, in 2D and 3D.

For a scalar displacement (the normal component), a body on a square or box and its lower side as
slave boundary, beta^2 is the smallest eigenvalue of S x = beta^2 T x. Here S = B A^-1 B^T with B
from the form under test and the H1 inner product A, and T is the same with a displacement of higher
order on the same mesh, which measures tractions in the dual norm of the traces.

The dual norm depends on that order: with order 4 in place of 3 the constants of elements of order 2
in 3D are smaller by up to a tenth, those of order 1 by less. The published constants come with one
order or the other.
"""

from __future__ import annotations

import numpy as np
from elasticity import NAMES, Displacements
from netgen.meshing import Mesh as NetgenMesh
from netgen.occ import Box, OCCGeometry, Pnt, Rectangle
from ngsolve import BND, CF, H1, BilinearForm, ElementId, Grad, Mesh, SurfaceL2, ds, dx
from ngsolve.meshes import MakeStructured2DMesh
from report_bounds import HalfDigit, Rate
from report_case import Case, Outcome, Row
from report_pictures import BLUE, GREEN, GREY, INK, ORANGE, Figure
from scipy.linalg import eigh
from scipy.sparse import csr_matrix

from ngslac import LACContact, LACSpace
from ngslac.meshes.boxes import StructuredBox

RIM = "left|right|front|back"
DIGIT = HalfDigit(1e-3)
# Computed by others, with a program that has nothing to do with this one: for h = 1/5, 1/10, 1/20.
TABLE = {
    "P1": (0.939, 0.811, 0.790),
    "P1bubble": (0.831, 0.837, 0.835),
    "P2": (0.899, 0.897, 0.900),
}
UNSTABLE = (0.346, 0.191, 0.097)
TABLES_3D = {  # for n = 4, 6, 8
    "": {
        ("tet", "P1bubble"): (0.475, 0.442, 0.428),
        ("tet", "P2bubble"): (0.764, 0.755, 0.752),
        ("hex", "P1"): (0.851, 0.750, 0.703),
        ("hex", "P1bubble"): (0.585, 0.519, 0.488),
        ("hex", "P2"): (0.893, 0.885, 0.883),
    },
    ", clamped rim": {
        ("tet", "P1bubble"): (0.420, 0.413, 0.411),
        ("tet", "P2bubble"): (0.753, 0.751, 0.749),
    },
}
UNSTABLE_3D = (0.368, 0.258, 0.198)  # one constant per triangle of order 2
NAMES_3D = NAMES | {"P1": "order 1, stars of faces", "P2bubble": "order 2, bubbles"}
COLOURS = (BLUE, ORANGE, GREEN, GREY, INK)


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


def Cube(n, kind, perturb=0.0):
    """The unit cube in n x n x n/2 bricks, twice as high as wide, cut into cells of one kind."""
    mesh = NetgenMesh(dim=3)
    lateral, height = np.linspace(0, 1, n + 1), np.linspace(0, 1, n // 2 + 1)
    StructuredBox(lateral, lateral, height, kind, perturb=perturb, seed=1).AddTo(mesh, "body")
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


def Sparse(mat):
    values, columns, starts = (np.array(a) for a in mat.CSR())
    return csr_matrix((values, columns, starts), shape=mat.shape)


def NormalMortar(V, Q):
    """Rows of the normal component of D; the wall takes no part in it."""
    (u, lam), _ = (V * Q).TnT()
    D, _ = LACContact(u, lam, obstacle=CF(0)).Mortar()
    last = V.Range(u.dim - 1)
    return Sparse(D)[u.dim - 1 :: u.dim, last.start : last.stop]


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
    A = BilinearForm((Grad(u) * Grad(v) + u * v) * dx, condense=True, symmetric=True).Assemble()
    inverse = A.mat.Inverse(H.FreeDofs(True), inverse="sparsecholesky")
    load, moved = A.mat.CreateColVector(), A.mat.CreateColVector()
    result = np.zeros((rows.shape[0], rows.shape[0]))
    for k in range(rows.shape[0]):
        load.FV().NumPy()[:] = rows[k].toarray()[0]
        moved.data = inverse * load
        result[:, k] = rows @ moved.FV().NumPy()
    return result


class Body:
    """A mesh with its facewise reference Schur complement, which all macro-elements share."""

    def __init__(self, mesh, *, reference=None, clamped=False):
        self.mesh, self.dirichlet = mesh, {"dirichlet": RIM} if clamped else {}
        exact = H1(mesh, order=reference or {2: 5, 3: 3}[mesh.dim], **self.dirichlet)
        rows, self.faces = FaceRows(exact)
        self.reference = Schur(exact, rows)

    def Space(self, kind):
        return Displacements(self.mesh, kind, slave="bottom", **self.dirichlet)

    def InfSup(self, kind, macros=None):
        """The constant of a displacement space with its own macro-elements, or with those given."""
        V = self.Space(kind)
        Q = LACSpace(V, slave="bottom", macros=macros)
        sums = np.zeros((Q.nmacros, len(self.faces)))
        sums[[Q.macros[nr] for nr in self.faces], range(len(self.faces))] = 1
        S = Schur(V.components[-1], NormalMortar(V, Q))
        return Roots(S, sums @ self.reference @ sums.T)[0]

    def PerFace(self, order):
        """All roots that belong to one constant per face, stable or not, the smallest first."""
        H = H1(self.mesh, order=order, **self.dirichlet)
        return Roots(Schur(H, FaceRows(H)[0]), self.reference)


def Roots(S, T):
    """Of the eigenvalues of S x = beta^2 T x."""
    return np.sqrt(np.maximum(eigh(S, T, eigvals_only=True), 0)).tolist()


def Order(divisions, constants):
    """Minus the power of the mesh size that the constants decay with: 0 or more is stable."""
    finer = divisions[-1] / divisions[0]
    return float(np.log(constants[-1] / constants[0]) / np.log(finer))


def Published(name, level, levels, constants, table):
    """A row for each level."""
    return [
        Row(f"{name}, {level}{n}", ours, published, DIGIT)
        for n, ours, published in zip(levels, constants, table, strict=True)
    ]


def InfSup2D(quick):
    divisions = (5, 10, 20)
    bodies = [Body(Square(n)) for n in divisions]
    clamped = [Body(Square(n, "trigs"), clamped=True) for n in divisions]
    rows, curves = [], {}
    for kind, published in TABLE.items():
        curves[NAMES[kind]] = found = [body.InfSup(kind) for body in bodies]
        rows += Published(NAMES[kind], "h = 1/", divisions, found, published)
    single = "order 1, one face each"
    curves[single] = found = [body.PerFace(1)[0] for body in bodies]
    rows += Published(f"{single} (unstable)", "h = 1/", divisions, found, UNSTABLE)
    for kind in (*TABLE, "P3"):
        text = f"{NAMES[kind]}, structured, clamped rim: order in the mesh size"
        order = Order(divisions, [body.InfSup(kind) for body in clamped])
        rows.append(Row(text, order, 0, Rate()))
    text = f"{single} (unstable): order in the mesh size"
    rows.append(Row(text, Order(divisions, found), -1))
    caption = (
        "Inf-sup constants of the macro-elements that `LACSpace` makes stay away from zero; that "
        "of one multiplier for each face of order 1 decays like the mesh size."
    )
    return Outcome(rows, Curves(divisions, curves), caption)


def InfSup3D(quick):
    levels, rows, curves = (4, 6, 8), [], {}
    for note, table in TABLES_3D.items():
        kinds = dict.fromkeys(kind for kind, _ in table)
        bodies = {k: [Body(Cube(n, k), clamped=bool(note)) for n in levels] for k in kinds}
        for (kind, element), published in table.items():
            name = f"{kind}, {NAMES_3D[element]}{note}"
            curves[name] = [body.InfSup(element) for body in bodies[kind]]
            rows += Published(name, "n = ", levels, curves[name], published)
        if not note:
            single = [body.PerFace(2)[0] for body in bodies["tet"]]
    name = "tet, order 2, one triangle each"
    curves[name] = single
    rows += Published(f"{name} (unstable)", "n = ", levels, single, UNSTABLE_3D)
    caption = "The same in 3D, over the number of elements along the edge of the contact face."
    return Outcome(rows, Curves(levels, curves), caption)


def Curves(levels, curves):
    def Draw(ax):
        for k, (name, values) in enumerate(curves.items()):
            style = "--x" if "each" in name else "-s" if "clamped" in name else "-o"
            ax.plot(levels, values, style, ms=4, lw=1, color=COLOURS[k % 5], label=name)
        ax.set_xticks(levels)
        ax.set_ylim(0, 1)
        ax.set_xlabel("elements along the edge")
        ax.set_ylabel("inf-sup constant")
        ax.legend(loc="center left", bbox_to_anchor=(1.01, 0.5))

    return Figure(Draw, size=(7.5, 3.6))


CASES = [
    Case(
        "infsup2d",
        "Inf-sup constants in 2D",
        "The constant that tells whether displacements and contact tractions fit together, for "
        "the unit square with its lower edge as slave side: the smallest eigenvalue of the Schur "
        "complement against that of displacements of order 5.",
        "For unstructured triangles, constants computed with a program of others; the method's "
        "condition: Abbas, Drouet, Hild, Pignet (2017), section 2.2.",
        "pytest tests/validation/test_cases.py -k infsup2d",
        InfSup2D,
    ),
    Case(
        "infsup3d",
        "Inf-sup constants in 3D",
        "The same for a box with structured tetrahedra or hexahedra, free or clamped all around "
        "the contact face. On triangles order 2 needs macro-elements of two faces, or bubbles.",
        "Constants computed with a program of others.",
        "pytest tests/validation/test_cases.py -k infsup3d",
        InfSup3D,
    ),
]
