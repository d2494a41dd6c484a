"""ngslac and other contact codes on the same meshes: accuracy beside time and memory.

    python tests/benchmarks/compare.py
    python tests/benchmarks/compare.py --problems sphere --sizes sphere=0.6,0.4 --markdown table.md
    python tests/benchmarks/compare.py --quick --json quick.json

Each run has a process of its own and a time limit; what is not installed, or fails, is named below
its table. The drivers and what they measure: `peers/README.md`. `--quick` runs ngslac alone, at
100,000 unknowns, and compares with one linear elastic solve of the same mesh.
"""

from __future__ import annotations

import argparse
import json
import os
import platform
import signal
import subprocess
import sys
from dataclasses import asdict, dataclass
from pathlib import Path
from tempfile import TemporaryDirectory

from _compare_tables import Missing, Table

__all__ = ["CASES", "PEERS", "Case", "Peer", "Run", "main"]

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
    """A problem: its title, mesh, options for the peers, and sizes of the slave faces in mm."""

    title: str
    problem: str
    options: tuple
    sizes: tuple
    errors: tuple


PEERS = {
    "ngslac": Peer("ngslac", "lac.py"),
    "bubble": Peer("ngslac, bubbles", "lac.py", ("--variant", "bubble"), only=("sphere",)),
    "penalty": Peer("ContactBoundary, penalty", "contactboundary.py"),
    "nitsche": Peer(
        "ContactBoundary, Nitsche",
        "contactboundary.py",
        ("--variant", "nitsche"),
        cannot=("friction",),
    ),
    "calculix": Peer("CalculiX, surface to surface", "calculix.py"),
    "mortar": Peer("CalculiX, mortar", "calculix.py", ("--variant", "mortar")),
    "kratos": Peer(
        "Kratos, ALM mortar", "kratos.py", linear=("hertz", "friction", "patch", "sphere")
    ),
    "getfem": Peer("GetFEM, ALM", "getfem_peer.py"),
}

PRESSURE = ("peak", "l2", "force")
CASES = {
    "hertz": Case("2D Hertz problem, frictionless", "hertz", (), (0.25,), PRESSURE),
    "friction": Case(
        "2D Hertz problem, friction 0.2 in 10 steps",
        "hertz",
        ("--friction", "0.2", "--steps", "10"),
        (0.25,),
        PRESSURE,
    ),
    "patch": Case("3D patch test", "patch", (), (0.1,), ("displacement", "stress", "penetration")),
    "sphere": Case("3D sphere on a block", "sphere", (), (0.6,), PRESSURE),
}


# ---------------------------------------------------------------- runs


def Environment(threads):
    """Environment variables for `threads` threads; dense blocks in sparse factors use one."""
    names = ("OMP_NUM_THREADS", "MKL_NUM_THREADS", "NGS_NUM_THREADS")
    return {**os.environ, **dict.fromkeys(names, str(threads)), "OPENBLAS_NUM_THREADS": "1"}


def Execute(command, limit, threads):
    """Run a program; returns its exit code (None: the limit was reached) and its last line."""
    process = subprocess.Popen(
        [str(word) for word in command],
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        stdin=subprocess.DEVNULL,
        text=True,
        errors="replace",
        env=Environment(threads),
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


def Run(name, peer, case, mesh, *, order=2, extra=(), limit=600.0, threads=2):
    """Run one peer on one mesh.

    Parameters
    ----------
    name : str
        Of the case, in `CASES`.
    peer : Peer
    case : Case
    mesh : Path
        An .npz file of `peers/meshes.py`; its .vol file lies beside it.
    order : {1, 2}
        Of the elements, where the peer has them.
    extra : sequence of str
        Further options of the peer.
    limit : float
        Seconds.
    threads : int

    Returns
    -------
    dict or Missing
        What the peer has written.
    """
    h = float(mesh.stem.split("_")[1])
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
    if code is None:
        return Missing(peer.title, h, f"stopped after {limit:g} s")
    if code == MISSING:
        return Missing(peer.title, h, f"not installed: {line}")
    return Missing(peer.title, h, f"failed: {line or f'exit code {code}'}")


def MeshFile(case, h, folder, limit, threads):
    """Make a mesh."""
    file = Path(folder) / f"{case.problem}_{h:g}.npz"
    if not file.exists():
        command = [sys.executable, FOLDER / "meshes.py", case.problem, f"{h:g}", file]
        code, line = Execute(command, limit, threads)
        if code != 0:
            raise RuntimeError(f"no mesh for {case.problem}, h = {h:g}: {line}")
    return file


def Compare(name, sizes, peers, folder, *, own, **options):
    """All runs of a case, with the options `own` of some peers; returns rows and missing ones."""
    case, rows, missing = CASES[name], [], []
    for h in sizes:
        mesh = MeshFile(case, h, folder, options["limit"], options["threads"])
        for key in (key for key in peers if name in (PEERS[key].only or CASES)):
            result = Run(name, PEERS[key], case, mesh, extra=own.get(key, ()), **options)
            if isinstance(result, Missing):
                missing.append(result)
                print(f"  {result.title}: {result.reason}", file=sys.stderr, flush=True)
            else:
                rows.append(result)
                print(
                    f"  {result['title']}: {result['seconds']:.1f} s", file=sys.stderr, flush=True
                )
    return rows, missing


# ---------------------------------------------------------------- command line


def Machine(threads):
    """What the times depend on."""
    return {"machine": platform.machine(), "cores": os.cpu_count(), "threads": threads}


def Sizes(words):
    """Sizes of each case from words such as "sphere=0.6,0.4"."""
    sizes = {name: case.sizes for name, case in CASES.items()}
    for word in words:
        name, _, values = word.partition("=")
        if name not in CASES or not values:
            raise SystemExit(f"--sizes {word}: write one of {', '.join(CASES)}, = and numbers")
        sizes[name] = tuple(float(value) for value in values.split(","))
    return sizes


def Quick(options):
    """ngslac alone against an elastic solve, at 100,000 unknowns."""
    from scaling import Ratios

    ratios = Ratios(ndof=100_000, inverse=options.inverse, solver=options.solver, printing=True)
    for name, value in ratios.items():
        print(f"{name:28} {value:.2f}" if isinstance(value, float) else f"{name:28} {value}")
    return ratios


def Parser():
    """The command line."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    add = parser.add_argument
    add("--problems", nargs="+", choices=CASES, default=list(CASES))
    add("--peers", nargs="+", choices=PEERS, default=list(PEERS))
    add("--sizes", nargs="+", default=[], metavar="CASE=H,H", help="sizes of the slave faces, mm")
    add("--order", type=int, choices=(1, 2), default=2)
    add("--limit", type=float, default=600.0, help="seconds for each run")
    add("--threads", type=int, default=os.cpu_count())
    add("--inverse", help="ngslac: sparse direct solver")
    add("--solver", help="ngslac: kind of solver")
    add("--meshes", metavar="DIR", help="keep the meshes here, and take those that are there")
    add("--quick", action="store_true", help="ngslac against an elastic solve, 100,000 unknowns")
    add("--json", metavar="FILE", help="write all figures to this file")
    add("--markdown", metavar="FILE", help="write the tables to this file")
    return parser


def Everything(options):
    """All tables; returns what goes into the JSON file."""
    chosen = {"--inverse": options.inverse, "--solver": options.solver}
    extra = [word for pair in chosen.items() if pair[1] is not None for word in pair]
    own = dict.fromkeys(("ngslac", "bubble"), extra)
    settings = {"order": options.order, "limit": options.limit, "threads": options.threads}
    sizes, rows, missing, tables = Sizes(options.sizes), [], [], []
    with TemporaryDirectory() as folder:
        folder = options.meshes or folder
        Path(folder).mkdir(parents=True, exist_ok=True)
        for name in options.problems:
            found, not_found = Compare(
                name, sizes[name], options.peers, folder, own=own, **settings
            )
            tables.append(Table(CASES[name], found, not_found))
            print(tables[-1], flush=True)
            rows += found
            missing += [{"case": name, **asdict(m)} for m in not_found]
    if options.markdown:
        Path(options.markdown).write_text("\n".join(tables))
    return {"rows": rows, "missing": missing, **Machine(options.threads)}


def main(argv=None):
    """Run from the command line."""
    options = Parser().parse_args(argv)
    figures = Quick(options) if options.quick else Everything(options)
    if options.json:
        Path(options.json).write_text(json.dumps(figures, indent=2) + "\n")


if __name__ == "__main__":
    main()
