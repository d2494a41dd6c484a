"""What is public, with valid arguments, and the kind of each argument."""

from collections.abc import Callable
from dataclasses import dataclass, field

from fuzz_kinds import PLAIN, VALUES, IsLegal, Near, Pairs
from fuzz_uses import Evaluated

import ngslac as lac
from ngslac.materials import NeoHooke, Stress

__all__ = ["TARGETS", "Target"]

# The kind that an argument of this name mostly has.
NAMED = Pairs("""
    a:bulk adjust:positive? also:things? augmentation:positive? bilateral:flag bulk:matrix
    callback:function? contacts:contacts deformation:displacement? density:density dt:positive
    displacement:displacement? edges:flag end:number energy:energy? field:word file:saved-file
    filename:path finite:flag freedofs:bits? friction:scalar? gf:solution initial:word
    inverse:word? lam:trial law:function? load:parameter master:region maxcuts:count
    maxdist:positive? maxit:count mesh:mesh motion:motion? obstacle:gap offset:gap?
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
    given: Callable  # given(world): valid arguments that are always there
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


# Of a World, whose methods are called.
OBJECTS = Pairs("""
    AugmentedLagrangianSolver:augmented ContactSolver:solver FormSum:form LACContact:contact
    LACSpace:Q LoadStepper:loads Segments:segments TimeStepper:times
""")
# A law may depend on the solution; it has no mesh on which values could be looked at.
LAW = {"CF of a trial function", "nan CF"}
ALSO = {"young": LAW, "nu": LAW, "u": {"trial function"}, "filename": {"folder"}}
ALSO |= {"flux": {"[]"}, "macro": {"0"}, "maxcuts": {"0"}}


def Used(w, contact):
    lac.ContactSolver(w.a, w.gf, contact).Solve(printing=False)
    return contact.Check()


def LoadSteps(w, **k):
    w.load.Set(0)
    return lac.LoadStepper(**k).Integrate(steps=1, printing=False)


def Space(w, **k):
    Q = lac.LACSpace(**k)
    return Q.nmacros, [Q.CoreDofs(m) for m in range(Q.nmacros)]


# What is more than a call: what was made is used.
CALLS = {
    "materials.Stress": lambda w, **k: Stress(**k),
    "materials.NeoHooke": lambda w, **k: NeoHooke(**k),
    "LACSpace": Space,
    "BubbleVectorH1": lambda w, **k: lac.BubbleVectorH1(**k).ndof,
    "LACContact": lambda w, **k: Used(w, lac.LACContact(**k)),
    "LACContact with another law": lambda w, **k: Used(w, w.Contact(**k)),
    "LACContact with obstacle": lambda w, **k: Used(w, w.Contact(master=None, **k)),
    "LACContact.Flow": lambda w, **k: w.Conducting().Flow(**k),
    "LACContact.Prepare": lambda w, **k: w.Contact().Prepare(**k),
    "ContactSolver": lambda w, **k: lac.ContactSolver(**k).Solve(printing=False),
    "AugmentedLagrangianSolver": lambda w, **k: lac.AugmentedLagrangianSolver(**k).Solve(
        printing=False
    ),
    "Flux": lambda w, **k: lac.Flux(**k).share,
    "FormSum": lambda w, a, contacts: lac.FormSum(a, contacts),
    "LoadStepper": LoadSteps,
    "TimeStepper": lambda w, **k: lac.TimeStepper(**k).Integrate(0.01, printing=False),
}
# Names | arguments | valid ones that are always there.
TABLE = """
materials.Stress | strain:tensor young:density nu:poisson plane:word
    | strain=Sym(Grad(w.u)), young=2.0, nu=0.3
materials.NeoHooke | F:tensor young:density nu:poisson | F=Id(2) + Grad(w.u), young=2.0, nu=0.3
LACSpace | V:space slave macros:state? components:count? autoupdate:flag axisymmetric:flag
    | V=w.V, slave="slave"
LACSpace.WithComponents | components:count
LACSpace.CoreDofs | macro:count
BubbleVectorH1 | mesh slave order:count dirichlet:any-pattern? | mesh=w.mesh, slave="slave", order=1
SplitSlaveFaces | mesh slave hexes:word | mesh=w.mesh, slave="slave"
FindContacts
    | mesh within:positive sliding:nonnegative angle:count masters:things tied:things young:things?
    | mesh=w.mesh, within=0.1
LACContact | u lam master friction tresca maxdist penetration stiffness:positive
    | u=w.u, lam=w.lam, master="master"
Law | traction:function
Flux | field:trial flow:function heat:function? share:share | field=w.T, flow=lambda z: z
LACContact with another law | offset adjust tied bilateral finite edges law flux:trial?
LACContact with obstacle | obstacle friction offset | obstacle=0.01
LACContact.Update | gf:solution?
LACContact.Activate | gf:solution?
LACContact.Prepare | bulk form:bulk? | bulk=w.a.mat
LACContact.Follow | gf
LACContact.AddApply | x y | x=w.Vector(), y=w.Vector()
LACContact.Apply | x y | x=w.Vector(), y=w.Vector()
LACContact.AssembleLinearization | x
LACContact.Commit | gf
LACContact.Evaluate | gf
LACContact.SetState | state gf:solution? | state=w.contact.State()
LACContact.Force | on:region?
LACContact.Flow | flux:trial?
LACContact.Moment | point:point?
LACContact.Draw | field background:background? deformation scale:number size:positive?
    | deformation=w.gf.components[0], show=False
LACContact.Plot | field along:word deformation axes:axes?
LACContact.WriteVTU | filename displacement | filename=w.folder.name + "/contact"
Segments.WriteVTU | filename
ContactSolver
    | a gf contacts rhs freedofs inverse initial solver:word? preconditioner:function?
    | a=w.a, gf=w.gf, contacts=w.contact
ContactSolver.Solve | maxit tol printing callback motion path:flag | printing=False
ContactSolver.SetState | state
ContactSolver.Merit | same_load
ContactSolver.Reaction | region:region motion:displacement? | region="bottom"
AugmentedLagrangianSolver
    | a gf contacts rhs freedofs inverse initial augmentation solver:word? preconditioner:function?
    | a=w.a, gf=w.gf, contacts=w.contact
AugmentedLagrangianSolver.Solve | maxit tol printing callback motion path:flag | printing=False
FormSum | a contacts | a=w.a, contacts=w.contact
FormSum.AssembleLinearization | x
FormSum.Apply | x y | x=w.Vector(), y=w.Vector()
LoadStepper | solver:tool load prescribe predict maxcuts | solver=w.solver, load=w.load
LoadStepper.Integrate | end callback printing maxit tol steps | printing=False, steps=1
LoadStepper.SetState | state
TimeStepper | solver:tool density dt rho_inf time prescribe energy maxcuts
    | solver=w.solver, density=1.0, dt=0.1
TimeStepper.Integrate | end:positive callback printing maxit tol | end=0.1, printing=False
TimeStepper.SetState | state
SaveState | file:path tool also | file=w.folder.name + "/new", tool=w.solver
LoadState | file tool also | file=w.file, tool=w.solver
LoadMesh | file comm:communicator? | file=w.file
"""


def Call(name):
    """``call(world, **arguments)`` of a target."""
    owner, _, method = name.partition(".")
    if name in CALLS:
        return CALLS[name]
    if not method:
        return lambda w, **k: getattr(lac, name)(**k)
    return lambda w, **k: getattr(getattr(w, OBJECTS[owner]), method)(**k)


def Rows(text):
    """The target of each row of a table; it goes on where the next line is indented."""
    for line in text.strip().replace("\n    |", " |").splitlines():
        name, names, given = [*map(str.strip, line.split("|")), ""][:3]
        yield Target(name, Call(name), names, Evaluated(f"dict({given})", {}), ALSO)


TARGETS = [*Rows(TABLE)]
