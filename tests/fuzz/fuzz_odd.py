"""Odd uses that no single odd value makes: what is done, and what the error has to say."""

from pathlib import Path

import ngsolve as ngs
import numpy as np
from netgen.meshing import Mesh as NetgenMesh
from ngsolve import CF, GridFunction, InnerProduct, LinearForm, VectorH1, ds, dx, x

import ngslac as lac

__all__ = ["LEGAL", "ODD"]


def Solve(w, a=None, gf=None, contacts=None, **flags):
    a, gf = w.Form() if a is None else a, w.gf if gf is None else gf
    return lac.ContactSolver(a, gf, contacts or w.contact, **flags).Solve(printing=False)


def Space(V, **flags):
    return lac.LACSpace(V, **({"slave": "slave"} | flags))


def Contact(u, lam, **flags):
    return lac.LACContact(u, lam, **({"master": "master"} | flags))


def Steps(w, **flags):
    return lac.LoadStepper(w.solver, w.load, **flags)


def Written(w, content):
    """A file with this content."""
    file = Path(w.folder.name) / "written"
    file.write_bytes(content)
    return file


def Changed(w, where):
    """The saved state with one byte changed, or cut there if it is negative."""
    content = bytearray(w.file.read_bytes())
    if where < 0:
        return Written(w, content[:where])
    content[int(where * len(content))] ^= 1
    return Written(w, content)


def PointLoad(w):
    f = LinearForm(w.X)
    f += w.v[1](0.5, 0.5)
    return f


def ZeroBulk(w):
    a = ngs.BilinearForm(w.X, check_unused=False)
    a += 0 * InnerProduct(w.u, w.v) * dx - w.v[1] * ds("top")
    return a


def Infinite(w):
    w.gf.vec.FV().NumPy()[3] = np.inf
    return Solve(w)


def Empty():
    return ngs.Mesh(NetgenMesh(dim=2))


MACROS = ([0], [0, 0, 0, 99999], [-1, 0, 1, 2], [2**31 - 1] * 3, [0, 2, 4], [0] * 99)
FLAGS = ("nonassemble", "diagonal", "symmetric_storage", "geom_free")
FILES = {
    "an empty file": lambda w: Written(w, b""),
    "text": lambda w: Written(w, b"a text, and no state"),
    "zeros": lambda w: Written(w, bytes(5000)),
    "a cut file": lambda w: Changed(w, -20),
    "half a file": lambda w: Changed(w, -(len(w.file.read_bytes()) // 2)),
    "a file with a bit of its head changed": lambda w: Changed(w, 0.001),
    "a file with a bit changed": lambda w: Changed(w, 0.5),
    "a file with a bit of its end changed": lambda w: Changed(w, 0.99),
}
READERS = {
    "LoadState": lambda w, file: lac.LoadState(file, w.solver),
    "LoadMesh": lambda w, file: lac.LoadMesh(file),
}

# Words of which the message has to hold one: name: what is done.
ODD = {
    # --- bulk forms
    **{
        flag: {f"bulk with {flag}=True": lambda w, flag=flag: Solve(w, w.Form(**{flag: True}))}
        for flag in FLAGS
    },
    "keep_internal": {
        "bulk without inner matrices": lambda w: Solve(
            w, w.Form(condense=True, keep_internal=False)
        ),
    },
    "lam": {
        "bulk with lam mu": lambda w: Solve(w, w.Form(InnerProduct(w.lam, w.mu) * ds("slave"))),
        "bulk with u mu": lambda w: Solve(w, w.Form(InnerProduct(w.u.Trace(), w.mu) * ds("slave"))),
        "bulk with lam v": lambda w: Solve(
            w, w.Form(InnerProduct(w.lam, w.v.Trace()) * ds("slave"))
        ),
        "bulk with a load on mu": lambda w: Solve(w, w.Form(w.mu[1] * ds("slave"))),
        "lam of another kind of space": lambda w: Contact(*(w.V * w.V).TrialFunction()),
    },
    "rhs": {
        "rhs with a load on mu": lambda w: Solve(
            w, rhs=LinearForm(w.mu[1] * ds("slave")).Assemble()
        ),
        "rhs that was never assembled": lambda w: Solve(w, rhs=LinearForm(w.v[1] * ds("top"))),
        "rhs of a point that was never assembled": lambda w: Solve(w, rhs=PointLoad(w)),
    },
    "NaN": {
        "bulk with a load that is NaN": lambda w: Solve(w, w.Form(CF(np.nan) * w.v[1] * dx)),
    },
    "gf|a": {"bulk on the displacement alone": lambda w: Solve(w, ngs.BilinearForm(w.V))},
    "a, the bulk form": {
        "bulk without a term": lambda w: Solve(w, ngs.BilinearForm(w.X)),
        "bulk of volume zero": lambda w: Solve(w, ZeroBulk(w)),
    },
    # --- solutions and contacts
    "gf": {
        "gf with infinity": Infinite,
        "gf of a second product space": lambda w: Solve(w, gf=GridFunction(w.V * w.Q)),
    },
    "contacts": {
        "the same contact twice": lambda w: Solve(w, contacts=[w.contact, w.contact]),
        "two contacts with one lam": lambda w: Solve(w, contacts=[w.contact, w.Contact()]),
        "a sum with one contact twice": lambda w: lac.FormSum(w.a, w.contact, w.contact),
        "a sum without contact": lambda w: lac.FormSum(w.a),
    },
    "free": {
        "nothing is free": lambda w: Solve(w, freedofs=ngs.BitArray([False] * w.X.ndof)),
    },
    "obstacle": {
        "a contact with both sides": lambda w: w.Contact(obstacle=CF(0.1)),
        "a contact with no side": lambda w: w.Contact(master=None),
        "an obstacle that is a vector": lambda w: w.Contact(master=None, obstacle=CF((x, 0))),
    },
    "tied": {"tied with friction": lambda w: w.Contact(tied=True, friction=0.1)},
    "lam|components": {
        "lam with one component": lambda w: Contact(*(w.V * w.Q.WithComponents(1)).TrialFunction()),
    },
    "u ": {
        "u alone": lambda w: Contact(w.V.TrialFunction(), w.lam),
        "u scalar": lambda w: Contact(w.u[0], w.lam),
    },
    # --- use before the pairing
    "Update|Evaluate": {
        **{
            f"{name} before the pairing": lambda w, name=name: getattr(w.Contact(), name)()
            for name in ("Force", "Moment", "Table", "Restore")
        },
        "AddApply before the pairing": lambda w: w.Contact().AddApply(w.Vector(), w.Vector()),
        "AssembleLinearization before the pairing": lambda w: w.Contact().AssembleLinearization(
            w.Vector()
        ),
    },
    "Update": {
        "Evaluate before the pairing": lambda w: w.Contact().Evaluate(w.gf),
        "Commit before the pairing": lambda w: w.Contact().Commit(w.gf),
    },
    # --- spaces
    "LACSpace": {
        "LACSpace of a scalar space": lambda w: Space(ngs.H1(w.mesh, order=2)),
        "LACSpace of a complex space": lambda w: Space(VectorH1(w.mesh, order=2, complex=True)),
        "LACSpace of a discontinuous space": lambda w: Space(
            ngs.Discontinuous(VectorH1(w.mesh, order=2))
        ),
        "LACSpace of a product": lambda w: Space(w.X),
        "LACSpace of a LACSpace": lambda w: Space(w.Q),
        "LACSpace on a clamped side": lambda w: Space(VectorH1(w.mesh, order=2, dirichlet="slave")),
    },
    "slave": {
        "master is slave": lambda w: w.Contact(master="slave"),
        "LACSpace without slave": lambda w: lac.LACSpace(w.V),
        "an empty mesh": lambda w: Space(VectorH1(Empty())),
    },
    "macros|macro": {
        f"macros={macros}": lambda w, macros=macros: Space(w.V, macros=macros) for macros in MACROS
    },
    "complex|real": {
        "BubbleVectorH1 of a complex field": lambda w: Space(
            lac.BubbleVectorH1(w.mesh, slave="slave", complex=True)
        ),
    },
    "boundary": {"an empty mesh to split": lambda w: lac.SplitSlaveFaces(Empty(), "slave")},
    # --- steppers
    "end|load": {"load at its end": lambda w: Steps(w).Integrate(1.0, printing=False)},
    "end": {"time at its end": lambda w: w.times.Integrate(0.0, printing=False)},
    "prescribe": {
        "prescribed on a region that is free": lambda w: Steps(w, prescribe={"slave": CF((0, 0))}),
        "prescribed on a misspelt region": lambda w: Steps(w, prescribe={"bottm": CF((0, 0))}),
        "a scalar prescribed": lambda w: Steps(w, prescribe={"bottom": CF(1)}),
    },
    "density": {
        "a density that is negative somewhere": lambda w: lac.TimeStepper(
            w.solver, x - 0.5, dt=0.1
        ),
    },
    "friction": {
        "friction that is negative somewhere": lambda w: w.Contact(friction=x - 0.5).Update(),
    },
    "stiffness": {"stiffness out of range": lambda w: w.Contact(stiffness=1e-300)},
    # --- files
    "dev/null": {"SaveState into a device": lambda w: lac.SaveState("/dev/null", w.solver)},
    "tool": {"LoadState of another tool": lambda w: lac.LoadState(w.file, w.times)},
    "mesh": {"LoadState of another mesh": lambda w: lac.LoadState(w.file, w.other.solver)},
    "SaveState|damaged|state": {
        f"{reader} of {name}": lambda w, read=read, make=make: read(w, make(w))
        for reader, read in READERS.items()
        for name, make in FILES.items()
    },
}

# What looks odd and has to work.
LEGAL = {
    "contacts as a tuple": lambda w: Solve(w, contacts=(w.contact,)),
    "contacts from a generator": lambda w: Solve(w, contacts=(c for c in [w.contact])),
    "numbers of numpy": lambda w: w.solver.Solve(
        maxit=np.int64(20), tol=np.float32(1e-6), printing=np.bool_(False)
    ),
    "flags as numbers": lambda w: w.Contact(finite=0, friction=0),
    "a vector as load": lambda w: Solve(w, rhs=w.f.vec),
    "twice a vector as load": lambda w: Solve(w, rhs=2 * w.f.vec),
    "a function as load": lambda w: Solve(w, rhs=lambda: w.f.vec),
    "condense": lambda w: Solve(w, w.Form(condense=True)),
    "condense and store": lambda w: Solve(w, w.Form(condense=True, store_inner=True)),
    "eliminate hidden": lambda w: Solve(w, w.Form(eliminate_hidden=True)),
    "symmetric": lambda w: Solve(w, w.Form(symmetric=True)),
    "a region as master": lambda w: Solve(
        w, contacts=w.Contact(master=w.mesh.Boundaries("master"))
    ),
    "stiffness 1e-6": lambda w: Solve(w, contacts=w.Contact(stiffness=1e-6)),
    "stiffness 1e6": lambda w: Solve(w, contacts=w.Contact(stiffness=1e6)),
    "friction 0 as Parameter": lambda w: Solve(w, contacts=w.Contact(friction=ngs.Parameter(0))),
    "Update twice": lambda w: (w.contact.Update(), w.contact.Update(w.gf)),
    "augmentation as int": lambda w: lac.AugmentedLagrangianSolver(
        w.a, w.gf, w.contact, augmentation=100
    ).Solve(printing=False),
    "prescribe nothing": lambda w: Steps(w, prescribe={}),
    "a state saved twice": lambda w: [lac.SaveState(w.file, w.solver) for _ in "12"],
    "a state loaded twice": lambda w: [lac.LoadState(w.file, w.solver) for _ in "12"],
    "SaveState before a solve": lambda w: lac.SaveState(
        w.file, lac.ContactSolver(w.a, w.gf, w.Contact())
    ),
    "macros by hand": lambda w: Space(
        w.V, macros=range(len(list(w.mesh.Boundaries("slave").Elements())))
    ),
}
