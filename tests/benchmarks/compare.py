"""ngslac and other contact codes on the same meshes: accuracy beside time and memory.

    python tests/benchmarks/compare.py
    python tests/benchmarks/compare.py --problems sphere --sizes sphere=0.6,0.4 --markdown table.md

Each run has a process of its own and a time limit; what is not installed, or fails, is named below
its table. ngslac alone runs on other sizes, too (`--own`): a second table has each peer beside the
fastest of its runs with no larger error. The drivers and what they measure: `peers/README.md`.
"""

from __future__ import annotations

import json
import os
import platform
import signal
import subprocess
import sys
from dataclasses import dataclass
from datetime import date
from pathlib import Path
from tempfile import TemporaryDirectory

from benchmark_frame import Markdown, Parser, WriteJSON
from equal_accuracy import MatchTable

__all__ = ["CASES", "PEERS", "Case", "Missing", "Peer", "Run", "main"]

FOLDER = Path(__file__).parent / "peers"
MISSING = 3  # exit code of a peer that is not installed


@dataclass(frozen=True)
class Peer:
    """A program: its title, its script in `peers/`, options, and what it cannot do."""

    title: str
    script: str
    options: tuple = ()
    linear: tuple = ()  # cases that it solves with first-order elements only
    cannot: tuple = ()  # cases that it does not solve at all
    only: tuple = ()  # the cases where it differs from the peer before; empty: all


@dataclass(frozen=True)
class Case:
    """A problem: its title, mesh, size of the slave faces in mm, figures, options for the peers.

    What makes runs of equal accuracy: the `decisive` errors, the `floor` below which they say
    nothing (see `equal_accuracy`), and the sizes at which ngslac alone runs (`own`).
    """

    title: str
    problem: str
    size: float
    errors: tuple
    options: tuple = ()
    decisive: tuple = ("l2",)
    floor: float = 0.0
    own: tuple = ()


@dataclass(frozen=True)
class Missing:
    """A run without a result, and why."""

    title: str
    h: float
    reason: str


BOUNDARY, NITSCHE = "contactboundary.py", ("--variant", "nitsche")
ALL = ("hertz", "friction", "patch", "sphere")
PEERS = {
    "ngslac": Peer("ngslac", "lac.py"),
    "first": Peer("ngslac, first order", "lac.py", linear=ALL),  # beside Kratos
    "bubble": Peer("ngslac, bubbles", "lac.py", ("--variant", "bubble"), only=("sphere",)),
    "penalty": Peer("ContactBoundary, penalty", BOUNDARY),
    "nitsche": Peer("ContactBoundary, Nitsche", BOUNDARY, NITSCHE, cannot=("friction",)),
    "calculix": Peer("CalculiX, surface to surface", "calculix.py"),
    "mortar": Peer("CalculiX, mortar", "calculix.py", ("--variant", "mortar")),
    "kratos": Peer("Kratos, ALM mortar", "kratos.py", linear=ALL),
    "getfem": Peer("GetFEM, ALM", "getfem_peer.py"),
}

OWN = ("ngslac", "first", "bubble")
PRESSURE = ("peak", "l2", "force")
L2 = ("l2", "recovered_l2")
SLIDING = ("--friction", "0.2", "--steps", "10")
CASES = {
    "hertz": Case(
        "2D Hertz problem, frictionless", "hertz", 0.25, PRESSURE, floor=0.01, own=(0.5, 0.125)
    ),
    "friction": Case(
        "2D Hertz problem, friction 0.2, 10 steps",
        *("hertz", 0.25, PRESSURE, SLIDING),
        floor=0.021,
        own=(0.5, 0.125),
    ),
    "patch": Case(
        "3D patch test",
        *("patch", 0.1, ("displacement", "stress", "penetration")),
        decisive=("stress",),
    ),
    "sphere": Case(
        "3D sphere on a block",
        *("sphere", 0.6, ("peak", *L2, "force")),
        decisive=L2,
        own=(1.0, 0.75, 0.4, 0.3),
    ),
}


# ---------------------------------------------------------------- runs


def Execute(command, limit, threads):
    """Run a program; returns its exit code (None: the limit was reached) and its last line."""
    names = ("OMP_NUM_THREADS", "MKL_NUM_THREADS", "NGS_NUM_THREADS")
    # Dense blocks in sparse factors use one thread.
    own = dict.fromkeys(names, str(threads)) | {"OPENBLAS_NUM_THREADS": "1"}
    process = subprocess.Popen(
        [str(word) for word in command],
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        stdin=subprocess.DEVNULL,
        text=True,
        errors="replace",
        env=os.environ | own,
        start_new_session=True,
    )
    try:
        output, _ = process.communicate(timeout=limit)
        code = process.returncode
    except subprocess.TimeoutExpired:
        code, output = None, ""
    finally:
        if process.poll() is None:
            os.killpg(process.pid, signal.SIGKILL)  # with all that it has started
            process.communicate()
    lines = output.strip().splitlines()
    return code, lines[-1] if lines else ""


def Run(name, key, mesh, *, order=2, extra=(), limit=600.0, threads=2):
    """Run a peer on a mesh for one of `CASES`; returns the row that it has written, or `Missing`.

    `mesh` is an .npz file of `peers/meshes.py` with the .vol file beside it, `order` that of the
    elements, where the peer has a choice, `limit` in seconds; `extra` are options of the peer.
    """
    peer, case, h = PEERS[key], CASES[name], float(mesh.stem.split("_")[1])
    if name in peer.cannot:
        return Missing(peer.title, h, "does not solve this problem")
    order = 1 if name in peer.linear else order
    with TemporaryDirectory() as folder:
        file = Path(folder) / "row.json"
        command = [sys.executable, FOLDER / peer.script, case.problem, mesh]
        command += ["--order", order, *case.options, *peer.options, *extra, "--json", file]
        code, line = Execute(command, limit, threads)
        if code == 0 and file.exists():
            return {**json.loads(file.read_text()), "title": peer.title, "case": name}
    failed = f"failed: {line or f'exit code {code}'}"
    reasons = {None: f"stopped after {limit:g} s", MISSING: f"not installed: {line}"}
    return Missing(peer.title, h, reasons.get(code, failed))


def MeshFile(case, h, folder, limit, threads):
    file = Path(folder) / f"{case.problem}_{h:g}.npz"
    if not file.exists():
        command = [sys.executable, FOLDER / "meshes.py", case.problem, f"{h:g}", file]
        code, line = Execute(command, limit, threads)
        if code != 0:
            raise RuntimeError(f"no mesh for {case.problem}, h = {h:g}: {line}")
    return file


def Compare(name, plan, folder, *, extra, **options):
    """All runs of a case: `plan` has the peers of each size, `extra` ngslac's options.

    Returns rows and missing ones.
    """
    rows, missing = [], []
    for h, peers in plan.items():
        mesh = MeshFile(CASES[name], h, folder, options["limit"], options["threads"])
        for key in (key for key in peers if name in (PEERS[key].only or CASES)):
            result = Run(name, key, mesh, extra=extra if key in OWN else (), **options)
            failed = isinstance(result, Missing)
            (missing if failed else rows).append(result)
            said = result.reason if failed else f"{result['seconds']:.1f} s"
            print(f"  {PEERS[key].title}: {said}", file=sys.stderr, flush=True)
    return rows, missing


def Plan(sizes, own, peers):
    """The peers of each size: all on `sizes`, ngslac alone on those of `own` beside."""
    alone = [key for key in peers if key in OWN]
    return dict.fromkeys(sizes, peers) | {h: alone for h in own if h not in sizes and alone}


# ---------------------------------------------------------------- output


def Table(case, rows, missing):
    """The result of a case as Markdown: a table sorted by time, notes, and what is missing."""
    head = ["", "order", "h", "dofs", "iterations", "time s", "cpu s", "GB", *case.errors]
    cells = [Cells(case, row) for row in sorted(rows, key=lambda r: (-r["h"], r["seconds"]))]
    lines = [f"### {case.title}", "", *([*Markdown(head, cells), ""] if cells else [])]
    notes = {row["title"]: f"{row['title']} {row['version']}: {row['settings']}" for row in rows}
    lines += [f"- {note}" for note in notes.values()]
    lines += [f"- missing: {m.title} (h = {m.h:g}): {m.reason}" for m in missing]
    lines += ["", *MatchTable(case, rows, Percent)]
    return "\n".join(lines).rstrip() + "\n"


def Cells(case, row):
    figures = [f"P{row['order']}", f"{row['h']:g}", str(row["dofs"]), str(row["iterations"])]
    figures += [f"{row[name]:.2f}" for name in ("seconds", "cpu", "memory")]
    return [row["title"], *figures, *(Percent(row.get(name)) for name in case.errors)]


def Percent(value):
    """A relative error in per cent; of very small ones the size. None: the peer has no such."""
    if value is None:
        return "-"
    if abs(value) < 1e-5:
        return f"{100 * value:.0e} %"
    return f"{100 * value:.2f} %" if abs(value) >= 1e-3 else f"{100 * value:.3f} %"


# ---------------------------------------------------------------- command line


def Sizes(words, default, option="--sizes"):
    """Sizes of each case from words such as "sphere=0.6,0.4", else those of `default`."""
    sizes = {name: default(case) for name, case in CASES.items()}
    for word in words:
        name, equals, values = word.partition("=")
        if name not in CASES or not equals:
            raise SystemExit(f"{option} {word}: write one of {', '.join(CASES)}, = and numbers")
        sizes[name] = tuple(float(value) for value in values.split(",") if value)
    return sizes


def Everything(options):
    """All tables; returns what goes into the JSON file."""
    chosen = {"--inverse": options.inverse, "--solver": options.solver}
    extra = [word for pair in chosen.items() if pair[1] is not None for word in pair]
    settings = {"order": options.order, "limit": options.limit, "threads": options.threads}
    sizes = Sizes(options.sizes, lambda case: (case.size,))
    own = Sizes(options.own, lambda case: case.own, "--own")
    rows, missing, tables = [], [], []
    with TemporaryDirectory() as folder:
        folder = options.meshes or folder
        Path(folder).mkdir(parents=True, exist_ok=True)
        for name in options.problems:
            plan = Plan(sizes[name], own[name], options.peers)
            found, not_found = Compare(name, plan, folder, extra=extra, **settings)
            tables.append(Table(CASES[name], found, not_found))
            print(tables[-1], flush=True)
            rows += found
            missing += [{"case": name, **vars(m)} for m in not_found]
    machine = Machine() | {"threads": options.threads}
    if options.markdown:
        where = ", ".join(f"{name} {value}" for name, value in machine.items())
        Path(options.markdown).write_text("\n".join([where + "\n", *tables]))
    return {"rows": rows, "missing": missing, **machine}


def Machine():
    """What measured times belong to."""
    file = Path("/proc/cpuinfo")
    lines = file.read_text().splitlines() if file.exists() else []
    models = [line.partition(":")[2].strip() for line in lines if line.startswith("model name")]
    name = models[0] if models else platform.processor() or platform.machine()
    return {"machine": name, "cores": os.cpu_count(), "date": date.today().isoformat()}


def main(argv=None):
    parser = Parser(__doc__)
    add = parser.add_argument
    add("--problems", nargs="+", choices=CASES, default=list(CASES))
    add("--peers", nargs="+", choices=PEERS, default=list(PEERS))
    add("--sizes", nargs="+", default=[], metavar="CASE=H,H", help="sizes of the slave faces, mm")
    add("--own", nargs="+", default=[], metavar="CASE=H,H", help="more sizes, ngslac alone")
    add("--order", type=int, choices=(1, 2), default=2)
    add("--limit", type=float, default=600.0, help="seconds for each run")
    add("--threads", type=int, default=os.cpu_count())
    add("--inverse", help="ngslac: sparse direct solver")
    add("--solver", help="ngslac: kind of solver")
    add("--meshes", metavar="DIR", help="keep the meshes here, and take those that are there")
    add("--markdown", metavar="FILE", help="write the tables to this file")
    options = parser.parse_args(argv)
    WriteJSON(options.json, Everything(options))


if __name__ == "__main__":
    main()
