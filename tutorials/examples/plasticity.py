"""J2 plasticity on quadrature points, with NGSolve alone: an incremental energy and its state."""

from __future__ import annotations

import math

import numpy as np
from ngsolve import *
from ngsolve import Integrate as NGSolveIntegrate
from ngsolve.comp import IntegrationRuleSpace

_ENTRIES = ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))


def PlaneStrain(gradient):
    """Small strain (3, 3) of a displacement gradient (2, 2)."""
    shear = 0.5 * (gradient[0, 1] + gradient[1, 0])
    return CF((gradient[0, 0], shear, 0, shear, gradient[1, 1], 0, 0, 0, 0), dims=(3, 3))


def LogStrain(gradient):
    """Hencky's strain ln(F^T F)/2 (3, 3) of a displacement gradient, (3, 3) or in plane strain.

    The laws of small strains hold for it, with the elastic and the plastic part added up, where
    strains are large (C. Miehe, N. Apel, M. Lambrecht, Comput. Methods Appl. Mech. Engrg. 191
    (2002) 5383-5425). It is exact in plane strain; in 3D see `_LogStrain3D`.
    """
    F = Id(gradient.dims[0]) + gradient
    C = F.trans * F
    return _LogStrain2D(C) if gradient.dims[0] == 2 else _LogStrain3D(C)


def _LogStrain2D(C):
    mean, volume = Trace(C) / 2, Det(C)
    # The eigenvalues are mean (1 +- sqrt(q)), and atanh(sqrt(q))/sqrt(q) is smooth at 0.
    q = 1 - volume / mean**2
    root = sqrt(IfPos(q - 0.01, q, 0.01))
    far = log((1 + root) / (1 - root)) / (2 * root)
    near = 1 + q / 3 + q**2 / 5 + q**3 / 7 + q**4 / 9
    strain = log(volume) / 4 * Id(2) + IfPos(q - 0.01, far, near) / 2 * (C / mean - Id(2))
    entries = strain[0, 0], strain[0, 1], 0, strain[1, 0], strain[1, 1], 0, 0, 0, 0
    return CF(entries, dims=(3, 3))


def _LogStrain3D(C):
    """Without eigenvalues: ln(I + X) is the integral of X (I + t X)^-1 over t from 0 to 1.

    By Gauss' rule with five points for the deviator: to 1e-8 for principal strains up to 0.3, and
    1e-5 up to 0.5. The trace is exact.
    """
    X = C / (Trace(C) / 3) - Id(3)
    strain = 0 * X
    for t, weight in zip(*np.polynomial.legendre.leggauss(5), strict=True):
        strain = strain + weight / 4 * X * Inv(Id(3) + (1 + t) / 2 * X)
    return strain + (log(Det(C)) / 2 - Trace(strain)) / 3 * Id(3)


class J2Plasticity:
    """Von Mises plasticity with isotropic hardening at small strains.

    The yield stress is ``yield_stress + hardening * a`` with the accumulated plastic strain a. A
    step is implicit in time: radial return. Written as a minimisation over the plastic increment
    (Ortiz, Stainier 1999) it has the energy density `Energy`; its first variation is the stress at
    the end of the step, the second one the consistent tangent, both by NGSolve's ``Variation``.

    The state (plastic strain and a) lives on the quadrature points and changes in `Commit` only: a
    step that fails leaves nothing behind.

    Stresses are in one unit, ``yield_stress`` is that in tension. The quadrature rules `rules`, by
    which to integrate the energy, are exact for polynomials of twice the `order`: 1 suits
    displacements of order 2 on triangles. `accumulated` is the committed a, a GridFunction.

    Examples
    --------
    >>> material = J2Plasticity(mesh, young=70e3, poisson=0.3, yield_stress=35.0)
    >>> a += Variation(material.Energy(PlaneStrain(Grad(u))) * dx(intrules=material.rules))
    >>> steps = LoadStepper(solver, load).Integrate(callback=lambda step: material.Commit(strain))
    """

    def __init__(self, mesh, *, young, poisson, yield_stress, hardening=0, order=1):
        if not (young > 0 and -1 < poisson < 0.5 and yield_stress > 0):
            raise ValueError(
                f"young = {young} and yield_stress = {yield_stress} must be positive, "
                f"poisson = {poisson} between -1 and 0.5"
            )
        if hardening < 0:
            raise ValueError("hardening must not be negative")
        self.shear, self.bulk = young / (2 * (1 + poisson)), young / (3 * (1 - 2 * poisson))
        self.yield_stress, self.hardening = yield_stress, hardening
        self.points = points = IntegrationRuleSpace(mesh, order=order)
        self.rules = points.GetIntegrationRules()
        self._entries = _ENTRIES[:4] if mesh.dim == 2 else _ENTRIES
        self.state = GridFunction(points ** (len(self._entries) + 1))
        self._next = GridFunction(self.state.space)
        self.accumulated = self.state.components[-1]

    @property
    def plastic(self):
        """The committed plastic strain (3, 3)."""
        values = dict(zip(self._entries, self.state.components, strict=False))
        return CF(
            tuple(values.get((min(i, j), max(i, j)), 0) for i in range(3) for j in range(3)),
            dims=(3, 3),
        )

    def _Trial(self, strain):
        """Deviatoric trial strain and the length of the trial stress, without a kink at zero."""
        elastic = strain - Trace(strain) / 3 * Id(3) - self.plastic
        tiny = 1e-9 * self.yield_stress / (2 * self.shear)
        return elastic, sqrt(InnerProduct(elastic, elastic) + tiny**2)

    def _Increment(self, length):
        """Increment of a from the length of the deviatoric trial strain."""
        # 3 G b + Y(a + b) = sqrt(3/2) 2 G length, where that is more than Y(a).
        now = self.yield_stress + self.hardening * self.accumulated
        excess = math.sqrt(6) * self.shear * length - now
        return IfPos(excess, excess / (3 * self.shear + self.hardening), 0)

    def Energy(self, strain):
        """Incremental energy density of a strain (3, 3), from the committed state on.

        Stored energy at the end of the step plus what the step dissipates and hardens.
        """
        _, length = self._Trial(strain)
        b = self._Increment(length)
        a = self.accumulated
        elastic = length - math.sqrt(1.5) * b
        energy = self.bulk / 2 * Trace(strain) ** 2 + self.shear * elastic**2
        energy += (self.yield_stress + self.hardening * (a + b / 2)) * b
        return energy.Compile()

    def Stress(self, strain):
        """Stress (3, 3) at the end of a step from the committed state."""
        elastic, length = self._Trial(strain)
        share = 1 - math.sqrt(1.5) * self._Increment(length) / length
        return self.bulk * Trace(strain) * Id(3) + 2 * self.shear * share * elastic

    def Mises(self, strain):
        """Von Mises stress at the end of a step from the committed state."""
        _, length = self._Trial(strain)
        stress = math.sqrt(6) * self.shear * (length - math.sqrt(1.5) * self._Increment(length))
        return stress

    def Smoothed(self):
        """The accumulated plastic strain as continuous function, by least squares."""
        space = H1(self.points.mesh, order=1)
        (u, v), rule = space.TnT(), dx(intrules=self.rules)
        mass = BilinearForm(u * v * rule).Assemble().mat
        load, smooth = LinearForm(self.accumulated * v * rule).Assemble(), GridFunction(space)
        smooth.vec.data = mass.Inverse() * load.vec
        return smooth

    def Integral(self, function):
        """Integral over the mesh by the quadrature rules of the state."""
        mesh = self.state.space.mesh
        return float(NGSolveIntegrate(function * dx(intrules=self.rules), mesh))

    def Commit(self, strain):
        """Accept a converged strain (3, 3), a function of the solution: update the state."""
        elastic, length = self._Trial(strain)
        b = self._Increment(length)
        flow = math.sqrt(1.5) * b / length * elastic
        plastic = self.plastic
        new = [plastic[i, j] + flow[i, j] for i, j in self._entries]
        self._next.Interpolate(CF((*new, self.accumulated + b)).Compile())
        self.state.vec.data = self._next.vec
