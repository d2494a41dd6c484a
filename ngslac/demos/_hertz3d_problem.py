"""The Hertz problems in 3D: what is computed, its mesh, space and form."""

from __future__ import annotations

from dataclasses import dataclass

from ngsolve import CF, Id, InnerProduct, Integrate, OuterProduct, Sym, Trace, VectorH1, ds, dx
from ngsolve import Grad as Gradient

from ngslac import BubbleVectorH1, SplitSlaveFaces
from ngslac.meshes.geometry3d import RotationMatrix
from ngslac.meshes.spheres import SphereOnBlock
from ngslac.reference import HertzLine, HertzPoint

from ._hertz3d_mesh import THICKNESS, CylinderOnBlock

__all__ = ["Displacements", "Form", "Problem", "Stress"]

YOUNG = {"body": 210e3, "block": 70e3}  # MPa
POISSON = 0.3
RADIUS = 50.0  # mm
# N on the whole sphere, N/mm on the cylinder: both have a contact radius (half width) of 2.5 mm.
FORCE = {"sphere": 24e3, "cylinder": 5.7e3}


@dataclass(frozen=True, kw_only=True)
class Problem:
    """What to compute.

    Parameters
    ----------
    shape : {"sphere", "cylinder"}
    model : {"quarter", "full"}
        x, y >= 0 (of the cylinder: x >= 0), or all. Only the full sphere can be rotated.
    order : int
        Order of the displacement.
    h : float
        Size of the slave faces in mm; the contact radius is 2.5 mm.
    maxh : float, optional
        Largest size of elements of the sphere and its block in mm, by default 25.
    force : float
        The load, as part of 24 kN (sphere) or 5.7 kN/mm (cylinder). The mesh is fine in a zone that
        grows with the contact radius.
    friction : float
        Coefficient of friction.
    steps : int
        Number of equal load steps.
    stabilize : {"none", "bubble", "split"}
        "bubble" adds a displacement bubble on every slave face, "split" divides the slave faces.
        Without them macro-elements are made of several faces where that is needed.
    inverse : str, optional
        Sparse direct solver, see `ContactSolver`.
    length, stress : float
        Units of the computation: one millimetre and one MPa expressed in them, e.g. ``1e-3`` and
        ``1e6`` to compute in metres and pascals. Results are in mm and MPa.
    rotation : (3, 3) array_like or (axis, float)
        Rotation of the whole problem, see `RotationMatrix`.
    """

    shape: str = "sphere"
    model: str = "quarter"
    order: int = 2
    h: float = 0.3125
    maxh: float | None = None
    force: float = 1.0
    friction: float = 0.0
    steps: int = 1
    stabilize: str = "none"
    inverse: str | None = None
    length: float = 1.0
    stress: float = 1.0
    rotation: object = None

    def __post_init__(self):
        for name, values in {
            "shape": ("sphere", "cylinder"),
            "model": ("quarter", "full"),
            "stabilize": ("none", "bubble", "split"),
        }.items():
            if getattr(self, name) not in values:
                raise ValueError(f"{name} must be one of {values}, not {getattr(self, name)!r}")
        if self.rotation is not None and (self.shape, self.model) != ("sphere", "full"):
            raise ValueError("only the full sphere can be rotated: the others have symmetry planes")

    @property
    def frame(self):
        """Unit vectors of the x, y and z direction of the problem, as rows."""
        return RotationMatrix(self.rotation).T

    @property
    def load(self):
        """Total force on the model."""
        force = self.force * FORCE[self.shape] * self.stress
        if self.shape == "sphere":
            return force * self.length**2 * (0.25 if self.model == "quarter" else 1.0)
        return force * self.length * self.Thickness() * (0.5 if self.model == "quarter" else 1.0)

    def Thickness(self):
        """Thickness of the slice of the cylinder in units of the computation."""
        return THICKNESS * self.length

    def Hertz(self, t=1.0):
        """Hertz' solution at the load factor t, in mm and MPa."""
        kind = HertzPoint if self.shape == "sphere" else HertzLine
        return kind(
            force=self.force * FORCE[self.shape] * t,
            radius1=RADIUS,
            young1=YOUNG["body"],
            nu1=POISSON,
            young2=YOUNG["block"],
            nu2=POISSON,
        )

    def Mesh(self):
        """The mesh: fine where they touch, and a bit around it."""
        hertz = self.Hertz()
        # A coarse, soft master of linear elements deforms with kinks. A stiff slave has to follow
        # them, which single faces answer by oscillating pressures: these need a finer master.
        ratio = 0.6 if self.order == 1 and self.stabilize != "none" else 1.2
        sizes = dict(radius=RADIUS, model=self.model, scale=self.length, ratio=ratio)
        if self.shape == "cylinder":
            return CylinderOnBlock(self.h, zone=1.3 * hertz.halfwidth, **sizes)
        return SphereOnBlock(
            self.h,
            zone=1.3 * hertz.contact_radius,
            order=max(2, self.order),
            maxh=self.maxh,
            rotation=self.rotation,
            **sizes,
        )


def Stress(problem, mesh, strain):
    """Stress of linear elasticity."""
    block = YOUNG["block"] * problem.stress
    young = mesh.MaterialCF({"block": block}, default=YOUNG["body"] * problem.stress)
    mu = young / (2 * (1 + POISSON))
    return 2 * mu * (strain + POISSON / (1 - 2 * POISSON) * Trace(strain) * Id(3))


def Displacements(problem, mesh):
    """Displacement space with the conditions at the bottom and on the symmetry planes."""
    if problem.stabilize == "split":
        mesh = SplitSlaveFaces(mesh, "slave")
    fixed = {
        "dirichletx": "bottom|sym_x",
        "dirichlety": "bottom|sym_y",
        "dirichletz": "bottom",
    }
    if problem.stabilize == "bubble":
        return BubbleVectorH1(mesh, order=problem.order, slave="slave", **fixed)
    return VectorH1(mesh, order=problem.order, **fixed)


def Form(problem, mesh, u, v, load):
    """Elasticity, and the load by way of a plate on the upper side.

    The plate resists to being stretched and tilted, and to horizontal motion, but not to a motion
    up or down. A sphere on a block without friction needs that in order not to roll.
    """
    form = InnerProduct(Stress(problem, mesh, Sym(Gradient(u))), Sym(Gradient(v))) * dx
    up = CF(tuple(problem.frame[2]))
    area = Integrate(CF(1) * ds(definedon=mesh.Boundaries("top")), mesh)
    size = RADIUS * problem.length
    young = YOUNG["body"] * problem.stress
    across = Id(3) - OuterProduct(up, up)
    plate = size * InnerProduct(Gradient(u).Trace(), Gradient(v).Trace())
    plate += InnerProduct(across * u, v) / size
    form += young * plate * ds("top")
    form += load * problem.load / area * InnerProduct(up, v) * ds("top")
    return form
