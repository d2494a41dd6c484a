"""ngslac in the comparison.

    python tests/benchmarks/peers/lac.py sphere sphere.npz --order 2 --json row.json

In 2D the samples of the pressure are those of the macro-elements at their middles, in 3D an L2
projection to continuous piecewise linear functions (README); there "recovered_l2" is the error of
`contact.Recovered().pressure`.

--variant plain (default)
    As a user would write it: `VectorH1` and a `LACSpace`, all options left alone.
--variant bubble
    `BubbleVectorH1`, which makes every slave face a macro-element.
"""

from __future__ import annotations

import sys

from elastic import CornerProjection, Displacements, Elastic, Errors, Loads, Read
from metrics import SphereFieldError, SpherePlaces
from ngsolve import (
    ET,
    H1,
    BilinearForm,
    GridFunction,
    IntegrationRule,
    LinearForm,
    Parameter,
    TaskManager,
    ds,
)
from peercommand import Main

import ngslac
from ngslac import BubbleVectorH1, ContactSolver, LACContact, LACSpace, LoadStepper

__all__ = ["Options", "Solve"]


def Solve(peermesh, arguments, watch):
    """Solve a problem; see `peercommand.Main`."""
    mesh = Read(arguments)
    with TaskManager():
        with watch.Running():
            solver, load = Model(peermesh, mesh, arguments)
            steps = LoadStepper(solver, load).Integrate(steps=arguments.steps, printing=False)
        contact, linear, u = solver.contacts[0], solver.linear, solver.gf.components[0]
        library = "MKL" if "pardiso" in linear.inverse else "without MKL"
        return {
            "version": ngslac.__version__,
            "dofs": u.space.ndof,
            "iterations": sum(step.iterations for step in steps),
            "settings": f"{arguments.variant}; solver {linear.method}, {library}, "
            f"{linear.factorisations} factorisations; residuals below 1e-10",
            "macros": contact.space.nmacros,
            **Errors(peermesh, mesh, u, lambda: Pressure(mesh, contact)),
            **Recovered(peermesh, mesh, contact),
        }


def Model(peermesh, mesh, arguments):
    bubbles = {"space": BubbleVectorH1, "slave": "slave"}
    V = Displacements(mesh, arguments, **(bubbles if arguments.variant == "bubble" else {}))
    fes = V * LACSpace(V, slave="slave")
    (u, lam), (v, _) = fes.TnT()
    bulk = BilinearForm(fes)
    bulk += Elastic(mesh, u, v)
    contact = LACContact(u, lam, master="master", friction=arguments.friction or None)
    force, load = Loads(peermesh, fes, V), Parameter(0)
    chosen = {"inverse": arguments.inverse, "solver": arguments.solver}
    options = {name: value for name, value in chosen.items() if value is not None}
    rhs = lambda: (load.Get() * force).Evaluate()  # noqa: E731
    return ContactSolver(bulk, GridFunction(fes), contact, rhs=rhs, **options), load


def Pressure(mesh, contact):
    """Samples of the pressure for `Errors`."""
    if mesh.dim == 2:
        table = contact.Table()
        return table["x"][:, 0], table["pressure"]
    form = LinearForm(H1(mesh, order=1))
    form += contact.pressure * form.space.TestFunction() * ds("slave")
    return CornerProjection(mesh, form.Assemble().vec.FV().NumPy())


def Recovered(peermesh, mesh, contact):
    """Error of the recovered pressure of the sphere, which is not linear on the faces."""
    if peermesh.problem != "sphere":
        return {}
    places = SpherePlaces()
    rule = IntegrationRule([tuple(place[:2]) for place in places], [0.0] * len(places))
    at = mesh.MapToAllElements({ET.TRIG: rule}, mesh.Boundaries("slave"))
    pressure = contact.Recovered().pressure(at).reshape(-1, len(places))
    faces = peermesh.Faces(1, "slave")
    return {"recovered_l2": SphereFieldError(peermesh.points, faces, pressure)}


def Options(parser):
    parser.add_argument("--variant", choices=("plain", "bubble"), default="plain")
    parser.add_argument("--inverse", help="sparse direct solver; default: that of ContactSolver")
    parser.add_argument("--solver", help="kind of solver; default: that of ContactSolver")


if __name__ == "__main__":
    sys.exit(Main(Solve, peer="ngslac", options=Options))
