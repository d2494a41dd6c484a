# SPDX-License-Identifier: LGPL-2.1-or-later
"""The linearized system of a state of steady sliding, at some speed."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import scipy
from ngsolve import CoefficientFunction, GridFunction, LinearForm, ds

from ngslac.analysis.tangent import AsBefore, ContactMatrix, Tangent
from ngslac.arguments import CheckNumber, CheckPositive, CheckValues, Coefficient
from ngslac.bodies.constraints import AllJumps
from ngslac.errors import Warn

if TYPE_CHECKING:
    from scipy.sparse import csr_matrix

    from ngslac.contact.contact import LACContact
    from ngslac.solve.solver import Equilibrium

__all__ = ["SteadyTangent"]

# Lengths of a trial slip, in units of the bound of friction over the scale of the contact.
LENGTHS = (1.0, 2.0)
# Friction, relative to the pressure, that is none.
ROUNDING = 1e-10


def SteadyTangent(
    static: Equilibrium, speed: CoefficientFunction | float | None = None, slope: float = 0.0
) -> tuple[Tangent, csr_matrix | None]:
    """The Tangent of small motions about steady sliding, and D (n, n) or None.

    K u + D du/dt + inertia = 0. The tangent of a step resists a turn of the slip by mu p / |slip|,
    which depends on the length of the step; sliding at the speed v resists it by mu p / |v|,
    against velocities. So K is the limit of a long slip, and D, in the rows of multipliers, holds
    the resistance. In 3D with large sliding friction turns with the slave about its normal in this
    limit. `speed` and `slope` are as in `Modes`.
    """
    if not isinstance(speed, CoefficientFunction | None):
        CheckPositive("speed", speed)
    speed, slope = Coefficient("speed", CheckValues("speed", speed)), CheckNumber("slope", slope)
    slides = [slide for slide in map(Slides, static.contacts) if np.any(slide.slips)]
    matrices = []
    with AsBefore(static):
        tangent = Tangent(static)
        for slide in slides:
            slide.Begin(static.gf)
        for length in LENGTHS if slides else ():
            for slide in slides:
                slide.SetLength(length)
            static.system.Measure()
            matrices.append(ContactMatrix(static.system))
    if not slides:
        return tangent, None
    if any(slide.contact.finite and slide.contact.mesh.dim == 3 for slide in slides):
        Warn(
            "friction of large sliding in 3D turns with the slave about its normal here, in place "
            "of keeping its direction: where bodies turn about that, take small sliding, from the "
            "deformed state by contact.Update(gf), to see how much that matters"
        )
    # The rows are linear in 1 / (1 + length), which is 0 for a long slip.
    tangent.contact = (3 * matrices[1] - 2 * matrices[0]).tocsr()
    damping = sum(slide.Damping(tangent.contact, speed, slope) for slide in slides)
    return tangent, damping if damping.nnz else None


class Slides:
    """The macro-elements of a contact at the limit of friction, and where they slip."""

    def __init__(self, contact: LACContact):
        self.contact, self.slips = contact, np.zeros(0, dtype=bool)
        if not contact.form.paired or contact.components == 1 or contact.own_law or contact.tied:
            return
        table = contact.Table()
        along = table["traction"] + table["pressure"][:, None] * table["normal"]
        bound = np.linalg.norm(along, axis=1)
        self.table, self.bound = table, bound
        least = ROUNDING * np.linalg.norm(table["traction"], axis=1)
        self.slips = (table["status"] == 2) & (bound > least)
        # The slip itself may be rounding, as it is after a step: friction shows its direction.
        self.direction = np.zeros_like(along)
        self.direction[self.slips] = -along[self.slips] / bound[self.slips, None]

    def Begin(self, gf: GridFunction) -> None:
        """Count the slip from here; the state is not that of the contact any more."""
        if {"friction", "tresca"} & set(self.contact._state.setup.get("slopes", ())):
            raise ValueError(
                "a contact slips by friction= that is a function of its fields, which know the "
                "slip of a step in place of a speed: give the coefficient at the speed of sliding, "
                "and its derivative as slope="
            )
        form = self.contact.form
        form.Commit(gf.vec)
        form.BeginSolve()
        self.history, scale = form.History(), form.Table()["c"]
        self.unit = (self.bound / scale)[:, None] * self.direction

    def SetLength(self, length: float) -> None:
        """Let the surfaces have slipped by this, in the present step."""
        reference = self.history["reference"] - length * self.unit.ravel()
        self.contact.form.SetHistory(self.history | {"reference": reference})

    def Damping(
        self, matrix: csr_matrix, speed: CoefficientFunction | None, slope: float
    ) -> csr_matrix:
        """The derivative of the rows of multipliers by the velocities, (n, n)."""
        size, d = matrix.shape[0], self.contact.mesh.dim
        n, t, table = self.table["normal"], self.direction, self.table
        along, across = (np.einsum("mi,mj->mij", v, v) for v in (t, n))
        across = np.eye(d) - across
        rubs = np.where(table["friction"] > 0, np.abs(table["pressure"]), 0.0)
        law = slope * rubs[:, None, None] * along
        if d == 3 and speed is not None:
            law += (self.bound / self._Means(speed))[:, None, None] * (across - along)
        dofs = np.asarray(self.contact.form.MultiplierDofs())
        # Rows of a multiplier, which the law leaves alone along itself: - factor (lam - law).
        factor = np.asarray(matrix[dofs.repeat(d), np.tile(dofs.reshape(-1, d), d).ravel()])
        area = np.where(self.slips, table["area"], np.inf)[:, None, None]
        blocks = (factor.reshape(-1, d, d) @ across @ law) / area
        rows = scipy.sparse.block_diag(list(blocks)) @ AllJumps(self.contact)
        place = np.ones(len(dofs)), (dofs, np.arange(len(dofs)))
        damping = scipy.sparse.csr_matrix(place, shape=(size, len(dofs))) @ rows
        damping.eliminate_zeros()
        return damping

    def _Means(self, speed: CoefficientFunction) -> np.ndarray:
        """Of the speed over the macro-elements (m,); all > 0 where they slip."""
        space = self.contact.space.WithComponents(1)
        means = LinearForm(speed * space.TestFunction() * ds(definedon=self.contact.space.slave))
        means = means.Assemble().vec.FV().NumPy() / self.table["fullarea"]
        CheckPositive("speed", float(np.min(means[self.slips])), "> 0 wherever contact slips")
        return np.where(self.slips, means, 1.0)
