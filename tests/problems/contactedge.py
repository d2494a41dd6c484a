"""Two elastic bodies that touch along part of a line, with an exact solution."""

from math import sqrt

import ngsolve
from exact_signorini import ElasticSignorini
from ngsolve import (
    CF,
    Grad,
    InnerProduct,
    Integrate,
    Sym,
    VectorH1,
    dx,
    x,
    y,
)
from posed import posed, stressed

from ngslac.materials import Stress
from ngslac.meshes import TwoBlocks

SIDES = "top|bottom|left_upper|right_upper|left_lower|right_lower"
LOWER = {"bottom", "left_lower", "right_lower"}
BODIES = "upper", "lower"


def Exact(*, scale=1.0, nu=(0.3, 0.2)):
    """The exact solution; `scale` multiplies moduli and stresses."""
    moduli = {"young1": 3.0 * scale, "young2": 1.0 * scale}
    ratios = {"nu1": nu[0], "nu2": nu[1]}
    return ElasticSignorini(**moduli, **ratios, tip=4 / 3, strength=0.01 * scale)


def EdgeMesh(n, ratio=1.37):
    return TwoBlocks(2 / n, 2 / n / ratio, width=2, structured=True)


class Edge:
    """The contact between both blocks; makes the solver of a mesh, which it keeps."""

    def __init__(self, exact=None, *, order=2):
        self.exact, self.order = exact or Exact(), order

    def __call__(self, mesh):
        self.mesh, exact = mesh, self.exact
        self.young = mesh.MaterialCF({"upper": exact.young1, "lower": exact.young2})
        self.nu = mesh.MaterialCF({"upper": exact.nu1, "lower": exact.nu2})
        V = VectorH1(mesh, order=self.order, dirichlet=SIDES)
        problem = posed(V, stressed(self.stress))
        self.gf = gf = problem.gf
        both = self._Both(exact.Displacement)
        held = {side: both[BODIES[side in LOWER]] for side in SIDES.split("|")}
        gf.components[0].Set(mesh.BoundaryCF(held), definedon=mesh.Boundaries(SIDES))
        return problem.solver()

    @staticmethod
    def _Both(field):
        pairs = enumerate(BODIES, 1)
        return {name: CF(field(x, y, body=b, sqrt=ngsolve.sqrt)) for b, name in pairs}

    def stress(self, H):
        return Stress(Sym(H), self.young, self.nu)

    def Error(self):
        """In the energy norm."""
        s = self.mesh.MaterialCF(self._Both(self.exact.Stress))
        t = self.stress(Grad(self.gf.components[0])) - CF((s[0], s[2], s[2], s[1]), dims=(2, 2))
        trace = t[0, 0] + t[1, 1]
        energy = (1 + self.nu) / self.young * (InnerProduct(t, t) - self.nu * trace * trace)
        return sqrt(Integrate(energy * dx(bonus_intorder=8), self.mesh))
