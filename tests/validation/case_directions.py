"""Coulomb's cone is round: two blocks under a pressure, sheared in any direction of the interface.

All outer boundaries are held at displacements that are linear in each block, hence the stress is
constant where the whole contact sticks, or slips with one friction coefficient.
"""

from __future__ import annotations

import numpy as np
from elasticity import Displacements, Field, Material, Pair
from ngsolve import CF, x, y, z
from report_bounds import Tolerance
from report_case import Case, Outcome, Row
from report_pictures import INK, ORANGE, Figure

from ngslac.meshes.blocks3d import TwoBlocks3D

OPEN, STICK, SLIP = 0, 1, 2
PRESSURE, FRICTION = 25.0, 0.3
ANGLES = np.radians([0, 17, 90, 133.7, 180, 251, 300, 359])
HELD = "top|bottom|(left|right|front|back)_(upper|lower)"
MESH = {"n_slave": (4, 3), "n_master": (3, 2), "layers": (1, 1), "perturb": 0.15}


class ShearedBlocks:
    """The upper block, which carries the multipliers, on the lower one; normal (0, 0, -1).

    `kinds` are the cells of the blocks, `space` is as for `Displacements`, `law` of LACContact.
    """

    def __init__(self, kinds=("hex", "tet"), space="P2", **law):
        self.mesh = TwoBlocks3D(*kinds, **MESH)
        self.pair = Pair(Displacements(self.mesh, space, dirichlet=HELD), Material(), **law)
        self.contact = self.pair.contact

    def Shear(self, direction, *, stress=0.0, slip=0.0):
        """Hold the blocks such that the traction along `direction` (x, y) would be `stress`.

        The upper block has moved by `slip` against that direction. Slip counts from the last
        call of `Commit`.
        """
        t = np.array([*direction, 0.0])
        tensor = np.diag([0.0, 0.0, -PRESSURE]) - stress * (np.outer(t, [0, 0, 1]))
        tensor -= stress * np.outer([0, 0, 1], t)
        linear = Field(Material().Strain(tensor)) * (CF((x, y, z)) - CF((0.5, 0.5, 0.0)))
        moved = linear - slip * CF(tuple(t))
        upper = self.mesh.BoundaryCF({"top|.*_upper": moved}, default=linear)
        self.pair.Hold(upper, HELD)
        last = self.pair.Solve()
        self.table = self.contact.Table()
        return last

    def Commit(self):
        """Later slip counts from here."""
        self.contact.Commit(self.pair.gf)

    @property
    def tangential(self):
        """Tangential tractions (n, 2) on the slave side."""
        return self.table["traction"][:, :2]


def Direction(angle):
    return np.array([np.cos(angle), np.sin(angle)])


def Directions(quick):
    blocks, bound = ShearedBlocks(friction=FRICTION), FRICTION * PRESSURE
    angles, found, errors = ANGLES[:3] if quick else ANGLES, [], {"slip": [], "stick": []}
    for angle in angles:
        blocks.Shear(Direction(angle), stress=bound, slip=2e-3)
        found.append(blocks.tangential.copy())
        errors["slip"].append(np.abs(found[-1] - bound * Direction(angle)).max() / bound)
        blocks.Shear(Direction(angle), stress=0.999 * bound)
        off = blocks.tangential - 0.999 * bound * Direction(angle)
        errors["stick"].append(np.abs(off).max() / bound)
    text = f"largest error of the friction, {len(angles)} directions"
    rows = [Row(f"{name}: {text}", max(e), 0, Tolerance()) for name, e in errors.items()]

    def Draw(ax):
        circle = np.linspace(0, 2 * np.pi, 361)
        ax.plot(bound * np.cos(circle), bound * np.sin(circle), color=INK, lw=0.8, label="F p")
        points = np.concatenate(found)
        ax.plot(*points.T, "o", color=ORANGE, ms=5, label="macro-elements in slip")
        ax.set(aspect="equal", xlabel="friction along x", ylabel="friction along y")
        ax.legend(loc="center")

    return Outcome(rows, Figure(Draw, size=(4.2, 4)), "Friction of all macro-elements in slip.")


CASES = [
    Case(
        "directions",
        "Coulomb's cone is round",
        "Two blocks under a pressure of 25, sheared in eight directions of the interface, at the "
        "bound of friction and just below it, on a mesh of hexahedra and tetrahedra.",
        "Coulomb's law: friction 0.3 times the pressure along the shear.",
        "pytest tests/validation/test_directions.py",
        Directions,
    ),
]
