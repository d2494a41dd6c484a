"""Is a converged state a solution? By numpy and NGSolve's own integrals: no form of contact used.

Normals are followed from points of the slave faces to the master faces by brute force; areas, mean
gaps, slips and the work of the tractions are sums over these points. With n cells along a face such
a sum errs by (1/n)**2 of what bends within a face, and by a part of 1/n at the end of the other
surface. That sets the tolerances: no result has been looked at.
"""

import numpy as np
from ngsolve import Det, Grad, GridFunction, Id, IntegrationRule
from stress_check import Require
from verify_side import CELLS, Side

GAP = {d: 1 / n**2 for d, n in CELLS.items()}  # relative to the size of the macro-element
WORK = {d: 0.25 / n for d, n in CELLS.items()}  # relative to the forces
ALGEBRA = 1e-4  # of the largest traction: the sums give nothing but the normals
COVERED = 0.2  # smallest part of a macro-element with a partner that tells its gap
ROUNDING = 1e-8  # forces that are none, relative to Young's modulus times the area


class Verifier:
    """Checks the states of a problem one after the other; call it at each converged step."""

    def __init__(self, problem):
        self.problem = problem
        self.sides = [Side(problem, k) for k in range(len(problem.pairs))]
        self.largest = ROUNDING**1.25 * max(problem.young.values())  # ALGEBRA of it is no traction
        area = sum(side.area.sum() for side in self.sides)
        self.forces = ROUNDING * max(problem.young.values()) * area
        if problem.twin:  # its slips count from the start
            for side in self.sides:
                side.contact.Update()
                side.last = side.Now()

    def __call__(self):
        states = [side.Now() for side in self.sides]
        self.largest = max(self.largest, *(np.abs(s.traction).max() for s in states))
        for side, state in zip(self.sides, states, strict=True):
            self._Conditions(side, state)
        self._Equilibrium(states)
        if self.problem.nonlinear:
            self._Orientation()
        for side, state in zip(self.sides, states, strict=True):
            side.last = state

    def _Conditions(self, side, state):
        known = state.covered > COVERED
        gap = state.gap / side.size
        tolerance = GAP[side.dim]
        if state.expected is not None:
            miss = np.linalg.norm(state.traction - state.expected, axis=1) / self.largest
            Require(miss[known].max(initial=0), WORK[side.dim], f"{side.name}: another traction")
            return
        if side.law.get("tied"):
            miss = np.linalg.norm(state.jump, axis=1) / side.size
            Require(miss[known].max(initial=0), tolerance, f"{side.name}: tied parts move apart")
            return
        pressure = state.pressure / self.largest
        shear = np.linalg.norm(state.shear, axis=1) / self.largest
        Require(-pressure[known].min(initial=0), ALGEBRA, f"{side.name}: tension")
        gap = gap / np.where(state.whole, tolerance, WORK[side.dim])
        Require(-gap[known].min(initial=0), 1, f"{side.name}: penetration")
        both = gap[known & (pressure > ALGEBRA)]
        Require(both.max(initial=0), 1, f"{side.name}: pressure across a gap")
        bound = state.friction * np.maximum(pressure, 0)
        # The mean normal errs where points are cut off at the end of the other surface, or of any
        # face of it where its normals count, too.
        exact = state.whole & state.even & (not side.finite)
        allowed = np.where(exact, ALGEBRA, WORK[side.dim])
        beyond = ((shear - bound) / allowed)[known]
        Require(beyond.max(initial=0), 1, f"{side.name}: too much friction")
        if side.last is not None:
            self._Friction(side, state, known & (bound > ALGEBRA))

    def _Friction(self, side, state, rubs):
        """Friction is at its bound and against the slip, or there is none.

        The path of what has closed in this step is not known.
        """
        last = side.last
        touched = (last.pressure > ALGEBRA * self.largest) & (last.covered > COVERED)
        rubs = rubs & touched & (np.abs(last.gap) < GAP[side.dim] * side.size)
        slip = np.linalg.norm(state.slip, axis=1)[rubs]
        bound = (state.friction * state.pressure)[rubs]
        against = np.sum(state.shear * state.slip, axis=1)[rubs] / bound
        allowed = GAP[side.dim] * side.size[rubs] + 0.02 * slip
        Require(
            ((slip + against) / allowed).max(initial=0), 1, f"{side.name}: slip within friction"
        )

    def _Equilibrium(self, states):
        """The residual of the bulk is the work of the tractions, for random displacements."""
        p = self.problem
        space, dim = p.X.components[0], p.mesh.dim
        residual = p.gf.vec.CreateVector()
        p.a.Apply(p.gf.vec, residual)
        free = np.array([bool(b) for b in space.FreeDofs()])
        bulk = residual.FV().NumPy()[: space.ndof] * free
        self.forces = max(self.forces, np.linalg.norm(bulk))
        surfaces = "|".join(s for pair in p.pairs for s in pair if isinstance(s, str))
        inner = np.array([not b for b in space.GetDofs(p.mesh.Boundaries(surfaces))])
        within = np.linalg.norm(bulk[inner]) / self.forces
        Require(within, p.rough, "equilibrium within the bodies")
        cut_off = sum(side.CutOff(s) for side, s in zip(self.sides, states, strict=True))
        test = GridFunction(space)
        random = np.random.default_rng(len(bulk))
        for _ in range(4):
            values = random.choice([-1.0, 1.0], len(bulk)) * free
            test.vec.FV().NumPy()[:] = values
            work = sum(side.Work(s, test) for side, s in zip(self.sides, states, strict=True))
            error = max(0, abs(values @ bulk - work) - cut_off)
            Require(error / self.forces, max(WORK[dim], p.rough), "work of the contact")

    def _Orientation(self):
        """det F > 0 at many points of each element."""
        mesh = self.problem.mesh
        F = Id(mesh.dim) + Grad(self.problem.gf.components[0])
        kinds = {element.type for element in mesh.Elements()}
        rules = {kind: IntegrationRule(kind, 6) for kind in kinds}
        points = mesh.MapToAllElements(rules, mesh.Materials(".*"))
        Require(-np.min(Det(F)(points)), 0, "an element is turned inside out")
