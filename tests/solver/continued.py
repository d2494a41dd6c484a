"""Computations that are saved half way: run in a process of its own to continue them.

``python continued.py FOLDER`` makes each problem again, loads its state from FOLDER, does the
second half and writes the end values there.
"""

import sys

import numpy as np
from motions import elastic, neo_hooke, on_ground, values
from netgen.occ import MoveTo, OCCGeometry
from ngsolve import (
    CF,
    BilinearForm,
    GridFunction,
    IfPos,
    InnerProduct,
    Mesh,
    Parameter,
    Variation,
    VectorH1,
    ds,
    dx,
    y,
)

from ngslac import ContactSolver, LACContact, LACSpace, LoadStepper
from ngslac.meshes import TwoBlocks
from ngslac.steps.restart import LoadMesh, LoadState
from ngslac.steps.time import TimeStepper

# Pardiso's results depend on where its memory lies, so that two runs of the same script differ.
INVERSE = "umfpack"


def loading(mesh=None, *, finite=False, nonlinear=True, **law):
    """A block pushed down and aside on another one; the parameter is the load."""
    mesh = mesh or TwoBlocks(0.3, overhang=0.3)
    V = VectorH1(mesh, order=2, dirichlet="bottom")
    X = V * LACSpace(V, slave="slave")
    (u, lam), (v, _) = X.TnT()
    load = Parameter(0.0)
    a = BilinearForm(X)
    a += Variation(neo_hooke(u, 10.0).Compile() * dx) if nonlinear else elastic(u, v, 10.0)
    # Down first, then aside, so that what was stuck begins to slip.
    at = CF((0.1 * load * load, -0.05 * load))
    a += 100 * InnerProduct(u - at, v) * ds("top")
    law = {"friction": 0.3} | ({"finite": True} if finite else {}) | law
    contact = LACContact(u, lam, master="master", **law)
    solver = ContactSolver(a, GridFunction(X), contact, inverse=INVERSE)
    return LoadStepper(solver, load)


def slotted(h=0.35, width=0.08):
    """A square with a slot from the left."""
    square = MoveTo(-1, -1).Rectangle(2, 2).Face()
    shape = square - MoveTo(-1.5, -width / 2).Rectangle(2, width).Face()
    shape.edges.name = "outside"
    for edge in shape.edges:
        if abs(edge.center.y) < 0.5 and abs(edge.center.x) < 0.9:
            edge.name = "slot"
    return Mesh(OCCGeometry(shape, dim=2).GenerateMesh(maxh=h))


def squeezed(mesh=None):
    """The slot is closed, and its sides slide: self-contact."""
    mesh = mesh or slotted()
    V = VectorH1(mesh, order=2)
    X = V * LACSpace(V, slave="slot")
    (u, lam), (v, _) = X.TnT()
    load = Parameter(0.0)
    a = BilinearForm(X)
    a += Variation(neo_hooke(u, 10.0).Compile() * dx)
    above, below = (IfPos(side * y - 0.999, 300, 0) for side in (1, -1))
    at = CF((0.1 * load * load, -0.4 * load))
    a += (above * InnerProduct(u - at, v) + below * InnerProduct(u, v)) * ds("outside")
    contact = LACContact(u, lam, master="slot", friction=0.3, finite=True)
    return LoadStepper(ContactSolver(a, GridFunction(X), contact, inverse=INVERSE), load)


def bouncing(mesh=None, *, rho_inf=0.9):
    """A block thrown at the ground."""
    motion = on_ground(
        mesh=mesh,
        inverse=INVERSE,
        gap=0.05,
        gravity=1.0,
        friction=0.4,
        dt=0.04,
        rho_inf=rho_inf,
        divisions=(3, 3),
    )
    if mesh is None:
        motion.throw(0.6, -0.8)
    return motion.stepper


MAKE = {
    "loading": loading,
    "linear": lambda mesh=None: loading(mesh, nonlinear=False, friction=0.6),
    "finite": lambda mesh=None: loading(mesh, finite=True),
    "squeezed": squeezed,
    "bouncing": bouncing,
}


def half(stepper, part):
    """The first or second half of the way, to 0.5 or to 1."""
    if isinstance(stepper, LoadStepper):
        stepper.Integrate(0.5 * part, steps=3, printing=False)
    else:
        stepper.Integrate(0.5 * part, printing=False)
    return stepper


def outcome(stepper):
    """All end values as numpy arrays."""
    table = stepper.solver.contacts[0].Table()
    found = {
        "gf": values(stepper.solver.gf),
        "numbers": np.array([s.number for s in stepper.steps]),
    }
    if isinstance(stepper, TimeStepper):
        found["velocity"] = values(stepper.velocity)
        found |= {f"energy_{name}": rows for name, rows in stepper.Table().items()}
    return found | table | {"reference": stepper.solver.contacts[0].form.Vectors("reference")}


def main(folder):
    for kind, make in MAKE.items():
        stepper = make(LoadMesh(f"{folder}/{kind}"))
        LoadState(f"{folder}/{kind}", stepper)
        np.savez(f"{folder}/{kind}.npz", **outcome(half(stepper, 2)))


if __name__ == "__main__":
    main(*sys.argv[1:])
