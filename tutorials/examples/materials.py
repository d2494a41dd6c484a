"""Materials under contact through NGSolve alone: near-incompressible rubber and thermal strain.

*rubber*: a round rubber cord (neo-Hooke, Poisson ratio 0.4999, plane strain) is squeezed between
frictionless plates by a quarter of its diameter. Displacement and hydrostatic pressure are
unknowns, together with the contact traction: a product of three spaces. At small loads the force
is that of K. L. Johnson, Contact Mechanics (1985), equation 5.57.

*thermal*: a disc is heated inside of a cold ring, closes a clearance and presses against it; the
pressure follows from Lame's thick-walled cylinders. Start it with::

    python tutorials/examples/materials.py --out results
"""

import math
from collections import namedtuple

import numpy as np
from command import Count, Main, Picture, Positive
from cords import CordMesh, DiscInRing
from deformed import DrawField
from ngsolve import *

from ngslac import ContactSolver, LACContact, LACSpace, LoadStepper
from ngslac.materials import Stress

RADIUS, OUTER = 50.0, 100.0  # of cord and disc; of the ring
CASES = ("rubber", "thermal")

Result = namedtuple("Result", "displacement contact field figures curve", defaults=[()])


def SqueezeForce(squeeze):
    """Small force that squeezes an incompressible cylinder by a part of its diameter D, over G D.

    Johnson 1985, equation 5.57, with 4 G for the plane strain modulus.
    """
    force = 4 * RADIUS * squeeze
    for _ in range(100):  # each half: R squeeze = P / (pi E*) (2 ln(4 R / a) - 1)
        halfwidth = math.sqrt(force * RADIUS / math.pi)
        force = 4 * math.pi * RADIUS * squeeze / (2 * math.log(4 * RADIUS / halfwidth) - 1)
    return force / (2 * RADIUS)


def ThermalPressure(heating, clearance, poisson=0.3):
    """Pressure over E of a disc in a cold ring, from Lame's solution; 0 while there is a gap.

    The disc's free expansion less the clearance is shared by the compression of the disc and the
    widening of the ring; `heating` is the thermal expansion coefficient times the temperature rise.
    """
    ratio = (OUTER / RADIUS) ** 2
    disc = (1 + poisson) * (1 - 2 * poisson)
    ring = (1 + poisson) * ((1 - 2 * poisson) + ratio) / (ratio - 1)
    return max(0.0, ((1 + poisson) * heating - clearance / RADIUS) / (disc + ring))


def RubberForm(X, bulk):
    """The neo-Hookean energy, with the hydrostatic pressure where the space has one."""
    (u, *p, _), (v, *_) = X.TnT()
    F = Grad(u) + Id(2)
    J = Det(F)
    energy = (J ** (-2 / 3) * (Trace(F.trans * F) + 1) - 3) / 2
    energy += p[0] * (J - 1) - p[0] ** 2 / (2 * bulk) if p else bulk / 2 * (J - 1) ** 2
    a = BilinearForm(X)
    a += Variation(energy.Compile() * dx("rubber"))
    a += InnerProduct(Sym(Grad(u)), Sym(Grad(v))) * dx("plate")  # is rigid: any will do
    return a


def Rubber(h=4.0, squeeze=0.25, steps=5, poisson=0.4999, order=2, mixed=True):
    """Squeeze the cord in equal steps; the shear modulus G is 1.

    The hydrostatic pressure is continuous and has one order less than the displacement; without it
    (`mixed`) the displacement alone locks. ``curve`` has (squeeze, force over G D) of each step.
    """
    if not 0 < poisson < 0.5:
        raise ValueError(f"poisson = {poisson} must lie between 0 and 0.5")
    bulk = 2 * (1 + poisson) / (3 * (1 - 2 * poisson))
    mesh, plate = CordMesh(h), "master|back"
    V = VectorH1(mesh, order=order, dirichletx=f"symx|{plate}", dirichlety=f"symy|{plate}")
    Q = LACSpace(V, slave="slave")
    X = V * H1(mesh, order=order - 1, definedon="rubber") * Q if mixed else V * Q
    a, (u, *_, lam) = RubberForm(X, bulk), X.TrialFunction()
    contact = LACContact(u, lam, master="master", finite=True)
    gf, load, curve = GridFunction(X), Parameter(0.0), [(0.0, 0.0)]
    solver = ContactSolver(a, gf, contact)

    def Record(step):
        curve.append((step.time, -float(contact.Force()[1]) / RADIUS))

    stepper = LoadStepper(solver, load, prescribe={plate: CF((0, -RADIUS * load))})
    done = stepper.Integrate(end=squeeze, steps=steps, callback=Record, printing=False)
    table, rubber = contact.Table(), mesh.Materials("rubber")
    change = Det(Grad(gf.components[0]) + Id(2)) - 1
    field = -gf.components[1] if mixed else -bulk * change
    volume = Integrate(1, mesh, definedon=rubber)
    figures = dict(zip(("squeeze", "force"), curve[-1], strict=True)) | {
        "peak_pressure": float(table["pressure"].max()),
        "contact_area": float(table["area"][table["status"] > 0].sum()),
        "volume_change": Integrate(change, mesh, definedon=rubber, order=6) / volume,
        "last_residuals": [entry.equilibrium for entry in solver.history],
        "newton_iterations": [step.iterations for step in done],
    }
    figures |= {"cuts": sum(step.cuts for step in done), "ndof": len(gf.vec)}
    return Result(gf.components[0], contact, field, figures, curve)


def Thermal(h=6.0, heating=1e-3, clearance=1e-3, poisson=0.3, order=2):
    """Heat the disc, which has a radial gap at the start; Young's modulus is 1."""
    mesh = DiscInRing(h, clearance=clearance, outer=OUTER)
    V = VectorH1(mesh, order=order, dirichletx="symx", dirichlety="symy")
    X = V * LACSpace(V, slave="slave")
    (u, lam), (v, _) = X.TnT()
    hot = mesh.MaterialCF({"disc": heating}, default=0)

    def Hot(u):  # out of the plane nothing moves: the hot disc is held back there, too
        return Stress(Sym(Grad(u)), 1.0, poisson) - hot / (1 - 2 * poisson) * Id(2)

    a = BilinearForm(X)
    a += InnerProduct(Hot(u), Sym(Grad(v))) * dx
    contact, gf = LACContact(u, lam, master="master"), GridFunction(X)
    solver = ContactSolver(a, gf, contact)
    solver.Solve(printing=False)
    around = CF((-y, x)) / IfPos(x**2 + y**2, sqrt(x**2 + y**2), 1.0)
    hoop = InnerProduct(Hot(gf.components[0]) * around, around)
    pressure = contact.Table()["pressure"]
    figures = {"pressure": float(pressure.mean()), "spread": float(np.ptp(pressure))}
    figures |= {"newton_iterations": len(solver.history) - 1, "ndof": len(gf.vec)}
    figures["lame"] = ThermalPressure(heating, clearance, poisson)
    return Result(gf.components[0], contact, hoop, figures)


def Write(results, folder):
    """Force and pressure of the cord, hoop stress of the disc; the surfaces for ParaView."""
    with Picture(folder, "materials", columns=3, size=(11.5, 3.6)) as axes:
        if rubber := results.get("rubber"):
            squeeze, force = np.transpose(rubber.curve)
            small = [SqueezeForce(s) for s in squeeze[1:]]
            axes[0].plot(squeeze, force, ".-", label="computed")
            axes[0].plot(squeeze[1:], small, "k", label="small strains")
            axes[0].set(xlabel="approach of the plates / diameter", ylabel="force / (diameter G)")
            axes[0].legend()
            DrawField(axes[1], rubber, ("rubber",), 1, "pressure in the rubber / G")
        if thermal := results.get("thermal"):
            label = "hoop stress / E, displacement x 200"
            DrawField(axes[2], thermal, ("disc", "ring"), 200, label)
    for name, result in results.items():
        result.contact.WriteVTU(folder / f"materials_{name}", displacement=result.displacement)


def Run(cases=CASES, squeeze=0.25, steps=5, heating=1e-3, out=None, quiet=True):
    """Solve the cases. Returns the numbers of each."""
    results = {}
    for name in cases:
        rubber = name == "rubber"
        results[name] = Rubber(squeeze=squeeze, steps=steps) if rubber else Thermal(heating=heating)
        if not quiet:
            print(f"{name}:")
            for key, value in results[name].figures.items():
                print(f"  {key:20} {value}")
    if out:
        Write(results, out)
    return {name: result.figures for name, result in results.items()}


main = Main(
    Run,
    __doc__,
    cases=(CASES, "to compute"),
    squeeze=(Positive, "of the cord, over its diameter"),
    steps=(Count, "in which the cord is squeezed"),
    heating=(Positive, "thermal expansion of the disc"),
)


if __name__ == "__main__":
    main()
