"""What one iterate of large sliding in 3D costs: pairing, residual and matrix of the contact alone.

    python tests/benchmarks/sliding.py --json sliding.json

A block of hexahedra or tetrahedra, rumpled at random, on a larger one; in each repetition it is
elsewhere. Milliseconds of processor time, without threads (the least of all repetitions): "follow"
pairs anew, "apply" is the residual, "again" the same where nothing moved since, "step" residual and
matrix. To compare two versions, run them in turns on the same machine.
"""

from __future__ import annotations

import time
from types import SimpleNamespace

import numpy as np
from benchmark_frame import Columns, Parser, WriteJSON
from ngsolve import CF, GridFunction, VectorH1

from ngslac import LACContact, LACSpace
from ngslac.meshes import TwoBlocks3D

CASES = {  # kind of the elements, their order, divisions of slave and master
    "hex 1": ("hex", 1, 26, 41),
    "hex 2": ("hex", 2, 10, 17),
    "hex 3": ("hex", 3, 5, 8),
    "tet 1": ("tet", 1, 14, 23),
    "tet 2": ("tet", 2, 9, 14),
}
WAY, RUMPLED = (0.07, 0.03, -0.01), 5e-5
CALLS = ("follow", "apply", "again", "step")
HEAD = ("case", "faces", "macros", "segments", "nonzeros", *CALLS)


def Problem(kind, order, n, m):
    """The contact, its solution, and a rigid motion of the slave with random displacements."""
    mesh = TwoBlocks3D(kind, kind, n, m, overhang=0.6, height=0.6, aligned=False)
    V = VectorH1(mesh, order=order)
    X = V * LACSpace(V, slave="slave")
    u, lam = X.TrialFunction()
    contact = LACContact(u, lam, master="master", friction=0.3, finite=True)
    contact.Update()
    contact.form.SetConstant(100.0)
    motion = GridFunction(V)
    motion.Set(mesh.MaterialCF({"upper": CF(WAY)}, default=CF((0, 0, 0))))
    values = motion.vec.FV().NumPy()
    values += RUMPLED * np.random.default_rng(1).normal(size=len(values))
    gf = GridFunction(X)
    traction = np.tile([0.1, 0.0, 0.5], (contact.space.nmacros, 1))
    traction[::3] = 0  # these are open
    gf.vec.FV().NumPy()[np.asarray(contact.form.MultiplierDofs())] = traction.ravel()
    return contact, gf, values


def Measure(kind, order, n, m, repeat=10):
    """One row: milliseconds of each of `CALLS`, and sizes."""
    contact, gf, motion = Problem(kind, order, n, m)
    residual = gf.vec.CreateVector()
    calls = {
        "follow": lambda: contact.Follow(gf),
        "apply": lambda: contact.Apply(gf.vec, residual),
        "again": lambda: contact.Apply(gf.vec, residual),
        "step": lambda: contact.form.AssembleStep(gf.vec, residual),
    }
    least = dict.fromkeys(CALLS, np.inf)
    for part in np.linspace(0.2, 1, repeat):
        gf.components[0].vec.FV().NumPy()[:] = part * motion
        for name in CALLS:
            start = time.process_time()
            calls[name]()
            least[name] = min(least[name], 1e3 * (time.process_time() - start))
    contact.Evaluate(gf)
    return SimpleNamespace(
        faces=len(list(contact.space.slave.Elements())),
        macros=contact.space.nmacros,
        segments=contact.form.nsegments,
        nonzeros=len(contact.form.mat.AsVector()),
        area=float(contact.Table()["area"].sum()),
        milliseconds=least,
    )


def Line(name, row):
    """One row of the table."""
    times = [f"{row.milliseconds[call]:.2f}" for call in CALLS]
    return Columns([name, row.faces, row.macros, row.segments, row.nonzeros, *times])


def main(argv=None):
    parser = Parser(__doc__)
    parser.add_argument("--cases", nargs="+", choices=CASES, default=list(CASES))
    parser.add_argument("--repeat", type=int, default=10)
    options, rows = parser.parse_args(argv), {}
    print(Columns(HEAD))
    for name in options.cases:
        rows[name] = Measure(*CASES[name], options.repeat)
        print(Line(name, rows[name]), flush=True)
    WriteJSON(options.json, rows)


if __name__ == "__main__":
    main()
