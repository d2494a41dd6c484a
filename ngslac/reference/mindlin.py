# SPDX-License-Identifier: LGPL-2.1-or-later
"""Partial slip under a tangential load at constant normal load (Cattaneo, Mindlin)."""

from collections.abc import Callable
from dataclasses import dataclass, fields, replace
from functools import cached_property, wraps
from math import pi
from typing import Any, ClassVar

import numpy as np

from ._checks import finite, instance, nonnegative, points
from ._means import semi_ellipse, semi_ellipse_mean
from ._polygons import semi_ellipsoid_mean
from .hertz import HertzLine, HertzPoint

__all__ = ["CattaneoMindlin", "CattaneoMindlinPoint", "MindlinPointReversal", "MindlinReversal"]


def _FieldType(state: "PartialSlip | Reversal", name: str) -> type:
    """The class that the annotation of a field asks for."""
    return {field.name: field.type for field in fields(state)}[name]


class PartialSlip:
    """A Hertz contact, loaded further when the normal load is complete; checked.

    Children have the fields `hertz`, `friction`, and the load.
    """

    _LOAD, _MOVE, _LIMIT = "shear", "slide", "friction * hertz.force"

    def __post_init__(self) -> None:
        """Check friction and load."""
        instance("hertz", self.hertz, _FieldType(self, "hertz"))
        name, load = self._LOAD, self._load
        finite(name, load)
        nonnegative("friction", self.friction)
        if abs(load) > self.limit * (1.0 + 1e-12):
            raise ValueError(
                f"{name} = {load!r} is not valid: the bodies would {self._MOVE}, "
                f"keep |{name}| <= {self._LIMIT} = {self.limit!r}"
            )

    @property
    def _load(self) -> float:
        return getattr(self, self._LOAD)

    @property
    def _scale(self) -> float:
        return np.sign(self._load) * self.friction * self.hertz.peak

    @property
    def limit(self) -> float:
        """Load F P at which all slips."""
        return self.friction * self.hertz.force

    @property
    def stick(self) -> float:
        """Half width or radius c of the stick zone (length)."""
        return self.ratio * self.hertz._size


@dataclass(frozen=True, kw_only=True)
class Reversal:
    """A load brought back from `start`: that state less twice the one of half the change."""

    start: Any
    _LOAD: ClassVar[str] = "shear"  # the field that holds the load, of `start` too

    def __post_init__(self) -> None:
        """Check the start and the load."""
        instance("start", self.start, _FieldType(self, "start"))
        name, now, before = self._LOAD, *self._Loads()
        finite(name, now)
        if abs(now) > abs(before):
            raise ValueError(
                f"{name} = {now!r} is not valid: keep |{name}| <= |start.{name}| = "
                f"{abs(before)!r}, beyond it use a {type(self.start).__name__} with this {name}"
            )

    def _Loads(self) -> tuple[float, float]:
        return getattr(self, self._LOAD), getattr(self.start, self._LOAD)

    @cached_property
    def _change(self) -> PartialSlip:
        now, before = self._Loads()
        return replace(self.start, **{self._LOAD: 0.5 * (before - now)})

    @property
    def ratio(self) -> float:
        """Part b/a of the contact that has not slipped since the reversal."""
        return self._change.ratio

    @property
    def stick(self) -> float:
        """Half width or radius b of that part (length)."""
        return self._change.stick


def superposed(method: Callable) -> Callable:
    """A method of `Reversal` from that of its states, for anything linear in the tractions."""

    @wraps(method)
    def of(self, *where: float | np.ndarray, **named) -> float | np.ndarray:
        before, change = (method(state, *where, **named) for state in (self.start, self._change))
        if isinstance(before, tuple):
            return tuple(b - 2.0 * c for b, c in zip(before, change, strict=True))
        return before - 2.0 * change

    return of


class _Sheared(PartialSlip):
    """A tangential force Q, uncoupled from the pressure."""

    def __post_init__(self) -> None:
        """Check the load, and that pressure and friction are not coupled."""
        super().__post_init__()
        if abs(self.hertz.beta) > 1e-12:
            raise ValueError(
                f"hertz = {self.hertz!r} is not valid: its pressure and friction are coupled "
                f"(beta = {self.hertz.beta:.3g}), give both bodies the same material"
            )

    @property
    def ratio(self) -> float:
        """Stick ratio c/a, from 1 (no tangential load) to 0 (sliding)."""
        if self.shear == 0:
            return 1.0
        return max(0.0, 1.0 - abs(self.shear) / self.limit) ** self._POWER

    def _Rest(self, shape: Callable, *where: float | np.ndarray) -> float | np.ndarray:
        """Sliding friction of that shape over the contact, less that of the stick zone."""
        outer, inner = (shape(*where, size) for size in (self.hertz._size, self.stick))
        return self._scale * (outer - self.ratio * inner)


@dataclass(frozen=True, kw_only=True)
class CattaneoMindlin(_Sheared):
    """A Hertz line contact, loaded tangentially after the normal load is complete.

    The contact sticks for |x| < c and slips for c < |x| < a, with c = a sqrt(1 - |Q|/(F P)) and

        tau(x) = sign(Q) F p0 (sqrt(1 - x^2/a^2) - (c/a) sqrt(1 - x^2/c^2)),

    where each root counts as zero where its argument is negative. Valid where tangential tractions
    leave the pressure alone, that is for `hertz.beta == 0`, as with equal materials. Sources:
    Cattaneo (1938); Mindlin, J. Appl. Mech. 16 (1949) 259; Johnson, Contact Mechanics (Cambridge,
    1985), section 7.2.

    Parameters
    ----------
    hertz : HertzLine
        The normal contact; gives P, a, p0 and E*.
    shear : float
        Resultant Q, per length, of the tangential tractions on the slave; |Q| <= F P. It balances
        the tangential load that is put on the slave body.
    friction : float
        Coefficient of friction F >= 0.

    Raises
    ------
    ValueError
        If the bodies would slide, or are of different materials.

    Examples
    --------
    >>> hertz = HertzLine(force=100, radius1=50, young1=1e5, nu1=0.3, young2=1e5, nu2=0.3)
    >>> partial = CattaneoMindlin(hertz=hertz, shear=15, friction=0.2)
    >>> print(f"{partial.ratio:.3f} {partial.Traction(0) / (0.2 * hertz.peak):.3f}")
    0.500 0.500
    """

    hertz: HertzLine
    shear: float
    friction: float
    _POWER = 1.0 / 2.0

    def Traction(self, x: float | np.ndarray) -> float | np.ndarray:
        """Tangential traction (stress, of the sign of Q) on the slave, see `HertzLine.Pressure`."""
        return self._Rest(semi_ellipse, x)

    def MeanTraction(self, x0: float | np.ndarray, x1: float | np.ndarray) -> float | np.ndarray:
        """Exact average of the traction over intervals, see `HertzLine.MeanPressure`."""
        return self._Rest(semi_ellipse_mean, x0, x1)

    def Slip(self, x: float | np.ndarray) -> float | np.ndarray:
        """Tangential slip of the slave against the master.

        The integral of the slip gradient sqrt(x^2 - c^2) 2 F p0 / (E* a) over the slip zone
        (Johnson, section 7.2), against the traction. For |Q| = F P the rigid sliding is left out.

        Parameters
        ----------
        x : float or array
            Distance from the middle (length).

        Returns
        -------
        float or array
            Length, of the shape of `x`; NaN for |x| > a, where the surfaces do not touch.
        """
        x, c, a = points("x", x), self.stick, self.hertz.halfwidth
        distance = np.maximum(np.abs(x), c)
        area = distance * np.sqrt(distance**2 - c**2)
        if c > 0:
            area = area - c**2 * np.arccosh(distance / c)
        slip = -self._scale / (self.hertz.modulus * a) * area
        return np.where(np.abs(x) <= a, slip, np.nan)[()]

    def Reverse(self, shear: float) -> "MindlinReversal":
        """State after the load has gone back to `shear`, see `MindlinReversal`.

        Returns
        -------
        MindlinReversal
        """
        return MindlinReversal(start=self, shear=shear)


@dataclass(frozen=True, kw_only=True)
class CattaneoMindlinPoint(_Sheared):
    """A Hertz point contact, loaded tangentially after the normal load is complete.

    The contact sticks for r < c and slips for c < r < a, with c = a (1 - |Q|/(F P))^(1/3) and

        tau(r) = sign(Q) F p0 (sqrt(1 - r^2/a^2) - (c/a) sqrt(1 - r^2/c^2)),

    all in the direction of Q; roots, materials, loads and errors are as in `CattaneoMindlin`.

    All conditions hold but one: for Poisson ratios other than zero, slip also has a component
    across the load (see `Slip`; up to 0.18 of that along for nu = 0.3), to which the friction
    should turn. So the solution is exact for nu = 0 and otherwise approximate in the slip zone:
    computed tractions have a small component across the load, and the computed stick zone is not
    quite a circle. Sources: as for the line contact; Johnson, section 7.2(d).

    Parameters
    ----------
    hertz : HertzPoint
        The normal contact; gives P, a, p0 and the elastic constants.

    Examples
    --------
    >>> hertz = HertzPoint(force=100, radius1=50, young1=1e5, nu1=0.3, young2=1e5, nu2=0.3)
    >>> partial = CattaneoMindlinPoint(hertz=hertz, shear=17.5, friction=0.2)
    >>> print(f"{partial.ratio:.3f} {partial.Traction(0) / (0.2 * hertz.peak):.3f}")
    0.500 0.500
    >>> state = CattaneoMindlinPoint.FromShift(hertz=hertz, shift=1e-4, friction=0.2)
    >>> print(f"{state.shear:.4f}")
    3.5819
    """

    hertz: HertzPoint
    shear: float
    friction: float
    _POWER = 1.0 / 3.0

    @classmethod
    def FromShift(
        cls, *, hertz: HertzPoint, shift: float, friction: float
    ) -> "CattaneoMindlinPoint":
        """State after the far parts of the bodies have moved; else as in `CattaneoMindlinPoint`.

        Parameters
        ----------
        shift : float
            Of the master against the slave (length), see the property of this name.

        Returns
        -------
        CattaneoMindlinPoint
        """
        instance("hertz", hertz, HertzPoint)
        finite("shift", shift)
        nonnegative("friction", friction)
        sliding = cls(hertz=hertz, shear=friction * hertz.force, friction=friction)
        if abs(shift) > sliding.shift * (1.0 + 1e-12):
            raise ValueError(
                f"shift = {shift!r} is not valid: the bodies would slide, "
                f"keep |shift| <= {sliding.shift!r}"
            )
        left = max(0.0, 1.0 - abs(shift) / (sliding.shift or 1.0))
        shear = np.copysign(sliding.shear * (1.0 - left**1.5), shift)
        return cls(hertz=hertz, shear=float(shear), friction=friction)

    @property
    def _compliances(self) -> tuple[float, float]:
        """Sums over both bodies of (2 - nu)/G and of nu/G."""
        nu1, nu2 = self.hertz.nu1, self.hertz.nu2
        return self.hertz._ShearSum(2.0 - nu1, 2.0 - nu2), self.hertz._ShearSum(nu1, nu2)

    @property
    def shift(self) -> float:
        """How far the master has moved against the slave (length), far from the contact.

        Of the sign of Q: 3 F P ((2 - nu1)/G1 + (2 - nu2)/G2)/(16 a) (1 - (c/a)^2), for small loads
        Q ((2 - nu1)/G1 + (2 - nu2)/G2)/(8 a).
        """
        a, c = self.hertz.contact_radius, self.stick
        return float(pi * self._scale * self._compliances[0] * (a * a - c * c) / (8.0 * a))

    def Traction(self, r: float | np.ndarray) -> float | np.ndarray:
        """Tangential traction (stress) on the slave, along Q, see `HertzPoint.Pressure`."""
        return self._Rest(semi_ellipse, points("r", r))

    def MeanTraction(self, vertices: np.ndarray) -> float | np.ndarray:
        """Exact average of the traction over polygons, see `HertzPoint.MeanPressure`."""
        return self._Rest(semi_ellipsoid_mean, vertices)

    def Slip(self, x: float | np.ndarray, y: float | np.ndarray) -> tuple:
        """Slip of the slave against the master: displacements by the tractions, less `shift`.

        Zero in stick, nearly against the traction in slip; for |Q| = F P the rigid sliding is left
        out.

        Parameters
        ----------
        x, y : float or array
            Position relative to the middle (length), x along Q.

        Returns
        -------
        tuple of float or array
            Both components (length); NaN for r > a, where the surfaces do not touch.
        """
        x, y = np.broadcast_arrays(points("x", x), points("y", y))
        a, c = self.hertz.contact_radius, self.stick
        outer, inner = (self._SurfaceMotion(x, y, radius) for radius in (a, c))
        r = np.hypot(x, y)
        along, across = (
            np.where(r <= a, np.where(r > c, o - i, 0.0), np.nan)
            for o, i in zip((outer[0] - self.shift, outer[1]), inner, strict=True)
        )
        return along[()], across[()]

    def _SurfaceMotion(
        self, x: float | np.ndarray, y: float | np.ndarray, radius: float
    ) -> tuple[float | np.ndarray, float | np.ndarray]:
        """Relative displacements of the surfaces under scale/a sqrt(radius^2 - r^2) along x.

        Source: Johnson, section 3.6.
        """
        mean, twin = self._compliances
        r = np.hypot(x, y)
        out = np.maximum(r, radius)
        if radius == 0:
            return np.zeros_like(r), np.zeros_like(r)
        angle, root = np.arcsin(radius / out), radius * np.sqrt(out**2 - radius**2)
        radial = (2.0 * radius**2 - out**2) * angle + root
        double = out**2 * angle + (2.0 * radius**2 - out**2) * root / out**2
        # Inside, angle = pi/2: the polynomial continues with the true radius.
        radial = np.where(r < radius, 0.5 * pi * (2.0 * radius**2 - r**2), radial)
        double = np.where(r < radius, 0.5 * pi, double / out**2)
        factor = self._scale / (8.0 * self.hertz.contact_radius)
        along = factor * (mean * radial + 0.5 * twin * double * (x * x - y * y))
        return along, factor * twin * double * x * y

    def Reverse(self, shear: float) -> "MindlinPointReversal":
        """State after the load has gone back to `shear`, see `MindlinPointReversal`.

        Returns
        -------
        MindlinPointReversal
        """
        return MindlinPointReversal(start=self, shear=shear)


@dataclass(frozen=True, kw_only=True)
class MindlinReversal(Reversal):
    """A Cattaneo-Mindlin contact whose tangential load is brought back, once and steadily.

    From Q* = `start.shear` to Q = `shear`, with |Q| <= |Q*|, slip comes back from the edge of the
    contact. The change is a Cattaneo-Mindlin state with twice the friction, so the state is that
    of Q* less twice that of (Q* - Q)/2. At Q = 0 tractions remain, at Q = -Q* all is mirrored, and
    the way back up closes a loop. Slip counts from before the first loading. Sources: Mindlin and
    Deresiewicz, J. Appl. Mech. 20 (1953) 327; Johnson, Contact Mechanics (Cambridge, 1985),
    section 7.4, here in plane strain.

    Parameters
    ----------
    start : CattaneoMindlin
        The state at the point of reversal.
    shear : float
        Present resultant Q of the tangential tractions on the slave, -|Q*| <= Q <= |Q*|.

    Raises
    ------
    ValueError
        If the load is larger than the one at the point of reversal.

    Examples
    --------
    >>> hertz = HertzLine(force=100, radius1=50, young1=1e5, nu1=0.3, young2=1e5, nu2=0.3)
    >>> unloaded = CattaneoMindlin(hertz=hertz, shear=15, friction=0.2).Reverse(0)
    >>> print(f"{unloaded.Traction(0) > 0} {unloaded.Traction(0.95 * hertz.halfwidth) < 0}")
    True True
    """

    start: CattaneoMindlin
    shear: float

    Traction = superposed(CattaneoMindlin.Traction)
    MeanTraction = superposed(CattaneoMindlin.MeanTraction)
    Slip = superposed(CattaneoMindlin.Slip)


@dataclass(frozen=True, kw_only=True)
class MindlinPointReversal(Reversal):
    """A Cattaneo-Mindlin point contact whose tangential load is brought back, once and steadily.

    The state is found as in `MindlinReversal`; at Q = 0 a shift remains too. Sources: the same.

    Parameters
    ----------
    start : CattaneoMindlinPoint
        The state at the point of reversal.

    Examples
    --------
    >>> hertz = HertzPoint(force=100, radius1=50, young1=1e5, nu1=0.3, young2=1e5, nu2=0.3)
    >>> loaded = CattaneoMindlinPoint(hertz=hertz, shear=17.5, friction=0.2)
    >>> print(f"{loaded.Reverse(0).shift / loaded.shift:.4f}")
    0.1505
    """

    start: CattaneoMindlinPoint
    shear: float

    shift = property(superposed(CattaneoMindlinPoint.shift.fget))
    Traction = superposed(CattaneoMindlinPoint.Traction)
    MeanTraction = superposed(CattaneoMindlinPoint.MeanTraction)
    Slip = superposed(CattaneoMindlinPoint.Slip)
