"""Two thin plates of one layer of elements, clamped at one end, the upper one over the lower."""

import numpy as np
from netgen.meshing import Mesh as NetgenMesh
from ngsolve import (
    Mesh,
    VectorH1,
    ds,
)
from posed import elastic, posed

from ngslac.meshes import StructuredBox

THICKNESS, YOUNG = 0.02, 1e5


def body(ngmesh, name, x, y, z, kind):
    box = StructuredBox(x, y, z, kind, names=lambda side, centre: f"{name}_{side}")
    box.AddTo(ngmesh, name)


def plates(kind="tet", *, n=(16, 19), friction=None, both=False, order=2, **flags):
    """The upper one is pushed at its free end, the lower one also clamped there for `both`."""
    ngmesh, across = NetgenMesh(dim=3), np.linspace(0, 0.2, 3)
    body(ngmesh, "upper", np.linspace(0, 1, n[0] + 1), across, [0, THICKNESS], kind)
    wider = np.linspace(-0.01, 0.21, 4)
    body(ngmesh, "lower", np.linspace(0, 1, n[1] + 1), wider, [-THICKNESS, 0], kind)
    ngmesh.Compress()
    mesh = Mesh(ngmesh)
    held = "upper_left|lower_left" + ("|lower_right" if both else "")
    V = VectorH1(mesh, order=order, dirichlet=held)
    law = {"slave": "upper_bottom", "master": "lower_top", "friction": friction} | flags
    return posed(
        V, elastic(YOUNG, 0.3), lambda u, v, load: 3 * load * v[2] * ds("upper_right"), **law
    )
