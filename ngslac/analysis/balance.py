# SPDX-License-Identifier: LGPL-2.1-or-later
"""Forces at faces and in elements that a discrete solution does not balance."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
from ngsolve import (
    BND,
    CF,
    L2,
    BaseVector,
    BilinearForm,
    BoundaryFromVolumeCF,
    CoefficientFunction,
    FacetFESpace,
    FESpace,
    Grad,
    GridFunction,
    InnerProduct,
    Integrate,
    LinearForm,
    Mesh,
    Region,
    VectorFacetFESpace,
    VectorL2,
    ds,
    dx,
    pi,
    specialcf,
    x,
    y,
    z,
)

from ngslac._ngslac import ContactForm, LACSpace, RegionWithFaces, Side
from ngslac.analysis.tangent import CONVERGED, Static
from ngslac.arguments import CheckFunction, CheckInstance, Wrong
from ngslac.arrays import AsBits, AsNumPy, ComponentsOf, Multiply, ToCSR
from ngslac.materials import AxisymmetricGrad
from ngslac.recovery.surface import SlaveSurface

if TYPE_CHECKING:
    from ngsolve.comp import DifferentialSymbol, ProxyFunction

    from ngslac.contact.contact import LACContact
    from ngslac.solve.solver import ContactSolver, Equilibrium

__all__ = [
    "Balance",
    "CheckSimplices",
    "ContactPoints",
    "FaceElements",
    "Numbered",
    "Owner",
]

# A displacement gradient at which the modulus is evaluated; part of a size that is rounding.
SMALL = 1e-6
# Of the forces at work: a larger imbalance means that stress or loads are not those of the bulk.
# Curved elements have some, by the points of their integrals.
UNBALANCED, RESULTANT, ROUNDING = 1e-2, 3e-4, 1e-12
# Arguments of a contact's form that say where it is, and those that do not matter for that.
COEFFICIENTS = "friction", "tresca", "offset"
KNOWN = {"master", "tool", "obstacle", *COEFFICIENTS, "tied", "bilateral", "finite", "edges"}
KNOWN |= {"adjust", "maxdist", "penetration"}
SIMPLICES = {10, 20}  # netgen's numbers of triangles and tetrahedra


class Straight:
    """Integrals and derivatives in plane and in space."""

    weight = CF(1)

    def __init__(self, dim: int):
        self.dim = dim  # rows of a stress

    def Gradient(self, u: CoefficientFunction) -> CoefficientFunction:
        """Of a displacement."""
        return Grad(u)

    def Traction(
        self, stress: CoefficientFunction, normal: CoefficientFunction
    ) -> CoefficientFunction:
        """Force per area."""
        return stress * normal

    def Around(self, stress: CoefficientFunction) -> CoefficientFunction:
        """The part of the divergence of a stress that is no derivative of its rows."""
        return CF((0,) * self.dim)

    def Positive(self, size: GridFunction) -> CoefficientFunction:
        """The weight, > 0 everywhere, of elements with a size."""
        return self.weight


class Round:
    """The same in half of a section of a body of revolution."""

    weight, dim = 2 * pi * x, 3
    Gradient = staticmethod(AxisymmetricGrad)

    def Traction(
        self, stress: CoefficientFunction, normal: CoefficientFunction
    ) -> CoefficientFunction:
        """Force per area, in the section."""
        return CF((stress[0, 0], stress[0, 1], stress[1, 0], stress[1, 1]), dims=(2, 2)) * normal

    def Around(self, stress: CoefficientFunction) -> CoefficientFunction:
        """The part of the divergence of a stress that is no derivative of its rows."""
        return CF((stress[0, 0] - stress[2, 2], stress[1, 0])) / x

    def Positive(self, size: GridFunction) -> CoefficientFunction:
        """The weight, > 0 also on the axis, of elements with a size."""
        return self.weight + SMALL * size


class Balance:
    """The stress of a solver's solution, its loads and contact tractions.

    Attributes
    ----------
    mesh : Mesh
    dim : int
    u : GridFunction
        Displacement.
    kind : Straight or Round
        How it is integrated.
    stress : CoefficientFunction (d, d), around an axis (3, 3)
    modulus, size : GridFunction
        Shear modulus and size of each element, constant on elements.
    homogeneous : bool
        Is it that of an adjoint solution, for which there are no loads and no gaps?
    """

    homogeneous = False

    def __init__(
        self,
        solver: ContactSolver,
        stress: Callable[[CoefficientFunction], CoefficientFunction],
        force: CoefficientFunction | None,
        tractions: dict[str | Region, CoefficientFunction] | None,
    ):
        self.static = static = Static(solver)
        Refuse(static)
        self.contacts = static.contacts
        form = self.contacts[0].form
        self.mesh, self.space = form.fes.mesh, form.component
        self.dim, self.order = self.mesh.dim, self.space.globalorder
        self.first = form.offset * form.fes.dim
        self.u = GridFunction(self.space)
        self.entries = static.gf.vec.FV().NumPy().copy()
        count = len(self.u.vec.FV())
        self.u.vec.FV().NumPy()[:] = self.entries[self.first : self.first + count]
        self.free = static.system.residual.free[self.first : self.first + count]
        self.law = stress
        self.multipliers = [
            self.entries[c.form.MultiplierDofs()].reshape(c.space.nmacros, -1)
            for c in self.contacts
        ]
        axisymmetric = self.contacts[0].space.axisymmetric
        self.kind = kind = Round() if axisymmetric else Straight(self.dim)
        self.stress = Tensor(stress, kind.Gradient(self.u), kind.dim)
        self.force = None if force is None else Vector("force", force, self.dim)
        self.tractions = Tractions(tractions, self.mesh, self.dim)
        self._Numbers()
        self._CheckStart()
        self._CheckBalance()

    def _Numbers(self) -> None:
        """Functions that are constant on elements."""
        constant = L2(self.mesh, order=0)
        self.modulus, self.size = GridFunction(constant), GridFunction(constant)
        self.modulus.Set(self.Modulus())
        volume = Integrate(CF(1), self.mesh, element_wise=True).NumPy()
        self.size.vec.FV().NumPy()[:] = volume ** (1 / self.dim)
        self.number = Numbered(constant)
        # Force per area and displacement by which the elements at a surface take up one of it.
        self.stiffness = 4 * self.modulus.vec.FV().NumPy() / self.size.vec.FV().NumPy()

    def Modulus(self) -> CoefficientFunction:
        """Shear modulus near the state without stress."""
        d = self.kind.dim
        shear = CF(tuple(SMALL * (k == 1) for k in range(d * d)), dims=(d, d))
        return (self.law(shear) - self.law(0 * shear))[0, 1] / SMALL

    def Elementwise(
        self, density: CoefficientFunction, where: DifferentialSymbol = dx
    ) -> np.ndarray:
        """Integrals (ne,) over elements or over their boundaries."""
        density = self.kind.weight * density
        return np.array(Integrate(density * where, self.mesh, element_wise=True).NumPy())

    @property
    def energy(self) -> float:
        """Norm of the solution: the root of the integral of stress times gradient."""
        work = InnerProduct(self.stress, self.kind.Gradient(self.u))
        return float(np.sqrt(abs(np.sum(self.Elementwise(work)))))

    # --- tractions -------------------------------------------------------------------------------

    def Contact(self, space: FESpace) -> np.ndarray:
        """Work (n,) of the contact tractions in the functions of a space like that of u."""
        work = 0
        for contact, tractions in zip(self.contacts, self.multipliers, strict=True):
            form = contact.form if space is self.space else Other(contact, space, self)
            jump = form.JumpMatrix(Side.both).CreateTranspose()
            work = work + Multiply([jump], tractions.ravel())
        return work

    def Outer(self, space: FESpace) -> np.ndarray:
        """LinearForm of the surface loads."""
        v, weight = space.TestFunction(), self.kind.weight
        loads = LinearForm(space)
        for region, traction in self.tractions:
            loads += weight * InnerProduct(traction, v) * ds(definedon=region, bonus_intorder=2)
        return loads.Assemble().vec.FV().NumPy().copy()

    def _CheckStart(self) -> None:
        """Raise for a stress without a displacement, with which the energy would differ."""
        start = self.law(0 * self.kind.Gradient(self.u))
        sizes = [np.sum(self.Elementwise(InnerProduct(t, t))) for t in (start, self.stress)]
        if sizes[0] > ROUNDING**2 * sizes[1]:
            raise ValueError(
                "stress is not zero without a displacement, as with heat or an initial stress: "
                "errors are not estimated for that"
            )

    def _CheckBalance(self) -> None:
        """Raise if loads, stress and contact are not in balance at the solution."""
        v, where = self.space.TestFunction(), dx(bonus_intorder=2)
        works = [InnerProduct(self.stress, self.kind.Gradient(v))]
        if self.force is not None:
            works.append(-self.force * v)
        parts = [LinearForm(self.kind.weight * work * where) for work in works]
        parts = [part.Assemble().vec.FV().NumPy() for part in parts]
        parts += [-self.Outer(self.space), -self.Contact(self.space)]
        parts = np.stack([part[self.free] for part in parts])
        size, error = np.linalg.norm(parts, axis=1).max(), np.linalg.norm(parts.sum(axis=0))
        wrong = error > UNBALANCED * size or self._Resultants(parts) > RESULTANT
        if not error <= self._Rounding() and not (np.isfinite(error) and not wrong):
            raise ValueError(
                f"stress, force and tractions leave {error / size:.2g} of the forces unbalanced: "
                "they must be those of the bulk form and of rhs, and the solver must have "
                f"converged (to {CONVERGED:g} or better)"
            )

    def _Resultants(self, parts: np.ndarray) -> float:
        """The largest work of forces together in motions without strain gradients, relative.

        Small imbalances of single nodes add up in them, such as those of a forgotten weight.
        """
        works, sizes = [], []
        for factor in (CF(1), *(x, y, z)[: self.dim]):
            for k in range(self.dim):
                motion = GridFunction(self.space)
                motion.Set(CF(tuple(factor if k == j else 0 for j in range(self.dim))))
                motion = motion.vec.FV().NumPy()[self.free]
                motion = motion / (np.abs(motion).max(initial=0) or 1.0)
                works.append(abs(np.sum(parts @ motion)))
                sizes.append(np.max(np.abs(parts) @ np.abs(motion)))
        return max(works) / (max(sizes) or 1.0)

    def _Rounding(self) -> float:
        """Forces that are rounding beside those of a displacement as large as the present one."""
        modulus, size = (f.vec.FV().NumPy() for f in (self.modulus, self.size))
        largest = np.abs(self.u.vec.FV().NumPy()).max(initial=0)
        forces = np.mean(modulus) * np.max(size) ** (self.dim - 2) * largest
        return ROUNDING * forces * np.sqrt(len(self.free))

    def Held(self, region: Region) -> np.ndarray:
        """Which components (d,) of the displacement are prescribed on a boundary."""
        parts = self._Parts()
        if parts is None:
            dofs = AsNumPy(self.space.GetDofs(region))
            free = self.free.reshape(len(dofs), -1)[dofs]
            return ~free.any(axis=0) if len(free) else np.zeros(self.dim, bool)
        ends = np.cumsum([0, *(part.ndof for part in parts)])
        held = np.zeros(self.dim, bool)
        for k, part in enumerate(parts):
            dofs = AsNumPy(part.GetDofs(region))
            held[k] = dofs.any() and not self.free[ends[k] : ends[k + 1]][dofs].any()
        return held

    def _Parts(self) -> list[FESpace] | None:
        return None if self.space.dim > 1 else list(ComponentsOf(self.space))

    def Supports(self) -> list[tuple[Region, np.ndarray]]:
        """Pairs of boundary region and held components (d,), where any is."""
        names = np.array(self.mesh.GetBoundaries())
        regions = [Region(self.mesh, BND, AsBits(names == name)) for name in dict.fromkeys(names)]
        pairs = [(region, self.Held(region)) for region in regions]
        return [(region, held) for region, held in pairs if held.any()]

    @cached_property
    def outer(self) -> np.ndarray:
        """Which facets (nf,) belong to one element: boundaries may lie inside of bodies, too."""
        facets = FacetFESpace(self.mesh, order=0)
        q = facets.TestFunction()
        loads = LinearForm(q * dx(element_boundary=True)), LinearForm(q * ds)
        both, there = (load.Assemble().vec.FV().NumPy() for load in loads)
        return (there > 0) & (both < 1.5 * there)

    def Sides(self) -> Region:
        """Region of slave and master of all contacts."""
        total = None
        for contact in self.contacts:
            for side in (contact.space.slave, contact.master):
                if side is not None:
                    total = side if total is None else total + side
        return total

    # --- what is left ----------------------------------------------------------------------------

    def Divergence(self) -> CoefficientFunction:
        """Divergence of the stress plus the body force: the imbalance within elements."""
        rows = [GridFunction(VectorL2(self.mesh, order=self.order)) for _ in range(self.dim)]
        for k, row in enumerate(rows):
            row.Set(CF(tuple(self.stress[k, j] for j in range(self.dim))))
        total = CF(tuple(sum(Grad(row)[j, j] for j in range(self.dim)) for row in rows))
        total = total + self.kind.Around(self.stress)
        return total if self.force is None else total + self.force

    def OnFacets(self, faces: FESpace, work: BaseVector) -> GridFunction:
        """The function on facets that does this work (BaseVector) in those of their space."""
        p, q = faces.TnT()
        weight, edge = self.kind.Positive(self.size), dx(element_boundary=True)
        mass = BilinearForm(weight * p * q * edge, symmetric=True).Assemble()
        found = GridFunction(faces)
        found.vec.data = mass.mat.Inverse(faces.FreeDofs(), "sparsecholesky") * work
        return found

    def FacetResidual(self, besides: Sequence[Region] = ()) -> tuple[GridFunction, GridFunction]:
        """Jumps of tractions, and the imbalance at boundaries: two GridFunctions on facets.

        The first is that of all faces but those of contacts, the second of these. The regions of
        `besides` do not count.
        """
        faces = VectorFacetFESpace(self.mesh, order=self.order)
        q = faces.TestFunction()
        traction = self.kind.Traction(self.stress, specialcf.normal(self.dim))
        edge = dx(element_boundary=True)
        out = LinearForm(self.kind.weight * InnerProduct(traction, q) * edge)
        left = out.Assemble().vec
        left.FV().NumPy()[:] -= self.Outer(faces) + self.Contact(faces)
        bulk, contact = self.OnFacets(faces, left), GridFunction(faces)
        values, ends = bulk.vec.FV().NumPy(), [0, *np.cumsum([c.ndof for c in faces.components])]
        for region, held in self.Supports():
            for k in np.flatnonzero(held):
                dofs = AsNumPy(faces.components[k].GetDofs(region))
                values[ends[k] : ends[k + 1]][dofs] = 0
        for region in besides:
            values[AsNumPy(faces.GetDofs(region))] = 0
        sides = AsNumPy(faces.GetDofs(self.Sides()))
        contact.vec.FV().NumPy()[sides] = values[sides]
        values[sides] = 0
        facets = Numbered(FacetFESpace(self.mesh, order=0))
        owners = (Owner(part, facets, measure=edge)[0] for part in faces.components)
        outer = np.concatenate([(facet >= 0) & self.outer[facet] for facet in owners])
        contact.vec.FV().NumPy()[:] *= np.sqrt(2)  # an inner face belongs to two elements
        values[outer] *= np.sqrt(2)
        return bulk, contact


def Numbered(space: FESpace) -> GridFunction:
    """The function with the value k at the dof k."""
    numbers = GridFunction(space)
    numbers.vec.FV().NumPy()[:] = np.arange(space.ndof)
    return numbers


def Diagonal(
    space: FESpace,
    factor: CoefficientFunction,
    product: Callable[[ProxyFunction, ProxyFunction], CoefficientFunction],
    measure: DifferentialSymbol,
) -> np.ndarray:
    """Squares (n,) of the functions of a space."""
    s, t = space.TnT()
    form = BilinearForm(factor * product(s, t) * measure, check_unused=False)
    return ToCSR(form.Assemble().mat).diagonal()


def Owner(
    space: FESpace,
    numbers: GridFunction,
    product: Callable[[ProxyFunction, ProxyFunction], CoefficientFunction] = InnerProduct,
    measure: DifferentialSymbol = dx,
) -> tuple[np.ndarray, np.ndarray]:
    """The number (n,) of an element or facet where each function of a space lives, and its square.

    A refined mesh keeps facets that were cut: theirs are -1 and 0.
    """
    plain, weighted = (Diagonal(space, f, product, measure) for f in (CF(1), numbers))
    there = plain > 0
    number = np.floor(weighted / np.where(there, plain, 1) + 1e-6)
    return np.where(there, number, -1).astype(int), plain


class ContactPoints:
    """Tractions and violated conditions at the quadrature points of a contact.

    Attributes
    ----------
    weight : (q,)
    element : (q,) int
        Of the slave's body.
    macro : (q,) int
    normal, traction, violation : (q, d)
        Contact direction; traction on the slave; the displacement by which contact conditions are
        violated: gaps of closed macro-elements, which are 0 in the mean, overlaps of open ones, and
        slip where they stick.
    stiffness : (q,)
        Force per area and displacement, of the element.
    work : (q,)
        Of friction where it does not oppose the slip, and of pressure in overlaps, >= 0; per area.
    """

    def __init__(self, contact: LACContact, balance: Balance):
        self.surface = surface = SlaveSurface(contact)
        face, at = surface.table[:, 0].astype(int), surface.table[:, 2:4]
        of = BoundaryFromVolumeCF(balance.number)
        self.weight, table = surface.weight, contact.Table()
        self.element = np.rint(surface.Evaluate(of, face, at)[:, 0]).astype(int)
        self.macro, tractions = surface.macro, balance.multipliers[balance.contacts.index(contact)]
        self.normal, self.traction = table["normal"][self.macro], tractions[self.macro]
        self.stiffness = self._Stiffness(balance, of)
        self._SetViolation(contact, balance, table)

    def _SetViolation(
        self, contact: LACContact, balance: Balance, table: dict[str, np.ndarray]
    ) -> None:
        """Set how far points of the surfaces violate the conditions of contact, and its work."""
        surface, normal = self.surface, self.normal
        jump = surface.Jump(Moved(contact, balance))
        mean = self._Mean(jump)
        gap = surface.gap * np.sum(surface.normal * normal, axis=1) - np.sum(jump * normal, axis=1)
        gap = self._Shifted(gap, contact, table)
        status = table["status"][self.macro]
        across = jump - mean - np.sum((jump - mean) * normal, axis=1)[:, None] * normal
        closed = status > 0
        held = closed & (status == 1) & contact.holds_tangentially
        if contact.own_law:
            self.violation, self.work = np.zeros_like(jump), np.zeros(len(gap))
            return
        if contact.tied or balance.homogeneous:
            counts = closed[:, None] * (jump - mean) - (closed & ~held)[:, None] * across
            self.violation, self.work = counts, np.zeros(len(gap))
            return
        normal_part, penetration = self._Normal(gap, closed, contact, balance)
        self.violation = normal_part[:, None] * normal + np.where(held[:, None], across, 0)
        slip = across + np.nan_to_num(table["slip"])[self.macro]
        drag = self.traction - np.sum(self.traction * normal, axis=1)[:, None] * normal
        work = np.linalg.norm(drag, axis=1) * np.linalg.norm(slip, axis=1)
        work = work + np.sum(drag * slip, axis=1)
        self.work = np.where(closed & (status == 2), work, 0) + penetration

    def _Shifted(
        self, gap: np.ndarray, contact: LACContact, table: dict[str, np.ndarray]
    ) -> np.ndarray:
        """Gaps plus an offset and the adjustment of the start."""
        offset = contact._state.setup["offset"]
        if isinstance(offset, CoefficientFunction):
            face, at = self.surface.table[:, 0].astype(int), self.surface.table[:, 2:4]
            gap = gap + self.surface.Evaluate(offset, face, at)[:, 0]
        mean = self._Mean(gap[:, None])[:, 0]
        return gap + np.nan_to_num(table["gap"][self.macro] - mean)

    def _Stiffness(self, balance: Balance, of: CoefficientFunction) -> np.ndarray:
        """Of both bodies in series (q,): either takes up a part of a displacement."""
        master = self.surface.table[:, 1].astype(int)
        soft, faced = 1 / balance.stiffness[self.element], master >= 0
        if faced.any():
            number = self.surface.Evaluate(of, master[faced], self.surface.table[faced, 4:6])
            soft[faced] += 1 / balance.stiffness[np.rint(number[:, 0]).astype(int)]
        return 1 / soft

    def _Normal(
        self, gap: np.ndarray, closed: np.ndarray, contact: LACContact, balance: Balance
    ) -> tuple[np.ndarray, np.ndarray]:
        """Gaps that count, and pressure times penetration where that is less than all gaps."""
        overlap = np.maximum(-gap, 0)
        if contact.bilateral:
            return gap, np.zeros(len(gap))
        pressure = -np.sum(self.traction * self.normal, axis=1)
        work = np.where(closed, np.maximum(pressure, 0) * overlap, 0)
        whole, part = (self._Sums(self.stiffness * g * g) for g in (gap, overlap))
        fewer = (part + 2 * self._Sums(work) < whole)[self.macro]
        fewer |= ~closed
        return np.where(fewer, -overlap, gap), np.where(fewer, work, 0)

    def _Sums(self, values: np.ndarray) -> np.ndarray:
        return np.bincount(self.macro, self.weight * values, len(self.surface.area))

    def _Mean(self, jump: np.ndarray) -> np.ndarray:
        surface = self.surface
        sums = [self._Sums(column) for column in jump.T]
        with np.errstate(divide="ignore", invalid="ignore"):
            return (np.stack(sums, axis=1) / surface.area[:, None])[self.macro]

    def Sum(self, values: np.ndarray, count: int) -> np.ndarray:
        """Integrals (ne,) over the faces of elements, of values (q,) at the points."""
        return np.bincount(self.element, self.weight * values, count)


def Moved(contact: LACContact, balance: Balance) -> GridFunction:
    """The displacement counted from where the surfaces were paired."""
    paired = contact._state.paired
    moved = GridFunction(balance.space)
    values = moved.vec.FV().NumPy()
    values[:] = balance.u.vec.FV().NumPy()
    moves = contact.master is not None and not balance.homogeneous
    if moves and paired is not None and len(paired):
        values -= paired[balance.first : balance.first + len(values)]
    return moved


def Other(contact: LACContact, space: FESpace, balance: Balance) -> ContactForm:
    """The form of a contact on the same macro-elements for another displacement space."""
    macros = np.array(contact.space.macros)
    numbers = macros[macros >= 0].tolist()
    around = contact.space.axisymmetric
    multipliers = LACSpace(space, slave=contact.space.slave, macros=numbers, axisymmetric=around)
    product = space * multipliers
    u, lam = product.TrialFunction()
    setup = contact._state.setup
    plain = {name: None if name in COEFFICIENTS else value for name, value in setup.items()}
    plain = {name: value for name, value in plain.items() if name in KNOWN}
    form = ContactForm(**(plain | {"u": u, "lam": lam, "law": None, "kept": {}}))
    paired, start = contact._state.paired, None
    if paired is not None and len(paired):
        first = GridFunction(balance.space)
        count = len(first.vec.FV())
        first.vec.FV().NumPy()[:] = paired[balance.first : balance.first + count]
        start = GridFunction(product)
        start.components[0].Set(first, definedon=balance.Sides())
    form.Update(start, None)
    return form


def FaceElements(region: Region) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Number, volume element and area of each face of a boundary region."""
    mesh = region.mesh
    number = Numbered(L2(mesh, order=0))
    area = np.array(Integrate(CF(1), region, element_wise=True).NumPy())
    sums = np.array(Integrate(BoundaryFromVolumeCF(number), region, element_wise=True).NumPy())
    faces = np.flatnonzero(area > 0)
    return faces, np.rint(sums[faces] / area[faces]).astype(int), area[faces]


# --- arguments -----------------------------------------------------------------------------------


def Refuse(static: Equilibrium) -> None:
    """Raise ValueError for problems that the estimators do not cover."""
    static.system.CheckSpace()
    space = static.contacts[0].form.component
    if space.dim == 1 and not ComponentsOf(space) and static.contacts[0].components > 1:
        raise ValueError(
            f"errors are not estimated for displacements of the space {space.type}, such as "
            "Compress or Periodic: take the space in it"
        )
    if not static.history:
        raise ValueError("solver has not solved anything: call solver.Solve() first")
    for contact in static.contacts:
        reasons = {
            "finite=True": contact.finite,
            "edges=True": contact._state.setup["edges"],
            "a scalar field": contact.components == 1,
            "a contact that is switched off": not contact.active,
        }
        found = [reason for reason, holds in reasons.items() if holds]
        if found:
            raise ValueError(f"contacts: errors are not estimated for {found[0]}")


def Tensor(
    law: Callable[[CoefficientFunction], CoefficientFunction],
    gradient: CoefficientFunction,
    dim: int,
) -> CoefficientFunction:
    """The stress that a function returns for a displacement gradient."""
    CheckFunction("stress", law, "a function of the displacement gradient")
    if law is None:
        raise Wrong(TypeError, "stress", law, "a function of the displacement gradient")
    value = law(gradient)
    CheckInstance("stress(H)", value, CoefficientFunction, "a matrix as CoefficientFunction")
    if tuple(value.dims) != (dim, dim):
        raise ValueError(f"stress(H) must have the shape ({dim}, {dim}), not {tuple(value.dims)}")
    return value


def Vector(name: str, value: CoefficientFunction, dim: int) -> CoefficientFunction:
    """A vector-valued function, or a sequence of numbers."""
    value = CF(tuple(value)) if isinstance(value, (tuple, list)) else value
    CheckInstance(name, value, CoefficientFunction, f"a vector with {dim} components")
    if value.dim != dim:
        raise ValueError(f"{name} must have {dim} components, not {value.dim}")
    return value


def Tractions(
    tractions: dict[str | Region, CoefficientFunction] | None, mesh: Mesh, dim: int
) -> list[tuple[Region, CoefficientFunction]]:
    """Pairs of region and function."""
    if tractions is None:
        return []
    CheckInstance("tractions", tractions, dict, "a dict from boundary names to tractions")
    return [
        (RegionWithFaces(mesh, "tractions", region), Vector("tractions", value, dim))
        for region, value in tractions.items()
    ]


def CheckSimplices(mesh: Mesh) -> None:
    """Raise ValueError for elements that are not bisected."""
    elements = mesh.ngmesh.Elements2D() if mesh.dim == 2 else mesh.ngmesh.Elements3D()
    if set(np.unique(elements.NumPy()["type"])) - SIMPLICES:
        raise ValueError(
            "mesh has elements that are not refined one by one: take triangles or tetrahedra"
        )
