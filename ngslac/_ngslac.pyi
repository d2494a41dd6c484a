# SPDX-License-Identifier: LGPL-2.1-or-later
from collections.abc import Sequence
from typing import Any

import ngsolve.comp
from pyngcore.pyngcore import Array_I_S

def __getattr__(name: str) -> Any: ...  # internal

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
    axisymmetric : bool
        The mesh in 2D is half of a section through bodies of revolution, x the distance from the axis,
        y along it. Means, areas and forces are those of the whole circumference, so that the bulk form
        has the factor ``2*pi*x``, as `AxisymmetricGrad` shows.

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
    def CoreDofs(self, macro: int) -> Array_I_S:
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
    def WithComponents(self, components: int) -> LACSpace:
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
    def __init__(
        self,
        V: ngsolve.comp.FESpace,
        *,
        slave: ngsolve.comp.Region | str,
        macros: Sequence[int] | None = None,
        components: int | None = None,
        autoupdate: bool = False,
        axisymmetric: bool = False,
    ) -> None: ...
    @property
    def axisymmetric(self) -> bool:
        """Are areas those of the whole circumference about the axis x = 0?"""
    @property
    def displacement(self) -> ngsolve.comp.FESpace:
        """The displacement space (FESpace) that the macro-elements are made for."""
    @property
    def macros(self) -> Array_I_S:
        """Macro-element of each boundary element of the mesh, -1 off the slave surface."""
    @property
    def nmacros(self) -> int:
        """Number of macro-elements."""
    @property
    def number(self) -> int:
        """Of its replica where the mesh is distributed, else -1."""
    @property
    def slave(self) -> ngsolve.comp.Region:
        """The slave surface (Region)."""

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

    Keyword arguments are those of VectorH1, and

    slave: regexpr or Region
      Boundaries whose faces get a bubble, i.e.: slave = 'left|right'
    """
    def __init__(self, mesh: ngsolve.comp.Mesh, **kwargs) -> None: ...
