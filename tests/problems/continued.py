"""Computations that are saved half way: run in a process of its own to continue them.

``python continued.py FOLDER`` makes each problem again, loads its state from FOLDER, does the
second half and writes the end values there.
"""

import sys

import numpy as np
from flights import on_slab
from motions import on_ground, values
from netgen.occ import MoveTo, OCCGeometry
from ngsolve import CF, IfPos, InnerProduct, Mesh, ds, y
from press import press

from ngslac import LoadMesh, LoadState, LoadStepper, TimeStepper

# Pardiso's results depend on where its memory lies, so that two runs of the same script differ.
INVERSE = "umfpack"


def driven(mesh, springs, **flags):
    """A press from load 0, driven by `springs(u, v, load)`; on its own mesh if none is given."""
    problem = press(change=lambda fresh: mesh or fresh, spring=0, **flags)
    problem.load.Set(0.0)
    u, v = problem.X.TrialFunction()[0], problem.X.TestFunction()[0]
    problem.a += springs(u, v, problem.load)
    return LoadStepper(problem.solver(inverse=INVERSE), problem.load)


def loading(mesh=None, *, nonlinear=True, friction=0.3, **law):
    """A block pushed down and aside on another one; the parameter is the load."""

    def springs(u, v, load):  # down first, then aside, so that what was stuck begins to slip
        return 400 * InnerProduct(u - load * CF((0.1 * load, -0.05)), v) * ds("top")

    flags = {"h": 0.3, "mesh_flags": {"structured": False}, "nonlinear": nonlinear}
    return driven(mesh, springs, friction=friction, **flags, **law)


def slotted(h=0.35, width=0.08):
    """A square with a slot from the left."""
    square = MoveTo(-1, -1).Rectangle(2, 2).Face()
    shape = square - MoveTo(-1.5, -width / 2).Rectangle(2, width).Face()
    shape.edges.name = "outside"
    for edge in shape.edges:
        if abs(edge.center.y) < 0.5 and abs(edge.center.x) < 0.9:
            edge.name = "slave"
    return Mesh(OCCGeometry(shape, dim=2).GenerateMesh(maxh=h))


def squeezed(mesh=None):
    """The slot is closed, and its sides slide: self-contact."""

    def springs(u, v, load):
        above, below = (IfPos(side * y - 0.999, 1200, 0) for side in (1, -1))
        at = load * CF((0.1 * load, -0.4))
        return (above * InnerProduct(u - at, v) + below * InnerProduct(u, v)) * ds("outside")

    law = {"master": "slave", "friction": 0.3, "finite": True}
    return driven(mesh or slotted(), springs, nonlinear=True, flags={"dirichlet": ""}, **law)


def bouncing(mesh=None, **flags):
    """A block thrown at the ground."""
    given = {"gap": 0.05, "gravity": 1.0, "friction": 0.4, "dt": 0.04, "rho_inf": 0.9}
    motion = on_ground(mesh=mesh, inverse=INVERSE, divisions=(3, 3), **given, **flags)
    return (motion if mesh else motion.throw(0.6, -0.8)).stepper


def flying(mesh=None):
    """A soft disc thrown at a soft slab, in large sliding."""
    flags = {"young": 15.0, "friction": 0.3, "dt": 0.05, "rho_inf": 0.9, "inverse": INVERSE}
    return on_slab((0.4, -1), mesh=mesh, h=0.6, **flags).stepper


MAKE = {
    "loading": loading,
    "linear": lambda mesh=None: loading(mesh, nonlinear=False, friction=0.6),
    "finite": lambda mesh=None: loading(mesh, finite=True),
    "squeezed": squeezed,
    "bouncing": bouncing,
    "flying": flying,
}


def half(stepper, part=1):
    """The first or second half of the way, to 0.5 or to 1."""
    flags = {"steps": 3} if isinstance(stepper, LoadStepper) else {}
    stepper.Integrate(0.5 * part, printing=False, **flags)
    return stepper


def outcome(stepper):
    """All end values as numpy arrays."""
    (contact,) = stepper.solver.contacts
    found = contact.Table() | {"reference": contact.form.Table()["reference"].ravel()}
    found["gf"] = values(stepper.solver.gf)
    found["numbers"] = np.array([step.number for step in stepper.steps])
    if isinstance(stepper, TimeStepper):
        found["velocity"] = values(stepper.velocity)
        found |= {f"energy_{name}": rows for name, rows in stepper.Table().items()}
    return found


def main(folder):
    for kind, make in MAKE.items():
        stepper = make(LoadMesh(f"{folder}/{kind}"))
        LoadState(f"{folder}/{kind}", stepper)
        np.savez(f"{folder}/{kind}.npz", **outcome(half(stepper, 2)))


if __name__ == "__main__":
    main(*sys.argv[1:])
