"""Odd uses that no single odd value makes."""

from pathlib import Path

import ngsolve as ngs
import numpy as np  # noqa: F401 (the uses below name it)
from fuzz_uses import Uses
from netgen.meshing import Mesh as NetgenMesh

import ngslac as lac

__all__ = ["ODD"]


def Solve(w, a=None, gf=None, contacts=None, **flags):
    a, gf = w.Form() if a is None else a, w.gf if gf is None else gf
    return lac.ContactSolver(a, gf, contacts or w.contact, **flags).Solve(printing=False)


def Space(V, **flags):
    return lac.LACSpace(V, **({"slave": "slave"} | flags))


def Contact(u, lam, **flags):
    return lac.LACContact(u, lam, **({"master": "master"} | flags))


def Disc():
    return lac.tools.Sphere((0.5, -2), 1)


def Against(w, tool, **flags):
    return w.Contact(master=None, obstacle=tool, finite=True, **flags)


def Lawful(w, law):
    return Solve(w, contacts=w.Contact(law=law))


def Keeping(w, worn, start=0.0):
    def Spring(places):
        pull = {"traction": places["gap"][:, None] * places["normal"], "by_gap": places["normal"]}
        return pull | {"worn": worn(places)}

    Spring.kept = {"worn": start}
    contact = w.Contact(law=Spring)
    Solve(w, contacts=contact)
    return contact.Commit(w.gf)


def Steps(w, **flags):
    return lac.LoadStepper(w.solver, w.load, **flags)


def Written(w, content):
    file = Path(w.folder.name) / "written"
    file.write_bytes(content)
    return file


def Cut(w, length):
    return Written(w, w.file.read_bytes()[:length])


def Changed(w, share):
    """The saved state with one bit changed."""
    content = bytearray(w.file.read_bytes())
    content[int(share * len(content))] ^= 1
    return Written(w, content)


def Empty():
    return ngs.Mesh(NetgenMesh(dim=2))


Augmented = lac.AugmentedLagrangianSolver
MACROS = ("[0]", "[0, 0, 0, 99999]", "[-1, 0, 1, 2]", "[2**31 - 1] * 3", "[0, 2, 4]", "[0] * 99")
FILES = {
    "an empty file": 'Written(w, b"")',
    "text": 'Written(w, b"a text, and no state")',
    "zeros": "Written(w, bytes(5000))",
    "a cut file": "Cut(w, -20)",
    "half a file": "Cut(w, len(w.file.read_bytes()) // 2)",
    "a file with a bit of its head changed": "Changed(w, 0.001)",
    "a file with a bit changed": "Changed(w, 0.5)",
    "a file with a bit of its end changed": "Changed(w, 0.99)",
}
PRODUCTS = ["[macros|macro]", *(f"macros={m} | Space(w.V, macros={m})" for m in MACROS)]
PRODUCTS += ["[SaveState|damaged|state]"]
PRODUCTS += [f"LoadState of {n} | LoadState({file}, w.solver)" for n, file in FILES.items()]
PRODUCTS += [f"LoadMesh of {n} | LoadMesh({file})" for n, file in FILES.items()]

USES = """
[NaN]
bulk with a load that is NaN | Solve(w, w.Form(CF(np.nan) * w.v[1] * dx))
[gf|a]
bulk on the displacement alone | Solve(w, BilinearForm(w.V))
[a, the bulk form]
bulk without a term | Solve(w, BilinearForm(w.X))
[gf]
gf of a second product space | Solve(w, gf=GridFunction(w.V * w.Q))
[obstacle]
an obstacle that is a vector | w.Contact(master=None, obstacle=CF((x, 0)))
[u ]
u scalar | Contact(w.u[0], w.lam)

[Update|Evaluate]
Force before the pairing | w.Contact().Force()
Moment before the pairing | w.Contact().Moment()
Table before the pairing | w.Contact().Table()
Restore before the pairing | w.Contact().Restore()
AddApply before the pairing | w.Contact().AddApply(w.Vector(), w.Vector())
AssembleLinearization before the pairing | w.Contact().AssembleLinearization(w.Vector())
[Update]
Evaluate before the pairing | w.Contact().Evaluate(w.gf)
Commit before the pairing | w.Contact().Commit(w.gf)

[slave]
an empty mesh | Space(VectorH1(Empty()))
[complex|real]
BubbleVectorH1 of a complex field | Space(BubbleVectorH1(w.mesh, slave="slave", complex=True))
[boundary]
an empty mesh to split | SplitSlaveFaces(Empty(), "slave")

[law]
a law that returns nothing | Lawful(w, lambda places: None)
a law that returns text | Lawful(w, lambda places: {"traction": "none"})
a law without a traction | Lawful(w, lambda places: {"by_gap": places["normal"]})
a law of one number | Lawful(w, lambda places: {"traction": 1.0})
a law of infinite size | Lawful(w, lambda places: {"traction": np.inf * places["normal"]})
a law with a misspelt derivative | Lawful(w, lambda places: {"traction": places["slip"], "by": 1})
a law that keeps a matrix | Keeping(w, lambda places: 0 * places["gap"], [[1, 0], [0, 1]])
a law that keeps one number | Keeping(w, lambda places: 1.0)
a law that keeps nothing | Keeping(w, lambda places: None)
[dev/null]
SaveState into a device | SaveState("/dev/null", w.solver)
[tool]
LoadState of another tool | LoadState(w.file, w.times)
[mesh]
LoadState of another mesh | LoadState(w.file, w.other.solver)

[normal]
a plane tool without a normal | lac.tools.Plane((0, 0), (0, 0))
[radius]
a tool of no size | lac.tools.Sphere((0, 0), 0)
[half_angle]
a tool as blunt as a plane | lac.tools.Cone((0, 0, 0), (0, 0, 1), 2)
[points]
a tool that encloses nothing | lac.tools.Polygon([(0, 0), (1, 1), (1, 0), (0, 1)])
[file]
a tool of no file | lac.tools.FromSTL(Written(w, b"solid"))
[boundary]
a tool of no boundary | lac.tools.FromMesh(w.mesh, "nowhere")
[surface]
a tool with a rim | lac.tools.FromMesh(w.mesh, "top")
[signed distance]
a tool that is nowhere | lac.tools.SignedDistance(w.load)
a tool of a field | lac.tools.SignedDistance(ngs.x + w.gf.components[0][0], dim=2)
[shift]
a tool led nowhere | Disc().Moved()
a tool led by a trial function | Disc().Moved(shift=(0, w.u[0]))
a tool led by the place | Disc().Moved(shift=(ngs.x, 0))
[axis]
a tool in 2D with an axis | Disc().Moved(angle=1, axis=(0, 0, 1))
[travel]
a tool driven by nothing | Disc().Driven(force=(0, 1))
a tool driven by the displacement | Against(w, Disc().Driven(travel=(None, w.u[1])))
a tool that is led and pushed | Disc().Driven(travel=(w.u, None), force=(0, 1))
[driven]
a tool driven twice | Disc().Driven(travel=(w.u, None)).Driven(travel=(w.u, None))
[moves]
a tool combined too late | -Disc().Moved(shift=(1, 0))
[finite]
a tool with small sliding | w.Contact(master=None, obstacle=Disc())
[tied]
a tool glued on | Against(w, Disc(), tied=True)
[obstacle]
a tool in another dimension | Against(w, lac.tools.Sphere((0, 0, 0), 1))
a number as tool | Against(w, 0.5)
a word as tool | Against(w, "plane")

[]
contacts as a tuple | Solve(w, contacts=(w.contact,))
contacts from a generator | Solve(w, contacts=(c for c in [w.contact]))
numbers of numpy | w.solver.Solve(maxit=np.int64(20), tol=np.float32(1e-6), printing=np.bool_(0))
flags as numbers | w.Contact(finite=0, friction=0)
a vector as load | Solve(w, rhs=w.f.vec)
twice a vector as load | Solve(w, rhs=2 * w.f.vec)
a function as load | Solve(w, rhs=lambda: w.f.vec)
condense | Solve(w, w.Form(condense=True))
condense and store | Solve(w, w.Form(condense=True, store_inner=True))
eliminate hidden | Solve(w, w.Form(eliminate_hidden=True))
symmetric | Solve(w, w.Form(symmetric=True))
a region as master | Solve(w, contacts=w.Contact(master=w.mesh.Boundaries("master")))
stiffness 1e-6 | Solve(w, contacts=w.Contact(stiffness=1e-6))
stiffness 1e6 | Solve(w, contacts=w.Contact(stiffness=1e6))
friction 0 as Parameter | Solve(w, contacts=w.Contact(friction=Parameter(0)))
Update twice | (w.contact.Update(), w.contact.Update(w.gf))
augmentation as int | Augmented(w.a, w.gf, w.contact, augmentation=100).Solve(printing=False)
prescribe nothing | Steps(w, prescribe={})
a state saved twice | [SaveState(w.file, w.solver) for _ in "12"]
a state loaded twice | [LoadState(w.file, w.solver) for _ in "12"]
SaveState before a solve | SaveState(w.file, ContactSolver(w.a, w.gf, w.Contact()))
LACSpace of a scalar space | Space(H1(w.mesh, order=2))
macros by hand | Space(w.V, macros=range(len([*w.mesh.Boundaries("slave").Elements()])))
"""
ODD = [*Uses(globals(), "\n".join([*PRODUCTS, USES]))]
