# SPDX-License-Identifier: LGPL-2.1-or-later
"""Mass, time integration and constrained velocities: what dynamics adds to a contact problem."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from ngsolve import (
    VOL,
    BaseMatrix,
    BaseVector,
    BilinearForm,
    BitArray,
    CoefficientFunction,
    FESpace,
    GridFunction,
    IfPos,
    Integrate,
    Parameter,
    Region,
    pi,
    x,
)

from ngslac.arguments import CheckNumber, CheckValues, Components, Shown, Wrong
from ngslac.arrays import Multiply
from ngslac.bodies.mass import MassMatrix
from ngslac.bulkforms import ScaleMatrix, WithMass, WithoutMass
from ngslac.parallel.layout import LayoutOf
from ngslac.parallel.matrices import SkinRows

if TYPE_CHECKING:
    from ngsolve.comp import ProxyFunction
    from scipy.sparse import spmatrix

    from ngslac._ngslac import ContactForm
    from ngslac.contact.contact import LACContact

__all__ = ["CheckEnergy", "DynamicForm", "Mass", "Scheme"]

# Velocities against constraints, relative to those that tools without mass follow, that are none.
ROUNDING = 1e-12


@dataclass(frozen=True)
class Scheme:
    """Coefficients of the generalised-alpha method (Chung and Hulbert 1993, eqs. 25 and 17)."""

    rho_inf: float

    def __post_init__(self) -> None:
        CheckNumber("rho_inf", self.rho_inf, "a number between 0 and 1", lambda r: 0 <= r <= 1)

    @property
    def mass(self) -> float:
        """alpha_m: weight of the old acceleration."""
        return (2 * self.rho_inf - 1) / (self.rho_inf + 1)

    @property
    def force(self) -> float:
        """alpha_f: weight of the old force."""
        return self.rho_inf / (self.rho_inf + 1)

    @property
    def gamma(self) -> float:
        return 0.5 - self.mass + self.force

    @property
    def beta(self) -> float:
        return 0.25 * (1 - self.mass + self.force) ** 2

    @property
    def weight(self) -> float:
        """Weight of the balance of bulk forces where that of the contact force is 1.

        The contact force c/M enters the displacement with dt^2/2, the acceleration with beta dt^2.
        """
        return 2 * self.beta / (1 - self.mass)

    @property
    def share(self) -> float:
        """Weight of the force at the end of the step."""
        return self.weight * (1 - self.force)


class Mass:
    """The mass of the displacement on the product space of a form, and motions under constraints.

    Attributes
    ----------
    matrix : WholeMass or what stands for it
    rows, free : (n,) bool
        Dofs of the displacement, and the free ones of them.
    """

    def __init__(
        self,
        a: BilinearForm,
        contact: LACContact,
        density: CoefficientFunction | float,
        free: np.ndarray,
    ):
        form = contact.form
        self.space = space = form.fes
        self.u, self.v = Displacement(space, form)
        self._changes = isinstance(density, CoefficientFunction)  # may hold a Parameter
        self.density = CheckScalar("density", density, "mass per reference volume, > 0")
        if contact.space.axisymmetric:
            self.density = density = 2 * pi * x * self.density
        self.wanted = density
        self._bodies = DefinedOn(form.component)
        self._masses = self._CheckPositive(2 * form.component.globalorder)
        self.rows = contact.layout.Of(np.zeros(contact.nscalars, dtype=bool))
        first = form.offset * space.dim
        self.rows[first : first + form.component.ndof * space.dim] = True
        self.free = free & self.rows
        self.matrix = MassMatrix(density, (self.u, self.v), contact, self.free)

    def _CheckPositive(self, order: int) -> np.ndarray:
        """The masses of the materials, all finite and > 0."""
        wrong = Integrate(IfPos(self.density, 0, 1), self._bodies, order=order, region_wise=True)
        masses = self._Masses()
        names = self._bodies.mesh.GetMaterials()
        for name, size, mass in zip(names, wrong, masses, strict=True):
            if size > 0 or not np.isfinite(mass):
                raise ValueError(
                    f"density = {Shown(self.density)} must be a finite number > 0 everywhere: it "
                    f"is not in the material {name!r}"
                )
        return masses

    def _Masses(self) -> np.ndarray:
        return np.array(Integrate(self.density, self._bodies, region_wise=True))

    def CheckConstant(self) -> None:
        """The mass matrix is made once: the density must be the same in each step."""
        if self._changes and not np.allclose(self._Masses(), self._masses, rtol=1e-10, atol=0):
            raise ValueError(
                "the density has changed, by a Parameter in it: make a new TimeStepper, and set "
                "its velocity"
            )

    def Times(self, values: np.ndarray) -> np.ndarray:
        """M times a numpy vector."""
        return self.matrix.Times(values)

    def Solve(self, forces: np.ndarray) -> np.ndarray:
        """The accelerations of the free dofs under forces; 0 elsewhere."""
        return self.matrix.Solve(forces)

    def Energy(self, velocity: np.ndarray) -> float:
        """Kinetic energy."""
        return 0.5 * float(velocity @ self.Times(velocity))

    def Arrest(
        self, rows: SkinRows | spmatrix, velocity: np.ndarray, rates: np.ndarray
    ) -> np.ndarray:
        """The velocity without its part against the constraints at work.

        Closed macro-elements keep no normal velocity relative to the other side, sticking ones
        none at all. The change is orthogonal with respect to the mass: in a frame that moves with
        the other side it can only take energy away. Tools that forces move have no mass: they take
        no impulse, and go along.
        """
        loose, wrong = self._WithoutMass(rows), rows @ velocity - rates
        rate = wrong - loose @ (loose.T @ wrong)
        if np.linalg.norm(rate) <= ROUNDING * np.linalg.norm(wrong):
            return velocity
        return velocity - self.matrix.Follow(rows, rate, loose)

    def _WithoutMass(self, rows: SkinRows | spmatrix) -> np.ndarray:
        """An orthonormal basis, as columns, of what constraints see of motions without mass."""
        if isinstance(rows, SkinRows):  # tools without mass need one process
            return np.zeros((rows.shape[0], 0))
        seen = rows[:, np.flatnonzero(~self.rows)]
        seen = seen[:, np.flatnonzero(abs(seen).sum(axis=0))].toarray()
        basis, sizes, _ = np.linalg.svd(seen, full_matrices=False)
        return basis[:, sizes > 1e-8 * sizes.max(initial=0)]


class DynamicForm:
    """Bulk form plus inertia in one time step, with the verbs of a BilinearForm.

    ``share * (a(u) + 2 M (u - u0) / (share dt^2))``: the force balance of the step, weighted such
    that the contact force is the one that acts all through the step.
    """

    def __init__(self, a: BilinearForm, mass: Mass, scheme: Scheme):
        self.elastic, self.space, self.condense = a, a.space, a.condense
        self.mass, self.share, self.layout = mass, scheme.share, LayoutOf(a.space)
        self.start = GridFunction(a.space)  # u + dt v at the beginning of the step
        self.dt, self.factor = 0.0, Parameter(1.0)
        # For the matrix alone, which knows nothing of the start.
        self._form = WithMass(a, self.factor, mass.wanted, mass.u, mass.v)
        self._applied = None
        self.renewed = True  # was the matrix made in this step? Callers reset it when one begins.

    def SetStep(self, dt: float) -> bool:
        """Choose the length of the step, up to rounding; True if that changes the matrix."""
        if abs(dt - self.dt) <= 1e-9 * dt:
            return False
        self.dt = dt
        self.factor.Set(2 / (self.share * dt**2))
        return True

    @property
    def mat(self) -> BaseMatrix:
        return self._form.mat

    @property
    def harmonic_extension(self) -> BaseMatrix:
        return self._form.harmonic_extension

    @property
    def harmonic_extension_trans(self) -> BaseMatrix:
        return self._form.harmonic_extension_trans

    @property
    def inner_solve(self) -> BaseMatrix:
        return (1 / self.share) * self._form.inner_solve

    def AssembleLinearization(self, x: BaseVector) -> None:
        self.renewed = True
        self._form.AssembleLinearization(x)
        ScaleMatrix(self._form, self.share)

    def Assemble(self) -> None:
        self.renewed = True
        self._form.Assemble()
        ScaleMatrix(self._form, self.share)

    def Apply(self, x: BaseVector, y: BaseVector) -> None:
        """Apply the form at the end of the step: y = form(x), which is remembered for `Elastic`."""
        Values = self.layout.Values
        self.layout.Apply(self.elastic, x, y)
        values, forces = Values(x), Values(y)
        self._applied = values.copy(), forces.copy()
        moved = values - Values(self.start.vec)
        forces[:] = self.share * (forces + self.factor.Get() * self.mass.Times(moved))

    def Elastic(self, x: np.ndarray) -> np.ndarray | None:
        """Residual of the form without inertia at x (n,); None where that was not the last one."""
        known = self._applied is not None and np.array_equal(self._applied[0], x)
        return self._applied[1].copy() if known else None

    def ElasticChange(self, motion: np.ndarray) -> np.ndarray:
        """What a linear form without inertia adds along a motion (n,); not where it condenses."""
        return Multiply([self.mat], motion) / self.share - self.factor.Get() * self.mass.Times(
            motion
        )


@WithoutMass.register
def _(form: DynamicForm) -> BilinearForm:
    return form.elastic


def CheckScalar(name: str, value: CoefficientFunction | float, wanted: str) -> CoefficientFunction:
    """A number or a real function with one component as CoefficientFunction."""
    wanted = f"a number or a CoefficientFunction, {wanted}"
    if not isinstance(value, CoefficientFunction):
        return CoefficientFunction(CheckNumber(name, value, wanted))
    if Components(value) != 1 or value.is_complex:
        raise Wrong(ValueError, name, value, f"{wanted}, real with one component")
    return CheckValues(name, value)


def CheckEnergy(energy: CoefficientFunction | float | None) -> CoefficientFunction | None:
    """The strain energy as a function, or None."""
    if energy is None:
        return energy
    return CheckScalar("energy", energy, "the strain energy per reference volume")


def DefinedOn(space: FESpace) -> Region:
    """The materials on which a space has dofs, as a region."""
    mesh, found = space.mesh, BitArray(len(space.mesh.GetMaterials()))
    found.Clear()
    for k in range(len(found)):
        one = BitArray(len(found))
        one.Clear()
        one[k] = True
        dofs = space.GetDofs(Region(mesh, VOL, one)).NumSet()
        found[k] = bool(LayoutOf(space).together.Sum(dofs) > 0)
    return Region(mesh, VOL, found)


def Displacement(space: FESpace, form: ContactForm) -> tuple[ProxyFunction, ProxyFunction]:
    """Trial and test function of the displacement of a compiled contact form."""

    def Find(
        part: FESpace, trial: ProxyFunction | Sequence, test: ProxyFunction | Sequence, offset: int
    ) -> tuple[ProxyFunction, ProxyFunction] | None:
        """Those of the component that begins there, in the parts of a space; None if it is none."""
        if not isinstance(trial, (list, tuple)):
            found = offset == form.offset and part.ndof == form.component.ndof
            return (trial, test) if found else None
        for component, *proxies in zip(part.components, trial, test, strict=True):
            if found := Find(component, *proxies, offset):
                return found
            offset += component.ndof
        return None

    found = Find(space, *space.TnT(), 0)
    if found is None:
        raise ValueError("the displacement of the contact is no component of the product space")
    return found
