"""What contact costs over one linear elastic solve, as the mesh gets finer.

Second-order problems: two blocks ("patch", "patch_hex") and a sphere on a block in 3D, without
friction, with friction 0.3 in one step, and in ten; Hertz' problem in 2D with friction 0.2 in ten
steps. Beside each one a linear elastic problem on the same mesh, both bodies held, assembled and
solved once: by the fastest direct solver at hand, and by the best solver of any kind, which is the
honest yardstick (mostly conjugate gradients with ngslac's own preconditioner; for elements of first
order also with PyAMG's smoothed aggregation).

    python tests/benchmarks/scaling.py --sizes 20000 100000 300000 --picture scaling.png
    python tests/benchmarks/scaling.py --sizes 1000000 --problems sphere --solver iterative

Each run has a process of its own, whose peak memory counts. The clock stands still while mesh and
spaces are made.
"""

from __future__ import annotations

import json
from dataclasses import dataclass, field, replace
from pathlib import Path

from benchmark_elastic import DIRECT, ITERATIVE, FastDirect, Fastest, Iterative
from benchmark_frame import Growth, InProcess, Markdown, Parser, Picture, WriteJSON
from benchmark_problems import SIZES, Problem
from benchmark_runs import SolveContact, SolveElastic

# Kind of run -> is there friction, number of load steps.
KINDS = {"frictionless": (False, 1), "friction": (True, 1), "ten_steps": (True, 10)}
ALL = ("elastic", *KINDS)
TITLES = {"patch": "two blocks, tetrahedra", "patch_hex": "two blocks, hexahedra"}
TITLES |= {"sphere": "sphere on block", "hertz": "Hertz, 2D"}
NAMES = {"elastic": "elastic, direct", "best": "elastic, best of any kind"}
NAMES |= {"frictionless": "frictionless", "friction": "friction, one step"}
NAMES |= {"ten_steps": "friction, ten steps"}
# Beyond, no direct solver has the memory to solve the elastic problem in three dimensions.
LARGEST_DIRECT = 500_000
SMALL = 30_000  # these are run three times
DEFAULT_SIZES = (20_000, 100_000, 300_000)


@dataclass(frozen=True)
class Row:
    """One run; times in seconds, memory in GB. What a kind of run does not have is None."""

    problem: str
    size: int  # as asked for
    kind: str  # of `KINDS`, or "elastic"
    ndof: int  # displacements
    wall: float
    cpu: float
    memory: float  # peak while solving, everything of the process
    inverse: str | None  # name of the elastic variant, method of the contact solver
    error: float  # force balance, or relative residual of the elastic solve
    macros: int | None = None
    iterations: list | None = None  # Newton, per step
    krylov: int | None = None
    factorisations: int | None = None
    phases: dict = field(default_factory=dict)  # seconds, see `benchmark_runs.CALLS`
    variants: dict = field(default_factory=dict)  # elastic: name -> wall, cpu, memory, error

    @property
    def share(self):
        """Pairing and contact assembly over the whole."""
        return (self.phases["pairing"] + self.phases["contact"]) / sum(self.phases.values())

    def Best(self):
        """Of an elastic row: that of the best solver of any kind."""
        name = Fastest(self.variants)
        return replace(self, kind="best", inverse=name, **self.variants[name])

    @property
    def isdirect(self):
        """Is this, an elastic row, that of a direct solver?"""
        return self.inverse not in ITERATIVE


# ---------------------------------------------------------------- runs


def ContactRun(name, size, kind, **options):
    """The `Row` of a contact problem; options of `ContactSolver` that are None count for none."""
    with_friction, steps = KINDS[kind]
    problem = Problem(name, size, with_friction * (0.2 if name == "hertz" else 0.3))
    options = {option: value for option, value in options.items() if value is not None}
    run = SolveContact(problem, problem.Mesh(), steps=steps, **options)
    return Row(
        problem=name,
        size=size,
        kind=kind,
        ndof=run.ndof,
        inverse=getattr(run.linear, "method", run.linear.inverse),
        error=run.error,
        macros=run.contact.space.nmacros,
        iterations=run.iterations,
        krylov=getattr(run.linear, "krylov", None),
        factorisations=getattr(run.linear, "factorisations", None),
        phases=run.phases,
        **run.figures,
    )


def Variants(space, size, inverse=None):
    """Names of the elastic solvers: direct ones, where these have the memory, then iterative ones.

    The direct ones are those of a solver, or the fast ones of this installation.
    """
    direct = FastDirect()
    if inverse is not None:
        named = [name for name, (solver, _) in DIRECT.items() if solver.startswith(inverse)]
        direct = named or [inverse]
    return [*(direct if size <= LARGEST_DIRECT else []), *Iterative(space)]


def ElasticRun(name, size, *, inverse=None, repeat=1):
    """Solve linear elasticity on the same mesh in each variant.

    The fastest direct one makes the `Row`, or the fastest of all where none is direct.
    """
    problem = Problem(name, size)
    mesh, tried = problem.Mesh(), {}
    for variant in Variants(problem.Space(mesh, both=True), size, inverse):
        runs = [SolveElastic(problem, mesh, variant) for _ in range(repeat)]
        ndof, tried[variant] = min(runs, key=lambda run: run[1]["wall"])
    best = Fastest({name: run for name, run in tried.items() if name not in ITERATIVE} or tried)
    return Row(name, size, "elastic", ndof, inverse=best, variants=tried, **tried[best])


def Measure(problem, size, kind, *, inverse=None, solver=None, repeat=None):
    """The fastest of `repeat` runs (by default 3 for small sizes, else 1), each in a new process.

    None if the processes were killed, most likely for lack of memory. `inverse` and `solver` are
    those of `ContactSolver`; the elastic problem takes the fastest variant of `inverse`.
    """
    repeat = repeat or (3 if size <= SMALL else 1)
    if kind == "elastic":
        return InProcess(ElasticRun, problem, size, inverse=inverse, repeat=repeat)
    options = {"inverse": inverse, "solver": solver}
    rows = [InProcess(ContactRun, problem, size, kind, **options) for _ in range(repeat)]
    return min((row for row in rows if row), key=lambda row: row.wall, default=None)


def Kinds(problem):
    if problem == "hertz":
        return ("elastic", "ten_steps")
    return ALL


def Runs(problems, sizes, kinds=ALL, **options):
    """Run all; prints each row as it comes."""
    for problem, size in ((p, s) for p in problems for s in sizes):
        for kind in (kind for kind in Kinds(problem) if kind in kinds):
            row = Measure(problem, size, kind, **options)
            killed = f"{problem:9} {size:8d}  {kind:12} was killed"
            print(Line(row) if row else killed, flush=True)
            if row:
                yield row


# ---------------------------------------------------------------- output


def Line(row):
    """One run in words and figures, for the terminal."""
    text = f"{row.problem:9} {row.ndof:8d}  {row.kind:12} {row.wall:8.2f} s, cpu {row.cpu:8.2f} s"
    text += f", {row.memory:6.2f} GB, {row.inverse}"
    if row.kind == "elastic":
        tried = (f"{name} {run['wall']:.2f} s" for name, run in row.variants.items())
        return f"{text} ({', '.join(tried)}), residual {row.error:.0e}"
    for title, value in (("Krylov", row.krylov), ("factorisations", row.factorisations)):
        text += "" if value is None else f", {title} {value}"
    newton = "+".join(str(n) for n in row.iterations)
    return f"{text}, Newton {newton}, contact {100 * row.share:.1f} %, balance {row.error:.0e}"


def Table(rows):
    """The table of the README: behind each time its ratios to both elastic solves."""
    head = ["problem", "dofs", "elastic, direct [s]", "elastic, best [s]"]
    head += [f"{NAMES[kind]} [s] (over direct, over best)" for kind in KINDS]
    head += ["Newton", "pairing, contact", "memory, direct / best / contact [GB]"]
    table = {}
    for row in sorted(rows, key=lambda row: (list(TITLES).index(row.problem), row.size)):
        table.setdefault((row.problem, row.size), {})[row.kind] = row
    cells = [Cells(problem, kinds) for (problem, _), kinds in table.items()]
    return "\n".join(Markdown(head, cells)) + "\n"


def Cells(problem, kinds):
    """Of one mesh; what was not run is a dash."""
    elastic, contact = kinds.get("elastic"), [row for kind, row in kinds.items() if kind in KINDS]
    direct = elastic if elastic and elastic.isdirect else None
    best = elastic.Best() if elastic else None

    def Seconds(row):
        over = [f"{row.wall / e.wall:.1f}" if e else "-" for e in (direct, best)] if row else []
        ratios = f" ({', '.join(over)})" if elastic else ""
        return f"{row.wall:.3g}{ratios}" if row else "-"

    cells = [TITLES[problem], str(next(iter(kinds.values())).ndof)]
    cells += [f"{row.wall:.3g}" if row else "-" for row in (direct, best)]
    cells += [Seconds(kinds.get(kind)) for kind in KINDS]
    cells.append(", ".join(str(sum(row.iterations)) for row in contact) or "-")
    cells.append(f"{100 * max(row.share for row in contact):.1f} %" if contact else "-")
    most = max((row.memory for row in contact), default=None)
    memory = [row.memory if row else None for row in (direct, best)] + [most]
    return [*cells, " / ".join("-" if m is None else f"{m:.2f}" for m in memory)]


def Draw(rows, file):
    """Time and memory over dofs, both logarithmic: a column for each problem."""
    names = [name for name in TITLES if any(row.problem == name for row in rows)]
    rows = [*rows, *(row.Best() for row in rows if row.kind == "elastic")]
    rows = [row for row in rows if row.kind != "elastic" or row.isdirect]
    size = {"figsize": (1.5 + 3.6 * len(names), 7), "sharex": True, "sharey": "row"}
    title = "Contact beside linear elastic solves, second order"
    quantities = {"wall": "wall time [s]", "memory": "peak memory [GB]"}
    with Picture(file, title, 2, len(names), **size) as all_axes:
        for line, (quantity, label) in zip(all_axes, quantities.items(), strict=True):
            line[0].set_ylabel(label)
            for axes, problem in zip(line, names, strict=True):
                Curves(axes, [row for row in rows if row.problem == problem], quantity)
                axes.set(title=TITLES[problem], xlabel="displacement dofs n")
        dofs = [row.ndof for row in rows]
        all_axes[0, 0].set_xlim(min(dofs) / 2, max(dofs) * 2)


def Curves(axes, rows, quantity):
    for number, (kind, style) in enumerate(
        zip(NAMES, ("s--", "x--", "o-", "^-", "D-"), strict=True)
    ):
        own = sorted((row for row in rows if row.kind == kind), key=lambda row: row.ndof)
        dofs, values = [r.ndof for r in own], [getattr(r, quantity) for r in own]
        slope = f", $n^{{{Growth(dofs, values):.2f}}}$" if len(own) > 1 else ""
        color = f"C{number - 2}" if number > 1 else ("black", "gray")[number]
        if own:
            axes.loglog(dofs, values, style, color=color, label=NAMES[kind] + slope)
    axes.grid(which="both", alpha=0.3)
    axes.legend(loc="best", fontsize="small")


def main(argv=None):
    parser = Parser(__doc__)
    add = parser.add_argument
    add("--sizes", type=int, nargs="+", default=DEFAULT_SIZES)
    add("--problems", nargs="+", choices=[*SIZES], default=["patch", "sphere", "hertz"])
    add("--kinds", nargs="+", choices=ALL, default=ALL, help="runs of each problem")
    add("--inverse", help="direct solver of contact and elastic problem")
    add("--solver", help="solver= of ContactSolver")
    add("--repeat", type=int, help="runs; the fastest counts")
    add("--load", metavar="FILE", nargs="+", default=[], help="rows of earlier runs; run none")
    add("--picture", metavar="FILE", help="draw time and memory over dofs")
    add("--markdown", metavar="FILE", help="write the table of the README")
    options = parser.parse_args(argv)
    rows = [Row(**row) for file in options.load for row in json.loads(Path(file).read_text())]
    if not options.load:
        for name, size in ((n, s) for n in options.problems for s in options.sizes):
            Problem(name, size).Parameters()  # complain now, not in an hour
        given = {name: getattr(options, name) for name in ("kinds", "inverse", "solver", "repeat")}
        rows = list(Runs(options.problems, options.sizes, **given))
    WriteJSON(options.json, rows)
    if options.markdown:
        Path(options.markdown).write_text(Table(rows))
    if options.picture:
        Draw(rows, options.picture)


if __name__ == "__main__":
    main()
