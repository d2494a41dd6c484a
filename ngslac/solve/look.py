# SPDX-License-Identifier: LGPL-2.1-or-later
"""A second look at a converged state, which does not know how it was found."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from ngsolve import Grad, GridFunction, InnerProduct, Integrate

from ngslac.arguments import ShownPoint
from ngslac.bodies.messages import DrivenMessage, IdleMessage
from ngslac.contact.certificate import PointsInside
from ngslac.contact.fields import FluxName
from ngslac.errors import ContactConvergenceError, FloatingBodyError
from ngslac.solve.inverted import InvertedError

if TYPE_CHECKING:
    from ngslac.contact.contact import LACContact
    from ngslac.contact.flux import Flux
    from ngslac.solve.system import System

__all__ = ["BORNE", "Look", "MechanismError"]

# Slip since the pairing, over the size of a macro-element, that small sliding is not made for.
STRAYED = 0.5
# Forces that hold idle bodies, relative to those of contact, which are more than an error of mesh.
BORNE = 1e-2
# Gradient of a displacement, on average over a body, that small strains are not made for; range of
# displacements over the size of the mesh below which it is not looked at.
LARGE, SMALL = 0.2, 0.01


class MechanismError(FloatingBodyError):
    """Loads do work on a motion that nothing resists in a state that has converged."""


class Look:
    """What a state of bulk and contact says of itself."""

    def __init__(self, system: System):
        self.system = system

    def __call__(self) -> None:
        """Raise an error if the state is none, and note what may not be meant."""
        self.system.notes.clear()
        self._LookAtElements()
        self._LookAtMotions()
        self._LookAtWays()
        self._LookAtDepths()
        self._LookAtPoints()
        self._LookAtSliding()
        self._LookAtRotations()
        self._LookAtFlows()

    def _Say(self, kind: str, message: str) -> None:
        """Note a message, if there is one."""
        if message:
            self.system.notes[kind] = message

    def _LookAtElements(self) -> None:
        """Are elements inside out?"""
        known, others = self.system.Inverted()
        if known:
            raise InvertedError(known + "; take smaller steps, or a finer mesh there")
        self._Say("inverted", others and others + ": the material knows small strains only there")

    def _LookAtMotions(self) -> None:
        """Motions that loads drive and nothing but curved contact holds, or that nothing drives."""
        system = self.system
        free = system.Freedom("rubbing", slides=True) if system.MayFloat() else None
        if free and system.IsDriven(free, "rubbing"):
            raise MechanismError(DrivenMessage(system.DrivenMotion(free, "rubbing")))
        self._Say("idle", IdleMessage(system.bodies.Names(free.weights)) if free else "")
        if free and system.residual.borne > BORNE:
            self._Say(
                "borne",
                f"up to {system.residual.borne:.1%} of the contact forces push bodies aside that "
                "nothing drives, as facets of their meshes lean: refine the slave where it touches",
            )

    def _LookAtWays(self) -> None:
        """Bodies that have gone through another one, and are far behind it."""
        if found := self.system.Passed():
            way, place = found
            raise ContactConvergenceError(
                f"the slave around {ShownPoint(place)} has moved by {way:.3g} through the master "
                "that it faced, and touches nothing: take smaller steps"
            )
        if (place := self.system.PassedTool()) is not None:
            raise ContactConvergenceError(
                f"the slave around {ShownPoint(place)} has gone through the tool: take smaller "
                "steps"
            )

    def _LookAtDepths(self) -> None:
        """Parts of a slave so deep in the master that contact does not see them."""
        for number, contact in enumerate(self.system.contacts):
            message = self._Depth(contact) if contact.active else ""
            if message and contact.finite:
                raise ContactConvergenceError(message)
            self._Say(f"depth {number}", message)

    def _Depth(self, contact: LACContact) -> str:
        """How deep some of the slave lies in the master where contact sees nothing, in words."""
        table = contact.Table()
        if np.all(table["area"] > 0.5 * table["fullarea"]):
            return ""
        depths = contact._Depths()
        if not np.any(depths):
            return ""
        deepest, inside = int(np.argmax(depths)), "tool" if contact.tool else "master"
        return (
            f"{np.count_nonzero(depths)} macro-elements of the slave lie inside of the {inside}, "
            f"up to {depths[deepest]:.3g} deep around {ShownPoint(table['x'][deepest])}, where "
            "contact does not see them and no force acts: give penetration = "
            f"{1.1 * depths[deepest]:.3g}, move the bodies apart, or take smaller steps"
        )

    def _LookAtPoints(self) -> None:
        """Corners and edges that lie inside of another body, where the mean gap is open."""
        for number, contact in enumerate(self.system.contacts):
            if found := PointsInside(contact, self.system.gf):
                depth, place, size = found
                self._Say(
                    f"points {number}",
                    f"the bodies overlap by {depth:.3g} around {ShownPoint(place)}, where contact "
                    f"is open: macro-elements, {size:.3g} large, do not see a corner or an edge "
                    "there. Refine the slave there",
                )

    def _LookAtSliding(self) -> None:
        for number, contact in enumerate(self.system.contacts):
            self._Say(f"slid {number}", self._Slid(contact))

    def _Slid(self, contact: LACContact) -> str:
        """Does a closed macro-element touch what it was paired with, and has slid away from?"""
        table = contact.Table()
        far = np.linalg.norm(contact._Slid(), axis=1) * (table["status"] > 0)
        size = contact._Sizes()
        worst = int(np.argmax(far / size)) if len(far) else 0
        if not len(far) or far[worst] <= STRAYED * size[worst]:
            return ""
        return (
            f"the slave has slid by {far[worst]:.3g} around {ShownPoint(table['x'][worst])} since "
            f"it was paired, where macro-elements are {size[worst]:.3g} large: small sliding keeps "
            "the partners of the start. Give LACContact finite=True, or call contact.Update(gf) "
            "between steps"
        )

    def _LookAtFlows(self) -> None:
        """Fields that flow through contact from their lower to their higher side."""
        for number, contact in enumerate(self.system.contacts):
            if contact.components == 1 and contact.own_law:
                self._LookAtLaw(number, contact.form.Table())
            elif contact.fluxes:
                self._LookAtFluxes(number, contact.fluxes, contact.form.Table())

    def _LookAtLaw(self, number: int, table: dict[str, np.ndarray]) -> None:
        """That of a tied scalar field, as the last Newton step knew it."""
        power = table["jump"] * table["traction"][:, 0]
        uphill = min(table["area"] @ power, table["area"] @ table["growth"]) > 0
        message = (
            f"through contact number {number} the field flows from its lower to its higher side: "
            "is the sign of law right? It gives what flows into the slave"
        )
        self._Say(f"flow {number}", message if uphill else "")

    def _LookAtFluxes(
        self, number: int, fluxes: Sequence[Flux], table: dict[str, np.ndarray]
    ) -> None:
        """Each `Flux`, without the heat that it sets free."""
        for k, flux in enumerate(fluxes):
            name, parts = FluxName(k), {"out": 1 - flux.share, "in": flux.share}
            flow = sum(part * table[name + end] for end, part in parts.items())
            growth = sum(part * table[f"{name}growth_{end}"] for end, part in parts.items())
            power = flow * table[name + "jump"]
            uphill = max(table["area"] @ growth, table["area"] @ power) < 0
            message = (
                f"flux number {k} of contact number {number} flows from the lower side of its "
                "field to the higher one: is its sign right? It counts from the slave to the master"
            )
            self._Say(f"flow {number} {k}", message if uphill else "")

    def _LookAtRotations(self) -> None:
        """Rotations and strains that a bulk form does not know which is linear."""
        system = self.system
        form = system.contacts[0].form
        first = form.offset * form.fes.dim
        values = system.values[first : first + form.component.ndof * form.fes.dim]
        mesh = system.gf.space.mesh
        tied = all(contact.tied for contact in system.contacts)  # of whatever fields
        if tied or not system.bulk.islinear or np.ptp(values) <= SMALL * system.residual.size:
            return
        u = GridFunction(form.component)
        u.vec.FV().NumPy()[:] = values
        squares = Integrate(InnerProduct(Grad(u), Grad(u)), mesh, order=2, region_wise=True)
        volumes = Integrate(1.0, mesh, order=0, region_wise=True)
        mean = np.sqrt(np.asarray(squares) / np.asarray(volumes))
        worst = int(np.argmax(mean))
        self._Say(
            "linear",
            ""
            if mean[worst] <= LARGE
            else f"the gradient of the displacement is {mean[worst]:.2g} on average in "
            f"'{mesh.GetMaterials()[worst]}': the bulk form is linear and knows small strains and "
            "rotations only. Take an energy that knows large ones, or look at the units of loads "
            "and moduli",
        )
