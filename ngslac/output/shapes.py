# SPDX-License-Identifier: LGPL-2.1-or-later
"""Filled surfaces and a legend for a webgui scene, which has lines and points alone."""

import json
from base64 import b64encode
from pathlib import Path

import numpy as np
from ngsolve import CF, ET, CoefficientFunction, GridFunction, IntegrationRule, Mesh, x, y, z

__all__ = ["Creases", "Patch", "Script", "Triangles"]

SCRIPT = Path(__file__).with_suffix(".js")
# Corners and midpoints of each face, and the triangles between them.
POINTS = {
    ET.TRIG: [(0, 0), (0.5, 0), (1, 0), (0, 0.5), (0.5, 0.5), (0, 1)],
    ET.QUAD: [(i / 2, j / 2) for j in range(3) for i in range(3)],
}
CORNERS = {
    ET.TRIG: [(0, 1, 3), (1, 4, 3), (1, 2, 4), (3, 4, 5)],
    ET.QUAD: [t for i in (0, 1, 3, 4) for t in ((i, i + 1, i + 3), (i + 1, i + 4, i + 3))],
}
OF_NETGEN = {ET.TRIG: (10, 12), ET.QUAD: (11, 13, 14)}  # numbers of types, with those of order 2
ALONG = 4  # parts of each edge


def Triangles(
    mesh: Mesh, chosen: np.ndarray, deformation: GridFunction | CoefficientFunction | None = None
) -> np.ndarray:
    """Corners (n, 3, 3) of triangles on the `chosen` boundary elements, (nboundary,) of bool."""
    types = mesh.ngmesh.Elements2D().NumPy()["type"]
    triangles = []
    for kind, points in POINTS.items():
        rule = {kind: IntegrationRule(points, [0] * len(points))}
        values = _Place(deformation)(mesh.MapToAllElements(rule, mesh.Boundaries(".*")))
        values = values.reshape(-1, len(points), 3)[chosen[np.isin(types, OF_NETGEN[kind])]]
        triangles.append(values[:, CORNERS[kind]].reshape(-1, 3, 3))
    return np.concatenate(triangles)


def Creases(
    mesh: Mesh, deformation: GridFunction | CoefficientFunction | None = None
) -> np.ndarray:
    """Ends (n, 2, 3) of lines along the edges of the geometry, where the mesh has them."""
    points = [(i / ALONG, 0) for i in range(ALONG + 1)]
    rule = {ET.SEGM: IntegrationRule(points, [0] * len(points))}
    values = _Place(deformation)(mesh.MapToAllElements(rule, mesh.BBoundaries(".*")))
    values = values.reshape(-1, len(points), 3)
    return np.stack([values[:, :-1], values[:, 1:]], axis=2).reshape(-1, 2, 3)


def _Place(deformation: GridFunction | CoefficientFunction | None) -> CoefficientFunction:
    place = CF((x, y, z))
    return place if deformation is None else place + deformation


def Patch(
    name: str,
    colour: str,
    triangles: np.ndarray,
    *,
    opacity: float = 1.0,
    flat: bool = False,
    behind: bool = False,
) -> dict[str, float | str]:
    """A surface of `triangles` (n, 3, 3): `flat` without shade and depth, `behind` the colours."""
    position = b64encode(np.asarray(triangles, dtype="<f4").tobytes()).decode("ascii")
    look = {"opacity": opacity, "flat": flat, "behind": behind}
    return {"name": name, "color": colour, "position": position, **look}


def Script(patches: list[dict[str, float | str]], legend: list[tuple[str, str]]) -> str:
    """The code that adds patches and a legend of (word, colour) to a scene, for ``js_code``."""
    added = json.dumps({"patches": patches, "legend": legend})
    return f"const added = {added};\n{SCRIPT.read_text()}"
