# SPDX-License-Identifier: LGPL-2.1-or-later
"""Small problems with known solutions: does an installation work?

Two blocks that do not match carry one constant stress. With half of the shear at which they slide
the displacement is linear; with all of it the upper block has slid by a given way besides. The
method gives both to rounding, in 2D and in 3D.
"""

from __future__ import annotations

import numpy as np
from ngsolve import (
    CF,
    BilinearForm,
    Grad,
    GridFunction,
    InnerProduct,
    Integrate,
    Sym,
    VectorH1,
    ds,
    dx,
    specialcf,
    x,
    y,
    z,
)

from ngslac._ngslac import LACSpace
from ngslac.contact.contact import LACContact
from ngslac.materials import Stress
from ngslac.meshes import TwoBlocks, TwoBlocks3D
from ngslac.solve.solver import ContactSolver

__all__ = ["CASES", "Differs", "Errors"]

YOUNG, POISSON, PRESSURE, FRICTION = 2000.0, 0.3, 25.0, 0.4
ALLOWED = 1e-9  # Newton's method ends at 1e-10 of the forces
HELD = "bottom|top"
FREE = "left_.*|right_.*|front_.*|back_.*"

# Name -> dimension, part of the shear stress at which the blocks slide, and slip of the upper one.
CASES = {
    f"{name} in {dim}D": (dim, *load)
    for dim in (2, 3)
    for name, load in {"stick": (0.5, 0.0), "slip": (1.0, 0.01)}.items()
}


def Errors(dim: int, shear: float, slip: float) -> np.ndarray:
    """Relative errors of the stress in the blocks and of the force on the slave."""
    along, up = np.array([1.0, 0, 0] if dim == 2 else [0.8, 0.6, 0])[:dim], np.eye(dim)[-1]
    level = shear * FRICTION * PRESSURE
    stress = level * (np.outer(along, up) + np.outer(up, along)) - PRESSURE * np.outer(up, up)
    trace = np.trace(stress) * (1 + POISSON if dim == 2 else 1)  # in 2D of plane strain
    strain = ((1 + POISSON) * stress - POISSON * trace * np.eye(dim)) / YOUNG
    exact, strain = (CF(tuple(tensor.ravel()), dims=(dim, dim)) for tensor in (stress, strain))

    mesh = TwoBlocks(0.25) if dim == 2 else TwoBlocks3D("tet", None, (3, 2), (2, 3))
    V = VectorH1(mesh, order=2, dirichlet=HELD)
    fes = V * LACSpace(V, slave="slave")
    (u, lam), (v, _) = fes.TnT()
    a = BilinearForm(fes)
    a += InnerProduct(Stress(Sym(Grad(u)), YOUNG, POISSON), Sym(Grad(v))) * dx
    a += -InnerProduct(exact * specialcf.normal(dim), v) * ds(FREE)
    gf = GridFunction(fes)
    slid = mesh.BoundaryCF({"top": slip}, default=0) * CF(tuple(along))
    displacement = gf.components[0]
    displacement.Set(strain * CF((x, y, z)[:dim]) + slid, definedon=mesh.Boundaries(HELD))
    contact = LACContact(u, lam, master="master", friction=FRICTION)
    ContactSolver(a, gf, contact).Solve(printing=False)

    error = Stress(Sym(Grad(displacement)), YOUNG, POISSON) - exact
    mean = np.sqrt(Integrate(InnerProduct(error, error), mesh) / 2)  # over both blocks, of size 1
    missing = np.linalg.norm(contact.Force() + stress[:, -1])  # the slave looks down
    return np.array([mean, missing]) / np.linalg.norm(stress)


def Differs(dim: int, shear: float, slip: float) -> str:
    """Describe how the solution differs from the exact one; "" if it does not."""
    try:
        errors = Errors(dim, shear, slip)
    except Exception as error:  # to be reported, with the results of the other cases
        return f"{type(error).__name__}: {error}"
    parts = zip(("stress", "contact force"), errors, strict=True)
    wrong = [f"{name} off by {size:.1e}" for name, size in parts if not size <= ALLOWED]
    return " and ".join(wrong) + f", of {ALLOWED:.0e} allowed" if wrong else ""
