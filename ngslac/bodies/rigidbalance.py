# SPDX-License-Identifier: LGPL-2.1-or-later
"""Can contact within its friction balance the loads on bodies that nothing else holds?

Moved as rigid ones, bodies feel the loads and contact alone. Their balance is linear in the
tractions, and what tractions there may be is a cone: a linear programme decides whether one of them
balances the loads, or finds the motion along which the loads win. It needs no solution.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
import scipy

from ngslac._ngslac import Side
from ngslac.bodies.rigidmotions import Turned
from ngslac.parallel.form import JumpRows
from ngslac.parallel.layout import LayoutOf

if TYPE_CHECKING:
    from scipy.sparse import csc_matrix, csr_matrix

    from ngslac.bodies.bodies import Bodies
    from ngslac.contact.contact import LACContact

__all__ = ["RigidBalance"]

# Loads that are not balanced, relative to all; forces at work that are rounding.
LEAST, ROUNDING = 1e-5, 1e-9
# Directions of friction in 3D: more of them than friction could carry, by half a per cent.
DIRECTIONS = 32
REMEDY = ". Constrain it, or prescribe a displacement in place of a force"
# Coefficient of friction of surfaces on which nothing slides.
ROUGH = 10.0
# Part of the farthest motion that belongs to a body which moves, too.
MOVING = 0.1


class RigidBalance:
    """Looks for contact tractions that balance the loads on bodies moved as rigid ones."""

    def __init__(
        self, bodies: Bodies, contacts: Sequence[LACContact], displacement: np.ndarray | None = None
    ):
        self.bodies, self.contacts = bodies, contacts
        self.motions = bodies.motions
        if displacement is not None:
            self.motions = self.motions + Turned(bodies.space, displacement, bodies.size)
        self.dim = bodies.space.mesh.dim

    def Find(self, forces: np.ndarray) -> str:
        """Why these loads have no balance, in words; "" if they have one."""
        columns = self.bodies.Columns(self.motions)
        if not columns.shape[1]:
            return ""
        layout = LayoutOf(self.bodies.space)
        loads = -layout.Works(columns, forces)
        gross = layout.Works(abs(columns), np.abs(forces))
        if np.all(np.abs(loads) <= ROUNDING * gross):
            return ""
        self._jumps = [JumpRows(contact.form, Side.both) @ columns for contact in self.contacts]
        self._loads = loads
        motion = self._Winner(0.0)
        return "" if motion is None else self._Message(motion)

    def _Winner(self, rough: float, within: np.ndarray | None = None) -> np.ndarray | None:
        """The motion along which loads do more work than contact resists; None: none."""
        within = np.eye(len(self._loads)) if within is None else within
        loads = within.T @ self._loads
        size = np.abs(loads).sum()
        if size == 0:
            return None
        rays, bounds = [], []
        for contact, jump in zip(self.contacts, self._jumps, strict=True):
            tractions, bound = Rays(contact, rough)
            rays.append(scipy.sparse.csr_matrix(-within.T @ (jump.T @ tractions)))
            bounds.append(bound / size)
        found = Separate(scipy.sparse.hstack(rays).tocsc(), np.concatenate(bounds), loads / size)
        motion, lacking = found
        return within @ motion if lacking > LEAST else None

    def _Message(self, motion: np.ndarray) -> str:
        """The message about loads that do work along a motion."""
        straight = self._Translations()
        pulled = self._Winner(np.inf, straight)
        if pulled is not None:
            return self._Says(pulled, "is pulled away ({}): contact can only push")
        tipped = self._Winner(ROUGH)
        if tipped is not None:
            return self._Says(
                tipped, "tips over ({}): no pressure balances the moment of the loads"
            )
        slides = self._Winner(0.0, straight)
        limit = "friction is at its limit" if self._Rubs() else "there is no friction"
        if slides is None:
            return self._Says(motion, "turns ({}): " + limit)
        return self._Says(self._Along(slides, straight), "slides away ({}): " + limit)

    def _Rubs(self) -> bool:
        return any(contact.holds_tangentially for contact in self.contacts)

    def _Translations(self) -> np.ndarray:
        """The motions without rotation, as columns of weights of all combinations."""
        turning = (combinations[self.dim :] for _, combinations in self.bodies.floating)
        _, singular, vectors = np.linalg.svd(scipy.linalg.block_diag(*turning))
        return vectors[np.sum(singular > 1e-8) :].T

    def _Along(self, motion: np.ndarray, within: np.ndarray) -> np.ndarray:
        """The part of a motion along the surfaces: Coulomb's cone tilts what slides off them."""
        normals = np.zeros((0, within.shape[1]))
        for contact, jump in zip(self.contacts, self._jumps, strict=True):
            table = contact.Table()
            rates = (jump @ motion).reshape(-1, self.dim)
            opening = np.sum(rates * table["normal"], axis=1)
            slip = np.linalg.norm(rates - opening[:, None] * table["normal"], axis=1)
            rubs = np.abs(opening) <= 1.01 * np.maximum(table["friction"], 0) * slip
            rows = (Blocks(table["normal"][:, :, None]).T @ jump) @ within
            normals = np.concatenate([normals, rows[rubs & (table["area"] > 0)]])
        _, singular, vectors = np.linalg.svd(normals.T @ normals)
        kept = vectors[np.sum(singular > 1e-6 * singular.max(initial=0.0)) :].T
        along = within @ (kept @ (kept.T @ (within.T @ motion)))
        return along if np.linalg.norm(along) > MOVING * np.linalg.norm(motion) else motion

    def _Says(self, motion: np.ndarray, words: str) -> str:
        """The same words of each body that a motion (m,) moves."""
        found = []
        for (part, combinations), (*_, rows) in zip(
            self.bodies.floating, self.bodies.unknowns, strict=True
        ):
            weights = combinations @ motion[rows]
            found.append((np.linalg.norm(weights), part, weights))
        most = max(size for size, *_ in found)
        texts = [
            f"body {self.bodies.name(part)} " + words.format(self._Direction(weights))
            for size, part, weights in found
            if size > MOVING * most
        ]
        return "no equilibrium: " + "; ".join(texts) + REMEDY

    def _Direction(self, weights: np.ndarray) -> str:
        """A motion in words: where to, or which rotation."""
        straight, turning = weights[: self.dim], weights[self.dim :]
        if np.linalg.norm(turning) > 0.5 * np.linalg.norm(straight):
            return self.bodies.names[self.dim + int(np.argmax(np.abs(turning)))]
        direction = straight / np.linalg.norm(straight)
        k = int(np.argmax(np.abs(direction)))
        if abs(direction[k]) > 0.999:
            return f"{self.bodies.names[k]}, towards {'-' if direction[k] < 0 else '+'}{'xyz'[k]}"
        return "in direction (" + ", ".join(f"{value + 0.0:.2g}" for value in direction) + ")"


def Separate(rays: csc_matrix, bounds: np.ndarray, loads: np.ndarray) -> tuple[np.ndarray, float]:
    """The motion that parts the loads from all that contact can do, and how much is lacking.

    The least sum of forces that have to be added for ``rays @ x + added = loads`` with
    0 <= x <= bounds; the motion is its derivative by the loads.
    """
    length = scipy.sparse.linalg.norm(rays, axis=0)
    used = length > 1e-12 * length.max(initial=0.0)
    rays, bounds = rays[:, used].multiply(1 / length[used]), bounds[used] * length[used]
    count, one = rays.shape[1], scipy.sparse.identity(len(loads))
    result = scipy.optimize.linprog(
        np.concatenate([np.zeros(count), np.ones(2 * len(loads))]),
        A_eq=scipy.sparse.hstack([rays, one, -one]).tocsr(),
        b_eq=loads,
        bounds=[(0, b if np.isfinite(b) else None) for b in bounds] + [(0, None)] * 2 * len(loads),
        method="highs",
    )
    if result.status != 0:
        return np.zeros(len(loads)), 0.0
    return result.eqlin.marginals, result.fun


def Rays(contact: LACContact, rough: float) -> tuple[csr_matrix, np.ndarray]:
    """Tractions as columns (d m, r) of which any sum is possible, and bounds (r,) of weights."""
    table, d = contact.Table(), contact.components
    faces = (table["area"] > 0)[:, None, None]
    if contact.tied:
        tractions = faces * np.concatenate([np.eye(d), -np.eye(d)], axis=1)
        return Blocks(tractions), np.full(tractions.shape[0] * 2 * d, np.inf)
    normal, around = table["normal"][:, :, None], Tangents(table["normal"])
    wedge = np.pi / DIRECTIONS if d == 3 else 0.0  # half of the angle between two directions
    friction = np.maximum(table["friction"], rough if np.isfinite(rough) else 0.0) / np.cos(wedge)
    pressed = friction[:, None, None] * around - normal
    # Tresca's bound, whatever the pressure: the sum of all directions is as long as one of them.
    bound = np.where(table["friction"] < 0, np.maximum(contact.form.Table()["tresca"], 0), 0)
    held = bound[:, None, None] * around * (np.tan(wedge) if d == 3 else 1.0)
    if rough == np.inf:  # without pressure, too
        pressed, held = np.broadcast_to(-normal, around.shape), around
    if contact.bilateral:
        pressed = np.concatenate([pressed, -pressed], axis=2)
    bounds = np.ones((len(normal), pressed.shape[2] + held.shape[2]))
    bounds[:, : None if rough == np.inf else pressed.shape[2]] = np.inf
    return Blocks(faces * np.concatenate([pressed, held], axis=2)), bounds.ravel()


def Blocks(tractions: np.ndarray) -> csr_matrix:
    """A (m, d, r) array as block diagonal sparse matrix (m d, m r)."""
    m, d, r = tractions.shape
    indices = np.arange(m * r).reshape(m, 1, r).repeat(d, axis=1)
    starts = np.arange(m * d + 1) * r
    return scipy.sparse.csr_matrix(
        (tractions.ravel(), indices.ravel(), starts), shape=(m * d, m * r)
    )


def Tangents(normal: np.ndarray) -> np.ndarray:
    """Directions (m, d, r) along the surface."""
    if normal.shape[1] == 2:
        tangent = np.stack([-normal[:, 1], normal[:, 0]], axis=1)
        return np.stack([tangent, -tangent], axis=2)
    axis = np.eye(3)[np.argmin(np.abs(normal), axis=1)]
    first = np.cross(normal, axis)
    first /= np.maximum(np.linalg.norm(first, axis=1), 1e-300)[:, None]
    second = np.cross(normal, first)
    angles = 2 * np.pi * np.arange(DIRECTIONS) / DIRECTIONS
    return first[:, :, None] * np.cos(angles) + second[:, :, None] * np.sin(angles)
