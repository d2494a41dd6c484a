"""Input and result files of CalculiX for the problems of the comparison; NumPy only.

CalculiX has no plane contact: the 2D problem becomes one layer of wedges that is held in z.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from boundary import Lowered, Opposite
from meshes import HELD
from metrics import LINE_FORCE, NU, PATCH_PRESSURE, SPHERE_LOAD, YOUNG

__all__ = ["CONTACT_TYPES", "ReadContact", "ReadDisplacement", "Solid", "WriteInput"]

CONTACT_TYPES = {"penalty": "SURFACE TO SURFACE", "mortar": "MORTAR"}

KINDS = {(2, 1): "C3D6", (2, 2): "C3D15", (3, 1): "C3D4", (3, 2): "C3D10"}
# Number of the face opposite to each corner; in 2D those of the wedge that stands on the triangle.
FACES = {2: np.array([4, 5, 3]), 3: np.array([3, 4, 2, 1])}
THICKNESS = 1.0
PRESSURE_COLUMN = 3  # of the block CONTACT: gap, two slips, pressure, two shear stresses


@dataclass(frozen=True)
class Solid:
    """The mesh as CalculiX gets it; numbers from 0 (in the files from 1).

    Parameters
    ----------
    mesh : PeerMesh
    order : {1, 2}
    """

    mesh: object
    order: int

    @property
    def kind(self):
        """CalculiX' name of the element."""
        return KINDS[self.mesh.dim, self.order]

    @property
    def points(self):
        """Coordinates (n, 3), the upper body shifted."""
        points = Lowered(self.mesh, self.order)
        if self.mesh.dim == 3:
            return points
        heights = [(points, 0.0), (points, THICKNESS)]
        if self.order == 2:
            heights.append((points[: self.mesh.nvertices], THICKNESS / 2))
        return np.vstack([np.column_stack([p, np.full(len(p), z)]) for p, z in heights])

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
        """All nodes on a boundary of the mesh."""
        nodes = self.mesh.Nodes(self.order, name)
        if self.mesh.dim == 3:
            return nodes
        n = len(self.mesh.Points(self.order))
        upright = nodes[nodes < self.mesh.nvertices] + 2 * n
        return np.concatenate([nodes, nodes + n, upright if self.order == 2 else nodes[:0]])

    def Faces(self, name):
        """Pairs of an element (from 0) and CalculiX' number of its face."""
        elements, corners = Opposite(self.mesh, name)
        return np.column_stack([elements, FACES[self.mesh.dim][corners]])


def WriteInput(
    file,
    mesh,
    order,
    *,
    friction=0.0,
    steps=1,
    variant="penalty",
    stiffness=0.0,
    linear_solver="SPOOLES",
):
    """Write the input file of a problem.

    Parameters
    ----------
    file : str or Path
        Ends in .inp.
    mesh : PeerMesh
    order : {1, 2}
    friction : float
    steps : int
        Number of equal load steps.
    variant : {"penalty", "mortar"}
    stiffness : float
        Pressure per overclosure; 0 (mortar only) for a hard contact.
    linear_solver : str
        CalculiX' name.
    """
    solid = Solid(mesh, order)
    lines = [*ModelLines(solid), *SupportLines(solid), *ContactLines(friction, variant, stiffness)]
    lines += StepLines(solid, steps, linear_solver)
    Path(file).write_text("\n".join(lines) + "\n")


def StepLines(solid, steps, linear_solver):
    """The load steps, and what is written to files."""
    yield "*STEP,INC=1000"
    yield f"*STATIC,SOLVER={linear_solver}"
    yield f"{1 / steps!r},1.,1e-5,{1 / steps!r}"
    yield from LoadLines(solid)
    if solid.mesh.problem == "patch":
        yield from ("*NODE PRINT,NSET=NALL", "U")
    else:
        yield from ("*CONTACT FILE", "CSTR")
    yield "*END STEP"


def ModelLines(solid):
    """Nodes, elements, materials, and the two surfaces."""
    yield "*NODE,NSET=NALL"
    for i, point in enumerate(solid.points.tolist(), 1):
        yield ",".join([str(i), *(f"{x:.13g}" for x in point)])
    elements, materials = solid.elements + 1, solid.mesh.materials
    for name in np.unique(materials):
        yield f"*ELEMENT,TYPE={solid.kind},ELSET={name.upper()}"
        for i in np.flatnonzero(materials == name):
            row = [str(number) for number in (i + 1, *elements[i].tolist())]
            yield from (",".join(row[:11]) + ("," if row[11:] else ""), *Rest(row[11:]))
        yield from (f"*MATERIAL,NAME=M{name.upper()}", "*ELASTIC", f"{YOUNG[name]},{NU}")
        yield f"*SOLID SECTION,ELSET={name.upper()},MATERIAL=M{name.upper()}"
    for name in ("slave", "master"):
        yield f"*SURFACE,NAME={name.upper()},TYPE=ELEMENT"
        yield from (f"{element + 1},S{face}" for element, face in solid.Faces(name).tolist())


def Rest(row):
    """A second line, if there is anything to write."""
    return [",".join(row)] if row else []


def SupportLines(solid):
    """Supports of the problem."""
    held = HELD[solid.mesh.problem]
    for name in held:
        yield f"*NSET,NSET=N{name.upper()}"
        yield from (f"{node + 1}," for node in solid.Nodes(name).tolist())
    yield "*BOUNDARY"
    if solid.mesh.dim == 2:
        yield "NALL,3,3"
    for name, component in held.items():
        yield f"N{name.upper()},{component + 1},{component + 1}"


def ContactLines(friction, variant, stiffness):
    """The contact and its law."""
    yield f"*CONTACT PAIR,INTERACTION=CONTACT,TYPE={CONTACT_TYPES[variant]}"
    yield "SLAVE,MASTER"
    yield "*SURFACE INTERACTION,NAME=CONTACT"
    if stiffness:
        yield from ("*SURFACE BEHAVIOR,PRESSURE-OVERCLOSURE=LINEAR", f"{stiffness!r}")
    if friction:
        yield from ("*FRICTION", f"{friction},{0.1 * stiffness!r}")


def LoadLines(solid):
    """The whole load; CalculiX ramps it over the step."""
    mesh = solid.mesh
    if mesh.problem == "hertz":
        node, n = mesh.load + 1, len(mesh.Points(solid.order))
        force = -LINE_FORCE / 2 * THICKNESS
        shares = {node: 1 / 2, node + n: 1 / 2}
        if solid.order == 2:
            shares = {node: 1 / 6, node + n: 1 / 6, node + 2 * n: 4 / 6}
        yield "*CLOAD"
        yield from (f"{at},2,{share * force!r}" for at, share in shares.items())
        return
    pressure = SPHERE_LOAD if mesh.problem == "sphere" else PATCH_PRESSURE
    yield "*DLOAD"
    yield from (f"{i + 1},P{face},{pressure!r}" for i, face in solid.Faces("top").tolist())


# ---------------------------------------------------------------- results


def ReadContact(file, count):
    """The last contact pressures of an .frd file.

    Parameters
    ----------
    file : str or Path
    count : int
        Number of nodes whose pressure is wanted; nodes without contact get 0.

    Returns
    -------
    (count,) array
    """
    pressure = None
    active = False
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
    """The last displacements of all nodes in a .dat file; seven digits, .frd files have six.

    Parameters
    ----------
    file : str or Path
    count : int
        Number of nodes.

    Returns
    -------
    (count, 3) array
    """
    displacement = np.full((count, 3), np.nan)
    with Path(file).open() as lines:
        for line in lines:
            words = line.split()
            if len(words) == 4 and words[0].isdigit():
                displacement[int(words[0]) - 1] = [float(word) for word in words[1:]]
    if np.isnan(displacement).any():
        raise ValueError(f"displacements are missing in {Path(file).name}")
    return displacement
