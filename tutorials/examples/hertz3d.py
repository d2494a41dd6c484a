"""Hertz in 3D: a sphere or a cylinder pressed on a block.

Small strains. A steel body of radius 50 mm (E = 210 GPa) is pressed on a block of aluminium (E = 70
GPa), nu = 0.3. The forces are so low (contact radius 2.5 mm) that Hertz' half-spaces are a good
model of both bodies. The sphere has his point contact. The cylinder is a slice of a long one (plane
strain), meshed with prisms, and has his line contact.

Source: K. L. Johnson, Contact Mechanics (1985), chapter 4. Start it with::

    python tutorials/examples/hertz3d.py --out results

p0_ratio compares the pressures about the middle with the means of Hertz' pressure over the same
macro-elements; contact_radius_ratio is that of the Hertz pressure which fits the multipliers best.
"""

from typing import Literal

import numpy as np
from command import Communicator, Main, NotNegative
from hertzmeans import Compare, Radius
from ngsolve import *
from pictures import Curves, Show
from slavefaces import SlaveFaces

from ngslac import *
from ngslac.materials import Stress
from ngslac.meshes import CylinderOnBlock, Distributed, SphereOnBlock
from ngslac.reference import HertzLine, HertzPoint

YOUNG, POISSON, RADIUS = {"body": 210e3, "block": 70e3}, 0.3, 50.0  # MPa, 1, mm
FORCE = {"sphere": 24e3, "cylinder": 5.7e3}  # N on the whole sphere, N/mm: a = 2.5 mm
PART = {("sphere", "quarter"): 0.25, ("cylinder", "quarter"): 0.5}  # of the force on the model


def Hertz(shape, force=1.0):
    """Hertz' solution for a part of the force."""
    bodies = dict(young1=YOUNG["body"], nu1=POISSON, young2=YOUNG["block"], nu2=POISSON)
    kind = HertzPoint if shape == "sphere" else HertzLine
    return kind(force=force * FORCE[shape], radius1=RADIUS, **bodies)


def Mesh(shape, h, *, model="quarter", order=2, stabilize="none"):
    """The bodies, fine where they touch: slave faces of size h, which are split then if wanted."""
    # Linear elements that grow fast with the depth make both bodies too stiff: ten per cent in the
    # contact modulus, which shows as a peak six per cent too high. A coarse, soft master of them
    # deforms with kinks that the pressures follow.
    ratio = 0.6 if order == 1 else 1.2
    options = dict(radius=RADIUS, model=model, ratio=ratio, zone=1.3 * Radius(Hertz(shape)))
    if shape == "cylinder":
        mesh = CylinderOnBlock(h, **options)
    else:
        grading = {"grading": 0.2} if order == 1 else {}
        mesh = SphereOnBlock(h, order=max(2, order), **options, **grading)
    return SplitSlaveFaces(mesh, "slave") if stabilize == "split" else mesh


def Elastic(mesh, u):
    """Stress of a displacement."""
    young = mesh.MaterialCF({"block": YOUNG["block"]}, default=YOUNG["body"])
    return Stress(Sym(Grad(u)), young, POISSON)


def Run(
    shape: Literal["sphere", "cylinder"] = "sphere", model: Literal["quarter", "full"] = "quarter",
    h=0.3125, order: Literal[1, 2, 3] = 2, stabilize: Literal["none", "bubble", "split"] = "none",
    friction: NotNegative = 0.0, steps=1, out=None
):  # fmt: skip
    """Press the body, and compare with Hertz.

    shape : what is pressed
    model : part that is computed
    h : size of the slave faces, in mm
    order : order of the displacement
    stabilize : of single faces by
    friction : coefficient of friction
    steps : number of load steps
    """
    mesh = Distributed(
        lambda: Mesh(shape, h, model=model, order=order, stabilize=stabilize), Communicator()
    )
    load, hertz = FORCE[shape] * PART.get((shape, model), 1.0), Hertz(shape)
    held = {"dirichletx": "bottom|sym_x", "dirichlety": "bottom|sym_y", "dirichletz": "bottom"}
    if stabilize == "bubble":
        V = BubbleVectorH1(mesh, order=order, slave="slave", **held)
    else:
        V = VectorH1(mesh, order=order, **held)
    X = V * LACSpace(V, slave="slave")
    (u, lam), (v, _) = X.TnT()
    factor, a, gf = Parameter(0.0), BilinearForm(X), GridFunction(X)
    a += InnerProduct(Elastic(mesh, u), Sym(Grad(v))) * dx
    # The load acts on a plate, which resists to being stretched and tilted, and to horizontal
    # motion, but not to one up or down. A sphere without friction needs that in order not to roll.
    plate = RADIUS * InnerProduct(Grad(u).Trace(), Grad(v).Trace())
    plate += (u[0] * v[0] + u[1] * v[1]) / RADIUS
    area = Integrate(1, mesh, definedon=mesh.Boundaries("top"))
    a += (YOUNG["body"] * plate + factor * load / area * v[2]) * ds("top")
    contact, done = LACContact(u, lam, master="master", friction=friction or None), []

    def Note(step):
        table = {name: np.copy(values) for name, values in contact.Table().items()}
        done.append((step.time, step.iterations, np.array(contact.Force()), table))

    with TaskManager():
        stepper = LoadStepper(ContactSolver(a, gf, contact), factor)
        stepper.Integrate(steps=steps, callback=Note, printing=False)
    (_, _, force, table), moved = done[-1], gf.components[0]
    faces = SlaveFaces(mesh, contact.space.macros, shape == "cylinder")
    figures = Compare(faces, hertz, table["pressure"]) | {
        "force_ratio": force[2] / load,
        "newton_iterations": [int(step[1]) for step in done],
    }
    print(f"Hertz: p0 = {hertz.peak:.1f} MPa, a = {Radius(hertz):.4f} mm; computed over Hertz:")
    for name in ("p0_ratio", "contact_radius_ratio", "force_ratio"):
        print(f"  {name:<22}{figures[name]:.5f}")
    print(f"error of the pressures in L2  {100 * figures['profile_error']:.2f} %")
    assert abs(figures["force_ratio"] - 1) < 1e-8, figures
    size = h / Radius(hertz)
    assert max(abs(figures[name] - 1) for name in ("p0_ratio", "contact_radius_ratio")) < 0.1 + size

    r = np.linspace(0, 1.3 * Radius(hertz), 500)
    along = "x" if shape == "cylinder" else lambda points: np.hypot(points[:, 0], points[:, 1])
    curve = {"Hertz": (r, hertz.Pressure(r), "k")}

    def Pressures(axes):
        contact.Plot("pressure", along=along, axes=axes, label="macro-elements")
        Curves("distance from the middle [mm]", "pressure [MPa]", **curve)(axes)

    Show(out, "hertz3d", moved, Pressures, slave=contact)
    if out:
        fields = {"displacement": moved, "stress": Elastic(mesh, moved)}
        files = str(out / "hertz3d")
        VTKOutput(mesh, [*fields.values()], [*fields], files, subdivision=1).Do()
    return figures | {"solution": (gf, contact, done)}


main = Main(Run)
