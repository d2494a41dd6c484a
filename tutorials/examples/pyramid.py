"""A square pyramid from an STL file is pressed into an elastic half-space, and cones beside it.

A quarter of a large block stands for the half-space. The pyramid is that of a hardness test, but
blunt, as the theory of half-spaces asks for. A cone with the angle beta between axis and flank
needs the force (2/pi) E* depth^2 tan(beta) (Sneddon 1965); the pyramid lies between the cone inside
of it and the one around it, and so does its force. Start it with::

    python tutorials/examples/pyramid.py --out results
"""

import math
import tempfile
from pathlib import Path

import numpy as np
from command import Main, Picture, Positive
from netgen.occ import Box, Glue, OCCGeometry, Z
from ngsolve import *

from ngslac import ContactSolver, LACContact, LACSpace, LoadStepper
from ngslac.materials import Stress
from ngslac.tools import Cone, FromSTL

YOUNG, POISSON, FLANK, SIZE = 1.0, 0.3, math.radians(85), 40.0
MODULUS = YOUNG / (1 - POISSON**2)
RADIUS = 1.0  # of the contact of the cone
DEPTH = RADIUS * math.pi / 2 / math.tan(FLANK)


def ConeForce(depth, angle):
    """On a half-space."""
    return 2 / math.pi * MODULUS * depth**2 * math.tan(angle)


def WritePyramid(file, height=1.0):
    """A pyramid upside down as text STL, its tip at 0, its flanks 85 degrees from the axis."""
    side = height * math.tan(FLANK)
    rim = [(side, side, height), (-side, side, height), (-side, -side, height),
           (side, -side, height)]  # fmt: skip
    facets = [((0, 0, 0), rim[(k + 1) % 4], rim[k]) for k in range(4)]
    facets += [(rim[0], rim[1], rim[2]), (rim[0], rim[2], rim[3])]
    lines = ["solid pyramid"]
    for facet in facets:
        lines += ["facet normal 0 0 0", "outer loop"]
        lines += ["vertex {:.12e} {:.12e} {:.12e}".format(*p) for p in facet]
        lines += ["endloop", "endfacet"]
    Path(file).write_text("\n".join([*lines, "endsolid pyramid", ""]))


def QuarterBlock(h):
    """Below z = 0, fine near the origin; "top", "x", "y" and "bottom"."""
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
    a = BilinearForm(X)
    a += InnerProduct(Stress(Sym(Grad(u)), YOUNG, POISSON), Sym(Grad(v))) * dx
    depth = Parameter(0)
    led = tool.Moved(shift=(0, 0, -depth))
    contact = LACContact(u, lam, obstacle=led, finite=True)
    LoadStepper(ContactSolver(a, GridFunction(X), contact), depth).Integrate(
        DEPTH, steps=2, printing=False
    )
    return contact


def Write(contacts, folder):
    with Picture(folder, "pyramid", 1, len(contacts), size=(9, 3)) as axes:
        for axis, (name, contact) in zip(axes, contacts.items(), strict=True):
            table = contact.Table()
            levels = np.linspace(-1e-6, 1, 13) * table["pressure"].max()
            drawn = axis.tricontourf(*table["x"][:, :2].T, table["pressure"], levels)
            axis.figure.colorbar(drawn, ax=axis, label="pressure")
            axis.set(title=name, aspect="equal", xlim=(0, 1.6), ylim=(0, 1.6))
    contacts["pyramid"].WriteVTU(folder / "pyramid_top")


def Run(h=0.25, out=None, quiet=True):
    """Press the tools in; returns their forces over that of the cone on a half-space."""
    mesh = QuarterBlock(h)
    with tempfile.TemporaryDirectory() as folder:
        WritePyramid(Path(folder) / "pyramid.stl")
        pyramid = FromSTL(Path(folder) / "pyramid.stl")
    around = math.atan(math.sqrt(2) * math.tan(FLANK))
    tools = {"cone inside": Cone((0, 0, 0), (0, 0, 1), FLANK), "pyramid": pyramid}
    tools["cone around"] = Cone((0, 0, 0), (0, 0, 1), around)
    contacts = {name: Press(mesh, tool) for name, tool in tools.items()}
    forces = [-4 * float(contact.Force()[2]) for contact in contacts.values()]
    inside, between, outside = np.array(forces) / ConeForce(DEPTH, FLANK)
    assert abs(inside - 1) < 0.05, inside
    assert inside < between < outside, (inside, between, outside)
    if out:
        Write(contacts, out)
    if not quiet:
        print(f"force of the cone over Sneddon's {inside:.4f}, of the cone around the pyramid")
        print(f"{outside / math.sqrt(2):.4f}; of the pyramid over that of the cone inside of it")
        print(f"{between / inside:.4f}")
    return {
        "cone_ratio": inside,
        "outer_cone_ratio": outside / math.sqrt(2),
        "pyramid_ratio": between / inside,
        "macros": int(contacts["pyramid"].space.nmacros),
    }


main = Main(Run, __doc__, h=(Positive, "edge length in the contact zone"))

if __name__ == "__main__":
    main()
