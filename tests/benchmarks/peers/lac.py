"""ngslac in the comparison.

    python tests/benchmarks/peers/lac.py sphere sphere.npz --order 2 --json row.json

LAC's pressure is constant on each macro-element (2D, second order: one edge; second-order
tetrahedra: two triangles). In 2D the samples are these constants at the middles of the
macro-elements; in 3D they are projected in L2 to the continuous piecewise linear functions in which
the other peers' pressures are measured, the projection that NGSolve's own contact needs, too.

--variant plain (default)
    As a user would write it: `VectorH1` and a `LACSpace`, all options left alone.
--variant bubble
    `BubbleVectorH1`, which makes every slave face a macro-element.
"""

from __future__ import annotations

import inspect
import sys

from peercommand import Main, NotInstalledError

try:
    from elastic import (
        CornerProjection,
        Displacements,
        Errors,
        LoadVector,
        Read,
        Stress,
        Young,
    )
    from ngsolve import (
        H1,
        BilinearForm,
        Grad,
        GridFunction,
        InnerProduct,
        LinearForm,
        Parameter,
        Sym,
        TaskManager,
        ds,
        dx,
    )

    import ngslac
    from ngslac import BubbleVectorH1, ContactSolver, LACContact, LACSpace, LoadStepper
except ModuleNotFoundError as error:
    MISSING = error
else:
    MISSING = None
    BUBBLES = {"bubble": {"space": BubbleVectorH1, "slave": "slave"}}

__all__ = ["Solve"]


def Solve(peermesh, arguments, watch):
    """Solve a problem; see `peercommand.Main`."""
    if MISSING:
        raise NotInstalledError(f"{MISSING}: install ngslac (pip install -e .)")
    mesh = Read(arguments)
    with TaskManager():
        with watch.Running():
            solver, load = Model(peermesh, mesh, arguments)
            steps = LoadStepper(solver, load).Integrate(steps=arguments.steps, printing=False)
        contact = solver.contacts[0]
        return {
            "version": ngslac.__version__,
            "dofs": solver.gf.space.components[0].ndof,
            "iterations": sum(step.iterations for step in steps),
            "settings": Settings(solver.linear, arguments.variant),
            "macros": contact.space.nmacros,
            **Errors(peermesh, mesh, solver.gf.components[0], lambda: Pressure(mesh, contact)),
        }


def Settings(linear, variant):
    """What was used, for the notes."""
    library = "MKL" if "pardiso" in linear.inverse else "without MKL"
    factors = f"{linear.factorisations} factorisations"
    return f"{variant}; solver {linear.method}, {library}, {factors}; residuals below 1e-10"


def Model(peermesh, mesh, arguments):
    """The contact solver and the load parameter."""
    V = Displacements(mesh, arguments, **BUBBLES.get(arguments.variant, {}))
    fes = V * LACSpace(V, slave="slave")
    (u, lam), (v, _) = fes.TnT()
    bulk = BilinearForm(fes)
    bulk += InnerProduct(Stress(Sym(Grad(u)), Young(mesh), mesh.dim), Sym(Grad(v))) * dx
    contact = LACContact(u, lam, master="master", friction=arguments.friction or None)
    force, load = LoadVector(peermesh, fes, displacement=V), Parameter(0)
    chosen = {"inverse": arguments.inverse, "solver": arguments.solver}
    options = {name: value for name, value in chosen.items() if value is not None}
    if unknown := options.keys() - inspect.signature(ContactSolver).parameters:
        raise ValueError(f"this version's ContactSolver has no option {', '.join(unknown)}")
    gf = GridFunction(fes)
    rhs = lambda: (load.Get() * force).Evaluate()  # noqa: E731
    return ContactSolver(bulk, gf, contact, rhs=rhs, **options), load


def Pressure(mesh, contact):
    """Samples of the pressure for `Errors`."""
    if mesh.dim == 2:
        table = contact.Table()
        return table["x"][:, 0], table["pressure"]
    form = LinearForm(H1(mesh, order=1))
    form += contact.pressure * form.space.TestFunction() * ds("slave")
    return CornerProjection(mesh, form.Assemble().vec.FV().NumPy())


def Options(parser):
    """What only ngslac has."""
    parser.add_argument("--variant", choices=("plain", "bubble"), default="plain")
    parser.add_argument("--inverse", help="sparse direct solver; default: that of ContactSolver")
    parser.add_argument("--solver", help="kind of solver; default: that of ContactSolver")


if __name__ == "__main__":
    sys.exit(Main(Solve, peer="ngslac", options=Options))
