# SPDX-License-Identifier: LGPL-2.1-or-later
"""Flow through a contact: heat, current, a leak."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING

from ngsolve import CF, CoefficientFunction

from ngslac.arguments import CheckFunction, CheckNumber, Wrong
from ngslac.contact.fields import CheckScalar, Explained, Expression, Fields

if TYPE_CHECKING:
    from ngsolve.comp import ProxyFunction

__all__ = ["CheckFluxes", "Flux"]


class Flux:
    """What flows through a contact, as heat or current does, for `LACContact` (``flux=``).

    It adds to the equation of a scalar field, one number for each macro-element: the bulk form has
    the conduction in both bodies, such as ``k * grad(T) * grad(S) * dx``.

    Parameters
    ----------
    field : ngsolve trial function
        Scalar, of the product space of displacement and traction: a temperature, a potential.
    flow : callable
        Gets the `Fields` and returns what flows from the slave to the master, per area (of the
        reference configuration) and time: an expression of ``z.Slave(T)`` and ``z.Master(T)``, and
        of pressure, gap, slip and so on.
    heat : callable, optional
        Gets the same and returns what is set free between the surfaces, such as ``z.power``, that
        of friction.
    share : float
        From 0 to 1: the part of `heat` that the slave gets. Two half-spaces share it as their
        effusivities, sqrt(conductivity * density * heat capacity).

    Raises
    ------
    TypeError, ValueError
        No scalar trial function; no function; a share outside of 0 to 1.

    Examples
    --------
    A conductance that grows with the pressure, and heat of friction:

    >>> from ngslac import Flux
    >>> V, W = VectorH1(mesh, order=2, dirichlet="bottom|top"), H1(mesh, order=2)
    >>> (u, T, lam), (v, S, mu) = (V * W * LACSpace(V, slave="slave")).TnT()
    >>> film = Flux(T, lambda z: 5 * z.pressure * (z.Slave(T) - z.Master(T)),
    ...             heat=lambda z: z.power, share=0.4)
    >>> contact = LACContact(u, lam, master="master", friction=0.3, flux=film)
    """

    def __init__(
        self,
        field: ProxyFunction,
        flow: Callable[[Fields], CoefficientFunction],
        *,
        heat: Callable[[Fields], CoefficientFunction] | None = None,
        share: float = 0.5,
    ):
        self.field = CheckScalar("field", field)
        if flow is None:
            raise Wrong(TypeError, "flow", flow, "a function of fields")
        self._flow = CheckFunction("flow", flow, "a function of fields")
        self._heat = CheckFunction("heat", heat, "a function of fields")
        self.share = CheckNumber("share", share, "a number from 0 to 1", lambda f: 0 <= f <= 1)

    def _On(self, fields: Fields) -> tuple[CoefficientFunction, CoefficientFunction]:
        """Out of the slave, and into the master."""
        with Explained("the flow of a Flux"):
            flow = self._flow(fields)
            heat = CF(0) if self._heat is None else self._heat(fields)
        flow = Expression("the flow of a Flux", flow)
        heat = Expression("the heat of a Flux", heat)
        return flow - self.share * heat, flow + (1 - self.share) * heat


def CheckFluxes(flux: Flux | Sequence[Flux] | None) -> tuple[Flux, ...]:
    """None, a Flux or several of them, as a tuple."""
    if flux is None:
        return ()
    fluxes = tuple(flux) if isinstance(flux, list | tuple) else (flux,)
    for one in fluxes:
        if not isinstance(one, Flux):
            raise Wrong(TypeError, "flux", one, "a Flux, or a list of them")
    if len({id(one) for one in fluxes}) < len(fluxes):
        raise ValueError("flux holds the same Flux twice, which would count twice: drop one")
    return fluxes
