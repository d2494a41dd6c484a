# SPDX-License-Identifier: LGPL-2.1-or-later
"""Methods of `LACContact` that show it: profiles by matplotlib, ParaView files."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from ngsolve import BND, CF, CoefficientFunction, GridFunction

from ngslac.arguments import CheckChoice, CheckDisplacement, CheckFunction, Wrong
from ngslac.arrays import AsBits
from ngslac.output.facepoints import FacePoints
from ngslac.output.fields import ARROWS, RECOVERED, FieldOf, NumbersOf
from ngslac.output.vtkfile import WriteVTK
from ngslac.parallel.form import FunctionOver

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from ngslac.contact.contact import LACContact

__all__ = ["Plot", "WriteVTU"]

CURVE = 9  # points of each face in a plot


def Plot(
    self,
    field: str = "pressure",
    *,
    along: str | Callable[[np.ndarray], np.ndarray] = "x",
    deformation: GridFunction | CoefficientFunction | None = None,
    axes: Axes | None = None,
    **style,
) -> Axes:
    """Plot a field of the last evaluation over a coordinate, by matplotlib.

    In 2D one step for each macro-element, in 3D one point; what is recovered is a curve in 2D and
    has a point for each face in 3D. Of the traction and of the slip the
    tangential part is shown: in 2D its component along the normal turned by 90 degrees
    counterclockwise, in 3D its norm.

    Parameters
    ----------
    field : str
        "pressure", "gap", "status", "traction", "slip", "recovered pressure" or "recovered
        traction".
    along : str or callable
        "x", "y", "z", or a function of the points (n, d) that returns (n,).
    deformation : GridFunction or CoefficientFunction, optional
        Displacement (d,): points of the current configuration in place of the reference.
    axes : matplotlib.axes.Axes, optional
        Default: the current ones.
    **style :
        Handed to `axes.plot` (label, color, ...).

    Returns
    -------
    matplotlib.axes.Axes

    Raises
    ------
    ValueError, TypeError
        An unknown field or coordinate, or an argument of another kind.

    Examples
    --------
    >>> axes = contact.Plot("pressure", along="x", label="computed")
    """
    from matplotlib import pyplot as plt

    names = self._names
    along_surface = (name for name in names.vectors if name != "normal")
    CheckChoice("field", field, (*names.scalars, *along_surface, *names.recovered))
    CheckDisplacement("deformation", deformation, self.mesh)
    if axes is not None and not callable(getattr(axes, "plot", None)):
        raise Wrong(TypeError, "axes", axes, "axes of matplotlib, or None")
    self._PairOnce()
    if field in names.solved:
        self._WarnIfUnsolved()
    coordinate = _Coordinate(along, self.mesh.dim)
    axes = plt.gca() if axes is None else axes
    faces = FacePoints(self, deformation)
    profile = _Smooth if field in RECOVERED else _Steps if self.mesh.dim == 2 else _Means
    dots = {} if self.mesh.dim == 2 else {"ls": "", "marker": "."}
    axes.plot(*profile(self, field, faces, coordinate), **(dots | style))
    axes.set_ylabel(field)
    if isinstance(along, str):
        axes.set_xlabel(along)
    return axes


def _Values(contact: LACContact, field: str) -> np.ndarray:
    """Of each macro-element."""
    table = contact.Table()
    return _Tangential(table[field], table["normal"]) if field in ARROWS else table[field]


def _Tangential(vectors: np.ndarray, normals: np.ndarray) -> np.ndarray:
    if vectors.shape[1] == 2:
        return normals[:, 0] * vectors[:, 1] - normals[:, 1] * vectors[:, 0]
    along = np.sum(vectors * normals, axis=1, keepdims=True)
    return np.linalg.norm(vectors - along * normals, axis=1)


def WriteVTU(
    self, filename: str | Path, *, displacement: GridFunction | CoefficientFunction | None = None
) -> Path:
    """Write the fields on the slave faces for ParaView.

    Parameters
    ----------
    filename : str or Path
    displacement : GridFunction or CoefficientFunction, optional
        Written, too: ParaView's filter "Warp By Vector" shows the deformed faces.

    Returns
    -------
    pathlib.Path

    Raises
    ------
    OSError
        The file cannot be written; nothing is left of it.
    TypeError, ValueError
        `filename` is none, or `displacement` no displacement.

    Examples
    --------
    >>> path = contact.WriteVTU("slave", displacement=gf.components[0])
    >>> path.name
    'slave.vtu'
    """
    CheckDisplacement("displacement", displacement, self.mesh)
    self._PairOnce()
    self._WarnIfUnsolved()
    names = (*self._names.scalars, *self._names.vectors, *self._names.recovered)
    fields = {name: FieldOf(self, name) for name in names}
    fields["macro"] = NumbersOf(self, np.arange(self.space.nmacros))
    if displacement is not None:
        fields["displacement"] = FunctionOver(self.form, displacement)
    if self.mesh.dim == 2:  # ParaView's vectors have three components
        fields |= {n: CF((f[0], f[1], 0)) for n, f in fields.items() if f.dim == 2}
    chosen, mesh = AsBits(np.array(self.surface.macros) >= 0), self.surface.mesh

    def Write() -> Path:
        return WriteVTK(filename, mesh, fields, vb=BND, drawelems=chosen, order=2)

    return self.layout.together.First(Write)


def _Coordinate(
    along: str | Callable[[np.ndarray], np.ndarray], dim: int
) -> Callable[[np.ndarray], np.ndarray]:
    """The function of points (n, d) that gives abscissas."""
    names = "xyz"[:dim]
    if not callable(along):
        CheckChoice("along", along, tuple(names))
        return lambda points: points[:, names.index(along)]
    CheckFunction("along", along, f"one of {', '.join(names)}, or a function of points")
    return lambda points: _Checked(np.asarray(along(points)), len(points))


def _Checked(values: np.ndarray, size: float | None) -> np.ndarray:
    """Abscissas that a function of the user has returned."""
    if values.shape != (size,):
        raise ValueError(
            f"along returns an array of the shape {values.shape}: one number for each of the "
            f"{size} points is wanted"
        )
    return values


def _Smooth(
    contact: LACContact,
    field: str,
    faces: FacePoints,
    coordinate: Callable[[np.ndarray], np.ndarray],
) -> Sequence[np.ndarray]:
    """Abscissas and ordinates on each face, in 2D with a break behind it."""
    flat = contact.mesh.dim == 2
    places = np.linspace(0, 1, CURVE) if flat else [None]

    def At(function: CoefficientFunction) -> np.ndarray:
        values = np.stack([faces.Evaluate(function, place) for place in places], axis=1)
        return values.reshape(-1, values.shape[-1])

    values = At(FieldOf(contact, field))
    if field in ARROWS:
        values = _Tangential(values, At(contact.Recovered().normal))
    points = np.stack([faces.Positions(place) for place in places], axis=1)
    s = coordinate(points.reshape(-1, contact.mesh.dim))
    if not flat:
        return s, values
    return [
        np.pad(v.reshape(-1, CURVE), ((0, 0), (0, 1)), constant_values=np.nan).ravel()
        for v in (s, values)
    ]


def _Means(
    contact: LACContact,
    field: str,
    faces: FacePoints,
    coordinate: Callable[[np.ndarray], np.ndarray],
) -> tuple[np.ndarray, np.ndarray]:
    """Abscissas and ordinates of a point for each macro-element."""
    return coordinate(faces.MacroMeans(faces.centers)), _Values(contact, field)


def _Steps(
    contact: LACContact,
    field: str,
    faces: FacePoints,
    coordinate: Callable[[np.ndarray], np.ndarray],
) -> tuple[np.ndarray, np.ndarray]:
    """Abscissas and ordinates of a step for each macro-element, with breaks where others lie."""
    values = _Values(contact, field)
    ends = np.sort([coordinate(points) for points in faces.ends], axis=0)
    low, high = np.full(len(values), np.inf), np.full(len(values), -np.inf)
    np.minimum.at(low, faces.macro, ends[0])
    np.maximum.at(high, faces.macro, ends[1])
    order = np.argsort(low)
    s = np.stack([low, high, high], axis=1)[order]
    v = np.stack([values] * 3, axis=1)[order].astype(float)  # a status, too, has breaks
    apart = np.append(low[order][1:] - high[order][:-1] > 1e-6 * (high - low).max(), False)
    s[:, 2], v[~apart, 2], v[apart, 2] = s[:, 1], v[~apart, 1], np.nan
    return s.ravel(), v.ravel()
