# SPDX-License-Identifier: LGPL-2.1-or-later
from __future__ import annotations
import collections.abc
import ngsolve.comp
import ngsolve.fem
import ngsolve.la
import numpy
import numpy.typing
import pyngcore.pyngcore
import typing
__all__: list[str] = ['BubbleVectorH1', 'Condensation', 'ContactForm', 'DofFingerprint', 'ElementDofs', 'EquilibrationScale', 'FacetCorners', 'FormDiagonal', 'GMRes', 'HoldsGridFunction', 'HoldsProxy', 'InnerElimination', 'IsAssembled', 'LACSpace', 'MergeMatrices', 'NamesInstead', 'PieceOf', 'PlacementOf', 'PolygonDifference', 'PolygonIntersection', 'PolygonOverlap', 'PreconditionedProduct', 'ProxyPath', 'RegionWithFaces', 'RigidTool', 'SchurComplement', 'Side', 'SplitSlaveFaces', 'StarSweeps', 'ToolDrive', 'ToolMotion', 'ToolShape', 'TwoLevel', 'TwoLevelProduct', 'Unmatched', 'VertexDofs', 'WholeMesh']
class LACSpace(ngsolve.comp.FESpace):
    """
    Contact tractions, constant on macro-elements of the slave surface.

    Every macro-element contains the support of at least one free displacement basis function, so that
    the method is inf-sup stable (Abbas, Drouet, Hild, Pignet 2017, section 2.2). The supports are read
    off the displacement space: single faces where these carry an inner dof (order >= 2 in 2D, or
    `BubbleVectorH1`), stars of faces around a vertex for first order. A function of the space is the
    traction acting on the slave body in Cartesian components (stress units), one vector per
    macro-element; there are no other dofs.

    Parameters
    ----------
    V : ngsolve.FESpace
        Displacement space, vector-valued and real, of any kind and order: VectorH1, H1(dim=d),
        VectorValued, a component of a product space. Dofs with Dirichlet conditions do not count.
    slave : str or Region
        Pattern of boundary names, or a boundary region: the side that carries the multipliers.
    macros : list[int], optional
        Macro-element of each slave face in the order of the mesh, numbered densely from 0, in place of
        the automatic choice; refused if one holds no inner basis function. Not for refined meshes.
    components : int, optional
        Numbers per macro-element; default: the space dimension, as `LACContact` needs it.
    autoupdate : bool
        Update with `mesh.Refine()`. Default: as V does.

    Raises
    ------
    TypeError, ValueError
        An argument that does not fit: the message names it, its value and what is wanted.
    NgException
        Faces of which no stable macro-element can be made (the message names them and the remedies).

    Notes
    -----
    Where the slave's displacement is prescribed in some directions, macro-elements carry the others
    exactly. In the prescribed ones they stick elastically, with a slip of a hundredth of what the surface
    gives under the same traction, and slip as elsewhere. So do faces that nothing can move along their
    normal, beside those that can. `LACContact.Check` names these macro-elements.

    Examples
    --------
    >>> V = VectorH1(mesh, order=2, dirichlet="bottom")
    >>> Q = LACSpace(V, slave="slave")
    >>> (u, lam), (v, mu) = (V * Q).TnT()
    >>> Q.ndof == mesh.dim * Q.nmacros
    True
    """
    def CoreDofs(self, macro: typing.SupportsInt | typing.SupportsIndex) -> pyngcore.pyngcore.Array_I_S:
        """
        Displacement dofs whose trace on the slave surface lives in one macro-element alone.

        Parameters
        ----------
        macro : int

        Returns
        -------
        Array of int
            Numbers in `displacement`; at least one.

        Raises
        ------
        IndexError
            If there is no such macro-element.
        """
    def WithComponents(self, components: typing.SupportsInt | typing.SupportsIndex) -> LACSpace:
        """
        The space on the same macro-elements with another number of components.

        Parameters
        ----------
        components : int
            1, 2 or 3 numbers per macro-element.

        Returns
        -------
        LACSpace
        """
    def __getstate__(self) -> tuple[ngsolve.comp.FESpace, pyngcore.pyngcore.Flags]:
        ...
    def __init__(self, V: ngsolve.comp.FESpace, *, slave: ngsolve.comp.Region | str, macros: collections.abc.Sequence[typing.SupportsInt | typing.SupportsIndex] | None = None, components: typing.SupportsInt | typing.SupportsIndex | None = None, autoupdate: bool = False) -> None:
        ...
    def __repr__(self) -> str:
        ...
    def __setstate__(self, arg0: tuple) -> None:
        ...
    @property
    def displacement(self) -> ngsolve.comp.FESpace:
        """
        The displacement space (FESpace) that the macro-elements are made for.
        """
    @property
    def macros(self) -> pyngcore.pyngcore.Array_I_S:
        """
        Macro-element of each boundary element of the mesh, -1 off the slave surface.
        """
    @property
    def nmacros(self) -> int:
        """
        Number of macro-elements.
        """
    @property
    def number(self) -> int:
        """
        Of its replica where the mesh is distributed, else -1.
        """
    @property
    def slave(self) -> ngsolve.comp.Region:
        """
        The slave surface (Region).
        """
class ToolShape:
    @staticmethod
    def Ball(arg0: collections.abc.Sequence[typing.SupportsFloat | typing.SupportsIndex], arg1: typing.SupportsFloat | typing.SupportsIndex, arg2: collections.abc.Sequence[typing.SupportsFloat | typing.SupportsIndex]) -> ToolShape:
        ...
    @staticmethod
    def Expression(arg0: ngsolve.fem.CoefficientFunction, arg1: typing.SupportsInt | typing.SupportsIndex) -> ToolShape:
        ...
    @staticmethod
    def Facets(arg0: collections.abc.Sequence[typing.SupportsFloat | typing.SupportsIndex], arg1: collections.abc.Sequence[typing.SupportsInt | typing.SupportsIndex], arg2: typing.SupportsInt | typing.SupportsIndex, arg3: bool) -> ToolShape:
        ...
    @staticmethod
    def HalfSpace(arg0: collections.abc.Sequence[typing.SupportsFloat | typing.SupportsIndex], arg1: collections.abc.Sequence[typing.SupportsFloat | typing.SupportsIndex]) -> ToolShape:
        ...
    @staticmethod
    def Revolution(arg0: ToolShape, arg1: collections.abc.Sequence[typing.SupportsFloat | typing.SupportsIndex], arg2: collections.abc.Sequence[typing.SupportsFloat | typing.SupportsIndex]) -> ToolShape:
        ...
    @staticmethod
    def Wedge(arg0: typing.SupportsFloat | typing.SupportsIndex) -> ToolShape:
        ...
    def Complement(self) -> ToolShape:
        ...
    def Evaluate(self, arg0: collections.abc.Sequence[typing.SupportsFloat | typing.SupportsIndex]) -> tuple[list[float], list[float], list[float]]:
        ...
    def Grown(self, arg0: typing.SupportsFloat | typing.SupportsIndex) -> ToolShape:
        ...
    def Together(self, arg0: ToolShape) -> ToolShape:
        ...
    @property
    def dim(self) -> int:
        ...
class ToolMotion:
    def __init__(self, shift: ngsolve.fem.CoefficientFunction, angle: ngsolve.fem.CoefficientFunction, center: typing.Annotated[collections.abc.Sequence[typing.SupportsFloat | typing.SupportsIndex], "FixedSize(3)"], axis: typing.Annotated[collections.abc.Sequence[typing.SupportsFloat | typing.SupportsIndex], "FixedSize(3)"]) -> None:
        ...
class ToolDrive:
    def __init__(self, travel: ngsolve.fem.CoefficientFunction, load: ngsolve.fem.CoefficientFunction, component: typing.SupportsInt | typing.SupportsIndex, center: typing.Annotated[collections.abc.Sequence[typing.SupportsFloat | typing.SupportsIndex], "FixedSize(3)"], axis: typing.Annotated[collections.abc.Sequence[typing.SupportsFloat | typing.SupportsIndex], "FixedSize(3)"]) -> None:
        ...
class RigidTool:
    def __init__(self, shape: ToolShape, motions: collections.abc.Sequence[ToolMotion], drives: collections.abc.Sequence[ToolDrive]) -> None:
        ...
class Side:
    """
    Members:

      slave

      master

      both
    """
    __members__: typing.ClassVar[dict[str, Side]]
    both: typing.ClassVar[Side]
    master: typing.ClassVar[Side]
    slave: typing.ClassVar[Side]
    @typing.overload
    def __eq__(self, other: Side) -> bool:
        ...
    @typing.overload
    def __eq__(self, other: typing.Any) -> bool:
        ...
    def __getstate__(self) -> int:
        ...
    def __hash__(self) -> int:
        ...
    def __index__(self) -> int:
        ...
    def __init__(self, value: typing.SupportsInt | typing.SupportsIndex) -> None:
        ...
    def __int__(self) -> int:
        ...
    @typing.overload
    def __ne__(self, other: Side) -> bool:
        ...
    @typing.overload
    def __ne__(self, other: typing.Any) -> bool:
        ...
    def __repr__(self) -> str:
        ...
    def __setstate__(self, state: typing.SupportsInt | typing.SupportsIndex) -> None:
        ...
    def __str__(self) -> str:
        ...
    @property
    def name(self) -> str:
        ...
    @property
    def value(self) -> int:
        ...
class ContactForm:
    def AddApply(self, arg0: ngsolve.la.BaseVector, arg1: ngsolve.la.BaseVector) -> None:
        ...
    def AddForces(self, x: ngsolve.la.BaseVector, tractions: typing.Annotated[numpy.typing.ArrayLike, numpy.float64], y: ngsolve.la.BaseVector) -> None:
        ...
    def AssembleLinearization(self, arg0: ngsolve.la.BaseVector) -> None:
        ...
    def AssembleStep(self, arg0: ngsolve.la.BaseVector, arg1: ngsolve.la.BaseVector) -> None:
        ...
    def BeginSolve(self) -> None:
        ...
    def CheckPaired(self) -> None:
        ...
    def Close(self, macros: pyngcore.pyngcore.BitArray, x: ngsolve.la.BaseVector) -> None:
        ...
    def Commit(self, arg0: ngsolve.la.BaseVector) -> None:
        ...
    def Evaluate(self, arg0: ngsolve.la.BaseVector) -> None:
        ...
    def Follow(self, arg0: ngsolve.la.BaseVector) -> None:
        ...
    def History(self) -> dict:
        ...
    def JumpMatrix(self, arg0: Side) -> ngsolve.la.BaseMatrix:
        ...
    def Lean(self, vectors: typing.Annotated[numpy.typing.ArrayLike, numpy.float64]) -> None:
        ...
    def LearnStiffness(self, bulk: ngsolve.comp.BilinearForm | ngsolve.la.BaseMatrix) -> None:
        ...
    def GapRanges(self, x: numpy.typing.NDArray[numpy.float64]) -> numpy.typing.NDArray[numpy.float64]:
        ...
    def Matrix(self, x: ngsolve.la.BaseVector, tractions: typing.Annotated[numpy.typing.ArrayLike, numpy.float64], stiffness: typing.Annotated[numpy.typing.ArrayLike, numpy.float64]) -> ngsolve.la.BaseMatrix:
        ...
    def MultiplierDofs(self) -> numpy.typing.NDArray[numpy.int32]:
        ...
    def Depths(self) -> numpy.typing.NDArray[numpy.float64]:
        ...
    def Overlaps(self) -> numpy.typing.NDArray[numpy.float64]:
        ...
    def Points(self) -> numpy.typing.NDArray[numpy.float64]:
        ...
    def Reevaluate(self) -> None:
        ...
    def Resultants(self) -> dict:
        ...
    def Restore(self) -> None:
        ...
    def Segments(self) -> tuple[numpy.typing.NDArray[numpy.float64], numpy.typing.NDArray[numpy.float64], numpy.typing.NDArray[numpy.uint64]]:
        ...
    def SetConstant(self, c: typing.SupportsFloat | typing.SupportsIndex) -> None:
        ...
    def SetActive(self, active: bool) -> None:
        ...
    def SetEven(self, even: bool) -> None:
        ...
    def SetHistory(self, arg0: collections.abc.Mapping[str, typing.Annotated[numpy.typing.ArrayLike, numpy.float64]]) -> None:
        ...
    def SetStiffness(self, bulk: ngsolve.la.BaseMatrix, factor: typing.SupportsFloat | typing.SupportsIndex = 1.0) -> None:
        ...
    def Table(self) -> dict:
        ...
    def ToolDofs(self) -> numpy.typing.NDArray[numpy.int32]:
        ...
    def ToolRows(self) -> numpy.typing.NDArray[numpy.float64]:
        ...
    def Update(self, gf: ngsolve.comp.GridFunction = None, history: collections.abc.Mapping[str, typing.Annotated[numpy.typing.ArrayLike, numpy.float64]] | None = None) -> None:
        ...
    def __init__(self, *, u: ngsolve.fem.CoefficientFunction, lam: ngsolve.fem.CoefficientFunction, master: ngsolve.comp.Region | None = None, obstacle: ngsolve.fem.CoefficientFunction = None, friction: ngsolve.fem.CoefficientFunction = None, tresca: ngsolve.fem.CoefficientFunction = None, offset: ngsolve.fem.CoefficientFunction = None, tool: RigidTool | None = None, tied: bool = False, bilateral: bool = False, finite: bool = False, edges: bool = False, adjust: typing.SupportsFloat | typing.SupportsIndex = 0.0, maxdist: typing.SupportsFloat | typing.SupportsIndex = 0.0, penetration: typing.SupportsFloat | typing.SupportsIndex = 0.0, active: bool = True, law: typing.Any = None) -> None:
        ...
    @property
    def active(self) -> bool:
        ...
    @property
    def component(self) -> ngsolve.comp.FESpace:
        ...
    @property
    def current(self) -> bool:
        ...
    @property
    def fes(self) -> ngsolve.comp.FESpace:
        ...
    @property
    def mat(self) -> ngsolve.la.BaseMatrix:
        ...
    @property
    def nsegments(self) -> int:
        ...
    @property
    def lamoffset(self) -> int:
        ...
    @property
    def offset(self) -> int:
        ...
    @property
    def paired(self) -> bool:
        ...
    @property
    def space(self) -> LACSpace:
        ...
class BubbleVectorH1(ngsolve.comp.VectorH1):
    """
    VectorH1 with a bubble on every face of a slave boundary.

    Local Average Contact needs a displacement basis function within every
    macro-element of the slave boundary. This space adds one per slave face where
    the order alone has none, and no other: edges get order 2, triangles order 3,
    quadrilaterals order 2. The mesh, and the space away from the slave boundary,
    stay as they are. In 2D with order >= 2 the space equals VectorH1.

    Parameters
    ----------
    mesh : ngsolve.Mesh

    Examples
    --------
    >>> V = BubbleVectorH1(mesh, order=1, slave="slave", dirichlet="bottom")
    >>> LACSpace(V, slave="slave").nmacros == len(list(mesh.Boundaries("slave").Elements()))
    True

    Keyword arguments can be:

    order: int = 1
      order of finite element space
    complex: bool = False
      Set if FESpace should be complex
    dirichlet: regexpr
      Regular expression string defining the dirichlet boundary.
      More than one boundary can be combined by the | operator,
      i.e.: dirichlet = 'top|right'
    dirichlet_bbnd: regexpr
      Regular expression string defining the dirichlet bboundary,
      i.e. points in 2D and edges in 3D.
      More than one boundary can be combined by the | operator,
      i.e.: dirichlet_bbnd = 'top|right'
    dirichlet_bbbnd: regexpr
      Regular expression string defining the dirichlet bbboundary,
      i.e. points in 3D.
      More than one boundary can be combined by the | operator,
      i.e.: dirichlet_bbbnd = 'top|right'
    definedon: Region or regexpr
      FESpace is only defined on specific Region, created with mesh.Materials('regexpr')
      or mesh.Boundaries('regexpr'). If given a regexpr, the region is assumed to be
      mesh.Materials('regexpr').
    dim: int = 1
      Create multi dimensional FESpace (i.e. [H1]^3)
    dgjumps: bool = False
      Enable discontinuous space for DG methods, this flag is needed for DG methods,
      since the dofs have a different coupling then and this changes the sparsity
      pattern of matrices.
    autoupdate: bool = True
      Automatically update on a change to the mesh.
    low_order_space: bool = True
      Generate a lowest order space together with the high-order space,
      needed for some preconditioners.
    hoprolongation: bool = False
      Create high order prolongation operators,
      only available for H1 and L2 on simplicial meshes
    order_policy: ORDER_POLICY = ORDER_POLICY.OLDSTYLE
      CONSTANT .. use the same fixed order for all elements,
      NODAL ..... use the same order for nodes of same shape,
      VARIABLE ... use an individual order for each edge, face and cell,
      OLDSTYLE .. as it used to be for the last decade
    print: bool = False
      (historic) print some output into file set by 'SetTestoutFile'
    interleaved: bool = False
      ordering of dofs changed to x0, y0, z0, x1 ....
    dirichletx: regexpr
      Regular expression string defining the dirichlet boundary
      on the first component of VectorH1.
      More than one boundary can be combined by the | operator,
      i.e.: dirichletx = 'top|right'
    dirichlety: regexpr
      Dirichlet boundary for the second component
    dirichletz: regexpr
      Dirichlet boundary for the third component
    dirichletx_bbnd: regexpr
      Regular expression string defining the dirichlet bboundary,
      i.e. points in 2D and edges in 3D, on the first component.
      More than one bboundary can be combined by the | operator,
      i.e.: dirichletx_bbnd = 'top|right'
    dirichlety_bbnd: regexpr
      Dirichlet bboundary for the second component
    dirichletz_bbnd: regexpr
      Dirichlet bboundary for the third component
    dirichletx_bbbnd: regexpr
      Regular expression string defining the dirichlet bbboundary,
      i.e. points in 3D, on the first component.
      More than one bbboundary can be combined by the | operator,
      i.e.: dirichletx_bbbnd = 'top|right'
    dirichlety_bbbnd: regexpr
      Dirichlet bbboundary for the second component
    dirichletz_bbbnd: regexpr
      Dirichlet bbboundary for the third component
    slave: regexpr or Region
      Boundaries whose faces get a bubble, i.e.: slave = 'left|right'
    """
    @staticmethod
    def __flags_doc__() -> dict:
        ...
    @staticmethod
    def __special_treated_flags__() -> dict:
        ...
    def __getstate__(self: ngsolve.comp.FESpace) -> tuple:
        ...
    def __init__(self, mesh: ngsolve.comp.Mesh, **kwargs) -> None:
        ...
    def __repr__(self) -> str:
        ...
    def __setstate__(self, arg0: tuple) -> None:
        ...
class Condensation(ngsolve.la.BaseMatrix):
    """
    Newton system without multipliers, by lifts of least energy, whatever the stiffnesses.
    `Part` is of a sparse matrix that is equivalent to the product. But for both, `mat` may hold
    the rows and columns of the multipliers alone.
    """
    def Complete(self, rhs: typing.Annotated[numpy.typing.ArrayLike, numpy.float64], u: typing.Annotated[numpy.typing.ArrayLike, numpy.float64], image: typing.Annotated[numpy.typing.ArrayLike, numpy.float64]) -> numpy.typing.NDArray[numpy.float64]:
        """
        Displacements and multipliers, with the bulk's forces of the first.
        """
    def Displacements(self, rhs: typing.Annotated[numpy.typing.ArrayLike, numpy.float64], w: typing.Annotated[numpy.typing.ArrayLike, numpy.float64]) -> numpy.typing.NDArray[numpy.float64]:
        """
        Those of the solution from one of `mat`; from zero: what fulfils the constraints.
        """
    def NodeBlocks(self, nodes: numpy.typing.ArrayLike) -> tuple[numpy.typing.NDArray[numpy.int32], numpy.typing.NDArray[numpy.int32], numpy.typing.NDArray[numpy.float64]]:
        """
        The part of some nodes (m, k) of dofs, as starts, columns and entries of its blocks.
        -1 stands for no dof; what is not free is a row of the identity.
        """
    def Part(self, dofs: pyngcore.pyngcore.BitArray = None) -> ngsolve.la.BaseMatrix:
        """
        Sparse matrix of some dofs, numbered anew; of all with their own numbers by default.
        """
    def Project(self, z: typing.Annotated[numpy.typing.ArrayLike, numpy.float64]) -> numpy.typing.NDArray[numpy.float64]:
        """
        P z: the part of displacements that keeps the constraints.
        """
    def Reduce(self, rhs: typing.Annotated[numpy.typing.ArrayLike, numpy.float64], u: typing.Annotated[numpy.typing.ArrayLike, numpy.float64], image: typing.Annotated[numpy.typing.ArrayLike, numpy.float64]) -> numpy.typing.NDArray[numpy.float64]:
        """
        Right hand side of `mat`, with the bulk's forces of what fulfils the constraints.
        """
    def Test(self, f: typing.Annotated[numpy.typing.ArrayLike, numpy.float64]) -> numpy.typing.NDArray[numpy.float64]:
        """
        The part of forces that tests what keeps the constraints.
        """
    def __init__(self, mat: ngsolve.la.BaseMatrix, multipliers: collections.abc.Sequence[typing.SupportsInt | typing.SupportsIndex], dim: typing.SupportsInt | typing.SupportsIndex, freedofs: pyngcore.pyngcore.BitArray) -> None:
        ...
    @property
    def constraints(self) -> numpy.typing.NDArray[numpy.int32]:
        """
        (n,) int: eliminated directions of each macro-element
        """
    @property
    def freedofs(self) -> pyngcore.pyngcore.BitArray:
        """
        the free displacements
        """
    @property
    def diagonal(self) -> numpy.typing.NDArray[numpy.float64]:
        """
        (n,): of the sparse matrix
        """
    @property
    def has_symmetric_contact(self) -> bool:
        """
        as without slip
        """
class InnerElimination:
    """
    Exact elimination of `inner` dofs, which are coupled within elements only, from a real
    sparse matrix. Throws where they cannot be eliminated.
    """
    def Expand(self, rhs: typing.Annotated[numpy.typing.ArrayLike, numpy.float64], x: typing.Annotated[numpy.typing.ArrayLike, numpy.float64]) -> numpy.typing.NDArray[numpy.float64]:
        """
        Solution on all dofs from one of `mat`.
        """
    def Reduce(self, rhs: typing.Annotated[numpy.typing.ArrayLike, numpy.float64]) -> numpy.typing.NDArray[numpy.float64]:
        """
        Right hand side of `mat`, zero on inner dofs.
        """
    def __init__(self, mat: ngsolve.la.BaseMatrix, inner: pyngcore.pyngcore.BitArray) -> None:
        ...
    @property
    def mat(self) -> ngsolve.la.BaseMatrix:
        """
        Matrix of the other dofs; the inner ones have their diagonal alone.
        """
class SchurComplement:
    """
    C^T A^-1 C for sparse columns C, from a 'sparsecholesky' A = L D L^T.

    The columns are those of a scipy csc_matrix; throws where L^-1 C had more entries than L.
    """
    def Forward(self, rhs: typing.Annotated[numpy.typing.ArrayLike, numpy.float64]) -> numpy.typing.NDArray[numpy.float64]:
        """
        y = L^-1 rhs, in the order of elimination.
        """
    def Solve(self, y: typing.Annotated[numpy.typing.ArrayLike, numpy.float64], x: typing.Annotated[numpy.typing.ArrayLike, numpy.float64]) -> numpy.typing.NDArray[numpy.float64]:
        """
        A^-1 (rhs - C x) from y = L^-1 rhs.
        """
    def Trace(self, y: typing.Annotated[numpy.typing.ArrayLike, numpy.float64]) -> numpy.typing.NDArray[numpy.float64]:
        """
        C^T A^-1 rhs from y = L^-1 rhs.
        """
    def __init__(self, inverse: ngsolve.la.BaseMatrix, starts: typing.Annotated[numpy.typing.ArrayLike, numpy.uint64], rows: typing.Annotated[numpy.typing.ArrayLike, numpy.int32], values: typing.Annotated[numpy.typing.ArrayLike, numpy.float64]) -> None:
        ...
    @property
    def complement(self) -> numpy.typing.NDArray[numpy.float64]:
        """
        (m, m): C^T A^-1 C
        """
class StarSweeps:
    """
    Sweeps on some scalar dofs, by overlapping `stars` of dofs with `dim` entries each, all of
    which are solved for at once.
    """
    def Update(self, system: Condensation) -> None:
        """
        Takes over a system with the same bulk.
        """
    def __init__(self, system: Condensation, dofs: pyngcore.pyngcore.BitArray, stars: pyngcore.pyngcore.Table_I, dim: typing.SupportsInt | typing.SupportsIndex) -> None:
        ...
class TwoLevel(ngsolve.la.BaseMatrix):
    """
    Preconditioner: a sweep forward, a correction, a sweep backward. The correction is by the
    operator `coarse`, on a space whose functions are the columns of a sparse matrix: the rows
    (starts, columns, values) belong to the free `dofs`, and others are empty.
    """
    def __init__(self, system: Condensation, sweeps: StarSweeps, coarse: ngsolve.la.BaseMatrix, dofs: numpy.typing.ArrayLike, starts: numpy.typing.ArrayLike, columns: numpy.typing.ArrayLike, values: numpy.typing.ArrayLike) -> None:
        ...
class PreconditionedProduct:
    """
    Products with a matrix A after a preconditioner M.
    """
    def Apply(self, x: ngsolve.la.BaseVector, z: ngsolve.la.BaseVector, image: ngsolve.la.BaseVector) -> None:
        """
        z = M^-1 x and image = A z.
        """
    @typing.overload
    def __init__(self, mat: ngsolve.la.BaseMatrix, inverse: ngsolve.la.BaseMatrix | None = None) -> None:
        ...
    @typing.overload
    def __init__(self, size: typing.SupportsInt | typing.SupportsIndex, apply: collections.abc.Callable, total: collections.abc.Callable) -> None:
        """
        apply(x, z, image) fills arrays: z = M^-1 x and image = A z. Where processes have parts
        of the vectors, total(numbers) sums up arrays over all of them.
        """
class TwoLevelProduct(PreconditionedProduct):
    """
    On the free dofs for a preconditioner M of A itself, to single precision.
    """
    def __init__(self, preconditioner: TwoLevel, system: Condensation) -> None:
        ...
def BoundaryVertices(mesh: ngsolve.comp.Mesh) -> numpy.typing.NDArray[numpy.int32]:
    """
    Vertices (n, 4) of the boundary elements of a mesh, -1 behind the last of each.
    """
def DofFingerprint(fes: ngsolve.comp.FESpace) -> int:
    """
    A number that differs for spaces that number the dofs of their elements in different ways.
    """
def ElementDofs(fes: ngsolve.comp.FESpace) -> tuple:
    """
    How many dofs each volume element has, and these one after the other; negative: none.
    """
def FormDiagonal(form: ngsolve.comp.BilinearForm, wanted: pyngcore.pyngcore.BitArray) -> numpy.typing.NDArray[numpy.float64]:
    """
    Diagonal (n,) of the elements of a form that hold one of the wanted dofs.
    """
def HoldsGridFunction(function: ngsolve.fem.CoefficientFunction) -> bool:
    """
    Does a function hold a GridFunction?
    """
def PieceOf(mesh: ngsolve.comp.Mesh) -> tuple:
    """
    What this process has of a distributed mesh, as seven tables
    """
def ProxyPath(proxy: ngsolve.fem.CoefficientFunction, name: str) -> list[int]:
    """
    Numbers of components that lead from a product space to that of a trial function.
    """
def Unmatched(mesh: ngsolve.comp.Mesh, vb: ngsolve.comp.VorB, pattern: str) -> collections.abc.Sequence[str]:
    """
    Of the alternatives of a pattern those that match no name
    """
def WholeMesh(empty: ngsolve.comp.Mesh, parts: tuple) -> ngsolve.comp.Mesh:
    """
    The mesh of all pieces, whose tables are stacked, on a process that has no elements
    """
def EquilibrationScale(bulk: ngsolve.la.BaseMatrix, contacts: collections.abc.Sequence[ContactForm]) -> numpy.typing.NDArray[numpy.float64]:
    ...
def FacetCorners(arg0: ngsolve.comp.Region, arg1: typing.SupportsInt | typing.SupportsIndex) -> list[float]:
    ...
def GMRes(product: PreconditionedProduct, rhs: ngsolve.la.BaseVector, freedofs: pyngcore.pyngcore.BitArray, tol: typing.SupportsFloat | typing.SupportsIndex, maxiter: typing.SupportsInt | typing.SupportsIndex, patience: typing.SupportsInt | typing.SupportsIndex = 0) -> tuple[ngsolve.la.BaseVector, numpy.typing.NDArray[numpy.float64], bool]:
    """
    GMRES from zero without restart, preconditioned from the right: solution of least residual,
    norms of the residuals before the first product and after each, and whether the last is at
    most `tol` times the first. Ends where `patience` products, if not 0, did not halve it.
    The preconditioner may be of any precision: flexible GMRES.
    """
def HoldsProxy(function: ngsolve.fem.CoefficientFunction) -> bool:
    """
    Does a function hold a trial or test function, which has no values?
    """
def IsAssembled(form: ngsolve.comp.LinearForm) -> bool:
    """
    Was a LinearForm ever assembled?
    """
def MergeMatrices(bulk: ngsolve.la.BaseMatrix, contacts: collections.abc.Sequence[ContactForm | ngsolve.la.BaseMatrix], scale: typing.Annotated[numpy.typing.ArrayLike, numpy.float64], former: ngsolve.la.BaseMatrix = None) -> ngsolve.la.BaseMatrix:
    """
    diag(scale) (bulk + contacts) diag(scale). Of `former`, merged from the same bulk with the
    same scale, only rows with contact are written anew, where the graph is the same.
    """
def PlacementOf(arg0: collections.abc.Sequence[ToolMotion], arg1: typing.SupportsInt | typing.SupportsIndex) -> list[float]:
    ...
def PolygonDifference(p: collections.abc.Sequence[typing.Annotated[collections.abc.Sequence[typing.SupportsFloat | typing.SupportsIndex], "FixedSize(2)"]], q: collections.abc.Sequence[typing.Annotated[collections.abc.Sequence[typing.SupportsFloat | typing.SupportsIndex], "FixedSize(2)"]], tolerance: typing.SupportsFloat | typing.SupportsIndex) -> list[list[typing.Annotated[list[float], "FixedSize(2)"]]]:
    ...
def PolygonIntersection(p: collections.abc.Sequence[typing.Annotated[collections.abc.Sequence[typing.SupportsFloat | typing.SupportsIndex], "FixedSize(2)"]], q: collections.abc.Sequence[typing.Annotated[collections.abc.Sequence[typing.SupportsFloat | typing.SupportsIndex], "FixedSize(2)"]], tolerance: typing.SupportsFloat | typing.SupportsIndex) -> list[typing.Annotated[list[float], "FixedSize(2)"]]:
    ...
def PolygonOverlap(p: collections.abc.Sequence[typing.Annotated[collections.abc.Sequence[typing.SupportsFloat | typing.SupportsIndex], "FixedSize(2)"]], q: collections.abc.Sequence[typing.Annotated[collections.abc.Sequence[typing.SupportsFloat | typing.SupportsIndex], "FixedSize(2)"]], tolerance: typing.SupportsFloat | typing.SupportsIndex) -> bool:
    ...
def NamesInstead(mesh: ngsolve.comp.Mesh, vb: ngsolve.comp.VorB, pattern: str) -> str:
    """
    The names that there are, the closest one, and what is special in patterns, for messages
    """
def RegionWithFaces(mesh: ngsolve.comp.Mesh, name: str, given: typing.Any, any: bool = False) -> ngsolve.comp.Region:
    """
    The boundary region that a pattern or a Region stands for; raises where it has no faces. any: a Region may be of any dimension
    """
def SplitSlaveFaces(mesh: ngsolve.comp.Mesh, slave: ngsolve.comp.Region, hexes: str = 'pyramids') -> ngsolve.comp.Mesh:
    """
    New mesh with the slave faces split; see ngslac.SplitSlaveFaces
    """
def VertexDofs(fes: ngsolve.comp.FESpace) -> numpy.typing.NDArray[numpy.int32]:
    """
    Dofs (nv, k) of a space on each vertex of the mesh, -1 behind the last.
    """
