"""Half-planes of different materials under a growing normal load, with the coupling in full.

`exact_spence.SpenceLine` takes the pressure from the problem without friction (Goodman). Here
the friction acts back on the pressure, as in the finite element model. The equations are those of
an increment of the load: a flat punch on |t| < 1 with pressure p and friction q,

    (1/pi) pv int p(s)/(t - s) ds = beta q,                        |t| < 1,
    (1/pi) pv int q(s)/(t - s) ds + beta p = 0,                    |t| < k,  stick,
    q = F p sign(beta t),                                          k < |t| < 1,  slip,

see `StickZone` for their derivation without the term beta q. They are solved by Gauss-Chebyshev
quadrature; the stick ratio k is where |q| reaches F p.
"""

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True, kw_only=True)
class CoupledPunch:
    """Solution for coefficients `beta` > 0 and `friction`, by `n` (even) nodes.

    With ``coupled=False`` it is Goodman's approximation, to check the numerics.
    """

    beta: float
    friction: float
    n: int = 200
    coupled: bool = True

    @property
    def nodes(self):
        return np.cos((2 * np.arange(1, self.n + 1) - 1) * np.pi / (2 * self.n))

    def _Matrix(self, sticks):
        """Equations for the values P, Q at the nodes, p = P/sqrt(1 - t^2)."""
        n, t = self.n, self.nodes
        x = np.cos(np.arange(1, n) * np.pi / n)  # collocation points, between the nodes
        cauchy = 1 / (n * (x[:, None] - t))
        mean = 0.5 * (np.eye(n)[:-1] + np.eye(n)[1:]) / np.sqrt(1 - x**2)[:, None]
        zero, total = np.zeros((n - 1, n)), np.full((1, n), np.pi / n)
        slip = np.eye(n)[~sticks]
        held = sticks[:-1] & sticks[1:]
        return np.block(
            [
                [cauchy, -self.beta * mean if self.coupled else zero],
                [total, 0 * total],
                [-self.friction * np.sign(t) * slip, slip],
                [self.beta * mean[held], cauchy[held]],
                [0 * total, total],
            ]
        )

    def _Solve(self, count):
        """P and Q with `count` nodes in stick on each side."""
        middle = self.n // 2
        sticks = np.abs(np.arange(self.n) - middle + 0.5) < count
        load = np.zeros(2 * self.n)
        load[self.n - 1] = 1.0
        return np.split(np.linalg.solve(self._Matrix(sticks), load), 2)

    def _Excess(self, count):
        """|q|/(F p) at the outermost node in stick, on the branch that grows with k."""
        (P, Q), i = self._Solve(count), self.n // 2 - count
        return abs(Q[i]) / (self.friction * P[i])

    def Stick(self, guess):
        """Stick ratio near `guess` (an interpolation), and the nodes in stick on each side."""
        t, middle = self.nodes, self.n // 2
        start = round(np.arcsin(guess) * self.n / np.pi)
        counts = np.arange(start - self.n // 40, start + self.n // 40 + 1)
        excess = np.array([self._Excess(count) for count in counts])
        i = np.flatnonzero((excess[:-1] < 1) & (excess[1:] >= 1))[0]
        ends = t[middle - counts[i : i + 2]]
        share = (1 - excess[i]) / (excess[i + 1] - excess[i])
        return ends[0] + share * (ends[1] - ends[0]), counts[i]

    def HertzFriction(self, x, guess):
        """|tau|/(F p) at x/a for two cylinders: the sum of all punches from x to a."""
        P, Q = self._Solve(self.Stick(guess)[1])
        i = np.arange(self.n // 2)
        t = self.nodes[i]
        ratio = np.cumsum(np.abs(Q[i]) / t**2) / np.cumsum(P[i] / t**2) / self.friction
        ends = np.cos((i + 1) * np.pi / self.n)
        return np.interp(x, ends[::-1], ratio[::-1])


def StickRatio(beta, friction, guess, *, coupled=True):
    """Stick ratio, extrapolated from 100 and 200 nodes (the error falls like 1/n)."""
    coarse, fine = (
        CoupledPunch(beta=beta, friction=friction, n=n, coupled=coupled).Stick(guess)[0]
        for n in (100, 200)
    )
    return 2 * fine - coarse
