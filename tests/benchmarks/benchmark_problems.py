"""The problems of `scaling.py`: meshes of a wanted number of displacements, loads, supports."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from ngsolve import (
    CF,
    BilinearForm,
    Grad,
    GridFunction,
    IfPos,
    InnerProduct,
    Integrate,
    LinearForm,
    Parameter,
    Sym,
    VectorH1,
    ds,
    dx,
)

from ngslac import LACContact, LACSpace
from ngslac.materials import Stress
from ngslac.meshes import HertzMesh, SphereOnBlock, TwoBlocks3D
from ngslac.meshes.geometry import CheckNonMatching

__all__ = ["HERTZ_FORCE", "SIZES", "Problem", "Refined"]

NU = 0.3
YOUNG = {"cylinder": 210e3, "sphere": 210e3, "upper": 2000.0, "block": 70e3, "lower": 4000.0}
RADIUS = 50.0  # of sphere and cylinder, mm
HERTZ_FORCE = 35e3 / 2  # N/mm on the half model
# Contact radius 5 mm: E* = 1 / (2 (1 - nu^2) / E), summed over the bodies.
SPHERE_FORCE = 4 / 3 * 5.0**3 / RADIUS / ((1 - NU**2) * (1 / 210e3 + 1 / 70e3)) / 4
PRESSURE, SHEAR = 25.0, (5.0, 1.5)  # on the upper block, whose section is 1: some of it slips
PRESSED = 0.2  # load factor at which the pressure is complete and the shear begins

# Number of displacements asked for -> parameters of the mesh: divisions and layers of the blocks;
# size on the slave side and of the sphere the grading and the largest size, of the cylinder the
# grading and the number of uniform refinements.
PATCH = {1_110: (2, 2), 20_000: (7, 6), 100_000: (12, 12), 300_000: (17, 19), 1_000_000: (26, 28)}
FINE = (0.2, 12.0)
SPHERE = {1_600: (3.0, 0.5, 40.0), 20_000: (1.07, *FINE), 100_000: (0.373, *FINE)}
SPHERE |= {300_000: (0.19, *FINE), 1_000_000: (0.097, *FINE)}
HERTZ = {2_600: (2.0, 0.3, 0), 20_000: (0.25, 0.08, 0), 100_000: (0.047, 0.05, 0)}
HERTZ |= {300_000: (0.0625, 0.06, 1), 1_000_000: (0.08, 0.06, 2)}
SIZES = {"patch": PATCH, "patch_hex": PATCH, "sphere": SPHERE, "hertz": HERTZ}


@dataclass(frozen=True)
class Problem:
    """Two blocks of tetrahedra or hexahedra ("patch", "patch_hex"), a quarter of a sphere on a
    block ("sphere"), half a cylinder on a block in 2D ("hertz").
    """

    name: str
    size: int | None = None  # displacement dofs, of ``SIZES[name]``; within a tenth of it
    friction: float = 0.0

    def Parameters(self):
        """Those of the mesh, from the table."""
        if self.size not in SIZES[self.name]:
            known = ", ".join(str(size) for size in SIZES[self.name])
            raise ValueError(f"{self.name} has no mesh of {self.size} dofs, but {known}")
        return SIZES[self.name][self.size]

    def Mesh(self):
        """The mesh; its contact faces do not match."""
        given = self.Parameters()
        if self.name == "hertz":
            return Refined(HertzMesh(given[0], grading=given[1]), given[2])
        if self.name == "sphere":
            block = {"width": 60.0, "height": 60.0, "ratio": 1.13, "maxh": given[2]}
            return SphereOnBlock(given[0], radius=RADIUS, zone=8.0, grading=given[1], **block)
        kind, (n, layers) = "hex" if self.name == "patch_hex" else "tet", given
        return TwoBlocks3D(kind, n_slave=n, n_master=n + 1, layers=(layers, layers))

    def Space(self, mesh, both=False):
        """Displacements with the supports of the contact problem, or with both bodies held."""
        x, y, bottom = "sym_x", "sym_y", "bottom"
        if self.name == "hertz":
            bottom += "|arc" if both else ""
            return VectorH1(mesh, order=2, dirichletx="bottom|sym", dirichlety=bottom)
        bottom += "|top" if both else ""
        if self.name.startswith("patch"):
            if self.friction or both:  # friction holds the upper block
                return VectorH1(mesh, order=2, dirichlet=bottom)
            x, y = (f"{side}_upper|{side}_lower" for side in ("left", "front"))
        return VectorH1(mesh, order=2, dirichletx=x, dirichlety=y, dirichletz=bottom)

    def Load(self):
        """Force on the slave body, a component for each direction."""
        if self.name == "hertz":
            return (0.0, -HERTZ_FORCE)
        if self.name == "sphere":
            return (0.0, 0.0, -SPHERE_FORCE)
        return (*(SHEAR if self.friction else (0.0, 0.0)), -PRESSURE)

    def Imbalance(self, force):
        """Contact force on the slave against its load, relative; supports may take the others."""
        taken = {"hertz": [1], "sphere": [2]}.get(self.name, [0, 1, 2])
        load = np.array(self.Load())
        return float(np.linalg.norm((np.array(force) + load)[taken]) / np.linalg.norm(load))

    def _Loading(self, mesh, v, load):
        """Virtual work of the load at a load factor, with a minus.

        The blocks are pressed first and pushed then: at proportional loads all steps after the
        first one would have nothing to do.
        """
        force = load * CF(self.Load())
        if self.name.startswith("patch") and self.friction:
            press = IfPos(load - PRESSED, 1, load / PRESSED)
            push = IfPos(load - PRESSED, (load - PRESSED) / (1 - PRESSED), 0)
            force = CF((*(push * f for f in SHEAR), -press * PRESSURE))
        if self.name == "hertz":
            return -InnerProduct(force, v) * ds(definedon=mesh.BBoundaries("load"))
        area = Integrate(1, mesh, definedon=mesh.Boundaries("top"))
        return -1 / area * InnerProduct(force, v) * ds("top")

    def Product(self, mesh):
        V = self.Space(mesh)
        return V * LACSpace(V, slave="slave")

    def Contact(self, fes):
        """What a user writes on this space: bulk with load, contact, load factor, solution."""
        (u, lam), (v, _) = fes.TnT()
        a, load = BilinearForm(fes), Parameter(0.0)
        a += Bulk(fes.mesh, u, v)
        a += self._Loading(fes.mesh, v, load)
        contact = LACContact(u, lam, master="master", friction=self.friction or None)
        return a, contact, load, GridFunction(fes)

    def Elastic(self, mesh):
        """Form and load of linear elasticity on the same mesh with both bodies held."""
        V = self.Space(mesh, both=True)
        u, v = V.TnT()
        a, f = BilinearForm(V), LinearForm(V)
        a += Bulk(mesh, u, v)
        f += v[mesh.dim - 1] * ds("slave") - v[mesh.dim - 1] * ds("master")
        return a, f.Assemble()


def Refined(mesh, times):
    """Netgen fails on plane faces with a side of more than a thousand edges."""
    for _ in range(times):
        mesh.Refine()
    mesh.Curve(2)
    CheckNonMatching(mesh)
    return mesh


def Bulk(mesh, u, v):
    """Linear elasticity, in 2D in plane strain."""
    young = mesh.MaterialCF({name: YOUNG[name] for name in mesh.GetMaterials()})
    return InnerProduct(Stress(Sym(Grad(u)), young, NU), Sym(Grad(v))) * dx
