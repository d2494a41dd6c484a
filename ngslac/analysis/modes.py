# SPDX-License-Identifier: LGPL-2.1-or-later
"""Vibrations about a converged contact state."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from ngsolve import BilinearForm, CoefficientFunction, GridFunction

from ngslac.analysis.pencil import GROWS, WRONG, Pencil
from ngslac.analysis.steadysliding import SteadyTangent
from ngslac.analysis.tangent import Static
from ngslac.arguments import CheckCount, CheckInstance, CheckNumber, Wrong
from ngslac.arrays import ToCSR
from ngslac.errors import Warn
from ngslac.steps.inertia import Mass
from ngslac.table import Columns

if TYPE_CHECKING:
    from ngsolve.webgui import WebGLScene
    from scipy.sparse import csr_matrix

    from ngslac.contact.contact import LACContact
    from ngslac.solve.solver import ContactSolver, Equilibrium
    from ngslac.steps.load import LoadStepper
    from ngslac.steps.time import TimeStepper

__all__ = ["Modes"]

STATUS = "open", "stick", "slip"
# Pictures of a period, and largest displacement over the size of the mesh.
PICTURES, AMPLITUDE = 24, 0.1


class Modes:
    """Free vibrations about a converged contact state: frequencies, growth rates and shapes.

    Small motions ``Re(x exp(lambda t))`` of bulk and contacts as they are linearized at the state,
    with its stresses: what sticks is held, what slips moves on along with its friction, and what is
    open is free. Where something slips the matrix is not symmetric: two modes may meet in
    frequency, and then one of them grows, which is heard as squeal ("mode coupling",
    Hoffmann et al. 2002). Unknowns without mass, such as the multipliers, follow at once.

    In steady sliding friction points against the velocity. In 3D a velocity v across the sliding
    turns it, which resists as a damper of mu p / speed, not as a stiffness: give `speed`. Without
    it the sliding is fast, and nothing resists.

    Parameters
    ----------
    solver : ContactSolver, LoadStepper or TimeStepper
        At a converged state of equilibrium. It stays as it is. A TimeStepper stands for its static
        problem.
    density : float or CoefficientFunction
        Mass per reference volume (2D: per area and unit thickness), > 0.
    count : int
        How many modes, those of the lowest frequencies. Two of a pair that flutters stay together:
        there may be one more. A mesh that has fewer gives all.
    speed : float, CoefficientFunction or Parameter, optional
        Of the sliding, > 0, in 3D. Of 2D it changes nothing.
    slope : float
        Derivative of the coefficient of friction by the speed. Negative: friction falls with speed,
        and feeds vibrations along the sliding.
    damping : (float, float) or BilinearForm, optional
        Of the bulk: factors of mass (1/time) and of the bulk's stiffness (time), after Rayleigh; or
        a form of velocities on the product space.

    Attributes
    ----------
    eigenvalues : (k,) complex array
        lambda, with an imaginary part >= 0 (radian per time), by their absolute values. The motions
        of a rigid body that nothing resists have 0.
    vectors : (n, k) complex array
        Shapes on all scalar dofs of the product space, as columns: modal mass 1, and the largest
        displacement is real.
    residuals : (k,) array
        Of the eigenvalue problem, relative to the forces of inertia. Beyond 1e-6 a warning says so.

    Raises
    ------
    TypeError, ValueError
        The solver has not converged, or solves scalar fields; a wrong density, count, speed or
        damping; friction at its limit that depends on the fields of the contact; a flux.
    LinearSolveError
        The modes were not found.

    Notes
    -----
    Arnoldi's method with a real shift (ARPACK by SciPy), Lanczos' where the matrix is symmetric,
    dense algebra up to 300 dofs; with damping on a problem of twice the size. Amplitudes that
    reverse the sliding, or open the contact, are not small. A law of your own counts by its
    derivative. In 3D with large sliding friction turns with the slave about its normal, and a
    warning says so. Modes without frequency that grow are those of buckling.

    Examples
    --------
    >>> from ngslac.analysis import Modes
    >>> last = solver.Solve(printing=False)
    >>> modes = Modes(solver, density=1.0, count=2)
    >>> bool(modes.frequencies.min() > 0), modes.unstable.tolist()
    (True, [])
    """

    def __init__(
        self,
        solver: ContactSolver | LoadStepper | TimeStepper,
        density: CoefficientFunction | float,
        *,
        count: int = 6,
        speed: CoefficientFunction | float | None = None,
        slope: float = 0.0,
        damping: tuple[float, float] | BilinearForm | None = None,
    ):
        static, count = Static(solver), CheckCount("count", count)
        CheckContacts(static.contacts)
        self.contact = static.contacts[0]
        tangent, friction = SteadyTangent(static, speed, slope)
        fields = {contact.form.offset: contact for contact in static.contacts}.values()
        masses = [Mass(static.a, contact, density, tangent.free).matrix for contact in fields]
        mass = sum(each.entries for each in masses)
        bulk = Damping(damping, static, mass, tangent.bulk)
        pencil = Pencil.Of(tangent, mass, [part for part in (friction, bulk) if part is not None])
        most = np.count_nonzero(pencil.heavy) - 3
        if count > most:
            raise ValueError(f"count = {count} must be at most {most}, for so few free dofs")
        self._status = np.concatenate([contact.Table()["status"] for contact in static.contacts])
        self.eigenvalues, self.vectors = pencil.Modes(count)
        self.residuals = pencil.Residuals(self.eigenvalues, self.vectors)
        if not np.all(self.residuals <= WRONG):
            Warn(f"modes: residuals up to {np.max(self.residuals):.1e}: the last ones may be wrong")

    @property
    def frequencies(self) -> np.ndarray:
        """Cycles per time (k,), Hz where times are seconds."""
        return self.eigenvalues.imag / (2 * np.pi)

    @property
    def growth(self) -> np.ndarray:
        """Growth rates of amplitudes (k,), 1/time: < 0 of vibrations that die away."""
        return self.eigenvalues.real

    @property
    def unstable(self) -> np.ndarray:
        """Numbers of the modes that grow, from 0 on."""
        return np.flatnonzero(self.growth > GROWS * np.abs(self.eigenvalues))

    def Table(self) -> dict[str, np.ndarray]:
        """The modes as numpy arrays, which print as a table.

        Returns
        -------
        dict
            ``mode`` (k,), ``frequency`` (k,), ``growth`` (k,), ``residual`` (k,).
        """
        return Columns(
            mode=np.arange(len(self.eigenvalues)),
            frequency=self.frequencies,
            growth=self.growth,
            residual=self.residuals,
        )

    def __repr__(self) -> str:
        closed = [f"{word} {np.sum(self._status == k)}" for k, word in enumerate(STATUS)]
        return f"<Modes: {len(self.growth)}, {len(self.unstable)} growing; {', '.join(closed)}>"

    def __str__(self) -> str:
        lines = [repr(self), str(self.Table())]
        for k in self.unstable:
            kind = "vibrates (flutter)" if self.frequencies[k] else "leaves the state (divergence)"
            lines.append(f"mode {k} grows by exp({self.growth[k]:.6g} t): it {kind}")
        return "\n".join(lines)

    def Shape(self, k: int) -> tuple[GridFunction, GridFunction]:
        """Real and imaginary part of the displacement of a mode.

        Parameters
        ----------
        k : int
            Its number.

        Returns
        -------
        tuple of GridFunction
            On the space of the displacement.

        Raises
        ------
        TypeError, ValueError
            There is no such mode.
        """
        k, most = CheckCount("k", k, least=0), len(self.eigenvalues) - 1
        if k > most:
            raise Wrong(ValueError, "k", k, f"the number of a mode, from 0 to {most}")
        form, values = self.contact.form, self.vectors[:, k]
        parts = GridFunction(form.component), GridFunction(form.component)
        for part, entries in zip(parts, (values.real, values.imag), strict=True):
            first, size = form.offset * form.fes.dim, len(part.vec.FV())
            part.vec.FV().NumPy()[:] = entries[first : first + size]
        return parts

    def Draw(self, k: int = 0, *, scale: float | None = None, **options) -> WebGLScene:
        """Show a mode in the webgui, as a film of one period without growth.

        Parameters
        ----------
        k : int
            Its number.
        scale : float, optional
            Factor of the shape. Default: the largest displacement is a tenth of the mesh.
        **options :
            Handed to `ngsolve.webgui.Draw`, such as show.

        Returns
        -------
        ngsolve.webgui.WebGLScene
        """
        from ngsolve import webgui

        real, imaginary = self.Shape(k)
        film = GridFunction(real.space, multidim=0, name=f"mode {k}")
        parts = [part.vec.FV().NumPy().copy() for part in (real, imaginary)]
        mesh = real.space.mesh
        if scale is None:
            size = np.ptp([vertex.point for vertex in mesh.vertices], axis=0).max()
            scale = AMPLITUDE * size / np.abs(parts).max()
        CheckNumber("scale", scale)
        for phase in np.linspace(0, 2 * np.pi, PICTURES, endpoint=False):
            moved = np.cos(phase) * parts[0] - np.sin(phase) * parts[1]
            real.vec.FV().NumPy()[:] = scale * moved
            film.AddMultiDimComponent(real.vec)
        options = {"deformation": True, "animate": True} | options
        return webgui.Draw(film, mesh, **options)


def CheckContacts(contacts: Sequence[LACContact]) -> None:
    """Raise where the contacts are not those of displacements alone."""
    if contacts[0].components == 1 or any(contact.fluxes for contact in contacts):
        raise ValueError(
            "solver is that of a scalar field, or has a contact with flux=: such a field has no "
            "inertia, and would follow at once; solve the displacement alone, at these fields"
        )


def Damping(
    damping: tuple[float, float] | BilinearForm | None,
    static: Equilibrium,
    mass: csr_matrix,
    bulk: csr_matrix,
) -> csr_matrix | None:
    """The matrix (n, n) of the bulk's damping, or None."""
    if damping is None:
        return None
    if isinstance(damping, tuple) and len(damping) == 2:
        for k, factor in enumerate(damping):
            known = "a finite number >= 0", lambda x: 0 <= x < np.inf
            CheckNumber(f"damping[{k}]", factor, *known)
        return damping[0] * mass + damping[1] * bulk
    wanted = "two factors, of mass and stiffness, or a BilinearForm on the product space"
    CheckInstance("damping", damping, BilinearForm, wanted)
    if damping.space != static.gf.space:
        raise ValueError("damping lives on another space than the solution: take that of the bulk")
    damping.AssembleLinearization(static.gf.vec)
    return ToCSR(damping.mat)
