# SPDX-License-Identifier: LGPL-2.1-or-later
"""A rigid body given by its signed distance, and how it moves."""

from __future__ import annotations

from collections.abc import Sequence
from numbers import Real

import numpy as np
from ngsolve import CF, CoefficientFunction
from ngsolve.comp import ProxyFunction

from ngslac._ngslac import PlacementOf, RigidTool, ToolDrive, ToolMotion, ToolShape
from ngslac.arguments import (
    CheckInstance,
    CheckNumber,
    CheckPoint,
    CheckValues,
    Coefficient,
    Shown,
    Wrong,
)

__all__ = ["CheckPoints", "Direction", "Tool"]


class Tool:
    """A rigid body given by its signed distance; made by the functions of this module.

    ``-tool`` is the complement of the tool, such as a cavity; ``tool | other`` is both as one.
    Tools are not changed: each method returns another one. Combine tools first, then move them.

    Attributes
    ----------
    dim : int
        Of the space, 2 or 3.

    Examples
    --------
    >>> from ngsolve import Parameter
    >>> from ngslac import tools
    >>> load = Parameter(0)
    >>> roll = tools.Sphere((0, 3), 1)
    >>> roll = roll.Moved(shift=(0, -load), angle=0.5 * load, center=(0, 3))
    >>> load.Set(0.25)
    >>> roll.Distance([(0, 1.5), (0, 2.75)]).round(12).tolist()
    [0.25, -1.0]
    """

    def __init__(
        self, shape: ToolShape, motions: Sequence[ToolMotion] = (), drives: Sequence[ToolDrive] = ()
    ):
        self._shape = CheckInstance("shape", shape, ToolShape, "made by a function of ngslac.tools")
        self._motions, self._drives = tuple(motions), tuple(drives)

    def __repr__(self) -> str:
        words = ["moves" if self._motions else "", "driven" if self._drives else ""]
        return f"<Tool in {self.dim}D" + "".join(f", {word}" for word in words if word) + ">"

    @property
    def dim(self) -> int:
        """Of the space, 2 or 3."""
        return self._shape.dim

    @property
    def compiled(self) -> RigidTool:
        """The RigidTool for the compiled form."""
        return RigidTool(self._shape, list(self._motions), list(self._drives))

    def Distance(self, points: Sequence[Sequence[float]]) -> np.ndarray:
        """Signed distances (n,) of points (n, d), with the present values of all Parameters.

        The travel that follows from forces is not included.

        Parameters
        ----------
        points : (n, d) array-like

        Returns
        -------
        (n,) array

        Raises
        ------
        TypeError, ValueError
            No points of this dimension.
        """
        points, (turn, shift) = CheckPoints("points", points, self.dim), self.placement
        values, *_ = self._shape.Evaluate(((points - shift) @ turn).ravel())
        return np.array(values)

    def _Look(self, points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Signed distances (n,) and their gradients (n, d) at points (n, d) of the tool's frame."""
        values, gradients, _ = self._shape.Evaluate(points.ravel())
        return np.array(values), np.array(gradients).reshape(points.shape)

    @property
    def placement(self) -> tuple[np.ndarray, np.ndarray]:
        """Where its path has led it: rotation (d, d), then shift (d,)."""
        place = np.array(PlacementOf(list(self._motions), self.dim))
        return place[: -self.dim].reshape(self.dim, self.dim), place[-self.dim :]

    # --- other tools ---------------------------------------------------------------------------

    def Grown(self, by: float) -> Tool:
        """All points within a distance of the tool: its convex corners become round.

        Parameters
        ----------
        by : float
            Length; < 0: the tool shrinks, if it is so thick.

        Returns
        -------
        Tool
        """
        return Tool(self._AtRest().Grown(CheckNumber("by", by)))

    def __neg__(self) -> Tool:
        return Tool(self._AtRest().Complement())

    def __or__(self, other: Tool) -> Tool:
        CheckInstance("other", other, Tool, "a tool")
        if other.dim != self.dim:
            raise ValueError(f"a tool in {self.dim}D and one in {other.dim}D make no tool")
        return Tool(self._AtRest().Together(other._AtRest()))

    def _AtRest(self) -> ToolShape:
        if self._motions or self._drives:
            raise ValueError("the tool moves already: combine tools first, then move the result")
        return self._shape

    # --- motion --------------------------------------------------------------------------------

    def Moved(
        self,
        *,
        shift: CoefficientFunction | Sequence[CoefficientFunction | float] | None = None,
        angle: CoefficientFunction | float | None = None,
        center: Sequence[float] | None = None,
        axis: Sequence[float] | None = None,
    ) -> Tool:
        """The tool on a path: turned about an axis, then shifted, after motions of before.

        Friction counts the slip against the points of the tool, so that a roll drags.

        Parameters
        ----------
        shift : (d,) sequence or vector of numbers, Parameters and functions of them, optional
            Lengths.
        angle : float, Parameter or function of Parameters, optional
            In radians, counterclockwise seen from where `axis` points to.
        center : (d,) array-like, optional
            A point of the axis, where the motions of before have led. Default: the origin.
        axis : (3,) array-like, optional
            In 3D the direction of the axis.

        Returns
        -------
        Tool

        Raises
        ------
        ValueError, TypeError, ngsolve.NgException
            Neither of them; a function that depends on the place; no axis in 3D, or one in 2D; a
            driven tool.
        """
        if shift is None and angle is None:
            raise ValueError("give shift= or angle=: how the tool moves")
        if self._drives:
            raise ValueError("the tool is driven already: give its path first, then Driven")
        motion = None if shift is None else _Vector("shift", shift, self.dim)
        angle = CheckValues("angle", Coefficient("angle", angle))
        turning = _Axis(center, axis, self.dim, angle is not None)
        return Tool(self._shape, [*self._motions, ToolMotion(motion, angle, *turning)])

    def Driven(
        self,
        *,
        travel: Sequence[ProxyFunction | None] | None = None,
        force: Sequence[CoefficientFunction | float] | None = None,
        turn: ProxyFunction | None = None,
        moment: CoefficientFunction | float | None = None,
        center: Sequence[float] | None = None,
        axis: Sequence[float] | None = None,
    ) -> Tool:
        """The tool moved by forces: how far it goes is unknown, and found with its balance.

        The unknowns are trial functions of a `NumberSpace`, one for each direction in which the
        tool may go, and one for a rotation; add them to the product space of `u` and `lam`. Their
        values count from the path.

        Parameters
        ----------
        travel : sequence of d trial functions or None, optional
            One for each component of the shift; None: it does not follow from forces.
        force : (d,) sequence of numbers, Parameters and functions of them, optional
            On the tool, in the same components. Default: 0.
        turn : trial function, optional
            Angle of a rotation in radians.
        moment : float, Parameter or function of Parameters, optional
            On the tool, about the axis (force times length). Default: 0.
        center : (d,) array-like, optional
            A point of the axis, of the tool before it moves. Default: the origin.
        axis : (3,) array-like, optional
            In 3D the direction of the axis.

        Returns
        -------
        Tool

        Raises
        ------
        ValueError, TypeError, ngsolve.NgException
            Nothing is unknown; a number of components that is not d; what is no trial function; a
            load on what is known; no axis in 3D, or one in 2D; a tool that is driven already.

        Examples
        --------
        >>> from netgen.occ import unit_square
        >>> from ngsolve import Mesh, NumberSpace, VectorH1
        >>> from ngslac import LACContact, LACSpace, tools
        >>> mesh = Mesh(unit_square.GenerateMesh(maxh=0.3))
        >>> V = VectorH1(mesh, order=2, dirichlet="bottom")
        >>> X = V * LACSpace(V, slave="top") * NumberSpace(mesh)
        >>> u, lam, down = X.TrialFunction()
        >>> punch = tools.Sphere((0.5, 2), 1).Driven(travel=(None, down), force=(0, -5))
        >>> contact = LACContact(u, lam, obstacle=punch, finite=True)
        """
        if self._drives:
            raise ValueError("the tool is driven already: give all in one call")
        asked, travel = travel, [None] * self.dim if travel is None else travel
        travel = _Components("travel", travel, self.dim)
        if turn is None and all(way is None for way in travel):
            nothing = "" if asked is None else f"; travel = {Shown(asked)} names nothing"
            raise ValueError("give travel= or turn=: what of the motion is unknown" + nothing)
        loads = _Components("force", [0.0] * self.dim if force is None else force, self.dim)
        for way, load in zip(travel, loads, strict=True):
            if way is None and not (isinstance(load, Real) and load == 0):
                raise ValueError(
                    f"force = {Shown(force)} acts where travel = {Shown(travel)} is None: give 0 "
                    "there, or an unknown"
                )
        if turn is None and moment is not None:
            raise ValueError("moment acts on a tool that does not turn: give turn=, or no moment")
        middle = [0.0] * 3, [0.0] * 3
        drives = [
            ToolDrive(_Unknown("travel", way), Coefficient("force", load), k, *middle)
            for k, (way, load) in enumerate(zip(travel, loads, strict=True))
            if way is not None
        ]
        if turn is not None:
            turning = _Axis(center, axis, self.dim, True)
            load = Coefficient("moment", moment)
            drives.append(ToolDrive(_Unknown("turn", turn), load, -1, *turning))
        return Tool(self._shape, self._motions, drives)


def CheckPoints(name: str, value: Sequence[Sequence[float]], dim: int) -> np.ndarray:
    """Points (n, d) as array."""
    wanted = f"an array of points (n, {dim})"
    try:
        points = np.asarray(value, float)
    except (TypeError, ValueError) as error:
        raise Wrong(TypeError, name, value, wanted) from error
    if points.ndim != 2 or points.shape[1] != dim:
        raise Wrong(ValueError, name, value, wanted)
    return points


def _Unknown(name: str, value: ProxyFunction) -> ProxyFunction:
    return CheckInstance(name, value, ProxyFunction, "a trial function of a NumberSpace")


def _Components(name: str, value: Sequence, dim: int) -> list:
    """A sequence of as many components as the space has, as list."""
    if not isinstance(value, (list, tuple, np.ndarray)):
        raise Wrong(TypeError, name, value, f"a list or tuple of {dim} components")
    if len(value) != dim:
        raise ValueError(f"{name} has {len(value)} components, the tool is in {dim}D")
    return list(value)


def _Vector(
    name: str, value: CoefficientFunction | Sequence[CoefficientFunction | float], dim: int
) -> CoefficientFunction:
    """A vector of numbers and functions as one function."""
    if not isinstance(value, CoefficientFunction):
        parts = _Components(name, value, dim)
        value = CF(tuple(CheckValues(name, Coefficient(name, part)) for part in parts))
    if value.dim != dim or value.is_complex:
        raise ValueError(f"{name} has {value.dim} components, the tool is in {dim}D, and real")
    return value


def _Axis(
    center: Sequence[float] | None, axis: Sequence[float] | None, dim: int, turns: bool
) -> tuple[list[float], list[float]]:
    """A point and a direction, three numbers each."""
    if dim == 2 and axis is not None:
        raise ValueError("axis is for tools in 3D, in 2D all turn in the plane: leave it out")
    center = np.zeros(dim) if center is None else CheckPoint("center", center, dim)
    axis = Direction("axis", axis, 3) if dim == 3 and turns else (0.0, 0.0, 1.0)
    return [*center, 0.0][:3], list(axis)


def Direction(name: str, value: Sequence[float] | None, dim: int) -> np.ndarray:
    """The unit vector along one that is not zero."""
    vector = CheckPoint(name, value, dim)
    if not np.any(vector):
        raise Wrong(ValueError, name, value, "a direction, no vector of zeros")
    vector = vector / np.abs(vector).max()  # whose square neither over- nor underflows
    return vector / np.linalg.norm(vector)
