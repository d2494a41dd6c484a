# SPDX-License-Identifier: LGPL-2.1-or-later
"""A mesh with its geometry as the bytes of NGSolve's archives, from which it comes back exactly.

NGSolve's text format would round the curved elements.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import ngsolve
import numpy as np
from netgen import meshing

if TYPE_CHECKING:
    from ngsolve import Mesh

__all__ = ["MeshOf", "MeshState"]


def Classes() -> dict[str, type]:
    """What meshes are made of, by name: nothing else is made from a file."""
    from netgen.csg import CSGeometry
    from netgen.geom2d import SplineGeometry
    from netgen.stl import STLGeometry

    found = {
        "Mesh": ngsolve.Mesh,
        "NetgenMesh": meshing.Mesh,
        "CSGeometry": CSGeometry,
        "SplineGeometry": SplineGeometry,
        "STLGeometry": STLGeometry,
    }
    try:
        from netgen.occ import OCCGeometry
    except ImportError:  # of a netgen without OpenCascade
        return found
    return found | {"OCCGeometry": OCCGeometry}


def MeshState(mesh: Mesh) -> dict:
    """The state of a mesh in dicts, lists, bytes and arrays."""
    return {"parts": Parts(mesh), "volumes": Volumes(mesh), "order": mesh.GetCurveOrder()}


def MeshOf(state: dict) -> Mesh:
    """The mesh of a `MeshState`."""
    mesh = Whole(state["parts"])
    if not SameVolumes(mesh, state):
        mesh.Curve(state["order"])  # NGSolve's archives lose that of meshes that were refined
    if not SameVolumes(mesh, state):
        raise ValueError("the mesh does not come back as it was saved: make it as it was made then")
    return mesh


def Volumes(mesh: Mesh) -> np.ndarray:
    return np.array(ngsolve.Integrate(1.0, mesh, element_wise=True))


def SameVolumes(mesh: Mesh, state: dict) -> bool:
    """Curvature included: to rounding, to which surfaces of geometries project points."""
    return np.allclose(Volumes(mesh), state["volumes"], rtol=1e-9, atol=0)


def Parts(thing: Any) -> dict | bytes | None:
    """A mesh or a geometry as the bytes that NGSolve's pickle consists of."""
    if thing is None or isinstance(thing, bytes):
        return thing
    for name, kind in Classes().items():
        if type(thing) is kind:
            (parts,) = thing.__getstate__()
            return {"kind": name, "parts": [Parts(part) for part in parts]}
    raise TypeError(f"a mesh with a {type(thing).__name__} cannot be saved")


def Whole(parts: dict | bytes | None) -> Any:
    """The inverse of `Parts`."""
    if not isinstance(parts, dict):
        return parts
    kind = Classes()[parts["kind"]]
    thing = kind.__new__(kind)
    thing.__setstate__(([Whole(part) for part in parts["parts"]],))
    return thing
