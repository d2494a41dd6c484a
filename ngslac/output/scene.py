# SPDX-License-Identifier: LGPL-2.1-or-later
"""The method of `LACContact` that shows it in a webgui scene."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ngsolve import CoefficientFunction, GridFunction

from ngslac.arguments import (
    CheckChoice,
    CheckDisplacement,
    CheckInstance,
    CheckNumber,
    CheckOnMesh,
    CheckPositive,
)
from ngslac.output.facepoints import FacePoints
from ngslac.output.marks import FlatMarks, SolidMarks
from ngslac.output.shapes import Script

if TYPE_CHECKING:
    from ngsolve.webgui import WebGLScene

__all__ = ["Draw"]


def Draw(
    self,
    field: str = "pressure",
    *,
    background: CoefficientFunction | None = None,
    deformation: GridFunction | CoefficientFunction | None = None,
    scale: float = 1,
    size: float | None = None,
    **options,
) -> WebGLScene:
    """Show a field of the last evaluation on the slave side, in the webgui.

    In 3D the camera looks at the slave faces, through the bodies, which are translucent. Numbers
    are colours on the slave faces and vectors arrows on them. In 2D the faces are edges: numbers
    are bars along the outward normal, vectors arrows, each status a dot, drawn on the bodies. A
    legend names the colours of the status (gray open, blue stick, orange slip). Faces without a
    partner have no gap and are gray.

    Parameters
    ----------
    field : str
        "pressure", "gap", "status", "traction", "slip", "normal", the continuous "recovered
        pressure" and "recovered traction", or what contact is made of: "macros" (by shuffled
        colours, in 2D by their ends) or "segments".
    background : CoefficientFunction, optional
        In 2D the function that colours the bodies, such as a stress. Default: the mesh, or the
        norm of the `deformation`.
    deformation : GridFunction or CoefficientFunction, optional
        Displacement (d,), by which bodies and glyphs are moved.
    scale : float
        Factor of the deformation.
    size : float, optional
        Length of the longest bar or arrow. Default: a fifth of the slave's diameter.
    **options :
        Handed to `ngsolve.webgui.Draw`: min, max, show, settings, and in place of the camera
        chosen here center, radius, euler_angles.

    Returns
    -------
    ngsolve.webgui.WebGLScene

    Raises
    ------
    ValueError, TypeError
        An unknown field, or an argument of another kind.

    Examples
    --------
    >>> last = ContactSolver(a, gf, contact).Solve(printing=False)
    >>> scene = contact.Draw("traction", deformation=gf.components[0], show=False)
    """
    # Importing the webgui switches NumPy's warnings off: not before somebody draws.
    from ngsolve import webgui

    names = self._names
    kinds = (*names.scalars, *names.vectors, *names.recovered, "macros", "segments")
    CheckChoice("field", field, kinds)
    CheckDisplacement("deformation", deformation, self.mesh)
    CheckNumber("scale", scale)
    if size is not None:
        CheckPositive("size", size, "a positive length, or None")
    if background is not None:
        wanted = "a CoefficientFunction such as a stress, or None"
        CheckInstance("background", background, CoefficientFunction, wanted)
        CheckOnMesh("background", background, self.mesh)
    self._PairOnce()
    if field in names.solved:
        self._WarnIfUnsolved()
    displacement = deformation
    if deformation is not None:
        # `scale` of Draw does not reach a deformation that is not the shown function.
        options["deformation"] = deformation = scale * displacement
    faces = FacePoints(self, deformation)
    if self.mesh.dim == 3:
        marks = SolidMarks(self, field, faces, deformation, size)
    else:
        background = displacement if background is None else background
        marks = FlatMarks(self, field, faces, background, size)
    options = marks.options | options
    options["objects"] = [*marks.objects, *options.get("objects", [])]
    options["settings"] = marks.settings | options.get("settings", {})
    options["js_code"] = Script(marks.patches, marks.legend) + options.get("js_code", "")
    return webgui.Draw(*marks.shown, **options)
