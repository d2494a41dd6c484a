"""Modification of meshes for Local Average Contact."""

import ngsolve

from . import _ngslac

__all__ = ["SplitSlaveFaces"]


def SplitSlaveFaces(mesh, slave):
    """Split the slave faces of a mesh, and only the volume elements on them.

    Local Average Contact is stable if every macro-element of the slave boundary contains the
    support of a displacement basis function. A face of a lowest order mesh contains none. After the
    split each former face does: it is a macro-element with vertices of its own inside. Order 2 and
    higher needs no split in 2D, and `BubbleVectorH1` reaches the same without a change of the mesh.

    Parameters
    ----------
    mesh : ngsolve.Mesh
        A two-dimensional mesh of triangles, quadrilaterals or both. It is not changed.
    slave : str or ngsolve.Region
        The slave boundary: a pattern of boundary names, or a boundary region of `mesh`.

    Returns
    -------
    ngsolve.Mesh
        A new mesh on the same geometry with the same names. It is curved to the same order; the new
        vertices lie on the geometry. Refinement history and deformation are not taken over.

    Raises
    ------
    ValueError
        If no boundary of the mesh matches `slave`.
    NgException
        If the mesh is three-dimensional, or so coarse that its curved boundary would fold an
        element over.

    Notes
    -----
    The edge of a triangle is halved, and so is the triangle. The edge of a quadrilateral is cut
    into three, and the quadrilateral into four around two new vertices at half its depth: halving a
    single edge would leave no division into quadrilaterals. These are the patterns of the option
    ``DECOUPE_LAC`` of code_aster's ``CREA_MAILLAGE``. An edge between two materials is split for
    both; a triangle there follows a quadrilateral on the other side. An element with several slave
    edges is split once for each, its longest edge first.

    The condition on the macro-elements and the change of the mesh are those of M. Abbas, G. Drouet,
    P. Hild and N. Pignet, *Une méthode éléments finis "Local Average Contact" pour le frottement*,
    13e Colloque national en calcul des structures, Giens (2017), hal-01899341.

    Examples
    --------
    >>> from netgen.occ import Circle, OCCGeometry
    >>> from ngsolve import BND, Mesh
    >>> from ngslac import SplitSlaveFaces
    >>> disk = Circle((0, 0), 1).Face()
    >>> disk.edges.name = "rim"
    >>> mesh = Mesh(OCCGeometry(disk, dim=2).GenerateMesh(maxh=0.5)).Curve(2)
    >>> split = SplitSlaveFaces(mesh, "rim")
    >>> split.GetNE(BND) == 2 * mesh.GetNE(BND)
    True
    """
    if not isinstance(mesh, ngsolve.Mesh):
        raise TypeError(f"SplitSlaveFaces needs an ngsolve.Mesh, not {type(mesh).__name__}")
    if isinstance(slave, str):
        pattern, slave = f"the pattern {slave!r}", mesh.Boundaries(slave)
    elif isinstance(slave, ngsolve.Region):
        pattern = "the given region"
    else:
        raise TypeError(f"slave must be a pattern or a Region, not {type(slave).__name__}")
    if mesh.dim < 3 and not any(slave.Mask()):
        names = ", ".join(repr(name) for name in dict.fromkeys(mesh.GetBoundaries()))
        raise ValueError(f"SplitSlaveFaces: {pattern} matches no boundary; there are {names}")
    return _ngslac.SplitSlaveFaces(mesh, slave)
