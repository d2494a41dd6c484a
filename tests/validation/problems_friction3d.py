"""Two blocks under a given pressure whose contact is sheared in any direction of the interface.

All outer boundaries are held at displacements that are linear in each block, hence the stress is
constant where the whole contact sticks, or slips with one friction coefficient.
"""

import numpy as np
from elasticity import Displacements
from elasticity3d import Field, Pair3D, Solid
from ngsolve import CF, x, y, z

from ngslac.meshes.blocks3d import TwoBlocks3D

OPEN, STICK, SLIP = 0, 1, 2
PRESSURE = 25.0
HELD = "top|bottom|(left|right|front|back)_(upper|lower)"
MESH = {"n_slave": (4, 3), "n_master": (3, 2), "layers": (1, 1), "perturb": 0.15}


class ShearedBlocks:
    """The upper block, which carries the multipliers, on the lower one; normal (0, 0, -1).

    Parameters
    ----------
    kinds : tuple of str
        Cells of the blocks.
    space : str
        Displacements, as "P2" or "P1bubble".
    **law
        Options of LACContact.
    """

    def __init__(self, kinds=("hex", "tet"), space="P2", **law):
        self.mesh = TwoBlocks3D(*kinds, **MESH)
        self.pair = Pair3D(Displacements(self.mesh, space, dirichlet=HELD), Solid(), **law)
        self.contact = self.pair.contact

    def Shear(self, direction, *, stress=0.0, slip=0.0):
        """Hold the blocks such that the traction along `direction` (x, y) would be `stress`.

        The upper block has moved by `slip` against that direction. Slip counts from the last
        call of `Commit`.
        """
        t = np.array([*direction, 0.0])
        tensor = np.diag([0.0, 0.0, -PRESSURE]) - stress * (np.outer(t, [0, 0, 1]))
        tensor -= stress * np.outer([0, 0, 1], t)
        linear = Field(Solid().Strain(tensor)) * (CF((x, y, z)) - CF((0.5, 0.5, 0.0)))
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

    @property
    def bound(self):
        """Friction times pressure of the macro-elements."""
        return self.table["friction"] * self.table["pressure"]

    def AssertCoulomb(self, tol=1e-10):
        """Every macro-element obeys the law; no tangential component of the normal is left."""
        size, slip = np.linalg.norm(self.tangential, axis=1), self.table["slip"][:, :2]
        sticks, slips = (self.table["status"] == k for k in (STICK, SLIP))
        scale = self.bound.max()
        assert np.all(size <= self.bound + tol * scale)
        assert np.abs(size - self.bound)[slips].max(initial=0.0) <= tol * scale
        displacement = PRESSURE / Solid().young  # of a block of height one
        assert np.abs(slip[sticks]).max(initial=0.0) <= tol * displacement
        work = (self.tangential * slip).sum(axis=1)[slips]
        opposite = -size[slips] * np.linalg.norm(slip[slips], axis=1)
        assert np.abs(work - opposite).max(initial=0.0) <= tol * np.abs(opposite).max(initial=1.0)
