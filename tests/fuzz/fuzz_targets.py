"""What is public, with valid arguments, and the kind of each argument."""

from collections.abc import Callable
from dataclasses import dataclass, field

from fuzz_kinds import PLAIN, VALUES, IsLegal, Near
from ngsolve import Grad, Id, Sym

import ngslac as lac
from ngslac.materials import NeoHooke, Stress

__all__ = ["TARGETS", "Target"]

# The kind that an argument of this name mostly has.
NAMED = {
    "a": "bulk",
    "also": "things?",
    "augmentation": "positive?",
    "bulk": "matrix",
    "callback": "function?",
    "contacts": "contacts",
    "deformation": "displacement?",
    "density": "density",
    "dt": "positive",
    "displacement": "displacement?",
    "end": "number",
    "energy": "energy?",
    "field": "word",
    "file": "saved-file",
    "filename": "path",
    "finite": "flag",
    "freedofs": "bits?",
    "friction": "scalar?",
    "gf": "solution",
    "initial": "word",
    "inverse": "word?",
    "lam": "trial",
    "load": "parameter",
    "master": "region",
    "maxcuts": "count",
    "maxdist": "positive?",
    "maxit": "count",
    "mesh": "mesh",
    "motion": "motion?",
    "obstacle": "gap",
    "penetration": "positive?",
    "predict": "flag",
    "prescribe": "prescribed?",
    "printing": "flag",
    "rho_inf": "share",
    "rhs": "load?",
    "same_load": "flag",
    "slave": "region",
    "state": "state",
    "steps": "count",
    "time": "parameter?",
    "tied": "flag",
    "tol": "below-one",
    "tool": "tool",
    "tresca": "scalar?",
    "u": "trial",
    "x": "vector",
    "y": "vector",
}


@dataclass
class Target:
    """Something to call.

    Attributes
    ----------
    call : callable
        ``call(world, **arguments)``, which also uses what it makes.
    given : callable
        ``given(world)``: valid arguments that are always there.
    names : str
        The arguments to vary, with a kind where that is not the one in NAMED: ``"tol x:arrays"``.
    also : dict
        Further legal labels of an argument.
    """

    name: str
    call: Callable
    given: Callable
    names: str
    also: dict = field(default_factory=dict)

    def Cases(self, every=False):
        """(argument, label, legal) of the odd values, of all of them if `every` is set.

        Else each argument gets what is easily taken for the right thing, half of the numbers, texts
        and containers, and a quarter of the objects: each target meets all of them.
        """
        for count, entry in enumerate(self.names.split()):
            name, _, kind = entry.partition(":")
            kind = kind or NAMED[name]
            for number, label in enumerate(VALUES):
                turn = (number + count + len(self.name)) % (2 if label in PLAIN else 4) == 0
                if every or turn or Near(kind, label):
                    yield name, label, self.IsLegal(name, kind, label)

    def IsLegal(self, name, kind, label):
        """May this argument have this value?"""
        return IsLegal(kind, label) or label in self.also.get(name, ())


def Solves(cls):
    return lambda w, **k: cls(**k).Solve(printing=False)


def Used(contact, w):
    lac.ContactSolver(w.a, w.gf, contact).Solve(printing=False)
    return contact.Check()


def LoadSteps(w, **k):
    w.load.Set(0)
    return lac.LoadStepper(**k).Integrate(steps=1, printing=False)


def TimeSteps(w, **k):
    return lac.TimeStepper(**k).Integrate(0.01, printing=False)


def Space(w, **k):
    Q = lac.LACSpace(**k)
    return Q.nmacros, [Q.CoreDofs(m) for m in range(Q.nmacros)]


def Bubbles(w, **k):
    return lac.BubbleVectorH1(**k).ndof


def Problem(w):
    return {"a": w.a, "gf": w.gf, "contacts": w.contact}


def Quietly(w):
    return {"printing": False}


def Nothing(w):
    return {}


SOLVER = "a gf contacts rhs freedofs inverse initial "
INTEGRATE = "end callback printing maxit tol "

# A law may depend on the solution; it has no mesh on which values could be looked at.
MODULI = {name: {"CF of a trial function", "nan CF"} for name in ("young", "nu")}

TARGETS = [
    # --- materials
    Target(
        "materials.Stress",
        lambda w, **k: Stress(**k),
        lambda w: {"strain": Sym(Grad(w.u)), "young": 2.0, "nu": 0.3},
        "strain:tensor young:density nu:poisson plane:word",
        MODULI,
    ),
    Target(
        "materials.NeoHooke",
        lambda w, **k: NeoHooke(**k),
        lambda w: {"F": Id(2) + Grad(w.u), "young": 2.0, "nu": 0.3},
        "F:tensor young:density nu:poisson",
        MODULI,
    ),
    # --- spaces and meshes
    Target(
        "LACSpace",
        Space,
        lambda w: {"V": w.V, "slave": "slave"},
        "V:space slave macros:state? components:count? autoupdate:flag",
    ),
    Target(
        "LACSpace.WithComponents",
        lambda w, **k: w.Q.WithComponents(**k),
        Nothing,
        "components:count",
    ),
    Target(
        "LACSpace.CoreDofs",
        lambda w, **k: w.Q.CoreDofs(**k),
        Nothing,
        "macro:count",
        {"macro": {"0"}},
    ),
    Target(
        "BubbleVectorH1",
        Bubbles,
        lambda w: {"mesh": w.mesh, "slave": "slave", "order": 1},
        "mesh slave order:count dirichlet:any-pattern?",
    ),
    Target(
        "SplitSlaveFaces",
        lambda w, **k: lac.SplitSlaveFaces(**k),
        lambda w: {"mesh": w.mesh, "slave": "slave"},
        "mesh slave hexes:word",
    ),
    # --- contact
    Target(
        "LACContact",
        lambda w, **k: Used(lac.LACContact(**k), w),
        lambda w: {"u": w.u, "lam": w.lam, "master": "master"},
        "u lam master friction tresca tied finite maxdist penetration stiffness:positive",
        {"u": {"trial function"}},
    ),
    Target(
        "LACContact with obstacle",
        lambda w, **k: Used(w.Contact(master=None, **k), w),
        lambda w: {"obstacle": 0.01},
        "obstacle friction",
    ),
    Target("LACContact.Update", lambda w, **k: w.contact.Update(**k), Nothing, "gf:solution?"),
    Target("LACContact.Prepare", lambda w, **k: w.Contact().Prepare(**k), Nothing, "bulk"),
    Target("LACContact.Follow", lambda w, **k: w.contact.Follow(**k), Nothing, "gf"),
    Target(
        "LACContact.AddApply",
        lambda w, **k: w.contact.AddApply(**k),
        lambda w: {"x": w.Vector(), "y": w.Vector()},
        "x y",
    ),
    Target(
        "LACContact.Apply",
        lambda w, **k: w.contact.Apply(**k),
        lambda w: {"x": w.Vector(), "y": w.Vector()},
        "x y",
    ),
    Target(
        "LACContact.AssembleLinearization",
        lambda w, **k: w.contact.AssembleLinearization(**k),
        Nothing,
        "x",
    ),
    Target("LACContact.Commit", lambda w, **k: w.contact.Commit(**k), Nothing, "gf"),
    Target("LACContact.Evaluate", lambda w, **k: w.contact.Evaluate(**k), Nothing, "gf"),
    Target(
        "LACContact.SetState",
        lambda w, **k: w.contact.SetState(**k),
        lambda w: {"state": w.contact.State()},
        "state gf:solution?",
    ),
    Target("LACContact.Moment", lambda w, **k: w.contact.Moment(**k), Nothing, "point:point?"),
    Target(
        "LACContact.Draw",
        lambda w, **k: w.contact.Draw(show=False, **k),
        lambda w: {"deformation": w.gf.components[0]},
        "field background:background? deformation scale:number size:positive?",
    ),
    Target(
        "LACContact.Plot",
        lambda w, **k: w.contact.Plot(**k),
        Nothing,
        "field along:word deformation axes:axes?",
    ),
    Target(
        "LACContact.WriteVTU",
        lambda w, **k: w.contact.WriteVTU(**k),
        lambda w: {"filename": w.folder.name + "/contact"},
        "filename displacement",
        {"filename": {"folder"}},
    ),
    Target(
        "Segments.WriteVTU",
        lambda w, **k: w.contact.Segments().WriteVTU(**k),
        Nothing,
        "filename",
        {"filename": {"folder"}},
    ),
    # --- solvers
    Target(
        "ContactSolver",
        Solves(lac.ContactSolver),
        Problem,
        SOLVER + "solver:word? preconditioner:function?",
    ),
    Target(
        "ContactSolver.Solve",
        lambda w, **k: w.solver.Solve(**k),
        Quietly,
        "maxit tol printing callback motion path:flag",
    ),
    Target("ContactSolver.SetState", lambda w, **k: w.solver.SetState(**k), Nothing, "state"),
    Target("ContactSolver.Merit", lambda w, **k: w.solver.Merit(**k), Nothing, "same_load"),
    Target(
        "AugmentedLagrangianSolver",
        Solves(lac.AugmentedLagrangianSolver),
        Problem,
        SOLVER + "augmentation",
    ),
    Target(
        "AugmentedLagrangianSolver.Solve",
        lambda w, **k: w.augmented.Solve(**k),
        Quietly,
        "maxit tol printing callback motion path:flag",
    ),
    Target(
        "FormSum",
        lambda w, a, contacts: lac.FormSum(a, contacts),
        lambda w: {"a": w.a, "contacts": w.contact},
        "a contacts",
    ),
    Target(
        "FormSum.AssembleLinearization",
        lambda w, **k: w.form.AssembleLinearization(**k),
        Nothing,
        "x",
    ),
    Target(
        "FormSum.Apply",
        lambda w, **k: w.form.Apply(**k),
        lambda w: {"x": w.Vector(), "y": w.Vector()},
        "x y",
    ),
    # --- steppers
    Target(
        "LoadStepper",
        LoadSteps,
        lambda w: {"solver": w.solver, "load": w.load},
        "solver:tool load prescribe predict maxcuts:count",
        {"maxcuts": {"0"}},
    ),
    Target(
        "LoadStepper.Integrate",
        lambda w, **k: w.loads.Integrate(**k),
        lambda w: {"printing": False, "steps": 1},
        INTEGRATE + "steps",
    ),
    Target("LoadStepper.SetState", lambda w, **k: w.loads.SetState(**k), Nothing, "state"),
    Target(
        "TimeStepper",
        TimeSteps,
        lambda w: {"solver": w.solver, "density": 1.0, "dt": 0.1},
        "solver:tool density dt rho_inf time prescribe energy maxcuts",
        {"maxcuts": {"0"}},
    ),
    Target(
        "TimeStepper.Integrate",
        lambda w, **k: w.times.Integrate(**k),
        lambda w: {"end": 0.1, "printing": False},
        INTEGRATE.replace("end", "end:positive"),
    ),
    Target("TimeStepper.SetState", lambda w, **k: w.times.SetState(**k), Nothing, "state"),
    # --- files
    Target(
        "SaveState",
        lambda w, **k: lac.SaveState(**k),
        lambda w: {"file": w.folder.name + "/new", "tool": w.solver},
        "file:path tool also",
    ),
    Target(
        "LoadState",
        lambda w, **k: lac.LoadState(**k),
        lambda w: {"file": w.file, "tool": w.solver},
        "file tool also",
    ),
    Target("LoadMesh", lambda w, **k: lac.LoadMesh(**k), Nothing, "file"),
]
