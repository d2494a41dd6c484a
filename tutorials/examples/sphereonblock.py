"""A sphere on a block of the same material: sizes, material, and what is known of a step."""

from dataclasses import dataclass

import numpy as np
from ngsolve import *

from ngslac.materials import Stress
from ngslac.meshes import SphereOnBlock
from ngslac.reference import HertzPoint

OPEN, STICK, SLIP = 0, 1, 2
COPIES = {"quarter": 4, "half": 2, "full": 1}  # of the model, which make the whole


@dataclass(frozen=True, kw_only=True)
class Sphere:
    """What a push and a twist have in common; in mm and MPa."""

    model: str  # "quarter" for twists, "half" (y >= 0) for shifts along x, "full"
    elements: float  # edges along the contact radius
    order: int = 2  # of the displacement
    # Macro-elements are single triangles or, with "none", several (two for order 2).
    stabilize: str = "bubble"
    friction: float = 0.3  # Coulomb's coefficient
    young: float = 70e3  # of both bodies
    nu: float = 0.3
    radius: float = 50.0  # of the sphere, half width and height of the block
    contact: float = 1.0  # radius to aim at; since the bodies are finite it gets a bit larger
    zone: float = 1.25  # radius of the slave face over `contact`
    grading: float = 0.5  # of the elements away from there
    press: int = 2  # steps of the normal motion
    steps: int = 5  # of the tangential motion, after a first small one
    # Friction acts while the normal load grows, too. It should not matter much, since bodies of the
    # same material have no reason to slip then; what it leaves are small radial tractions, from the
    # curvature and from the discretization.
    rough: bool = True

    @property
    def approach(self):
        """Displacement of the top towards the block, at which Hertz' radius is `contact`."""
        return self.contact**2 / self.radius

    @property
    def shear_modulus(self):
        return self.young / (2 * (1 + self.nu))

    def Hertz(self, force):
        """Hertz' solution for a normal force."""
        elastic = dict(young1=self.young, nu1=self.nu, young2=self.young, nu2=self.nu)
        return HertzPoint(force=force, radius1=self.radius, **elastic)

    def Mesh(self):
        """The mesh of the model."""
        return SphereOnBlock(
            self.contact / self.elements,
            radius=self.radius,
            zone=self.zone * self.contact,
            width=self.radius,
            height=self.radius,
            model=self.model,
            grading=self.grading,
        )

    def Stress(self, u):
        """Stress of a displacement."""
        return Stress(Sym(Grad(u)), self.young, self.nu)


@dataclass(frozen=True)
class State:
    """A converged step. Arrays run over the macro-elements of the model.

    `force` and `moment` (about the z axis) act on the slave, and are those of the whole contact;
    `motion` has the approach, shift and angle of the top.
    """

    motion: dict
    force: np.ndarray
    moment: float
    area: np.ndarray
    pressure: np.ndarray
    traction: np.ndarray  # (n, 2), tangential, in the plane
    slip: np.ndarray  # (n, 2), of the last step
    status: np.ndarray
    iterations: int
    copies: int  # of the model in the whole
    vector: object  # of the solution

    def Radius(self, *status):
        """Radius of a disc with the area of all macro-elements of these statuses."""
        area = self.copies * self.area[np.isin(self.status, status)].sum()
        return float(np.sqrt(area / np.pi))
