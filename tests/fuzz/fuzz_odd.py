"""Odd uses that no single odd value makes: what is done, and what the error has to say."""

from pathlib import Path

import numpy as np
from ngsolve import (
    CF,
    H1,
    BilinearForm,
    BitArray,
    Discontinuous,
    GridFunction,
    InnerProduct,
    LinearForm,
    Mesh,
    Parameter,
    VectorH1,
    ds,
    dx,
    x,
)

from ngslac import (
    AugmentedLagrangianSolver,
    BubbleVectorH1,
    ContactSolver,
    FormSum,
    LACContact,
    LACSpace,
    LoadMesh,
    LoadState,
    LoadStepper,
    SaveState,
    SplitSlaveFaces,
    TimeStepper,
)

__all__ = ["LEGAL", "ODD"]


def Solve(w, a=None, gf=None, contacts=None, **flags):
    a, gf = w.Form() if a is None else a, w.gf if gf is None else gf
    return ContactSolver(a, gf, contacts or w.contact, **flags).Solve(printing=False)


def Fresh(w):
    return w.Contact(), w.Vector()


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


def Product(*spaces):
    product = spaces[0]
    for space in spaces[1:]:
        product = product * space
    return product


def Load(w, file):
    return LoadState(file, w.solver)


MULTIPLIER = "lam"
# name: (what is done, words of which the message has to hold one)
ODD = {
    # --- bulk forms
    **{
        f"bulk with {flag}={value}": (
            lambda w, f=flag, v=value: Solve(w, w.Form(**{f: v})),
            (flag,),
        )
        for flag, value in (
            ("nonassemble", True),
            ("diagonal", True),
            ("symmetric_storage", True),
            ("geom_free", True),
        )
    },
    "bulk without inner matrices": (
        lambda w: Solve(w, w.Form(condense=True, keep_internal=False)),
        ("keep_internal",),
    ),
    "bulk with lam mu": (
        lambda w: Solve(w, w.Form(InnerProduct(w.lam, w.mu) * ds("slave"))),
        (MULTIPLIER,),
    ),
    "bulk with u mu": (
        lambda w: Solve(w, w.Form(InnerProduct(w.u.Trace(), w.mu) * ds("slave"))),
        (MULTIPLIER,),
    ),
    "bulk with lam v": (
        lambda w: Solve(w, w.Form(InnerProduct(w.lam, w.v.Trace()) * ds("slave"))),
        (MULTIPLIER,),
    ),
    "bulk with a load on mu": (lambda w: Solve(w, w.Form(w.mu[1] * ds("slave"))), (MULTIPLIER,)),
    "rhs with a load on mu": (
        lambda w: Solve(w, rhs=LinearForm(w.mu[1] * ds("slave")).Assemble()),
        ("rhs",),
    ),
    "rhs that was never assembled": (
        lambda w: Solve(w, rhs=LinearForm(w.v[1] * ds("top"))),
        ("rhs",),
    ),
    "rhs of a point that was never assembled": (
        lambda w: Solve(w, rhs=PointLoad(w)),
        ("rhs",),
    ),
    "bulk with a load that is NaN": (
        lambda w: Solve(w, w.Form(CF(np.nan) * w.v[1] * dx)),
        ("NaN",),
    ),
    "bulk on the displacement alone": (lambda w: Solve(w, BilinearForm(w.V)), ("gf", "a")),
    "bulk without a term": (lambda w: Solve(w, BilinearForm(w.X)), ("a, the bulk form",)),
    "bulk of volume zero": (
        lambda w: Solve(w, ZeroBulk(w)),
        ("a, the bulk form",),
    ),
    # --- solutions and contacts
    "gf with infinity": (lambda w: Infinite(w), ("gf",)),
    "gf of a second product space": (lambda w: Solve(w, gf=GridFunction(w.V * w.Q)), ("gf",)),
    "the same contact twice": (lambda w: Solve(w, contacts=[w.contact, w.contact]), ("contacts",)),
    "two contacts with one lam": (
        lambda w: Solve(w, contacts=[w.contact, w.Contact()]),
        ("contacts",),
    ),
    "a sum with one contact twice": (lambda w: FormSum(w.a, w.contact, w.contact), ("contacts",)),
    "a sum without contact": (lambda w: FormSum(w.a), ("contacts",)),
    "nothing is free": (lambda w: Solve(w, freedofs=BitArray([False] * w.X.ndof)), ("free",)),
    "a contact with both sides": (lambda w: w.Contact(obstacle=CF(0.1)), ("obstacle",)),
    "a contact with no side": (lambda w: w.Contact(master=None), ("obstacle",)),
    "tied with friction": (lambda w: w.Contact(tied=True, friction=0.1), ("tied",)),
    "master is slave": (lambda w: w.Contact(master="slave"), ("slave",)),
    "lam of another kind of space": (
        lambda w: LACContact(*(w.V * w.V).TrialFunction(), master="master"),
        ("lam",),
    ),
    "lam with one component": (
        lambda w: LACContact(*(w.V * w.Q.WithComponents(1)).TrialFunction(), master="master"),
        ("lam", "components"),
    ),
    "u alone": (lambda w: LACContact(w.V.TrialFunction(), w.lam, master="master"), ("u ",)),
    "u scalar": (lambda w: LACContact(w.u[0], w.lam, master="master"), ("u ",)),
    # --- use before the pairing
    **{
        f"{name} before the pairing": (lambda w, use=use: use(*Fresh(w)), ("Update", "Evaluate"))
        for name, use in {
            "Force": lambda c, v: c.Force(),
            "Moment": lambda c, v: c.Moment(),
            "Table": lambda c, v: c.Table(),
            "AddApply": lambda c, v: c.AddApply(v, v),
            "AssembleLinearization": lambda c, v: c.AssembleLinearization(v),
            "Restore": lambda c, v: c.Restore(),
        }.items()
    },
    "Evaluate before the pairing": (lambda w: w.Contact().Evaluate(w.gf), ("Update",)),
    "Commit before the pairing": (lambda w: w.Contact().Commit(w.gf), ("Update",)),
    # --- spaces
    "LACSpace of a scalar space": (
        lambda w: LACSpace(H1(w.mesh, order=2), slave="slave"),
        ("LACSpace",),
    ),
    "LACSpace of a complex space": (
        lambda w: LACSpace(VectorH1(w.mesh, order=2, complex=True), slave="slave"),
        ("LACSpace",),
    ),
    "LACSpace of a discontinuous space": (
        lambda w: LACSpace(Discontinuous(VectorH1(w.mesh, order=2)), slave="slave"),
        ("LACSpace",),
    ),
    "LACSpace of a product": (lambda w: LACSpace(w.X, slave="slave"), ("LACSpace",)),
    "LACSpace of a LACSpace": (lambda w: LACSpace(w.Q, slave="slave"), ("LACSpace",)),
    "LACSpace on a clamped side": (
        lambda w: LACSpace(VectorH1(w.mesh, order=2, dirichlet="slave"), slave="slave"),
        ("LACSpace",),
    ),
    "LACSpace without slave": (lambda w: LACSpace(w.V), ("slave",)),
    **{
        f"macros={macros}": (
            lambda w, m=macros: LACSpace(w.V, slave="slave", macros=m),
            ("macros", "macro"),
        )
        for macros in ([0], [0, 0, 0, 99999], [-1, 0, 1, 2], [2**31 - 1] * 3, [0, 2, 4], [0] * 99)
    },
    "BubbleVectorH1 of a complex field": (
        lambda w: LACSpace(BubbleVectorH1(w.mesh, slave="slave", complex=True), slave="slave"),
        ("complex", "real"),
    ),
    "an empty mesh": (lambda w: LACSpace(VectorH1(EmptyMesh()), slave="slave"), ("slave",)),
    "an empty mesh to split": (lambda w: SplitSlaveFaces(EmptyMesh(), "slave"), ("boundary",)),
    # --- steppers
    "load at its end": (
        lambda w: LoadStepper(w.solver, w.load).Integrate(1.0, printing=False),
        ("end", "load"),
    ),
    "time at its end": (lambda w: w.times.Integrate(0.0, printing=False), ("end",)),
    "prescribed on a region that is free": (
        lambda w: LoadStepper(w.solver, w.load, prescribe={"slave": CF((0, 0))}),
        ("prescribe",),
    ),
    "prescribed on a misspelt region": (
        lambda w: LoadStepper(w.solver, w.load, prescribe={"bottm": CF((0, 0))}),
        ("prescribe",),
    ),
    "a scalar prescribed": (
        lambda w: LoadStepper(w.solver, w.load, prescribe={"bottom": CF(1)}),
        ("prescribe",),
    ),
    "a density that is negative somewhere": (
        lambda w: TimeStepper(w.solver, x - 0.5, dt=0.1),
        ("density",),
    ),
    "an obstacle that is a vector": (
        lambda w: w.Contact(master=None, obstacle=CF((x, 0))),
        ("obstacle",),
    ),
    "friction that is negative somewhere": (
        lambda w: w.Contact(friction=x - 0.5).Update(),
        ("friction",),
    ),
    "stiffness out of range": (lambda w: w.Contact(stiffness=1e-300), ("stiffness",)),
    # --- files
    "SaveState into a device": (lambda w: SaveState("/dev/null", w.solver), ("dev/null",)),
    "LoadState of another tool": (lambda w: LoadState(w.file, w.times), ("tool",)),
    "LoadState of another mesh": (lambda w: LoadState(w.file, w.other.solver), ("mesh",)),
    **{
        f"{load.__name__} of {name}": (
            lambda w, load=load, make=make: load(w, make(w)),
            ("SaveState", "damaged", "state"),
        )
        for load in (Load, lambda w, file: LoadMesh(file))
        for name, make in {
            "an empty file": lambda w: Written(w, b""),
            "text": lambda w: Written(w, b"a text, and no state"),
            "zeros": lambda w: Written(w, bytes(5000)),
            "a cut file": lambda w: Changed(w, -20),
            "half a file": lambda w: Changed(w, -(len(w.file.read_bytes()) // 2)),
            "a file with a bit of its head changed": lambda w: Changed(w, 0.001),
            "a file with a bit changed": lambda w: Changed(w, 0.5),
            "a file with a bit of its end changed": lambda w: Changed(w, 0.99),
        }.items()
    },
}


def PointLoad(w):
    f = LinearForm(w.X)
    f += w.v[1](0.5, 0.5)
    return f


def ZeroBulk(w):
    a = BilinearForm(w.X, check_unused=False)
    a += 0 * InnerProduct(w.u, w.v) * dx - w.v[1] * ds("top")
    return a


def Infinite(w):
    w.gf.vec.FV().NumPy()[3] = np.inf
    return Solve(w)


def EmptyMesh():
    from netgen.meshing import Mesh as NetgenMesh

    return Mesh(NetgenMesh(dim=2))


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
    "friction 0 as Parameter": lambda w: Solve(w, contacts=w.Contact(friction=Parameter(0))),
    "Update twice": lambda w: (w.contact.Update(), w.contact.Update(w.gf)),
    "augmentation as int": lambda w: AugmentedLagrangianSolver(
        w.a, w.gf, w.contact, augmentation=100
    ).Solve(printing=False),
    "prescribe nothing": lambda w: LoadStepper(w.solver, w.load, prescribe={}),
    "a state saved twice": lambda w: (SaveState(w.file, w.solver), SaveState(w.file, w.solver)),
    "a state loaded twice": lambda w: (LoadState(w.file, w.solver), LoadState(w.file, w.solver)),
    "SaveState before a solve": lambda w: SaveState(w.file, ContactSolver(w.a, w.gf, w.Contact())),
    "macros by hand": lambda w: LACSpace(
        w.V, slave="slave", macros=range(len(list(w.mesh.Boundaries("slave").Elements())))
    ),
}
