# SPDX-License-Identifier: LGPL-2.1-or-later
"""Equilibrated estimator: stresses in equilibrium with loads and contact tractions bound the error.

Stresses are found on the patches of vertices. All patches of a colour, which have no element in
common, are solved at once.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from typing import TYPE_CHECKING

import numpy as np
from ngsolve import (
    CF,
    ET,
    H1,
    L2,
    VOL,
    BaseVector,
    BilinearForm,
    CoefficientFunction,
    FacetFESpace,
    FESpace,
    Grad,
    GridFunction,
    HDiv,
    InnerProduct,
    Integrate,
    IntegrationRule,
    Inv,
    LinearForm,
    Mesh,
    Region,
    Sym,
    VectorFacetFESpace,
    VectorL2,
    div,
    ds,
    dx,
    specialcf,
    x,
    y,
    z,
)

from ngslac.analysis.balance import (
    Balance,
    CheckSimplices,
    ContactPoints,
    FaceElements,
    Numbered,
    Owner,
)
from ngslac.analysis.colours import Colours
from ngslac.analysis.estimate import Consistency, ErrorEstimate
from ngslac.analysis.shapes import Constants, Rule
from ngslac.arrays import AsBits, AsNumPy, ToCSR

if TYPE_CHECKING:
    from ngsolve.comp import DifferentialSymbol, ProxyFunction

    from ngslac.solve.solver import ContactSolver

__all__ = ["EquilibratedEstimate"]

# Of the stiffness: keeps multipliers that have no effect where they are.
SHIFT = 1e-9
LINEAR = 1e-8  # relative difference of twice the stress and that of twice the displacement
CROSSES = 1e-6  # of the square of a function: more on a facet is a flow through it
MORE = {2: 3, 3: 1}  # degrees of polynomials beyond that of the data, for what they miss
SYMMETRY = 16.0  # how much more than stresses their skew part weighs, beside Korn's constant


class Patches:
    """The vertices in colours such that no element has two of one."""

    def __init__(self, mesh: Mesh):
        self.hats = H1(mesh, order=1)
        self.corner = ToCSR(Pairing(self.hats, L2(mesh, order=0), dx).mat)
        self.corner.data[:] = 1
        self.colour = Colours(self.corner)

    def __iter__(self) -> Iterator[GridFunction]:
        """Sums of the hat functions of each colour."""
        for colour in range(self.colour.max() + 1):
            hat = GridFunction(self.hats)
            hat.vec.FV().NumPy()[:] = self.colour == colour
            yield hat


def Pairing(trial: FESpace, test: FESpace, measure: DifferentialSymbol) -> BilinearForm:
    """Mass matrix between two scalar spaces."""
    form = BilinearForm(trialspace=trial, testspace=test)
    form += trial.TrialFunction() * test.TestFunction() * measure
    return form.Assemble()


class Compliance:
    """Strain energy of stresses for a linear law; `law` maps displacement gradients to stresses."""

    def __init__(self, law: Callable[[CoefficientFunction], CoefficientFunction], dim: int):
        pairs = [(i, i) for i in range(dim)]
        pairs += [(i, j) for i in range(dim) for j in range(i + 1, dim)]
        self.dim, self.pairs = dim, pairs
        units = [self._Unit(i, j) for i, j in pairs]
        columns = [self._Numbers(law(unit)) for unit in units]
        count = len(pairs)
        inverse = Inverse([[column[i] for column in columns] for i in range(count)])
        entries = tuple(entry for row in inverse for entry in row)
        self._inverse = CF(entries, dims=(count, count)).Compile()

    def _Unit(self, i: int, j: int) -> CoefficientFunction:
        size = 1.0 if i == j else np.sqrt(0.5)
        entries = np.zeros((self.dim, self.dim))
        entries[i, j] = entries[j, i] = size
        return CF(tuple(entries.ravel().tolist()), dims=(self.dim, self.dim))

    def _Numbers(self, tensor: CoefficientFunction) -> list[CoefficientFunction]:
        """Components in an orthonormal basis of symmetric tensors."""
        return [
            tensor[i, i] if i == j else np.sqrt(0.5) * (tensor[i, j] + tensor[j, i])
            for i, j in self.pairs
        ]

    def Strain(self, stress: CoefficientFunction) -> CoefficientFunction:
        """The strain of a stress."""
        numbers = self._inverse * CF(tuple(self._Numbers(stress)))
        entries = [[None] * self.dim for _ in range(self.dim)]
        for k, (i, j) in enumerate(self.pairs):
            entries[i][j] = entries[j][i] = numbers[k] * (1.0 if i == j else np.sqrt(0.5))
        return CF(tuple(e for row in entries for e in row), dims=(self.dim, self.dim))

    def __call__(self, one: CoefficientFunction, two: CoefficientFunction) -> CoefficientFunction:
        """Product of the symmetric parts of two stresses."""
        first, second = (CF(tuple(self._Numbers(stress))) for stress in (one, two))
        return InnerProduct(self._inverse * first, second)


def Inverse(rows: Sequence[Sequence[CoefficientFunction]]) -> list[list[CoefficientFunction]]:
    """Of a symmetric matrix of functions with 3 or 6 rows, by blocks of 3."""

    def Block(i: int, j: int) -> CoefficientFunction:
        return CF(
            tuple(rows[3 * i + k][3 * j + m] for k in range(3) for m in range(3)), dims=(3, 3)
        )

    def Entries(matrix: CoefficientFunction) -> list[list[CoefficientFunction]]:
        return [[matrix[k, m] for m in range(3)] for k in range(3)]

    first = Inv(Block(0, 0))
    if len(rows) == 3:
        return Entries(first)
    between = first * Block(0, 1)
    last = Inv(Block(1, 1) - Block(1, 0) * between)
    corner = first + between * last * between.trans
    side = -1 * (between * last)
    top = [a + b for a, b in zip(Entries(corner), Entries(side), strict=True)]
    return top + [a + b for a, b in zip(Entries(side.trans), Entries(last), strict=True)]


class Equilibration:
    """A stress in equilibrium, whose rows are functions of H(div)."""

    def __init__(self, balance: Balance, order: int):
        self.balance, self.mesh, self.dim = balance, balance.mesh, balance.dim
        d, constant = self.dim, L2(self.mesh, order=0)
        self.unit = float(np.mean(balance.modulus.vec.FV().NumPy()))
        self.compliance = Compliance(balance.law, d)
        self.korn = GridFunction(constant)
        vertices, points = CornersOf(self.mesh)
        self.korn.vec.FV().NumPy()[:] = Constants(points[vertices]).Turn()
        self.row = HDiv(self.mesh, order=order)
        parts = [HDiv(self.mesh, order=order) for _ in range(d)]
        parts.append(VectorL2(self.mesh, order=order - 1))
        parts += [L2(self.mesh, order=order - 1) for _ in range(d * (d - 1) // 2)]
        self.space, self.normal = FESpace(parts), specialcf.normal(d)
        self._Owners(constant)
        self._Data()
        self.solution = GridFunction(self.space)
        self._Solve()
        self.stress = Rows(self.solution.components[:d])

    def _Owners(self, constant: FESpace) -> None:
        """Facet (-1: none) and element of each dof of a row, and element of each multiplier."""
        mesh, facets = self.mesh, FacetFESpace(self.mesh, order=0)
        edge = dx(element_boundary=True)
        touching = ToCSR(Pairing(H1(mesh, order=1), facets, edge).mat)
        touching.data = (touching.data > 1e-10 * touching.data.max()).astype(float)
        self.touching = touching
        inside, mass = Owner(self.row, Numbered(constant))

        def normal(s: ProxyFunction, t: ProxyFunction) -> CoefficientFunction:
            return (s * self.normal) * (t * self.normal)

        facet, through = Owner(self.row, Numbered(facets), normal, edge)
        size = self.balance.size.vec.FV().NumPy()[inside]
        crosses = through * size > CROSSES * mass
        self.facet, self.element = np.where(crosses, facet, -1), np.where(crosses, -1, inside)
        self.multipliers = np.concatenate(
            [Owner(part, Numbered(constant))[0] for part in self._Others()]
        )

    def _Others(self) -> Sequence[FESpace]:
        return self.space.components[self.dim :]

    def _Data(self) -> None:
        """Tractions on boundaries, as functions on facets, and where they hold."""
        balance, d = self.balance, self.dim
        faces = VectorFacetFESpace(self.mesh, order=balance.order + 1)
        work = GridFunction(faces).vec
        work.FV().NumPy()[:] = balance.Outer(faces) + balance.Contact(faces)
        self.traction = balance.OnFacets(faces, work)
        outer = (self.facet >= 0) & balance.outer[self.facet]
        self.prescribed = np.repeat(outer[None], d, axis=0)
        for region, held in balance.Supports():
            dofs = AsNumPy(self.row.GetDofs(region))
            for k in np.flatnonzero(held):
                self.prescribed[k] &= ~dofs
        s, t = self.row.TnT()
        traces = [f.Trace() * self.normal for f in (s, t)]
        boundary = BilinearForm(traces[0] * traces[1] * ds, check_unused=False).Assemble()
        free = AsBits(outer)
        self._project = boundary.mat.Inverse(free, "sparsecholesky") if outer.any() else None

    def Projected(self, hat: GridFunction, k: int) -> np.ndarray:
        """Dofs of a row with the normal traction of a component, times a hat function."""
        t = self.row.TestFunction()
        load = LinearForm(self.row)
        load += hat * self.traction[k] * (t.Trace() * self.normal) * ds(bonus_intorder=2)
        load.Assemble()
        found = load.vec.CreateVector()
        found.data = self._project * load.vec
        return np.where(self.prescribed[k], found.FV().NumPy(), 0)

    def _Form(self) -> BilinearForm:
        """Stresses by their energy, with equilibrium and symmetry as constraints."""
        d, unit, size = self.dim, self.unit, self.balance.size
        modulus = self.balance.modulus
        (*s, u, r), (*t, v, q) = map(self._Split, self.space.TnT())
        S, T = Rows(s), Rows(t)
        weight = SYMMETRY * self.korn**2 / (2 * modulus)
        form = unit * (self.compliance(S, T) + weight * InnerProduct(Skew(S), Skew(T)))
        divs = zip(s, t, strict=True)
        form += size * sum(div(a) * v[k] + div(b) * u[k] for k, (a, b) in enumerate(divs))
        form += sum(a * b for a, b in zip(q, Turns(S, d), strict=True))
        form += sum(a * b for a, b in zip(r, Turns(T, d), strict=True))
        form -= SHIFT * (u * v + sum(a * b for a, b in zip(r, q, strict=True)))
        return BilinearForm(form * dx, check_unused=False).Assemble()

    def _Split(
        self, functions: Sequence[ProxyFunction]
    ) -> list[ProxyFunction | Sequence[ProxyFunction]]:
        d = self.dim
        return [*functions[:d], functions[d], functions[d + 1 :]]

    def _Load(self, hat: GridFunction) -> BaseVector:
        """The loads of a patch, and the stress to which its own is to be near."""
        balance = self.balance
        *t, v, _ = self._Split(self.space.TestFunction())
        near = self.unit * self.compliance(hat * balance.stress, Rows(t))
        body = balance.stress * Grad(hat)
        if balance.force is not None:
            body = body - hat * balance.force
        load = LinearForm(self.space)
        load += (near + balance.size * body * v) * dx(bonus_intorder=1)
        return load.Assemble().vec

    def _Solve(self) -> None:
        """Add up the solutions of all patches."""
        form, patches = self._Form(), Patches(self.mesh)
        total = self.solution.vec
        total[:] = 0
        for hat in patches:
            chosen = hat.vec.FV().NumPy()
            near, inner = self.touching @ chosen > 0, self.element >= 0
            elements = patches.corner @ chosen > 0
            mine = np.where(self.facet >= 0, near[self.facet], elements[self.element] & inner)
            rows = [mine & ~held for held in self.prescribed]
            free = np.concatenate([*rows, elements[self.multipliers]])
            start, right = total.CreateVector(), self._Load(hat)
            start[:] = 0
            data = [self.Projected(hat, k) * mine for k in range(self.dim)]
            start.FV().NumPy()[: self.dim * self.row.ndof] = np.concatenate(data)
            right.data -= form.mat * start
            start.data += form.mat.Inverse(AsBits(free), "umfpack") * right
            total.data += start


def Rows(functions: Sequence[CoefficientFunction]) -> CoefficientFunction:
    """A matrix of its rows."""
    d = len(functions)
    return CF(tuple(f[j] for f in functions for j in range(d)), dims=(d, d))


def Skew(matrix: CoefficientFunction) -> CoefficientFunction:
    """Its skew part."""
    return 0.5 * (matrix - matrix.trans)


def Turns(matrix: CoefficientFunction, dim: int) -> list[CoefficientFunction]:
    """The numbers that vanish where it is symmetric."""
    pairs = [(i, j) for i in range(dim) for j in range(i + 1, dim)]
    return [matrix[i, j] - matrix[j, i] for i, j in pairs]


def CornersOf(mesh: Mesh) -> tuple[np.ndarray, np.ndarray]:
    """Vertices (ne, d + 1) of the elements, and all points (nv, d)."""
    ng, d = mesh.ngmesh, mesh.dim
    elements = (ng.Elements2D() if d == 2 else ng.Elements3D()).NumPy()["nodes"]
    return elements[:, : d + 1] - 1, np.array(ng.Coordinates())[:, :d]


def ElementOfFace(mesh: Mesh) -> np.ndarray:
    """Volume element (nf,) of each boundary face."""
    faces, elements, _ = FaceElements(mesh.Boundaries(".*"))
    found = np.full(faces.max() + 1, -1)
    found[faces] = elements
    return found


class Oscillation:
    """Roots of the largest energy that unbalanced parts of the data can have.

    It has no linear part on a face, or in an element.
    """

    def __init__(self, found: Equilibration, balance: Balance):
        self.found, self.balance, self.mesh = found, balance, balance.mesh
        self.vertices, self.points = CornersOf(self.mesh)
        self.soft = np.sqrt(2 * balance.modulus.vec.FV().NumPy())

    def Surface(self) -> np.ndarray:
        """The part (ne,) of tractions in the energy of the difference of stresses.

        Those of contacts are polynomials on parts of the master's faces only. What the stress in
        equilibrium lacks of them, each element takes up by a displacement, the stress of which is
        added to the difference.
        """
        added, loads = np.zeros(self.mesh.ne), self._Loads() + self._Prescribed()
        of = ElementOfFace(self.mesh)
        face, place, forces = (np.concatenate(part) for part in zip(*loads, strict=True))
        elements, mine = np.unique(of[face], return_inverse=True)
        corners = self.points[np.roll(self.vertices[elements], 1, axis=1)]
        constants = Constants(corners, degree=self.balance.order + 1 + MORE[self.mesh.dim])
        values = constants.Values(mine, place)
        moments = np.zeros((len(elements), self.mesh.dim, values.shape[1]))
        np.add.at(moments, mine, forces[:, :, None] * values[:, None, :])
        taken = constants.Carrying(moments)
        own = np.sum(taken * moments, axis=(1, 2)) / self.soft[elements] ** 2
        cross = np.sum(taken * constants.StrainMoments(self._Strains(constants)[elements]), (1, 2))
        added[elements] = own + 2 * cross
        return added

    def _Loads(self) -> list[tuple[np.ndarray, np.ndarray, np.ndarray]]:
        """Faces, places and forces of the remaining tractions at the points of contacts."""
        loads = []
        for contact in self.balance.contacts:
            points = ContactPoints(contact, self.balance)
            surface = points.surface
            opposite = surface.position + surface.gap[:, None] * surface.normal
            for side, sign, place in ((0, 1, surface.position), (1, -1, opposite)):
                face = surface.table[:, side].astype(int)
                there = face >= 0
                if there.any():
                    at = surface.table[there, 2 + 2 * side : 4 + 2 * side]
                    carried = surface.Evaluate(self.found.traction, face[there], at)
                    rest = sign * points.traction[there] - carried
                    loads.append((face[there], place[there], rest * points.weight[there, None]))
        return loads

    def _Prescribed(self) -> list[tuple[np.ndarray, np.ndarray, np.ndarray]]:
        """The same of surface loads."""
        loads, d = [], self.mesh.dim
        kind = ET.SEGM if d == 2 else ET.TRIG
        places, weights = Rule(kind, 2 * self.balance.order + 4, d - 1)
        for region, traction in self.balance.tractions:
            faces, _, area = FaceElements(region)
            rule = IntegrationRule(places.tolist(), [0.0] * len(places))
            at = self.mesh.MapToAllElements({ET.SEGM: rule, ET.TRIG: rule}, region)
            rest = (traction - self.found.traction)(at).reshape(-1, d)
            share = np.outer(area, weights / weights.sum()).ravel()
            place = CF((x, y, z)[:d])(at).reshape(-1, d)
            loads.append((np.repeat(faces, len(places)), place, rest * share[:, None]))
        return loads

    def _Strains(self, constants: Constants) -> np.ndarray:
        """Of the difference of stresses, (ne, q, d, d) at points of all elements."""
        d = self.mesh.dim
        rule = IntegrationRule(constants.points.tolist(), [0.0] * len(constants.points))
        at = self.mesh.MapToAllElements({ET.TRIG if d == 2 else ET.TET: rule}, VOL)
        difference = Sym(self.found.stress) - self.balance.stress
        return self.found.compliance.Strain(difference)(at).reshape(self.mesh.ne, -1, d, d)

    def Body(self) -> np.ndarray:
        """Roots of energies (ne,) of body forces less their polynomial part."""
        rows = self.found.solution.components[: self.mesh.dim]
        left = CF(tuple(div(row) for row in rows))
        left = left if self.balance.force is None else left + self.balance.force
        size = np.sqrt(self.balance.Elementwise(InnerProduct(left, left)))
        less = self.balance.order
        return Constants(self.points[self.vertices]).Inside(less) * size / self.soft


def EquilibratedEstimate(
    solver: ContactSolver,
    stress: Callable[[CoefficientFunction], CoefficientFunction],
    *,
    force: CoefficientFunction | None = None,
    tractions: dict[str | Region, CoefficientFunction] | None = None,
) -> ErrorEstimate:
    """Bound the error of a linear bulk by a stress in equilibrium (Prager and Synge).

    On the patch of each vertex a stress of H(div) is found that balances body force, surface loads
    and contact tractions, which act on both bodies, and is close to that of the solution. The sum
    is in equilibrium. It is symmetric but for a small part, which counts by Korn's constant of each
    element.

    Parameters
    ----------
    solver : ContactSolver
        As of `ResidualEstimate`; the order of displacements is at least 2, and the mesh one of
        triangles or tetrahedra.
    stress : callable
        As of `ResidualEstimate`, linear in the displacement gradient, and symmetric.
    force : (d,) CoefficientFunction, optional
        Body force, per volume.
    tractions : dict, optional
        Surface loads (d,) by boundary name, stress units.

    Returns
    -------
    ErrorEstimate
        Of each element: bulk, its distance to the stress in equilibrium; contact, what polynomials
        miss of tractions at surfaces; consistency, as of `ResidualEstimate`.

    Raises
    ------
    ValueError, TypeError
        As of `ResidualEstimate`; a nonlinear stress, first order, other elements, an axisymmetric
        problem.

    Notes
    -----
    With the contact tractions of the solution as loads, bulk and contact together are not less than
    the energy norm of the error: on straight elements, up to constants of Korn's and Poincaré's
    inequalities, which are eigenvalues on polynomials (of degree 5, in 3D 3), and for tractions up
    to what polynomials of such a degree see of them. What contact conditions in the mean add is
    estimated: gaps count as displacements that the elements at both surfaces take up, or by the
    work of the pressure in overlaps. With Coulomb friction the bound of the tangential traction is
    that of the solution. Springs count as loads, and prescribed displacements as the space has
    them. Prager and Synge, Quart. Appl. Math. 5 (1947); for contact Weiss and Wohlmuth, Math. Comp.
    78 (2009); weak symmetry: Bertrand, Kober, Moldenhauer and Starke, Numer. Methods Partial
    Differ. Equ. 37 (2021).

    Examples
    --------
    >>> from ngslac.analysis import EquilibratedEstimate
    >>> last = solver.Solve(printing=False)
    >>> down = {"top": CF((0, -0.01 * load))}
    >>> found = EquilibratedEstimate(solver, lambda H: Sym(H), tractions=down)
    >>> found.relative < 1e-9  # an even pressure, which the space has
    True
    """
    balance = Balance(solver, stress, force, tractions)
    Check(balance)
    found = Equilibration(balance, balance.order + 1)
    away, skew = Sym(found.stress) - balance.stress, Skew(found.stress)
    weight = found.korn**2 / (2 * balance.modulus)
    parts = found.compliance(away, away), weight * InnerProduct(skew, skew)
    first, second = (np.maximum(balance.Elementwise(part), 0) for part in parts)
    rest = Oscillation(found, balance)
    others = np.sqrt(second) + rest.Body()
    bulk = (np.sqrt(first) + others) ** 2
    whole = (np.sqrt(np.maximum(first + rest.Surface(), 0)) + others) ** 2
    squares = np.minimum(bulk, whole), np.maximum(whole - bulk, 0)
    return ErrorEstimate("equilibrated", *squares, Consistency(balance), balance.energy)


def Check(balance: Balance) -> None:
    """Raise ValueError for problems that cannot be equilibrated."""
    CheckSimplices(balance.mesh)
    if balance.contacts[0].space.axisymmetric:
        raise ValueError(
            "contacts: the equilibrated estimate is not known around an axis, take ResidualEstimate"
        )
    if balance.order < 2:
        raise ValueError(
            "the displacement space has order 1, which does not balance the moments of patches: "
            "take order 2 or higher, or ResidualEstimate"
        )
    twice = balance.law(2 * Grad(balance.u)) - 2 * balance.stress
    skew = balance.stress - balance.stress.trans
    stresses = twice, skew, balance.stress
    *wrong, size = (Integrate(InnerProduct(t, t), balance.mesh) for t in stresses)
    if max(wrong) > LINEAR**2 * size:
        raise ValueError(
            "stress is not linear in the displacement gradient, or not symmetric: the equilibrated "
            "estimator is for linear elasticity, take ResidualEstimate"
        )
