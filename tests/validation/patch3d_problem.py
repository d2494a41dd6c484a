"""The patch test of two blocks in 3D: constant stress, loads, and what is exact."""

import math

import numpy as np
from elasticity import Displacements
from elasticity3d import Field, Solid, StressError
from ngsolve import (
    CF,
    ET,
    VOL,
    BilinearForm,
    GridFunction,
    InnerProduct,
    LinearForm,
    Sym,
    ds,
    dx,
    specialcf,
    x,
    y,
    z,
)
from ngsolve import Grad as Gradient

from ngslac.meshes.blocks3d import TwoBlocks3D
from ngslac.meshes.geometry3d import CheckNonMatching3D, RotationMatrix

HELD = "bottom|left_upper"
FREE = "top|(right|front|back)_upper|(left|right|front|back)_lower|(master|slave)_rim"
PRESSURE, SHEAR, FRICTION = 25.0, 4.0, 0.3
TURN = ((1.0, 2.0, -0.5), 67.0)
OBLIQUE = {"shape": "oblique", "perturb": 0.2, "rotation": TURN}
# Options of the contact, traction along the slip direction, and slip of the slave.
LAWS = {
    "frictionless": ({}, 0.0, 0.0),
    "stick": ({"friction": FRICTION}, SHEAR, 0.0),
    "slip": ({"friction": FRICTION}, FRICTION * PRESSURE, -2e-3),
    "tresca": ({"tresca": SHEAR}, SHEAR, -1e-3),
    "tied": ({"tied": True}, SHEAR, 0.0),
}


def Frame(slope=20.0, azimuth=30.0, shape="flat", rotation=None, **_):
    """Two tangents of the interface and the normal out of the upper block, as columns."""
    a = math.radians(azimuth)
    rise = math.tan(math.radians(slope)) if shape == "oblique" else 0.0
    normal = np.array([rise * math.cos(a), rise * math.sin(a), -1.0])
    normal /= np.linalg.norm(normal)
    tangent = np.cross(normal, [0.3, 0.8, 0.1])  # no direction of the meshes
    tangent /= np.linalg.norm(tangent)
    axes = np.column_stack([tangent, np.cross(normal, tangent), normal])
    return RotationMatrix(rotation) @ axes


def Stress(options, *, shear=0.0, pressure=PRESSURE):
    """A constant stress with the given traction on the interface."""
    axes = Frame(**options)
    return axes @ np.array([[-7, 2, shear], [2, 5, 0], [shear, 0, -pressure]]) @ axes.T


def Linear(options, gradient, shift=(0.0, 0.0, 0.0)):
    """A linear displacement without rotation about the middle of the interface."""
    middle = options.get("scale", 1.0) * RotationMatrix(options.get("rotation"))[:, :2].mean(axis=1)
    return Field(gradient) * (CF((x, y, z)) - CF(tuple(middle))) + CF(tuple(shift))


def HasPyramids(mesh):
    return any(el.type == ET.PYRAMID for el in mesh.Elements(VOL))


def Patch(pair, options, stress, *, slip=0.0, lower=None, contact="slave|master", held=HELD):
    """Load, hold and solve; returns the largest errors of stress and traction."""
    strain, below = (m.Strain(stress) for m in (Solid(), lower or Solid()))
    fields = {
        "left_upper": Linear(options, strain, slip * Frame(**options)[:, 0]),
        "bottom": Linear(options, below),
    }
    pair.Hold(pair.mesh.BoundaryCF(fields), held)
    if HasPyramids(pair.mesh):
        pair.LoadStressInside(stress, contact)
    else:
        pair.LoadStress(stress, FREE)
    pair.Solve(tol=1e-13)
    return pair.StressError(stress), TractionError(pair, stress)


def TractionError(pair, stress, weights=1.0):
    """Largest error of the multipliers relative to the stress; open ones must carry nothing."""
    table = pair.contact.Table()
    exact = np.where(table["area"][:, None] > 0, table["normal"] @ stress, 0.0)
    error = np.abs(table["traction"] - exact).max(axis=1)
    return (weights * error).max() / np.abs(stress).max()


def Blocks(kinds, space, *, slave="slave", **options):
    """Mesh and displacements; that the meshes do not match is asserted after a split too."""
    divisions = (4, 3) if space == "P1" else (3, 2)  # P1 has vertex stars as macro-elements
    sizes = {"n_slave": divisions, "n_master": divisions[::-1]}
    mesh = TwoBlocks3D(*kinds, **sizes | options)
    V = Displacements(mesh, space, slave=slave, dirichlet=HELD)
    assert CheckNonMatching3D(V.mesh) > 1e-3
    return V


def BulkError(V, options, stress):
    """Error of the stress in the solution with tractions on the surface and without contact.

    The contact faces are held as well, hence V has to be fixed there.
    """
    u, v = V.TnT()
    a = BilinearForm(InnerProduct(Solid().Stress(Sym(Gradient(u))), Sym(Gradient(v))) * dx)
    load = LinearForm(InnerProduct(Field(stress) * specialcf.normal(3), v) * ds(FREE))
    gf = GridFunction(V)
    gf.Set(
        Linear(options, Solid().Strain(stress)), definedon=V.mesh.Boundaries(f"{HELD}|slave|master")
    )
    a.Assemble()
    load.Assemble()
    rest = (load.vec - a.mat * gf.vec).Evaluate()
    gf.vec.data += a.mat.Inverse(V.FreeDofs()) * rest
    return StressError(gf.space.mesh, Solid().Stress(Sym(Gradient(gf))), stress)
