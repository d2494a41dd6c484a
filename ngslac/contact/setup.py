# SPDX-License-Identifier: LGPL-2.1-or-later
"""The arguments of a contact, checked."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any, NoReturn

from ngsolve import CoefficientFunction, GridFunction, Parameter, Region
from ngsolve.comp import ProxyFunction

from ngslac._ngslac import HoldsGridFunction, RegionWithFaces
from ngslac.arguments import (
    CheckFlag,
    CheckFunction,
    CheckInstance,
    CheckOnMesh,
    CheckPositive,
    Coefficient,
    IsFunction,
    Wrong,
)
from ngslac.contact.fields import COEFFICIENTS, CheckedStarts, Dependent, Law
from ngslac.parallel.form import Compiled, MakeForm
from ngslac.tools import SignedDistance, Tool

if TYPE_CHECKING:
    from ngslac.contact.flux import Flux

__all__ = ["CheckedSetup"]


def CheckedSetup(
    u: ProxyFunction,
    lam: ProxyFunction,
    master: Region | str | None,
    functions: dict[str, Any],
    flags: dict[str, bool],
    lengths: dict[str, float | None],
    law: Law | Callable | None,
    fluxes: Sequence[Flux],
    dt: Parameter,
) -> tuple[Tool | None, dict[str, Any]]:
    """The tool, and the arguments of a ContactForm, as a dict; those here are as in LACContact."""
    names = "obstacle", "friction", "tresca", "offset"
    obstacle, friction, tresca, offset = map(functions.get, names)
    tied, bilateral, finite, edges = map(flags.get, ("tied", "bilateral", "finite", "edges"))
    for name, proxy in {"u": u, "lam": lam}.items():
        if not isinstance(proxy, ProxyFunction):
            raise Wrong(TypeError, name, proxy, "a trial function of a product space")
    if (master is None) == (obstacle is None):
        raise ValueError("give either master= or obstacle=, not both and not none")
    flags = {name: CheckFlag(name, value) for name, value in flags.items()}
    if tied and (friction is not None or tresca is not None):
        raise ValueError("tied surfaces do not slide: drop friction and tresca, or tied")
    if isinstance(law, type) or not hasattr(law, "_On"):
        CheckFunction("law", law, "a function from places to tractions, or a Law")
    if law is not None and (bilateral or edges or (friction, tresca) != (None, None)):
        raise ValueError(
            "a law of your own says all: drop law, or bilateral, edges, friction and tresca"
        )
    if tied and (offset is not None or bilateral):
        raise ValueError("tied surfaces keep their distance: drop offset and bilateral, or tied")
    if edges and (finite or tied or bilateral or master is None):
        raise ValueError(
            "edges need small sliding on a master: drop edges, or finite, tied, bilateral and "
            "obstacle"
        )
    if tied and lengths["adjust"] is not None:
        raise ValueError(
            "tied surfaces keep their distance: drop adjust; maxdist says how far a tie reaches"
        )
    if u.dim == 1 and not (tied and master is not None and not finite and not fluxes):
        raise ValueError(
            "u is a scalar field, which can be tied to that of a master, no more: give tied=True, "
            "and drop finite, obstacle and flux; a displacement has as many components as the mesh "
            "has dimensions, as VectorH1 has"
        )
    for name, value in lengths.items():
        if value is not None:
            CheckPositive(name, value, "a positive length")
    mesh = u.space.mesh
    for name, function in functions.items():
        if hasattr(function, "_On"):
            raise ValueError(
                f"{name} is a Law, which stands for the whole contact: give it as law="
            )
    dependent = {k: f for k, f in functions.items() if k in COEFFICIENTS and IsFunction(f)}
    if dependent and edges:
        raise ValueError(f"edges need a {next(iter(dependent))} that is no function of the contact")
    if dependent and law is not None:
        raise ValueError(
            "a law of your own says all: put what offset depends on into the law, in which a "
            "smaller z.gap is the same"
        )
    if fluxes and edges:
        raise ValueError("edges know no flux: drop edges, or flux")
    functions = functions | dict.fromkeys(dependent)
    for name, value in functions.items():
        CheckOnMesh(name, value, mesh)
        plain = isinstance(value, GridFunction) or not isinstance(value, CoefficientFunction)
        if mesh.comm.size > 1 and not plain and HoldsGridFunction(value):
            raise ValueError(
                f"{name} holds a GridFunction: on a distributed mesh give one as it is, or a "
                "function of place and Parameters"
            )
    region = None if master is None else RegionWithFaces(mesh, "master", master)
    tool = _ToolOf(obstacle, mesh.dim, flags)
    functions = functions | {"obstacle": None if tool else obstacle}
    functions = {
        name: Coefficient(name, value, COEFFICIENTS.get(name, -math.inf))
        for name, value in functions.items()
    }
    lengths = {name: value or 0.0 for name, value in lengths.items()}
    compiled = None if tool is None else tool.compiled
    setup = {"u": u, "lam": lam, "master": region, "tool": compiled} | functions | flags | lengths
    expression = hasattr(law, "_On")
    space = Compiled(MakeForm(setup)).space if dependent or expression or fluxes else None
    if expression:
        law = law._On(space, dt, u.dim, tied=flags["tied"], finite=flags["finite"])
    kept = CheckInstance("law.kept", getattr(law, "kept", {}), dict, "a dict of numbers or vectors")
    if law is not None and not expression:
        numpy_law = law
        law = lambda places: numpy_law(Places(places))  # noqa: E731
    setup |= {"law": law, "kept": CheckedStarts("law.kept", kept)}
    if dependent or fluxes:
        sides = ("slave",) if region is None else ("slave", "master")
        fields = Dependent(u, space, dt, dependent, fluxes, tied=flags["tied"], sides=sides)
        if law is not None and fields["kept"]:
            raise ValueError("a flux beside law remembers nothing: drop z.History from the flux")
        setup |= fields
    return tool, setup


class Places(dict):
    """Arrays by name, for a law in NumPy."""

    def __getattr__(self, name: str) -> NoReturn:
        raise AttributeError(
            f"places has no attribute {name!r}: a law in NumPy takes places[{name!r}]; a function "
            "that returns an expression of fields is given as law=Law(function)"
        )


def _ToolOf(
    obstacle: CoefficientFunction | Tool | float | None, dim: int, flags: dict[str, bool]
) -> Tool | None:
    """The tool; None for a gap function of small sliding, or no obstacle."""
    if obstacle is None or not (flags["finite"] or isinstance(obstacle, Tool)):
        return None
    if not flags["finite"]:
        raise ValueError("obstacle is a tool in space, which needs finite=True")
    if flags["tied"]:
        raise ValueError("a tool with finite=True cannot be tied: drop tied, or mesh the tool")
    if not isinstance(obstacle, Tool):
        wanted = "a tool of ngslac.tools, or a signed distance as a function of x, y, z"
        CheckInstance("obstacle", obstacle, CoefficientFunction, wanted + ", with finite=True")
        obstacle = SignedDistance(obstacle, dim=dim)
    if obstacle.dim != dim:
        raise ValueError(f"obstacle is a tool in {obstacle.dim}D, the mesh is in {dim}D")
    return obstacle
