"""Figures of the friction problems in 3D: from the macro-elements to numbers and a table."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from ngsolve import BilinearForm, GridFunction, InnerProduct, LinearForm, Sym, ds, dx, sqrt, x, y
from ngsolve import Grad as Gradient
from scipy.optimize import minimize_scalar

from ._command import CommandParser
from ._friction3d import COPIES, OPEN, SLIP, STICK
from ._hertz3d_macros import Macros

__all__ = ["BulkCompliance", "Faces", "Parser", "Row", "Summary", "Table"]


@dataclass(frozen=True)
class Faces:
    """The slave faces of a model seen from above, and mean values on its macro-elements."""

    macros: Macros

    @classmethod
    def Of(cls, model):
        return cls(Macros(model.mesh, model.contact.space.macros))

    @property
    def areas(self):
        """Areas (n,) of the faces."""
        (ax, ay), (bx, by) = (
            np.moveaxis(c, -1, 0)
            for c in (self.macros.corners, np.roll(self.macros.corners, -1, axis=1))
        )
        return 0.5 * np.abs((ax * by - ay * bx).sum(axis=1))

    def Means(self, exact):
        """Exact tractions (n, 2) averaged over the macro-elements, from those over the faces.

        `exact` has a `MeanTraction`, of one component (along x) or two.
        """
        values = np.asarray(exact.MeanTraction(self.macros.corners))
        if values.ndim == 1:
            values = np.column_stack([values, np.zeros_like(values)])
        areas = self.areas
        sums = np.column_stack([self.macros.Sum(areas * v) for v in values.T])
        return sums / self.macros.Sum(areas)[:, None]

    @property
    def middle(self):
        """Centres (n, 2) of the macro-elements."""
        centres, areas = self.macros.corners[:, :3].mean(axis=1), self.areas
        sums = np.column_stack([self.macros.Sum(areas * c) for c in centres.T])
        return sums / self.macros.Sum(areas)[:, None]

    def Misfit(self, state, exact):
        """Distance of the tractions to the exact means in the L2 norm, relative to the latter."""
        means, w = self.Means(exact), state.area[:, None]
        return float(np.sqrt((w * (state.traction - means) ** 2).sum() / (w * means**2).sum()))

    def FittedRatio(self, state, Exact):
        """Stick ratio of the solution that fits the tractions best.

        ``Exact(part)`` is the solution at a part (0, 1) of the load that makes all slip.
        """

        def Distance(part):
            difference = state.traction - self.Means(Exact(part))
            return (state.area[:, None] * difference**2).sum()

        best = minimize_scalar(Distance, bounds=(0, 1), method="bounded", options={"xatol": 1e-3})
        return Exact(best.x).ratio


def BulkCompliance(model):
    """Displacement of the top along x per force, beyond that of two half-spaces.

    What finite bodies add to the displacement of half-spaces depends on the force alone, not on
    how its tractions are distributed in the small contact (de Saint-Venant). So it is computed
    with known ones, without contact: sqrt(1 - r^2/b^2) on the slave face, of radius b, and the
    opposite on the master side. From the mean displacement, with these weights, that of
    half-spaces is taken, 3 Q (2 - nu)/(20 G b) on each side for a force Q (integrated from
    Johnson, Contact Mechanics, 1985, equation 3.91a).
    """
    problem, V = model.problem, model.solution.space.components[0]
    radius = problem.zone * problem.contact
    left = 1 - (x * x + y * y) / radius**2
    density = sqrt(0.5 * (left + sqrt(left * left)))  # zero outside
    u, v = V.TnT()
    a = BilinearForm(InnerProduct(problem.Stress(u), Sym(Gradient(v))) * dx, symmetric=True)
    slave, master = (
        LinearForm(density * v[0] * ds(name, bonus_intorder=10)).Assemble().vec
        for name in ("slave", "master")
    )
    moved, unit = GridFunction(V), GridFunction(V)
    load = (slave - master).Evaluate()
    moved.vec.data = a.Assemble().mat.Inverse(V.FreeDofs(), inverse="sparsecholesky") * load
    unit.Set((1, 0, 0))
    copies = COPIES[problem.model]
    force = copies * unit.vec.InnerProduct(slave)
    mean = copies * moved.vec.InnerProduct(load) / force
    half_spaces = 2 * 3 * force * (2 - problem.nu) / (20 * problem.shear_modulus * radius)
    return float((mean - half_spaces) / force)


# ---------------------------------------------------------------- figures


def Row(faces, state, hertz, exact, Exact=None):
    """Figures of a state: its stick zone and tractions against the exact solution.

    With `Exact`, as in `Faces.FittedRatio`, also the stick radius that fits the tractions.
    """
    a = hertz.contact_radius
    stick = state.Radius(STICK)
    return {
        "stick_ratio": stick / a,
        "stick_ratio_fit": faces.FittedRatio(state, Exact) if Exact else None,
        "stick_ratio_exact": exact.ratio,
        "contact_ratio": state.Radius(STICK, SLIP) / a,
        "traction_misfit": faces.Misfit(state, exact),
        "open": int(np.sum(state.status == OPEN)),
        "stick": int(np.sum(state.status == STICK)),
        "slip": int(np.sum(state.status == SLIP)),
        "iterations": state.iterations,
    }


def Summary(model, rows, seconds):
    """What both demos put into the JSON file."""
    problem, hertz = model.problem, model.problem.Hertz(model.states[-1].force[2])
    iterations = [state.iterations for state in model.states]
    loading = [row for row in rows if row["stick_ratio_fit"] is not None]

    def Largest(name):
        return max(abs(row[name] - row["stick_ratio_exact"]) for row in loading)

    return {
        "stick_error": Largest("stick_ratio"),
        "stick_fit_error": Largest("stick_ratio_fit"),
        "contact_ratio": rows[-1]["contact_ratio"],
        "newton_iterations": iterations,
        "newton_max": max(iterations),
        "ndof": len(model.solution.vec),
        "macros": model.contact.space.nmacros,
        "seconds": seconds,
        "hertz": {"contact_radius": hertz.contact_radius, "peak": hertz.peak},
        "normal_force": float(model.states[-1].force[2]),
        "model": problem.model,
        "elements": problem.elements,
        "order": problem.order,
        "stabilize": problem.stabilize,
        "friction": problem.friction,
        "nu": problem.nu,
        "steps": rows,
    }


def Table(columns, rows):
    """Rows as text; `columns` has name -> (heading, format)."""
    lines = [" ".join(f"{heading:>11}" for heading, _ in columns.values())]
    for row in rows:
        cells = (
            "-" if row[name] is None else format(row[name], fmt)
            for name, (_, fmt) in columns.items()
        )
        lines.append(" ".join(f"{cell:>11}" for cell in cells))
    return "\n".join(lines)


# ---------------------------------------------------------------- command line


def Parser(name, text, problem):
    """Command line of a demo; `problem` is its class, which has the defaults."""
    parser = CommandParser(name, text)

    def Add(option, help, **options):
        default = getattr(problem, option)
        parser.add_argument(f"--{option}", default=default, help=f"{help} ({default})", **options)

    Add("model", "part that is computed", choices=tuple(COPIES))
    Add("elements", "element edges along the contact radius", type=float)
    Add("order", "order of the displacement", type=int, choices=(1, 2, 3))
    Add("stabilize", "how macro-elements are made", choices=("none", "bubble"))
    Add("friction", "coefficient of friction", type=float)
    Add("nu", "Poisson's ratio", type=float)
    parser.add_argument(
        "--smooth", dest="rough", action="store_false", help="no friction while pressing"
    )
    Add("steps", "steps of the tangential load", type=int)
    Add("inverse", "sparse direct solver, such as umfpack or pardiso")
    parser.add_argument("--out", metavar="DIR", help="write pictures, scenes and VTU files there")
    return parser
