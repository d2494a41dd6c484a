"""Measure twisting blocks: balances of forces, moments and work, torques, symmetry."""

from __future__ import annotations

import math

import numpy as np
from ironing import Quadratic
from ngsolve import CF, GridFunction, x, y, z
from report_bounds import Tolerance
from report_case import Case, Outcome, Row
from report_pictures import ORANGE, Figure
from twistblocks import MEAN_DISTANCE, Problem, Torque, Turn

TURN = 22.5  # degrees of a step
HALF = math.radians(TURN / 2)
# Distance of the middles of four faces from the axis, over the mean distance in the whole square.
MIDDLES = 0.25 * math.sqrt(2) / MEAN_DISTANCE


def TangentialTorque(table):
    """Torque of the tangential tractions alone, taken at the middles of the macro-elements.

    The face of the slave is not quite parallel to the plane in each macro-element, and the pressure
    acts along its normal. The difference from the whole torque vanishes with the mesh size.
    """
    traction, normal = table["traction"], table["normal"]
    tangential = traction - np.sum(traction * normal, axis=1)[:, None] * normal
    return float(table["area"] @ np.cross(table["x"], tangential)[:, 2])


def SymmetryError(table, reference, n):
    """Largest change of the pressures under a quarter turn, relative to the largest pressure."""
    number = np.lexsort((reference[:, 0].round(9), reference[:, 1].round(9)))
    pressure = table["pressure"][number].reshape(n, n)
    return float(np.abs(pressure - np.rot90(pressure)).max() / np.abs(pressure).max())


class Measured:
    """The turned blocks, and numbers that are measured after each step.

    The upper block has n x n faces and turns in `steps`; other arguments are those of the example.
    """

    def __init__(self, steps, n, *, angle, rigid=False, friction=0.3):
        self.stepper, self.contact = Problem(n, friction=friction, angle=angle, rigid=rigid)
        self.n, self.held = n, "lower_.*" if rigid else "lower_bottom"
        self.solver, self.friction = self.stepper.solver, friction
        self.displacement = self.solver.gf.components[0]
        self.contact.Update()
        self.reference = self.contact.Table()["x"].copy()
        self.place = GridFunction(self.displacement.space)
        self.place.Set(CF((x, y, z)))
        self.rows, self.table = [], None
        turned = Turn(self.stepper, self.contact, steps, friction, angle, self._Measure)
        self.figures = self._Figures(turned, np.radians(angle / steps))

    def _Measure(self, _):
        contact, history = self.contact, self.solver.history
        self.table = table = contact.Table()
        torque = contact.Moment((0, 0, 0))[2]
        self.rows.append(
            {
                "quadratic": Quadratic([max(h.equilibrium, h.constraint) for h in history]),
                "balance": self._Balance(),
                "symmetry_error": SymmetryError(table, self.reference, self.n),
                "sideways": float(np.abs(contact.Force()[:2]).max()),
                "tangential_share": TangentialTorque(table) / torque,
                # Work of friction in this step, N mm.
                "dissipated": -float(table["area"] @ np.sum(table["traction"] * table["slip"], 1)),
            }
        )

    def _Balance(self):
        """Errors of the balances: forces and moments on the upper block, and on both."""
        (top, turn), (bottom, back) = self._Reaction("upper_top"), self._Reaction(self.held)
        force, torque = self.contact.Force(), self.contact.Moment((0, 0, 0))[2]
        size, moment = np.linalg.norm(force), max(abs(torque), 1e-12)
        return {
            "force_upper": float(np.linalg.norm(top + force) / size),
            "force_both": float(np.linalg.norm(top + bottom) / size),
            "torque_upper": abs(turn + torque) / moment,
            "torque_both": abs(turn + back) / moment,
        }

    def _Reaction(self, boundary):
        """Force and moment about the z axis that hold a boundary, from the whole residual."""
        solver, V = self.solver, self.place.space
        residual = solver.gf.vec.CreateVector()
        solver.a.Apply(solver.gf.vec, residual)
        self.contact.AddApply(solver.gf.vec, residual)
        held = np.array(list(V.GetDofs(V.mesh.Boundaries(boundary))), dtype=bool)
        values = np.where(held, residual.FV().NumPy()[: V.ndof], 0.0)
        current = self.place.vec.FV().NumPy() + self.displacement.vec.FV().NumPy()
        parts = [slice(r.start, r.stop) for r in (V.Range(k) for k in range(3))]
        vertices = V.mesh.nv  # their functions add up to 1
        force = np.array([values[p][:vertices].sum() for p in parts])
        right, back = parts[0], parts[1]
        return force, float(current[right] @ values[back] - current[back] @ values[right])

    def _Figures(self, example, step):
        """Figures of the example and of the measurements; each step turns by the angle `step`."""
        turned = self.rows[2:]
        figures = {name: values[2:] for name, values in example.items()}
        figures |= {name: [row[name] for row in turned] for name in turned[0]}
        balances = figures["balance"]
        work = -TangentialTorque(self.table) * step
        return figures | {
            "iterations": example["iterations"],
            "cuts": sum(example["cuts"]),
            "quadratic_steps": sum(row["quadratic"] for row in self.rows),
            "balance": {name: max(b[name] for b in balances) for name in balances[0]},
            "symmetry_error": max(figures["symmetry_error"]),
            "sideways": max(figures["sideways"]),
            # Work of friction over work of the tangential torque, from the values at the end of the
            # last step. In steady slip by an angle h, tractions point along the chord of the path,
            # which is h/2 from the tangent, and the ratio is tan(h/2) / (h/2).
            "dissipation_ratio": figures["dissipated"][-1] / work,
        }


def Twist(quick):
    count = 2 if quick else 4
    rigid = Measured(count, 2, angle=count * TURN, rigid=True)
    elastic = rigid if quick else Measured(8, 4, angle=120.0)
    steady, full = rigid.figures, elastic.figures
    torque, punch = (steady[name] for name in ("torque", "punch_ratio"))
    text = "rigid plane, 4 faces: steady torque over that of a flat punch"
    work = "rigid plane: work of friction over that of the tangential torque"
    rows = [
        Row(text, punch[-1], MIDDLES),
        Row(work, steady["dissipation_ratio"], math.tan(HALF) / HALF),
    ]
    if not quick:
        change = abs(torque[-1] / torque[-2] - 1)
        rows.append(Row("rigid plane: change of the torque in the last step", change, 0))
        text = "two blocks, 16 faces: torque over that of a flat punch"
        rows.append(Row(text, full["punch_ratio"][-1], 1))
    for name, value in full["balance"].items():
        text = f"balance of {name.replace('_', ', ')}: error over its size"
        rows.append(Row(text, value, 0, None if name == "torque_both" else Tolerance()))
    rows.append(Row("symmetry of the pressures", full["symmetry_error"], 0, Tolerance()))
    caption = "Pressures and tractions at the end from above, and the torque over the angle."

    def Draw(left, right):
        table = elastic.table
        points = left.scatter(*table["x"][:, :2].T, c=table["pressure"], s=60)
        left.figure.colorbar(points, ax=left, label="pressure [MPa]")
        left.quiver(*table["x"][:, :2].T, *table["traction"][:, :2].T, color=ORANGE)
        left.set_aspect("equal")
        Torque(full, elastic.friction)(right)

    return Outcome(rows, Figure(Draw, columns=2), caption)


CASES = [
    Case(
        "twisting-blocks",
        "Twisting blocks",
        "A soft block is pressed on another one and turned: it twists, then slides with friction "
        "0.3 and turns as a whole. Under a uniform pressure the torque of a flat square punch is "
        "0.3826 times friction, force and width; faces that count by their middles alone have "
        "0.924 of it if there are four. Forces and moments balance; the tractions act on both "
        "sides of a gap that vanishes on average, hence the error of the last moment.",
        "The torque of a flat punch; balances of forces, moments and work "
        "(`tests/validation/test_twistblocks.py`).",
        "python tutorials/examples/twistblocks.py --n 4 --steps 8 --angle 120 --out results",
        Twist,
    ),
]
