"""Two bodies pressed together: what Hertz contacts of lines and of points have in common."""

from dataclasses import dataclass
from math import inf

from ._checks import positive
from .dundurs import ContactModulus, DundursBeta

__all__ = ["HertzPair"]


@dataclass(frozen=True, kw_only=True)
class HertzPair:
    """Normal force, radii and elastic constants of two bodies, checked."""

    force: float
    radius1: float
    radius2: float = inf
    young1: float
    nu1: float
    young2: float
    nu2: float

    def __post_init__(self):
        positive("force", self.force)
        positive("radius1", self.radius1, infinite=True)
        positive("radius2", self.radius2, infinite=True)
        if self.radius1 == inf and self.radius2 == inf:
            raise ValueError(
                f"radius2 = {self.radius2!r} is not valid: surface 1 is flat already, "
                "give one of the radii a finite value"
            )
        _ = self.modulus  # checks the elastic constants

    @property
    def _elastic(self):
        return dict(young1=self.young1, nu1=self.nu1, young2=self.young2, nu2=self.nu2)

    @property
    def modulus(self):
        """Contact modulus E* (see `ContactModulus`)."""
        return ContactModulus(**self._elastic)

    @property
    def beta(self):
        """Second Dundurs constant, with body 1 as the slave (see `DundursBeta`)."""
        return DundursBeta(**self._elastic)

    @property
    def radius(self):
        """Relative radius R, 1/R = 1/R1 + 1/R2."""
        return 1.0 / (1.0 / self.radius1 + 1.0 / self.radius2)

    def _ShearSum(self, factor1=1.0, factor2=1.0):
        """Sum factor1/G1 + factor2/G2 over both bodies; a rigid one adds nothing."""
        soft1, soft2 = 2.0 * (1.0 + self.nu1) / self.young1, 2.0 * (1.0 + self.nu2) / self.young2
        return factor1 * soft1 + factor2 * soft2
