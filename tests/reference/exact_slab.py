"""The friction benchmark of a compressed slab on a rigid plane."""

from dataclasses import dataclass

import numpy as np

from ngslac.reference._checks import choice, finite, nonnegative, points, poisson, positive


@dataclass(frozen=True, kw_only=True)
class FrictionSlab:
    """Half of a slab, pushed down onto a rigid plane and in from its side, in plane strain.

    Source: code_aster, verification document V6.04.128 (SSNV128); see `GRECO_SLAB`.

    The body is the rectangle (0, width) x (0, height). The plane is y = 0; `top_pressure` acts on
    y = height and `side_pressure` on x = 0, both as pressures (positive pushes inwards); x = width
    is a plane of symmetry, without displacement along x. Both loads grow together.

    Parameters
    ----------
    width, height : float
        Size of the modelled half.
    young, nu, friction : float
        Young's modulus, Poisson ratio, coefficient of friction with the plane.
    top_pressure, side_pressure : float
        Loads.
    abscissae : tuple of float
        Points x on the contact line where displacements along x are known.
    published, converged : tuple of float
        These displacements as published, and as they converge under mesh refinement.
    open_end, slip_end : float
        Converged ends of the open part (from x = 0) and of the part that slips; the rest sticks.

    Raises
    ------
    ValueError
        If a number is out of range, or there is not one value for each abscissa.

    Examples
    --------
    >>> print(f"{GRECO_SLAB.FrictionlessDisplacement(0):.3e} {GRECO_SLAB.converged[0]:.3e}")
    4.062e-05 2.860e-05
    """

    width: float
    height: float
    young: float
    nu: float
    friction: float
    top_pressure: float
    side_pressure: float
    abscissae: tuple
    published: tuple
    converged: tuple
    open_end: float
    slip_end: float

    def __post_init__(self):
        positive("width", self.width)
        positive("height", self.height)
        positive("young", self.young)
        poisson("nu", self.nu)
        nonnegative("friction", self.friction)
        for name in ("top_pressure", "side_pressure", "open_end", "slip_end"):
            finite(name, getattr(self, name))
        for name in ("published", "converged"):
            self._OneEach(name, getattr(self, name))

    def _OneEach(self, name, values):
        """Values, one for each abscissa, as array."""
        wanted, found = points("abscissae", self.abscissae), points(name, values)
        if found.shape != wanted.shape:
            raise ValueError(
                f"{name} = {values!r} is not valid: give one value for each of the {wanted.size} "
                "abscissae"
            )
        return found

    def FrictionlessDisplacement(self, x) -> float | np.ndarray:
        """Displacement along x if the plane had no friction: the exact, uniform stress state.

        Position `x` (length) and result as in `HertzLine.Pressure`, but a length.
        """
        across = (1.0 - self.nu**2) * self.side_pressure
        strain = (across - self.nu * (1.0 + self.nu) * self.top_pressure) / self.young
        return strain * (self.width - points("x", x))

    def Errors(self, displacement, *, reference="converged") -> float | np.ndarray:
        """Relative errors of displacements at the abscissae.

        Parameters
        ----------
        displacement : (n,) array
            Along x at `abscissae` (length).
        reference : {"converged", "published"}
            Against which values; another name is a ValueError.

        Returns
        -------
        (n,) array
        """
        names = ("converged", "published")
        choice("reference", reference, names, "give 'converged' or 'published'")
        displacement = self._OneEach("displacement", displacement)
        return displacement / np.array(getattr(self, reference)) - 1.0


GRECO_SLAB = FrictionSlab(
    width=40e-3,
    height=40e-3,
    young=1.3e11,
    nu=0.2,
    friction=1.0,
    top_pressure=5e7,
    side_pressure=15e7,
    abscissae=(0.0, 1.25e-3, 5e-3, 7.5e-3, 11.25e-3),
    published=(2.86e-5, 2.72e-5, 2.28e-5, 1.98e-5, 1.50e-5),
    converged=(2.860e-5, 2.722e-5, 2.287e-5, 1.981e-5, 1.541e-5),
    open_end=3.3e-3,
    slip_end=29.8e-3,
)
"""The slab proposed by GRECO, a French research group, in SI units (m, Pa).

Sources: Raous and co-workers, and Feijoo, Barbosa and Zouain, studied this benchmark; data and
`published` are those of the code_aster verification case SSNV128, document V6.04.128 (there with a
tolerance of 5 %).
`converged`, `open_end` and `slip_end` are limits of mesh refinement with LAC elements, good to
about 0.5 % (displacements). They show that the last published value is about 3 % low.
"""
