"""Press a square pyramid from an STL file, and two cones, into an elastic half-space.

A quarter of a large block stands for the half-space. The pyramid is like that of a hardness test,
but blunt, because the theory of half-spaces requires it. A cone with the angle beta from the axis
needs the force (2/pi) E* depth^2 tan(beta) (Sneddon 1965); the pyramid lies between two cones.
Start it with::

    python tutorials/examples/pyramid.py --out results
"""

import math
import tempfile
from pathlib import Path

from command import Main
from netgen.occ import Box, Glue, OCCGeometry, Z
from ngsolve import *
from pictures import Map, Show

from ngslac import *
from ngslac.materials import Stress
from ngslac.tools import Cone, FromSTL

YOUNG, POISSON, FLANK, SIZE = 1.0, 0.3, math.radians(85), 40.0
DEPTH = math.pi / 2 / math.tan(FLANK)  # at which the contact of the cone has radius 1
FORCE = 2 / math.pi * YOUNG / (1 - POISSON**2) * DEPTH**2 * math.tan(FLANK)  # Sneddon


def Pyramid():
    """A pyramid from a text STL, upside down: its tip is at 0, its flanks 85 degrees off axis."""
    side = math.tan(FLANK)
    a, b, c, d = rim = [(side, side, 1), (-side, side, 1), (-side, -side, 1), (side, -side, 1)]
    facets = [((0, 0, 0), rim[(k + 1) % 4], rim[k]) for k in range(4)] + [(a, b, c), (a, c, d)]
    text = "solid pyramid\n"
    for facet in facets:
        corners = "".join("vertex {:.12e} {:.12e} {:.12e}\n".format(*corner) for corner in facet)
        text += f"facet normal 0 0 0\nouter loop\n{corners}endloop\nendfacet\n"
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "pyramid.stl"
        file.write_text(f"{text}endsolid pyramid\n")
        return FromSTL(file)


def QuarterBlock(h):
    """A quarter of a block below z = 0, fine near the origin; sides "top", "x", "y", "bottom"."""
    zone = Box((0, 0, -1.2), (1.7, 1.7, 0))
    zone.maxh = h
    block = Glue([zone, Box((0, 0, -SIZE), (SIZE, SIZE, 0)) - zone])
    for face in block.faces:
        at = face.center
        face.name = "x" if at.x < 1e-9 else "y" if at.y < 1e-9 else "side"
    block.faces.Min(Z).name, block.faces.Nearest((0.5, 0.5, 0)).name = "bottom", "top"
    return Mesh(OCCGeometry(block).GenerateMesh(maxh=SIZE / 4, grading=0.4))


def Press(mesh, tool):
    """The contact with the tool at its full depth."""
    V = VectorH1(mesh, order=2, dirichletx="x", dirichlety="y", dirichlet="bottom")
    X = V * LACSpace(V, slave="top")
    (u, lam), (v, _) = X.TnT()
    a, depth = BilinearForm(X), Parameter(0)
    a += InnerProduct(Stress(Sym(Grad(u)), YOUNG, POISSON), Sym(Grad(v))) * dx
    contact = LACContact(u, lam, obstacle=tool.Moved(shift=(0, 0, -depth)), finite=True)
    solver = ContactSolver(a, GridFunction(X), contact)
    LoadStepper(solver, depth).Integrate(DEPTH, steps=2, printing=False)
    return contact


def Run(h=0.25, out=None):
    """Press the tools in, and divide their forces by that of the cone on a half-space.

    h : edge length in the contact zone
    """
    mesh, flat = QuarterBlock(h), math.atan(math.sqrt(2) * math.tan(FLANK))
    inner, outer = (Cone((0, 0, 0), (0, 0, 1), angle) for angle in (FLANK, flat))
    tools = {"cone inside": inner, "pyramid": Pyramid(), "cone around": outer}
    contacts = {name: Press(mesh, tool) for name, tool in tools.items()}
    forces = [-4 * contact.Force()[2] / FORCE for contact in contacts.values()]
    inside, pyramid, around = forces[0], forces[1] / forces[0], forces[2] / math.sqrt(2)
    print(f"force over Sneddon's of the cone inside of the pyramid {inside:.4f}, of that around it")
    print(f"{around:.4f}; of the pyramid over that of the cone inside of it {pyramid:.4f}")
    assert abs(inside - 1) < 0.05
    assert forces == sorted(forces)

    panels, window = [], {"xlim": (0, 1.6), "ylim": (0, 1.6)}
    for name, contact in contacts.items():
        at, pressure = contact.Table()["x"][:, :2], contact.Table()["pressure"]
        panels.append(Map(at, pressure, f"pressure, {name}", **window))
    Show(out, "pyramid", None, *panels, top=contacts["pyramid"])
    return {"cone_ratio": inside, "outer_cone_ratio": around, "pyramid_ratio": pyramid}


main = Main(Run)
