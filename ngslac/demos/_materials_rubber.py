"""The rubber cord of the materials demo."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

from ngsolve import (
    CF,
    H1,
    BilinearForm,
    Det,
    Grad,
    GridFunction,
    Id,
    InnerProduct,
    Integrate,
    Parameter,
    Sym,
    Trace,
    Variation,
    VectorH1,
    dx,
)

from ngslac import ContactSolver, LACContact, LACSpace, LoadStepper

from ._materials_meshes import CordMesh

__all__ = ["RADIUS", "Result", "Rubber", "SqueezeForce"]

RADIUS = 50.0


@dataclass
class Result:
    """A solved case: `figures` (as in the JSON file) and the NGSolve objects."""

    mesh: object
    displacement: GridFunction
    contact: object
    field: object  # what the picture shows
    solver: object
    curve: list = field(default_factory=list)
    figures: dict = field(default_factory=dict)


def SqueezeForce(squeeze, *, shear=1.0):
    """Force per length that squeezes an incompressible elastic cylinder between flat plates.

    Small loads: Johnson 1985, equation 5.57, with 4 G for the plane strain modulus.

    Parameters
    ----------
    squeeze : float
        Approach of the plates over the diameter, small.
    shear : float
        Shear modulus G.

    Returns
    -------
    float
        Force over the diameter (stress units).
    """
    modulus, force = 4 * shear, 4 * shear * RADIUS * squeeze
    for _ in range(100):  # each half: R squeeze = P / (pi E*) (2 ln(4 R / a) - 1)
        halfwidth = math.sqrt(4 * force * RADIUS / (math.pi * modulus))
        logarithm = 2 * math.log(4 * RADIUS / halfwidth) - 1
        force = math.pi * modulus * RADIUS * squeeze / logarithm
    return force / (2 * RADIUS)


def NeoHooke(gradient, shear):
    """Isochoric neo-Hooke energy in plane strain, and the change of volume."""
    F = gradient + Id(2)
    J = Det(F)
    return shear / 2 * (J ** (-2 / 3) * (Trace(F.trans * F) + 1) - 3), J


def Rubber(*, h=4.0, squeeze=0.25, steps=5, poisson=0.4999, order=2, mixed=True):
    """Squeeze the cord.

    Parameters
    ----------
    h : float
        Edge length on the cord's arc (its radius is 50).
    squeeze : float
        Approach of the plates over the diameter of the cord.
    steps : int
        Number of equal steps.
    poisson : float
        Poisson's ratio, < 0.5.
    order : int
        Of the displacement; the hydrostatic pressure has one less and is continuous.
    mixed : bool
        With the hydrostatic pressure as unknown; else the displacement alone, which locks.

    Returns
    -------
    Result
        The shear modulus is 1; ``curve`` has (squeeze, force over diameter) of each step.
    """
    if not 0 < poisson < 0.5:
        raise ValueError(f"poisson = {poisson} must lie between 0 and 0.5")
    shear = 1.0
    bulk = 2 * shear * (1 + poisson) / (3 * (1 - 2 * poisson))
    mesh = CordMesh(h)
    plate = "master|back"
    V = VectorH1(mesh, order=order, dirichletx=f"symx|{plate}", dirichlety=f"symy|{plate}")
    Q = LACSpace(V, slave="slave")
    X = V * H1(mesh, order=order - 1, definedon="rubber") * Q if mixed else V * Q
    (u, *p, lam), (v, *_) = X.TnT()
    isochoric, J = NeoHooke(Grad(u), shear)
    a = BilinearForm(X)
    volumetric = p[0] * (J - 1) - p[0] ** 2 / (2 * bulk) if mixed else bulk / 2 * (J - 1) ** 2
    a += Variation((isochoric + volumetric).Compile() * dx("rubber"))
    a += shear * InnerProduct(Sym(Grad(u)), Sym(Grad(v))) * dx("plate")  # is rigid: any will do
    contact = LACContact(u, lam, master="master", finite=True)
    gf, load = GridFunction(X), Parameter(0.0)
    solver = ContactSolver(a, gf, contact)
    stepper = LoadStepper(solver, load, prescribe={plate: CF((0, -RADIUS * load))})
    pressure = -gf.components[1] if mixed else -bulk * (Det(Grad(gf.components[0]) + Id(2)) - 1)
    result = Result(mesh, gf.components[0], contact, pressure, solver)
    result.curve.append((0.0, 0.0))

    def Record(step):
        result.curve.append((step.time, -float(contact.Force()[1]) / RADIUS))

    done = stepper.Integrate(end=squeeze, steps=steps, callback=Record, printing=False)
    result.figures = _RubberFigures(result, done, J=Det(Grad(gf.components[0]) + Id(2)))
    return result


def _RubberFigures(result, steps, J):
    mesh, table = result.mesh, result.contact.Table()
    rubber = mesh.Materials("rubber")
    volume = Integrate(CF(1), mesh, definedon=rubber)
    return {
        "squeeze": result.curve[-1][0],
        "force": result.curve[-1][1],
        "peak_pressure": float(table["pressure"].max()),
        "contact_area": float(table["area"][table["status"] > 0].sum()),
        "volume_change": Integrate(J - 1, mesh, definedon=rubber, order=6) / volume,
        "last_residuals": [entry.equilibrium for entry in result.solver.history],
        "newton_iterations": [step.iterations for step in steps],
        "cuts": sum(step.cuts for step in steps),
        "ndof": len(result.solver.gf.vec),
    }
