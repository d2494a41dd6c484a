# SPDX-License-Identifier: LGPL-2.1-or-later
"""Coefficients of a contact that depend on its own fields."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any, NoReturn

import numpy as np
from netgen.meshing import NgException
from ngsolve import (
    CF,
    CoefficientFunction,
    FESpace,
    GridFunction,
    InnerProduct,
    Parameter,
)
from ngsolve.comp import ProxyFunction

from ngslac._ngslac import HoldsProxy, LACSpace, ProxyPath
from ngslac.arguments import CheckFunction, CheckNumber, Coefficient, Wrong
from ngslac.output.facepoints import OnePoint
from ngslac.parallel.layout import LayoutOf

if TYPE_CHECKING:
    from ngslac.contact.flux import Flux

__all__ = [
    "COEFFICIENTS",
    "CheckScalar",
    "CheckedStarts",
    "Dependent",
    "Explained",
    "Expression",
    "Fields",
    "FluxName",
    "Law",
]

ZERO = str(CF(1).Diff(Parameter(0)))  # a derivative that is zero everywhere
TINY = 1e-150  # its square is a number, too
NEGLIGIBLE = 1e-120  # numbers that come of it alone are less
# Names of places, table columns and answers: the memory of a law may have none of them.
TAKEN = {"gap", "slip", "normal", "jump", "x", "area", "c", "trial", "traction", "status"}
TAKEN |= {"pressure", "friction", "fullarea"}
# The coefficients that may depend on the fields, with their least values.
COEFFICIENTS = {"friction": 0, "tresca": 0, "offset": -math.inf}


class Fields:
    """The fields of a contact as symbols: the argument of a coefficient that is a function.

    Numbers of the macro-elements, with which expressions are made and differentiated.

    Attributes
    ----------
    slip : CoefficientFunction
        Vector (d,) along the surface, of the present step, slave minus master; a length.
    rate : CoefficientFunction
        The slip over the length of the step: of time, or of the load of `LoadStepper`.
    gap : CoefficientFunction
        > 0 open; a length.
    pressure : CoefficientFunction
        >= 0 compression; stress units.
    traction : CoefficientFunction
        Vector (d,) on the slave; stress units. Not of a `Law`, which gives it.
    power : CoefficientFunction
        Of friction, >= 0: what slip turns into heat; stress times velocity, not of a `Law`.
    dt : CoefficientFunction
        Length of the step, a Parameter; 1 before the first one.
    c : CoefficientFunction
        Of a `Law`: the stiffness of the surface, by which a slip counts in the trial; stress over
        length.

    Examples
    --------
    Friction that falls with the speed of slip:

    >>> from ngsolve import Norm, exp
    >>> def Falling(z):
    ...     return 0.2 + 0.2 * exp(-Norm(z.rate) / 3)
    >>> (u, lam), _ = fes.TnT()
    >>> contact = LACContact(u, lam, master="master", friction=Falling)
    """

    def __init__(
        self,
        space: LACSpace,
        dt: Parameter,
        names: Sequence[str],
        *,
        hidden: Sequence[str] = (),
        sides: Sequence[str] = (),
        components: int | None = None,
    ):
        self._numbers, d = space.WithComponents(1), components or space.mesh.dim
        self.kept, self.memory, self.symbols, self.constants, self.dt = {}, {}, {}, {}, dt
        self.scalars, self._sides = {}, sides  # trial functions by the paths of their components
        self._names = [*names, *(f"{side.capitalize()}(T)" for side in sides)]
        for name in [*names, *hidden]:
            count = 1 if name in ("gap", "pressure") else d
            found = self.symbols[name] = [GridFunction(self._numbers) for _ in range(count)]
            if name in names:
                setattr(self, name, found[0] if count == 1 else CF(tuple(found)))
        if "slip" in names:
            self.rate = self.slip / dt
            self._names.append("rate")
        if "slip" in names and "traction" in names:
            self.power = -InnerProduct(self.traction, self.rate)
            self._names.append("power")
        if "trial" in names:
            self.constants["c"] = self.c = GridFunction(self._numbers)
            self._names.append("c")

    def __getattr__(self, name: str) -> NoReturn:
        names = ", ".join(self._names)
        raise AttributeError(f"there is no field {name!r} here: there are {names} and dt")

    def Slave(self, field: ProxyFunction) -> GridFunction:
        """Mean of a scalar field, such as a temperature, over the slave side of a macro-element.

        Parameters
        ----------
        field : trial function
            Scalar, of the product space of displacement and traction.

        Returns
        -------
        CoefficientFunction

        Raises
        ------
        ValueError, TypeError
            No such trial function; a `Law`, which sees none.
        """
        return self._Side(field, "slave")

    def Master(self, field: ProxyFunction) -> GridFunction:
        """The same where the macro-element meets the master. Tools and obstacles have none.

        Parameters
        ----------
        field : trial function

        Returns
        -------
        CoefficientFunction

        Raises
        ------
        ValueError, TypeError
            As of `Slave`; there is no master with a mesh.
        """
        return self._Side(field, "master")

    def _Side(self, field: ProxyFunction, side: str) -> GridFunction:
        """The symbol of a scalar field on one side."""
        if side not in self._sides:
            what = "a Law sees no scalar fields" if not self._sides else f"there is no {side}"
            jump = ", or what is tied by z.jump, the slave's less the master's"
            raise ValueError(
                f"{what}: give what it needs as a GridFunction or a Parameter"
                + (jump if "jump" in self._names else "")
            )
        return self.SidesOf(field)[side == "master"]

    def SidesOf(self, field: ProxyFunction) -> list[GridFunction]:
        """The symbols of a scalar field on both sides."""
        name = f"scalar {self.NumberOf(CheckScalar('field', field, ValueError))}"
        if name not in self.symbols:
            self.symbols[name] = [GridFunction(self._numbers) for _ in range(2)]
        return self.symbols[name]

    def NumberOf(self, field: ProxyFunction) -> int:
        """Number of a scalar field among all of them."""
        path = tuple(ProxyPath(field, "field"))
        self.scalars.setdefault(path, field)
        return list(self.scalars).index(path)

    def History(
        self,
        name: str,
        update: Callable[[GridFunction], CoefficientFunction],
        *,
        start: float = 0.0,
    ) -> CoefficientFunction:
        """Remember a number, such as a way, a wear or a damage; returns its present value.

        Parameters
        ----------
        name : str
            Under which it is in `LACContact.Table` and in saved states.
        update : callable
            Gets what it was when the step began, a CoefficientFunction, and returns what it is now.
        start : float
            Before the first step.

        Returns
        -------
        CoefficientFunction
            Of the present step: what `update` returned.

        Raises
        ------
        ValueError, TypeError
            A name that means something else, or is taken already; no function; no number.
        """
        CheckFunction("update", update, "a function of what it was before")
        if not isinstance(name, str) or not name.isidentifier():
            raise ValueError(f"History: name = {name!r} must be a word, as of a variable in Python")
        if name in self.kept:
            raise ValueError(f"History: {name!r} is kept already: take another name")
        self.kept |= CheckedStarts("History", {name: CheckNumber("start", start)})
        before = GridFunction(self._numbers)
        with Explained(f"History of {name}, which is a number,"):
            now = Expression(f"History of {name}", update(before))
        self.memory[name] = before, now
        return now

    @property
    def values(self) -> list[GridFunction]:
        """All symbols in a row."""
        return [symbol for symbols in self.symbols.values() for symbol in symbols]


def CheckScalar(
    name: str, field: ProxyFunction, kind: type[Exception] = TypeError
) -> ProxyFunction:
    """A trial function with one component; else an error of this kind."""
    if not isinstance(field, ProxyFunction) or field.dims or field.is_complex:
        wanted = "a scalar trial function of the product space, such as a temperature"
        raise Wrong(kind, name, field, wanted)
    return field


def Dependent(
    u: ProxyFunction,
    space: LACSpace,
    dt: Parameter,
    functions: dict[str, Callable[[Fields], CoefficientFunction]],
    fluxes: Sequence[Flux],
    *,
    tied: bool,
    sides: Sequence[str],
) -> dict[str, Any]:
    """Arguments of a ContactForm for coefficients and fluxes that depend on the fields."""
    names = ("slip", "gap", "pressure", "traction")  # in the order that the form knows
    seen = () if tied else names
    fields = Fields(space, dt, seen, hidden=[n for n in names if n not in seen], sides=sides)
    found = {}
    for name, function in functions.items():
        with Explained(f"{name}(z)"):
            value = getattr(function, "expression", function)(fields)
        found[name] = Expression(f"{name}(z)", value, COEFFICIENTS[name])
    flows = []
    for k, flux in enumerate(fluxes):
        fields.SidesOf(flux.field)
        flows.append((fields.NumberOf(flux.field), FluxName(k), *flux._On(fields)))
    slopes = {name: _Slopes(f"{name}(z)", f, fields.values) for name, f in found.items()}
    for _, name, *ends in flows:
        for end, flowing in zip(("out", "in"), ends, strict=True):
            slopes[name + end] = _Slopes("the flow of a Flux", flowing, fields.values)
    if "offset" in found and str(found["offset"].Diff(fields.gap)) != ZERO:
        raise ValueError("offset depends on z.gap, which holds the offset: take z.pressure or slip")
    for by_symbol in slopes.values():
        by_symbol[:] = [None if str(slope) == ZERO else slope for slope in by_symbol]
    return found | {
        "fields": fields.values,
        "slopes": slopes,
        "scalars": [Trial(u.space, *scalar) for scalar in fields.scalars.items()],
        "flows": flows,
        "kept": fields.kept,
        "memory": fields.memory,
    }


def Trial(space: FESpace, path: Sequence[int], field: ProxyFunction) -> ProxyFunction:
    """The trial function of a component, which `field` is."""
    if field.space != space:
        raise ValueError("field lives on another space than u and lam: take their product space")
    found, component = space.TrialFunction(), space
    for number in path:
        found, component = found[number], component.components[number]
    touched = component.GetDofs(component.mesh.Boundaries(".*")).NumSet()
    if not LayoutOf(component).together.Sum(touched):
        raise ValueError(
            f"field lives on a space of type {type(component).__name__}, which has no degrees of "
            "freedom of its own on boundaries: take a continuous one, such as H1"
        )
    return found


def FluxName(number: int) -> str:
    """Beginning of the names of two columns of `LACContact.Table`."""
    return f"flux{number + 1 if number else ''}_"


class Law:
    """A contact law as an expression of the contact's fields, for `LACContact` (``law=``).

    NGSolve differentiates it. Contact is soft then: a traction needs a gap, a slip or a jump, or
    for laws that stick a ``trial``, see the how-to "A law of your own".

    Parameters
    ----------
    traction : callable
        Gets the `Fields` and returns the traction on the slave, a CoefficientFunction with d
        components: a pressure p is ``-p * z.normal``. Besides ``slip``, ``rate`` and ``gap`` they
        have ``normal`` (d,) out of the slave, ``jump`` (d,) = slip - gap normal, and ``trial``
        (d,); of tied surfaces ``jump``, and with small sliding ``normal``. Functions of the place,
        Parameters and GridFunctions count, too.

    Raises
    ------
    TypeError
        No function.

    Examples
    --------
    A layer whose pressure grows with the square of its compression:

    >>> from ngsolve import IfPos
    >>> from ngslac import Law
    >>> (u, lam), _ = fes.TnT()
    >>> layer = Law(lambda z: -IfPos(z.gap, 0, 1e3 * z.gap**2) * z.normal)
    >>> contact = LACContact(u, lam, master="master", law=layer)
    """

    def __init__(self, traction: Callable[[Fields], CoefficientFunction]):
        if traction is None:
            raise Wrong(TypeError, "traction", traction, "a function of fields")
        self._traction = CheckFunction("traction", traction, "a function of fields")

    def _On(
        self, space: LACSpace, dt: Parameter, components: int, *, tied: bool, finite: bool
    ) -> _LawOnFaces:
        """The law of a contact, from places to arrays."""
        names = ("slip", "gap", "normal", "jump", "trial")
        if tied:
            names = ("jump",) if finite or components == 1 else ("jump", "normal")
        fields = Fields(space, dt, names, components=components)
        return _LawOnFaces(self._traction, space, fields, components)


class _LawOnFaces:
    """Evaluates an expression and its derivatives for all macro-elements at once."""

    def __init__(
        self,
        traction: Callable[[Fields], CoefficientFunction],
        space: LACSpace,
        fields: Fields,
        d: int,
    ):
        self._space, self._fields = space, fields
        with Explained("the traction of a Law"):
            found = traction(fields)
        if d == 1:
            instead = "the jump of what is tied, z.jump"
            found = CF((Expression("the traction of a Law", found, instead=instead),))
        if not isinstance(found, CoefficientFunction) or found.dim != d:
            raise ValueError(
                f"the traction of a Law must have {d} components, such as z.normal, or a CF of "
                "numbers: return it"
            )
        self.kept, rows = fields.kept, [found] if d == 1 else [found[k] for k in range(d)]
        self._parts, flat = [("traction", d)], list(rows)
        for name, symbols in fields.symbols.items():
            self._parts.append((f"by_{name}", d * len(symbols)))
            for row in rows:
                flat += _Slopes("the traction of a Law", row, symbols)
        for name, (_, now) in fields.memory.items():
            self._parts.append((name, 1))
            flat.append(now)
        self._expression, self._known = CF(tuple(flat)).Compile(), None

    def __call__(self, places: dict[str, np.ndarray]) -> dict[str, np.ndarray]:
        """Traction and slopes in the middles of the slave's faces, which the form asks for."""
        points, owner = self._Points()
        for name, symbols in self._fields.symbols.items():
            values = places[name].reshape(len(places["area"]), -1).copy()
            if name in ("slip", "jump"):  # where the length of 0 has a derivative
                values[~np.any(values, axis=1), 0] = TINY
            for symbol, column in zip(symbols, values.T, strict=True):
                symbol.vec.FV().NumPy()[:] = column
        for name, (before, _) in self._fields.memory.items():
            before.vec.FV().NumPy()[:] = places[name]
        for name, constant in self._fields.constants.items():
            constant.vec.FV().NumPy()[:] = places[name]
        values = self._expression(points)
        means = np.zeros((len(places["area"]), values.shape[1]))
        np.add.at(means, owner, values)
        means /= np.bincount(owner, minlength=len(means))[:, None]
        means[np.abs(means) < NEGLIGIBLE] = 0
        ends = np.cumsum([size for _, size in self._parts])[:-1]
        columns = np.split(means, ends, axis=1)
        return {name: c for (name, _), c in zip(self._parts, columns, strict=True)}

    def _Points(self) -> tuple[np.ndarray, np.ndarray]:
        """The middles of the slave's faces, and the macro-element of each."""
        space, mesh = self._space, self._space.mesh
        known = mesh.nv, mesh.ne, space.nmacros
        if self._known != known:
            fields = self._fields
            memory = [before for before, _ in fields.memory.values()]
            for field in (*fields.values, *fields.constants.values(), *memory):
                if len(field.vec) != space.nmacros:
                    field.space.Update(), field.Update()
            self._at = mesh.MapToAllElements(OnePoint(), space.slave)
            macros = np.array(space.macros)
            self._owner, self._known = macros[macros >= 0], known
        return self._at, self._owner


@contextmanager
def Explained(name: str) -> Iterator[None]:
    """Add to an error of NGSolve which expression caused it, and the usual reason."""
    try:
        yield
    except (NgException, TypeError) as error:
        raise ValueError(
            f"{name} is no expression that NGSolve can differentiate: a vector and a number do not "
            "add up, a power that is no whole number is exp(a * log(.)), IfPos stands for if, max "
            f"and min, and functions are those of ngsolve. NGSolve says: {error}"
        ) from error


def _Slopes(
    name: str, expression: CoefficientFunction, symbols: Sequence[GridFunction]
) -> list[CoefficientFunction]:
    """Derivatives of an expression by symbols."""
    with Explained(name):
        return [expression.Diff(symbol) for symbol in symbols]


def Expression(
    name: str,
    value: Any,
    least: float = -math.inf,
    *,
    instead: str = "its means, z.Slave(T) and z.Master(T)",
) -> CoefficientFunction:
    """The answer of a function of the fields, checked; `instead` of a trial function in words."""
    if value is None:
        raise Wrong(TypeError, name, value, "an expression of the fields: return it")
    found = Coefficient(name, value, least)
    if HoldsProxy(found):
        raise ValueError(f"{name} holds a trial function: take {instead}")
    return found


def CheckedStarts(
    whose: str, starts: dict[str, float | Sequence[float] | np.ndarray]
) -> dict[str, np.ndarray]:
    """The memory of a macro-element before the first step: arrays by name."""
    for name, start in starts.items():
        if not isinstance(name, str) or name in TAKEN or name.startswith("by_"):
            raise ValueError(f"{whose} has {name!r}, which means something else: rename it")
        values = np.asarray(start)
        if values.ndim > 1 or not values.size or values.dtype.kind not in "fiu":
            raise Wrong(ValueError, f"{whose}[{name!r}]", start, "a number, or a vector (k)")
        if not np.all(np.isfinite(values)):
            raise Wrong(ValueError, f"{whose}[{name!r}]", start, "finite")
    return {name: np.atleast_1d(np.asarray(start, dtype=float)) for name, start in starts.items()}
