# SPDX-License-Identifier: LGPL-2.1-or-later
"""Arguments as users write them, checked: a message holds the name, the value and the remedy."""

import math
import re
from collections.abc import Callable, Sequence
from numbers import Integral, Real
from typing import Any

import numpy as np
from ngsolve import (
    VOL,
    BaseVector,
    CoefficientFunction,
    FESpace,
    GridFunction,
    Mesh,
    ProductSpace,
    Region,
)

from ngslac._ngslac import HoldsProxy

__all__ = [
    "LARGEST_COUNT",
    "CheckChoice",
    "CheckCount",
    "CheckDisplacement",
    "CheckDistinct",
    "CheckFlag",
    "CheckFunction",
    "CheckInstance",
    "CheckMoves",
    "CheckNumber",
    "CheckOnMesh",
    "CheckOnSpace",
    "CheckParts",
    "CheckPoint",
    "CheckPositive",
    "CheckPrinting",
    "CheckState",
    "CheckValues",
    "CheckVector",
    "Coefficient",
    "Components",
    "FillVector",
    "IsFunction",
    "Shown",
    "ShownPoint",
    "Wrong",
]

LARGEST_COUNT = 2**31 - 1  # what the compiled part takes


def Shown(value: Any, longest: int = 60) -> str:
    """A value on one line of an error message, cut where it is long."""
    try:
        text = " ".join(repr(value).split())
    except Exception:  # of an object whose repr fails
        text = f"<{type(value).__name__}>"
    text = re.sub(r"<[\w.]*?(\w+) object at 0x\w+>", r"<\1>", text)
    return text if len(text) <= longest else text[: longest - 3] + "..."


def ShownPoint(point: Sequence[float]) -> str:
    """A position in an error message, in any unit of length."""
    return "(" + ", ".join(f"{x:.6g}" for x in point) + ")"


def Wrong(kind: type[Exception], name: str, value: Any, wanted: str) -> Exception:
    """An error of this kind, in the wording that all checks share."""
    return kind(f"{name} = {Shown(value)} must be {wanted}")


# --- numbers and words ---------------------------------------------------------------------------


def CheckNumber(
    name: str,
    value: Any,
    wanted: str = "a finite number",
    accepts: Callable[[float], bool] = math.isfinite,
) -> float:
    """The real number as float; TypeError if it is none, ValueError if it is not accepted."""
    if not isinstance(value, Real) or isinstance(value, (bool, np.bool_)):
        raise Wrong(TypeError, name, value, wanted)
    try:
        number = float(value)
    except OverflowError:
        number = math.inf
    if not accepts(number):
        raise Wrong(ValueError, name, value, wanted)
    return number


def CheckPositive(name: str, value: Any, wanted: str = "a finite number > 0") -> float:
    """The positive number as float."""
    return CheckNumber(name, value, wanted, lambda x: math.isfinite(x) and x > 0)


def CheckCount(name: str, value: Any, least: int = 1) -> int:
    """The whole number as int."""
    wanted = f"a whole number, at least {least} and at most {LARGEST_COUNT}"
    if not isinstance(value, Integral) or isinstance(value, (bool, np.bool_)):
        raise Wrong(TypeError, name, value, wanted)
    if not least <= value <= LARGEST_COUNT:
        raise Wrong(ValueError, name, value, wanted)
    return int(value)


def CheckFlag(name: str, value: Any) -> bool:
    """True, False, 1 or 0 as bool: other objects are true by accident."""
    if not (isinstance(value, (Integral, np.bool_)) and value in (0, 1)):
        raise Wrong(TypeError, name, value, "True or False")
    return bool(value)


def CheckPrinting(value: Any) -> bool | str:
    """The option `printing` of a stepper: True (iterations), "steps", or False."""
    if isinstance(value, str) and value == "steps":
        return value
    try:
        return CheckFlag("printing", value)
    except TypeError:
        raise Wrong(TypeError, "printing", value, 'True, False or "steps"') from None


def CheckChoice(name: str, value: Any, options: Sequence[str]) -> str:
    """One of the words in `options`."""
    wanted = "one of " + ", ".join(map(repr, options))
    if not isinstance(value, str):
        raise Wrong(TypeError, name, value, wanted)
    if value not in options:
        raise Wrong(ValueError, name, value, wanted)
    return value


def CheckPoint(name: str, value: Any, dim: int) -> np.ndarray:
    """A sequence of `dim` finite coordinates as array."""
    wanted = f"a point with {dim} coordinates, finite numbers"
    try:
        point = np.asarray(value)
    except (TypeError, ValueError) as error:
        raise Wrong(TypeError, name, value, wanted) from error
    if point.dtype.kind not in "fiu":
        raise Wrong(TypeError, name, value, wanted)
    if point.shape != (dim,) or not np.isfinite(point).all():
        raise Wrong(ValueError, name, value, wanted)
    return point.astype(float)


# --- objects -------------------------------------------------------------------------------------


def CheckInstance(name: str, value: Any, kind: type | tuple[type, ...], wanted: str) -> Any:
    """An object of a class, or of one of several; `wanted` says how users get it."""
    if not isinstance(value, kind):
        raise Wrong(TypeError, name, value, wanted)
    return value


def IsFunction(value: Any) -> bool:
    """Can it be called, without being one of NGSolve's objects that can, such as a mesh?"""
    return callable(value) and not type(value).__module__.startswith("ngsolve")


def CheckFunction(name: str, value: Any, wanted: str = "a function, or None") -> Callable | None:
    """A Python function or None."""
    if value is not None and not IsFunction(value):
        raise Wrong(TypeError, name, value, wanted)
    if isinstance(value, type):
        raise Wrong(TypeError, name, value, f"{wanted}, not a class: give an object of it")
    return value


def CheckOnSpace(name: str, gf: Any, space: FESpace) -> GridFunction:
    """A GridFunction on this product space."""
    CheckInstance(name, gf, GridFunction, "a GridFunction on the product space")
    if gf.space != space:
        raise ValueError(
            f"{name} lives on another space than u and lam, with {gf.space.ndof} dofs in place of "
            f"{space.ndof}: take GridFunction(X) of their product space X"
        )
    return gf


def CheckVector(name: str, vector: BaseVector, size: int) -> BaseVector:
    """A real vector with `size` scalar entries."""
    CheckInstance(name, vector, BaseVector, "a vector on the product space, such as gf.vec")
    if vector.is_complex:
        raise ValueError(f"{name} is a complex vector: contact needs real ones")
    if (found := vector.FV().NumPy().size) != size:
        raise ValueError(
            f"{name} has {found} entries, the product space {size}: take a vector of that space"
        )
    return vector


def Components(function: CoefficientFunction) -> int:
    """The number of components of a function; 0 for one of a product space, which has parts."""
    parts = isinstance(function, GridFunction) and type(function.space) is ProductSpace
    return 0 if parts else function.dim


def CheckDisplacement(name: str, value: Any, mesh: Mesh) -> CoefficientFunction | None:
    """A real function with one component for each dimension of the mesh, or None."""
    wanted = f"a displacement with {mesh.dim} components, such as gf.components[0], or None"
    if value is None:
        return value
    CheckInstance(name, value, CoefficientFunction, wanted)
    if Components(value) != mesh.dim or value.is_complex:
        raise Wrong(ValueError, name, value, wanted + ", real")
    return CheckOnMesh(name, value, mesh)


def CheckState(state: Any, *keys: str) -> dict:
    """Check that a state is a dict with these keys, as `State` returns it."""
    wanted = "the dict that State() of a thing made in the same way returned"
    CheckInstance("state", state, dict, wanted)
    if missing := [key for key in keys if key not in state]:
        raise ValueError(f"state lacks {', '.join(map(repr, missing))}: it must be {wanted}")
    return state


def CheckParts(state: dict, **kinds: type | tuple[type, ...]) -> dict:
    """The values of a state are of these kinds, or of one of several; returns the state."""
    for key, kind in kinds.items():
        if not isinstance(state[key], kind):
            raise Wrong(TypeError, f"state[{key!r}]", state[key], "what State() returned there")
    return state


def FillVector(name: str, vec: BaseVector, values: np.ndarray) -> None:
    """Put the values of a state into a vector, if they are as many."""
    entries = vec.FV().NumPy()
    if np.shape(values) != entries.shape:
        raise ValueError(
            f"state holds {np.size(values)} values of {name}, which has {len(entries)} entries: it "
            "is that of another problem, or of before the space was refined"
        )
    entries[:] = values


def CheckOnMesh(name: str, function: Any, mesh: Mesh) -> Any:
    """A function with values that is no GridFunction of another mesh."""
    if isinstance(function, GridFunction) and function.space.mesh != mesh:
        raise ValueError(f"{name} lives on another mesh than the contact: take one on the same")
    return CheckValues(name, function)


def CheckValues(name: str, function: Any) -> Any:
    """Check for a number, or a function without trial and test functions."""
    if isinstance(function, CoefficientFunction) and HoldsProxy(function):
        raise ValueError(
            f"{name} holds a trial or test function, which has no values: take the GridFunction, "
            "such as gf.components[0], in its place"
        )
    return function


# --- regions and coefficients --------------------------------------------------------------------


def BoundaryNames(region: Region) -> str:
    """Names of the boundaries of a region, as a pattern."""
    names = zip(region.mesh.GetBoundaries(), region.Mask(), strict=True)
    return "|".join(dict.fromkeys(name for name, inside in names if inside))


def Coefficient(name: str, value: Any, least: float = -math.inf) -> CoefficientFunction | None:
    """A number, CoefficientFunction or Parameter as a real scalar function; None stays None."""
    if value is None:
        return None
    if not isinstance(value, CoefficientFunction):
        wanted = "a finite number" + (f" >= {least:g}" if math.isfinite(least) else "")
        accepts = lambda number: math.isfinite(number) and number >= least  # noqa: E731
        return CoefficientFunction(CheckNumber(name, value, wanted, accepts))
    if (components := Components(value)) != 1:
        raise ValueError(
            f"{name} has {components or 'several'} components: it must be one number at each "
            "point, such as a component value[0] or Norm(value)"
        )
    if value.is_complex:
        raise ValueError(f"{name} is complex: it must be one real number at each point")
    return value


def CheckDistinct(slave: Region, master: Region, remedy: str) -> None:
    """Raise ValueError, which says what to do, where the two regions share boundaries."""
    both, names = (slave * master).Mask(), slave.mesh.GetBoundaries()
    shared = [name for name, common in zip(names, both, strict=True) if common]
    if shared:
        raise ValueError(f"boundaries {', '.join(shared)} are both slave and master: {remedy}")


def CheckMoves(master: Region, space: FESpace, component: FESpace) -> None:
    """Raise ValueError where the master moves with another displacement than the slave does.

    `component` is the displacement among those of the product space.
    """
    body = Region(master.mesh, VOL, master.Neighbours(VOL).Mask())
    if component.GetDofs(body).NumSet():
        return
    if component.TrialFunction().dim == 1:
        raise ValueError(
            f"master = {BoundaryNames(master)!r} has no degrees of freedom of u: define its space "
            "on both bodies"
        )
    for other in _Parts(space):
        moves = other.TrialFunction().dim == master.mesh.dim and other.GetDofs(body).NumSet()
        if moves and other.type != "lacspace":
            raise ValueError(
                f"master = {BoundaryNames(master)!r} has no degrees of freedom of u, but of "
                f"another component of the product space, a {other.type}: it would count as a "
                "body at rest. Take one space for the displacements of both bodies"
            )


def _Parts(space: FESpace) -> list[FESpace]:
    """Components of components; a VectorH1 is one, though it is made of scalar spaces."""
    if isinstance(space.TrialFunction(), (list, tuple)):
        return [part for component in space.components for part in _Parts(component)]
    return [space]
