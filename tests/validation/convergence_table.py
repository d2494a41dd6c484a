"""Table and picture of the convergence rates: python tests/validation/convergence_table.py

Two elastic bodies, non-matching meshes, exact solution with the square root singularity of the
pressure at the end of the contact (see signorini.py). The rates are averages over the last two
halvings of the mesh size, because single ones depend on where that end lies in its macro-element.
H1 is measured in the energy norm; "means" compares with the averages of the exact pressure over the
macro-elements.
"""

import argparse
from pathlib import Path

from elasticity import NAMES
from signorini import Measure, Rates

COLUMNS = {"energy": "H1", "l2": "L2", "traction": "L2", "mean": "means"}
SLOPES = {"energy": (1.0, 1.5), "l2": (2.0, 2.5), "traction": (1.0,), "mean": (1.0,)}
STYLE = {
    "P1": ("#1b6ca8", "o"),
    "P1split": ("#c1440e", "s"),
    "P1bubble": ("#3a7d44", "^"),
    "P2": ("#7b4b94", "D"),
    "P3": ("#444444", "v"),
}


def Line(kind, errors, steps):
    """One row of the table."""
    e = errors[-1]
    values = "".join(f"{getattr(e, name):11.2e}" for name in COLUMNS)
    rates = ""
    if len(errors) > steps:
        rates = "".join(f"{Rates(errors, name, steps):8.2f}" for name in COLUMNS)
    return f"{NAMES[kind]:22s}{e.n:5d}{values}{rates or 32 * ' '}{e.iterations:6d}"


def Table(levels, kinds, steps=2):
    """Compute and print; returns the errors by kind."""
    groups = [("", 27), ("relative errors", 44), (f"rates over {steps} halvings", 32)]
    print("".join(f"{title:^{width}s}" for title, width in groups))
    groups = [("", 27), ("displacement", 22), ("multiplier", 22)]
    groups += [("displacement", 16), ("multiplier", 16)]
    print("".join(f"{title:^{width}s}" for title, width in groups))
    errors = "".join(f"{head:>11s}" for head in COLUMNS.values())
    rates = "".join(f"{head:>8s}" for head in COLUMNS.values())
    print(f"{'N':>27s}{errors}{rates}{'iter.':>6s}")
    results = {}
    for kind in kinds:
        results[kind] = []
        for n in levels:
            results[kind].append(Measure(n, kind))
            print(Line(kind, results[kind], steps), flush=True)
    return results


def Picture(results, file):
    """Errors over the mesh size, both logarithmic, with triangles' slopes as dashed lines."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(10.5, 3.9), layout="constrained")
    titles = {
        "energy": "displacement, H1",
        "l2": "displacement, L2",
        "traction": "multiplier, L2",
    }
    for ax, (name, title) in zip(figure.subplots(1, 3), titles.items(), strict=True):
        for kind, errors in results.items():
            h = [1 / e.n for e in errors]
            values = [getattr(e, name) for e in errors]
            colour, marker = STYLE[kind]
            ax.loglog(h, values, color=colour, marker=marker, ms=5, lw=1.4, label=NAMES[kind])
        Slopes(ax, results, name)
        Axes(ax, title, h)
    figure.axes[0].set_ylabel("relative error")
    handles = figure.axes[0].get_legend_handles_labels()
    figure.legend(*handles, loc="outside lower center", ncols=len(results), frameon=False)
    figure.savefig(file, dpi=150)


def Slopes(ax, results, name):
    """Dashed lines of the expected rates below the curves."""
    everything = [e for errors in results.values() for e in errors]
    ends = min(1 / e.n for e in everything), max(1 / e.n for e in everything)
    ordered = sorted(results.values(), key=lambda errors: getattr(errors[-1], name))
    curves = [ordered[0]] if len(SLOPES[name]) == 1 else [ordered[-1], ordered[0]]
    for slope, errors in zip(SLOPES[name], curves, strict=True):
        shift = 0.55 * min(getattr(e, name) * e.n**slope for e in errors)
        ax.loglog(ends, [shift * h**slope for h in ends], color="0.55", lw=0.9, ls=(0, (5, 3)))
        at = (ends[0] * ends[1]) ** 0.5
        text = f"rate {slope:g}"
        ax.annotate(
            text,
            (at, shift * at**slope),
            (3, -4),
            textcoords="offset points",
            color="0.4",
            fontsize=8,
            va="top",
        )


def Axes(ax, title, h):
    ax.set_title(title, fontsize=10)
    ax.set_xlabel("mesh size over the length of the interface")
    ax.set_xticks(h, [f"1/{round(1 / value)}" for value in h])
    ax.minorticks_off()
    ax.grid(color="0.9", lw=0.6)


def main(argv=None):
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--levels", type=int, default=4, help="number of meshes, from N = 8 on")
    parser.add_argument("--kinds", nargs="+", choices=NAMES, default=list(NAMES))
    parser.add_argument("--out", default="convergence.png", help="file of the picture")
    options = parser.parse_args(argv)
    results = Table([8 * 2**k for k in range(options.levels)], options.kinds)
    Picture(results, Path(options.out))
    print(f"picture: {options.out}")


if __name__ == "__main__":
    main()
