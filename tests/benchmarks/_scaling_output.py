"""Tables and the picture of `scaling.py`."""

from __future__ import annotations

from _scaling_runs import KINDS, Growth

TITLES = {
    "patch": "two blocks, tetrahedra",
    "patch_hex": "two blocks, hexahedra",
    "sphere": "sphere on block",
    "hertz": "Hertz, 2D",
}
NAMES = {
    "elastic": "elastic solve",
    "frictionless": "frictionless",
    "friction": "friction, one step",
    "ten_steps": "friction, ten steps",
}


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


def ByKind(rows):
    """Nested: (problem, size) -> kind -> row."""
    table = {}
    for row in rows:
        table.setdefault((row.problem, row.size), {})[row.kind] = row
    return table


def Markdown(rows):
    """The table of the README."""
    head = ["problem", "dofs", "elastic solve [s]"]
    head += [f"{NAMES[kind]} [s]" for kind in KINDS]
    head += ["Newton", "pairing, contact", "memory, elastic / contact [GB]"]
    lines = ["| " + " | ".join(head) + " |", "|---" * len(head) + "|"]
    for (problem, size), kinds in sorted(
        ByKind(rows).items(), key=lambda item: (list(TITLES).index(item[0][0]), item[0][1])
    ):
        lines.append("| " + " | ".join(_Cells(problem, size, kinds)) + " |")
    return "\n".join(lines) + "\n"


def _Cells(problem, size, kinds):
    elastic = kinds.get("elastic")
    contact = [kinds[kind] for kind in KINDS if kind in kinds]
    cells = [TITLES[problem], str(next(iter(kinds.values())).ndof) if kinds else str(size)]
    cells.append(f"{elastic.wall:.3g}" if elastic else "-")
    for kind in KINDS:
        cells.append(_Seconds(kinds.get(kind), elastic))
    cells.append(", ".join(str(sum(row.iterations)) for row in contact) or "-")
    cells.append(f"{100 * max(row.share for row in contact):.1f} %" if contact else "-")
    memory = f"{elastic.memory:.2f}" if elastic else "-"
    most = f"{max(row.memory for row in contact):.2f}" if contact else "-"
    return [*cells, f"{memory} / {most}"]


def _Seconds(row, elastic):
    """Seconds, and their multiple of the elastic solve."""
    if row is None:
        return "-"
    return f"{row.wall:.3g}" + (f" ({row.wall / elastic.wall:.1f}x)" if elastic else "")


def Picture(rows, file):
    """Time and memory over dofs, both logarithmic: a column for each problem."""
    import matplotlib

    matplotlib.use("Agg")
    from matplotlib import pyplot as plt

    problems = [name for name in TITLES if any(row.problem == name for row in rows)]
    figure, all_axes = plt.subplots(
        2,
        len(problems),
        figsize=(1.5 + 3.6 * len(problems), 7),
        sharex=True,
        sharey="row",
        squeeze=False,
        layout="constrained",
    )
    for column, problem in enumerate(problems):
        own = [row for row in rows if row.problem == problem]
        for axes, quantity in zip(all_axes[:, column], ("wall", "memory"), strict=True):
            _Curves(axes, own, quantity)
        all_axes[0, column].set_title(TITLES[problem])
        all_axes[1, column].set_xlabel("displacement dofs n")
    all_axes[0, 0].set_ylabel("wall time [s]")
    all_axes[1, 0].set_ylabel("peak memory [GB]")
    dofs = [row.ndof for row in rows]
    all_axes[0, 0].set_xlim(min(dofs) / 2, max(dofs) * 2)
    figure.suptitle("Contact beside one linear elastic solve, second order")
    figure.savefig(file, dpi=150)
    plt.close(figure)


def _Curves(axes, rows, quantity):
    for number, (kind, style) in enumerate(zip(NAMES, ("s--", "o-", "^-", "D-"), strict=True)):
        own = sorted((row for row in rows if row.kind == kind), key=lambda row: row.ndof)
        if not own:
            continue
        dofs, values = [r.ndof for r in own], [getattr(r, quantity) for r in own]
        slope = f", $n^{{{Growth(dofs, values):.2f}}}$" if len(own) > 1 else ""
        color = f"C{number - 1}" if number else "black"
        axes.loglog(dofs, values, style, color=color, label=NAMES[kind] + slope)
    axes.grid(which="both", alpha=0.3)
    axes.legend(loc="best", fontsize="small")
