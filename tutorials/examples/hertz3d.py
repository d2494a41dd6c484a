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

from dataclasses import dataclass, field

import numpy as np
from command import Communicator, Count, Main, NotNegative, Picture, Positive
from hertzmeans import Compare, Radius
from ngsolve import *
from slavefaces import SlaveFaces

from ngslac import BubbleVectorH1, ContactSolver, LACContact, LACSpace, LoadStepper, SplitSlaveFaces
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


def Displacements(mesh, *, order=2, stabilize="none"):
    """Displacements that are held at the bottom and on the symmetry planes."""
    held = {"dirichletx": "bottom|sym_x", "dirichlety": "bottom|sym_y", "dirichletz": "bottom"}
    if stabilize == "bubble":
        return BubbleVectorH1(mesh, order=order, slave="slave", **held)
    return VectorH1(mesh, order=order, **held)


@dataclass
class Pressed:
    """The solution of `Press`; a tuple per converged step."""

    solution: GridFunction
    contact: LACContact
    stress: CF
    steps: list = field(default_factory=list)  # load factor, iterations, force, table

    def Record(self, step):
        table = {name: np.copy(values) for name, values in self.contact.Table().items()}
        self.steps.append((step.time, step.iterations, np.array(self.contact.Force()), table))


def Press(mesh, load, *, inverse=None, steps=1, friction=0.0, **options):
    """Press the bodies together by a force; the options are those of `Displacements`."""
    V = Displacements(mesh, **options)
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
    contact = LACContact(u, lam, master="master", friction=friction or None)
    pressed = Pressed(gf, contact, Elastic(mesh, gf.components[0]))
    stepper = LoadStepper(ContactSolver(a, gf, contact, inverse=inverse), factor)
    with TaskManager():
        stepper.Integrate(steps=steps, callback=pressed.Record, printing=False)
    return pressed


def Run(
    *,
    out,
    quiet,
    shape="sphere",
    model="quarter",
    h=0.3125,
    order=2,
    stabilize="none",
    friction=0.0,
    steps=1,
    inverse=None,
):
    """Compute, compare, print, write; the figures."""
    mesh = Distributed(
        lambda: Mesh(shape, h, model=model, order=order, stabilize=stabilize), Communicator()
    )
    load, hertz = FORCE[shape] * PART.get((shape, model), 1.0), Hertz(shape)
    how = dict(order=order, stabilize=stabilize, friction=friction, steps=steps, inverse=inverse)
    pressed = Press(mesh, load, **how)
    contact, (_, _, force, table) = pressed.contact, pressed.steps[-1]
    faces = SlaveFaces(contact.mesh, contact.space.macros, shape == "cylinder")
    iterations = [int(n) for _, n, *_ in pressed.steps]
    figures = Compare(faces, hertz, table["pressure"]) | {
        "force_ratio": force[2] / load,
        "newton_iterations": iterations,
        "newton_max": max(iterations),
        "ndof": pressed.solution.components[0].space.ndofglobal + table["traction"].size,
    }
    assert abs(figures["force_ratio"] - 1) < 1e-8, figures
    if not quiet:
        print(f"{figures['ndof']} unknowns, {len(faces.area)} macro-elements, Newton {iterations}")
        print(f"Hertz: p0 = {hertz.peak:.1f} MPa, a = {Radius(hertz):.4f} mm; computed over Hertz:")
        for name in ("p0_ratio", "contact_radius_ratio", "force_ratio"):
            print(f"  {name:<22}{figures[name]:.5f}")
        print(f"error of the pressures in L2  {100 * figures['profile_error']:.2f} %")
    if out:
        Write(out, pressed, hertz)
    return figures


def Write(out, pressed, hertz):
    """A picture of the pressures and files for ParaView: bodies, slave faces, segments."""
    displacement, contact = pressed.solution.components[0], pressed.contact
    line, r = isinstance(hertz, HertzLine), np.linspace(0, 1.3 * Radius(hertz), 500)
    along = "x" if line else lambda points: np.hypot(points[:, 0], points[:, 1])
    with Picture(out, "hertz3d_pressure") as axes:
        contact.Plot("pressure", along=along, axes=axes, label="macro-elements")
        axes.plot(r, hertz.Pressure(r), "k", lw=0.9, label="Hertz")
        axes.set(xlabel="distance from the middle [mm]", ylabel="pressure [MPa]")
        axes.legend()
    fields, names = [displacement, pressed.stress], ["displacement", "stress"]
    VTKOutput(contact.mesh, fields, names, str(out / "hertz3d"), subdivision=1).Do()
    contact.WriteVTU(out / "hertz3d_contact.vtu", displacement=displacement)
    contact.Segments().WriteVTU(out / "hertz3d_segments.vtu")


main = Main(
    Run,
    __doc__,
    shape=(("sphere", "cylinder"), "what is pressed"),
    model=(("quarter", "full"), "part that is computed"),
    h=(Positive, "size of the slave faces, in mm"),
    order=((1, 2, 3), "order of the displacement"),
    stabilize=(("none", "bubble", "split"), "of single faces by"),
    friction=(NotNegative, "coefficient of friction"),
    steps=(Count, "number of load steps"),
    inverse=(str, "sparse direct solver, such as umfpack or pardiso"),
)


if __name__ == "__main__":
    main()
