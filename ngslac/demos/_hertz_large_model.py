"""A rubber cylinder between rigid plates, a quarter of it: mesh, model, states."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np
from netgen.occ import ArcOfCircle, Pnt, Segment
from ngsolve import (
    CF,
    BilinearForm,
    Grad,
    GridFunction,
    Id,
    Integrate,
    Parameter,
    Variation,
    VectorH1,
    dx,
)

from ngslac import ContactSolver, LACContact, LACSpace, LoadStepper
from ngslac.materials import NeoHooke
from ngslac.meshes.geometry import (
    Body,
    CheckPositive,
    Divisions,
    GenerateMesh,
    NonMatchingDivisions,
    Side,
)

__all__ = ["RADIUS", "Approach", "CylinderMesh", "Model", "State"]

RADIUS = 1.0  # mm
_ANGLE = 70.0  # degrees of the arc that may touch
_LENGTH, _THICKNESS = 1.25, 0.15  # of the plate


def CylinderMesh(h=0.05, *, ratio=1.3, grading=0.25, order=3):
    """Mesh of a quarter of a disc of radius 1 that touches a plate at the origin; triangles.

    Materials "cylinder" (x >= 0, 0 <= y <= 1) and "plate" below it. Boundaries: "slave" (the arc
    where contact can be), "free" (the rest of it), "sym" (x = 0), "middle" (y = 1), "master" (the
    top of the plate) and "back" (the rest of the plate).

    Parameters
    ----------
    h : float
        Edge length on the slave side.
    ratio : float
        Edge length of the plate over that.
    grading : float
        Growth of the element size into the cylinder.
    order : int
        Order of the curved geometry.

    Returns
    -------
    ngsolve.Mesh
        No node of the slave is above one of the master, but for the two at x = 0.
    """
    CheckPositive(h=h, ratio=ratio, grading=grading)
    reach = math.radians(_ANGLE)
    arc = Divisions(reach * RADIUS, h)
    nodes = RADIUS * np.sin(np.linspace(0, reach, arc + 1))
    count = NonMatchingDivisions(nodes, 0.0, _LENGTH, ratio * h)

    def Point(angle):
        return Pnt(RADIUS * math.sin(angle), RADIUS * (1 - math.cos(angle)), 0)

    centre, bottom, side = Pnt(0, RADIUS, 0), Point(0), Point(math.pi / 2)
    middle = (reach + math.pi / 2) / 2
    cylinder = Body(
        [
            Side(ArcOfCircle(bottom, Point(reach / 2), Point(reach)), "slave", arc),
            Side(ArcOfCircle(Point(reach), Point(middle), side), "free"),
            Side(Segment(side, centre), "middle"),
            Side(Segment(centre, bottom), "sym"),
        ],
        "cylinder",
    )
    return GenerateMesh([cylinder, _Plate(count)], order=order, maxh=0.25, grading=grading)


def _Plate(count):
    corners = [(0, -_THICKNESS), (_LENGTH, -_THICKNESS), (_LENGTH, 0), (0, 0)]
    points = [Pnt(*corner, 0) for corner in corners]
    names = ["back", "back", "master", "back"]
    return Body(
        [
            Side(Segment(p, q), name, count if name == "master" else None)
            for p, q, name in zip(points, [*points[1:], points[0]], names, strict=True)
        ],
        "plate",
    )


def Approach(force, young, nu):
    """Hertz' approach of the middle of a cylinder between two rigid plates, at small strains.

    ``P (1 - nu^2) / (pi E) (2 log(4 R / a) - 1)`` with the half width ``a^2 = 4 P R (1 - nu^2) /
    (pi E)`` (K. L. Johnson, Contact Mechanics, 1985, section 5.6).

    Parameters
    ----------
    force : float or array
        Per length of the whole cylinder, N/mm.
    young, nu : float
        Young's modulus in MPa and Poisson's ratio.

    Returns
    -------
    float or array
        Of the middle to a plate, in mm.

    Examples
    --------
    >>> round(float(Approach(0.01, 1.0, 0.5)), 6)
    0.015336
    """
    compliance = force * (1 - nu**2) / (math.pi * young)
    halfwidth = np.sqrt(4 * compliance * RADIUS)
    return compliance * (2 * np.log(4 * RADIUS / halfwidth) - 1)


@dataclass(frozen=True)
class State:
    """A converged step."""

    approach: float  # of the middle, in mm
    force: float  # per length of the whole cylinder, N/mm
    sideways: float  # of the half cylinder, without friction 0
    energy: float  # strain energy of the half that the plate sees (x of both signs), N mm/mm
    halfwidth: float  # of the contact, in mm: the position of the outer end of the last macro
    peak: float  # largest pressure per area of the reference, MPa
    iterations: int
    cuts: int
    residuals: tuple
    vector: object = field(repr=False)


class Model:
    """The discrete problem and its states.

    Parameters
    ----------
    h, order, young, nu, friction, depth :
        As in `hertz_large.Problem`.
    """

    def __init__(self, *, h, order, young, nu, friction, depth):
        self.mesh = mesh = CylinderMesh(h, order=order)
        V = VectorH1(
            mesh, order=order, dirichletx="sym|back|master", dirichlety="middle|back|master"
        )
        X = V * LACSpace(V, slave="slave")
        u, lam = X.TrialFunction()
        self.a, self.solution = BilinearForm(X), GridFunction(X)
        self.a += Variation(NeoHooke(Id(2) + Grad(u), young, nu).Compile() * dx("cylinder"))
        self.contact = LACContact(u, lam, master="master", friction=friction or None, finite=True)
        self.load = Parameter(0.0)
        free = X.FreeDofs() & ~X.GetDofs(mesh.Materials("plate"))
        solver = ContactSolver(self.a, self.solution, self.contact, freedofs=free)
        motion = {"middle": CF((0, -depth * self.load))}
        self.stepper = LoadStepper(solver, self.load, prescribe=motion)
        self.depth, self.states = depth, []
        self.stored = NeoHooke(Id(2) + Grad(self.displacement), young, nu)

    @property
    def displacement(self):
        return self.solution.components[0]

    def Integrate(self, end, steps, callback=None, printing=False):
        """Press on to the part `end` of the depth, and record each step."""

        def Record(step):
            self.states.append(self._State(step))
            if callback:
                callback(self.states[-1])

        self.stepper.Integrate(end, steps=steps, callback=Record, printing=printing)

    def _State(self, step):
        history = self.stepper.solver.history
        table = self.contact.Table()
        sideways, up = self.contact.Force()
        return State(
            approach=self.depth * step.time,
            force=2 * up,
            sideways=abs(sideways),
            energy=2 * Integrate(self.stored, self.mesh, definedon=self.mesh.Materials("cylinder")),
            halfwidth=self._HalfWidth(table),
            peak=float(table["pressure"].max()),
            iterations=step.iterations,
            cuts=step.cuts,
            residuals=tuple(max(entry.equilibrium, entry.constraint) for entry in history),
            vector=self.solution.vec.CreateVector(copy=True),
        )

    def _HalfWidth(self, table):
        """Where the contact ends: between the last closed and the first open macro-element."""
        x, closed = table["x"][:, 0], table["status"] > 0
        if not closed.any():
            return 0.0
        last = x[closed].max()
        beyond = x[~closed & (x > last)]
        return float(0.5 * (last + beyond.min())) if len(beyond) else float(last)
