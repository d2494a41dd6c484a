"""Input and result files of CalculiX for the problems of the comparison; NumPy only.

CalculiX has no plane contact: the 2D problem becomes one layer of wedges that is held in z.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from decks import Bodies, Rows
from meshes import HELD
from metrics import LINE_FORCE, NU, PRESSURE, YOUNG

__all__ = ["KINDS", "ReadContact", "ReadDisplacement", "Solid", "WriteInput"]

CONTACT_TYPES = {"penalty": "SURFACE TO SURFACE", "mortar": "MORTAR"}
KINDS = {(2, 1): "C3D6", (2, 2): "C3D15", (3, 1): "C3D4", (3, 2): "C3D10"}
# Number of the face opposite to each corner; in 2D those of the wedge that stands on the triangle.
FACES = {2: np.array([4, 5, 3]), 3: np.array([3, 4, 2, 1])}
THICKNESS = 1.0
PRESSURE_COLUMN = 3  # of the block CONTACT: gap, two slips, pressure, two shear stresses


@dataclass(frozen=True)
class Solid:
    """A `PeerMesh` of an order as CalculiX gets it; numbers from 0 (in the files from 1)."""

    mesh: object
    order: int

    @property
    def points(self):
        """Coordinates (n, 3), the upper body lowered."""
        points = self.mesh.Lowered(self.order)
        if self.mesh.dim == 3:
            return points
        layers = [(points, 0.0), (points, THICKNESS)]
        if self.order == 2:
            layers.append((points[: self.mesh.nvertices], THICKNESS / 2))
        return np.vstack([np.column_stack([p, np.full(len(p), z)]) for p, z in layers])

    @property
    def elements(self):
        """Nodes of the elements in CalculiX' order."""
        nodes, n = self.mesh.Elements(self.order), len(self.mesh.Points(self.order))
        if self.mesh.dim == 3:
            return nodes
        corners, mids = nodes[:, :3], nodes[:, 3:]
        wedge = [corners, corners + n, mids, mids + n]
        return np.hstack([*wedge, corners + 2 * n] if self.order == 2 else wedge)

    def Nodes(self, name):
        nodes = self.mesh.Nodes(self.order, name)
        if self.mesh.dim == 3:
            return nodes
        n = len(self.mesh.Points(self.order))
        upright = nodes[nodes < self.mesh.nvertices] + 2 * n
        return np.concatenate([nodes, nodes + n, upright if self.order == 2 else nodes[:0]])

    def Faces(self, name):
        """Pairs of an element (from 0) and CalculiX' number of its face."""
        elements, corners = self.mesh.Opposite(name)
        return zip(elements.tolist(), FACES[self.mesh.dim][corners].tolist(), strict=True)


def WriteInput(file, solid, arguments, stiffness=0.0):
    """Write the .inp file: a `Solid`, options as of the driver, pressure per overclosure (0: hard).

    The options are ``friction``, ``steps`` (equal load steps), ``variant`` and ``linear_solver``.
    """
    lines = [*ModelLines(solid), *SupportLines(solid), *ContactLines(arguments, stiffness)]
    Path(file).write_text("\n".join([*lines, *StepLines(solid, arguments)]) + "\n")


def Numbers(numbers, values):
    """Lines of CalculiX, whose fields have 20 characters."""
    return Rows(numbers, values, join=",", digits=13, most=11)


def ModelLines(solid):
    """Nodes, elements, materials, and the two surfaces."""
    yield "*NODE,NSET=NALL"
    yield from Numbers(range(len(solid.points)), solid.points)
    for name, mine, _ in Bodies(solid.mesh, solid.order):
        title = name.upper()
        yield f"*ELEMENT,TYPE={KINDS[solid.mesh.dim, solid.order]},ELSET={title}"
        yield from Numbers(mine, solid.elements[mine] + 1)
        yield from (f"*MATERIAL,NAME=M{title}", "*ELASTIC", f"{YOUNG[name]},{NU}")
        yield f"*SOLID SECTION,ELSET={title},MATERIAL=M{title}"
    for name in ("slave", "master"):
        yield f"*SURFACE,NAME={name.upper()},TYPE=ELEMENT"
        yield from (f"{element + 1},S{face}" for element, face in solid.Faces(name))


def SupportLines(solid):
    held = HELD[solid.mesh.problem]
    for name in held:
        yield f"*NSET,NSET=N{name.upper()}"
        yield from (f"{node + 1}," for node in solid.Nodes(name).tolist())
    yield "*BOUNDARY"
    if solid.mesh.dim == 2:
        yield "NALL,3,3"
    for name, component in held.items():
        yield f"N{name.upper()},{component + 1},{component + 1}"


def ContactLines(arguments, stiffness):
    yield f"*CONTACT PAIR,INTERACTION=CONTACT,TYPE={CONTACT_TYPES[arguments.variant]}"
    yield from ("SLAVE,MASTER", "*SURFACE INTERACTION,NAME=CONTACT")
    if stiffness:
        yield from ("*SURFACE BEHAVIOR,PRESSURE-OVERCLOSURE=LINEAR", f"{stiffness!r}")
    if arguments.friction:
        yield from ("*FRICTION", f"{arguments.friction},{0.1 * stiffness!r}")


def StepLines(solid, arguments):
    """The load steps, and what is written to files."""
    size = 1 / arguments.steps
    yield from ("*STEP,INC=1000", f"*STATIC,SOLVER={arguments.linear_solver}")
    yield f"{size!r},1.,1e-5,{size!r}"
    yield from LoadLines(solid)
    patch = solid.mesh.problem == "patch"
    yield from ("*NODE PRINT,NSET=NALL", "U") if patch else ("*CONTACT FILE", "CSTR")
    yield "*END STEP"


def LoadLines(solid):
    """The whole load; CalculiX ramps it over the step."""
    mesh = solid.mesh
    if mesh.problem != "hertz":
        pressure = PRESSURE[mesh.problem]
        yield "*DLOAD"
        yield from (f"{i + 1},P{face},{pressure!r}" for i, face in solid.Faces("top"))
        return
    n, force = len(mesh.Points(solid.order)), -LINE_FORCE / 2 * THICKNESS
    shares = (1 / 6, 1 / 6, 4 / 6) if solid.order == 2 else (1 / 2, 1 / 2)
    yield "*CLOAD"
    yield from (f"{mesh.load + 1 + i * n},2,{share * force!r}" for i, share in enumerate(shares))


# ---------------------------------------------------------------- results


def ReadContact(file, count):
    """The last contact pressures (count,) of an .frd file; nodes without contact get 0."""
    pressure, active = None, False
    with Path(file).open() as lines:
        for line in lines:
            if line.startswith(" -4"):
                active = line.split()[1] == "CONTACT"
                if active:
                    pressure = np.zeros(count)
            elif line.startswith(" -3"):
                active = False
            elif active and line.startswith(" -1") and (node := int(line[3:13])) <= count:
                start = 13 + 12 * PRESSURE_COLUMN  # columns of fixed width, no blank for a minus
                pressure[node - 1] = float(line[start : start + 12])
    if pressure is None:
        raise ValueError(f"no contact stresses in {Path(file).name}")
    return pressure


def ReadDisplacement(file, count):
    """The last displacements (count, 3) in a .dat file; seven digits, .frd files have six."""
    displacement = np.full((count, 3), np.nan)
    with Path(file).open() as lines:
        for words in map(str.split, lines):
            if len(words) == 4 and words[0].isdigit():
                displacement[int(words[0]) - 1] = [float(word) for word in words[1:]]
    if np.isnan(displacement).any():
        raise ValueError(f"displacements are missing in {Path(file).name}")
    return displacement
