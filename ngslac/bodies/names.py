# SPDX-License-Identifier: LGPL-2.1-or-later
"""Names of bodies in messages."""

import numpy as np
from ngsolve import CoefficientFunction, FESpace, GridFunction, InnerProduct, Integrate, x, y, z

from ngslac.arguments import ShownPoint
from ngslac.arrays import AsNumPy
from ngslac.bodies.rigidmotions import DofsOfMaterials
from ngslac.parallel.layout import LayoutOf

__all__ = ["BodyNames"]


class BodyNames:
    """Names of the connected parts of a displacement space."""

    def __init__(self, space: FESpace, part: np.ndarray, used: np.ndarray, motions: np.ndarray):
        self.space, self.part, self.used, self.motions = space, part, used, motions
        self.block, self.together = space.dim, LayoutOf(space).together
        self.materials = np.array(space.mesh.GetMaterials())

    def __call__(self, part: int) -> str:
        """The material, and of several bodies of one material also number and middle of this."""
        name = self.Material(part)
        alike = self._Alike(name)
        if len(alike) == 1:
            return f"'{name}'"
        number = f"{alike.index(part) + 1} of {len(alike)}, " if part in alike else ""
        return f"'{name}' ({number}around {ShownPoint(self.Middle(part))})"

    def Material(self, part: int) -> str:
        """The first material of a body."""
        inside = np.zeros(self.space.ndof, dtype=bool)
        inside[np.flatnonzero((self.part == part) & self.used) // self.block] = True
        for name in dict.fromkeys(self.materials):
            if self.together.Reduce(np.any(inside & self._Dofs(name)), "LOR"):
                return str(name)
        return "?"

    def _Dofs(self, name: str) -> np.ndarray:
        return AsNumPy(DofsOfMaterials(self.space, self.materials == name))

    def _Alike(self, name: str) -> list[int]:
        """The bodies of a material, in the order of the mesh."""
        own = self._Dofs(name).repeat(self.block) & self.used
        found = [list(dict.fromkeys(self.part[own].tolist()))]
        if self.together.size > 1:  # parts have the order of the mesh there
            found = [sorted({part for some in self.together.Gather(found[0]) for part in some})]
        return found[0]

    def Middle(self, part: int) -> tuple[float, ...]:
        """The middle of a body in the reference configuration, as a tuple."""
        mesh = self.space.mesh
        shift = GridFunction(self.space)  # is a translation on this body and 0 on others
        inside, components = np.flatnonzero(self.part == part), shift.dim
        shift.vec.FV().NumPy()[inside] = self.motions[inside, :components].sum(axis=1)
        one = InnerProduct(shift, CoefficientFunction((1,) * components))
        moments = Integrate(CoefficientFunction((x * one, y * one, z * one, one)), mesh)
        return tuple(moments[k] / moments[3] for k in range(mesh.dim))
