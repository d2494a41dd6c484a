# SPDX-License-Identifier: LGPL-2.1-or-later
"""Modification of meshes for Local Average Contact."""

import ngsolve
from ngsolve import Mesh, Region

from ngslac import _ngslac
from ngslac.arguments import CheckChoice, CheckInstance

__all__ = ["SplitSlaveFaces"]


def SplitSlaveFaces(mesh: Mesh, slave: Region | str, *, hexes: str = "pyramids") -> Mesh:
    """Split the slave faces of a mesh, and only the volume elements on them.

    Local Average Contact is stable if every macro-element of the slave boundary contains the
    support of a displacement basis function. A face of a lowest order mesh contains none. After the
    split each former face does: it is a macro-element with vertices of its own inside. Order 2 and
    higher needs no split in 2D; in 3D order 2 on quadrilaterals and order 3 on triangles need none.
    `BubbleVectorH1` reaches the same without a change of the mesh.

    Parameters
    ----------
    mesh : ngsolve.Mesh
        A mesh of triangles and quadrilaterals in 2D, of tetrahedra, pyramids, prisms and hexahedra
        in 3D. It is not changed.
    slave : str or ngsolve.Region
        The slave boundary: a pattern of boundary names, or a boundary region of `mesh`.
    hexes : {"pyramids", "hexes"}
        What a hexahedron with a slave face becomes, see below. Without effect on other elements.

    Returns
    -------
    ngsolve.Mesh
        A new mesh on the same geometry with the same names. It is curved to the same order; the new
        vertices lie on the geometry, unless the slave vertices of `mesh` do not. Refinement history
        and deformation are not taken over.

    Raises
    ------
    ValueError
        If no boundary of the mesh matches `slave`, it is a region of another mesh or of another
        dimension than boundaries, or `hexes` is unknown.
    TypeError
        If `mesh` is no mesh, or `slave` neither a pattern nor a region.
    NgException
        If the mesh has elements of second order, or is so coarse that its curved boundary would
        fold an element over.

    Notes
    -----
    **2D.** The edge of a triangle is halved, and so is the triangle. The edge of a quadrilateral is
    cut into three, and the quadrilateral into four around two new vertices at half its depth:
    halving a single edge would leave no division into quadrilaterals. An edge between two materials
    is split for both; a triangle there follows a quadrilateral on the other side. An element with
    several slave edges is split once for each, its longest edge first.

    **3D.** The slave face gets a vertex at its barycentre; its edges stay as they are. The volume
    element becomes the cones from this vertex over its other faces:

    =========================  =============  =====================================
    element, slave face        the face       the element
    =========================  =============  =====================================
    tetrahedron                3 triangles    3 tetrahedra
    pyramid, base              4 triangles    4 tetrahedra
    pyramid, triangle          3 triangles    3 tetrahedra, 1 pyramid
    prism, triangle            3 triangles    1 tetrahedron, 3 pyramids
    prism, quadrilateral       4 triangles    2 tetrahedra, 2 pyramids
    hexahedron                 4 triangles    5 pyramids
    hexahedron, ``"hexes"``    5 quads        6 hexahedra
    =========================  =============  =====================================

    With ``hexes="hexes"`` the slave face carries a smaller quadrilateral, a third as wide, and four
    others around it, the hexahedron below them four more vertices at half of its depth. A face
    between a hexahedron and another element gets triangles all the same. A piece with another slave
    face is split in turn, the largest face first. The angles of the pieces are smaller than those
    of the element: 15 degrees are usual between the faces of tetrahedra. On a curved boundary curve
    the mesh as well: the new vertices alone would stand out like tips.

    Stable as they are, the cones of prisms over a triangle have a low inf-sup constant, 0.23 for
    prisms as high as wide (tetrahedra 0.30, hexahedra 0.38 with ``"pyramids"`` and 0.61 with
    ``"hexes"``, all on structured bricks): `BubbleVectorH1` is the better choice there.

    The first part of a boundary element keeps its number, the others are appended, one slave
    element after the other. `LACSpace` finds the former faces of order 1 by itself, apart from
    those of ``"hexes"``; for these, and for order 2 on triangles, where it takes smaller
    macro-elements, it can be given them.

    These are the patterns of the option ``DECOUPE_LAC`` of code_aster's ``CREA_MAILLAGE``. The
    condition on the macro-elements and the change of the mesh are those of M. Abbas, G. Drouet, P.
    Hild and N. Pignet, *Une méthode éléments finis "Local Average Contact" pour le frottement*, 13e
    Colloque national en calcul des structures, Giens (2017), hal-01899341; the cones in 3D those of
    M. Abbas, G. Drouet and P. Hild, *The local average contact (LAC) method*, Computer Methods in
    Applied Mechanics and Engineering 339 (2018).

    Examples
    --------
    >>> from netgen.occ import Circle, OCCGeometry
    >>> from ngsolve import BND, Mesh, VectorH1
    >>> from ngsolve.meshes import MakeStructured3DMesh
    >>> from ngslac import LACSpace, SplitSlaveFaces
    >>> disk = Circle((0, 0), 1).Face()
    >>> disk.edges.name = "rim"
    >>> mesh = Mesh(OCCGeometry(disk, dim=2).GenerateMesh(maxh=0.5)).Curve(2)
    >>> split = SplitSlaveFaces(mesh, "rim")
    >>> split.GetNE(BND) == 2 * mesh.GetNE(BND)
    True

    A brick of eight hexahedra, and one multiplier for each of the four faces on its top:

    >>> brick = MakeStructured3DMesh(hexes=True, nx=2, ny=2, nz=2)
    >>> SplitSlaveFaces(brick, "top").ne, SplitSlaveFaces(brick, "top", hexes="hexes").ne
    (24, 28)
    >>> split = SplitSlaveFaces(brick, "top")
    >>> LACSpace(VectorH1(split, order=1), slave="top").nmacros
    4
    >>> former = [0, 1, 2, 3] + [i // 3 for i in range(12)]
    >>> LACSpace(VectorH1(split, order=2), slave="top", macros=former).nmacros
    4
    """
    CheckInstance("mesh", mesh, ngsolve.Mesh, "an ngsolve.Mesh")
    CheckChoice("hexes", hexes, ("pyramids", "hexes"))
    region = _ngslac.RegionWithFaces(mesh, "slave", slave)
    return _ngslac.SplitSlaveFaces(mesh, region, hexes)
