"""A plate is rolled in two passes, from 1 to 0.75 and to 0.5: large plastic strains.

The upper half of the plate, in plane strain. The roll is a tool on a path: it goes down, along the
plate while it turns, down again, and back. Two rolls of radius 2, plate of length 4, as in the
problem of two passes of MOOSE's examples of rigid contact, here with friction. Start it with::

    python tutorials/examples/rolling.py --out results

What comes out has the thickness of the gap between the rolls, and the volume of the plate.
"""

import numpy as np
from command import Main, NotNegative
from ngsolve import *
from ngsolve.meshes import MakeStructured2DMesh
from pictures import Bodies, Curves, Show
from plasticity import J2Plasticity, LogStrain

from ngslac import *
from ngslac.tools import Sphere

LENGTH, RADIUS, GAPS = 4.0, 2.0, (0.75, 0.5)
FROM, TO, BACK = 1.2, 2.4, 1.4  # where the roll goes down, turns back, and stops


def Run(h=0.167, steps=16, friction: NotNegative = 0.1, out=None):
    """Both passes: thickness after each, and the volume over that before.

    h : edge length
    steps : steps along the plate, per pass
    friction : coefficient
    """
    size = {"nx": round(LENGTH / h), "ny": max(2, round(0.5 / h))}
    mesh = MakeStructured2DMesh(quads=False, mapping=lambda s, t: (LENGTH * s, t / 2), **size)
    V = VectorH1(mesh, order=2, dirichletx="left", dirichlety="bottom")
    X = V * LACSpace(V, slave="top")
    u, lam = X.TrialFunction()
    material = J2Plasticity(mesh, young=70e3, poisson=0.3, yield_stress=200.0, hardening=200.0)
    a, gf, down, way = BilinearForm(X), GridFunction(X), Parameter(0.0), Parameter(0.0)
    a += Variation(material.Energy(LogStrain(Grad(u))) * dx(intrules=material.rules))
    above = FROM, 0.5 + RADIUS
    path = {"shift": (way, -down), "angle": -way / RADIUS, "center": above}
    roll = Sphere(above, RADIUS).Moved(**path)
    contact = LACContact(u, lam, obstacle=roll, finite=True, friction=friction)
    solver, moved = ContactSolver(a, gf, contact), gf.components[0]
    strain, start = LogStrain(Grad(moved)), np.linspace(0, LENGTH, 400)
    forces, thickness = [], []  # on the roll; in the middle of the way

    def Note(step):
        material.Commit(strain)
        forces.append(-contact.Force())

    for gap, end in zip(GAPS, (TO, BACK), strict=True):
        flags = {"printing": False, "callback": Note}
        LoadStepper(solver, down).Integrate((1 - gap) / 2, steps=max(2, steps // 4), **flags)
        LoadStepper(solver, way).Integrate(end - FROM, steps=steps, **flags)
        top = np.array([moved(mesh(s, 0.5)) for s in start])
        half = np.interp((TO + BACK) / 2, start + top[:, 0], 0.5 + top[:, 1])
        thickness.append(2 * float(half))
    volume = Integrate(Det(Id(2) + Grad(moved)), mesh, order=4) / Integrate(1, mesh)
    print("thickness after both passes {:.4f} {:.4f}".format(*thickness))
    print(f"volume over that before {volume:.5f}")
    assert np.allclose(thickness, GAPS, atol=0.02), thickness
    assert abs(volume - 1) < 0.01, volume

    along, lift = np.transpose(forces)
    steps = np.arange(len(lift))
    curves = {"upwards": (steps, lift, ".-"), "along": (steps, along, ".-")}
    Show(out, "rolling", moved, Bodies(moved), Curves("step", "force on the roll", **curves),
         top=contact)  # fmt: skip
    length = LENGTH + moved(mesh(LENGTH, 0.0))[0]
    return {"thickness": thickness, "volume": volume, "length": length}


main = Main(Run)
