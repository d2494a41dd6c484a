"""Two thin plates of one layer of elements, clamped at one end, the upper one over the lower."""

import numpy as np
from netgen.meshing import Mesh as NetgenMesh
from ngsolve import (
    BilinearForm,
    Grad,
    GridFunction,
    InnerProduct,
    Mesh,
    Parameter,
    Sym,
    VectorH1,
    ds,
    dx,
)
from press import Press

from ngslac import LACContact, LACSpace
from ngslac.materials import Stress
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
    X = V * LACSpace(V, slave="upper_bottom")
    (u, lam), (v, _) = X.TnT()
    a, load = BilinearForm(X), Parameter(1.0)
    a += InnerProduct(Stress(Sym(Grad(u)), YOUNG, 0.3), Sym(Grad(v))) * dx
    a += 3 * load * v[2] * ds("upper_right")
    contact = LACContact(u, lam, master="lower_top", friction=friction, **flags)
    return Press(mesh, X, a, GridFunction(X), contact, load)
