"""What is public, with valid arguments, and the kind of each argument."""

from collections.abc import Callable
from dataclasses import dataclass, field

from fuzz_kinds import PLAIN, VALUES, IsLegal, Near, Pairs
from ngsolve import Grad, Id, Sym

import ngslac as lac
from ngslac.materials import NeoHooke, Stress

__all__ = ["TARGETS", "Target"]

# The kind that an argument of this name mostly has.
NAMED = Pairs("""
    a:bulk also:things? augmentation:positive? bulk:matrix callback:function? contacts:contacts
    deformation:displacement? density:density dt:positive displacement:displacement? end:number
    energy:energy? field:word file:saved-file filename:path finite:flag freedofs:bits?
    friction:scalar? gf:solution initial:word inverse:word? lam:trial load:parameter master:region
    maxcuts:count maxdist:positive? maxit:count mesh:mesh motion:motion? obstacle:gap
    penetration:positive? predict:flag prescribe:prescribed? printing:flag rho_inf:share rhs:load?
    same_load:flag slave:region state:state steps:count time:parameter? tied:flag tol:below-one
    tool:tool tresca:scalar? u:trial x:vector y:vector
""")


@dataclass
class Target:
    """Something to call."""

    name: str
    call: Callable  # call(world, **arguments), which also uses what it makes
    names: str  # the arguments to vary, with a kind where NAMED has another: "tol x:arrays"
    given: Callable = lambda w: {}  # valid arguments that are always there
    also: dict = field(default_factory=dict)  # further legal labels of an argument
    plain: bool = False  # objects of NGSolve only with `every`

    def Cases(self, every=False):
        """(argument, label, legal) of the odd values, of all of them if `every` is set.

        Else each argument gets what is easily taken for the right thing, half of the numbers, texts
        and containers, and a quarter of the objects: each target meets all of them.
        """
        for count, entry in enumerate(self.names.split()):
            name, _, kind = entry.partition(":")
            kind = kind or NAMED[name]
            for number, label in enumerate(PLAIN if self.plain and not every else VALUES):
                turn = (number + count + len(self.name)) % (2 if label in PLAIN else 4) == 0
                if every or turn or Near(kind, label):
                    yield name, label, IsLegal(kind, label) or label in self.also.get(name, ())


OBJECTS = {  # of a World
    "AugmentedLagrangianSolver": "augmented",
    "ContactSolver": "solver",
    "FormSum": "form",
    "LACContact": "contact",
    "LACSpace": "Q",
    "LoadStepper": "loads",
    "Segments": "segments",
    "TimeStepper": "times",
}


def Method(name, names, given=Target.given, **also):
    """Of one of `OBJECTS`."""
    owner, _, method = name.partition(".")

    def Call(w, **k):
        return getattr(getattr(w, OBJECTS[owner]), method)(**k)

    return Target(name, Call, names, given, also)


def Function(thing, names, given=Target.given, **also):
    return Target(thing.__name__, lambda w, **k: thing(**k), names, given, also)


def Solver(cls, names):
    def Call(w, **k):
        cls(**k).Solve(printing=False)

    names = f"a gf contacts rhs freedofs inverse initial {names}"
    given = lambda w: {"a": w.a, "gf": w.gf, "contacts": w.contact}  # noqa: E731
    return Target(cls.__name__, Call, names, given)


def Used(contact, w):
    lac.ContactSolver(w.a, w.gf, contact).Solve(printing=False)
    return contact.Check()


def LoadSteps(w, **k):
    w.load.Set(0)
    return lac.LoadStepper(**k).Integrate(steps=1, printing=False)


def Space(w, **k):
    Q = lac.LACSpace(**k)
    return Q.nmacros, [Q.CoreDofs(m) for m in range(Q.nmacros)]


def Quietly(w):
    return {"printing": False}


def Vectors(w):
    return {"x": w.Vector(), "y": w.Vector()}


SOLVE = "maxit tol printing callback motion path:flag"
INTEGRATE = "callback printing maxit tol"
# A law may depend on the solution; it has no mesh on which values could be looked at.
MODULI = {name: {"CF of a trial function", "nan CF"} for name in ("young", "nu")}
ZERO = {"0"}

TARGETS = [
    # --- materials
    Target(
        "materials.Stress",
        lambda w, **k: Stress(**k),
        "strain:tensor young:density nu:poisson plane:word",
        lambda w: {"strain": Sym(Grad(w.u)), "young": 2.0, "nu": 0.3},
        MODULI,
    ),
    Target(
        "materials.NeoHooke",
        lambda w, **k: NeoHooke(**k),
        "F:tensor young:density nu:poisson",
        lambda w: {"F": Id(2) + Grad(w.u), "young": 2.0, "nu": 0.3},
        MODULI,
    ),
    # --- spaces and meshes
    Target(
        "LACSpace",
        Space,
        "V:space slave macros:state? components:count? autoupdate:flag",
        lambda w: {"V": w.V, "slave": "slave"},
    ),
    Method("LACSpace.WithComponents", "components:count"),
    Method("LACSpace.CoreDofs", "macro:count", macro=ZERO),
    Target(
        "BubbleVectorH1",
        lambda w, **k: lac.BubbleVectorH1(**k).ndof,
        "mesh slave order:count dirichlet:any-pattern?",
        lambda w: {"mesh": w.mesh, "slave": "slave", "order": 1},
    ),
    Function(
        lac.SplitSlaveFaces, "mesh slave hexes:word", lambda w: {"mesh": w.mesh, "slave": "slave"}
    ),
    # --- contact
    Target(
        "LACContact",
        lambda w, **k: Used(lac.LACContact(**k), w),
        "u lam master friction tresca tied finite maxdist penetration stiffness:positive",
        lambda w: {"u": w.u, "lam": w.lam, "master": "master"},
        {"u": {"trial function"}},
    ),
    Target(
        "LACContact with obstacle",
        lambda w, **k: Used(w.Contact(master=None, **k), w),
        "obstacle friction",
        lambda w: {"obstacle": 0.01},
    ),
    Method("LACContact.Update", "gf:solution?"),
    Target("LACContact.Prepare", lambda w, **k: w.Contact().Prepare(**k), "bulk"),
    Method("LACContact.Follow", "gf"),
    Method("LACContact.AddApply", "x y", Vectors),
    Method("LACContact.Apply", "x y", Vectors),
    Method("LACContact.AssembleLinearization", "x"),
    Method("LACContact.Commit", "gf"),
    Method("LACContact.Evaluate", "gf"),
    Method("LACContact.SetState", "state gf:solution?", lambda w: {"state": w.contact.State()}),
    Method("LACContact.Moment", "point:point?"),
    Method(
        "LACContact.Draw",
        "field background:background? deformation scale:number size:positive?",
        lambda w: {"deformation": w.gf.components[0], "show": False},
    ),
    Method("LACContact.Plot", "field along:word deformation axes:axes?"),
    Method(
        "LACContact.WriteVTU",
        "filename displacement",
        lambda w: {"filename": w.folder.name + "/contact"},
        filename={"folder"},
    ),
    Method("Segments.WriteVTU", "filename", filename={"folder"}),
    # --- solvers
    Solver(lac.ContactSolver, "solver:word? preconditioner:function?"),
    Method("ContactSolver.Solve", SOLVE, Quietly),
    Method("ContactSolver.SetState", "state"),
    Method("ContactSolver.Merit", "same_load"),
    Solver(lac.AugmentedLagrangianSolver, "augmentation"),
    Method("AugmentedLagrangianSolver.Solve", SOLVE, Quietly),
    Target(
        "FormSum",
        lambda w, a, contacts: lac.FormSum(a, contacts),
        "a contacts",
        lambda w: {"a": w.a, "contacts": w.contact},
    ),
    Method("FormSum.AssembleLinearization", "x"),
    Method("FormSum.Apply", "x y", Vectors),
    # --- steppers
    Target(
        "LoadStepper",
        LoadSteps,
        "solver:tool load prescribe predict maxcuts:count",
        lambda w: {"solver": w.solver, "load": w.load},
        {"maxcuts": ZERO},
    ),
    Method(
        "LoadStepper.Integrate", f"end {INTEGRATE} steps", lambda w: {"printing": False, "steps": 1}
    ),
    Method("LoadStepper.SetState", "state"),
    Target(
        "TimeStepper",
        lambda w, **k: lac.TimeStepper(**k).Integrate(0.01, printing=False),
        "solver:tool density dt rho_inf time prescribe energy maxcuts",
        lambda w: {"solver": w.solver, "density": 1.0, "dt": 0.1},
        {"maxcuts": ZERO},
    ),
    Method(
        "TimeStepper.Integrate",
        f"end:positive {INTEGRATE}",
        lambda w: {"end": 0.1, "printing": False},
    ),
    Method("TimeStepper.SetState", "state"),
    # --- files
    Function(
        lac.SaveState,
        "file:path tool also",
        lambda w: {"file": w.folder.name + "/new", "tool": w.solver},
    ),
    Function(lac.LoadState, "file tool also", lambda w: {"file": w.file, "tool": w.solver}),
    Function(lac.LoadMesh, "file"),
]
