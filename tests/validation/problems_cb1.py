"""NAFEMS contact benchmark 1 (Konter) with large displacements (code_aster SSNP154).

A steel cylinder of diameter 100 mm on an aluminium block of side 200 mm under 35 kN/mm, of which
half is computed. Hooke's law of Green's strain (GROT_GDEP), dead load at the top of the cylinder.
"""

from ngsolve import VectorH1
from problems_large import Model, SaintVenant

from ngslac.meshes import HertzMesh

YOUNG = {"cylinder": 210e3, "block": 70e3}  # MPa
FORCE = 17.5e3  # N/mm, half of it
PUBLISHED = {0.0: (-1.30690, -1.30802), 0.1: (-1.30108, -1.30264)}  # linear, quadratic elements


def CylinderModel(h, *, friction=None, energy=SaintVenant, finite=True, order=2):
    """The discrete problem; the load 1 is the full force."""
    mesh = HertzMesh(h, order=max(2, order))
    V = VectorH1(mesh, order=order, dirichletx="bottom|sym", dirichlety="bottom")
    return Model(V, energy, YOUNG, friction=friction, finite=finite, forces={"load": (0.0, -FORCE)})
