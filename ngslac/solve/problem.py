# SPDX-License-Identifier: LGPL-2.1-or-later
"""The parts of a problem as users hand them to a solver, checked."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from itertools import combinations
from typing import TYPE_CHECKING

import numpy as np
import scipy
from netgen.meshing import NgException
from ngsolve import (
    BND,
    CF,
    ET,
    BaseMatrix,
    BaseVector,
    BilinearForm,
    BitArray,
    FESpace,
    GridFunction,
    Integrate,
    IntegrationRule,
    Region,
    x,
)
from ngsolve.la import SparseMatrixd

from ngslac.arguments import BoundaryNames, CheckInstance, CheckNumber, CheckOnSpace, Shown, Wrong
from ngslac.arrays import AsNumPy, Multiply, ToCSR
from ngslac.bodies.rigidmotions import DofsOfMaterials, RigidMotions
from ngslac.contact.contact import LACContact
from ngslac.errors import ContactConvergenceError, Warn
from ngslac.parallel.extent import ExtentOf
from ngslac.parallel.layout import Layout, LayoutOf, Whole

if TYPE_CHECKING:
    from ngslac._ngslac import ContactForm

__all__ = [
    "AssembleBulk",
    "CheckAxis",
    "CheckBodies",
    "CheckBulk",
    "CheckContacts",
    "CheckFreeDofs",
    "CheckInverse",
    "CheckMatrix",
    "CheckMotion",
    "CheckSlaves",
    "CheckStart",
    "CheckTolerance",
    "MultiplierRows",
    "ScalarFields",
    "UnheldFields",
]

# Forces against a shift off the axis, relative to those against a shear: less are none.
RESISTS = 1e-13
# Stiffness against a strain in one direction over that against shear, of usual materials.
STIFFER = 3.5
# What a constant of a scalar field meets, relative to the size of what it does: less is nothing.
UNHELD = 1e-10
# Distance from the axis over the farthest one: less is none.
AXIS = 1e-9
# By what factor the resistance differs from that of hoop strains where it may be one.
ALIKE = 5.0
# Differences of ratios of energies that are one, and two.
SAME, DIFFERENT = 0.01, 0.03
# Flags of a BilinearForm that leave no matrix, or not enough of it, with what to do instead.
REFUSED = {
    "nonassemble": "it has no matrix then",
    "diagonal": "it keeps the diagonal of the matrix alone",
    "geom_free": "it has no assembled matrix then",
    "symmetric_storage": "it keeps one triangle only, which several solvers read as a full matrix",
}


def CheckBulk(a: BilinearForm) -> BilinearForm:
    """A bulk form whose matrix can be assembled, merged with that of contact, and solved."""
    CheckInstance("a", a, BilinearForm, "the bulk as a BilinearForm on the product space")
    if a.space.is_complex:
        raise ValueError("a lives on a complex space: contact needs a real one")
    flags = a.flags.ToDict()
    for flag, why in REFUSED.items():
        if flags.get(flag):
            raise ValueError(f"a has the flag {flag}=True: {why}; make the BilinearForm without")
    if flags.get("keep_internal", True) is False:
        raise ValueError(
            "a has the flag keep_internal=False: inner displacements cannot be recovered then; "
            "make it without, condense=True is enough"
        )
    return a


def CheckContacts(
    contacts: LACContact | Iterable[LACContact],
    space: FESpace,
    gf: GridFunction | None = None,
    name: str = "contacts",
) -> list[LACContact]:
    """One contact or several as a list of contacts on one space, each with a lam of its own.

    `gf` is the solution, which tells whether a contact or the bulk form is on another space.
    """
    several = isinstance(contacts, Iterable) and not isinstance(contacts, (str, bytes))
    found, moved = {}, set()
    for contact in contacts if several else [contacts]:
        CheckInstance(name, contact, LACContact, "a LACContact, or a list of them")
        if contact.form.fes != space:
            if isinstance(gf, GridFunction) and gf.space == contact.form.fes:
                raise ValueError(
                    f"a, the bulk form, lives on another space than u and lam, with {space.ndof} "
                    f"dofs in place of {gf.space.ndof}: take BilinearForm(X) of their product "
                    "space X"
                )
            raise ValueError(
                f"{name}: a, gf and the contacts must live on the same product space X: take u and "
                "lam of LACContact, BilinearForm(X) and GridFunction(X) from one X"
            )
        if contact.form.lamoffset in found:  # before the next: an endless iterable repeats itself
            raise ValueError(f"{name}: two contacts share one lam: give each a LACSpace of its own")
        if contact.form.offset != next(iter(found.values()), contact).form.offset:
            raise ValueError(
                f"{name}: two contacts have different fields u, such as a displacement and a "
                "temperature: give contacts of one; heat flows through that of a displacement "
                "with flux="
            )
        tools = {*contact.form.ToolDofs()}
        if moved & tools:
            raise ValueError(
                f"{name}: two contacts have tools with the same unknown travel, whose loads would "
                "count twice: give all that a driven tool touches to one LACSpace"
            )
        moved |= tools
        found[contact.form.lamoffset] = contact
    if not found:
        raise ValueError(f"{name} = {Shown(contacts)} is empty: give at least one LACContact")
    return list(found.values())


SIDES = "give one contact both sides, as in master='one|other', make one of them the master"
OBSTACLES = (
    "unite obstacles that move alike, as in one | other, or give each a part of the boundary with "
    "a name of its own"
)


def CheckSlaves(contacts: Sequence[LACContact]) -> None:
    """No two contacts that are on press one slave face on one surface: which one is not told."""
    for one, other in combinations([contact for contact in contacts if contact.active], 2):
        both = one.space.slave * other.space.slave
        if HasFaces(both) and not AreApart(one, other):
            meshed = one.master is not None and other.master is not None
            remedy = SIDES if meshed else OBSTACLES
            raise ValueError(
                f"contacts: two of them have the slave {BoundaryNames(both)!r}: the system would "
                f"be singular where both are closed: {remedy}, or Deactivate one of them"
            )


def HasFaces(region: Region) -> bool:
    """Is there an element in a region?"""
    return next(iter(region.Elements()), None) is not None


def AreApart(one: LACContact, other: LACContact) -> bool:
    """Have two contacts masters without a common face?"""
    if one.master is None or other.master is None:
        return False
    return not HasFaces(one.master * other.master)


def CheckStart(gf: GridFunction, space: FESpace) -> GridFunction:
    """A solution on the product space with finite values."""
    CheckOnSpace("gf", gf, space)
    if not np.isfinite(LayoutOf(space).Values(gf.vec)).all():
        raise ValueError("the start value gf holds NaN or infinite values: set all of it")
    return gf


def CheckFreeDofs(
    freedofs: BitArray | None, space: FESpace, contacts: Sequence[LACContact]
) -> BitArray | None:
    """A BitArray with one bit for each dof of the space; those free by default for None.

    Multipliers that are not free would let the surfaces pass through each other.
    """
    if freedofs is None:
        return freedofs
    CheckInstance("freedofs", freedofs, BitArray, "a BitArray such as X.FreeDofs(), or None")
    if len(freedofs) != space.ndof:
        raise ValueError(
            f"freedofs has {len(freedofs)} bits, the product space {space.ndof} dofs: take a copy "
            "of X.FreeDofs()"
        )
    if not LayoutOf(space).together.Sum(freedofs.NumSet()):
        raise ValueError("freedofs has no bit set: nothing is free to move; take X.FreeDofs()")
    held = AsNumPy(space.FreeDofs()) & ~AsNumPy(freedofs)
    for form in (contact.form for contact in contacts):
        if np.any(held[form.lamoffset : form.lamoffset + form.space.ndof]):
            raise ValueError(
                "freedofs takes dofs of lam away, which contact needs: clear those of displacements"
            )
    return freedofs


def CheckInverse(inverse: str | None) -> str | None:
    """The name of a sparse direct solver that is there: it has to solve one equation."""
    if inverse is None:
        return None
    CheckInstance("inverse", inverse, str, "the name of a sparse direct solver, such as 'umfpack'")
    one = SparseMatrixd.CreateFromCOO([0], [0], [1.0], 1, 1)
    try:
        if not inverse:
            raise ValueError("the name is empty")
        one.Inverse(inverse=inverse)
    except Exception as error:
        raise ValueError(
            f"inverse={inverse!r} is not available ({error}): 'umfpack' and 'sparsecholesky' "
            "always are, 'pardiso' with MKL; None takes the fastest"
        ) from error
    return inverse


# --- a solve -------------------------------------------------------------------------------------


def CheckTolerance(tol: float) -> float:
    """A relative tolerance: below 1, where the start would do."""
    return CheckNumber("tol", tol, "a number > 0 and < 1, such as 1e-10", lambda x: 0 < x < 1)


def CheckMotion(motion: np.ndarray | None, constrained: np.ndarray) -> np.ndarray | None:
    """How far constrained dofs move, as array of finite numbers; None where they do not."""
    if motion is None:
        return None
    wanted = f"an array of {len(constrained)} finite numbers, one for each scalar dof, or None"
    if not isinstance(motion, np.ndarray) or motion.dtype.kind not in "fiu":
        raise Wrong(TypeError, "motion", motion, wanted)
    if motion.shape != constrained.shape or not np.isfinite(motion).all():
        raise Wrong(ValueError, "motion", motion, wanted)
    return motion


# --- multipliers ---------------------------------------------------------------------------------


def MultiplierRows(contacts: Sequence[LACContact]) -> np.ndarray:
    """The scalar dofs of the multipliers of all contacts as (n,) bool."""
    rows = contacts[0].layout.Of(np.zeros(contacts[0].nscalars, dtype=bool))
    for form in (contact.form for contact in contacts):
        first = form.lamoffset * form.fes.dim
        rows[first : first + form.space.ndof * form.fes.dim] = True
    return rows


def ScalarFields(contacts: Sequence[LACContact]) -> list[tuple[FESpace, np.ndarray]]:
    """Pairs of the scalar fields that flow through contacts: their spaces, and rows (k,)."""
    known = {first: space for contact in contacts for space, first in contact.form.scalars}
    return [(space, np.arange(first, first + space.ndof)) for first, space in known.items()]


def UnheldFields(
    mats: Sequence[BaseMatrix], contacts: Sequence[LACContact], free: np.ndarray
) -> str:
    """In which materials the matrices hold no constant of a scalar field, in words, or ""."""
    names = []
    for space, rows in ScalarFields(contacts):
        own, one = free[rows], GridFunction(space)
        one.Set(1)
        values = one.vec.FV().NumPy()[own]
        parts = [ToCSR(mat)[rows[own]][:, rows[own]] for mat in mats if mat.height]
        matrix = sum(parts[1:], parts[0])
        matrix.eliminate_zeros()
        count, part = scipy.sparse.csgraph.connected_components(matrix)
        left = np.bincount(part, np.abs(matrix @ values), count)
        size = np.bincount(part, abs(matrix) @ np.abs(values), count)
        loose = np.zeros(space.ndof, dtype=bool)
        loose[own] = (left <= UNHELD * size)[part]
        names += _MaterialsOf(space, loose) if np.any(loose) else []
    if not names:
        return ""
    return (
        f"a scalar field, such as the temperature, is held by nothing in {', '.join(names)}: where "
        "contact is open nothing flows there. Give it a Dirichlet condition, a loss to the "
        "surroundings or a capacity, or let something flow across the gap"
    )


def AssembleBulk(a: BilinearForm, x: BaseVector, layout: Layout | Whole) -> None:
    """The derivative of the bulk form at a vector; what NGSolve says against it names the form."""
    layout.Values(x)
    try:
        layout.together.Agree(lambda: a.AssembleLinearization(x), NgException)
    except NgException as error:
        raise NgException(f"a, the bulk form, cannot be assembled: {error}") from error


def CheckMatrix(mat: BaseMatrix, rows: np.ndarray, layout: Layout | Whole) -> None:
    """Refuse a bulk without stiffness, or one that couples the multipliers in the (n,) bool `rows`.

    Such terms would change the contact law.
    """
    values = layout.Consistent(np.random.default_rng(0).uniform(1, 2, len(rows)))
    if not np.any(Multiply([mat], values)):
        raise ValueError("a, the bulk form, has no stiffness: add that of the bodies to it")
    coupled = np.abs(Multiply([mat], values * rows)), np.abs(Multiply([mat], values) * rows)
    if any(np.any(part > 0) for part in coupled):  # CheckBodies reports NaN
        raise ValueError(
            "a, the bulk form, holds terms with lam or its test function: LACContact adds all of "
            "contact, leave these terms out"
        )


def CheckBodies(mat: BaseMatrix, contact: LACContact, free: np.ndarray, *, rests: bool) -> None:
    """Refuse a material that has no stiffness, or NaN, where it is `free` (n,) bool to move.

    `rests`: is the solution 0? Else NaN comes from that, as of elements that are inside out.
    """
    form = contact.form
    space, block = form.component, form.fes.dim
    own = _Displacements(form)
    random = np.random.default_rng(0).uniform(1, 2, len(free))
    forces = Multiply([mat], contact.layout.Consistent(random))[own]
    undefined, none = ~np.isfinite(forces) & free[own], (forces == 0) & free[own]
    for wrong, what in ((undefined, "NaN or infinity"), (none, "nothing")):
        where = wrong.reshape(-1, block).any(axis=1) if np.any(wrong) else None
        names = [] if where is None else _MaterialsOf(space, where)
        if names and wrong is undefined and not rests:
            raise ContactConvergenceError(
                "the residual holds NaN or infinite values of a, the bulk form, at the start, in "
                + ", ".join(map(repr, names))
            )
        if names:
            raise ValueError(
                f"a, the bulk form, gives {', '.join(map(repr, names))} {what} as stiffness: is "
                "there a name that is missing in a MaterialCF, a modulus of 0, or an integral that "
                "leaves a body out?"
            )


def CheckAxis(mat: BaseMatrix, contacts: Sequence[LACContact], free: np.ndarray) -> None:
    """Refuse a bulk without hoop strain beside axisymmetric contact; warn of the opposite.

    A shift away from the axis strains a body of revolution, but nothing in a plane.
    """
    flags = [contact.space.axisymmetric for contact in contacts]
    if len(set(flags)) > 1:
        raise ValueError(
            f"contact number {flags.index(True)} is axisymmetric and number {flags.index(False)} "
            "is not: make each LACSpace with axisymmetric=True, or none"
        )
    mesh = contacts[0].mesh
    extent = ExtentOf(mesh)
    if mesh.dim > 2 or extent.least[0] < -AXIS * extent.far:
        return
    form, fields, scalar = contacts[0].form, ScalarFields(contacts), contacts[0].components == 1
    if scalar or flags[0]:  # of displacements in a plane hoop strains tell
        fields.append((form.component, np.r_[_Displacements(form)]))
    for space, rows in fields:
        _CheckFactor(mat, space, rows, contacts[0].layout, axisymmetric=flags[0])
    if scalar:
        return
    found = list(_HoopStiffness(mat, form, contacts[0].layout))
    without = [repr(name) for name, resists, _ in found if not resists]
    if flags[0] and without:
        raise ValueError(
            f"a, the bulk form, has no hoop strain in {', '.join(without)}, but contact is "
            "axisymmetric: take 2*pi*x*dx and AxisymmetricGrad of ngslac.materials"
        )
    if flags[0] and _LeavesAxis(contacts[0].form, free):
        Warn(
            "the axis x = 0 of axisymmetric bodies is free to move across: give the displacement "
            "space dirichletx with the name of the boundary there"
        )
    alike = [1 / ALIKE < ratio < ALIKE for *_, ratio in found]
    if not flags[0] and alike and all(alike) and not without:
        Warn(
            "a, the bulk form, resists a shift along x as that of an axisymmetric problem does, "
            "but contact is that of a plane: if x is the distance from an axis, make the LACSpace "
            "with axisymmetric=True"
        )


def _CheckFactor(
    mat: BaseMatrix, space: FESpace, rows: np.ndarray, layout: Layout | Whole, *, axisymmetric: bool
) -> None:
    """Warn of a bulk with the factor x beside contact that is not axisymmetric, or the opposite.

    The energies of r^2/2 and r, with the distance r from the innermost point, have another ratio
    where each point counts by x, if what is conducted, or sheared along y, is so alike everywhere.
    Where the form has more than that, or the bodies are thin rings, it tells nothing.
    """
    works, r = [], x - ExtentOf(space.mesh).least[0]
    for function in (r**2 / 2, r):
        gf, values = GridFunction(space), layout.Zeros()
        gf.Set(function if gf.dim == 1 else CF((0, function)))
        values[rows] = gf.vec.FV().NumPy()
        works.append((values * Multiply([mat], values))[rows].reshape(-1, space.dim).sum(axis=1))
    weights = r**2, 1, r**2 * x, x
    moments = [Integrate(f, space.mesh, order=4, region_wise=True).NumPy() for f in weights]
    wrong = []
    for k in range(len(space.mesh.GetMaterials())):
        dofs = AsNumPy(DofsOfMaterials(space, np.arange(len(moments[0])) == k))
        curved, straight = (work[dofs].sum() for work in works)
        plane, around = (moments[i][k] / moments[i + 1][k] for i in (0, 2))
        if straight > 0 and around > (1 + DIFFERENT) * plane:
            other = plane if axisymmetric else around
            wrong.append(abs(curved / straight / other - 1) < SAME)
    if wrong and all(wrong):
        has, is_ = ("no", "is") if axisymmetric else ("a", "is not")
        Warn(
            f"a, the bulk form, has {has} factor 2*pi*x, as it seems, and contact {is_} "
            "axisymmetric: it goes with axisymmetric=True of each LACSpace"
        )


def _LeavesAxis(form: ContactForm, free: np.ndarray) -> bool:
    """Can some of the `free` (n,) bool dofs move a vertex on the axis across?"""
    space, block = form.component, form.fes.dim
    own = _Displacements(form)
    gf = GridFunction(space)
    gf.vec.FV().NumPy()[:] = np.random.default_rng(0).uniform(1, 2, space.ndof * block) * free[own]
    ends = IntegrationRule([(0.0,), (1.0,)], [0.5, 0.5])
    points = space.mesh.MapToAllElements({ET.SEGM: ends}, BND)
    away = x(points).ravel()
    together = LayoutOf(space).together
    farthest = together.Reduce(away.max(initial=0), "MAX")
    leaves = bool(len(away)) and np.any(gf(points)[away <= AXIS * farthest, 0] != 0)
    return together.Reduce(leaves, "LOR")


def _HoopStiffness(
    mat: BaseMatrix, form: ContactForm, layout: Layout | Whole
) -> Iterator[tuple[str, bool, float]]:
    """Of each material: its name, does it resist a shift along x, and how much.

    1 is about what hoop strains make, by the modulus that a shear tells; 0 where a shift along y,
    which strains no hoop, is resisted as much: by inertia, or springs. Materials all of whose dofs
    lie on boundaries are left out.
    """
    space, block, mesh = form.component, form.fes.dim, form.component.mesh
    own = _Displacements(form)
    motions, _, size = RigidMotions(space)
    shift, along = motions[:, 0], motions[:, 1]
    shear = size * motions[:, 2] * (along != 0)
    pushed, works = [], []
    for field in (shift, shear, along):
        values = layout.Zeros()
        values[own] = field
        forces = Multiply([mat], values)
        pushed.append(np.abs(forces[own]).reshape(-1, block).max(axis=1))
        works.append((values * forces)[own].reshape(-1, block).sum(axis=1))
    inside = ~AsNumPy(space.GetDofs(mesh.Boundaries(".*")))
    rings, areas = (Integrate(f, mesh, order=4, region_wise=True) for f in (1 / x, x))
    for k, name in enumerate(mesh.GetMaterials()):
        dofs = AsNumPy(DofsOfMaterials(space, np.arange(len(rings)) == k))
        if LayoutOf(space).together.Reduce(np.any(dofs & inside), "LOR"):
            resists = pushed[0][dofs & inside].max() > RESISTS * pushed[1][dofs].max()
            hoop, modulus, other = (work[dofs].sum() for work in works)
            strains = modulus > 0 and other < hoop / 2
            ratio = hoop / modulus * areas[k] / rings[k] / STIFFER if strains else 0.0
            yield name, resists, ratio


def _Displacements(form: ContactForm) -> slice:
    """The scalar dofs of the displacement among those of the product space."""
    block = form.fes.dim
    return slice(form.offset * block, (form.offset + form.component.ndof) * block)


def _MaterialsOf(space: FESpace, dofs: np.ndarray) -> list[str]:
    """Names of the materials that have some of these dofs (n,) bool for themselves."""
    materials = np.array(space.mesh.GetMaterials())
    names = list(dict.fromkeys(materials.tolist()))
    inside = {name: AsNumPy(DofsOfMaterials(space, materials == name)) for name in names}
    count = sum(part.astype(int) for part in inside.values())
    alone = {name: part & (count == 1) for name, part in inside.items()}
    found = {name: np.any(part & np.asarray(dofs)) for name, part in alone.items()}
    together = LayoutOf(space).together
    return [name for name, part in found.items() if together.Reduce(bool(part), "LOR")]
