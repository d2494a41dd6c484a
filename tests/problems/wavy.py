"""An elastic block on a rigid wavy surface: Westergaard's contact, exact for deep blocks."""

from math import asin, pi, sin, sqrt

import ngsolve
import numpy as np
from netgen.occ import OCCGeometry, Rectangle, X, Y
from ngsolve import (
    CF,
    Mesh,
    Sym,
    VectorH1,
    ds,
    x,
)
from posed import posed, stressed

from ngslac.materials import Stress

YOUNG, NU = 1.0, 0.3
FULL = 1e-3  # mean pressure that closes all of the wave
AMPLITUDE = FULL * (1 - NU**2) / (pi * YOUNG)


class Wavy:
    """Half a wave of length 1. The slave is the upper side; the bottom carries the mean pressure.

    It is `share` of the pressure that closes the whole wave.
    """

    def __init__(self, share=0.4):
        self.traction = CF((0, share * FULL))
        self.tractions = {"bottom": self.traction}
        self.half_width = asin(sqrt(share)) / pi

    @property
    def area(self):
        """Squared integral of the exact pressure over that of its square."""
        t = (np.arange(20000) + 0.5) / 20000 * pi / 2
        psi = pi * self.half_width * np.sin(t)
        square = np.maximum(sin(pi * self.half_width) ** 2 - np.sin(psi) ** 2, 0)
        pressure, weight = np.cos(psi) * np.sqrt(square), self.half_width * np.cos(t)
        return (pressure @ weight) ** 2 / (pressure**2 @ weight) * (pi / 2 / 20000)

    @staticmethod
    def Mesh(maxh=0.25):
        box = Rectangle(0.5, 1).Face()
        for side, name in ((box.edges.Min(X), "left"), (box.edges.Max(X), "right")):
            side.name = name
        box.edges.Min(Y).name, box.edges.Max(Y).name = "bottom", "top"
        return Mesh(OCCGeometry(box, dim=2).GenerateMesh(maxh=maxh))

    @staticmethod
    def stress(H):
        return Stress(Sym(H), YOUNG, NU)

    def __call__(self, mesh):
        V = VectorH1(mesh, order=2, dirichletx="left|right")
        wave = AMPLITUDE * (1 - ngsolve.cos(2 * pi * x))
        return posed(
            V,
            stressed(self.stress),
            lambda u, v, load: -self.traction * v * ds("bottom"),
            slave="top",
            obstacle=wave,
        ).solver()
