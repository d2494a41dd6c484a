"""A contact problem in a few lines, and the numbers of its solution that are compared."""

from dataclasses import dataclass
from inspect import isfunction

import numpy as np
from ngsolve import (
    BilinearForm,
    Grad,
    GridFunction,
    Id,
    InnerProduct,
    Integrate,
    Parameter,
    Sym,
    Variation,
    VectorH1,
    dx,
)

from ngslac import ContactSolver, LACContact, LACSpace
from ngslac.materials import NeoHooke, Stress

TOL = 1e-12  # of Newton's method: too small for its last error to show in comparisons
QUIET = {"printing": False, "tol": TOL}


@dataclass
class Problem:
    """The objects of a contact problem; `load` is the parameter of the load steps."""

    mesh: object
    X: object
    a: object
    gf: object
    contacts: list
    load: object

    @property
    def u(self):
        return self.gf.components[0]

    def solver(self, **options):
        return ContactSolver(self.a, self.gf, self.contacts, **options)


def linear(u, v, young):
    return InnerProduct(Stress(Sym(Grad(u)), young, 0.3), Sym(Grad(v))) * dx


def rubber(u, v, young):
    return Variation(NeoHooke(Id(u.dim) + Grad(u), young, 0.3).Compile() * dx)


def problem(
    mesh,
    pairs=None,
    *,
    order=2,
    bulk=linear,
    young=None,
    flags=None,
    condense=False,
    axisymmetric=False,
    **law,
):
    """Bodies that are held at "bottom" and "top"; `pairs` has the options of each slave.

    `flags` go to the displacement space, `law` to each contact. A function in `law` gets the load.
    """
    pairs = {"slave": {}} if pairs is None else pairs
    held = {"dirichlet": "bottom|top"} if flags is None else flags
    V = VectorH1(mesh, order=order, **held)
    X = V
    for slave in pairs:
        X = X * LACSpace(V, slave=slave, axisymmetric=axisymmetric)
    (u, *lams), (v, *_) = X.TnT()
    a, load = BilinearForm(X, condense=condense), Parameter(0.0)
    a += bulk(u, v, mesh.MaterialCF(young or {}, default=100.0))
    law = {key: value(load) if isfunction(value) else value for key, value in law.items()}
    law = law if "obstacle" in law else {"master": "master"} | law
    contacts = [
        LACContact(u, lam, **(law | pairs[slave])) for lam, slave in zip(lams, pairs, strict=True)
    ]
    return Problem(mesh, X, a, GridFunction(X), contacts, load)


def results(made, **more):
    """name -> (numbers, size to which their errors are relative; None: the size of the numbers)."""
    found = {name: (value, None) for name, value in more.items()}
    size = 0.0
    for material in dict.fromkeys(made.mesh.GetMaterials()):
        body, u = made.mesh.Materials(material), made.u
        volume = Integrate(1, made.mesh, definedon=body)
        square = Integrate(InnerProduct(u, u), made.mesh, definedon=body)
        size = max(size, (square / volume) ** 0.5)
        found[f"u of {material}"] = Integrate(u, made.mesh, definedon=body), size * volume
        found[f"u.u of {material}"] = square, size**2 * volume
    for k, contact in enumerate(made.contacts):
        found |= {f"{name} {k}": value for name, value in of_contact(contact, size).items()}
    return found


def of_contact(contact, size):
    """Fields and resultants; the size of gaps is that of the displacements."""
    table = contact.Table()
    force = contact.Force()
    whole = float(np.linalg.norm(force)) or 1.0
    return {name: (table[name], None) for name in ("x", "normal", "area", "status", "traction")} | {
        "pressure": (table["pressure"], float(np.abs(table["traction"]).max())),
        "gap": (table["gap"], size),
        "force": (force, whole),
        "moment": (contact.Moment(), whole),
    }
