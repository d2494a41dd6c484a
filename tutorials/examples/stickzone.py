"""A sphere that is moved tangentially, against the exact solutions: frame of two examples."""

from dataclasses import dataclass, field

import numpy as np
from command import Count, Main, NotNegative, Picture, Positive
from movedsphere import OPEN, SLIP, STICK, Model
from ngsolve import VTKOutput
from scipy.optimize import minimize_scalar
from slavefaces import SlaveFaces

FIRST = 0.01  # of the load that makes all slip: a first step, which tells the stiffness before slip


@dataclass
class Results:
    """The figures, the model with its states, the exact solutions of the loads of the steps."""

    problem: object
    exact: list = field(default_factory=list)
    figures: dict = field(default_factory=dict)

    def __post_init__(self):
        self.model = Model(self.problem)
        self.faces = SlaveFaces(self.model.mesh, self.model.contact.space.macros)

    @property
    def states(self):
        """The states of the tangential load, without the first small step."""
        return self.model.states[self.problem.press + 1 :]


def TractionMeans(faces, exact):
    """Exact tractions (m, 2) averaged over the macro-elements.

    `exact` has a `MeanTraction`, of one component (along x) or two.
    """
    values = np.asarray(exact.MeanTraction(faces.corners))
    if values.ndim == 1:
        values = np.column_stack([values, np.zeros_like(values)])
    return faces.Means(values)


def Misfit(faces, state, exact):
    """Distance of the tractions to the exact means in the L2 norm, relative to the latter."""
    means, w = TractionMeans(faces, exact), state.area[:, None]
    return float(np.sqrt((w * (state.traction - means) ** 2).sum() / (w * means**2).sum()))


def FittedRatio(faces, state, Exact):
    """Stick ratio of the solution that fits the tractions best.

    ``Exact(part)`` is the solution at a part (0, 1) of the load that makes all slip.
    """

    def Distance(part):
        difference = state.traction - TractionMeans(faces, Exact(part))
        return (state.area[:, None] * difference**2).sum()

    best = minimize_scalar(Distance, bounds=(0, 1), method="bounded", options={"xatol": 1e-3})
    return Exact(best.x).ratio


def Row(results, step, Exact=None):
    """Figures of a step: its stick zone and tractions against the exact solution.

    With `Exact`, as in `FittedRatio`, also the stick radius that fits the tractions.
    """
    faces, state, exact = results.faces, results.states[step], results.exact[step]
    a = results.problem.Hertz(state.force[2]).contact_radius
    return {
        "stick_ratio": state.Radius(STICK) / a,
        "stick_ratio_fit": FittedRatio(faces, state, Exact) if Exact else None,
        "stick_ratio_exact": exact.ratio,
        "contact_ratio": state.Radius(STICK, SLIP) / a,
        "traction_misfit": Misfit(faces, state, exact),
        "open": int(np.sum(state.status == OPEN)),
        "stick": int(np.sum(state.status == STICK)),
        "slip": int(np.sum(state.status == SLIP)),
        "iterations": state.iterations,
    }


def Summary(model, rows):
    """What both examples put into the JSON file."""
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
        "steps": rows,
    }


def Example(name, Solve, text, problem, models, *, load, columns, told, curves, **options):
    """The ``main`` of an example whose results are ``Solve(callback, **options)``.

    ``load(state)`` is printed in each step, and then the figures `columns` of the steps and `told`
    of all; `curves` are pairs of names to draw, computed and exact; `problem` has the defaults.
    """

    def Tell(state):
        print(f"  {load(state)}   {state.iterations} Newton iterations", flush=True)

    def Run(*, out, quiet, smooth=False, **chosen):
        results = Solve(None if quiet else Tell, rough=not smooth, **chosen)
        figures = results.figures
        if not quiet:
            print(Table(columns, figures["steps"]))
            for key in ("stiffness_ratio", *told, "stick_error", "stick_fit_error"):
                print(f"{key.replace('_', ' '):<20}{figures[key]:.4f}")
        if out:
            Write(results, out, name, *curves)
        return figures

    return Main(Run, text, problem, **Choices(*models), **options)


def Table(names, rows):
    """Figures of the steps as text."""
    lines = ["  ".join(f"{name:>9}" for name in names)]
    for row in rows:
        cells = ("-" if row[name] is None else format(row[name], ".4g") for name in names)
        lines.append("  ".join(f"{c:>{max(9, len(n))}}" for c, n in zip(cells, names, strict=True)))
    return "\n".join(lines)


def Choices(*models):
    """Options of the command line that both have."""
    return {
        "model": (models, "part that is computed"),
        "elements": (Positive, "element edges along the contact radius"),
        "order": ((1, 2, 3), "order of the displacement"),
        "stabilize": (("none", "bubble"), "how macro-elements are made"),
        "friction": (Positive, "coefficient of friction"),
        "nu": (NotNegative, "Poisson's ratio"),
        "steps": (Count, "steps of the tangential load"),
        "smooth": (bool, "no friction while pressing"),
    }


def Write(results, out, name, curve, exact):
    """The curve, the tractions, and files for ParaView: bodies and slave faces.

    `curve` and `exact` are pairs of names of figures of the steps.
    """
    model, rows, state = results.model, results.figures["steps"], results.states[-1]
    hertz, friction = model.problem.Hertz(state.force[2]), model.problem.friction
    r = np.linspace(0, 1.2 * hertz.contact_radius, 300)
    along = {"along": lambda points: np.hypot(points[:, 0], points[:, 1])}
    with Picture(out, name, columns=2, size=(9, 3.6)) as (left, right):
        for (x, y), style, label in ((exact, "k-", "exact"), (curve, "o", "computed")):
            left.plot([0, *(r[x] for r in rows)], [0, *(r[y] for r in rows)], style, label=label)
        left.set(xlabel=curve[0].replace("_", " "), ylabel=curve[1].replace("_", " "))
        model.contact.Plot("traction", label="traction", axes=right, **along)
        exact = "friction times Hertz' pressure"
        right.plot(r, friction * hertz.Pressure(r), "k", lw=0.9, label=exact)
        right.set(xlabel="distance from the middle [mm]", ylabel="tangential traction [MPa]")
        left.legend()
        right.legend()
    fields = [model.displacement, model.problem.Stress(model.displacement)]
    VTKOutput(model.mesh, fields, ["displacement", "stress"], str(out / name), subdivision=1).Do()
    model.contact.WriteVTU(out / f"{name}_contact.vtu", displacement=model.displacement)
