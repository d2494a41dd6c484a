# SPDX-License-Identifier: LGPL-2.1-or-later
"""Elements that a deformation turns inside out."""

import numpy as np
from ngsolve import (
    VOL,
    BilinearForm,
    CoefficientFunction,
    Det,
    ElementId,
    FESpace,
    Grad,
    GridFunction,
    Id,
    IfPos,
    Integrate,
    Mesh,
    x,
    y,
    z,
)

from ngslac._ngslac import ContactForm, PieceOf
from ngslac.arguments import ShownPoint
from ngslac.arrays import AsNumPy
from ngslac.bodies.rigidmotions import DofsOfMaterials
from ngslac.errors import ContactConvergenceError
from ngslac.parallel.extent import ExtentOf
from ngslac.parallel.layout import LayoutOf

__all__ = ["InvertedError", "InvertedMessage", "TurningMaterials"]

# Relative difference of forces that is rounding; a rotation, and strains that are not small.
ROUNDING = 1e-8
ANGLE, STRAIN = 0.5, 0.1


class InvertedError(ContactConvergenceError):
    """Newton's method converged to a state with elements turned inside out."""


def InvertedMessage(
    form: ContactForm, gf: GridFunction, materials: np.ndarray | None = None
) -> str:
    """Which elements the displacement of a compiled contact form turns inside out; "" if none."""
    space, mesh = form.component, form.fes.mesh
    u, first = GridFunction(space), form.offset * form.fes.dim
    values, together = LayoutOf(space).Values(u.vec), LayoutOf(space).together
    values[:] = gf.vec.FV().NumPy()[first : first + len(values)]
    looked = 1 if materials is None else CoefficientFunction(list(map(float, materials)))
    folded = IfPos(Det(Id(mesh.dim) + Grad(u)), 0, looked)
    shares = Integrate(folded, mesh, order=2 * space.globalorder, element_wise=True)
    numbers = np.flatnonzero(np.asarray(shares.NumPy()) > 0)
    found = [first for first in together.Gather(First(mesh, numbers)) if first]
    if not found:
        return ""
    count = together.Sum(len(numbers))
    words = f"{count} elements turn" if count > 1 else "an element turns"
    return f"{words} inside out (det F <= 0), the first {min(found)[1]}"


def First(mesh: Mesh, numbers: np.ndarray) -> tuple[int, str] | None:
    """Of some elements here the first one: its number among all, and where it is; or None."""
    if not len(numbers):
        return None
    first = int(numbers[0])
    if mesh.comm.size > 1:
        table = np.array(PieceOf(mesh)[2 if mesh.dim == 3 else 3])[:, 0]
        first = int(numbers[np.argmin(table[numbers])])
    element = mesh[ElementId(VOL, first)]
    corners = [mesh[v].point for v in element.vertices]
    place = f"in '{element.mat}' at {ShownPoint(np.mean(corners, axis=0))}"
    return (int(table[first]) if mesh.comm.size > 1 else first), place


def TurningMaterials(a: BilinearForm, form: ContactForm, gf: GridFunction) -> np.ndarray:
    """Materials of which the bulk form knows finite rotations: they turn the forces with them.

    Where they do, as in linear elasticity, the determinant of the deformation means nothing.
    """
    space, mesh = form.component, form.fes.mesh
    bent, turned = Bent(space)
    none, there, back, rotated = (
        Forces(a, form, gf, values) for values in (0 * bent, bent, -bent, turned)
    )
    count, materials = len(mesh.GetMaterials()), []
    for k in range(count):
        others = DofsOfMaterials(space, np.arange(count) != k)
        others |= space.GetDofs(mesh.Boundaries(".*"))  # where springs or pressures may act
        inside = AsNumPy(DofsOfMaterials(space, np.arange(count) == k)).repeat(form.fes.dim)
        layout, apart = LayoutOf(space), AsNumPy(others).repeat(form.fes.dim)
        own = layout.Everywhere(inside) & ~layout.Everywhere(apart)
        sizes = [np.linalg.norm((forces - none)[own]) for forces in (there, rotated)]
        curved = np.linalg.norm((there + back - 2 * none)[own])
        finite = ROUNDING * sizes[0] < curved < np.inf
        materials.append(finite and abs(sizes[1] - sizes[0]) <= ROUNDING * sizes[0])
    return np.array(materials)


def Bent(space: FESpace) -> tuple[np.ndarray, np.ndarray]:
    """Coefficients of a displacement with strains, and of the same that is then turned."""
    d, extent = space.mesh.dim, ExtentOf(space.mesh)
    middle, size = extent.center, extent.size
    arms = [c - m for c, m in zip((x, y, z), middle, strict=False)]
    u, turned = GridFunction(space), GridFunction(space)
    bend = STRAIN / size * arms[0] * arms[1]
    u.Set(CoefficientFunction((bend, -STRAIN / size * arms[0] ** 2, bend)[:d]), VOL)
    c, s = np.cos(ANGLE), np.sin(ANGLE)
    now = [arm + u[k] for k, arm in enumerate(arms)]
    now[:2] = c * now[0] - s * now[1], s * now[0] + c * now[1]
    turned.Set(CoefficientFunction(tuple(a - b for a, b in zip(now, arms, strict=True))), VOL)
    Values = LayoutOf(space).Values
    return Values(u.vec).copy(), Values(turned.vec).copy()


def Forces(
    a: BilinearForm, form: ContactForm, gf: GridFunction, displacement: np.ndarray
) -> np.ndarray:
    """What the bulk form says of a displacement (n,)."""
    vec, forces = gf.vec.CreateVector(), gf.vec.CreateVector()
    own = slice(first := form.offset * form.fes.dim, first + len(displacement))
    vec.data = gf.vec
    vec.FV().NumPy()[own] = displacement
    layout = LayoutOf(form.fes)
    layout.Apply(a, vec, forces)
    return layout.Values(forces)[own].copy()
