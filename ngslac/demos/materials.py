"""Materials under contact through NGSolve alone: near-incompressible rubber and thermal strain.

Two small problems in which nothing is special about the contact: the material is an energy or a
stress that the user writes down.

*rubber*: a round rubber cord (neo-Hooke, Poisson ratio 0.4999, plane strain) is squeezed between
frictionless plates by a quarter of its diameter. Displacement and hydrostatic pressure are
unknowns, together with the contact traction: a product of three spaces. At small loads the force
is that of K. L. Johnson, Contact Mechanics (1985), equation 5.57.

*thermal*: a disc is heated inside of a cold ring, closes a clearance and presses against it; the
pressure follows from Lame's thick-walled cylinders.

Start it with::

    python -m ngslac.demos.materials --picture materials.png
"""

from __future__ import annotations

import time

import numpy as np
from ngsolve import (
    CF,
    BilinearForm,
    Grad,
    GridFunction,
    Id,
    IfPos,
    InnerProduct,
    Sym,
    Trace,
    VectorH1,
    dx,
    sqrt,
    x,
    y,
)

from ngslac import ContactSolver, LACContact, LACSpace

from ._command import CommandParser, WriteJSON
from ._materials_meshes import DiscInRing
from ._materials_rubber import RADIUS, Result, Rubber, SqueezeForce
from ._pictures import Matplotlib

__all__ = ["Result", "Rubber", "Run", "SqueezeForce", "Thermal", "ThermalPressure", "main"]

CASES = ("rubber", "thermal")


# ---------------------------------------------------------------- thermal strain


def ThermalPressure(*, heating, clearance, young=1.0, poisson=0.3, outer=100.0):
    """Contact pressure of a heated disc in a cold ring of the same material, in plane strain.

    Lame's solution at small strains. The disc's free expansion less the clearance is shared by the
    compression of the disc and the widening of the ring; 0 while there is a gap.

    Parameters
    ----------
    heating : float
        Thermal expansion coefficient times temperature rise.
    clearance : float
        Radial gap at the start.
    young, poisson : float
        Elastic constants.
    outer : float
        Outer radius of the ring.
    """
    ratio = (outer / RADIUS) ** 2
    disc = (1 + poisson) * (1 - 2 * poisson) / young
    ring = (1 + poisson) / young * ((1 - 2 * poisson) + ratio) / (ratio - 1)
    return max(0.0, ((1 + poisson) * heating - clearance / RADIUS) / (disc + ring))


def Thermal(*, h=6.0, heating=1e-3, clearance=1e-3, poisson=0.3, order=2):
    """Heat the disc.

    Parameters
    ----------
    h : float
        Edge length on the disc's rim (its radius is 50).
    heating : float
        Thermal expansion coefficient times temperature rise of the disc.
    clearance : float
        Radial gap at the start.
    poisson : float
        Poisson's ratio.
    order : int
        Of the displacement.

    Returns
    -------
    Result
        Young's modulus is 1.
    """
    mesh = DiscInRing(h, clearance=clearance)
    V = VectorH1(mesh, order=order, dirichletx="symx", dirichlety="symy")
    X = V * LACSpace(V, slave="slave")
    (u, lam), (v, _) = X.TnT()
    shear = 1 / (2 * (1 + poisson))
    hot = mesh.MaterialCF({"disc": heating}, default=0)

    def Stress(strain):
        # Out of the plane nothing moves: the hot disc is held back there, too.
        elastic = strain - hot * Id(2)
        lame = 2 * shear * poisson / (1 - 2 * poisson)
        return 2 * shear * elastic + lame * (Trace(elastic) - hot) * Id(2)

    a = BilinearForm(X)
    a += InnerProduct(Stress(Sym(Grad(u))), Sym(Grad(v))) * dx
    contact = LACContact(u, lam, master="master")
    gf = GridFunction(X)
    solver = ContactSolver(a, gf, contact)
    solver.Solve(printing=False)
    stress = Stress(Sym(Grad(gf.components[0])))
    radius = IfPos(x**2 + y**2, sqrt(x**2 + y**2), 1.0)
    around = CF((-y, x)) / radius
    hoop = InnerProduct(stress * around, around)
    result = Result(mesh, gf.components[0], contact, hoop, solver)
    exact = ThermalPressure(heating=heating, clearance=clearance, poisson=poisson)
    pressure = contact.Table()["pressure"]
    result.figures = {
        "pressure": float(pressure.mean()),
        "lame": exact,
        "spread": float(np.ptp(pressure)),
        "newton_iterations": len(solver.history) - 1,
        "ndof": len(gf.vec),
    }
    return result


# ---------------------------------------------------------------- all of them


def Run(*, picture=None, quiet=True, cases=CASES):
    """Solve the cases.

    Parameters
    ----------
    picture : str or path, optional
        File for the picture, which needs both cases.
    quiet : bool
        Print nothing.
    cases : sequence of {"rubber", "thermal"}

    Returns
    -------
    dict
        A `Result` for each case.
    """
    if unknown := set(cases) - set(CASES):
        raise ValueError(f"unknown cases {sorted(unknown)}: there are {', '.join(CASES)}")
    if picture is not None:
        Matplotlib()  # complain before the work, not after it
        if set(cases) != set(CASES):
            raise ValueError("the picture shows all cases: compute them all")
    results = {}
    for name in cases:
        start = time.perf_counter()
        results[name] = {"rubber": Rubber, "thermal": Thermal}[name]()
        results[name].figures["seconds"] = time.perf_counter() - start
        if not quiet:
            print(f"{name}:")
            for key, value in results[name].figures.items():
                print(f"  {key:20} {value}")
    if picture is not None:
        from ._materials_pictures import MaterialsPicture

        MaterialsPicture(results, picture)
    return results


def main(argv=None):
    """Run the demo from the command line."""
    parser = CommandParser("materials", __doc__)
    parser.add_argument("--cases", nargs="+", choices=CASES, default=CASES)
    parser.add_argument("--picture", metavar="PNG", help="write a picture to this file")
    options = vars(parser.parse_args(argv))
    file = options.pop("json")
    results = Run(**options)
    if file:
        WriteJSON({name: result.figures for name, result in results.items()}, file)


if __name__ == "__main__":
    main()
