"""Cost of pairing: 10^3 to 10^6 slave faces against as many master faces that do not match.

Thin layers of one element, P2 displacements, with slightly more faces on the master side than on
the slave side: no inner nodes meet. Straight, and bent to a sine by a displacement, so that every
face is a parabola.

    python tests/benchmarks/pairing.py --largest 1000000
    python tests/benchmarks/pairing.py --dim 3

Every size runs in a process of its own. The whole call `contact.Update` is timed by
`time.perf_counter` (wall) and `time.process_time` (cpu, all threads, of which the idle ones spin),
its parts by NGSolve's timers (`ngslac::...`, wall); the minimum of the repetitions counts.
"""

from __future__ import annotations

import os
import time
from pathlib import Path
from types import SimpleNamespace

import numpy as np
from benchmark_frame import Columns, Growth, InProcess, Parser, WriteJSON
from layers import LayerMesh
from ngsolve import CF, GridFunction, SetNumThreads, TaskManager, Timers, VectorH1, sin, x

from ngslac import LACContact, LACSpace

PARTS = {
    "surfaces": "ngslac::Surface",
    "tree": "ngslac::Pair - tree",
    "pair": "ngslac::Pair",  # includes the tree
    "jump": "ngslac::MacroJump",
    "rows": "ngslac::MacroJump - rows",
}
AMPLITUDE, WAVE = 0.1, 3.0
HEAD = ("n", "segments", "Update s", "cpu s", *PARTS, "rest", "us/face", "space s", "bytes/seg")


def Contact(n, curved, dim):
    """The contact, its configuration (None: straight), and the time to make the LACSpace."""
    mesh = LayerMesh(n, dim)
    V = VectorH1(mesh, order=2)
    start = time.perf_counter()
    Q = LACSpace(V, slave="slave")
    seconds = time.perf_counter() - start
    X = V * Q
    u, lam = X.TrialFunction()
    contact = LACContact(u, lam, master="master", maxdist=0.1, penetration=0.1)
    if not curved:
        return contact, None, seconds
    gf = GridFunction(X)
    bent = CF((0,) * (dim - 1) + (AMPLITUDE * sin(WAVE * x),))
    gf.components[0].Set(bent, definedon=mesh.Boundaries("slave|master"))
    return contact, gf, seconds


def Measure(n, curved=False, threads=None, repeat=5, dim=2):
    """One row: n slave faces paired `repeat` times, times in seconds.

    `threads` changes their number for the whole process.
    """
    if threads:
        SetNumThreads(threads)
    with TaskManager():
        contact, gf, space = Contact(n, curved, dim)
        before = ResidentBytes()
        runs = [TimedUpdate(contact, gf)]
        memory = ResidentBytes() - before
        runs += [TimedUpdate(contact, gf) for _ in range(repeat - 1)]
        table = contact.Table()
    return SimpleNamespace(
        n=len(list(contact.space.slave.Elements())),
        curved=curved,
        threads=threads,
        segments=contact.form.nsegments,
        area=float(table["area"].sum()),  # paired, of the whole length
        length=float(table["fullarea"].sum()),
        space=space,  # making the LACSpace: traces, macro-elements
        update=min(wall for wall, _, _ in runs),
        cpu=min(cpu for _, cpu, _ in runs),  # of all threads
        parts={name: min(parts[name] for *_, parts in runs) for name in PARTS},
        memory=memory / contact.form.nsegments,  # bytes that the first Update added
    )


def TimedUpdate(contact, gf):
    """Wall and processor seconds of one Update, and wall seconds of its parts."""
    before = TimerSeconds()
    wall, cpu = time.perf_counter(), time.process_time()
    contact.Update(gf)
    wall, cpu = time.perf_counter() - wall, time.process_time() - cpu
    after = TimerSeconds()
    return wall, cpu, {name: after[t] - before.get(t, 0.0) for name, t in PARTS.items()}


def TimerSeconds():
    """Seconds so far of every timer of ngslac."""
    return {t["name"]: t["time"] for t in Timers() if t["name"].startswith("ngslac::")}


def ResidentBytes():
    """Memory of this process now; 0 where the system does not tell it in this way."""
    statm = Path("/proc/self/statm")
    return int(statm.read_text().split()[1]) * os.sysconf("SC_PAGE_SIZE") if statm.exists() else 0


def Line(row):
    """One row; parts as microseconds per slave face."""
    rest = row.update - sum(row.parts[name] for name in ("surfaces", "pair", "jump", "rows"))
    parts = [f"{1e6 * t / row.n:.2f}" for t in (*row.parts.values(), rest, row.update)]
    figures = [row.n, row.segments, f"{row.update:.4f}", f"{row.cpu:.4f}", *parts]
    return Columns([*figures, f"{row.space:.3f}", f"{row.memory:.0f}"])


def Series(sizes, curved, threads, repeat, dim):
    """Measure and print one shape; each size in a fresh process."""
    shape = "curved" if curved else "straight"
    print(f"\n{dim}D, {shape}, {threads} thread(s); parts in microseconds per slave face")
    print(Columns(HEAD))
    rows = []
    for n in sizes:
        rows.append(InProcess(Measure, n, curved, threads, repeat, dim))
        if rows[-1] is None:
            raise MemoryError(f"the run of {n} slave faces was killed")
        print(Line(rows[-1]), flush=True)
    if len(rows) > 1:
        print(Exponents(rows, threads))
    return rows


def Exponents(rows, threads):
    """How time grows: of processor time with one thread, else of wall time."""
    n = [row.n for row in rows]
    p = Growth(n, [row.cpu if threads == 1 else row.update for row in rows])
    pair, reference = Growth(n, [row.parts["pair"] for row in rows]), Growth(n, n * np.log(n))
    return f"time ~ n^{p:.2f} (pair alone n^{pair:.2f}); n log n is n^{reference:.2f} here"


def main(argv=None):
    parser = Parser(__doc__)
    add = parser.add_argument
    add("--dim", type=int, choices=(2, 3), default=2)
    add("--largest", type=int, default=100_000, help="most slave faces")
    add("--threads", type=int, nargs="+", default=[1, 2])
    add("--repeat", type=int, default=5, help="calls of Update; the minimum counts")
    options = parser.parse_args(argv)
    sizes = [10**k for k in range(3, 10) if 10**k <= options.largest]
    rows = []
    for curved in (False, True):
        for threads in options.threads:
            rows += Series(sizes, curved, threads, options.repeat, options.dim)
    WriteJSON(options.json, rows)


if __name__ == "__main__":
    main()
