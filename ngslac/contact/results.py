# SPDX-License-Identifier: LGPL-2.1-or-later
"""Methods of `LACContact` for its results: resultants, operators, segments, a report."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from ngsolve import BaseMatrix, Integrate, Region

from ngslac._ngslac import RegionWithFaces, Side
from ngslac.arguments import BoundaryNames, CheckPoint
from ngslac.contact.fields import FluxName
from ngslac.contact.report import ContactReport
from ngslac.errors import Warn
from ngslac.output.segments import Segments
from ngslac.parallel.form import RegionOn

if TYPE_CHECKING:
    from ngslac.contact.flux import Flux
    from ngslac.recovery.recovered import Recovered

__all__ = [
    "Check",
    "Describe",
    "Flow",
    "Force",
    "Moment",
    "Mortar",
    "RecoveredOf",
    "SegmentsOf",
    "Table",
]

# What `Table` shows under the names of the form.
SHOWN = "area", "fullarea", "friction", "normal", "pressure", "gap", "traction", "slip"


def Describe(self) -> str:
    """In a line: both sides, the law, and whether it is paired."""
    sides = [self.space.slave] if self.master is None else [self.space.slave, self.master]
    names = [repr(BoundaryNames(side)) for side in sides]
    setup = self._state.setup
    laws = {"tied": self.tied, "bilateral": self.bilateral, "a law of its own": self.own_law}
    laws |= {"Coulomb friction": setup["friction"] is not None}
    laws |= {"Tresca friction": setup["tresca"] is not None, "large sliding": self.finite}
    words = [word for word, holds in laws.items() if holds]
    return (
        f"<LACContact: {self.space.nmacros} macro-elements of {names[0]} against "
        f"{'an obstacle' if self.master is None else names[1]}, "
        + ", ".join(words or ["frictionless"])
        + ("" if self.active else ", switched off")
        + (">" if self.form.paired else ", not paired yet>")
    )


def Table(self) -> dict[str, np.ndarray]:
    """The last evaluation as numpy arrays over the macro-elements.

    Returns
    -------
    dict
        ``x`` (n, d) centroid, with ``finite=True`` of the deformed surface, ``normal`` (n, d),
        ``area`` (n) paired, ``fullarea`` (n), both of the reference configuration,
        ``pressure`` (n), ``traction`` (n, d) on the slave, both 0 where the status is 0,
        ``gap`` (n) > 0 open, NaN without a partner,
        ``slip`` (n, d) of the last step, ``status`` (n) 0 open, 1 stick, 2 slip,
        ``friction`` (n) coefficient, -1 without Coulomb friction, of a flux ``flux_out`` (n) out of
        the slave and ``flux_in`` (n) into the master, per area of the reference configuration (of
        the second flux ``flux2_out``, ...),
        of a scalar `u` ``flux`` (n) out of the slave and ``jump`` (n) of its means, slave less
        master, beside which pressure, gap and slip are 0,
        and what a ``law`` of your own keeps.
    """
    known = self.form.Table()
    table = {name: known[name] for name in SHOWN}
    table["gap"] = np.where(table["area"] == 0, np.nan, table["gap"])
    table |= {"x": known["center"], "status": known["status"].astype(int)}
    if self.components == 1:
        table |= dict.fromkeys(("flux", "flux_out", "flux_in"), -known["traction"][:, 0])
        table["jump"] = np.where(table["area"] == 0, np.nan, known["jump"])
    for number in range(len(self.fluxes)):
        table |= {FluxName(number) + end: known[FluxName(number) + end] for end in ("out", "in")}
    return table | self.form.Kept()


def Force(self, *, on: Region | str | None = None) -> np.ndarray:
    """Resultant of the contact tractions on the slave; the master gets the opposite.

    Parameters
    ----------
    on : str or Region, optional
        Faces of either side: the force that acts on these, such as on one of several masters. That
        of a macro-element which faces several of them is shared by area.

    Returns
    -------
    (d,) array
        Where the problem is axisymmetric that of the whole circumference: the sum of the radial
        forces, of which opposite ones balance each other, and the axial force. Of a scalar `u`
        (1,): what flows into the slave.

    Raises
    ------
    ValueError, TypeError
        `on` has no face of slave or master.

    Examples
    --------
    >>> last = ContactSolver(a, gf, contact).Solve(printing=False)
    >>> abs(contact.Force(on="master") + contact.Force()).max().round(9).item()
    0.0
    """
    forces = self.form.Resultants()["force"][:, : self.components]
    return forces.sum(axis=0) if on is None else ShareOn(self, on) @ forces


def Flow(self, *, flux: Flux | None = None) -> tuple[float, float]:
    """What flows through the contact in all, out of the slave and into the master.

    Parameters
    ----------
    flux : Flux, optional
        Which one of several; None: the first.

    Returns
    -------
    tuple of float
        Per time; they differ by what is set free between the surfaces.

    Raises
    ------
    ValueError
        The contact has no flux, or not this one.

    Examples
    --------
    >>> from ngslac import Flux
    >>> W = H1(mesh, order=2, dirichlet="bottom|top")
    >>> fes = V * W * LACSpace(V, slave="slave")
    >>> (u, T, lam), (v, S, mu) = fes.TnT()
    >>> a = BilinearForm(InnerProduct(Grad(u), Grad(v)) * dx + grad(T) * grad(S) * dx)
    >>> film = Flux(T, lambda z: z.Slave(T) - z.Master(T))
    >>> contact = LACContact(u, lam, master="master", tied=True, flux=film)
    >>> gf = GridFunction(fes)
    >>> gf.components[1].Set(1, definedon=mesh.Boundaries("top"))
    >>> last = ContactSolver(a, gf, contact).Solve(printing=False)
    >>> out, into = contact.Flow()
    >>> abs(out - 1 / 3) < 1e-9 and abs(into - out) < 1e-12
    True
    """
    if flux not in (None, *self.fluxes) or not (self.fluxes or self.components == 1):
        raise ValueError("flux is none of this contact: give it in LACContact(..., flux=)")
    name = FluxName(0 if flux is None else self.fluxes.index(flux))
    table = self.Table()
    return tuple(float(table["area"] @ table[name + end]) for end in ("out", "in"))


def ShareOn(self, on: Region | str) -> np.ndarray:
    """Part (n,) of the force of each macro-element that acts on some faces, < 0 on the master's."""
    region = RegionWithFaces(self.surface.mesh, "on", RegionOn(self.form, on))
    segments, chosen = self.Segments(), Integrate(1.0, region, element_wise=True).NumPy() > 0
    slave, master = (chosen[side] & (side >= 0) for side in (segments.slave, segments.master))
    if not np.any(slave | master):
        sides = BoundaryNames(self.space.slave), self.master and BoundaryNames(self.master)
        raise ValueError(
            f"on = {BoundaryNames(region)!r} has no face in contact: slave and master are "
            f"{sides[0]!r} and {sides[1]!r}"
        )
    macro, count = np.array(self.surface.macros)[segments.slave], self.space.nmacros
    area = np.bincount(macro, segments.area, count)
    on_slave, on_master = (np.bincount(macro, segments.area * s, count) for s in (slave, master))
    return (on_slave - on_master) / np.where(area > 0, area, 1)


def Moment(self, point: Sequence[float] | None = None) -> float | np.ndarray:
    """Moment of the contact tractions on the slave.

    Parameters
    ----------
    point : (d,) array-like, optional
        About which; a position (length). Default: the origin.

    Returns
    -------
    float in 2D, (3,) array in 3D
        Force times length; 0 where the problem is axisymmetric.

    Raises
    ------
    ValueError
        A point of another dimension.
    """
    RefuseScalar(self)
    d = self.mesh.dim
    point = np.zeros(d) if point is None else CheckPoint("point", point, d)
    if self.space.axisymmetric:
        return 0.0
    total = self.form.Resultants()["moment"].sum(axis=0)
    arm, force = np.zeros(3), np.zeros(3)
    arm[:d], force[:d] = point, self.Force()
    moment = total - np.cross(arm, force)
    return float(moment[2]) if d == 2 else moment


def Mortar(self) -> tuple[BaseMatrix, BaseMatrix]:
    """Operators D and M of the weighted mean jump, as NGSolve sparse matrices.

    ``D u - M u`` is the integral of (slave minus paired master displacement) over each
    macro-element, d rows per macro-element, of a scalar `u` one, columns the dofs of its space. For
    scipy copy the arrays of ``D.CSR()``: they are views that die with the matrix.

    Raises
    ------
    ValueError
        The mesh is distributed: no process has these matrices then.
    """
    self._PairOnce()
    if self.mesh.comm.size > 1:
        raise ValueError("Mortar: matrices of a distributed mesh are not known: use Apply")
    return self.form.JumpMatrix(Side.slave), self.form.JumpMatrix(Side.master)


def RecoveredOf(self) -> Recovered:
    """Continuous pressure and traction of the last evaluation, made when first asked for.

    The multipliers are constant on macro-elements; these functions are continuous, never pull,
    and have the forces and moments of the multipliers, see `Recovered`.

    Returns
    -------
    Recovered

    Raises
    ------
    ValueError
        The tractions of the last evaluation are not all finite.

    Examples
    --------
    >>> last = ContactSolver(a, gf, contact).Solve(printing=False)
    >>> smooth = contact.Recovered()
    >>> pressure = Integrate(smooth.pressure, mesh.Boundaries("slave"))
    >>> bool(abs(contact.Force()[1] - pressure) < 1e-12)
    True
    """
    RefuseScalar(self)
    self._PairOnce()
    WarnIfUnsolved(self)
    if self._recovered is None:
        displacement = self._state.Displacement(self._solution)
        from ngslac.recovery.recovered import Recovered

        self._recovered = Recovered(self, displacement)
    return self._recovered


def RefuseScalar(self) -> None:
    """Raise for a scalar field, which has no pressures."""
    if self.components == 1:
        raise ValueError("u is a scalar field, which has no pressures and no moment: take Flow()")


def WarnIfUnsolved(self) -> None:
    """Warn that pressures are 0 where there was no solution yet."""
    table = self.form.Table()
    if self._solution is None and not any(np.any(table[k]) for k in ("traction", "status")):
        Warn("nothing is solved yet: pressures, tractions and slips are 0; solve first")


def SegmentsOf(self) -> Segments:
    """The segments of the pairing, see `Segments`."""
    self._PairOnce()
    return Segments(self.form, self.mesh.dim)


def Check(self) -> ContactReport:
    """A readable report of the pairing, see `ContactReport`."""
    self._PairOnce()
    return ContactReport(self)
