"""From a STEP file to a contact result: a bracket bolted on a plate and pulled sideways.

    python step_to_contact.py [folder for the results]

The script makes an assembly, writes it to a STEP file and goes on with that file alone, as if it
came from a CAD system: it names faces by their position, meshes the parts without joining them,
tightens the bolt, pulls, prints the resultants, and writes files for ParaView. Units: mm, N, MPa.
"""

import sys
from pathlib import Path

import numpy as np
from netgen.occ import Box, Compound, Cylinder, OCCGeometry, Pnt, X, Z
from ngsolve import (
    BND,
    CF,
    BilinearForm,
    BitArray,
    Grad,
    GridFunction,
    InnerProduct,
    Integrate,
    Mesh,
    Parameter,
    Sym,
    TaskManager,
    VectorH1,
    VTKOutput,
    ds,
    dx,
    specialcf,
)

from ngslac import ContactSolver, LACContact, LACSpace, LoadStepper
from ngslac.materials import Stress

folder = Path(sys.argv[1] if len(sys.argv) > 1 else "results")
folder.mkdir(parents=True, exist_ok=True)

# ---- 1. A STEP file -------------------------------------------------------------------------
# An angle bracket with a boss for the bolt's head, and the plate under it. Replace this part by
# your own file. The foot of the bracket and the top of the plate lie in the same plane.
bracket = Box((-20, -15, 0), (20, 15, 8)) + Box((-20, -15, 0), (-12, 15, 40))
bracket = bracket + Cylinder((4, 0, 8), Z, r=8, h=1) - Cylinder((4, 0, 0), Z, r=4.5, h=9)
plate = Box((-30, -20, -10), (30, 20, 0)) - Cylinder((4, 0, -10), Z, r=4, h=10)
Compound([plate, bracket]).WriteStep(str(folder / "assembly.step"))

# ---- 2. Read it, and look at what there is ---------------------------------------------------
solids = OCCGeometry(str(folder / "assembly.step")).shape.solids
for solid in solids:
    print(f"solid of volume {solid.mass:.0f}, centre", np.round(tuple(solid.center), 2))
    for face in solid.faces:
        print(f"    face of area {face.mass:7.1f}, centre", np.round(tuple(face.center), 2))

# Parts and faces are found by where they are: Min and Max take the farthest centre in a direction,
# Nearest the shape next to a point, faces[Z < 1] a list. (Names in the file would be kept as well.)
plate, bracket = solids.Min(Z), solids.Max(Z)
plate.mat("plate")
bracket.mat("bracket")
for solid in solids:
    solid.faces.name = "free"
plate.faces.Min(Z).name = "bottom"
plate.faces.Max(Z).name = "master"
bracket.faces.Min(Z).name = "slave"  # the finer side
bracket.faces.Nearest(Pnt(4, 6, 9)).name = "washer"
bracket.faces.Min(X).name = "back"

# ---- 3. Mesh --------------------------------------------------------------------------------
# Compound keeps the parts apart: each has its own faces and is meshed by itself, with its own size.
# Glue would make one shared face of the two that touch, and one body of the parts. (Where two faces
# coincide from edge to edge, the mesher may make the same triangles twice. That does no harm.)
bracket.maxh, plate.maxh = 6, 10
shape = Compound([plate, bracket])
mesh = Mesh(OCCGeometry(shape).GenerateMesh(maxh=20, grading=0.5)).Curve(2)

# A check of the names: area and mean normal of each named face.
areas = {}
for name in "bottom", "master", "slave", "washer", "back":
    region = mesh.Boundaries(name)
    areas[name] = Integrate(CF(1), region)
    normal = np.array(Integrate(specialcf.normal(3), region)) / areas[name]
    print(f"{name:6}  area {areas[name]:7.1f}, normal", normal.round(3) + 0.0)

# ---- 4. The problem -------------------------------------------------------------------------
V = VectorH1(mesh, order=2, dirichlet="bottom")
Q = LACSpace(V, slave="slave")  # one contact traction per macro-element of the foot
fes = V * Q
(u, lam), (v, mu) = fes.TnT()
print(f"{mesh.ne} elements, {V.ndof} displacements, {Q.nmacros} macro-elements")

E, nu = mesh.MaterialCF({"bracket": 210e3, "plate": 70e3}), 0.3


# Two loads, each with a factor that goes from 0 to 1: the bolt presses on the boss (on the plate it
# would act below, at the fixed side), and a force pulls at the back of the bracket.
bolt_force, pull_force = np.array([0, 0, -12000.0]), np.array([1000.0, 250.0, 0])
bolt, pull = Parameter(0), Parameter(0)
a = BilinearForm(fes)
a += InnerProduct(Stress(Sym(Grad(u)), E, nu), Sym(Grad(v))) * dx
a += -bolt / areas["washer"] * CF(tuple(bolt_force)) * v * ds("washer")
a += -pull / areas["back"] * CF(tuple(pull_force)) * v * ds("back")

contact = LACContact(u, lam, master="master", friction=0.3)
print(contact.Check())

# ---- 5. Load steps --------------------------------------------------------------------------
# Nothing but contact and friction holds the bracket. What slips depends on the order of the loads:
# first the bolt, then the pull in steps.
gf = GridFunction(fes)
solver = ContactSolver(a, gf, contact)
rows = []


def Row(step):
    """Force and moment (about the origin) on the bracket, and the state of the joint."""
    table = contact.Table()
    counts = np.bincount(table["status"], minlength=3)
    area = table["area"][table["status"] > 0].sum()
    force, moment = contact.Force(), contact.Moment((0, 0, 0))
    rows.append((bolt.Get(), pull.Get(), *force, *moment / 1000, table["pressure"].max(), area))
    print("".join(f"{number:8.1f}" for number in rows[-1]), *counts, step.iterations, sep="  ")


names = ["bolt", "pull", "Fx", "Fy", "Fz", "Mx", "My", "Mz", "pmax", "area"]  # N, N m, MPa, mm^2
print("".join(f"{name:>8}" for name in names), " open, stick, slip; solves")
with TaskManager():
    LoadStepper(solver, bolt).Integrate(steps=1, callback=Row, printing=False)
    LoadStepper(solver, pull).Integrate(steps=5, callback=Row, printing=False)

# ---- 6. Files for ParaView ------------------------------------------------------------------
shift = gf.components[0]
fields = {"displacement": shift, "stress": Stress(Sym(Grad(shift)), E, nu)}
VTKOutput(mesh, [*fields.values()], [*fields], str(folder / "volume"), order=2).Do()
fields = {name: getattr(contact, name) for name in ("pressure", "gap", "status", "traction")}
foot = BitArray([element.mat == "slave" for element in mesh.Elements(BND)])
VTKOutput(mesh, [*fields.values()], [*fields], str(folder / "contact")).Do(vb=BND, drawelems=foot)
contact.Segments().WriteVTU(folder / "segments.vtu")
