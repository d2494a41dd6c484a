"""Two blocks, the upper one pressed on the lower one and turned: mesh, material, states."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np
from netgen.meshing import Mesh as NetgenMesh
from ngsolve import (
    CF,
    BilinearForm,
    Grad,
    GridFunction,
    Id,
    IfPos,
    Integrate,
    Mesh,
    Parameter,
    Variation,
    VectorH1,
    cos,
    dx,
    sin,
    x,
    y,
    z,
)

from ngslac import ContactSolver, LACContact, LACSpace, LoadStepper
from ngslac.materials import NeoHooke
from ngslac.meshes.boxes import AddBody, StructuredBox
from ngslac.meshes.geometry3d import CheckNonMatching3D

__all__ = ["DEPTH", "HEIGHT", "Model", "State", "TwistMesh"]

WIDTH, HEIGHT = 1.0, 1.5  # of the upper block, in mm
LOWER_WIDTH, LOWER_HEIGHT = 1.6, 0.4
DEPTH = 0.15  # by which the top goes down, in mm
YOUNG, POISSON = {"upper": 10.0, "lower": 200.0}, 0.3  # MPa


def TwistMesh(n=3):
    """Mesh of the upper block, with n x n faces below, on the wider lower one; hexahedra.

    Both are centred at the z axis and touch at z = 0. Materials "upper" and "lower", boundaries
    "slave", "master", "top", "bottom", "side" and "side_lower".

    Parameters
    ----------
    n : int
        Faces of the upper block in each direction. The lower block has at least one less.

    Returns
    -------
    ngsolve.Mesh
        `CheckNonMatching3D` has passed.

    Raises
    ------
    ValueError
        For n less than 2.
    """
    if n < 2:
        raise ValueError(f"n = {n} must be at least 2")
    mesh = NetgenMesh(dim=3)
    for name, width, faces, heights, names in (
        ("upper", WIDTH, n, (0, HEIGHT), {"bottom": "slave", "top": "top"}),
        ("lower", LOWER_WIDTH, n - 1, (-LOWER_HEIGHT, 0), {"top": "master", "bottom": "bottom"}),
    ):
        side = "side" if name == "upper" else "side_lower"
        grid = width * np.linspace(-0.5, 0.5, faces + 1)
        layers = max(1, round(0.5 * faces)) if name == "upper" else 1
        box = StructuredBox(
            grid,
            grid,
            np.linspace(*heights, layers + 1),
            names=lambda which, _, names=names, side=side: names.get(which, side),
        )
        AddBody(mesh, name, box)
    mesh.Compress()
    mesh = Mesh(mesh)
    CheckNonMatching3D(mesh)
    return mesh


@dataclass(frozen=True)
class State:
    """A converged step. Forces in N, moments about the z axis in N mm."""

    angle: float  # of the top, in degrees
    iterations: int
    cuts: int
    residuals: tuple  # of the iterations: the larger one of equilibrium and constraint
    force: np.ndarray  # of the contact on the upper block
    torque: float
    top: tuple  # reaction at the top: force (3,), moment
    bottom: tuple
    energy: float  # strain energy, N mm
    dissipated: float  # by friction in this step, N mm
    table: dict  # of the contact
    vector: object = field(repr=False)  # of the solution


class Model:
    """The discrete problem and its states.

    Parameters
    ----------
    n, order, friction, angle :
        As in `twistblocks.Problem`.
    rigid : bool
        The lower block does not deform.
    """

    def __init__(self, *, n, order, friction, angle, rigid):
        self.mesh = mesh = TwistMesh(n)
        V = VectorH1(mesh, order=order, dirichlet="top|bottom")
        X = V * LACSpace(V, slave="slave")
        u, lam = X.TrialFunction()
        self.young = mesh.MaterialCF(YOUNG)
        self.a = BilinearForm(X)
        bodies = mesh.Materials("upper") if rigid else mesh.Materials(".*")
        self.a += Variation(
            NeoHooke(Id(3) + Grad(u), self.young, POISSON).Compile() * dx(definedon=bodies)
        )
        self.bodies, self.solution = bodies, GridFunction(X)
        self.contact = LACContact(u, lam, master="master", friction=friction or None, finite=True)
        self.load, self.angle = Parameter(0.0), math.radians(angle)
        free = X.FreeDofs()
        if rigid:
            free = free & ~X.GetDofs(mesh.Materials("lower"))
        solver = ContactSolver(self.a, self.solution, self.contact, freedofs=free)
        self.stepper = LoadStepper(solver, self.load, prescribe={"top": self._Motion()})
        self.place = GridFunction(V)
        self.place.Set(CF((x, y, z)))
        self.contact.Update()
        self.reference = self.contact.Table()["x"].copy()
        self.states = []

    @property
    def displacement(self):
        return self.solution.components[0]

    def _Motion(self):
        """The top goes down until the time 1 and turns until the time 2."""
        t = self.load
        down, turned = IfPos(t - 1, 1, t), self.angle * IfPos(t - 1, t - 1, 0)
        c, s = cos(turned), sin(turned)
        return CF((c * x - s * y - x, s * x + c * y - y, -DEPTH * down))

    def Integrate(self, end, steps, callback=None, printing=False):
        """Go on to the time `end`, and record each step."""

        def Record(step):
            self.states.append(self._State(step))
            if callback:
                callback(self.states[-1])

        self.stepper.Integrate(end, steps=steps, callback=Record, printing=printing)

    def _State(self, step):
        contact, history = self.contact, self.stepper.solver.history
        table = contact.Table()
        work = table["area"] @ np.sum(table["traction"] * table["slip"], axis=1)
        u = self.displacement
        return State(
            angle=math.degrees(self.angle) * max(step.time - 1.0, 0.0),
            iterations=step.iterations,
            cuts=step.cuts,
            residuals=tuple(max(entry.equilibrium, entry.constraint) for entry in history),
            force=contact.Force(),
            torque=contact.Moment((0, 0, 0))[2],
            top=self._Reaction("top"),
            bottom=self._Reaction("master|bottom|side_lower" if self.Rigid() else "bottom"),
            energy=Integrate(
                NeoHooke(Id(3) + Grad(u), self.young, POISSON), self.mesh, definedon=self.bodies
            ),
            dissipated=-work,
            table=table | {"reference": self.reference},
            vector=self.solution.vec.CreateVector(copy=True),
        )

    def Rigid(self):
        """Is the lower block rigid?"""
        return not self.bodies.Mask()[list(self.mesh.GetMaterials()).index("lower")]

    def _Reaction(self, boundary):
        """Force and moment about the z axis that hold a boundary, from the whole residual."""
        residual = self.solution.vec.CreateVector()
        self.a.Apply(self.solution.vec, residual)
        self.contact.AddApply(self.solution.vec, residual)
        V = self.displacement.space
        held = np.array(list(V.GetDofs(self.mesh.Boundaries(boundary))), dtype=bool)
        values = np.where(held, residual.FV().NumPy()[: V.ndof], 0.0)
        current = self.place.vec.FV().NumPy() + self.displacement.vec.FV().NumPy()
        parts = [slice(r.start, r.stop) for r in (V.Range(k) for k in range(3))]
        vertices = self.mesh.nv  # their functions add up to 1
        force = np.array([values[p][:vertices].sum() for p in parts])
        right, back = parts[0], parts[1]
        return force, float(current[right] @ values[back] - current[back] @ values[right])
